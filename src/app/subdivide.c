#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "app/file_arguments.h"
#include "app/file_command.h"
#include "app/number.h"
#include "base/error.h"

static const hewn_option options[] = {
    HEWN_OPTION_OUTPUT,
    {0, "scheme", "NAME", "catmull-clark, loop (triangles only) or bilinear. Default: catmull-clark."},
    {0, "levels", "N", "Refine N times, 16 at most; each makes four faces of one. 0 only with --limit. Default: 1."},
    {0, "limit", NULL, "Put vertices where infinitely many levels would put them, with exact normals."},
    {0, "boundary", "RULE",
     "Boundaries become smooth curves with sharp corners (edge-and-corner) or none (edge-only), or faces that touch "
     "them are left out (none). Default: edge-and-corner."},
    {0, "creases", "FILE",
     "Take creases and sharp vertices from the `t crease` and `t corner` lines of FILE, which may be the input."},
    {0, "crease-angle", "DEGREES", "Make edges sharp whose faces bend by more."},
    {0, "creasing", "RULE", "How sharpness falls from level to level: uniform or chaikin. Default: uniform."},
    {0, "uv", "RULE",
     "Where corner attributes are interpolated linearly: corners-plus1, corners-only, corners-plus2, boundaries, all "
     "or none. Default: corners-plus1."},
    {0, "triangulate", NULL, "Cut polygons into triangles first."},
    {0, "adaptive", "ERROR",
     "Keep larger faces where they lie within ERROR of the next level, in the input's unit; their neighbours' vertices "
     "become theirs too, so nothing cracks."},
    {0, "max-memory", "SIZE",
     "Refuse levels that take more, such as 512M, before any is made. Default: what the machine has."},
    HEWN_OPTIONS_FRAME,
    HEWN_OPTION_FROM,
    HEWN_OPTION_TO,
    HEWN_OPTION_REPORT,
    HEWN_OPTION_QUIET,
    HEWN_OPTION_HELP,
};

/* --- arguments --------------------------------------------------------------------------------------------------- */

static const char *scheme_name(int i)
{
    return hewn_scheme_name((hewn_scheme)i);
}
static const char *boundary_name(int i)
{
    return hewn_subdivide_boundary_name((hewn_subdivide_boundary)i);
}
static const char *creasing_name(int i)
{
    return hewn_creasing_name((hewn_creasing)i);
}
static const char *uv_name(int i)
{
    return hewn_uv_rule_name((hewn_uv_rule)i);
}

/* One of the words that `word` tells until NULL; 0 where none is given. */
static hewn_result read_word(const hewn_arguments *arguments, const char *name, const char *(*word)(int),
                             const char *all, int *out, hewn_error *error)
{
    const char *given = hewn_arguments_value(arguments, name);
    *out = 0;
    if (!given)
        return HEWN_OK;
    for (; word(*out); (*out)++)
        if (strcmp(word(*out), given) == 0)
            return HEWN_OK;
    return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--%s is %s, not '%s'", name, all, given);
}

static hewn_result read_rules(const hewn_arguments *arguments, hewn_subdivide_desc *desc, hewn_error *error)
{
    int scheme, boundary, creasing, uv;
    HEWN_TRY(read_word(arguments, "scheme", scheme_name, "catmull-clark, loop or bilinear", &scheme, error));
    HEWN_TRY(read_word(arguments, "boundary", boundary_name, "edge-and-corner, edge-only or none", &boundary, error));
    HEWN_TRY(read_word(arguments, "creasing", creasing_name, "uniform or chaikin", &creasing, error));
    HEWN_TRY(read_word(arguments, "uv", uv_name, "corners-plus1, none, corners-only, corners-plus2, boundaries or all",
                       &uv, error));
    desc->scheme = (hewn_scheme)scheme;
    desc->boundary = (hewn_subdivide_boundary)boundary;
    desc->creasing = (hewn_creasing)creasing;
    desc->uv = (hewn_uv_rule)uv;
    return HEWN_OK;
}

static hewn_result read_levels(const hewn_arguments *arguments, hewn_subdivide_desc *desc, hewn_error *error)
{
    const char *levels = hewn_arguments_value(arguments, "levels");
    desc->limit = hewn_arguments_has(arguments, "limit");
    desc->levels = 1;
    if (levels)
        HEWN_TRY(hewn_count_parse(levels, "--levels", 0, &desc->levels, error));
    if (desc->levels > HEWN_MOST_LEVELS)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--levels is at most %d, not %s", HEWN_MOST_LEVELS, levels);
    if (desc->levels == 0 && !desc->limit)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--levels 0 needs --limit");
    desc->levels = desc->levels ? desc->levels : HEWN_LEVELS_NONE;
    return HEWN_OK;
}

static hewn_result read_subdivide(const hewn_arguments *arguments, hewn_file_steps *steps, hewn_file_job_desc *desc,
                                  hewn_error *error)
{
    hewn_file_subdivide *out = &steps->subdivide;
    desc->subdivide = out;
    const char *angle = hewn_arguments_value(arguments, "crease-angle");
    const char *adaptive = hewn_arguments_value(arguments, "adaptive");
    const char *memory = hewn_arguments_value(arguments, "max-memory");
    HEWN_TRY(read_rules(arguments, &out->desc, error));
    HEWN_TRY(read_levels(arguments, &out->desc, error));
    if (angle)
        HEWN_TRY(hewn_number_parse(angle, "--crease-angle", &out->desc.crease_angle, error));
    if (!(out->desc.crease_angle >= 0 && out->desc.crease_angle <= 180))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--crease-angle is from 0 to 180 degrees, not %s", angle);
    if (adaptive)
        HEWN_TRY(hewn_number_parse(adaptive, "--adaptive", &out->adaptive, error));
    if (adaptive && !(out->adaptive > 0))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--adaptive must be greater than 0, not %s", adaptive);
    if (memory)
        HEWN_TRY(hewn_bytes_parse(memory, "--max-memory", &out->desc.max_memory, error));
    out->creases = hewn_arguments_value(arguments, "creases");
    out->triangulate = hewn_arguments_has(arguments, "triangulate");
    return HEWN_OK;
}

/* --- the command ------------------------------------------------------------------------------------------------- */

static void print_summary(const hewn_file_job_desc *desc, const hewn_file_report *report)
{
    (void)desc;
    const hewn_subdivide_report *done = &report->subdivide;
    fprintf(stderr, "  %s, %" PRIu32 " %s from %" PRIu64 " faces", hewn_scheme_name(report->scheme), done->levels,
            done->levels == 1 ? "level" : "levels", report->faces_before);
    if (done->creases > 0 || done->corners > 0)
        fprintf(stderr, "; %" PRIu64 " creased edges, %" PRIu64 " sharp vertices", done->creases, done->corners);
    if (done->adaptive_faces > 0)
        fprintf(stderr, "; %" PRIu64 " faces of lower levels", done->adaptive_faces);
    if (done->dropped_faces > 0)
        fprintf(stderr, "; %" PRIu64 " faces at boundaries left out", done->dropped_faces);
    fputc('\n', stderr);
}

static int run(const hewn_command *command, const hewn_arguments *arguments)
{
    return hewn_file_command_run(command, arguments, &(hewn_file_command){read_subdivide, print_summary});
}

const hewn_command hewn_command_subdivide = {
    .name = "subdivide",
    .summary = "refine a mesh file to a smooth surface",
    .usage = "FILE -o FILE [OPTION]...",
    .about = "Reads a mesh (.glb, .gltf, .obj, .ply, .stl, .off, also with .gz), refines it as\n"
             "a subdivision surface with the rules of OpenSubdiv, and writes it with its\n"
             "attributes. It must be manifold: `hewn repair` makes it so.\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .after = "Examples:\n"
             "  hewn subdivide cage.obj -o smooth.obj --levels 3 --creases cage.obj\n"
             "  hewn subdivide scan.ply -o fine.ply --scheme loop --limit\n"
             "  hewn subdivide part.off -o part.glb --crease-angle 30 --adaptive 0.01\n",
    .run = run,
};
