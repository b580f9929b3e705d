#include "base/alloc.h"
#include "pipeline/json_parts.h"
#include "pipeline/label_job.h"
#include "pipeline/simplify_step.h"
#include "pipeline/smooth_step.h"

void hewn_label_report_destroy(hewn_label_report *report)
{
    for (uint32_t n = 0; n < report->label_count; n++) {
        hewn_free(report->labels[n].name);
        hewn_free(report->labels[n].path);
    }
    hewn_free(report->labels);
    hewn_free(report->missing);
    hewn_free(report->input);
    hewn_free(report->output);
    *report = (hewn_label_report){0};
}

static void print_label(hewn_json *json, const hewn_label_fact *fact)
{
    hewn_json_object(json, NULL);
    hewn_json_integer(json, "label", fact->label);
    hewn_json_string(json, "name", fact->name);
    hewn_json_array(json, "color");
    for (int k = 0; k < 4; k++)
        hewn_json_unsigned(json, NULL, fact->color[k]);
    hewn_json_end_array(json);
    hewn_json_string(json, "output", fact->path);
    hewn_json_unsigned(json, "voxels", fact->voxels);
    hewn_json_unsigned(json, "vertices", fact->vertices);
    hewn_json_unsigned(json, "faces", fact->faces);
    hewn_json_object(json, "certificate");
    hewn_json_certificate(json, &fact->certificate);
    hewn_json_end_object(json);
    hewn_json_end_object(json);
}

static void print_conversion(hewn_json *json, const hewn_label_report *report)
{
    const hewn_conversion *done = &report->conversion;
    hewn_json_string(json, "world", report->anatomical ? "RAS" : NULL);
    hewn_json_string(json, "space", hewn_space_name(report->space));
    hewn_json_object(json, "conversion");
    hewn_json_string(json, "unit_before", done->unit_before ? done->unit_before->name : NULL);
    hewn_json_string(json, "unit_after", done->unit_after ? done->unit_after->name : NULL);
    hewn_json_bool(json, "unit_assumed", done->unit_assumed || report->unit_assumed);
    hewn_json_string(json, "up_after", report->up_known ? hewn_axis_name(done->up_after) : NULL);
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

hewn_result hewn_label_report_write(const hewn_label_report *report, const char *path, hewn_error *error)
{
    hewn_text text = {0};
    hewn_json json = hewn_json_begin(&text);
    hewn_json_object(&json, NULL);
    hewn_json_files(&json, report->input, hewn_volume_format_name(report->from), report->output,
                    hewn_mesh_format_name(report->to));
    hewn_json_stages(&json, report->stages, report->stage_count, report->seconds);
    hewn_json_host_peak(&json, report->peak_host_bytes);
    hewn_json_array(&json, "dims");
    for (int axis = 0; axis < 3; axis++)
        hewn_json_unsigned(&json, NULL, report->dims[axis]);
    hewn_json_end_array(&json);
    print_conversion(&json, report);
    hewn_json_unsigned(&json, "relaxations", report->relaxations);
    if (report->smoothed)
        hewn_smooth_json(&json, report->smooth_method, &report->smooth);
    if (report->islands.bodies > 0)
        hewn_json_bodies(&json, "islands", &report->islands);
    if (report->simplified)
        hewn_simplify_json(&json, &report->simplify);
    hewn_json_object(&json, "counts"); /* of the mesh that the shells share */
    hewn_json_unsigned(&json, "vertices", report->vertices);
    hewn_json_unsigned(&json, "faces", report->faces);
    hewn_json_end_object(&json);
    hewn_json_array(&json, "missing");
    for (uint32_t i = 0; i < report->missing_count; i++)
        hewn_json_integer(&json, NULL, report->missing[i]);
    hewn_json_end_array(&json);
    hewn_json_array(&json, "labels");
    for (uint32_t n = 0; n < report->label_count; n++)
        print_label(&json, &report->labels[n]);
    hewn_json_end_array(&json);
    hewn_json_end_object(&json);
    hewn_result result = hewn_json_finish(&text, path, error);
    hewn_text_clear(&text);
    return result;
}
