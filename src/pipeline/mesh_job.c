#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/alloc.h"
#include "base/clock.h"
#include "base/error.h"
#include "base/file.h"
#include "base/progress.h"
#include "hewn/job.h"
#include "iso/grid.h"
#include "pipeline/domain.h"
#include "pipeline/opening.h"
#include "pipeline/report.h"

/* A job under way: what it holds, in the order in which it was taken. */
typedef struct mesh_job {
    const hewn_mesh_job_desc *desc;
    hewn_mesh_format format;
    hewn_report *report;
    double began;
    hewn_scene *scene;
    hewn_opening opening;
    bool opening_begun;
    hewn_device *device;
    hewn_extractor *extractor;
    hewn_triangles triangles;
} mesh_job;

static double seconds_since(double began)
{
    return hewn_clock_now() - began;
}

/* Whoever could not read the input has a bad input; only a refused output is a failure of input and output. */
static hewn_result blame_input(hewn_result result, const char *path, hewn_error *error)
{
    if (result == HEWN_IO)
        result = HEWN_BAD_INPUT;
    if (result == HEWN_BAD_INPUT && error) {
        error->code = result;
        if (!error->file[0]) {
            hewn_error copy = *error;
            const char *name = strcmp(path, "-") == 0 ? "standard input" : path;
            hewn_fail_at(error, result, name, copy.line, "%s", copy.message);
        }
    }
    return result;
}

/* --- before any work --------------------------------------------------------------------------------------------- */

static hewn_result check_format(mesh_job *job, hewn_error *error)
{
    const hewn_mesh_job_desc *desc = job->desc;
    bool standard = strcmp(desc->output, "-") == 0;
    job->format = desc->format;
    if (job->format == HEWN_MESH_UNKNOWN && !standard)
        job->format = hewn_mesh_format_of(desc->output);
    if (job->format == HEWN_MESH_UNKNOWN && standard)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "standard output has no extension: name its format with --to ply, stl or obj");
    if (job->format == HEWN_MESH_UNKNOWN)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "the name '%s' does not end in .glb, .obj, .ply or .stl, so its format is unknown",
                         desc->output);
    if (job->format == HEWN_MESH_GLB && standard)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "GLB cannot be written to standard output; ply, stl and obj can");
    return HEWN_OK;
}

/* A file is begun and given up, because nothing else tells for sure that it can be written. Devices and pipes are left
 * alone: opening and closing one is something that its reader would notice. */
static hewn_result check_output(const char *path, hewn_error *error)
{
    struct stat status;
    if (strcmp(path, "-") == 0)
        return HEWN_OK;
    if (stat(path, &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode))
        return HEWN_OK;
    hewn_output *output = NULL;
    HEWN_TRY(hewn_output_create(path, &output, error));
    hewn_output_destroy(&output);
    return HEWN_OK;
}

static hewn_result check(mesh_job *job, hewn_error *error)
{
    const hewn_mesh_job_desc *desc = job->desc;
    if (!desc->scene.path || !desc->output)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a job needs a scene and an output");
    if (desc->resolution && desc->cell > 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a resolution and a cell size exclude each other");
    if (desc->resolution > HEWN_MAX_RESOLUTION)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "more than %u cells on the longest side are not supported",
                         HEWN_MAX_RESOLUTION);
    if (!isfinite(desc->cell) || desc->cell < 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a cell size of %g makes no sense", desc->cell);
    if (desc->bounds)
        HEWN_TRY(hewn_domain_check(desc->bounds, error));
    HEWN_TRY(check_format(job, error));
    if (desc->report && strcmp(desc->report, desc->output) == 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the mesh and the report cannot both go to %s",
                         strcmp(desc->output, "-") == 0 ? "standard output" : desc->output);
    HEWN_TRY(check_output(desc->output, error));
    return desc->report ? check_output(desc->report, error) : HEWN_OK;
}

static hewn_result set_threads(uint32_t threads, hewn_error *error)
{
    if (threads == 0)
        return HEWN_OK;
    char digits[16];
    snprintf(digits, sizeof digits, "%u", threads);
    if (setenv("LP_NUM_THREADS", digits, 1) != 0)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory");
    omp_set_num_threads((int)threads);
    return HEWN_OK;
}

/* --- the stages -------------------------------------------------------------------------------------------------- */

static hewn_result describe_request(mesh_job *job, hewn_error *error)
{
    hewn_report *report = job->report;
    const hewn_mesh_job_desc *desc = job->desc;
    report->input = hewn_strdup(desc->scene.path);
    report->output = hewn_strdup(desc->output);
    if (!report->input || !report->output)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the report");
    report->format = job->format;
    report->method = desc->method;
    report->open = desc->open;
    report->threads = desc->threads;
    report->resolution = desc->resolution || desc->cell > 0 ? desc->resolution : HEWN_DEFAULT_RESOLUTION;
    return HEWN_OK;
}

static hewn_result load(mesh_job *job, hewn_box *bounds, hewn_error *error)
{
    double begin = seconds_since(job->began);
    HEWN_TRY(hewn_scene_load(&job->desc->scene, &job->scene, error));
    HEWN_TRY(hewn_report_add_scene(job->report, job->scene, error));
    snprintf(job->report->units, sizeof job->report->units, "%s", hewn_scene_units(job->scene));
    HEWN_TRY(hewn_domain_choose(job->desc, job->scene, bounds, &job->report->bounds_source, error));
    hewn_report_add_stage(job->report, "load", begin, seconds_since(job->began));
    return HEWN_OK;
}

static hewn_result compile(mesh_job *job, hewn_error *error)
{
    HEWN_TRY(hewn_progress_report(job->desc->progress, "startup", 0, error));
    HEWN_TRY(hewn_opening_wait(&job->opening, &job->device, error));
    hewn_report_add_stage(job->report, "startup", 0, job->opening.end - job->began);
    job->report->device = *hewn_device_get_info(job->device);
    HEWN_TRY(hewn_progress_report(job->desc->progress, "compile", 0, error));
    double begin = seconds_since(job->began);
    const hewn_field *field = hewn_scene_field(job->scene);
    HEWN_TRY(hewn_extractor_create(job->device, field, hewn_field_root(field), &job->extractor, error));
    hewn_report_add_stage(job->report, "compile", begin, seconds_since(job->began));
    return HEWN_OK;
}

static hewn_result extract(mesh_job *job, const hewn_box *bounds, hewn_error *error)
{
    const hewn_mesh_job_desc *desc = job->desc;
    hewn_extract_desc extract_desc = {
        .bounds = *bounds,
        .resolution = job->report->resolution,
        .cell = desc->cell,
        .method = desc->method,
        .open = desc->open,
        .progress = desc->progress,
    };
    hewn_extract_stats *stats = &job->report->extraction;
    double begin = seconds_since(job->began);
    HEWN_TRY(hewn_extract(job->extractor, &extract_desc, &job->triangles, stats, error));
    for (uint32_t i = 0; i < stats->stage_count; ++i)
        hewn_report_add_stage(job->report, stats->stages[i].name, begin + stats->stages[i].begin,
                              begin + stats->stages[i].end);
    return HEWN_OK;
}

/* What was promised of the mesh has to hold before anybody gets to see it. */
static hewn_result certify(mesh_job *job, hewn_error *error)
{
    HEWN_TRY(hewn_progress_report(job->desc->progress, "certify", 0, error));
    double begin = seconds_since(job->began);
    hewn_certificate *certificate = &job->report->certificate;
    HEWN_TRY(hewn_certify(&job->triangles, job->desc->progress, certificate, error));
    certificate->max_residual = job->report->extraction.max_residual;
    job->report->vertices = job->triangles.vertex_count;
    job->report->faces = job->triangles.triangle_count;
    hewn_report_add_stage(job->report, "certify", begin, seconds_since(job->began));
    if ((certificate->closed || job->desc->open) && certificate->manifold && certificate->oriented)
        return HEWN_OK;
    return hewn_fail(
        error, HEWN_INTERNAL,
        "the mesh failed its proof and was not written: %llu open edges, %llu edges and %llu vertices that "
        "are not manifold; this is a fault of Hewn, please report it",
        (unsigned long long)certificate->boundary_edges, (unsigned long long)certificate->non_manifold_edges,
        (unsigned long long)certificate->non_manifold_vertices);
}

/* The name of a scene's file without folder and extension: a mesh on standard output has no name of its own. */
static void name_of_scene(const char *path, char *out, size_t size)
{
    const char *slash = strrchr(path, '/');
    const char *base = slash ? slash + 1 : path;
    const char *dot = strrchr(base, '.');
    int length = dot && dot != base ? (int)(dot - base) : (int)strlen(base);
    snprintf(out, size, "%.*s", length, strcmp(path, "-") == 0 ? "mesh" : base);
}

static hewn_result write_mesh(mesh_job *job, hewn_error *error)
{
    const hewn_mesh_job_desc *desc = job->desc;
    HEWN_TRY(hewn_progress_report(desc->progress, "write", 0, error));
    double begin = seconds_since(job->began);
    char name[256];
    name_of_scene(desc->scene.path, name, sizeof name);
    hewn_mesh_write_desc write_desc = {
        .format = job->format,
        .name = strcmp(desc->output, "-") == 0 ? name : NULL,
        .metres_per_unit = hewn_scene_metres_per_unit(job->scene),
        .up = hewn_scene_up(job->scene),
        .progress = desc->progress,
    };
    HEWN_TRY(hewn_mesh_write(&job->triangles, desc->output, &write_desc, error));
    hewn_report_add_stage(job->report, "write", begin, seconds_since(job->began));
    return HEWN_OK;
}

/* --- the whole --------------------------------------------------------------------------------------------------- */

static hewn_result run(mesh_job *job, hewn_error *error)
{
    const hewn_mesh_job_desc *desc = job->desc;
    HEWN_TRY(check(job, error));
    HEWN_TRY(describe_request(job, error));
    HEWN_TRY(hewn_progress_report(desc->progress, "load", 0, error));
    HEWN_TRY(set_threads(desc->threads, error));
    hewn_opening_begin(&job->opening, desc->device, desc->validation);
    job->opening_begun = true;
    hewn_box bounds;
    hewn_result result = load(job, &bounds, error);
    if (result != HEWN_OK)
        return blame_input(result, desc->scene.path, error);
    HEWN_TRY(compile(job, error));
    result = extract(job, &bounds, error);
    if (result != HEWN_OK)
        return result == HEWN_BAD_INPUT ? blame_input(result, desc->scene.path, error) : result;
    HEWN_TRY(certify(job, error));
    return write_mesh(job, error);
}

static void release(mesh_job *job)
{
    double begin = seconds_since(job->began);
    hewn_triangles_destroy(&job->triangles);
    hewn_extractor_destroy(&job->extractor);
    if (job->device)
        job->report->peak_device_bytes = hewn_device_peak_bytes(job->device);
    if (job->opening_begun) {
        hewn_opening_close(&job->opening);
        job->report->validation_messages = atomic_load(&job->opening.messages);
    }
    hewn_scene_destroy(&job->scene);
    double end = seconds_since(job->began);
    hewn_report_add_stage(job->report, "shutdown", begin, end);
    job->report->seconds = end;
    job->report->peak_host_bytes = hewn_peak_host_bytes();
}

hewn_result hewn_mesh_scene(const hewn_mesh_job_desc *desc, hewn_report *out, hewn_error *error)
{
    *out = (hewn_report){0};
    mesh_job job = {.desc = desc, .report = out, .began = desc->began > 0 ? desc->began : hewn_clock_now()};
    hewn_result result = run(&job, error);
    release(&job);
    if (result == HEWN_OK && desc->report)
        result = hewn_report_write(out, desc->report, error);
    if (result != HEWN_OK)
        hewn_report_destroy(out);
    return result;
}

static hewn_result examine(const char *path, const hewn_progress *progress, hewn_triangles *triangles,
                           hewn_report *report, hewn_error *error)
{
    double began = hewn_clock_now();
    report->input = hewn_strdup(path);
    if (!report->input)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the report");
    HEWN_TRY(hewn_progress_report(progress, "load", 0, error));
    HEWN_TRY(hewn_mesh_read(path, triangles, error));
    double loaded = seconds_since(began);
    hewn_report_add_stage(report, "load", 0, loaded);
    HEWN_TRY(hewn_progress_report(progress, "certify", 0, error));
    HEWN_TRY(hewn_certify(triangles, progress, &report->certificate, error));
    report->certificate.max_residual = NAN;
    report->vertices = triangles->vertex_count;
    report->faces = triangles->triangle_count;
    report->seconds = seconds_since(began);
    hewn_report_add_stage(report, "certify", loaded, report->seconds);
    return HEWN_OK;
}

hewn_result hewn_mesh_examine(const char *path, const hewn_progress *progress, hewn_report *out, hewn_error *error)
{
    *out = (hewn_report){0};
    hewn_triangles triangles = {0};
    hewn_result result = examine(path, progress, &triangles, out, error);
    hewn_triangles_destroy(&triangles);
    out->peak_host_bytes = hewn_peak_host_bytes();
    if (result == HEWN_OK)
        return HEWN_OK;
    hewn_report_destroy(out);
    return blame_input(result, path, error);
}
