/* glTF 2.0 and GLB: the triangles of the scene to show, with the transforms of its nodes. */
#include <math.h>
#include <string.h>

#include "io/builder.h"
#include "io/bytes.h"
#include "io/formats.h"
#include "io/gltf_data.h"

enum { MAGIC = 0x46546C67, JSON_CHUNK = 0x4E4F534A, BINARY_CHUNK = 0x004E4942 };
enum { TRIANGLES = 4, STRIP = 5, FAN = 6 };

/* Instances can make a small file large; past this many bytes and 64 times the file's length (with that of its buffers)
 * it is refused. */
static const uint64_t FREE_BYTES = (uint64_t)64 << 20;

typedef struct gltf_placed {
    size_t primitive;
    double matrix[16]; /* column-major, to the scene's coordinates */
} gltf_placed;

typedef struct gltf_reader {
    hewn_gltf_data data;
    hewn_builder builder;
    gltf_placed *placed;
    size_t placed_count, placed_room;
    uint64_t length; /* of the file */
    uint64_t spent;  /* bytes of memory, on what the scene places */
    bool normals;    /* every placed primitive has them */
} gltf_reader;

/* --- the container ---------------------------------------------------------------------------------------------------
 */

typedef struct container {
    const char *json;
    size_t json_length;
} container;

static hewn_result fail(const gltf_reader *reader, const char *what, hewn_error *error)
{
    return hewn_fail_at(error, HEWN_BAD_INPUT, reader->data.name, 0, "%s", what);
}

/* GLB: a header of 12 bytes, then chunks of length, type and content; JSON comes first, binary data may follow. */
static hewn_result open_container(gltf_reader *reader, const char *bytes, size_t length, container *out,
                                  hewn_error *error)
{
    if (length < 4 || hewn_get_u32(bytes) != MAGIC) {
        const char *name = reader->data.name;
        size_t tail = strlen(name);
        if (tail >= 4 && (memcmp(name + tail - 4, ".glb", 4) == 0 || memcmp(name + tail - 4, ".GLB", 4) == 0))
            return fail(reader, "this is not a GLB file: it does not begin with \"glTF\"", error);
        *out = (container){bytes, length};
        return HEWN_OK;
    }
    if (length < 20)
        return fail(reader, "the file ends within the headers of GLB", error);
    if (hewn_get_u32(bytes + 4) != 2)
        return fail(reader, "this is not version 2 of GLB", error);
    uint64_t total = hewn_get_u32(bytes + 8), text = hewn_get_u32(bytes + 12);
    if (total > length)
        return fail(reader, "the file is shorter than its header says", error);
    if (hewn_get_u32(bytes + 16) != JSON_CHUNK)
        return fail(reader, "the first chunk is not JSON", error);
    if (total < 20 || text > total - 20)
        return fail(reader, "the JSON chunk ends past the file", error);
    *out = (container){bytes + 20, (size_t)text};
    const char *rest = bytes + 20 + text;
    uint64_t left = total - 20 - text;
    if (left < 8)
        return HEWN_OK;
    if (hewn_get_u32(rest) > left - 8)
        return fail(reader, "the binary chunk ends past the file", error);
    if (hewn_get_u32(rest + 4) == BINARY_CHUNK) {
        reader->data.chunk = rest + 8;
        reader->data.chunk_length = hewn_get_u32(rest);
    }
    return HEWN_OK;
}

/* --- which primitives are where
 * --------------------------------------------------------------------------------------- */

static hewn_result spend(gltf_reader *reader, uint64_t bytes, hewn_error *error)
{
    reader->spent += bytes;
    if (reader->spent > FREE_BYTES + 64 * (reader->length + reader->data.loaded))
        return hewn_fail_at(error, HEWN_LIMIT, reader->data.name, 0,
                            "the scene repeats its meshes so often that it is out of proportion to the file");
    return HEWN_OK;
}

static hewn_result place_mesh(gltf_reader *reader, int mesh, const double matrix[16], hewn_error *error)
{
    const hewn_gltf *gltf = &reader->data.gltf;
    if (mesh < 0 || (size_t)mesh >= gltf->mesh_count)
        return fail(reader, "a node names a mesh that does not exist", error);
    for (size_t i = 0; i < gltf->meshes[mesh].primitive_count; i++) {
        size_t primitive = gltf->meshes[mesh].first_primitive + i;
        if (gltf->primitives[primitive].mode < TRIANGLES)
            continue; /* points and lines */
        HEWN_TRY(spend(reader, sizeof(gltf_placed), error));
        void *items = reader->placed;
        HEWN_TRY(hewn_reserve(&items, &reader->placed_room, reader->placed_count + 1, sizeof(gltf_placed), error));
        reader->placed = items;
        gltf_placed *place = &reader->placed[reader->placed_count++];
        place->primitive = primitive;
        memcpy(place->matrix, matrix, sizeof place->matrix);
    }
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

static hewn_result push_nodes(gltf_reader *reader, gltf_walk *walk, const int *nodes, size_t count,
                              const double matrix[16], hewn_error *error)
{
    for (size_t i = count; i-- > 0;) { /* backwards, so that the first is taken first */
        if (nodes[i] < 0 || (size_t)nodes[i] >= reader->data.gltf.node_count)
            return fail(reader, "the scene names a node that does not exist", error);
        if (walk->seen[nodes[i]])
            return fail(reader, "a node stands in the scene twice", error);
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

static const double IDENTITY[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

static hewn_result walk_nodes(gltf_reader *reader, gltf_walk *walk, hewn_error *error)
{
    const hewn_gltf *gltf = &reader->data.gltf;
    HEWN_TRY(push_nodes(reader, walk, gltf->roots, gltf->root_count, IDENTITY, error));
    while (walk->count > 0) {
        gltf_visit visit = walk->stack[--walk->count];
        const hewn_gltf_node *node = &gltf->nodes[visit.node];
        double matrix[16];
        multiply(visit.matrix, node->matrix, matrix);
        if (node->mesh != HEWN_GLTF_NONE)
            HEWN_TRY(place_mesh(reader, node->mesh, matrix, error));
        if (node->child_count > 0)
            HEWN_TRY(push_nodes(reader, walk, gltf->children + node->first_child, node->child_count, matrix, error));
    }
    return HEWN_OK;
}

static hewn_result place_all(gltf_reader *reader, hewn_error *error)
{
    const hewn_gltf *gltf = &reader->data.gltf;
    if (gltf->node_count == 0) { /* meshes alone: a library of them, say */
        for (size_t mesh = 0; mesh < gltf->mesh_count; mesh++)
            HEWN_TRY(place_mesh(reader, (int)mesh, IDENTITY, error));
        return HEWN_OK;
    }
    gltf_walk walk = {.seen = hewn_alloc_zero(gltf->node_count, sizeof *walk.seen)};
    hewn_result result =
        walk.seen ? walk_nodes(reader, &walk, error) : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for nodes");
    hewn_free(walk.stack);
    hewn_free(walk.seen);
    return result;
}

/* --- one primitive
 * ---------------------------------------------------------------------------------------------------- */

typedef struct gltf_source {
    hewn_gltf_items positions, normals, indices;
    bool has_normals, has_indices;
    uint64_t corners;   /* indices, or vertices where there are none */
    uint64_t triangles; /* before those of strips that only turn are dropped */
} gltf_source;

static hewn_result open_vectors(gltf_reader *reader, int accessor, const char *what, hewn_gltf_items *out,
                                hewn_error *error)
{
    HEWN_TRY(hewn_gltf_items_of(&reader->data, accessor, out, error));
    if (out->component_type != HEWN_GLTF_FLOAT || out->components != 3)
        return hewn_fail_at(error, HEWN_BAD_INPUT, reader->data.name, 0, "%s are not vectors of three floats", what);
    return HEWN_OK;
}

static hewn_result open_source(gltf_reader *reader, size_t index, gltf_source *out, hewn_error *error)
{
    const hewn_gltf_primitive *primitive = &reader->data.gltf.primitives[index];
    *out = (gltf_source){0};
    if (primitive->mode > FAN)
        return fail(reader, "a primitive has a mode that glTF does not know", error);
    if (primitive->positions == HEWN_GLTF_NONE)
        return fail(reader, "a primitive has no positions", error);
    HEWN_TRY(open_vectors(reader, primitive->positions, "positions", &out->positions, error));
    out->has_normals = primitive->normals != HEWN_GLTF_NONE;
    if (out->has_normals) {
        HEWN_TRY(open_vectors(reader, primitive->normals, "normals", &out->normals, error));
        if (out->normals.count != out->positions.count)
            return fail(reader, "a primitive has not as many normals as positions", error);
    }
    out->has_indices = primitive->indices != HEWN_GLTF_NONE;
    out->corners = out->positions.count;
    if (out->has_indices) {
        HEWN_TRY(hewn_gltf_items_of(&reader->data, primitive->indices, &out->indices, error));
        int type = out->indices.component_type;
        if (out->indices.components != 1 ||
            (type != HEWN_GLTF_UBYTE && type != HEWN_GLTF_USHORT && type != HEWN_GLTF_UINT))
            return fail(reader, "indices are not unsigned whole numbers", error);
        out->corners = out->indices.count;
    }
    if (primitive->mode == TRIANGLES && out->corners % 3 != 0)
        return fail(reader, "a primitive's corners do not make up whole triangles", error);
    out->triangles = primitive->mode == TRIANGLES ? out->corners / 3 : out->corners < 3 ? 0 : out->corners - 2;
    return HEWN_OK;
}

static void get_vector(const hewn_gltf_items *items, uint64_t index, double out[3])
{
    const char *at = items->first + index * items->stride;
    for (int axis = 0; axis < 3; axis++) {
        uint32_t bits = hewn_get_u32(at + 4 * axis);
        float value;
        memcpy(&value, &bits, sizeof value);
        out[axis] = (double)value;
    }
}

static uint64_t get_index(const gltf_source *source, uint64_t corner)
{
    if (!source->has_indices)
        return corner;
    const unsigned char *at = (const unsigned char *)source->indices.first + corner * source->indices.stride;
    if (source->indices.component_type == HEWN_GLTF_UBYTE)
        return at[0];
    if (source->indices.component_type == HEWN_GLTF_USHORT)
        return (uint64_t)at[0] | (uint64_t)at[1] << 8;
    return hewn_get_u32((const char *)at);
}

/* The cofactors of the matrix's linear part, which turn normals (up to length and, mirrored, sign), and its sign. */
static bool normal_matrix(const double m[16], double out[9])
{
    for (int column = 0; column < 3; column++) {
        const double *a = m + 4 * ((column + 1) % 3), *b = m + 4 * ((column + 2) % 3);
        out[3 * column + 0] = a[1] * b[2] - a[2] * b[1];
        out[3 * column + 1] = a[2] * b[0] - a[0] * b[2];
        out[3 * column + 2] = a[0] * b[1] - a[1] * b[0];
    }
    return m[0] * out[0] + m[1] * out[1] + m[2] * out[2] < 0;
}

static void add_vertices(gltf_reader *reader, const gltf_source *source, const double m[16])
{
    hewn_triangles *mesh = &reader->builder.mesh;
    double cofactors[9];
    double sign = normal_matrix(m, cofactors) ? -1 : 1;
    bool straight = memcmp(m, IDENTITY, sizeof IDENTITY) == 0; /* keeps every bit */
    for (uint64_t v = 0; v < source->positions.count; v++) {
        double p[3], n[3];
        float *to = mesh->positions + 3 * (mesh->vertex_count + v);
        get_vector(&source->positions, v, p);
        for (int row = 0; row < 3; row++)
            to[row] = (float)(straight ? p[row] : m[row] * p[0] + m[4 + row] * p[1] + m[8 + row] * p[2] + m[12 + row]);
        if (!reader->normals)
            continue;
        to = mesh->normals + 3 * (mesh->vertex_count + v);
        get_vector(&source->normals, v, n);
        double turned[3], square = 0;
        for (int row = 0; row < 3; row++) {
            turned[row] = sign * (cofactors[row] * n[0] + cofactors[3 + row] * n[1] + cofactors[6 + row] * n[2]);
            square += turned[row] * turned[row];
        }
        for (int row = 0; row < 3; row++)
            to[row] = (float)(straight ? n[row] : turned[row] / sqrt(square));
    }
}

static hewn_result add_triangles(gltf_reader *reader, const gltf_source *source, int mode, bool mirrored,
                                 hewn_error *error)
{
    hewn_triangles *mesh = &reader->builder.mesh;
    for (uint64_t t = 0; t < source->triangles; t++) {
        uint64_t at[3] = {3 * t, 3 * t + 1, 3 * t + 2}, corner[3];
        if (mode == STRIP) {
            at[0] = t + t % 2;
            at[1] = t + 1 - t % 2;
            at[2] = t + 2;
        } else if (mode == FAN) {
            at[0] = 0;
            at[1] = t + 1;
            at[2] = t + 2;
        }
        for (int k = 0; k < 3; k++) {
            corner[k] = get_index(source, at[k]);
            if (corner[k] >= source->positions.count)
                return hewn_fail_at(error, HEWN_BAD_INPUT, reader->data.name, 0,
                                    "a primitive names vertex %llu of its %llu", (unsigned long long)corner[k],
                                    (unsigned long long)source->positions.count);
            corner[k] += mesh->vertex_count;
        }
        if (mode == STRIP && (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0]))
            continue;
        HEWN_TRY(hewn_builder_add_triangle(&reader->builder, (uint32_t)corner[0], (uint32_t)corner[mirrored ? 2 : 1],
                                           (uint32_t)corner[mirrored ? 1 : 2], error));
    }
    return HEWN_OK;
}

/* --- the whole
 * -------------------------------------------------------------------------------------------------------- */

/* Counts what all placed primitives need, then makes room for it at once. */
static hewn_result make_room(gltf_reader *reader, hewn_error *error)
{
    uint64_t vertices = 0;
    reader->normals = reader->placed_count > 0;
    for (size_t i = 0; i < reader->placed_count; i++) {
        gltf_source source;
        HEWN_TRY(open_source(reader, reader->placed[i].primitive, &source, error));
        HEWN_TRY(spend(reader, 24 * source.positions.count, error));
        HEWN_TRY(spend(reader, 12 * source.triangles, error));
        vertices += source.positions.count;
        reader->normals = reader->normals && source.has_normals;
    }
    if (vertices > UINT32_MAX)
        return hewn_fail_at(error, HEWN_LIMIT, reader->data.name, 0, "more vertices than indices can name");
    hewn_builder *builder = &reader->builder;
    builder->mesh.positions = hewn_alloc(vertices, 3 * sizeof(float));
    builder->mesh.normals = reader->normals ? hewn_alloc(vertices, 3 * sizeof(float)) : NULL;
    if (!builder->mesh.positions || (reader->normals && !builder->mesh.normals))
        return hewn_fail_at(error, HEWN_OUT_OF_MEMORY, reader->data.name, 0, "out of memory for %llu vertices",
                            (unsigned long long)vertices);
    builder->position_room = vertices;
    builder->normal_room = reader->normals ? vertices : 0;
    return HEWN_OK;
}

static hewn_result read_scene(gltf_reader *reader, hewn_error *error)
{
    reader->data.buffers = hewn_alloc_zero(reader->data.gltf.buffer_count, sizeof *reader->data.buffers);
    if (!reader->data.buffers)
        return hewn_fail_at(error, HEWN_OUT_OF_MEMORY, reader->data.name, 0, "out of memory for buffers");
    HEWN_TRY(place_all(reader, error));
    HEWN_TRY(make_room(reader, error));
    for (size_t i = 0; i < reader->placed_count; i++) {
        const gltf_placed *place = &reader->placed[i];
        gltf_source source;
        double ignored[9];
        HEWN_TRY(open_source(reader, place->primitive, &source, error));
        add_vertices(reader, &source, place->matrix);
        HEWN_TRY(add_triangles(reader, &source, reader->data.gltf.primitives[place->primitive].mode,
                               normal_matrix(place->matrix, ignored), error));
        reader->builder.mesh.vertex_count += source.positions.count;
    }
    return HEWN_OK;
}

hewn_result hewn_gltf_read(const char *bytes, size_t length, const char *name, const char *path, hewn_triangles *out,
                           hewn_error *error)
{
    *out = (hewn_triangles){0};
    gltf_reader reader = {.data = {.name = name, .path = path}, .length = length};
    container json = {0};
    HEWN_TRY(open_container(&reader, bytes, length, &json, error));
    HEWN_TRY(hewn_gltf_parse(json.json, json.json_length, name, &reader.data.gltf, error));
    hewn_result result = read_scene(&reader, error);
    if (result == HEWN_OK)
        result = hewn_builder_finish(&reader.builder, name, out, error);
    hewn_builder_clear(&reader.builder);
    hewn_free(reader.placed);
    hewn_gltf_data_free(&reader.data);
    hewn_gltf_free(&reader.data.gltf);
    return result;
}
