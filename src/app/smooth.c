#include "app/file_arguments.h"
#include "app/file_command.h"
#include "app/smooth_arguments.h"

static const hewn_option options[] = {
    HEWN_OPTION_OUTPUT,
    {0, "method", "NAME",
     "taubin (hardly shrinks), laplacian, cotan (mean curvature flow), implicit (the same, stable for any step), "
     "bilateral (keeps sharp edges) or hc. Default: taubin."},
    {0, "iterations", "N", "Take N steps. Default: 10; implicit 1; bilateral 8."},
    {0, "strength", "S",
     "taubin, laplacian: go this share of the way to the mean of the neighbours in a step, up to 1. Default: 0.5."},
    {0, "passband", "K",
     "taubin: keep shapes whose eigenvalue of the mesh's normalised Laplacian (0 to 2) is below K. Default: 0.02."},
    {0, "step", "LENGTH",
     "cotan, implicit: smooth as a Gaussian of this deviation in each step, in the input's unit. Default: the mean "
     "edge."},
    {0, "remeasure", "N",
     "cotan, implicit: measure weights and areas anew before each Nth step. Default: at the start only."},
    {0, "angle", "DEGREES", "bilateral: faces that bend by much more do not mix. Default: 20."},
    {0, "radius", "LENGTH",
     "bilateral: faces that are much further apart do not mix. Default: the mean distance of neighbours."},
    {0, "original", "A", "hc: draw vertices to where they were at first, from 0 to 1. Default: 0."},
    {0, "push", "B", "hc: the share of that pull taken from the vertex itself, from 0 to 1. Default: 0.5."},
    {0, "lock", "LIST",
     "What stays, with commas between: boundary, features:ANGLE (edges that bend by more), labels (where faces differ "
     "in label, material, group or object)."},
    {0, "keep-volume", NULL, "Give each closed component its volume back by an offset. taubin does so by default."},
    {0, "free-volume", NULL, "Do not."},
    {0, "mask", "NAME", "Scale each vertex' move by this vertex attribute, from 0 to 1 (bytes: to 255)."},
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
    desc->smooth = &steps->smooth;
    return hewn_smooth_arguments_read(arguments, &steps->smooth, error);
}

static void print(const hewn_file_job_desc *desc, const hewn_file_report *report)
{
    (void)desc;
    hewn_smooth_print(&report->smooth, report->smooth_method);
}

static int run(const hewn_command *command, const hewn_arguments *arguments)
{
    return hewn_file_command_run(command, arguments, &(hewn_file_command){read, print});
}

const hewn_command hewn_command_smooth = {
    .name = "smooth",
    .summary = "smooth a mesh file",
    .usage = "FILE -o FILE [OPTION]...",
    .about = "Reads a mesh (.glb, .gltf, .obj, .ply, .stl, .off, also with .gz), moves its\n"
             "vertices, and writes it with its attributes; normals are made anew. Faces and\n"
             "their connections stay, so any mesh will do, open and non-manifold ones too.\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .after = "Examples:\n"
             "  hewn smooth scan.ply -o smooth.ply --iterations 30\n"
             "  hewn smooth part.stl -o part.stl --method bilateral\n"
             "  hewn smooth bone.obj -o bone.obj --method implicit --step 0.5 --keep-volume\n",
    .run = run,
};
