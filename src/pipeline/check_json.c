#include "pipeline/check_json.h"

#include "pipeline/json_parts.h"

static void print_component(hewn_json *json, const hewn_component *part)
{
    hewn_json_object(json, NULL);
    hewn_json_unsigned(json, "vertices", part->vertices);
    hewn_json_unsigned(json, "edges", part->edges);
    hewn_json_unsigned(json, "faces", part->faces);
    hewn_json_integer(json, "euler", part->euler);
    hewn_json_bool(json, "closed", part->closed);
    hewn_json_bool(json, "manifold", part->manifold);
    hewn_json_bool(json, "oriented", part->oriented);
    hewn_json_bool(json, "orientable", part->orientable);
    hewn_json_integer(json, "genus", part->genus);
    hewn_json_unsigned(json, "boundary_edges", part->boundary_edges);
    hewn_json_unsigned(json, "boundary_loops", part->boundary_loops);
    hewn_json_unsigned(json, "non_manifold_edges", part->non_manifold_edges);
    hewn_json_unsigned(json, "non_manifold_vertices", part->non_manifold_vertices);
    hewn_json_number(json, "volume", part->volume);
    hewn_json_number(json, "area", part->area);
    hewn_json_box(json, "bounds", &part->bounds);
    hewn_json_end_object(json);
}

static void print_crossings(hewn_json *json, const hewn_check *check)
{
    if (check->self_intersections_known)
        hewn_json_unsigned(json, "self_intersections", check->self_intersections);
    else
        hewn_json_string(json, "self_intersections", NULL);
    hewn_json_array(json, "intersecting_faces");
    for (uint32_t i = 0; i < check->pair_count; i++) {
        hewn_json_array(json, NULL);
        hewn_json_unsigned(json, NULL, check->pairs[i][0]);
        hewn_json_unsigned(json, NULL, check->pairs[i][1]);
        hewn_json_end_array(json);
    }
    hewn_json_end_array(json);
}

void hewn_json_check(hewn_json *json, const char *key, const hewn_check *check)
{
    hewn_json_object(json, key);
    hewn_json_certificate(json, &check->certificate);
    hewn_json_bool(json, "orientable", check->orientable);
    hewn_json_integer(json, "euler", check->euler);
    hewn_json_unsigned(json, "edges", check->edges);
    hewn_json_unsigned(json, "boundary_loops", check->boundary_loops);
    hewn_json_unsigned(json, "unoriented_edges", check->unoriented_edges);
    hewn_json_unsigned(json, "duplicate_faces", check->duplicate_faces);
    hewn_json_unsigned(json, "isolated_vertices", check->isolated_vertices);
    print_crossings(json, check);
    hewn_json_array(json, "component_list");
    for (uint32_t i = 0; i < check->component_count; i++)
        print_component(json, &check->components[i]);
    hewn_json_end_array(json);
    hewn_json_end_object(json);
}
