#include "pipeline/voxelize_report.h"

#include "base/json.h"
#include "pipeline/json_parts.h"

hewn_result hewn_voxelize_report_write(const hewn_voxelize_report *report, const char *path, hewn_error *error)
{
    hewn_text text = {0};
    hewn_json json = hewn_json_begin(&text);
    hewn_json_object(&json, NULL);
    hewn_json_string(&json, "version", hewn_version());
    hewn_json_string(&json, "format", hewn_volume_format_name(report->written.format));
    hewn_json_string(&json, "unit", report->unit ? report->unit->name : NULL);
    hewn_json_number(&json, "cell", report->cell);
    hewn_json_number(&json, "band", report->band);
    hewn_json_array(&json, "origin");
    for (int i = 0; i < 3; i++)
        hewn_json_number(&json, NULL, report->origin[i]);
    hewn_json_end_array(&json);
    hewn_json_array(&json, "dims");
    for (int i = 0; i < 3; i++)
        hewn_json_unsigned(&json, NULL, report->written.dims[i]);
    hewn_json_end_array(&json);
    hewn_json_unsigned(&json, "active", report->written.active);
    if (report->is_mesh) {
        hewn_json_object(&json, "mesh");
        hewn_json_unsigned(&json, "vertices", report->vertices);
        hewn_json_unsigned(&json, "faces", report->faces);
        hewn_json_number(&json, "confidence", report->mesh.confidence);
        hewn_json_number(&json, "doubtful", report->mesh.doubtful);
        hewn_json_end_object(&json);
    }
    hewn_json_unsigned(&json, "file_bytes", report->written.length);
    hewn_json_unsigned(&json, "sample_bytes", report->bytes);
    hewn_json_object(&json, "peak");
    hewn_json_unsigned(&json, "host_bytes", report->peak_host_bytes);
    hewn_json_end_object(&json);
    hewn_json_number(&json, "seconds", report->seconds);
    hewn_json_end_object(&json);
    hewn_result result = hewn_json_finish(&text, path, error);
    hewn_text_clear(&text);
    return result;
}
