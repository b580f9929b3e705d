#include <stdio.h>

#include "app/app.h"
#include "app/file_arguments.h"
#include "app/record.h"
#include "app/smooth_arguments.h"

static const hewn_option options[] = {
    HEWN_OPTION_OUTPUT,
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

static int run(const hewn_command *command, const hewn_arguments *arguments)
{
    hewn_error error = {0};
    hewn_file_arguments file;
    hewn_file_smooth smooth = {0};
    const char *method = hewn_arguments_value(arguments, "smooth");
    hewn_result result = hewn_file_arguments_read(arguments, &file, &error);
    if (result == HEWN_OK && method)
        result = hewn_smooth_method_parse(method, "--smooth", &smooth.desc.method, &error);
    if (result != HEWN_OK)
        return hewn_report_misuse(command, &error);
    hewn_signals_catch();
    hewn_progress progress = hewn_progress_begin(file.quiet);
    hewn_file_report report;
    file.desc.smooth = method ? &smooth : NULL;
    file.desc.progress = &progress;
    file.desc.began = hewn_started();
    result = hewn_file_convert(&file.desc, &report, &error);
    hewn_progress_end();
    if (result != HEWN_OK)
        return hewn_report_misuse(command, &error);
    if (!file.quiet) {
        hewn_record_print(&report);
        if (method)
            hewn_smooth_print(&report);
        hewn_notes_print(&file.desc, &report);
    }
    hewn_file_report_destroy(&report);
    return 0;
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
