#include "hewn/voxelize_job.h"

#include <math.h>
#include <string.h>

#include "base/clock.h"
#include "base/error.h"
#include "pipeline/domain.h"
#include "pipeline/mesh_samples.h"
#include "pipeline/paths.h"
#include "pipeline/report.h"
#include "pipeline/voxelize_report.h"

typedef struct voxelize_job {
    const hewn_voxelize_job_desc *desc;
    hewn_voxelize_report *report;
    hewn_mesh_format mesh; /* HEWN_MESH_UNKNOWN: the input is a scene */
    hewn_sampling *sampling;
    hewn_sampling_place place;
} voxelize_job;

static hewn_result check(voxelize_job *job, hewn_error *error)
{
    const hewn_voxelize_job_desc *desc = job->desc;
    if (!desc->scene.path || !desc->output)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a job needs an input and an output");
    job->mesh = desc->mesh != HEWN_MESH_UNKNOWN || desc->scene.format != HEWN_SCENE_BY_NAME
                    ? desc->mesh
                    : hewn_mesh_format_of(desc->scene.path);
    if (desc->cell < 0 || isnan(desc->cell) || isinf(desc->cell))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the cell must be above 0 and finite, not %g", desc->cell);
    if (job->mesh != HEWN_MESH_UNKNOWN && desc->bounds)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a mesh is sampled whole, without bounds");
    if (desc->bounds)
        HEWN_TRY(hewn_domain_check(desc->bounds, error));
    hewn_volume_format format;
    HEWN_TRY(hewn_sampling_format(desc->output, desc->format, &format, error));
    if (desc->report && strcmp(desc->report, desc->output) == 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the volume and the report cannot both go to %s",
                         strcmp(desc->output, "-") == 0 ? "standard output" : desc->output);
    HEWN_TRY(hewn_output_check(desc->output, error));
    return desc->report ? hewn_output_check(desc->report, error) : HEWN_OK;
}

static hewn_result sample_mesh(voxelize_job *job, hewn_error *error)
{
    const hewn_voxelize_job_desc *desc = job->desc;
    const hewn_read_desc read = {.format = job->mesh, .progress = desc->progress};
    hewn_model model = {0};
    hewn_result result = hewn_model_read(desc->scene.path, &read, &model, error);
    if (result != HEWN_OK)
        return hewn_blame_input(result, desc->scene.path, error);
    job->report->is_mesh = true;
    job->report->vertices = model.vertex_count;
    job->report->faces = model.face_count;
    job->report->unit = desc->unit ? desc->unit : model.unit;
    const hewn_mesh_sampling_desc sampling = {.cell = desc->cell,
                                              .band = desc->band,
                                              .dense = desc->dense,
                                              .memory_limit = desc->memory_limit,
                                              .progress = desc->progress};
    result = hewn_mesh_samples(&model, &sampling, &job->sampling, &job->place, &job->report->mesh, error);
    hewn_model_destroy(&model);
    return result == HEWN_BAD_INPUT ? hewn_blame_input(result, desc->scene.path, error) : result;
}

/* Longest side over as many cells as a mesh gets by default. */
static double default_cell(const hewn_box *box)
{
    double longest = 0;
    for (int i = 0; i < 3; i++)
        longest = fmax(longest, box->hi[i] - box->lo[i]);
    return longest / HEWN_DEFAULT_RESOLUTION;
}

static hewn_result sample_scene(voxelize_job *job, hewn_error *error)
{
    const hewn_voxelize_job_desc *desc = job->desc;
    hewn_scene_desc load = desc->scene;
    hewn_scene *scene;
    load.reader = load.reader ? load.reader : hewn_scene_reader_standard();
    HEWN_TRY(hewn_scene_load(&load, &scene, error));
    job->report->unit = hewn_scene_unit(scene);
    hewn_field_sampling_desc sampling = {.cell = desc->cell,
                                         .band = desc->band,
                                         .dense = desc->dense,
                                         .memory_limit = desc->memory_limit,
                                         .progress = desc->progress};
    const hewn_mesh_job_desc like = {.bounds = desc->bounds, .cell = desc->cell};
    hewn_bounds_source source;
    hewn_result result = hewn_domain_choose(&like, scene, &sampling.bounds, &source, error);
    if (result == HEWN_OK && !(sampling.cell > 0))
        sampling.cell = default_cell(&sampling.bounds);
    if (result == HEWN_OK)
        result = hewn_sampling_from_field(hewn_scene_field(scene), &sampling, &job->sampling, &job->place, error);
    hewn_scene_destroy(&scene);
    return result;
}

static hewn_result run(voxelize_job *job, hewn_error *error)
{
    const hewn_voxelize_job_desc *desc = job->desc;
    hewn_voxelize_report *report = job->report;
    HEWN_TRY(check(job, error));
    HEWN_TRY(job->mesh != HEWN_MESH_UNKNOWN ? sample_mesh(job, error) : sample_scene(job, error));
    report->cell = job->place.cell;
    report->band = desc->band > 0 ? desc->band : 3;
    report->bytes = hewn_sampling_size(job->sampling);
    memcpy(report->origin, job->place.origin, sizeof report->origin);
    const hewn_sampling_write_desc write = {.format = desc->format,
                                            .band = desc->band,
                                            .dense = desc->dense,
                                            .unit = report->unit,
                                            .progress = desc->progress};
    HEWN_TRY(hewn_sampling_write(job->sampling, &job->place, &write, desc->output, &report->written, error));
    return HEWN_OK;
}

hewn_result hewn_voxelize_file(const hewn_voxelize_job_desc *desc, hewn_voxelize_report *out, hewn_error *error)
{
    *out = (hewn_voxelize_report){0};
    voxelize_job job = {.desc = desc, .report = out};
    double began = desc->began > 0 ? desc->began : hewn_clock_now();
    hewn_result result = run(&job, error);
    hewn_sampling_destroy(&job.sampling);
    out->seconds = hewn_clock_now() - began;
    out->peak_host_bytes = hewn_peak_host_bytes();
    if (result == HEWN_OK && desc->report)
        result = hewn_voxelize_report_write(out, desc->report, error);
    if (result != HEWN_OK)
        *out = (hewn_voxelize_report){0};
    return result;
}
