#include "hewn/atlas_job.h"

#include <stdio.h>
#include <string.h>

#include "atlas/charset.h"
#include "base/alloc.h"
#include "base/clock.h"
#include "base/error.h"
#include "base/file.h"
#include "base/progress.h"
#include "io/png_write.h"
#include "pipeline/atlas_json.h"
#include "pipeline/paths.h"

enum { MOST_BYTES = 1 << 26 };

/* --- characters ----------------------------------------------------------------------------------------------------
 */

/* A file of a charset's description or of plain text. */
static hewn_result add_file(hewn_charset *set, const char *path,
                            hewn_result (*add)(hewn_charset *set, const char *text, hewn_error *error),
                            hewn_error *error)
{
    char *bytes;
    size_t length;
    hewn_error reason = {0};
    HEWN_TRY(hewn_blame_input(hewn_file_read(path, MOST_BYTES, &bytes, &length, error), path, error));
    hewn_result result =
        strlen(bytes) == length ? add(set, bytes, &reason) : hewn_fail(&reason, HEWN_BAD_INPUT, "a text has no byte 0");
    hewn_free(bytes);
    return result == HEWN_OK ? HEWN_OK
                             : hewn_fail_at(error, result, strcmp(path, "-") == 0 ? "standard input" : path,
                                            reason.line, "%s", reason.message);
}

static hewn_result add_charset(hewn_charset *set, const char *name, const hewn_font *font, hewn_error *error)
{
    bool known;
    HEWN_TRY(hewn_charset_add_named(set, name, font, &known, error));
    return known ? HEWN_OK : add_file(set, name, hewn_charset_add_description, error);
}

static hewn_result add_text(hewn_charset *set, const char *text, hewn_error *error)
{
    if (text[0] == '@' && text[1] != '\0')
        return add_file(set, text + 1, hewn_charset_add_text, error);
    hewn_error reason = {0};
    hewn_result result = hewn_charset_add_text(set, text, &reason);
    return result == HEWN_OK ? HEWN_OK
                             : hewn_fail(error, result == HEWN_BAD_INPUT ? HEWN_INVALID_ARGUMENT : result,
                                         "the text of characters: %s", reason.message);
}

static hewn_result gather(const hewn_atlas_job_desc *desc, const hewn_font *font, hewn_charset *set, hewn_error *error)
{
    for (size_t i = 0; i < desc->charset_count; i++)
        HEWN_TRY(add_charset(set, desc->charsets[i], font, error));
    for (size_t i = 0; i < desc->text_count; i++)
        HEWN_TRY(add_text(set, desc->texts[i], error));
    if (desc->charset_count == 0 && desc->text_count == 0)
        HEWN_TRY(add_charset(set, "ascii", font, error));
    return set->count > 0 ? HEWN_OK : hewn_fail(error, HEWN_INVALID_ARGUMENT, "the set of characters is empty");
}

/* --- files ---------------------------------------------------------------------------------------------------------
 */

static hewn_result write_files(const hewn_atlas_job_desc *desc, const hewn_atlas *atlas, hewn_output *outputs[2],
                               hewn_error *error)
{
    HEWN_TRY(hewn_progress_report(desc->atlas.progress, "write", 0, error));
    HEWN_TRY(hewn_output_create(desc->output, &outputs[0], error));
    if (desc->json)
        HEWN_TRY(hewn_output_create(desc->json, &outputs[1], error));
    HEWN_TRY(hewn_png_write_bytes(outputs[0], atlas->texels, atlas->width, atlas->height, atlas->channels, error));
    HEWN_TRY(hewn_output_settle(outputs[0], error));
    if (desc->json) {
        hewn_text text = {0};
        hewn_atlas_write_json(atlas, desc->y_down, &text);
        hewn_result result = hewn_text_status(&text, error);
        if (result == HEWN_OK)
            result = hewn_output_write(outputs[1], text.bytes, text.length, error);
        hewn_text_clear(&text);
        HEWN_TRY(result);
        HEWN_TRY(hewn_output_settle(outputs[1], error));
    }
    HEWN_TRY(hewn_output_finish(&outputs[0], error));
    return desc->json ? hewn_output_finish(&outputs[1], error) : HEWN_OK;
}

static hewn_result check(const hewn_atlas_job_desc *desc, hewn_error *error)
{
    if (!desc->font || !desc->output)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a job needs a font and an output");
    if (desc->json && strcmp(desc->json, desc->output) == 0 && strcmp(desc->json, "-") == 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the image and the JSON cannot both go to standard output");
    if (desc->json && strcmp(desc->json, desc->output) == 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the image and the JSON cannot be the same file");
    HEWN_TRY(hewn_output_check(desc->output, error));
    return desc->json ? hewn_output_check(desc->json, error) : HEWN_OK;
}

static hewn_result make(const hewn_atlas_job_desc *desc, hewn_font *font, hewn_atlas *out, hewn_error *error)
{
    hewn_charset set = {0};
    hewn_atlas_desc own = desc->atlas;
    hewn_error reason = {0};
    uint32_t *characters = NULL;
    hewn_result result = gather(desc, font, &set, error);
    if (result == HEWN_OK)
        result = hewn_charset_list(&set, &characters, error);
    own.characters = characters;
    own.character_count = set.count;
    if (result == HEWN_OK) {
        result = hewn_atlas_create(font, &own, out, &reason);
        if (result == HEWN_BAD_INPUT)
            hewn_fail_at(error, result, desc->font, 0, "%s", reason.message);
        else if (result != HEWN_OK && error)
            *error = reason;
    }
    hewn_free(characters);
    hewn_charset_clear(&set);
    return result;
}

hewn_result hewn_atlas_file(const hewn_atlas_job_desc *desc, hewn_atlas_report *out, hewn_error *error)
{
    hewn_font *font = NULL;
    hewn_output *outputs[2] = {NULL, NULL};
    double began = hewn_clock_now();
    *out = (hewn_atlas_report){0};
    hewn_result result = check(desc, error);
    if (result == HEWN_OK)
        result = hewn_blame_input(hewn_font_open(desc->font, desc->face, &font, error), desc->font, error);
    if (result == HEWN_OK)
        result = make(desc, font, &out->atlas, error);
    if (result == HEWN_OK)
        result = write_files(desc, &out->atlas, outputs, error);
    hewn_output_destroy(&outputs[0]);
    hewn_output_destroy(&outputs[1]);
    if (font)
        snprintf(out->font, sizeof out->font, "%s", hewn_font_name(font));
    hewn_font_destroy(&font);
    hewn_free(out->atlas.texels);
    out->atlas.texels = NULL;
    out->seconds = hewn_clock_now() - began;
    if (result != HEWN_OK)
        hewn_atlas_report_destroy(out);
    return result;
}

void hewn_atlas_report_destroy(hewn_atlas_report *report)
{
    hewn_atlas_destroy(&report->atlas);
    *report = (hewn_atlas_report){0};
}
