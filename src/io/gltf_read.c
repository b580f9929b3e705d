/* glTF 2.0 and GLB: the triangles of the scene to show, with the transforms of its nodes. */
#include <math.h>
#include <string.h>

#include "base/progress.h"
#include "io/bytes.h"
#include "io/formats.h"
#include "io/gltf_scene.h"

enum { MAGIC = 0x46546C67, JSON_CHUNK = 0x4E4F534A, BINARY_CHUNK = 0x004E4942 };
enum { TRIANGLES = 4, STRIP = 5, FAN = 6 };

static const double IDENTITY[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

hewn_result hewn_gltf_fail(const hewn_gltf_scene *scene, const char *what, hewn_error *error)
{
    return hewn_fail_at(error, HEWN_BAD_INPUT, scene->data.name, 0, "%s", what);
}

hewn_result hewn_gltf_step(hewn_gltf_scene *scene, hewn_error *error)
{
    if (++scene->steps % (1 << 14) != 0)
        return HEWN_OK;
    double fraction = (double)scene->steps / (double)(scene->most_steps + 1);
    return hewn_progress_report(scene->progress, "load", fmin(fraction, 1), error);
}

/* --- the container ------------------------------------------------------------------------------------------------ */

typedef struct container {
    const char *json;
    size_t json_length;
} container;

/* GLB: a header of 12 bytes, then chunks of length, type and content; JSON comes first, binary data may follow. */
static hewn_result open_container(hewn_gltf_scene *scene, const char *bytes, size_t length, container *out,
                                  hewn_error *error)
{
    if (length < 4 || hewn_get_u32(bytes) != MAGIC) {
        const char *name = scene->data.name;
        size_t tail = strlen(name);
        if (tail >= 4 && (memcmp(name + tail - 4, ".glb", 4) == 0 || memcmp(name + tail - 4, ".GLB", 4) == 0))
            return hewn_gltf_fail(scene, "this is not a GLB file: it does not begin with \"glTF\"", error);
        *out = (container){bytes, length};
        return HEWN_OK;
    }
    if (length < 20)
        return hewn_gltf_fail(scene, "the file ends within the headers of GLB", error);
    if (hewn_get_u32(bytes + 4) != 2)
        return hewn_gltf_fail(scene, "this is not version 2 of GLB", error);
    uint64_t total = hewn_get_u32(bytes + 8), text = hewn_get_u32(bytes + 12);
    if (total > length)
        return hewn_gltf_fail(scene, "the file is shorter than its header says", error);
    if (hewn_get_u32(bytes + 16) != JSON_CHUNK)
        return hewn_gltf_fail(scene, "the first chunk is not JSON", error);
    if (total < 20 || text > total - 20)
        return hewn_gltf_fail(scene, "the JSON chunk ends past the file", error);
    *out = (container){bytes + 20, (size_t)text};
    const char *rest = bytes + 20 + text;
    uint64_t left = total - 20 - text;
    if (left < 8)
        return HEWN_OK;
    if (hewn_get_u32(rest) > left - 8)
        return hewn_gltf_fail(scene, "the binary chunk ends past the file", error);
    if (hewn_get_u32(rest + 4) == BINARY_CHUNK) {
        scene->data.chunk = rest + 8;
        scene->data.chunk_length = hewn_get_u32(rest);
    }
    return HEWN_OK;
}

/* --- which meshes are where --------------------------------------------------------------------------------------- */

/* Whether two primitives have the same accessors for their vertices. */
static bool share_vertices(const hewn_gltf *gltf, const hewn_gltf_primitive *a, const hewn_gltf_primitive *b)
{
    bool same = a->positions == b->positions && a->attribute_count == b->attribute_count;
    for (size_t i = 0; same && i < a->attribute_count; i++) {
        const hewn_gltf_attribute *of_a = &gltf->attributes[a->first_attribute + i];
        const hewn_gltf_attribute *of_b = &gltf->attributes[b->first_attribute + i];
        same = of_a->accessor == of_b->accessor && strcmp(of_a->semantic, of_b->semantic) == 0;
    }
    return same;
}

/* The set that a primitive's vertices belong to. Only the latest few are looked at, so that time stays linear. */
static hewn_result place_set(hewn_gltf_scene *scene, hewn_gltf_instance *instance, size_t primitive, size_t *out,
                             hewn_error *error)
{
    const hewn_gltf *gltf = &scene->data.gltf;
    for (size_t back = 1; back <= 8 && back <= instance->set_count; back++) {
        *out = scene->set_count - back;
        if (share_vertices(gltf, &gltf->primitives[primitive], &gltf->primitives[scene->sets[*out].primitive]))
            return HEWN_OK;
    }
    HEWN_TRY(hewn_gltf_spend(&scene->data, 1, sizeof(hewn_gltf_set), error));
    void *items = scene->sets;
    HEWN_TRY(hewn_reserve(&items, &scene->set_room, scene->set_count + 1, sizeof(hewn_gltf_set), error));
    scene->sets = items;
    scene->sets[scene->set_count] = (hewn_gltf_set){.primitive = primitive};
    *out = scene->set_count++;
    instance->set_count++;
    return HEWN_OK;
}

static hewn_result place_part(hewn_gltf_scene *scene, hewn_gltf_instance *instance, size_t primitive, hewn_error *error)
{
    size_t set;
    if (scene->data.gltf.primitives[primitive].mode > FAN)
        return hewn_gltf_fail(scene, "a primitive has a mode that glTF does not know", error);
    if (scene->data.gltf.primitives[primitive].positions == HEWN_GLTF_NONE)
        return hewn_gltf_fail(scene, "a primitive has no positions", error);
    HEWN_TRY(place_set(scene, instance, primitive, &set, error));
    HEWN_TRY(hewn_gltf_spend(&scene->data, 1, sizeof(hewn_gltf_part), error));
    void *items = scene->parts;
    HEWN_TRY(hewn_reserve(&items, &scene->part_room, scene->part_count + 1, sizeof(hewn_gltf_part), error));
    scene->parts = items;
    scene->parts[scene->part_count++] = (hewn_gltf_part){.primitive = primitive, .set = set};
    instance->part_count++;
    return HEWN_OK;
}

static hewn_result place_mesh(hewn_gltf_scene *scene, int number, const char *name, const double matrix[16],
                              hewn_error *error)
{
    const hewn_gltf *gltf = &scene->data.gltf;
    if (number < 0 || (size_t)number >= gltf->mesh_count)
        return hewn_gltf_fail(scene, "a node names a mesh that does not exist", error);
    const hewn_gltf_mesh *mesh = &gltf->meshes[number];
    hewn_gltf_instance instance = {.name = name[0] ? name : mesh->name,
                                   .mesh = number,
                                   .first_part = scene->part_count,
                                   .first_set = scene->set_count};
    memcpy(instance.matrix, matrix, sizeof instance.matrix);
    for (size_t i = 0; i < mesh->primitive_count; i++)
        if (gltf->primitives[mesh->first_primitive + i].mode >= TRIANGLES) /* others are points and lines */
            HEWN_TRY(place_part(scene, &instance, mesh->first_primitive + i, error));
    if (instance.part_count == 0)
        return HEWN_OK;
    HEWN_TRY(hewn_gltf_spend(&scene->data, 1, sizeof(hewn_gltf_instance), error));
    void *items = scene->instances;
    HEWN_TRY(hewn_reserve(&items, &scene->instance_room, scene->instance_count + 1, sizeof instance, error));
    scene->instances = items;
    scene->instances[scene->instance_count++] = instance;
    return HEWN_OK;
}

static void multiply(const double a[16], const double b[16], double out[16])
{
    for (int column = 0; column < 4; column++)
        for (int row = 0; row < 4; row++) {
            double sum = 0;
            for (int k = 0; k < 4; k++)
                sum += a[4 * k + row] * b[4 * column + k];
            out[4 * column + row] = sum;
        }
}

typedef struct gltf_visit {
    size_t node;
    double matrix[16]; /* of its parent */
} gltf_visit;

/* Nodes to come, and which were seen: glTF's nodes form trees, so none may be met twice. */
typedef struct gltf_walk {
    gltf_visit *stack;
    size_t count, room;
    bool *seen;
} gltf_walk;

static hewn_result push_nodes(hewn_gltf_scene *scene, gltf_walk *walk, const int *nodes, size_t count,
                              const double matrix[16], hewn_error *error)
{
    for (size_t i = count; i-- > 0;) { /* backwards, so that the first is taken first */
        if (nodes[i] < 0 || (size_t)nodes[i] >= scene->data.gltf.node_count)
            return hewn_gltf_fail(scene, "the scene names a node that does not exist", error);
        if (walk->seen[nodes[i]])
            return hewn_gltf_fail(scene, "a node stands in the scene twice", error);
        walk->seen[nodes[i]] = true;
        void *items = walk->stack;
        HEWN_TRY(hewn_reserve(&items, &walk->room, walk->count + 1, sizeof(gltf_visit), error));
        walk->stack = items;
        gltf_visit *next = &walk->stack[walk->count++];
        next->node = (size_t)nodes[i];
        memcpy(next->matrix, matrix, sizeof next->matrix);
    }
    return HEWN_OK;
}

static hewn_result walk_nodes(hewn_gltf_scene *scene, gltf_walk *walk, hewn_error *error)
{
    const hewn_gltf *gltf = &scene->data.gltf;
    HEWN_TRY(push_nodes(scene, walk, gltf->roots, gltf->root_count, IDENTITY, error));
    while (walk->count > 0) {
        gltf_visit visit = walk->stack[--walk->count];
        const hewn_gltf_node *node = &gltf->nodes[visit.node];
        double matrix[16];
        multiply(visit.matrix, node->matrix, matrix);
        if (node->mesh != HEWN_GLTF_NONE)
            HEWN_TRY(place_mesh(scene, node->mesh, node->name, matrix, error));
        if (node->child_count > 0)
            HEWN_TRY(push_nodes(scene, walk, gltf->children + node->first_child, node->child_count, matrix, error));
    }
    return HEWN_OK;
}

static hewn_result place_all(hewn_gltf_scene *scene, hewn_error *error)
{
    const hewn_gltf *gltf = &scene->data.gltf;
    if (gltf->node_count == 0) { /* meshes alone: a library of them, say */
        for (size_t mesh = 0; mesh < gltf->mesh_count; mesh++)
            HEWN_TRY(place_mesh(scene, (int)mesh, "", IDENTITY, error));
        return HEWN_OK;
    }
    gltf_walk walk = {.seen = hewn_alloc_zero(gltf->node_count, sizeof *walk.seen)};
    hewn_result result =
        walk.seen ? walk_nodes(scene, &walk, error) : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for nodes");
    hewn_free(walk.stack);
    hewn_free(walk.seen);
    return result;
}

/* --- corners ------------------------------------------------------------------------------------------------------ */

bool hewn_gltf_is_straight(const double matrix[16])
{
    return memcmp(matrix, IDENTITY, sizeof IDENTITY) == 0;
}

bool hewn_gltf_cofactors(const double matrix[16], double out[9])
{
    for (int column = 0; column < 3; column++) {
        const double *a = matrix + 4 * ((column + 1) % 3), *b = matrix + 4 * ((column + 2) % 3);
        out[3 * column + 0] = a[1] * b[2] - a[2] * b[1];
        out[3 * column + 1] = a[2] * b[0] - a[0] * b[2];
        out[3 * column + 2] = a[0] * b[1] - a[1] * b[0];
    }
    return matrix[0] * out[0] + matrix[1] * out[1] + matrix[2] * out[2] < 0;
}

hewn_result hewn_gltf_positions_of(hewn_gltf_scene *scene, int accessor, hewn_gltf_items *out, hewn_error *error)
{
    HEWN_TRY(hewn_gltf_items_of(&scene->data, accessor, out, error));
    if (out->components != 3 || out->component_type == HEWN_GLTF_UINT)
        return hewn_gltf_fail(scene, "positions are not vectors of three numbers", error);
    return HEWN_OK;
}

hewn_result hewn_gltf_corners_of(hewn_gltf_scene *scene, const hewn_gltf_instance *instance, size_t primitive,
                                 hewn_gltf_corners *out, hewn_error *error)
{
    const hewn_gltf_primitive *given = &scene->data.gltf.primitives[primitive];
    hewn_gltf_items positions;
    double ignored[9];
    HEWN_TRY(hewn_gltf_positions_of(scene, given->positions, &positions, error));
    *out = (hewn_gltf_corners){.has_indices = given->indices != HEWN_GLTF_NONE,
                               .mode = given->mode,
                               .mirrored = hewn_gltf_cofactors(instance->matrix, ignored),
                               .vertex_count = positions.count};
    uint64_t count = positions.count;
    if (out->has_indices) {
        HEWN_TRY(hewn_gltf_indices_of(&scene->data, given->indices, &out->indices, error));
        count = out->indices.count;
    }
    if (given->mode == TRIANGLES && count % 3 != 0)
        return hewn_gltf_fail(scene, "a primitive's corners do not make up whole triangles", error);
    out->triangles = given->mode == TRIANGLES ? count / 3 : count < 3 ? 0 : count - 2;
    return HEWN_OK;
}

bool hewn_gltf_triangle(const hewn_gltf_corners *corners, uint64_t index, uint64_t out[3])
{
    uint64_t at[3] = {3 * index, 3 * index + 1, 3 * index + 2};
    if (corners->mode == STRIP) {
        at[0] = index + index % 2;
        at[1] = index + 1 - index % 2;
        at[2] = index + 2;
    } else if (corners->mode == FAN) {
        at[0] = 0;
        at[1] = index + 1;
        at[2] = index + 2;
    }
    for (int k = 0; k < 3; k++) {
        uint64_t from = at[corners->mirrored && k > 0 ? 3 - k : k];
        out[k] = corners->has_indices ? hewn_gltf_index(&corners->indices, from) : from;
    }
    return corners->mode != STRIP || (out[0] != out[1] && out[1] != out[2] && out[2] != out[0]);
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

static hewn_result read_scene(hewn_gltf_scene *scene, hewn_error *error)
{
    hewn_model *model = &scene->builder.model;
    HEWN_TRY(hewn_gltf_data_open(&scene->data, error));
    HEWN_TRY(place_all(scene, error));
    HEWN_TRY(hewn_gltf_add_surfaces(scene, error));
    HEWN_TRY(hewn_builder_finish(&scene->builder, scene->data.name, error));
    HEWN_TRY(hewn_gltf_add_channels(scene, error));
    model->unit = hewn_unit_find("m");
    model->up = HEWN_AXIS_PLUS_Y;
    model->up_known = true;
    return HEWN_OK;
}

hewn_result hewn_gltf_read(const hewn_source *source, hewn_model *out, hewn_error *error)
{
    *out = (hewn_model){0};
    hewn_gltf_scene scene = {.data = {.name = source->name, .path = source->path, .length = source->length},
                             .progress = source->progress,
                             .base_colors = source->base_colors};
    container json = {0};
    HEWN_TRY(open_container(&scene, source->bytes, source->length, &json, error));
    HEWN_TRY(hewn_gltf_parse(json.json, json.json_length, source->name, &scene.data.gltf, error));
    hewn_result result = read_scene(&scene, error);
    if (result == HEWN_OK)
        hewn_builder_move(&scene.builder, out);
    hewn_builder_clear(&scene.builder);
    hewn_free(scene.wedge_vertices);
    hewn_free(scene.instances);
    hewn_free(scene.sets);
    hewn_free(scene.parts);
    hewn_gltf_data_free(&scene.data);
    hewn_gltf_free(&scene.data.gltf);
    return result;
}
