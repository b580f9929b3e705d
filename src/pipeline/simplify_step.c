#include "pipeline/simplify_step.h"

void hewn_simplify_json(hewn_json *json, const hewn_simplify_report *report)
{
    const double none = 0.0 / 0.0; /* prints as null */
    hewn_json_object(json, "simplify");
    hewn_json_unsigned(json, "triangles_before", report->triangles_before);
    hewn_json_unsigned(json, "triangles", report->triangles);
    hewn_json_unsigned(json, "target", report->target);
    hewn_json_bool(json, "reached", report->reached);
    hewn_json_unsigned(json, "runs", report->runs);
    hewn_json_unsigned(json, "dropped_faces", report->dropped_faces);
    hewn_json_unsigned(json, "dropped_vertices", report->dropped_vertices);
    hewn_json_unsigned(json, "locked_vertices", report->locked_vertices);
    hewn_json_unsigned(json, "unwalked_vertices", report->unwalked_vertices);
    hewn_json_number(json, "error_allowed", report->error_allowed > 0 ? report->error_allowed : none);
    hewn_json_number(json, "distance", report->measured ? report->distance : none);
    hewn_json_number(json, "distance_low", report->measured ? report->distance_low : none);
    hewn_json_end_object(json);
}
