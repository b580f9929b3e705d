#include "hewn/file_job.h"

#include <stdio.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/progress.h"
#include "pipeline/frame.h"
#include "pipeline/losses.h"
#include "pipeline/outcore_step.h"
#include "pipeline/paths.h"
#include "pipeline/report.h"
#include "pipeline/smooth_step.h"
#include "pipeline/stages.h"
#include "pipeline/subdivide_step.h"

/* A job under way. */
typedef struct file_job {
    const hewn_file_job_desc *desc;
    hewn_file_report *report;
    hewn_stages stages;
    hewn_frame frame;
    hewn_model model;
} file_job;

/* --- before any work --------------------------------------------------------------------------------------------- */

static hewn_result check(file_job *job, hewn_error *error)
{
    const hewn_file_job_desc *desc = job->desc;
    if (!desc->input || !desc->output)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a job needs an input and an output");
    HEWN_TRY(hewn_input_format(desc->input, desc->from, &job->report->from, error));
    HEWN_TRY(hewn_output_format(desc->output, desc->to, &job->report->to, error));
    HEWN_TRY(hewn_frame_choose(job->report->to, (hewn_frame){desc->to_unit, desc->to_up}, &job->frame, error));
    if (desc->report && strcmp(desc->report, desc->output) == 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the mesh and the report cannot both go to %s",
                         strcmp(desc->output, "-") == 0 ? "standard output" : desc->output);
    if (desc->max_memory > 0 && (!desc->simplify || desc->repair || desc->subdivide || desc->smooth || desc->check))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "only simplification alone goes with a limit of memory: all else needs the whole mesh");
    job->report->max_memory = desc->max_memory;
    HEWN_TRY(hewn_output_check(desc->output, error));
    return desc->report ? hewn_output_check(desc->report, error) : HEWN_OK;
}

/* --- the stages -------------------------------------------------------------------------------------------------- */

/* What the caller knows better than the file. */
static void take_frame(file_job *job)
{
    const hewn_file_job_desc *desc = job->desc;
    hewn_file_report *report = job->report;
    hewn_model *model = &job->model;
    report->file_unit = model->unit;
    report->file_up = model->up;
    report->file_up_known = model->up_known;
    hewn_frame_declare((hewn_frame){desc->unit, desc->up}, model);
}

static hewn_result load(file_job *job, hewn_error *error)
{
    const hewn_file_job_desc *desc = job->desc;
    hewn_file_report *report = job->report;
    hewn_read_desc read = {.format = report->from, .progress = desc->progress};
    hewn_stage_begin(&job->stages);
    hewn_result result = hewn_model_read(desc->input, &read, &job->model, error);
    if (result != HEWN_OK)
        return hewn_blame_input(result, desc->input, error);
    hewn_model *model = &job->model;
    report->vertices_before = model->vertex_count;
    report->faces_before = model->face_count;
    take_frame(job);
    hewn_stage_end(&job->stages, "load");
    return HEWN_OK;
}

/* Within a limit of memory; what does not fit is simplified as well. */
static hewn_result load_within(file_job *job, hewn_error *error)
{
    bool done;
    HEWN_TRY(hewn_outcore_step(job->desc, job->report, &job->stages, &job->model, &done, error));
    take_frame(job);
    return HEWN_OK;
}

static hewn_result repair(file_job *job, hewn_error *error)
{
    hewn_file_report *report = job->report;
    hewn_repair_desc desc = *job->desc->repair;
    desc.progress = job->desc->progress;
    hewn_stage_begin(&job->stages);
    hewn_mesh *mesh = NULL;
    hewn_result result = hewn_mesh_from_model(&job->model, &desc, &mesh, &report->repair, error);
    if (result != HEWN_OK)
        return hewn_blame_input(result, job->desc->input, error);
    hewn_model repaired;
    result = hewn_model_from_mesh(mesh, &repaired, error);
    hewn_mesh_destroy(&mesh);
    HEWN_TRY(result);
    repaired.unit = job->model.unit;
    repaired.up = job->model.up;
    repaired.up_known = job->model.up_known;
    hewn_model_destroy(&job->model);
    job->model = repaired;
    report->repaired = true;
    hewn_stage_end(&job->stages, "repair");
    return HEWN_OK;
}

static hewn_result subdivide(file_job *job, hewn_error *error)
{
    hewn_file_report *report = job->report;
    hewn_stage_begin(&job->stages);
    hewn_result result =
        hewn_subdivide_step(&job->model, job->desc->subdivide, job->desc->progress, &report->subdivide, error);
    if (result != HEWN_OK)
        return hewn_blame_input(result, job->desc->input, error);
    report->subdivided = true;
    report->scheme = job->desc->subdivide->desc.scheme;
    hewn_stage_end(&job->stages, "subdivide");
    return HEWN_OK;
}

static hewn_result simplify(file_job *job, hewn_error *error)
{
    hewn_file_report *report = job->report;
    hewn_simplify_desc desc = *job->desc->simplify;
    desc.labels = NULL;
    desc.frozen = NULL;
    desc.progress = job->desc->progress;
    hewn_stage_begin(&job->stages);
    hewn_result result = hewn_model_simplify(&job->model, &desc, &report->simplify, error);
    if (result != HEWN_OK)
        return hewn_blame_input(result, job->desc->input, error);
    report->simplified = true;
    hewn_stage_end(&job->stages, "simplify");
    return HEWN_OK;
}

static hewn_result smooth(file_job *job, hewn_error *error)
{
    hewn_file_report *report = job->report;
    hewn_stage_begin(&job->stages);
    hewn_result result = hewn_smooth_step(&job->model, job->desc->smooth, job->desc->progress, &report->smooth, error);
    if (result != HEWN_OK)
        return hewn_blame_input(result, job->desc->input, error);
    report->smoothed = true;
    report->smooth_method = job->desc->smooth->desc.method;
    hewn_stage_end(&job->stages, "smooth");
    return HEWN_OK;
}

static hewn_result convert(file_job *job, hewn_error *error)
{
    hewn_file_report *report = job->report;
    const hewn_unit *unit = hewn_frame_unit(report->to, job->frame, &job->model);
    HEWN_TRY(hewn_model_convert(&job->model, unit, job->frame.up, &report->conversion, error));
    report->up_known = job->model.up_known;
    report->vertices = job->model.vertex_count;
    report->faces = job->model.face_count;
    return HEWN_OK;
}

static hewn_result examine(file_job *job, hewn_error *error)
{
    hewn_stage_begin(&job->stages);
    hewn_check_desc desc = {.skip_self_intersections = job->desc->skip_self_intersections,
                            .progress = job->desc->progress};
    hewn_polygons polygons = hewn_model_polygons(&job->model);
    HEWN_TRY(hewn_check_polygons(&polygons, &desc, &job->report->check, error));
    hewn_stage_end(&job->stages, "check");
    return HEWN_OK;
}

static hewn_result write(file_job *job, hewn_error *error)
{
    const hewn_file_job_desc *desc = job->desc;
    hewn_file_report *report = job->report;
    char name[256];
    hewn_stage_begin(&job->stages);
    HEWN_TRY(hewn_losses_find(&job->model, report->to, &report->losses, error));
    if (report->to == HEWN_MESH_STL)
        report->losses.rejoined = report->repair.vertex_copies;
    hewn_path_stem(strcmp(desc->output, "-") == 0 ? desc->input : desc->output, name, sizeof name);
    hewn_write_desc write_desc = {.format = report->to, .name = name, .progress = desc->progress};
    HEWN_TRY(hewn_model_write(&job->model, desc->output, &write_desc, error));
    hewn_stage_end(&job->stages, "write");
    return HEWN_OK;
}

/* --- the whole --------------------------------------------------------------------------------------------------- */

static hewn_result run(file_job *job, hewn_error *error)
{
    const hewn_file_job_desc *desc = job->desc;
    hewn_file_report *report = job->report;
    HEWN_TRY(check(job, error));
    report->input = hewn_strdup(desc->input);
    report->output = hewn_strdup(desc->output);
    if (!report->input || !report->output)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the report");
    if (desc->max_memory > 0)
        HEWN_TRY(load_within(job, error));
    else
        HEWN_TRY(load(job, error));
    if (desc->repair)
        HEWN_TRY(repair(job, error));
    if (desc->subdivide)
        HEWN_TRY(subdivide(job, error));
    if (desc->smooth)
        HEWN_TRY(smooth(job, error));
    if (desc->simplify && !report->simplified)
        HEWN_TRY(simplify(job, error));
    HEWN_TRY(convert(job, error));
    if (desc->check)
        HEWN_TRY(examine(job, error));
    return write(job, error);
}

hewn_result hewn_file_convert(const hewn_file_job_desc *desc, hewn_file_report *out, hewn_error *error)
{
    *out = (hewn_file_report){0};
    file_job job = {.desc = desc,
                    .report = out,
                    .stages = hewn_stages_start(desc->began, out->stages, sizeof out->stages / sizeof *out->stages,
                                                &out->stage_count)};
    hewn_result result = run(&job, error);
    hewn_model_destroy(&job.model);
    out->seconds = hewn_stages_seconds(&job.stages);
    out->peak_host_bytes = hewn_peak_host_bytes();
    if (result == HEWN_OK && desc->report)
        result = hewn_file_report_write(out, desc->report, error);
    if (result != HEWN_OK)
        hewn_file_report_destroy(out);
    return result;
}
