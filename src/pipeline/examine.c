#include "pipeline/examine.h"

#include "base/clock.h"
#include "base/error.h"
#include "pipeline/check_json.h"
#include "pipeline/json_parts.h"
#include "pipeline/model_facts.h"
#include "pipeline/paths.h"
#include "pipeline/report.h"

static hewn_result read_and_check(hewn_examination *job, hewn_error *error)
{
    hewn_read_desc read = {.format = job->format, .progress = job->progress};
    hewn_check_desc desc = {.skip_self_intersections = job->skip_self_intersections, .progress = job->progress};
    HEWN_TRY(hewn_model_read(job->path, &read, &job->model, error));
    job->stages[0].end = job->stages[1].begin = hewn_clock_now() - job->began;
    hewn_polygons polygons = hewn_model_polygons(&job->model);
    HEWN_TRY(hewn_check_polygons(&polygons, &desc, &job->check, error));
    job->stages[1].end = hewn_clock_now() - job->began;
    return HEWN_OK;
}

/* The second surface is brought to the unit and axes of the first, where both say what theirs are. */
static hewn_result measure(hewn_examination *job, hewn_error *error)
{
    hewn_model other;
    hewn_read_desc read = {.format = job->against_format, .progress = job->progress};
    const hewn_polygons one = hewn_model_polygons(&job->model);
    job->stages[2].begin = hewn_clock_now() - job->began;
    hewn_result result = hewn_model_read(job->against, &read, &other, error);
    if (result != HEWN_OK)
        return hewn_blame_input(result, job->against, error);
    const hewn_unit *unit = other.unit ? job->model.unit : NULL;
    const hewn_axis *up = other.up_known && job->model.up_known ? &job->model.up : NULL;
    result = hewn_model_convert(&other, unit, up, NULL, error);
    const hewn_polygons two = hewn_model_polygons(&other);
    if (result == HEWN_OK)
        result =
            hewn_polygons_distance(&one, &two, &(hewn_distance_desc){.progress = job->progress}, &job->distance, error);
    hewn_model_destroy(&other);
    job->stages[2].end = hewn_clock_now() - job->began;
    return result;
}

hewn_result hewn_examine(hewn_examination *job, hewn_error *error)
{
    job->stages[2] = (hewn_report_stage){.name = "measure"};
    job->stages[0] = (hewn_report_stage){.name = "load"};
    job->stages[1] = (hewn_report_stage){.name = "check"};
    HEWN_TRY(hewn_input_format(job->path, job->format, &job->format, error));
    if (job->against)
        HEWN_TRY(hewn_input_format(job->against, job->against_format, &job->against_format, error));
    hewn_result result = read_and_check(job, error);
    if (result != HEWN_OK)
        return hewn_blame_input(result, job->path, error);
    return job->against ? measure(job, error) : HEWN_OK;
}

static void print_words(hewn_json *json, const char *key, uint32_t bits)
{
    hewn_json_array(json, key);
    for (uint32_t bit = 1; bit & HEWN_REQUIRE_ALL; bit <<= 1)
        if (bits & bit)
            hewn_json_string(json, NULL, hewn_requirement_name((hewn_requirement)bit));
    hewn_json_end_array(json);
}

static void print_distance(hewn_json *json, const hewn_examination *job)
{
    hewn_json_object(json, "distance");
    hewn_json_string(json, "against", job->against);
    hewn_json_number(json, "high", job->distance.high);
    hewn_json_number(json, "low", job->distance.low);
    hewn_json_number(json, "there", job->distance.there);
    hewn_json_number(json, "there_low", job->distance.there_low);
    hewn_json_number(json, "back", job->distance.back);
    hewn_json_number(json, "back_low", job->distance.back_low);
    hewn_json_end_object(json);
}

hewn_result hewn_examination_write(const hewn_examination *job, const char *path, hewn_error *error)
{
    hewn_text text = {0};
    hewn_json json = hewn_json_begin(&text);
    hewn_json_object(&json, NULL);
    hewn_json_string(&json, "version", hewn_version());
    hewn_json_string(&json, "input", job->path);
    hewn_json_string(&json, "format", hewn_mesh_format_name(job->format));
    hewn_json_stages(&json, job->stages, job->against ? 3 : 2, job->stages[job->against ? 2 : 1].end);
    hewn_json_object(&json, "peak");
    hewn_json_unsigned(&json, "host_bytes", hewn_peak_host_bytes());
    hewn_json_end_object(&json);
    hewn_result result = hewn_json_model(&json, &job->model, error);
    print_words(&json, "required", job->required);
    print_words(&json, "unmet", hewn_check_unmet(job->check, job->required));
    hewn_json_check(&json, "certificate", job->check);
    if (job->against)
        print_distance(&json, job);
    hewn_json_end_object(&json);
    if (result == HEWN_OK)
        result = hewn_json_finish(&text, path, error);
    hewn_text_clear(&text);
    return result;
}

void hewn_examination_clear(hewn_examination *job)
{
    hewn_check_destroy(&job->check);
    hewn_model_destroy(&job->model);
}
