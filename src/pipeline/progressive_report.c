#include "base/alloc.h"
#include "hewn/progressive_job.h"
#include "pipeline/json_parts.h"

void hewn_progressive_report_destroy(hewn_progressive_report *report)
{
    if (!report)
        return;
    hewn_free(report->input);
    hewn_free(report->output);
    hewn_free(report->marks);
    *report = (hewn_progressive_report){0};
}

static void print_progressive(hewn_json *json, const hewn_progressive_info *info)
{
    hewn_json_object(json, "progressive");
    hewn_json_unsigned(json, "base_vertices", info->base_vertices);
    hewn_json_unsigned(json, "base_triangles", info->base_triangles);
    hewn_json_unsigned(json, "vertices", info->vertices);
    hewn_json_unsigned(json, "triangles", info->triangles);
    hewn_json_unsigned(json, "faces", info->faces);
    hewn_json_unsigned(json, "splits", info->splits);
    hewn_json_unsigned(json, "splits_there", info->splits_there);
    hewn_json_bool(json, "complete", info->complete);
    hewn_json_array(json, "marks");
    for (uint32_t i = 0; i < info->mark_count; i++) {
        hewn_json_object(json, NULL);
        hewn_json_unsigned(json, "splits", info->marks[i].splits);
        hewn_json_unsigned(json, "triangles", info->marks[i].triangles);
        hewn_json_number(json, "error", info->marks[i].error);
        hewn_json_number(json, "error_low", info->marks[i].error_low);
        hewn_json_end_object(json);
    }
    hewn_json_end_array(json);
    hewn_json_end_object(json);
}

hewn_result hewn_progressive_report_write(const hewn_progressive_report *report, const char *path, hewn_error *error)
{
    hewn_text text = {0};
    hewn_json json = hewn_json_begin(&text);
    hewn_json_object(&json, NULL);
    hewn_json_files(&json, report->input, hewn_mesh_format_name(report->from), report->output,
                    hewn_mesh_format_name(report->to));
    hewn_json_stages(&json, report->stages, report->stage_count, report->seconds);
    hewn_json_host_peak(&json, report->peak_host_bytes);
    print_progressive(&json, &report->info);
    hewn_json_object(&json, "counts");
    hewn_json_unsigned(&json, "splits", report->to == HEWN_MESH_HPM ? report->info.splits : report->splits);
    hewn_json_unsigned(&json, "vertices", report->vertices);
    hewn_json_unsigned(&json, "triangles", report->triangles);
    hewn_json_end_object(&json);
    hewn_json_end_object(&json);
    hewn_result result = hewn_json_finish(&text, path, error);
    hewn_text_clear(&text);
    return result;
}
