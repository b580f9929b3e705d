#include "app/simplify_arguments.h"

#include <inttypes.h>
#include <stdio.h>

#include "app/file_arguments.h"
#include "app/file_command.h"
#include "app/number.h"
#include "base/error.h"

static const hewn_option options[] = {
    HEWN_OPTION_OUTPUT,
    {0, "ratio", "R", "Leave this share of the triangles, above 0 to 1."},
    {0, "faces", "N", "Leave at most N triangles."},
    {0, "error", "LENGTH",
     "Go no further than LENGTH away, in the input's unit: the distance of every point of each surface from the other, "
     "which is proven before the mesh is written."},
    {0, "error-rel", "SHARE", "The same in diagonals of the input's box."},
    HEWN_OPTIONS_SIMPLIFY_MANNER,
    {0, "max-memory", "SIZE",
     "Take at most SIZE bytes of memory, as 500M or 2G: what does not fit is simplified in parts, with temporary files "
     "beside the output. Not with --no-self-intersections then."},
    HEWN_OPTIONS_FRAME,
    HEWN_OPTION_FROM,
    HEWN_OPTION_TO,
    HEWN_OPTION_REPORT,
    HEWN_OPTION_QUIET,
    HEWN_OPTION_HELP,
};

static hewn_result read(const hewn_arguments *arguments, hewn_file_steps *steps, hewn_file_job_desc *desc,
                        hewn_error *error)
{
    const char *memory = hewn_arguments_value(arguments, "max-memory");
    desc->simplify = &steps->simplify;
    if (memory)
        HEWN_TRY(hewn_bytes_parse(memory, "--max-memory", &desc->max_memory, error));
    return hewn_simplify_arguments_read(arguments, &steps->simplify, error);
}

static void print(const hewn_file_job_desc *desc, const hewn_file_report *report)
{
    (void)desc;
    hewn_simplify_print(&report->simplify);
    if (report->passes > 0)
        fprintf(stderr, "  in %" PRIu32 " %s over up to %" PRIu32 " parts; at most %.4g MB of memory\n", report->passes,
                report->passes == 1 ? "pass" : "passes", report->parts, (double)report->peak_host_bytes / 1e6);
}

static int run(const hewn_command *command, const hewn_arguments *arguments)
{
    return hewn_file_command_run(command, arguments, &(hewn_file_command){read, print});
}

const hewn_command hewn_command_simplify = {
    .name = "simplify",
    .summary = "make a mesh file of fewer triangles",
    .usage = "FILE -o FILE [OPTION]...",
    .about = "Reads a mesh (.glb, .gltf, .obj, .ply, .stl, .off, also with .gz), collapses its\n"
             "edges, those first that change its shape least, and writes it with its\n"
             "attributes. A manifold mesh stays manifold, with as many parts, holes and\n"
             "handles as before.\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .after = "Examples:\n"
             "  hewn simplify scan.ply -o small.glb --ratio 0.1\n"
             "  hewn simplify part.stl -o part.stl --error 0.05 --lock features:30\n"
             "  hewn simplify chair.obj -o small.obj --faces 2000 --report report.json\n"
             "  hewn simplify city.ply -o city.glb --ratio 0.01 --max-memory 2G\n",
    .run = run,
};
