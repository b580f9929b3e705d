#include "app/file_arguments.h"
#include "app/file_command.h"
#include "app/simplify_arguments.h"
#include "app/smooth_arguments.h"
#include "base/error.h"

static const hewn_option options[] = {
    HEWN_OPTION_OUTPUT,
    HEWN_OPTION_SIMPLIFY,
    {0, "smooth", "METHOD",
     "Smooth it on the way by taubin, laplacian, cotan, implicit, bilateral or hc with their defaults; `hewn smooth` "
     "has "
     "their parameters."},
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
    bool simplify;
    HEWN_TRY(hewn_simplify_target_read(arguments, &steps->simplify, &simplify, error));
    desc->simplify = simplify ? &steps->simplify : NULL;
    steps->simplify.measure = simplify && desc->report;
    const char *method = hewn_arguments_value(arguments, "smooth");
    if (!method)
        return HEWN_OK;
    desc->smooth = &steps->smooth;
    return hewn_smooth_method_parse(method, "--smooth", &steps->smooth.desc.method, error);
}

static void print(const hewn_file_job_desc *desc, const hewn_file_report *report)
{
    if (desc->simplify)
        hewn_simplify_print(&report->simplify);
    if (desc->smooth)
        hewn_smooth_print(report);
}

static int run(const hewn_command *command, const hewn_arguments *arguments)
{
    return hewn_file_command_run(command, arguments, &(hewn_file_command){read, print});
}

const hewn_command hewn_command_convert = {
    .name = "convert",
    .summary = "write a mesh file in another format, unit or axes",
    .usage = "FILE -o FILE [OPTION]...",
    .about = "Reads a mesh (.glb, .gltf, .obj, .ply, .stl, .off, also with .gz) and writes it\n"
             "as it is: polygons, order of vertices, attributes and double precision stay\n"
             "where the format can hold them, and what it cannot is named. Unit and axes\n"
             "change only as asked, or as the format demands; what was done is told exactly.\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .after = "Examples:\n"
             "  hewn convert chair.obj --unit in --up +Z -o chair.glb\n"
             "  hewn convert part.stl --unit mm -o part.3mf\n"
             "  hewn convert scan.ply.gz -o - --to off | head -2\n",
    .run = run,
};
