#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "app/certificate.h"
#include "app/file_arguments.h"
#include "app/file_command.h"
#include "app/number.h"
#include "base/error.h"
#include "pipeline/repair_counts.h"

static const hewn_option options[] = {
    HEWN_OPTION_OUTPUT,
    {0, "weld", "T",
     "Join vertices that lie within T of each other, in the input's unit. Default: 0, those at one place."},
    {0, "no-weld", NULL, "Join no vertices."},
    {0, "fill", "N", "Fill holes of up to N edges, N being 512 at most; `all` is 512. Default: 0, no holes."},
    {0, "fill-flat", NULL, "Fill with as few triangles as can be. Default: smoothly, in the spacing of the rim."},
    {0, "strict", NULL, "Repair nothing but welding: fail where there is something to repair, saying what."},
    {0, "drop-flat", NULL, "Drop faces without area, which may open slits."},
    {0, "drop-small", "N", "Remove components of fewer than N faces."},
    {0, "drop-share", "S",
     "Remove components whose box has a diagonal below S times that of the whole mesh, S from 0 to 1."},
    {0, "outward", "WHICH",
     "Turn closed components so that they face outward: those that were inconsistent (turned), all of them, cavities "
     "too (always), or none (never). Default: turned."},
    {0, "opposite", "WHICH",
     "Of two faces with the same corners but opposite directions keep one, keep both (both), or none (none). "
     "Default: one."},
    {0, "keep-directions", NULL, "Turn no faces: cut neighbours apart that disagree."},
    {0, "keep-isolated", NULL, "Keep vertices without a face."},
    {0, "no-self-intersections", NULL, "Do not count self-intersections of the result, which takes the longest."},
    HEWN_OPTIONS_FRAME,
    HEWN_OPTION_FROM,
    HEWN_OPTION_TO,
    HEWN_OPTION_REPORT,
    HEWN_OPTION_QUIET,
    HEWN_OPTION_HELP,
};

/* --- arguments --------------------------------------------------------------------------------------------------- */

static hewn_result read_weld(const hewn_arguments *arguments, hewn_repair_desc *desc, hewn_error *error)
{
    const char *weld = hewn_arguments_value(arguments, "weld");
    desc->weld = !hewn_arguments_has(arguments, "no-weld");
    if (weld && !desc->weld)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--weld and --no-weld exclude each other");
    if (!weld)
        return HEWN_OK;
    HEWN_TRY(hewn_number_parse(weld, "--weld", &desc->weld_distance, error));
    if (desc->weld_distance < 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--weld must be at least 0, not %s", weld);
    return HEWN_OK;
}

static hewn_result read_fill(const hewn_arguments *arguments, hewn_repair_desc *desc, hewn_error *error)
{
    const char *fill = hewn_arguments_value(arguments, "fill");
    desc->fill_flat = hewn_arguments_has(arguments, "fill-flat");
    if (fill && strcmp(fill, "all") == 0)
        desc->fill_edges = HEWN_FILL_LIMIT;
    else if (fill)
        HEWN_TRY(hewn_count_parse(fill, "--fill", 0, &desc->fill_edges, error));
    if (desc->fill_edges > HEWN_FILL_LIMIT)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--fill is at most %d, not %s", HEWN_FILL_LIMIT, fill);
    return HEWN_OK;
}

static hewn_result read_small(const hewn_arguments *arguments, hewn_repair_desc *desc, hewn_error *error)
{
    const char *small = hewn_arguments_value(arguments, "drop-small");
    const char *share = hewn_arguments_value(arguments, "drop-share");
    uint32_t faces = 0;
    if (small)
        HEWN_TRY(hewn_count_parse(small, "--drop-small", 0, &faces, error));
    desc->least_faces = faces;
    if (share)
        HEWN_TRY(hewn_number_parse(share, "--drop-share", &desc->least_share, error));
    if (!(desc->least_share >= 0 && desc->least_share <= 1))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--drop-share is from 0 to 1, not %s", share);
    return HEWN_OK;
}

/* One of `count` words; the place of the given one goes to `*out`, which stays as it is where none is given. */
static hewn_result read_word(const hewn_arguments *arguments, const char *name, const char *const *words, int count,
                             int *out, hewn_error *error)
{
    const char *given = hewn_arguments_value(arguments, name);
    for (int i = 0; i < count; i++)
        if (!given || strcmp(given, words[i]) == 0) {
            *out = given ? i : *out;
            return HEWN_OK;
        }
    return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--%s is %s, %s or %s, not '%s'", name, words[0], words[1], words[2],
                     given);
}

static hewn_result read_repair(const hewn_arguments *arguments, hewn_repair_desc *desc, hewn_error *error)
{
    static const char *const outward[] = {
        [HEWN_OUTWARD_TURNED] = "turned", [HEWN_OUTWARD_NEVER] = "never", [HEWN_OUTWARD_ALWAYS] = "always"};
    static const char *const opposite[] = {
        [HEWN_OPPOSITE_ONE] = "one", [HEWN_OPPOSITE_KEEP] = "both", [HEWN_OPPOSITE_CANCEL] = "none"};
    *desc = hewn_repair_desc_default();
    int outward_word = desc->outward, opposite_word = desc->opposite;
    HEWN_TRY(read_weld(arguments, desc, error));
    HEWN_TRY(read_fill(arguments, desc, error));
    HEWN_TRY(read_small(arguments, desc, error));
    HEWN_TRY(read_word(arguments, "outward", outward, HEWN_OUTWARD_COUNT, &outward_word, error));
    HEWN_TRY(read_word(arguments, "opposite", opposite, HEWN_OPPOSITE_COUNT, &opposite_word, error));
    desc->outward = (hewn_outward)outward_word;
    desc->opposite = (hewn_opposite)opposite_word;
    desc->drop_flat = hewn_arguments_has(arguments, "drop-flat");
    desc->keep_directions = hewn_arguments_has(arguments, "keep-directions");
    desc->keep_isolated = hewn_arguments_has(arguments, "keep-isolated");
    desc->strict = hewn_arguments_has(arguments, "strict");
    return HEWN_OK;
}

/* --- the command ------------------------------------------------------------------------------------------------- */

/* Counts that are 0 are left to the report. */
static void print_counts(const hewn_repair_report *repair)
{
    const hewn_repair_count *count;
    bool any = false;
    for (size_t i = 0; (count = hewn_repair_count_at(i)) != NULL; i++) {
        uint64_t value = hewn_repair_count_of(repair, count);
        if (value > 0)
            fprintf(stderr, "  %-38s %" PRIu64 "\n", count->text, value);
        any = any || value > 0;
    }
    if (!any)
        fprintf(stderr, "  nothing to repair\n");
}

static void print_summary(const hewn_file_job_desc *desc, const hewn_file_report *report)
{
    (void)desc;
    print_counts(&report->repair);
    hewn_certificate_summarise(report->check, report->conversion.unit_after, stderr);
}

static hewn_result read(const hewn_arguments *arguments, hewn_file_steps *steps, hewn_file_job_desc *desc,
                        hewn_error *error)
{
    desc->repair = &steps->repair;
    desc->check = true;
    desc->skip_self_intersections = hewn_arguments_has(arguments, "no-self-intersections");
    return read_repair(arguments, &steps->repair, error);
}

static int run(const hewn_command *command, const hewn_arguments *arguments)
{
    return hewn_file_command_run(command, arguments, &(hewn_file_command){read, print_summary});
}

const hewn_command hewn_command_repair = {
    .name = "repair",
    .summary = "make an oriented manifold of any mesh file",
    .usage = "FILE -o FILE [OPTION]...",
    .about = "Reads a mesh (.glb, .gltf, .obj, .ply, .stl, .off, also with .gz), joins\n"
             "vertices, drops degenerate and duplicate faces, turns faces to agree, splits\n"
             "edges and vertices that are not manifold, fills holes if asked, and writes it\n"
             "with its attributes. What was done is counted, and the result examined as\n"
             "`hewn check` would. Parts may still run through each other.\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .after = "Examples:\n"
             "  hewn repair scan.stl -o scan.ply --fill 100 --drop-small 50\n"
             "  hewn repair torn.obj -o torn.obj --weld 1e-4\n"
             "  hewn repair part.stl -o part.glb --unit mm --up +Z --strict\n",
    .run = run,
};
