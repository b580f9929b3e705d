#include "hewn/progressive_job.h"

#include <stdio.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "pipeline/frame.h"
#include "pipeline/paths.h"
#include "pipeline/report.h"
#include "pipeline/stages.h"

typedef struct progressive_job {
    const hewn_progressive_job_desc *desc;
    hewn_progressive_report *report;
    hewn_stages stages;
    hewn_frame frame;
    bool make; /* a progressive mesh; else one is taken from it */
    hewn_model model;
    hewn_progressive *progressive;
} progressive_job;

/* --- before any work ---------------------------------------------------------------------------------------------- */

static hewn_result check_formats(progressive_job *job, hewn_error *error)
{
    const hewn_progressive_job_desc *desc = job->desc;
    hewn_progressive_report *report = job->report;
    const hewn_mesh_format to = desc->to != HEWN_MESH_UNKNOWN ? desc->to : hewn_mesh_format_of(desc->output);
    HEWN_TRY(hewn_input_format(desc->input, desc->from, &report->from, error));
    job->make = to == HEWN_MESH_HPM;
    if (job->make) {
        report->to = to;
        return HEWN_OK;
    }
    if (report->from != HEWN_MESH_HPM)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "neither input nor output is a progressive mesh (.hpm): nothing to take a mesh from");
    return hewn_output_format(desc->output, desc->to, &report->to, error);
}

static hewn_result check(progressive_job *job, hewn_error *error)
{
    const hewn_progressive_job_desc *desc = job->desc;
    if (!desc->input || !desc->output)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a job needs an input and an output");
    HEWN_TRY(check_formats(job, error));
    if (job->make && (desc->error > 0 || desc->partial))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "an error and parts of files are for meshes that are taken from a progressive one");
    if (desc->faces > 0 && desc->error > 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a number of faces and an error exclude each other");
    HEWN_TRY(hewn_frame_choose(job->report->to, (hewn_frame){desc->to_unit, desc->to_up}, &job->frame, error));
    if (desc->report && strcmp(desc->report, desc->output) == 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the mesh and the report cannot both go to %s",
                         strcmp(desc->output, "-") == 0 ? "standard output" : desc->output);
    HEWN_TRY(hewn_output_check(desc->output, error));
    return desc->report ? hewn_output_check(desc->report, error) : HEWN_OK;
}

/* --- the stages --------------------------------------------------------------------------------------------------- */

static hewn_result convert(progressive_job *job, hewn_error *error)
{
    hewn_conversion conversion;
    return hewn_model_convert(&job->model, hewn_frame_unit(job->report->to, job->frame, &job->model), job->frame.up,
                              &conversion, error);
}

static hewn_result make(progressive_job *job, hewn_error *error)
{
    const hewn_progressive_job_desc *desc = job->desc;
    const hewn_read_desc read = {.format = job->report->from, .progress = desc->progress};
    const hewn_progressive_desc how = {.faces = desc->faces, .measure = true, .progress = desc->progress};
    hewn_stage_begin(&job->stages);
    hewn_result result = hewn_model_read(desc->input, &read, &job->model, error);
    if (result != HEWN_OK)
        return hewn_blame_input(result, desc->input, error);
    hewn_frame_declare((hewn_frame){desc->unit, desc->up}, &job->model);
    HEWN_TRY(convert(job, error));
    hewn_stage_end(&job->stages, "load");
    hewn_stage_begin(&job->stages);
    result = hewn_progressive_make(&job->model, &how, &job->progressive, error);
    if (result != HEWN_OK)
        return hewn_blame_input(result, desc->input, error);
    hewn_stage_end(&job->stages, "simplify");
    hewn_stage_begin(&job->stages);
    HEWN_TRY(hewn_progressive_write(job->progressive, desc->output, error));
    hewn_stage_end(&job->stages, "write");
    job->report->vertices = job->model.vertex_count;
    job->report->triangles = hewn_progressive_about(job->progressive).triangles;
    return HEWN_OK;
}

static uint64_t choose_splits(const progressive_job *job)
{
    if (job->desc->faces > 0)
        return hewn_progressive_splits_for(job->progressive, job->desc->faces);
    if (job->desc->error > 0)
        return hewn_progressive_splits_within(job->progressive, job->desc->error);
    return hewn_progressive_about(job->progressive).splits_there;
}

static hewn_result write_mesh(progressive_job *job, hewn_error *error)
{
    char name[256];
    hewn_stage_begin(&job->stages);
    job->report->vertices = job->model.vertex_count;
    job->report->triangles = hewn_progressive_triangles_at(job->progressive, job->report->splits);
    HEWN_TRY(convert(job, error));
    hewn_path_stem(strcmp(job->desc->output, "-") == 0 ? job->desc->input : job->desc->output, name, sizeof name);
    const hewn_write_desc desc = {.format = job->report->to, .name = name, .progress = job->desc->progress};
    HEWN_TRY(hewn_model_write(&job->model, job->desc->output, &desc, error));
    hewn_stage_end(&job->stages, "write");
    return HEWN_OK;
}

static hewn_result take(progressive_job *job, hewn_error *error)
{
    const hewn_progressive_job_desc *desc = job->desc;
    hewn_stage_begin(&job->stages);
    hewn_result result = hewn_progressive_read(desc->input, desc->partial, desc->progress, &job->progressive, error);
    if (result == HEWN_OK) {
        job->report->splits = choose_splits(job);
        result = hewn_progressive_model(job->progressive, job->report->splits, &job->model, error);
    }
    if (result != HEWN_OK)
        return hewn_blame_input(result, desc->input, error);
    hewn_frame_declare((hewn_frame){desc->unit, desc->up}, &job->model);
    hewn_stage_end(&job->stages, "load");
    return write_mesh(job, error);
}

static hewn_result describe(progressive_job *job, hewn_error *error)
{
    hewn_progressive_report *report = job->report;
    report->info = hewn_progressive_about(job->progressive);
    report->marks = hewn_alloc(report->info.mark_count, sizeof *report->marks);
    if (!report->marks)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the report");
    for (uint32_t i = 0; i < report->info.mark_count; i++)
        report->marks[i] = report->info.marks[i];
    report->info.marks = report->marks;
    return HEWN_OK;
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

static hewn_result run(progressive_job *job, hewn_error *error)
{
    HEWN_TRY(check(job, error));
    job->report->input = hewn_strdup(job->desc->input);
    job->report->output = hewn_strdup(job->desc->output);
    if (!job->report->input || !job->report->output)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the report");
    HEWN_TRY(job->make ? make(job, error) : take(job, error));
    return describe(job, error);
}

hewn_result hewn_progressive_file(const hewn_progressive_job_desc *desc, hewn_progressive_report *out,
                                  hewn_error *error)
{
    *out = (hewn_progressive_report){0};
    progressive_job job = {.desc = desc,
                           .report = out,
                           .stages = hewn_stages_start(desc->began, out->stages,
                                                       sizeof out->stages / sizeof *out->stages, &out->stage_count)};
    hewn_result result = run(&job, error);
    hewn_model_destroy(&job.model);
    hewn_progressive_destroy(&job.progressive);
    out->seconds = hewn_stages_seconds(&job.stages);
    out->peak_host_bytes = hewn_peak_host_bytes();
    if (result == HEWN_OK && desc->report)
        result = hewn_progressive_report_write(out, desc->report, error);
    if (result != HEWN_OK)
        hewn_progressive_report_destroy(out);
    return result;
}
