#include "pipeline/report.h"

#include <stdio.h>
#include <string.h>
#include <sys/resource.h>

#include "base/alloc.h"
#include "base/error.h"
#include "pipeline/json_parts.h"
#include "pipeline/simplify_step.h"
#include "pipeline/smooth_step.h"

void hewn_report_add_stage(hewn_report *report, const char *name, double begin, double end)
{
    if (report->stage_count == sizeof report->stages / sizeof *report->stages)
        return;
    hewn_report_stage *stage = &report->stages[report->stage_count++];
    snprintf(stage->name, sizeof stage->name, "%s", name);
    stage->begin = begin;
    stage->end = end;
}

static hewn_result copy_files(hewn_report *report, const hewn_scene *scene)
{
    size_t count = hewn_scene_file_count(scene);
    report->files = hewn_alloc_zero(count, sizeof *report->files);
    if (!report->files)
        return HEWN_OUT_OF_MEMORY;
    for (size_t i = 0; i < count; ++i) {
        report->files[i] = hewn_strdup(hewn_scene_file(scene, i));
        if (!report->files[i])
            return HEWN_OUT_OF_MEMORY;
        report->file_count = i + 1;
    }
    return HEWN_OK;
}

static hewn_result copy_parameters(hewn_report *report, const hewn_scene *scene)
{
    size_t count = hewn_scene_parameter_count(scene);
    report->parameters = hewn_alloc_zero(count, sizeof *report->parameters);
    if (!report->parameters)
        return HEWN_OUT_OF_MEMORY;
    for (size_t i = 0; i < count; ++i) {
        const hewn_scene_parameter *parameter = hewn_scene_parameter_at(scene, i);
        report->parameters[i].name = hewn_strdup(parameter->name);
        if (!report->parameters[i].name)
            return HEWN_OUT_OF_MEMORY;
        report->parameters[i].value = parameter->value;
        report->parameter_count = i + 1;
    }
    return HEWN_OK;
}

static hewn_result copy_sampled(hewn_report *report, const hewn_scene *scene)
{
    size_t count = hewn_scene_sampled_count(scene);
    report->sampled = hewn_alloc_zero(count, sizeof *report->sampled);
    if (!report->sampled)
        return HEWN_OUT_OF_MEMORY;
    for (size_t i = 0; i < count; ++i) {
        report->sampled[i] = *hewn_scene_sampled_at(scene, i);
        report->sampled[i].path = hewn_strdup(report->sampled[i].path);
        if (!report->sampled[i].path)
            return HEWN_OUT_OF_MEMORY;
        report->sampled_count = i + 1;
    }
    return HEWN_OK;
}

hewn_result hewn_report_add_scene(hewn_report *report, const hewn_scene *scene, hewn_error *error)
{
    if (copy_files(report, scene) != HEWN_OK || copy_parameters(report, scene) != HEWN_OK ||
        copy_sampled(report, scene) != HEWN_OK)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the report");
    return HEWN_OK;
}

/* A size that the system tells of this process; 0 where it does not. */
static uint64_t read_status(const char *format)
{
    unsigned long long kibibytes = 0;
    FILE *status = fopen("/proc/self/status", "r");
    if (!status)
        return 0;
    char line[256];
    while (!kibibytes && fgets(line, sizeof line, status))
        if (sscanf(line, format, &kibibytes) != 1)
            kibibytes = 0;
    fclose(status);
    return (uint64_t)kibibytes * 1024;
}

/* VmHWM belongs to this program alone; ru_maxrss, the fallback, starts with what the parent had before exec. */
uint64_t hewn_peak_host_bytes(void)
{
    const uint64_t bytes = read_status("VmHWM: %llu kB");
    struct rusage usage;
    if (!bytes && getrusage(RUSAGE_SELF, &usage) == 0)
        return (uint64_t)usage.ru_maxrss * 1024;
    return bytes;
}

uint64_t hewn_host_bytes(void)
{
    const uint64_t bytes = read_status("VmRSS: %llu kB");
    return bytes ? bytes : hewn_peak_host_bytes();
}

void hewn_report_destroy(hewn_report *report)
{
    if (!report)
        return;
    hewn_free(report->input);
    hewn_free(report->output);
    for (size_t i = 0; i < report->file_count; ++i)
        hewn_free(report->files[i]);
    hewn_free(report->files);
    for (size_t i = 0; i < report->parameter_count; ++i)
        hewn_free(report->parameters[i].name);
    hewn_free(report->parameters);
    for (size_t i = 0; i < report->sampled_count; ++i)
        hewn_free(report->sampled[i].path);
    hewn_free(report->sampled);
    *report = (hewn_report){0};
}

static const char *bounds_source_name(hewn_bounds_source source)
{
    switch (source) {
    case HEWN_BOUNDS_GIVEN: return "given";
    case HEWN_BOUNDS_SCENE: return "scene";
    case HEWN_BOUNDS_FIELD: return "field";
    }
    return NULL;
}

static void print_sampled(hewn_json *json, const hewn_report *report)
{
    hewn_json_array(json, "sampled");
    for (size_t i = 0; i < report->sampled_count; ++i) {
        const hewn_scene_sampled *one = &report->sampled[i];
        hewn_json_object(json, NULL);
        hewn_json_string(json, "file", one->path);
        hewn_json_unsigned(json, "bytes", one->bytes);
        if (one->is_mesh) {
            hewn_json_number(json, "cell", one->cell);
            hewn_json_number(json, "confidence", one->confidence);
            hewn_json_number(json, "doubtful", one->doubtful);
        }
        hewn_json_end_object(json);
    }
    hewn_json_end_array(json);
}

static void print_request(hewn_json *json, const hewn_report *report)
{
    hewn_json_array(json, "files");
    for (size_t i = 0; i < report->file_count; ++i)
        hewn_json_string(json, NULL, report->files[i]);
    hewn_json_end_array(json);
    hewn_json_object(json, "parameters");
    for (size_t i = 0; i < report->parameter_count; ++i)
        hewn_json_number(json, report->parameters[i].name, report->parameters[i].value);
    hewn_json_end_object(json);
    print_sampled(json, report);
    hewn_json_string(json, "units", report->units);
    hewn_json_string(json, "output", report->output);
    hewn_json_string(json, "format", hewn_mesh_format_name(report->format));
    hewn_json_string(json, "method", hewn_method_name(report->method));
    hewn_json_bool(json, "open", report->open);
    hewn_json_bool(json, "quads", report->quads);
    hewn_json_bool(json, "colors", report->colors);
    hewn_json_bool(json, "labels", report->labels);
    if (report->adaptive > 0)
        hewn_json_number(json, "adaptive", report->adaptive);
    else
        hewn_json_string(json, "adaptive", NULL);
    if (report->max_memory > 0)
        hewn_json_unsigned(json, "max_memory", report->max_memory);
    else
        hewn_json_string(json, "max_memory", NULL);
    if (report->resolution)
        hewn_json_unsigned(json, "resolution", report->resolution);
    else
        hewn_json_string(json, "resolution", NULL);
    if (report->threads)
        hewn_json_unsigned(json, "threads", report->threads);
    else
        hewn_json_string(json, "threads", NULL);
    hewn_json_string(json, "device", report->device.name);
    hewn_json_string(json, "driver", report->device.driver);
}

static void print_extraction(hewn_json *json, const hewn_report *report)
{
    const hewn_extract_stats *stats = &report->extraction;
    hewn_json_box(json, "bounds", &stats->bounds);
    hewn_json_string(json, "bounds_from", bounds_source_name(report->bounds_source));
    hewn_json_number(json, "cell", stats->cell);
    hewn_json_array(json, "cells");
    for (int axis = 0; axis < 3; ++axis)
        hewn_json_unsigned(json, NULL, stats->cells[axis]);
    hewn_json_end_array(json);
    hewn_json_bool(json, "left_bounds", stats->left_bounds);
    hewn_json_unsigned(json, "cap_vertices", stats->cap_vertices);
    hewn_json_unsigned(json, "cells_visited", stats->cells_visited);
    hewn_json_unsigned(json, "bricks_active", stats->bricks_active);
    hewn_json_unsigned(json, "suspect_cells", stats->suspect_cells);
    if (stats->suspect_cells > 0)
        hewn_json_box(json, "first_suspect", &stats->first_suspect);
    else
        hewn_json_string(json, "first_suspect", NULL);
    hewn_json_unsigned(json, "undefined_cells", stats->undefined_cells);
    if (hewn_method_is_dual(report->method))
        hewn_json_unsigned(json, "fans", stats->fans);
    if (report->method == HEWN_METHOD_DC) {
        hewn_json_object(json, "features");
        hewn_json_unsigned(json, "edge_vertices", stats->edge_vertices);
        hewn_json_unsigned(json, "corner_vertices", stats->corner_vertices);
        hewn_json_unsigned(json, "planes_found", stats->planes_found);
        hewn_json_unsigned(json, "lost", stats->features_lost);
        hewn_json_end_object(json);
    }
    if (report->adaptive > 0) {
        hewn_json_object(json, "merged");
        hewn_json_unsigned(json, "uniform_vertices", stats->uniform_vertices);
        hewn_json_unsigned(json, "uniform_faces", stats->uniform_triangles);
        hewn_json_unsigned(json, "octree_merges", stats->octree_merges);
        hewn_json_unsigned(json, "pair_merges", stats->pair_merges);
        hewn_json_end_object(json);
    }
    if (report->smoothed)
        hewn_smooth_json(json, report->smooth_method, &report->smooth);
    if (report->simplified)
        hewn_simplify_json(json, &report->simplify);
    hewn_json_unsigned(json, "validation_messages", report->validation_messages);
}

static void print_result(hewn_json *json, const hewn_report *report)
{
    hewn_json_object(json, "peak");
    hewn_json_unsigned(json, "host_bytes", report->peak_host_bytes);
    hewn_json_unsigned(json, "device_bytes", report->peak_device_bytes);
    if (report->max_memory > 0)
        hewn_json_unsigned(json, "counted_bytes", report->extraction.peak_memory);
    hewn_json_end_object(json);
    if (report->max_memory > 0)
        hewn_json_unsigned(json, "parts", report->extraction.parts);
    hewn_json_object(json, "counts");
    hewn_json_unsigned(json, "vertices", report->vertices);
    hewn_json_unsigned(json, "faces", report->faces);
    hewn_json_end_object(json);
    hewn_json_object(json, "certificate");
    hewn_json_certificate(json, &report->certificate);
    hewn_json_end_object(json);
}

hewn_result hewn_report_write(const hewn_report *report, const char *path, hewn_error *error)
{
    hewn_text text = {0};
    hewn_json json = hewn_json_begin(&text);
    hewn_json_object(&json, NULL);
    hewn_json_string(&json, "version", hewn_version());
    hewn_json_string(&json, "input", report->input);
    print_request(&json, report);
    hewn_json_stages(&json, report->stages, report->stage_count, report->seconds);
    print_extraction(&json, report);
    print_result(&json, report);
    hewn_json_end_object(&json);
    hewn_result result = hewn_json_finish(&text, path, error);
    hewn_text_clear(&text);
    return result;
}
