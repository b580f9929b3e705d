/* GLB: metres, +Y up. tinygltf makes the JSON, the binary chunk is streamed from the triangles. */
#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "io/bytes.h"
#include "io/shim/gltf.h"
#include "io/stream.h"

enum { MAGIC = 0x46546C67, JSON_CHUNK = 0x4E4F534A, BINARY_CHUNK = 0x004E4942 };

/* The rotation that turns the scene's up axis to +Y. */
static void turn(hewn_axis up, const float in[3], float out[3])
{
    float x = in[0], y = in[1], z = in[2];
    switch (up) {
    case HEWN_AXIS_PLUS_Y: break;
    case HEWN_AXIS_PLUS_Z: y = in[2], z = -in[1]; break;
    case HEWN_AXIS_PLUS_X: x = -in[1], y = in[0]; break;
    }
    out[0] = x;
    out[1] = y;
    out[2] = z;
}

static void convert_position(const hewn_mesh_writing *job, uint64_t v, float out[3])
{
    float turned[3];
    turn(job->up, job->mesh->positions + 3 * v, turned);
    for (int axis = 0; axis < 3; axis++)
        out[axis] = (float)((double)turned[axis] * job->metres_per_unit);
}

/* glTF wants length 1. What nearly has it keeps its bits, what has none points up. */
static void convert_normal(const hewn_mesh_writing *job, uint64_t v, float out[3])
{
    turn(job->up, job->mesh->normals + 3 * v, out);
    double x = (double)out[0], y = (double)out[1], z = (double)out[2];
    double length = sqrt(x * x + y * y + z * z);
    if (fabs(length - 1) < 1e-4)
        return;
    bool usable = isfinite(length) && length > 0;
    out[0] = usable ? (float)(x / length) : 0.0f;
    out[1] = usable ? (float)(y / length) : 1.0f;
    out[2] = usable ? (float)(z / length) : 0.0f;
}

static char *put_vector(const float vector[3], char *to)
{
    for (int axis = 0; axis < 3; axis++)
        to = hewn_put_float(to, vector[axis]);
    return to;
}

static char *put_position(const hewn_mesh_writing *job, uint64_t v, char *to)
{
    float position[3];
    convert_position(job, v, position);
    return put_vector(position, to);
}

static char *put_normal(const hewn_mesh_writing *job, uint64_t v, char *to)
{
    float normal[3];
    convert_normal(job, v, normal);
    return put_vector(normal, to);
}

static char *put_long_indices(const hewn_mesh_writing *job, uint64_t t, char *to)
{
    for (int k = 0; k < 3; k++)
        to = hewn_put_u32(to, job->mesh->indices[3 * t + k]);
    return to;
}

static char *put_short_indices(const hewn_mesh_writing *job, uint64_t t, char *to)
{
    for (int k = 0; k < 3; k++)
        to = hewn_put_u16(to, job->mesh->indices[3 * t + k]);
    return to;
}

/* 65535 restarts a primitive and must not be an index. */
static bool has_short_indices(const hewn_triangles *mesh)
{
    return mesh->vertex_count <= UINT16_MAX;
}

static bool is_empty(const hewn_triangles *mesh)
{
    return mesh->triangle_count == 0;
}

/* Bytes of the binary chunk before padding, saturating. */
static uint64_t binary_length(const hewn_triangles *mesh)
{
    if (is_empty(mesh))
        return 0;
    if (mesh->vertex_count > UINT32_MAX || mesh->triangle_count > UINT32_MAX)
        return UINT64_MAX / 2;
    uint64_t vertex = mesh->normals ? 24 : 12, triangle = has_short_indices(mesh) ? 6 : 12;
    return mesh->vertex_count * vertex + mesh->triangle_count * triangle;
}

static hewn_result find_bounds(const hewn_mesh_writing *job, hewn_gltf_desc *desc, hewn_error *error)
{
    for (uint64_t v = 0; v < job->mesh->vertex_count; v++) {
        float p[3];
        convert_position(job, v, p);
        if (!(isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2])))
            return hewn_fail(error, HEWN_LIMIT, "vertex %llu lies too far out for GLB's floats in metres",
                             (unsigned long long)v);
        for (int axis = 0; axis < 3; axis++) {
            float value = p[axis] + 0.0f; /* no -0 */
            desc->lo[axis] = v == 0 || value < desc->lo[axis] ? value : desc->lo[axis];
            desc->hi[axis] = v == 0 || value > desc->hi[axis] ? value : desc->hi[axis];
        }
    }
    return HEWN_OK;
}

/* The file's header, the JSON chunk and the binary chunk's header. */
static hewn_result assemble_head(hewn_mesh_writing *job, const hewn_text *json, hewn_error *error)
{
    uint64_t text = (json->length + 3) & ~(uint64_t)3, binary = (binary_length(job->mesh) + 3) & ~(uint64_t)3;
    uint64_t head = 20 + text + (binary > 0 ? 8 : 0);
    if (head + binary > UINT32_MAX)
        return hewn_fail(error, HEWN_LIMIT, "the mesh needs %llu bytes, more than the 4 GiB that a GLB file can hold",
                         (unsigned long long)(head + binary));
    job->head = hewn_alloc(head, 1);
    if (!job->head)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for writing");
    job->head_length = head;
    char *at = hewn_put_u32(job->head, MAGIC);
    at = hewn_put_u32(at, 2);
    at = hewn_put_u32(at, (uint32_t)(head + binary));
    at = hewn_put_u32(at, (uint32_t)text);
    at = hewn_put_u32(at, JSON_CHUNK);
    memset(at, ' ', text);
    memcpy(at, json->bytes, json->length);
    at += text;
    if (binary > 0) {
        at = hewn_put_u32(at, (uint32_t)binary);
        hewn_put_u32(at, BINARY_CHUNK);
    }
    return HEWN_OK;
}

static hewn_result fits(const hewn_triangles *mesh, hewn_error *error)
{
    if (binary_length(mesh) > UINT32_MAX)
        return hewn_fail(error, HEWN_LIMIT,
                         "%llu vertices and %llu triangles need more than the 4 GiB that a GLB file can hold",
                         (unsigned long long)mesh->vertex_count, (unsigned long long)mesh->triangle_count);
    return HEWN_OK;
}

static hewn_result prepare(hewn_mesh_writing *job, hewn_error *error)
{
    const hewn_triangles *mesh = job->mesh;
    hewn_text generator = {0}, json = {0};
    hewn_text_print(&generator, "Hewn %s", hewn_version());
    hewn_gltf_desc desc = {.name = job->name,
                           .generator = generator.bytes,
                           .vertex_count = mesh->vertex_count,
                           .index_count = 3 * mesh->triangle_count,
                           .has_normals = mesh->normals != NULL,
                           .short_indices = has_short_indices(mesh)};
    hewn_result result = hewn_text_status(&generator, error);
    if (result == HEWN_OK)
        result = find_bounds(job, &desc, error);
    if (result == HEWN_OK)
        result = hewn_gltf_compose(&desc, &json, error);
    if (result == HEWN_OK)
        result = assemble_head(job, &json, error);
    hewn_text_clear(&generator);
    hewn_text_clear(&json);
    return result;
}

static hewn_result write(const hewn_mesh_writing *job, hewn_output *output, hewn_error *error)
{
    const hewn_triangles *mesh = job->mesh;
    HEWN_TRY(hewn_output_write(output, job->head, job->head_length, error));
    if (is_empty(mesh))
        return HEWN_OK;
    hewn_stream positions = {put_position, mesh->vertex_count, 12, 0, 0.35};
    HEWN_TRY(hewn_stream_write(job, &positions, output, error));
    hewn_stream normals = {put_normal, mesh->normals ? mesh->vertex_count : 0, 12, 0.35, 0.35};
    HEWN_TRY(hewn_stream_write(job, &normals, output, error));
    hewn_put_item put_indices = has_short_indices(mesh) ? put_short_indices : put_long_indices;
    hewn_stream indices = {put_indices, mesh->triangle_count, 12, 0.7, 0.3};
    HEWN_TRY(hewn_stream_write(job, &indices, output, error));
    size_t padding = (size_t)(-binary_length(mesh) & 3);
    return hewn_output_write(output, "\0\0\0", padding, error);
}

const hewn_mesh_writer hewn_glb_writer = {fits, prepare, write};
