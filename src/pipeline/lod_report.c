#include "base/alloc.h"
#include "hewn/lod_job.h"
#include "pipeline/json_parts.h"

void hewn_lod_report_destroy(hewn_lod_report *report)
{
    if (!report)
        return;
    for (uint32_t i = 0; i < report->level_count; i++)
        hewn_free(report->levels[i].output);
    hewn_free(report->levels);
    hewn_free(report->input);
    hewn_free(report->output);
    *report = (hewn_lod_report){0};
}

static void print_level(hewn_json *json, const hewn_lod_report *report, const hewn_lod_report_level *level)
{
    hewn_json_object(json, NULL);
    if (level->output)
        hewn_json_string(json, "output", level->output);
    hewn_json_unsigned(json, "vertices", level->vertices);
    hewn_json_unsigned(json, "triangles", level->triangles);
    hewn_json_number(json, "error", level->error);
    hewn_json_number(json, "error_low", level->error_low);
    hewn_json_number(json, "error_rel", report->diagonal > 0 ? level->error / report->diagonal : 0);
    hewn_json_number(json, "screen_coverage", level->coverage);
    hewn_json_bool(json, "reached", level->reached);
    hewn_json_end_object(json);
}

hewn_result hewn_lod_report_write(const hewn_lod_report *report, const char *path, hewn_error *error)
{
    hewn_text text = {0};
    hewn_json json = hewn_json_begin(&text);
    hewn_json_object(&json, NULL);
    hewn_json_files(&json, report->input, hewn_mesh_format_name(report->from), report->output,
                    hewn_mesh_format_name(report->to));
    hewn_json_stages(&json, report->stages, report->stage_count, report->seconds);
    hewn_json_host_peak(&json, report->peak_host_bytes);
    hewn_json_object(&json, "counts_before");
    hewn_json_unsigned(&json, "vertices", report->vertices_before);
    hewn_json_unsigned(&json, "faces", report->faces_before);
    hewn_json_unsigned(&json, "triangles", report->triangles_before);
    hewn_json_end_object(&json);
    hewn_json_number(&json, "diagonal", report->diagonal);
    hewn_json_array(&json, "levels");
    for (uint32_t i = 0; i < report->level_count; i++)
        print_level(&json, report, &report->levels[i]);
    hewn_json_end_array(&json);
    hewn_json_end_object(&json);
    hewn_result result = hewn_json_finish(&text, path, error);
    hewn_text_clear(&text);
    return result;
}
