#include <stdio.h>

#include "app/app.h"
#include "app/file_arguments.h"
#include "app/record.h"
#include "app/smooth_arguments.h"

static const hewn_option options[] = {
    HEWN_OPTION_OUTPUT,
    {0, "method", "NAME",
     "taubin (hardly shrinks), laplacian, cotan (mean curvature flow), implicit (the same, stable for any step), "
     "bilateral (keeps sharp edges) or hc. Default: taubin."},
    {0, "iterations", "N", "Take N steps. Default: 10; implicit 1; bilateral 6."},
    {0, "strength", "S",
     "taubin, laplacian: go this share of the way to the mean of the neighbours in a step, up to 1. Default: 0.5."},
    {0, "passband", "K",
     "taubin: keep shapes whose eigenvalue of the mesh's normalised Laplacian (0 to 2) is below K. Default: 0.02."},
    {0, "step", "LENGTH",
     "cotan, implicit: smooth as a Gaussian of this deviation in each step, in the input's unit. Default: the mean "
     "edge."},
    {0, "angle", "DEGREES", "bilateral: faces that bend by much more do not mix. Default: 15."},
    {0, "radius", "LENGTH",
     "bilateral: faces that are much further apart do not mix. Default: the mean distance of neighbours."},
    {0, "original", "A", "hc: draw vertices to where they were at first, from 0 to 1. Default: 0."},
    {0, "push", "B", "hc: the share of that pull taken from the vertex itself, from 0 to 1. Default: 0.5."},
    {0, "lock", "LIST",
     "What stays, with commas between: boundary, features:ANGLE (edges that bend by more), labels (where faces differ "
     "in label, material, group or object)."},
    {0, "keep-volume", NULL, "Give each closed component its volume back by an offset."},
    {0, "mask", "NAME", "Scale each vertex' move by this vertex attribute, from 0 to 1 (bytes: to 255)."},
    HEWN_OPTIONS_FRAME,
    HEWN_OPTION_FROM,
    HEWN_OPTION_TO,
    HEWN_OPTION_REPORT,
    HEWN_OPTION_QUIET,
    HEWN_OPTION_HELP,
};

static int run(const hewn_command *command, const hewn_arguments *arguments)
{
    hewn_error error = {0};
    hewn_file_arguments file;
    hewn_file_smooth smooth;
    hewn_result result = hewn_file_arguments_read(arguments, &file, &error);
    if (result == HEWN_OK)
        result = hewn_smooth_arguments_read(arguments, &smooth, &error);
    if (result != HEWN_OK)
        return hewn_report_misuse(command, &error);
    hewn_signals_catch();
    hewn_progress progress = hewn_progress_begin(file.quiet);
    hewn_file_report report;
    file.desc.smooth = &smooth;
    file.desc.progress = &progress;
    file.desc.began = hewn_started();
    result = hewn_file_convert(&file.desc, &report, &error);
    hewn_progress_end();
    if (result != HEWN_OK)
        return hewn_report_misuse(command, &error);
    if (!file.quiet) {
        hewn_record_print(&report);
        hewn_smooth_print(&report);
        hewn_notes_print(&file.desc, &report);
    }
    hewn_file_report_destroy(&report);
    return 0;
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
