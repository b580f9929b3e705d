/* The report of a job from volume to mesh, as JSON. */
#include "base/json.h"
#include "hewn/volume_job.h"
#include "pipeline/json_parts.h"
#include "pipeline/simplify_step.h"
#include "pipeline/smooth_step.h"

static void print_iso(hewn_json *json, const hewn_volume_report *report)
{
    static const char *const kinds[] = {[HEWN_ISO_NUMBER] = "number",
                                        [HEWN_ISO_OTSU] = "otsu",
                                        [HEWN_ISO_PERCENTILE] = "percentile",
                                        [HEWN_ISO_HOUNSFIELD] = "hounsfield"};
    hewn_json_object(json, "iso");
    hewn_json_string(json, "kind", kinds[report->iso.kind]);
    hewn_json_bool(json, "chosen", report->iso_chosen);
    hewn_json_number(json, "value", report->iso_value);
    hewn_json_string(json, "inside", report->extraction.below ? "below" : "above");
    hewn_json_end_object(json);
}

static void print_place(hewn_json *json, const hewn_volume_report *report)
{
    hewn_json_string(json, "space", hewn_space_name(report->space));
    hewn_json_string(json, "unit_before", report->unit_before ? report->unit_before->name : NULL);
    hewn_json_string(json, "unit", report->unit ? report->unit->name : NULL);
    hewn_json_bool(json, "unit_assumed", report->unit_assumed);
    hewn_json_bool(json, "anatomical", report->anatomical);
    hewn_json_bool(json, "left_handed", report->left_handed);
    hewn_json_array(json, "place");
    for (int i = 0; i < 16; i++)
        hewn_json_number(json, NULL, report->place[i]);
    hewn_json_end_array(json);
}

static void print_volume(hewn_json *json, const hewn_volume_report *report)
{
    hewn_json_array(json, "dims");
    for (int axis = 0; axis < 3; axis++)
        hewn_json_unsigned(json, NULL, report->dims[axis]);
    hewn_json_end_array(json);
    hewn_json_string(json, "type", hewn_voxel_name(report->type));
    hewn_json_number(json, "slope", report->slope);
    hewn_json_number(json, "intercept", report->intercept);
    hewn_json_unsigned(json, "frames", report->frame_count);
    hewn_json_unsigned(json, "frame", report->frame);
    hewn_json_string(json, "remark", report->remark);
    hewn_json_object(json, "range");
    hewn_json_number(json, "lo", report->range.lo);
    hewn_json_number(json, "hi", report->range.hi);
    hewn_json_unsigned(json, "finite", report->range.finite_count);
    hewn_json_unsigned(json, "nan", report->range.nan_count);
    hewn_json_unsigned(json, "infinite", report->range.infinite_count);
    hewn_json_end_object(json);
    hewn_json_array(json, "histogram");
    for (int i = 0; i < HEWN_VOLUME_REPORT_BINS; i++)
        hewn_json_unsigned(json, NULL, report->bins[i]);
    hewn_json_end_array(json);
}

/* What was done besides; each only where it was asked for. */
static void print_steps(hewn_json *json, const hewn_volume_report *report)
{
    const hewn_body_counts *bodies = &report->extraction.bodies;
    if (report->filter.length > 0) {
        hewn_json_object(json, "filter");
        hewn_json_string(json, "kind", report->filter.filter == HEWN_VOLUME_MEDIAN ? "median" : "gaussian");
        hewn_json_number(json, "length", report->filter.length);
        hewn_json_end_object(json);
    }
    if (bodies->bodies > 0)
        hewn_json_bodies(json, "bodies", bodies);
    if (report->smoothed)
        hewn_smooth_json(json, report->smooth_method, &report->smooth);
    if (report->simplified)
        hewn_simplify_json(json, &report->simplify);
}

static void print_mesh(hewn_json *json, const hewn_volume_report *report)
{
    const hewn_volume_extract_stats *stats = &report->extraction;
    hewn_json_string(json, "method", hewn_method_name(report->method));
    hewn_json_bool(json, "open", report->open);
    hewn_json_unsigned(json, "active_cells", stats->active_cells);
    hewn_json_unsigned(json, "decided_cells", stats->decided_cells);
    hewn_json_unsigned(json, "cap_vertices", stats->cap_vertices);
    hewn_json_bool(json, "box_shaped", report->box_shaped);
    hewn_json_object(json, "peak");
    hewn_json_unsigned(json, "host_bytes", report->peak_host_bytes);
    hewn_json_end_object(json);
    hewn_json_object(json, "counts");
    hewn_json_unsigned(json, "vertices", report->vertices);
    hewn_json_unsigned(json, "faces", report->faces);
    hewn_json_end_object(json);
    hewn_json_object(json, "certificate");
    hewn_json_certificate(json, &report->certificate);
    hewn_json_end_object(json);
}

hewn_result hewn_volume_report_write(const hewn_volume_report *report, const char *path, hewn_error *error)
{
    hewn_text text = {0};
    hewn_json json = hewn_json_begin(&text);
    hewn_json_object(&json, NULL);
    hewn_json_string(&json, "version", hewn_version());
    hewn_json_string(&json, "input", report->input);
    hewn_json_string(&json, "from", hewn_volume_format_name(report->from));
    hewn_json_string(&json, "output", report->output);
    hewn_json_string(&json, "format", hewn_mesh_format_name(report->to));
    print_iso(&json, report);
    print_place(&json, report);
    hewn_json_stages(&json, report->stages, report->stage_count, report->seconds);
    print_volume(&json, report);
    print_steps(&json, report);
    print_mesh(&json, report);
    hewn_json_end_object(&json);
    hewn_result result = hewn_json_finish(&text, path, error);
    hewn_text_clear(&text);
    return result;
}
