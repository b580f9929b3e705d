#include <stdio.h>
#include <string.h>

#include "app/app.h"
#include "app/file_arguments.h"
#include "app/number.h"
#include "app/path_arguments.h"
#include "base/alloc.h"
#include "base/error.h"

typedef struct atlas_request {
    hewn_atlas_job_desc desc;
    const char **charsets, **texts;
    bool quiet;
} atlas_request;

static const hewn_option options[] = {
    {'o', "output", "FILE", "Write the image to FILE as PNG; `-` is standard output. Required."},
    {0, "json", "FILE",
     "Write where each letter is, metrics and kerning to FILE, in the layout of msdf-atlas-gen; `-` is standard "
     "output."},
    {0, "type", "NAME",
     "msdf: three distances whose middle one keeps corners sharp. sdf: the distance, in grey. psdf: that to sides "
     "which "
     "go on straight, in grey. mtsdf: msdf, and sdf as opacity. Default: msdf."},
    {0, "size", "PX", "Texels an em, 1 to 4096. Default: 32."},
    {0, "range", "PX",
     "How many texels lie between the lowest distance (0) and the highest (255), 0.1 to 1024; the outline is in the "
     "middle. Default: 4."},
    {0, "charset", "NAME",
     "Characters: ascii, latin1, all (that the font has), or a file with numbers, 'c', \"text\" and ranges [FIRST, "
     "LAST]. "
     "May be repeated. Default: ascii, without --chars."},
    {0, "chars", "TEXT", "The characters of this text; @FILE: of a text file. May be repeated."},
    {0, "dimensions", "WxH", "Size of the image; pot: the least power of two. Default: the least square."},
    {0, "y-origin", "SIDE",
     "In the JSON y counts from the bottom, upward, or from the top, downward. Default: bottom."},
    {0, "corner", "DEGREES", "An outline that turns by this much has a corner there. Default: 8."},
    {0, "face", "N", "Which font of a collection, from 0. Default: 0."},
    {0, "no-kerning", NULL, "Leave kerning out of the JSON."},
    HEWN_OPTION_QUIET,
    HEWN_OPTION_HELP,
};

/* --- the command line -----------------------------------------------------------------------------------------------
 */

static hewn_result read_texels(const hewn_arguments *arguments, hewn_atlas_desc *atlas, hewn_error *error)
{
    static const struct {
        const char *name, *option;
        double least, most;
    } numbers[3] = {{"size", "--size", 1, 4096}, {"range", "--range", 0.1, 1024}, {"corner", "--corner", 0.1, 179}};
    double *const to[3] = {&atlas->size, &atlas->range, &atlas->corner};
    for (int i = 0; i < 3; i++) {
        const char *text = hewn_arguments_value(arguments, numbers[i].name);
        if (!text)
            continue;
        HEWN_TRY(hewn_number_parse(text, numbers[i].option, to[i], error));
        if (*to[i] < numbers[i].least || *to[i] > numbers[i].most)
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "%s is %g to %g, not %s", numbers[i].option,
                             numbers[i].least, numbers[i].most, text);
    }
    return HEWN_OK;
}

static hewn_result read_look(const hewn_arguments *arguments, hewn_atlas_job_desc *desc, hewn_error *error)
{
    const char *type = hewn_arguments_value(arguments, "type"), *face = hewn_arguments_value(arguments, "face");
    const char *sides = hewn_arguments_value(arguments, "dimensions"),
               *origin = hewn_arguments_value(arguments, "y-origin");
    if (type && !hewn_atlas_type_named(type, &desc->atlas.type))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--type is msdf, sdf, psdf or mtsdf, not '%s'", type);
    if (face)
        HEWN_TRY(hewn_count_parse(face, "--face", 0, &desc->face, error));
    if (sides && strcmp(sides, "pot") == 0)
        desc->atlas.power_of_two = true;
    else if (sides)
        HEWN_TRY(hewn_size_parse(sides, "--dimensions", &desc->atlas.width, &desc->atlas.height, error));
    if (origin && strcmp(origin, "top") != 0 && strcmp(origin, "bottom") != 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--y-origin is bottom or top, not '%s'", origin);
    desc->y_down = origin && strcmp(origin, "top") == 0;
    desc->atlas.no_kerning = hewn_arguments_has(arguments, "no-kerning");
    return read_texels(arguments, &desc->atlas, error);
}

static hewn_result read_characters(const hewn_arguments *arguments, atlas_request *request, hewn_error *error)
{
    hewn_atlas_job_desc *desc = &request->desc;
    request->charsets = hewn_alloc(arguments->given_count, sizeof *request->charsets);
    request->texts = hewn_alloc(arguments->given_count, sizeof *request->texts);
    if (!request->charsets || !request->texts)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the arguments");
    for (size_t i = 0; i < arguments->given_count; i++) {
        const hewn_given *given = &arguments->given[i];
        const char *name = given->option->name ? given->option->name : "";
        if (strcmp(name, "charset") == 0)
            request->charsets[desc->charset_count++] = given->value;
        else if (strcmp(name, "chars") == 0)
            request->texts[desc->text_count++] = given->value;
    }
    desc->charsets = request->charsets;
    desc->texts = request->texts;
    return HEWN_OK;
}

static hewn_result read_request(const hewn_arguments *arguments, atlas_request *request, hewn_error *error)
{
    hewn_atlas_job_desc *desc = &request->desc;
    if (arguments->operand_count == 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "which font? Give its file");
    if (arguments->operand_count > 1)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "one file at a time, please; '%s' is one too many",
                         arguments->operands[1]);
    desc->font = arguments->operands[0];
    desc->json = hewn_arguments_value(arguments, "json");
    request->quiet = hewn_arguments_has(arguments, "quiet");
    HEWN_TRY(hewn_output_argument_read(arguments, "image", "FILE", &desc->output, error));
    if (!desc->font[0] || (desc->json && !desc->json[0]))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a file needs a name");
    HEWN_TRY(hewn_output_spare_terminal(desc->output, "PNG", error));
    HEWN_TRY(read_look(arguments, desc, error));
    return read_characters(arguments, request, error);
}

/* --- running --------------------------------------------------------------------------------------------------------
 */

static void print_missing(const hewn_atlas *atlas)
{
    enum { SHOWN = 20 };
    if (atlas->missing_count == 0)
        return;
    fprintf(stderr, "hewn: note: the font has no glyph for %zu character%s:", atlas->missing_count,
            atlas->missing_count == 1 ? "" : "s");
    for (size_t i = 0; i < atlas->missing_count && i < SHOWN; i++)
        fprintf(stderr, " U+%04X", atlas->missing[i]);
    fprintf(stderr, "%s\n", atlas->missing_count > SHOWN ? " and others" : "");
}

static void print_summary(const atlas_request *request, const hewn_atlas_report *report)
{
    const hewn_atlas *atlas = &report->atlas;
    const char *output = request->desc.output;
    fprintf(stderr, "%s: %u x %u texels, %s of %s; %zu characters, %zu kerned pairs",
            strcmp(output, "-") == 0 ? "standard output" : output, atlas->width, atlas->height,
            hewn_atlas_type_name(atlas->type), report->font, atlas->glyph_count, atlas->kerning_count);
    if (atlas->softened > 0)
        fprintf(stderr, "; %zu texels without colours", atlas->softened);
    fprintf(stderr, "; %.2f s\n", report->seconds);
}

static int run(const hewn_command *command, const hewn_arguments *arguments)
{
    atlas_request request = {0};
    hewn_atlas_report report = {0};
    hewn_error error = {0};
    hewn_result result = read_request(arguments, &request, &error);
    if (result == HEWN_OK) {
        hewn_signals_catch();
        hewn_signals_end_at_once(true, NULL);
        hewn_progress progress = hewn_progress_begin(request.quiet);
        request.desc.atlas.progress = &progress;
        result = hewn_atlas_file(&request.desc, &report, &error);
        request.desc.atlas.progress = NULL;
        hewn_progress_end();
    }
    if (result == HEWN_OK) {
        print_missing(&report.atlas);
        if (!request.quiet)
            print_summary(&request, &report);
    }
    hewn_atlas_report_destroy(&report);
    hewn_free(request.charsets);
    hewn_free(request.texts);
    return result == HEWN_OK ? 0 : hewn_report_misuse(command, &error);
}

const hewn_command hewn_command_atlas = {
    .name = "atlas",
    .summary = "draw the letters of a font as distances into one image",
    .usage = "FONT -o FILE.png [--json FILE.json] [OPTION]...",
    .about = "Makes a glyph atlas: the letters of a font (.ttf, .otf, .ttc, .woff) beside one\n"
             "another in an image, each texel the distance to the outline. A shader draws them\n"
             "sharp at any size: of three distances in red, green and blue (msdf) it takes the\n"
             "middle one, and where that is above one half there is ink.\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .after = "Examples:\n"
             "  hewn atlas DejaVuSans.ttf -o sans.png --json sans.json\n"
             "  hewn atlas DejaVuSans.ttf -o sans.png --json sans.json --type mtsdf \\\n"
             "    --size 48 --range 6 --charset latin1 --chars €\n",
    .run = run,
};
