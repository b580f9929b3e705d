#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "base/clock.h"
#include "base/error.h"
#include "base/progress.h"
#include "geom/distinct.h"
#include "hewn/job.h"
#include "iso/grid.h"
#include "pipeline/domain.h"
#include "pipeline/kept.h"
#include "pipeline/mesh_parts.h"
#include "pipeline/paint_step.h"
#include "pipeline/paths.h"
#include "pipeline/report.h"

/* A job under way: what it holds, in the order in which it was taken. */
typedef struct mesh_job {
    const hewn_mesh_job_desc *desc;
    hewn_mesh_format format;
    hewn_report *report;
    double began;
    hewn_scene *scene;
    hewn_mesh_kept *kept; /* the caller's, or `own` */
    hewn_mesh_kept own;
    uint64_t messages; /* of the validation layer, from before this job */
    hewn_triangles triangles;
    hewn_mesh_parts parts; /* where there is a limit of memory: `triangles` is a view of them */
    hewn_mesh_paint paint;
} mesh_job;

static double seconds_since(double began)
{
    return hewn_clock_now() - began;
}

/* --- before any work --------------------------------------------------------------------------------------------- */

static hewn_result check_faces(const mesh_job *job, hewn_error *error)
{
    const hewn_mesh_job_desc *desc = job->desc;
    const char *method = hewn_method_name(desc->method);
    if (!isfinite(desc->adaptive) || desc->adaptive < 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a tolerance of %g makes no sense", desc->adaptive);
    if (desc->adaptive > 0 && desc->quads)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "merged faces are triangles, not quads");
    if (desc->adaptive > 0 && desc->max_memory > 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "merging faces needs the whole mesh in memory, so it excludes a limit of memory");
    if (desc->adaptive > 0 && (!method || strcmp(method, hewn_method_name(HEWN_METHOD_DC)) != 0))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "only the triangles of dc can be merged, not those of %s",
                         method);
    if ((desc->smooth || desc->simplify) && desc->max_memory > 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "%s needs the whole mesh in memory, so it excludes a limit of memory",
                         desc->smooth ? "smoothing" : "simplification");
    if (desc->simplify && desc->quads)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "simplified faces are triangles, not quads");
    if (desc->quads && !hewn_method_is_dual(desc->method))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the method %s makes triangles; nets and dc make quads", method);
    if (desc->quads && !hewn_mesh_format_has_polygons(job->format))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "%s files hold triangles only; quads can go to .obj, .off and .ply",
                         hewn_mesh_format_name(job->format));
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
    HEWN_TRY(hewn_output_format(desc->output, desc->format, &job->format, error));
    HEWN_TRY(check_faces(job, error));
    if (desc->report && strcmp(desc->report, desc->output) == 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the mesh and the report cannot both go to %s",
                         strcmp(desc->output, "-") == 0 ? "standard output" : desc->output);
    HEWN_TRY(hewn_output_check(desc->output, error));
    return desc->report ? hewn_output_check(desc->report, error) : HEWN_OK;
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
    report->open = desc->open;
    report->quads = desc->quads;
    report->adaptive = desc->adaptive;
    report->max_memory = desc->max_memory;
    report->threads = desc->threads;
    report->resolution = desc->resolution || desc->cell > 0 ? desc->resolution : HEWN_DEFAULT_RESOLUTION;
    return HEWN_OK;
}

static hewn_result load(mesh_job *job, hewn_box *bounds, hewn_error *error)
{
    double begin = seconds_since(job->began);
    HEWN_TRY(hewn_scene_load(&job->desc->scene, &job->scene, error));
    HEWN_TRY(hewn_report_add_scene(job->report, job->scene, error));
    snprintf(job->report->units, sizeof job->report->units, "%s", hewn_scene_unit(job->scene)->name);
    HEWN_TRY(hewn_domain_choose(job->desc, job->scene, bounds, &job->report->bounds_source, error));
    hewn_report_add_stage(job->report, "load", begin, seconds_since(job->began));
    return HEWN_OK;
}

static hewn_result compile(mesh_job *job, hewn_error *error)
{
    hewn_mesh_kept *kept = job->kept;
    hewn_device *device;
    HEWN_TRY(hewn_progress_report(job->desc->progress, "startup", 0, error));
    HEWN_TRY(hewn_opening_wait(&kept->opening, &device, error));
    hewn_report_add_stage(job->report, "startup", 0, fmax(kept->opening.end - job->began, 0));
    job->report->device = *hewn_device_get_info(device);
    HEWN_TRY(hewn_progress_report(job->desc->progress, "compile", 0, error));
    double begin = seconds_since(job->began);
    const hewn_field *field = hewn_scene_field(job->scene);
    HEWN_TRY(hewn_mesh_kept_compile(kept, device, field, error));
    hewn_report_add_stage(job->report, "compile", begin, seconds_since(job->began));
    return HEWN_OK;
}

/* Those of an extraction that began then, and what was done with its parts beside them. */
static void add_stages(mesh_job *job, double begin)
{
    const hewn_extract_stats *stats = &job->report->extraction;
    const hewn_parts_span *certified = &job->parts.certified, *stored = &job->parts.stored;
    for (uint32_t i = 0; i < stats->stage_count; ++i)
        hewn_report_add_stage(job->report, stats->stages[i].name, begin + stats->stages[i].begin,
                              begin + stats->stages[i].end);
    if (job->desc->max_memory == 0)
        return;
    hewn_report_add_stage(job->report, "certify", certified->begin - job->began, certified->end - job->began);
    hewn_report_add_stage(job->report, "store", stored->begin - job->began, stored->end - job->began);
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
        .quads = desc->quads,
        .adaptive = desc->adaptive,
        .max_memory = desc->max_memory,
        .progress = desc->progress,
    };
    hewn_extract_stats *stats = &job->report->extraction;
    double begin = seconds_since(job->began);
    if (desc->max_memory > 0)
        HEWN_TRY(hewn_mesh_parts_make(&job->parts, job->kept->extractor, &extract_desc, desc->output, stats,
                                      &job->report->certificate, error));
    else
        HEWN_TRY(hewn_extract(job->kept->extractor, &extract_desc, &job->triangles, stats, error));
    job->report->method = stats->method;
    add_stages(job, begin);
    return HEWN_OK;
}

/* Before faces are merged, so that colours and labels count in that. */
static hewn_result find_paint(mesh_job *job, hewn_error *error)
{
    const hewn_field *field = hewn_scene_field(job->scene);
    double begin = seconds_since(job->began);
    HEWN_TRY(hewn_mesh_paint_find(field, &job->triangles, job->desc->quads, job->format, &job->paint, error));
    job->report->colors = job->paint.colors != NULL;
    job->report->labels = job->paint.labels != NULL;
    if (job->paint.colors || job->paint.labels)
        hewn_report_add_stage(job->report, "paint", begin, seconds_since(job->began));
    return HEWN_OK;
}

/* Vertices that smoothing and rounding bring together are moved apart again. */
static hewn_result smooth(mesh_job *job, hewn_error *error)
{
    hewn_smooth_desc desc = *job->desc->smooth;
    double begin = seconds_since(job->began);
    desc.labels = NULL;
    desc.freedom = NULL;
    desc.progress = job->desc->progress;
    HEWN_TRY(hewn_triangles_smooth(&job->triangles, &desc, &job->report->smooth, error));
    HEWN_TRY(hewn_triangles_make_distinct(&job->triangles, NULL, error));
    job->report->smoothed = true;
    job->report->smooth_method = desc.method;
    job->report->extraction.max_residual = NAN; /* was that of the cells' vertices */
    hewn_report_add_stage(job->report, "smooth", begin, seconds_since(job->began));
    return HEWN_OK;
}

static hewn_result simplify(mesh_job *job, hewn_error *error)
{
    hewn_simplify_desc desc = *job->desc->simplify;
    double begin = seconds_since(job->began);
    desc.labels = NULL;
    desc.frozen = NULL;
    desc.progress = job->desc->progress;
    HEWN_TRY(hewn_mesh_paint_simplify(&job->triangles, &job->paint, &desc, &job->report->simplify, error));
    job->report->simplified = true;
    job->report->extraction.max_residual = NAN; /* was that of the cells' vertices */
    hewn_report_add_stage(job->report, "simplify", begin, seconds_since(job->began));
    return HEWN_OK;
}

/* What was promised of the mesh has to hold before anybody gets to see it. */
static hewn_result certify(mesh_job *job, hewn_error *error)
{
    HEWN_TRY(hewn_progress_report(job->desc->progress, "certify", 0, error));
    double begin = seconds_since(job->began);
    hewn_certificate *certificate = &job->report->certificate;
    if (job->desc->max_memory > 0)
        job->triangles = job->parts.triangles; /* certified as they came */
    else
        HEWN_TRY(hewn_certify(&job->triangles, job->desc->progress, certificate, error));
    certificate->max_residual = job->report->extraction.max_residual;
    job->report->vertices = job->triangles.vertex_count;
    job->report->faces = job->triangles.triangle_count / (job->desc->quads ? 2 : 1);
    if (job->desc->max_memory == 0)
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

static hewn_result write_mesh(mesh_job *job, hewn_error *error)
{
    const hewn_mesh_job_desc *desc = job->desc;
    HEWN_TRY(hewn_progress_report(desc->progress, "write", 0, error));
    double begin = seconds_since(job->began);
    char name[256];
    hewn_channel channels[2];
    uint32_t channel_count = 0;
    HEWN_TRY(hewn_mesh_paint_channels(&job->paint, job->format, job->triangles.vertex_count, channels, &channel_count,
                                      error));
    hewn_path_stem(desc->scene.path, name, sizeof name);
    hewn_write_desc write_desc = {
        .format = job->format,
        .name = strcmp(desc->output, "-") == 0 ? name : NULL,
        .unit = hewn_scene_unit(job->scene),
        .up = hewn_scene_up(job->scene),
        .channels = channels,
        .channel_count = channel_count,
        .quads = desc->quads,
        .progress = desc->progress,
    };
    if (desc->max_memory > 0)
        write_desc.progress = hewn_mesh_parts_progress(&job->parts, desc->progress);
    HEWN_TRY(hewn_triangles_write(&job->triangles, desc->output, &write_desc, error));
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
    hewn_mesh_kept_open(job->kept, desc->device, desc->validation);
    job->messages = atomic_load(&job->kept->opening.messages);
    hewn_box bounds;
    hewn_result result = load(job, &bounds, error);
    if (result != HEWN_OK)
        return hewn_blame_input(result, desc->scene.path, error);
    if (desc->max_memory > 0 && hewn_mesh_paint_wanted(hewn_scene_field(job->scene), job->format))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "colours and labels need the whole mesh in memory, so they exclude a limit of memory; .stl "
                         "and .3mf files have none");
    HEWN_TRY(compile(job, error));
    result = extract(job, &bounds, error);
    if (result != HEWN_OK)
        return result == HEWN_BAD_INPUT ? hewn_blame_input(result, desc->scene.path, error) : result;
    if (desc->max_memory == 0)
        HEWN_TRY(find_paint(job, error));
    if (desc->smooth)
        HEWN_TRY(smooth(job, error));
    if (desc->simplify)
        HEWN_TRY(simplify(job, error));
    HEWN_TRY(certify(job, error));
    return write_mesh(job, error);
}

/* Gives back all but what is kept for the next job; after a failure of the device nothing is. */
static void release(mesh_job *job, hewn_result result)
{
    double begin = seconds_since(job->began);
    hewn_mesh_kept *kept = job->kept;
    bool broken = result == HEWN_DEVICE_LOST || result == HEWN_OUT_OF_DEVICE_MEMORY || result == HEWN_OUT_OF_MEMORY;
    hewn_device *device = NULL;
    if (job->desc->max_memory > 0)
        job->triangles = (hewn_triangles){0};
    hewn_triangles_destroy(&job->triangles);
    hewn_mesh_parts_clear(&job->parts);
    hewn_mesh_paint_destroy(&job->paint);
    (void)hewn_opening_wait(&kept->opening, &device, NULL); /* it reads the description from another thread */
    if (device)
        job->report->peak_device_bytes = hewn_device_peak_bytes(device);
    if (broken || kept == &job->own)
        hewn_mesh_kept_close(kept);
    job->report->validation_messages = atomic_load(&kept->opening.messages) - job->messages;
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
    job.kept = desc->kept ? desc->kept : &job.own;
    hewn_result result = run(&job, error);
    release(&job, result);
    if (result == HEWN_OK && desc->report)
        result = hewn_report_write(out, desc->report, error);
    if (result != HEWN_OK)
        hewn_report_destroy(out);
    return result;
}
