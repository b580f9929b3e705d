#include "base/alloc.h"
#include "base/error.h"
#include "hewn/file_job.h"
#include "pipeline/check_json.h"
#include "pipeline/json_parts.h"
#include "pipeline/losses.h"
#include "pipeline/repair_counts.h"
#include "pipeline/simplify_step.h"
#include "pipeline/smooth_step.h"
#include "pipeline/subdivide_step.h"

void hewn_file_report_destroy(hewn_file_report *report)
{
    if (!report)
        return;
    hewn_free(report->input);
    hewn_free(report->output);
    hewn_losses_destroy(&report->losses);
    hewn_check_destroy(&report->check);
    *report = (hewn_file_report){0};
}

static void print_counts(hewn_json *json, const char *key, uint64_t vertices, uint64_t faces)
{
    hewn_json_object(json, key);
    hewn_json_unsigned(json, "vertices", vertices);
    hewn_json_unsigned(json, "faces", faces);
    hewn_json_end_object(json);
}

static const char *unit_name(const hewn_unit *unit)
{
    return unit ? unit->name : NULL;
}

/* What the input was before: as the caller says, else as the file does; null where neither does. */
static void print_conversion(hewn_json *json, const hewn_file_report *report)
{
    const hewn_conversion *done = &report->conversion;
    hewn_json_object(json, "conversion");
    hewn_json_string(json, "unit_in_file", unit_name(report->file_unit));
    hewn_json_string(json, "up_in_file", report->file_up_known ? hewn_axis_name(report->file_up) : NULL);
    hewn_json_string(json, "unit_before", unit_name(done->unit_before));
    hewn_json_string(json, "unit_after", unit_name(done->unit_after));
    hewn_json_bool(json, "unit_assumed", done->unit_assumed);
    hewn_json_string(json, "up_before", report->up_known && !done->up_assumed ? hewn_axis_name(done->up_before) : NULL);
    hewn_json_string(json, "up_after", report->up_known ? hewn_axis_name(done->up_after) : NULL);
    hewn_json_bool(json, "up_assumed", done->up_assumed);
    hewn_json_array(json, "scale");
    hewn_json_unsigned(json, NULL, done->scale_numerator);
    hewn_json_unsigned(json, NULL, done->scale_denominator);
    hewn_json_end_array(json);
    hewn_json_array(json, "rotation");
    for (int i = 0; i < 9; i++)
        hewn_json_integer(json, NULL, done->rotation[i]);
    hewn_json_end_array(json);
    hewn_json_end_object(json);
}

static void print_repair(hewn_json *json, const hewn_repair_report *repair)
{
    const hewn_repair_count *count;
    hewn_json_object(json, "repair");
    for (size_t i = 0; (count = hewn_repair_count_at(i)) != NULL; i++)
        hewn_json_unsigned(json, count->name, hewn_repair_count_of(repair, count));
    hewn_json_end_object(json);
}

static void print_losses(hewn_json *json, const hewn_file_losses *lost)
{
    hewn_json_object(json, "not_kept");
    hewn_json_unsigned(json, "cut_faces", lost->cut_faces);
    hewn_json_array(json, "attributes");
    for (uint32_t i = 0; i < lost->channel_count; i++)
        hewn_json_string(json, NULL, lost->channels[i]);
    hewn_json_end_array(json);
    hewn_json_unsigned(json, "rounded_vertices", lost->rounded);
    hewn_json_number(json, "rounding", lost->rounding);
    hewn_json_unsigned(json, "isolated_vertices", lost->isolated);
    hewn_json_unsigned(json, "rejoined_vertices", lost->rejoined);
    hewn_json_end_object(json);
}

static void print_limit(hewn_json *json, const hewn_file_report *report)
{
    if (report->max_memory == 0) {
        hewn_json_string(json, "max_memory", NULL);
        return;
    }
    hewn_json_unsigned(json, "max_memory", report->max_memory);
    hewn_json_unsigned(json, "passes", report->passes);
    hewn_json_unsigned(json, "parts", report->parts);
    hewn_json_unsigned(json, "disk_bytes", report->disk_bytes);
}

hewn_result hewn_file_report_write(const hewn_file_report *report, const char *path, hewn_error *error)
{
    hewn_text text = {0};
    hewn_json json = hewn_json_begin(&text);
    hewn_json_object(&json, NULL);
    hewn_json_files(&json, report->input, hewn_mesh_format_name(report->from), report->output,
                    hewn_mesh_format_name(report->to));
    hewn_json_stages(&json, report->stages, report->stage_count, report->seconds);
    hewn_json_host_peak(&json, report->peak_host_bytes);
    print_limit(&json, report);
    print_counts(&json, "counts_before", report->vertices_before, report->faces_before);
    print_counts(&json, "counts", report->vertices, report->faces);
    print_conversion(&json, report);
    if (report->repaired)
        print_repair(&json, &report->repair);
    if (report->subdivided)
        hewn_subdivide_json(&json, report->scheme, &report->subdivide);
    if (report->simplified)
        hewn_simplify_json(&json, &report->simplify);
    if (report->smoothed)
        hewn_smooth_json(&json, report->smooth_method, &report->smooth);
    if (report->check)
        hewn_json_check(&json, "certificate", report->check);
    print_losses(&json, &report->losses);
    hewn_json_end_object(&json);
    hewn_result result = hewn_json_finish(&text, path, error);
    hewn_text_clear(&text);
    return result;
}
