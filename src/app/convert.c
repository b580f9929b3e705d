#include "app/file_arguments.h"
#include "app/file_command.h"
#include "app/label_command.h"
#include "app/smooth_arguments.h"

static const hewn_option options[] = {
    HEWN_OPTION_OUTPUT,
    {0, "smooth", "METHOD",
     "Smooth it on the way by taubin, laplacian, cotan, implicit, bilateral or hc with their defaults; `hewn smooth` "
     "has "
     "their parameters."},
    HEWN_OPTIONS_LABELS,
    HEWN_OPTIONS_VOLUME,
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
    const char *method = hewn_arguments_value(arguments, "smooth");
    if (!method)
        return HEWN_OK;
    desc->smooth = &steps->smooth;
    return hewn_smooth_method_parse(method, "--smooth", &steps->smooth.desc.method, error);
}

static void print(const hewn_file_job_desc *desc, const hewn_file_report *report)
{
    if (desc->smooth)
        hewn_smooth_print(report);
}

static int run(const hewn_command *command, const hewn_arguments *arguments)
{
    if (hewn_label_arguments_any(arguments))
        return hewn_label_command_run(command, arguments);
    return hewn_file_command_run(command, arguments, &(hewn_file_command){read, print});
}

const hewn_command hewn_command_convert = {
    .name = "convert",
    .summary = "write a mesh in another format, unit or axes; mesh labels",
    .usage = "FILE -o FILE [OPTION]...",
    .about = "Reads a mesh (.glb, .gltf, .obj, .ply, .stl, .off, also with .gz) and writes it\n"
             "as it is: polygons, order of vertices, attributes and double precision stay\n"
             "where the format can hold them, and what it cannot is named. Unit and axes\n"
             "change only as asked, or as the format demands; what was done is told exactly.\n"
             "\n"
             "With --labels it reads a volume of labels and writes the surface of each: all\n"
             "are made at once, closed and manifold, and neighbours fit without a gap. A .glb\n"
             "file has a node a label, .obj and .ply an object; for a file a label name a\n"
             "folder (-o DIR/) or a pattern (-o {name}.stl).\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .after = "Examples:\n"
             "  hewn convert chair.obj --unit in --up +Z -o chair.glb\n"
             "  hewn convert part.stl --unit mm -o part.3mf\n"
             "  hewn convert scan.ply.gz -o - --to off | head -2\n"
             "  hewn convert brain.nii.gz --labels all --names FreeSurferLUT.txt -o brain.glb\n"
             "  hewn convert seg.nrrd --labels 1,3 -o 'parts/{label}-{name}.stl'\n",
    .run = run,
};
