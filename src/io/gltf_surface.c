/* Vertices and triangles of a glTF scene. */
#include <math.h>
#include <string.h>

#include "io/gltf_scene.h"
#include "io/welder.h"

/* --- positions ---------------------------------------------------------------------------------------------------- */

static void get_position(const hewn_gltf_items *items, const double matrix[16], bool straight, uint64_t index,
                         double out[3])
{
    double p[3];
    hewn_gltf_numbers(items, index, p);
    for (int row = 0; row < 3; row++)
        out[row] =
            straight ? p[row] : matrix[row] * p[0] + matrix[4 + row] * p[1] + matrix[8 + row] * p[2] + matrix[12 + row];
}

static hewn_result fail_position(const hewn_gltf_scene *scene, uint64_t index, hewn_error *error)
{
    return hewn_fail_at(error, HEWN_BAD_INPUT, scene->data.name, 0, "the position of vertex %llu is not finite",
                        (unsigned long long)index);
}

static bool has_minus_zero(const double position[3])
{
    for (int axis = 0; axis < 3; axis++)
        if (position[axis] == 0 && signbit(position[axis]))
            return true;
    return false;
}

/* --- seams by equal positions ------------------------------------------------------------------------------------- */

static hewn_result weld_set(hewn_gltf_scene *scene, const hewn_gltf_set *set, const double matrix[16],
                            hewn_welder *welder, bool *minus, hewn_error *error)
{
    hewn_gltf_items positions;
    bool straight = hewn_gltf_is_straight(matrix);
    HEWN_TRY(hewn_gltf_positions_of(scene, scene->data.gltf.primitives[set->primitive].positions, &positions, error));
    for (uint64_t i = 0; i < set->count; i++) {
        double p[3];
        get_position(&positions, matrix, straight, i, p);
        if (!(isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2])))
            return fail_position(scene, i, error);
        *minus = *minus || has_minus_zero(p);
        HEWN_TRY(hewn_welder_add(welder, &scene->builder, p, &scene->wedge_vertices[set->first_wedge + i], error));
        HEWN_TRY(hewn_gltf_step(scene, error));
    }
    return HEWN_OK;
}

/* The welder makes 0 of -0; a vertex gets back the bits that its first wedge has. */
static hewn_result restore_minus(hewn_gltf_scene *scene, const hewn_gltf_instance *instance, hewn_error *error)
{
    bool straight = hewn_gltf_is_straight(instance->matrix);
    for (size_t s = instance->set_count; s-- > 0;) {
        const hewn_gltf_set *set = &scene->sets[instance->first_set + s];
        hewn_gltf_items positions;
        HEWN_TRY(
            hewn_gltf_positions_of(scene, scene->data.gltf.primitives[set->primitive].positions, &positions, error));
        for (uint64_t i = set->count; i-- > 0;) {
            uint64_t vertex = scene->wedge_vertices[set->first_wedge + i];
            get_position(&positions, instance->matrix, straight, i, scene->builder.model.positions + 3 * vertex);
        }
    }
    return HEWN_OK;
}

static hewn_result weld_instance(hewn_gltf_scene *scene, const hewn_gltf_instance *instance, hewn_error *error)
{
    hewn_welder welder = {0};
    bool minus = false;
    hewn_result result = HEWN_OK;
    for (size_t s = 0; s < instance->set_count && result == HEWN_OK; s++)
        result = weld_set(scene, &scene->sets[instance->first_set + s], instance->matrix, &welder, &minus, error);
    hewn_welder_clear(&welder);
    if (result == HEWN_OK && minus)
        result = restore_minus(scene, instance, error);
    return result;
}

/* --- seams as EXT_mesh_manifold says ------------------------------------------------------------------------------ */

/* The lowest of the vertices that are one with a vertex; halves the ways to it (Tarjan and van Leeuwen 1984). */
static uint32_t find_root(uint32_t *parents, uint32_t vertex)
{
    while (parents[vertex] != vertex) {
        parents[vertex] = parents[parents[vertex]];
        vertex = parents[vertex];
    }
    return vertex;
}

static bool same_position(const hewn_gltf_items *positions, uint32_t a, uint32_t b)
{
    double of_a[3], of_b[3];
    hewn_gltf_numbers(positions, a, of_a);
    hewn_gltf_numbers(positions, b, of_b);
    return of_a[0] == of_b[0] && of_a[1] == of_b[1] && of_a[2] == of_b[2];
}

/* The sparse items of the manifold's indices name the vertices that are one with those of the other items. */
static hewn_result join_vertices(hewn_gltf_scene *scene, const hewn_gltf_mesh *mesh, const hewn_gltf_items *positions,
                                 uint32_t *parents, hewn_error *error)
{
    hewn_gltf_items split, whole;
    HEWN_TRY(hewn_gltf_indices_of(&scene->data, mesh->topology_indices, &whole, error));
    HEWN_TRY(hewn_gltf_base_of(&scene->data, mesh->topology_indices, &split, error));
    for (uint64_t i = 0; i < whole.count; i++) {
        uint32_t from = hewn_gltf_index(&split, i), to = hewn_gltf_index(&whole, i);
        if (from == to)
            continue;
        if (from >= positions->count || to >= positions->count)
            return hewn_gltf_fail(scene, "EXT_mesh_manifold merges a vertex that does not exist", error);
        if (!same_position(positions, from, to))
            return hewn_gltf_fail(scene, "EXT_mesh_manifold merges vertices at different positions", error);
        from = find_root(parents, from);
        to = find_root(parents, to);
        parents[from > to ? from : to] = from > to ? to : from;
    }
    return HEWN_OK;
}

/* Adds the vertices that are left; afterwards `parents` holds the model's vertex of each. */
static hewn_result add_joined(hewn_gltf_scene *scene, const hewn_gltf_instance *instance,
                              const hewn_gltf_items *positions, uint32_t *parents, hewn_error *error)
{
    bool straight = hewn_gltf_is_straight(instance->matrix);
    hewn_model *model = &scene->builder.model;
    for (uint32_t v = 0; v < positions->count; v++) {
        double p[3];
        get_position(positions, instance->matrix, straight, v, p);
        if (!(isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2])))
            return fail_position(scene, v, error);
        if (parents[v] != v) { /* roots are the lowest, so theirs is known already */
            parents[v] = parents[parents[v]];
            continue;
        }
        parents[v] = (uint32_t)model->vertex_count;
        HEWN_TRY(hewn_builder_add_vertex(&scene->builder, p, error));
        HEWN_TRY(hewn_gltf_step(scene, error));
    }
    return HEWN_OK;
}

static hewn_result join_instance(hewn_gltf_scene *scene, const hewn_gltf_instance *instance, hewn_error *error)
{
    const hewn_gltf *gltf = &scene->data.gltf;
    const hewn_gltf_mesh *mesh = &gltf->meshes[instance->mesh];
    hewn_gltf_items positions;
    for (size_t s = 0; s < instance->set_count; s++)
        if (gltf->primitives[scene->sets[instance->first_set + s].primitive].positions != mesh->topology_positions)
            return hewn_gltf_fail(scene, "EXT_mesh_manifold names other positions than the primitives", error);
    HEWN_TRY(hewn_gltf_positions_of(scene, mesh->topology_positions, &positions, error));
    uint32_t *parents = hewn_alloc(positions.count, sizeof *parents);
    if (!parents)
        return hewn_fail_at(error, HEWN_OUT_OF_MEMORY, scene->data.name, 0, "out of memory for vertices");
    for (uint32_t v = 0; v < positions.count; v++)
        parents[v] = v;
    hewn_result result = join_vertices(scene, mesh, &positions, parents, error);
    for (uint32_t v = 0; v < positions.count && result == HEWN_OK; v++)
        parents[v] = find_root(parents, v);
    if (result == HEWN_OK)
        result = add_joined(scene, instance, &positions, parents, error);
    for (size_t s = 0; s < instance->set_count && result == HEWN_OK; s++) {
        const hewn_gltf_set *set = &scene->sets[instance->first_set + s];
        memcpy(scene->wedge_vertices + set->first_wedge, parents, set->count * sizeof *parents);
    }
    hewn_free(parents);
    return result;
}

/* --- faces -------------------------------------------------------------------------------------------------------- */

static hewn_result add_part(hewn_gltf_scene *scene, const hewn_gltf_instance *instance, hewn_gltf_part *part,
                            hewn_error *error)
{
    const hewn_gltf_set *set = &scene->sets[part->set];
    hewn_gltf_corners corners;
    HEWN_TRY(hewn_gltf_corners_of(scene, instance, part->primitive, &corners, error));
    part->first_face = scene->builder.model.face_count;
    for (uint64_t t = 0; t < corners.triangles; t++) {
        uint64_t at[3];
        bool there = hewn_gltf_triangle(&corners, t, at);
        for (int k = 0; k < 3; k++)
            if (at[k] >= set->count)
                return hewn_fail_at(error, HEWN_BAD_INPUT, scene->data.name, 0,
                                    "a primitive names vertex %llu of its %llu", (unsigned long long)at[k],
                                    (unsigned long long)set->count);
        const uint32_t *vertices = scene->wedge_vertices + set->first_wedge;
        if (there)
            HEWN_TRY(
                hewn_builder_add_triangle(&scene->builder, vertices[at[0]], vertices[at[1]], vertices[at[2]], error));
        HEWN_TRY(hewn_gltf_step(scene, error));
    }
    part->face_count = scene->builder.model.face_count - part->first_face;
    return HEWN_OK;
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

/* Numbers wedges and makes room for all vertices at once. */
static hewn_result make_room(hewn_gltf_scene *scene, hewn_error *error)
{
    for (size_t s = 0; s < scene->set_count; s++) {
        hewn_gltf_items positions;
        hewn_gltf_set *set = &scene->sets[s];
        HEWN_TRY(
            hewn_gltf_positions_of(scene, scene->data.gltf.primitives[set->primitive].positions, &positions, error));
        HEWN_TRY(hewn_gltf_spend(&scene->data, positions.count, 3 * sizeof(double) + sizeof(uint32_t), error));
        set->first_wedge = scene->wedge_count;
        set->count = positions.count;
        scene->wedge_count += positions.count;
    }
    for (size_t i = 0; i < scene->instance_count; i++) {
        const hewn_gltf_instance *instance = &scene->instances[i];
        for (size_t p = 0; p < instance->part_count; p++) {
            hewn_gltf_corners corners;
            HEWN_TRY(hewn_gltf_corners_of(scene, instance, scene->parts[instance->first_part + p].primitive, &corners,
                                          error));
            HEWN_TRY(hewn_gltf_spend(&scene->data, corners.triangles, 3 * sizeof(uint32_t), error));
            scene->most_steps += corners.triangles;
        }
    }
    scene->most_steps += scene->wedge_count;
    if (scene->wedge_count >= HEWN_NONE)
        return hewn_fail_at(error, HEWN_LIMIT, scene->data.name, 0, "more vertices than indices can name");
    scene->wedge_vertices = hewn_alloc(scene->wedge_count, sizeof *scene->wedge_vertices);
    if (!scene->wedge_vertices)
        return hewn_fail_at(error, HEWN_OUT_OF_MEMORY, scene->data.name, 0, "out of memory for %llu vertices",
                            (unsigned long long)scene->wedge_count);
    void *positions = NULL;
    hewn_result result =
        hewn_reserve(&positions, &scene->builder.position_room, scene->wedge_count, 3 * sizeof(double), error);
    scene->builder.model.positions = positions;
    return result;
}

hewn_result hewn_gltf_add_surfaces(hewn_gltf_scene *scene, hewn_error *error)
{
    HEWN_TRY(make_room(scene, error));
    for (size_t i = 0; i < scene->instance_count; i++) {
        const hewn_gltf_instance *instance = &scene->instances[i];
        if (scene->data.gltf.meshes[instance->mesh].has_topology)
            HEWN_TRY(join_instance(scene, instance, error));
        else
            HEWN_TRY(weld_instance(scene, instance, error));
        for (size_t p = 0; p < instance->part_count; p++)
            HEWN_TRY(add_part(scene, instance, &scene->parts[instance->first_part + p], error));
    }
    return HEWN_OK;
}
