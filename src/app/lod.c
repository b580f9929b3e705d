#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/app.h"
#include "app/file_arguments.h"
#include "app/number.h"
#include "app/simplify_arguments.h"
#include "base/error.h"

enum { MOST_LEVELS = 64 };

static const hewn_option options[] = {
    {'o', "output", "FILE",
     "Write a .glb file with all levels, with {level} in the name a file a level (.glb, .obj, .ply, .stl, .off, "
     ".3mf), or a .hpm file, a progressive mesh. Required."},
    {0, "levels", "LIST",
     "Levels with these shares of the triangles, falling, with commas between; 1 is the mesh itself. Default: "
     "1,0.5,0.25,0.125."},
    {0, "errors", "LIST",
     "Levels that go no further than these lengths away, rising, in the input's unit, which is proven; 0 is the mesh "
     "itself."},
    {0, "pixels", "P",
     "Levels in a GLB file are meant for sizes at which their error shows as P lines of a picture or less. Default: "
     "1."},
    {0, "lines", "N", "That picture has N lines. Default: 1080."},
    {0, "faces", "N",
     "The progressive mesh begins with N triangles, or as many more as it must; or, where the input is one, take its "
     "mesh of at most N."},
    {0, "error", "LENGTH", "Take the coarsest measured mesh of a progressive one that is proven to be this near."},
    {0, "clusters", NULL,
     "Write a .glb file with the mesh cut into clusters, and a hierarchy of coarser ones in its extras, for renderers "
     "that choose levels by the cluster."},
    {0, "cluster-size", "V,T", "Clusters have at most V vertices and T triangles. Default: 64,124."},
    {0, "partial", NULL, "Take a progressive mesh that is cut off as far as it goes."},
    HEWN_OPTIONS_SIMPLIFY_MANNER,
    HEWN_OPTIONS_FRAME,
    HEWN_OPTION_FROM,
    {0, "to", "FORMAT", "Write the levels as glb, obj, ply, stl, off or 3mf. Default: by the output's extension."},
    HEWN_OPTION_REPORT,
    HEWN_OPTION_QUIET,
    HEWN_OPTION_HELP,
};

typedef struct lod_request {
    hewn_file_arguments file;
    hewn_lod_job_desc desc;
    hewn_progressive_job_desc progressive;
    hewn_clusters_job_desc clusters;
    bool is_progressive, is_clusters; /* the job is that; else it is levels */
    double numbers[MOST_LEVELS];
} lod_request;

/* --- the command line --------------------------------------------------------------------------------------------- */

static hewn_result read_numbers(const char *text, const char *option, double *out, uint32_t *count, hewn_error *error)
{
    char number[64];
    *count = 0;
    for (const char *at = text; at;) {
        size_t length = strcspn(at, ",");
        if (*count == MOST_LEVELS)
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "%s takes %d numbers at the most", option, MOST_LEVELS);
        if (length >= sizeof number)
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "%s takes numbers, not '%s'", option, at);
        memcpy(number, at, length);
        number[length] = '\0';
        HEWN_TRY(hewn_number_parse(number, option, &out[(*count)++], error));
        at = at[length] ? at + length + 1 : NULL;
    }
    return HEWN_OK;
}

static hewn_result read_levels(const hewn_arguments *arguments, lod_request *request, hewn_error *error)
{
    const char *levels = hewn_arguments_value(arguments, "levels"), *errors = hewn_arguments_value(arguments, "errors");
    hewn_lod_desc *desc = &request->desc.levels;
    if (levels && errors)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--levels and --errors exclude each other");
    HEWN_TRY(read_numbers(errors   ? errors
                          : levels ? levels
                                   : "1,0.5,0.25,0.125",
                          errors ? "--errors" : "--levels", request->numbers, &desc->count, error));
    desc->ratios = errors ? NULL : request->numbers;
    desc->errors = errors ? request->numbers : NULL;
    return hewn_lod_desc_check(desc, error);
}

static hewn_result read_positive(const hewn_arguments *arguments, const char *name, double *out, hewn_error *error)
{
    const char *text = hewn_arguments_value(arguments, name);
    if (!text)
        return HEWN_OK;
    HEWN_TRY(hewn_number_parse(text, name, out, error));
    return *out > 0 ? HEWN_OK
                    : hewn_fail(error, HEWN_INVALID_ARGUMENT, "--%s must be greater than 0, not %s", name, text);
}

static hewn_result refuse(const hewn_arguments *arguments, const char *const *names, const char *why, hewn_error *error)
{
    for (; *names; names++)
        if (hewn_arguments_has(arguments, *names))
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--%s %s", *names, why);
    return HEWN_OK;
}

static hewn_result read_progressive(const hewn_arguments *arguments, lod_request *out, hewn_error *error)
{
    static const char *const levels[] = {
        "levels", "errors", "pixels", "lines", "lock", "preserve", "no-self-intersections", NULL};
    const char *faces = hewn_arguments_value(arguments, "faces");
    const hewn_file_job_desc *file = &out->file.desc;
    uint32_t count = 0;
    HEWN_TRY(refuse(arguments, levels, "is for levels, not for progressive meshes", error));
    if (faces)
        HEWN_TRY(hewn_count_parse(faces, "--faces", 1, &count, error));
    out->progressive = (hewn_progressive_job_desc){.input = file->input,
                                                   .from = file->from,
                                                   .output = file->output,
                                                   .to = file->to,
                                                   .report = file->report,
                                                   .unit = file->unit,
                                                   .up = file->up,
                                                   .to_unit = file->to_unit,
                                                   .to_up = file->to_up,
                                                   .faces = count,
                                                   .partial = hewn_arguments_has(arguments, "partial")};
    return read_positive(arguments, "error", &out->progressive.error, error);
}

/* A progressive mesh is made where the output is one, and taken from where the input is one and no levels are asked
 * for. */
static bool is_progressive(const hewn_arguments *arguments, const hewn_file_job_desc *file)
{
    const hewn_mesh_format from = file->from != HEWN_MESH_UNKNOWN ? file->from : hewn_mesh_format_of(file->input);
    const hewn_mesh_format to = file->to != HEWN_MESH_UNKNOWN ? file->to : hewn_mesh_format_of(file->output);
    const bool levels = hewn_arguments_has(arguments, "levels") || hewn_arguments_has(arguments, "errors");
    return to == HEWN_MESH_HPM || (from == HEWN_MESH_HPM && !levels);
}

static hewn_result read_clusters(const hewn_arguments *arguments, lod_request *out, hewn_error *error)
{
    static const char *const others[] = {"levels",   "errors", "pixels", "lines",   "lock",
                                         "preserve", "faces",  "error",  "partial", "no-self-intersections",
                                         NULL};
    const char *size = hewn_arguments_value(arguments, "cluster-size");
    const hewn_file_job_desc *file = &out->file.desc;
    double numbers[MOST_LEVELS];
    uint32_t count = 0;
    HEWN_TRY(refuse(arguments, others, "does not go with --clusters", error));
    out->clusters = (hewn_clusters_job_desc){.input = file->input,
                                             .from = file->from,
                                             .output = file->output,
                                             .to = file->to,
                                             .report = file->report,
                                             .unit = file->unit,
                                             .up = file->up,
                                             .to_unit = file->to_unit,
                                             .to_up = file->to_up};
    if (!size)
        return HEWN_OK;
    HEWN_TRY(read_numbers(size, "--cluster-size", numbers, &count, error));
    if (count != 2 || !(numbers[0] >= 3 && numbers[0] <= 255 && numbers[1] >= 1 && numbers[1] <= 512))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "--cluster-size is V,T: 3 to 255 vertices and 1 to 512 triangles, not %s", size);
    out->clusters.clusters.vertices = (uint32_t)numbers[0];
    out->clusters.clusters.triangles = (uint32_t)numbers[1];
    return HEWN_OK;
}

static hewn_result read_request(const hewn_arguments *arguments, lod_request *out, hewn_error *error)
{
    static const char *const taking[] = {"faces", "error", "partial", NULL};
    static const char *const sizes[] = {"cluster-size", NULL};
    *out = (lod_request){0};
    HEWN_TRY(hewn_file_arguments_read(arguments, &out->file, error));
    const hewn_file_job_desc *file = &out->file.desc;
    out->is_clusters = hewn_arguments_has(arguments, "clusters");
    if (out->is_clusters)
        return read_clusters(arguments, out, error);
    HEWN_TRY(refuse(arguments, sizes, "goes with --clusters only", error));
    out->is_progressive = is_progressive(arguments, file);
    if (out->is_progressive)
        return read_progressive(arguments, out, error);
    HEWN_TRY(refuse(arguments, taking, "is for progressive meshes (.hpm), not for levels", error));
    out->desc = (hewn_lod_job_desc){.input = file->input,
                                    .from = file->from,
                                    .output = file->output,
                                    .to = file->to,
                                    .report = file->report,
                                    .unit = file->unit,
                                    .up = file->up,
                                    .to_unit = file->to_unit,
                                    .to_up = file->to_up};
    HEWN_TRY(read_levels(arguments, out, error));
    HEWN_TRY(read_positive(arguments, "pixels", &out->desc.pixels, error));
    HEWN_TRY(read_positive(arguments, "lines", &out->desc.lines, error));
    return hewn_simplify_manner_read(arguments, &out->desc.levels.simplify, error);
}

/* --- running ------------------------------------------------------------------------------------------------------ */

static void print_summary(const hewn_lod_report *report)
{
    fprintf(stderr, "%s: %u levels of %" PRIu64 " triangles in %.2f s\n", report->output, report->level_count,
            report->triangles_before, report->seconds);
    for (uint32_t i = 0; i < report->level_count; i++) {
        const hewn_lod_report_level *level = &report->levels[i];
        fprintf(stderr, "  %2u %9" PRIu64 " triangles; nowhere more than %.4g away; from %.3g of the picture's height",
                i, level->triangles, level->error, level->coverage);
        fprintf(stderr, "%s%s\n", level->output ? ": " : "", level->output ? level->output : "");
        if (!level->reached)
            fprintf(stderr, "hewn: note: fewer than %" PRIu64 " triangles are not possible here\n", level->triangles);
    }
}

static void print_progressive(const hewn_progressive_report *report)
{
    const hewn_progressive_info *info = &report->info;
    if (report->to != HEWN_MESH_HPM) {
        fprintf(stderr, "%s: %" PRIu64 " triangles, %" PRIu64 " of %" PRIu64 " splits done, in %.2f s\n",
                strcmp(report->output, "-") == 0 ? "standard output" : report->output, report->triangles,
                report->splits, info->splits, report->seconds);
        if (info->splits_there < info->splits)
            fprintf(stderr, "hewn: note: the file is cut off; %" PRIu64 " splits are there\n", info->splits_there);
        return;
    }
    fprintf(stderr, "%s: %" PRIu64 " triangles and %" PRIu64 " splits to %" PRIu64 " triangles in %.2f s\n",
            strcmp(report->output, "-") == 0 ? "standard output" : report->output, info->base_triangles, info->splits,
            info->triangles, report->seconds);
    for (uint32_t i = 0; i < info->mark_count; i++)
        fprintf(stderr, "  %9" PRIu64 " triangles: nowhere more than %.4g away\n", info->marks[i].triangles,
                info->marks[i].error);
}

static hewn_result run_levels(lod_request *request, hewn_error *error)
{
    hewn_lod_report report;
    hewn_result result = hewn_lod_file(&request->desc, &report, error);
    hewn_progress_end();
    if (result == HEWN_OK && !request->file.quiet)
        print_summary(&report);
    if (result == HEWN_OK)
        hewn_lod_report_destroy(&report);
    return result;
}

static hewn_result run_progressive(lod_request *request, hewn_error *error)
{
    hewn_progressive_report report;
    hewn_result result = hewn_progressive_file(&request->progressive, &report, error);
    hewn_progress_end();
    if (result == HEWN_OK && !request->file.quiet)
        print_progressive(&report);
    if (result == HEWN_OK)
        hewn_progressive_report_destroy(&report);
    return result;
}

static hewn_result run_clusters(lod_request *request, hewn_error *error)
{
    hewn_clusters_report report;
    hewn_result result = hewn_clusters_file(&request->clusters, &report, error);
    hewn_progress_end();
    if (result != HEWN_OK)
        return result;
    if (!request->file.quiet) {
        fprintf(stderr, "%s: %u clusters of %" PRIu64 " triangles in %u levels in %.2f s\n", report.output,
                report.clusters, report.triangles, report.level_count, report.seconds);
        for (uint32_t i = 0; i < report.level_count; i++)
            fprintf(stderr, "  %2u %7u clusters, %9" PRIu64 " triangles; nowhere more than %.4g away\n", i,
                    report.levels[i].clusters, report.levels[i].triangles, report.levels[i].error);
    }
    hewn_clusters_report_destroy(&report);
    return HEWN_OK;
}

static int run(const hewn_command *command, const hewn_arguments *arguments)
{
    hewn_error error = {0};
    lod_request request;
    hewn_result result = read_request(arguments, &request, &error);
    if (result != HEWN_OK)
        return hewn_report_misuse(command, &error);
    hewn_signals_catch();
    hewn_progress progress = hewn_progress_begin(request.file.quiet);
    request.desc.progress = request.progressive.progress = request.clusters.progress = &progress;
    request.desc.began = request.progressive.began = request.clusters.began = hewn_started();
    result = request.is_clusters      ? run_clusters(&request, &error)
             : request.is_progressive ? run_progressive(&request, &error)
                                      : run_levels(&request, &error);
    return result == HEWN_OK ? 0 : hewn_report_misuse(command, &error);
}

const hewn_command hewn_command_lod = {
    .name = "lod",
    .summary = "make levels of detail of a mesh file",
    .usage = "FILE -o FILE [OPTION]...",
    .about = "Reads a mesh (.glb, .gltf, .obj, .ply, .stl, .off, also with .gz) and writes it\n"
             "in levels of detail, each with a proven distance from the mesh: in one GLB\n"
             "file (extension MSFT_lod, with screen coverages), or as a file a level. Or\n"
             "makes a progressive mesh (.hpm), from which meshes of any number of\n"
             "triangles are taken, all of them being the input again. Or cuts the mesh\n"
             "into clusters with a hierarchy of coarser ones.\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .after = "Examples:\n"
             "  hewn lod scan.ply -o scan.glb --levels 1,0.5,0.25,0.1\n"
             "  hewn lod part.stl -o 'part-{level}.ply' --errors 0,0.05,0.2\n"
             "  hewn lod chair.obj -o chair.glb --pixels 2 --report report.json\n"
             "  hewn lod scan.ply -o scan.hpm\n"
             "  hewn lod scan.hpm -o small.ply --faces 5000\n"
             "  hewn lod scan.ply -o scan.glb --clusters\n",
    .run = run,
};
