#include "hewn/lod_job.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "pipeline/frame.h"
#include "pipeline/losses.h"
#include "pipeline/paths.h"
#include "pipeline/report.h"
#include "pipeline/stages.h"

/* Where the number of a level goes in a file's name. */
static const char place_of_level[] = "{level}";

typedef struct lod_job {
    const hewn_lod_job_desc *desc;
    hewn_lod_report *report;
    hewn_stages stages;
    hewn_frame frame;
    bool separate; /* a file a level */
    hewn_model model;
    hewn_lod_level *levels;
    uint32_t count;
} lod_job;

/* --- before any work ---------------------------------------------------------------------------------------------- */

/* The name of level `i`'s file; the caller's. */
static char *level_path(const char *output, uint32_t i)
{
    const char *place = strstr(output, place_of_level);
    const size_t room = strlen(output) + 16;
    char *path = hewn_alloc(room, 1);
    if (path)
        snprintf(path, room, "%.*s%u%s", (int)(place - output), output, i, place + sizeof place_of_level - 1);
    return path;
}

static hewn_result check_output(lod_job *job, hewn_error *error)
{
    const hewn_lod_job_desc *desc = job->desc;
    if (strcmp(desc->output, "-") == 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "levels of detail cannot be written to standard output");
    job->separate = strstr(desc->output, place_of_level) != NULL;
    HEWN_TRY(hewn_output_format(desc->output, desc->to, &job->report->to, error));
    if (!job->separate && job->report->to != HEWN_MESH_GLB)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "%s holds one level only: put {level} into the name for a file a level, or write .glb",
                         hewn_mesh_format_name(job->report->to));
    if (!job->separate)
        return hewn_output_check(desc->output, error);
    for (uint32_t i = 0; i < desc->levels.count; i++) {
        char *path = level_path(desc->output, i);
        hewn_result result = path ? hewn_output_check(path, error)
                                  : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a file's name");
        hewn_free(path);
        HEWN_TRY(result);
    }
    return HEWN_OK;
}

static hewn_result check(lod_job *job, hewn_error *error)
{
    const hewn_lod_job_desc *desc = job->desc;
    if (!desc->input || !desc->output)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a job needs an input and an output");
    HEWN_TRY(hewn_input_format(desc->input, desc->from, &job->report->from, error));
    HEWN_TRY(check_output(job, error));
    HEWN_TRY(hewn_frame_choose(job->report->to, (hewn_frame){desc->to_unit, desc->to_up}, &job->frame, error));
    if (desc->report && strcmp(desc->report, desc->output) == 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the levels and the report cannot both go to %s", desc->output);
    return desc->report ? hewn_output_check(desc->report, error) : HEWN_OK;
}

/* --- the stages --------------------------------------------------------------------------------------------------- */

static double find_diagonal(const hewn_model *model)
{
    double square = 0;
    for (uint64_t axis = 0; axis < 3; axis++) {
        double lo = INFINITY, hi = -INFINITY;
        for (uint64_t v = 0; v < model->vertex_count; v++) {
            lo = fmin(lo, model->positions[3 * v + axis]);
            hi = fmax(hi, model->positions[3 * v + axis]);
        }
        square += hi > lo ? (hi - lo) * (hi - lo) : 0;
    }
    return sqrt(square);
}

static uint64_t count_triangles(const hewn_model *model)
{
    return hewn_model_corner_count(model) - 2 * model->face_count;
}

static hewn_result load(lod_job *job, hewn_error *error)
{
    const hewn_lod_job_desc *desc = job->desc;
    hewn_read_desc read = {.format = job->report->from, .progress = desc->progress};
    hewn_stage_begin(&job->stages);
    hewn_result result = hewn_model_read(desc->input, &read, &job->model, error);
    if (result != HEWN_OK)
        return hewn_blame_input(result, desc->input, error);
    hewn_frame_declare((hewn_frame){desc->unit, desc->up}, &job->model);
    job->report->vertices_before = job->model.vertex_count;
    job->report->faces_before = job->model.face_count;
    job->report->triangles_before = count_triangles(&job->model);
    job->report->diagonal = find_diagonal(&job->model);
    hewn_stage_end(&job->stages, "load");
    return HEWN_OK;
}

static hewn_result simplify(lod_job *job, hewn_error *error)
{
    hewn_lod_desc desc = job->desc->levels;
    desc.simplify.labels = NULL;
    desc.simplify.frozen = NULL;
    desc.simplify.progress = job->desc->progress;
    hewn_stage_begin(&job->stages);
    hewn_result result = hewn_lod_levels_make(&job->model, &desc, &job->levels, error);
    if (result != HEWN_OK)
        return hewn_blame_input(result, job->desc->input, error);
    job->count = desc.count;
    hewn_stage_end(&job->stages, "simplify");
    return HEWN_OK;
}

/* What turning a level into what the file has may move a point by, in the input's unit: numbers that become floats, and
 * the one rounding of each in a change of units. */
static double find_rounding(const hewn_conversion *conversion, double rounding, const hewn_model *model)
{
    double most = 0, scale = (double)conversion->scale_numerator / (double)conversion->scale_denominator;
    if (scale != 1)
        for (uint64_t i = 0; i < 3 * model->vertex_count; i++)
            most = fmax(most, fabs(model->positions[i]));
    return sqrt(3.0) * (rounding + most * 0x1p-51) / scale * (1 + 0x1p-40);
}

/* Brings a level to the frame of the file and fills in what the report says of it. */
static hewn_result finish_level(lod_job *job, uint32_t i, hewn_error *error)
{
    hewn_lod_level *level = &job->levels[i];
    hewn_lod_report_level *said = &job->report->levels[i];
    hewn_conversion conversion;
    hewn_file_losses losses = {0};
    const hewn_unit *unit = hewn_frame_unit(job->report->to, job->frame, &level->model);
    HEWN_TRY(hewn_model_convert(&level->model, unit, job->frame.up, &conversion, error));
    HEWN_TRY(hewn_losses_find(&level->model, job->report->to, &losses, error));
    const double rounding = find_rounding(&conversion, losses.rounding, &level->model);
    hewn_losses_destroy(&losses);
    said->vertices = level->model.vertex_count;
    said->triangles = count_triangles(&level->model);
    said->error = level->error > 0 || rounding > 0 ? (level->error + rounding) * (1 + 0x1p-50) : 0;
    said->error_low = fmax(0, level->error_low - rounding);
    said->reached = !level->simplified || level->report.reached;
    return HEWN_OK;
}

/* Each level is meant for sizes from where the next would do. Errors of levels that do not rise, which happens where
 * they are few triangles apart, do not make it fall. */
static void find_coverages(lod_job *job)
{
    const double pixels = job->desc->pixels > 0 ? job->desc->pixels : 1;
    const double lines = job->desc->lines > 0 ? job->desc->lines : 1080;
    double least = 1;
    for (uint32_t i = 0; i + 1 < job->count; i++) {
        const double next = job->report->levels[i + 1].error;
        least = fmin(least, hewn_lod_coverage(next, job->report->diagonal, pixels, lines));
        job->report->levels[i].coverage = least;
    }
}

static hewn_result write_together(lod_job *job, const hewn_write_desc *desc, hewn_error *error)
{
    const hewn_model **models = hewn_alloc(job->count, sizeof *models);
    double *coverages = hewn_alloc(job->count, sizeof *coverages);
    hewn_result result =
        models && coverages ? HEWN_OK : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the levels");
    for (uint32_t i = 0; result == HEWN_OK && i < job->count; i++) {
        models[i] = &job->levels[i].model;
        coverages[i] = job->report->levels[i].coverage;
    }
    if (result == HEWN_OK)
        result = hewn_levels_write_glb(models, coverages, job->count, job->desc->output, desc, error);
    hewn_free(models);
    hewn_free(coverages);
    return result;
}

static hewn_result write_apart(lod_job *job, const hewn_write_desc *desc, hewn_error *error)
{
    for (uint32_t i = 0; i < job->count; i++) {
        char *path = job->report->levels[i].output = level_path(job->desc->output, i);
        if (!path)
            return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a file's name");
        char name[256];
        hewn_write_desc level = *desc;
        hewn_path_stem(path, name, sizeof name);
        level.name = name;
        HEWN_TRY(hewn_model_write(&job->levels[i].model, path, &level, error));
    }
    return HEWN_OK;
}

static hewn_result write(lod_job *job, hewn_error *error)
{
    char name[256];
    hewn_stage_begin(&job->stages);
    job->report->levels = hewn_alloc_zero(job->count, sizeof *job->report->levels);
    if (!job->report->levels)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the report");
    job->report->level_count = job->count;
    for (uint32_t i = 0; i < job->count; i++)
        HEWN_TRY(finish_level(job, i, error));
    find_coverages(job);
    hewn_path_stem(job->desc->output, name, sizeof name);
    hewn_write_desc desc = {.format = job->report->to, .name = name, .progress = job->desc->progress};
    HEWN_TRY(job->separate ? write_apart(job, &desc, error) : write_together(job, &desc, error));
    hewn_stage_end(&job->stages, "write");
    return HEWN_OK;
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

static hewn_result run(lod_job *job, hewn_error *error)
{
    HEWN_TRY(check(job, error));
    job->report->input = hewn_strdup(job->desc->input);
    job->report->output = hewn_strdup(job->desc->output);
    if (!job->report->input || !job->report->output)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the report");
    HEWN_TRY(load(job, error));
    HEWN_TRY(simplify(job, error));
    return write(job, error);
}

hewn_result hewn_lod_file(const hewn_lod_job_desc *desc, hewn_lod_report *out, hewn_error *error)
{
    *out = (hewn_lod_report){0};
    lod_job job = {.desc = desc,
                   .report = out,
                   .stages = hewn_stages_start(desc->began, out->stages, sizeof out->stages / sizeof *out->stages,
                                               &out->stage_count)};
    hewn_result result = run(&job, error);
    hewn_model_destroy(&job.model);
    hewn_lod_levels_destroy(&job.levels, job.count);
    out->seconds = hewn_stages_seconds(&job.stages);
    out->peak_host_bytes = hewn_peak_host_bytes();
    if (result == HEWN_OK && desc->report)
        result = hewn_lod_report_write(out, desc->report, error);
    if (result != HEWN_OK)
        hewn_lod_report_destroy(out);
    return result;
}
