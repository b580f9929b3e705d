#include "pipeline/json_parts.h"

#include <math.h>

#include "base/error.h"
#include "base/file.h"

void hewn_json_vector(hewn_json *json, const char *key, const double vector[3])
{
    hewn_json_array(json, key);
    for (int axis = 0; axis < 3; ++axis)
        hewn_json_number(json, NULL, vector[axis]);
    hewn_json_end_array(json);
}

void hewn_json_box(hewn_json *json, const char *key, const hewn_box *box)
{
    hewn_json_object(json, key);
    hewn_json_vector(json, "lo", box->lo);
    hewn_json_vector(json, "hi", box->hi);
    hewn_json_end_object(json);
}

void hewn_json_bodies(hewn_json *json, const char *key, const hewn_body_counts *counts)
{
    hewn_json_object(json, key);
    hewn_json_unsigned(json, "bodies", counts->bodies);
    hewn_json_unsigned(json, "cavities", counts->cavities);
    hewn_json_unsigned(json, "kept_bodies", counts->kept_bodies);
    hewn_json_unsigned(json, "kept_cavities", counts->kept_cavities);
    hewn_json_number(json, "largest_volume", counts->largest_volume);
    hewn_json_end_object(json);
}

void hewn_json_certificate(hewn_json *json, const hewn_certificate *certificate)
{
    hewn_json_bool(json, "closed", certificate->closed);
    hewn_json_bool(json, "manifold", certificate->manifold);
    hewn_json_bool(json, "oriented", certificate->oriented);
    hewn_json_unsigned(json, "components", certificate->components);
    hewn_json_integer(json, "genus", certificate->genus);
    hewn_json_number(json, "volume", certificate->volume);
    hewn_json_number(json, "area", certificate->area);
    hewn_json_box(json, "bounds", &certificate->bounds);
    hewn_json_number(json, "max_residual", certificate->max_residual);
    hewn_json_unsigned(json, "boundary_edges", certificate->boundary_edges);
    hewn_json_unsigned(json, "non_manifold_edges", certificate->non_manifold_edges);
    hewn_json_unsigned(json, "non_manifold_vertices", certificate->non_manifold_vertices);
    hewn_json_unsigned(json, "degenerate_faces", certificate->degenerate_faces);
}

void hewn_json_files(hewn_json *json, const char *input, const char *from, const char *output, const char *to)
{
    hewn_json_string(json, "version", hewn_version());
    hewn_json_string(json, "input", input);
    hewn_json_string(json, "from", from);
    hewn_json_string(json, "output", output);
    hewn_json_string(json, "to", to);
}

void hewn_json_host_peak(hewn_json *json, uint64_t bytes)
{
    hewn_json_object(json, "peak");
    hewn_json_unsigned(json, "host_bytes", bytes);
    hewn_json_end_object(json);
}

/* Microseconds are all that a wall clock is good for; more digits only make the file hard to read. */
static double microseconds(double seconds)
{
    return round(seconds * 1e6) / 1e6;
}

void hewn_json_stages(hewn_json *json, const hewn_report_stage *stages, uint32_t count, double seconds)
{
    hewn_json_number(json, "seconds", microseconds(seconds));
    hewn_json_array(json, "stages");
    for (uint32_t i = 0; i < count; ++i) {
        hewn_json_object(json, NULL);
        hewn_json_string(json, "name", stages[i].name);
        hewn_json_number(json, "begin", microseconds(stages[i].begin));
        hewn_json_number(json, "end", microseconds(stages[i].end));
        hewn_json_number(json, "seconds", microseconds(stages[i].end - stages[i].begin));
        hewn_json_end_object(json);
    }
    hewn_json_end_array(json);
}

hewn_result hewn_json_finish(const hewn_text *text, const char *path, hewn_error *error)
{
    HEWN_TRY(hewn_text_status(text, error));
    hewn_output *output = NULL;
    HEWN_TRY(hewn_output_create(path, &output, error));
    hewn_result result = hewn_output_write(output, text->bytes, text->length, error);
    if (result == HEWN_OK)
        return hewn_output_finish(&output, error);
    hewn_output_destroy(&output);
    return result;
}
