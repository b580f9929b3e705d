#include "hewn/clusters_job.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "pipeline/frame.h"
#include "pipeline/json_parts.h"
#include "pipeline/paths.h"
#include "pipeline/report.h"
#include "pipeline/stages.h"

typedef struct clusters_job {
    const hewn_clusters_job_desc *desc;
    hewn_clusters_report *report;
    hewn_stages stages;
    hewn_frame frame;
    hewn_model model;
    hewn_clusters clusters;
} clusters_job;

/* --- the stages --------------------------------------------------------------------------------------------------- */

static hewn_result check(clusters_job *job, hewn_error *error)
{
    const hewn_clusters_job_desc *desc = job->desc;
    hewn_mesh_format to;
    if (!desc->input || !desc->output)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a job needs an input and an output");
    HEWN_TRY(hewn_input_format(desc->input, desc->from, &job->report->from, error));
    HEWN_TRY(hewn_output_format(desc->output, desc->to, &to, error));
    if (to != HEWN_MESH_GLB)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "clusters are written as .glb only, not as %s",
                         hewn_mesh_format_name(to));
    HEWN_TRY(hewn_frame_choose(to, (hewn_frame){desc->to_unit, desc->to_up}, &job->frame, error));
    if (desc->report && strcmp(desc->report, desc->output) == 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the mesh and the report cannot both go to %s", desc->output);
    HEWN_TRY(hewn_output_check(desc->output, error));
    return desc->report ? hewn_output_check(desc->report, error) : HEWN_OK;
}

/* Positions become floats before clusters are made, so that what is proven of these holds for the file. */
static hewn_result round_positions(clusters_job *job, hewn_error *error)
{
    for (uint64_t v = 0; v < job->model.vertex_count; v++) {
        double square = 0;
        for (uint64_t axis = 0; axis < 3; axis++) {
            double *at = &job->model.positions[3 * v + axis];
            if (!(fabs(*at) <= (double)FLT_MAX))
                return hewn_fail(error, HEWN_LIMIT, "vertex %llu lies too far out for GLB's floats",
                                 (unsigned long long)v);
            const double rounded = (double)(float)*at;
            square += (rounded - *at) * (rounded - *at);
            *at = rounded;
        }
        job->report->rounding = fmax(job->report->rounding, sqrt(square));
    }
    return HEWN_OK;
}

static hewn_result load(clusters_job *job, hewn_error *error)
{
    const hewn_clusters_job_desc *desc = job->desc;
    const hewn_read_desc read = {.format = job->report->from, .progress = desc->progress};
    hewn_conversion conversion;
    hewn_stage_begin(&job->stages);
    hewn_result result = hewn_model_read(desc->input, &read, &job->model, error);
    if (result != HEWN_OK)
        return hewn_blame_input(result, desc->input, error);
    hewn_frame_declare((hewn_frame){desc->unit, desc->up}, &job->model);
    HEWN_TRY(hewn_model_convert(&job->model, job->frame.unit, job->frame.up, &conversion, error));
    HEWN_TRY(round_positions(job, error));
    hewn_stage_end(&job->stages, "load");
    return HEWN_OK;
}

static hewn_result describe(clusters_job *job, hewn_error *error)
{
    hewn_clusters_report *report = job->report;
    const hewn_clusters *from = &job->clusters;
    report->levels = hewn_alloc_zero(from->level_count, sizeof *report->levels);
    if (!report->levels)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the report");
    report->level_count = from->level_count;
    report->clusters = from->count;
    report->vertices = from->unique_count;
    for (uint32_t i = 0; i < from->count; i++) {
        hewn_clusters_report_level *level = &report->levels[from->clusters[i].level];
        level->clusters++;
        level->triangles += from->clusters[i].triangle_count;
        level->error = fmax(level->error, (double)from->clusters[i].self.error);
    }
    report->triangles = from->level_count > 0 ? report->levels[0].triangles : 0;
    return HEWN_OK;
}

static hewn_result make(clusters_job *job, hewn_error *error)
{
    hewn_clusters_desc desc = job->desc->clusters;
    desc.progress = job->desc->progress;
    hewn_stage_begin(&job->stages);
    hewn_result result = hewn_clusters_make(&job->model, &desc, &job->clusters, error);
    if (result != HEWN_OK)
        return hewn_blame_input(result, job->desc->input, error);
    hewn_stage_end(&job->stages, "simplify");
    return describe(job, error);
}

static hewn_result write(clusters_job *job, hewn_error *error)
{
    char name[256];
    hewn_stage_begin(&job->stages);
    hewn_path_stem(job->desc->output, name, sizeof name);
    const hewn_write_desc desc = {.name = name, .progress = job->desc->progress};
    HEWN_TRY(hewn_clusters_write_glb(&job->clusters, &job->model, job->desc->output, &desc, error));
    hewn_stage_end(&job->stages, "write");
    return HEWN_OK;
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

static hewn_result run(clusters_job *job, hewn_error *error)
{
    HEWN_TRY(check(job, error));
    job->report->input = hewn_strdup(job->desc->input);
    job->report->output = hewn_strdup(job->desc->output);
    if (!job->report->input || !job->report->output)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the report");
    HEWN_TRY(load(job, error));
    HEWN_TRY(make(job, error));
    return write(job, error);
}

hewn_result hewn_clusters_file(const hewn_clusters_job_desc *desc, hewn_clusters_report *out, hewn_error *error)
{
    *out = (hewn_clusters_report){0};
    clusters_job job = {.desc = desc,
                        .report = out,
                        .stages = hewn_stages_start(desc->began, out->stages, sizeof out->stages / sizeof *out->stages,
                                                    &out->stage_count)};
    hewn_result result = run(&job, error);
    hewn_model_destroy(&job.model);
    hewn_clusters_destroy(&job.clusters);
    out->seconds = hewn_stages_seconds(&job.stages);
    out->peak_host_bytes = hewn_peak_host_bytes();
    if (result == HEWN_OK && desc->report)
        result = hewn_clusters_report_write(out, desc->report, error);
    if (result != HEWN_OK)
        hewn_clusters_report_destroy(out);
    return result;
}

/* --- the report --------------------------------------------------------------------------------------------------- */

void hewn_clusters_report_destroy(hewn_clusters_report *report)
{
    if (!report)
        return;
    hewn_free(report->input);
    hewn_free(report->output);
    hewn_free(report->levels);
    *report = (hewn_clusters_report){0};
}

hewn_result hewn_clusters_report_write(const hewn_clusters_report *report, const char *path, hewn_error *error)
{
    hewn_text text = {0};
    hewn_json json = hewn_json_begin(&text);
    hewn_json_object(&json, NULL);
    hewn_json_files(&json, report->input, hewn_mesh_format_name(report->from), report->output, "glb");
    hewn_json_stages(&json, report->stages, report->stage_count, report->seconds);
    hewn_json_host_peak(&json, report->peak_host_bytes);
    hewn_json_unsigned(&json, "vertices", report->vertices);
    hewn_json_unsigned(&json, "triangles", report->triangles);
    hewn_json_unsigned(&json, "clusters", report->clusters);
    hewn_json_number(&json, "rounding", report->rounding);
    hewn_json_array(&json, "levels");
    for (uint32_t i = 0; i < report->level_count; i++) {
        hewn_json_object(&json, NULL);
        hewn_json_unsigned(&json, "clusters", report->levels[i].clusters);
        hewn_json_unsigned(&json, "triangles", report->levels[i].triangles);
        hewn_json_number(&json, "error", report->levels[i].error);
        hewn_json_end_object(&json);
    }
    hewn_json_end_array(&json);
    hewn_json_end_object(&json);
    hewn_result result = hewn_json_finish(&text, path, error);
    hewn_text_clear(&text);
    return result;
}
