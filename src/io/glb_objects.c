/* GLB with several objects, each a node of its own. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/file.h"
#include "base/json.h"
#include "base/progress.h"
#include "base/srgb.h"
#include "io/bytes.h"
#include "io/formats.h"

enum { MAGIC = 0x46546C67, JSON_CHUNK = 0x4E4F534A, BINARY_CHUNK = 0x004E4942 };
enum { FLOATS = 5126, INDICES = 5125, VERTICES_TARGET = 34962, INDICES_TARGET = 34963 };

typedef struct file {
    const hewn_object *objects;
    size_t count;
    const int64_t *numbers;
    const char *space;
    const hewn_progress *progress;
    hewn_output *output;
} file;

static uint64_t position_bytes(const hewn_model *model)
{
    return model->vertex_count * 12;
}

static uint64_t index_bytes(const hewn_model *model)
{
    return model->face_count * 12;
}

/* Positions, normals and indices, all of 4 bytes. */
static uint64_t object_bytes(const hewn_model *model)
{
    return model->face_count == 0 ? 0 : 2 * position_bytes(model) + index_bytes(model);
}

static hewn_result check(const file *of, hewn_error *error)
{
    uint64_t bytes = 0;
    for (size_t i = 0; i < of->count; i++) {
        const hewn_model *model = of->objects[i].model;
        if (model->first)
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "object '%s' has faces that are no triangles",
                             of->objects[i].name);
        if (model->vertex_count > UINT32_MAX || model->face_count > UINT32_MAX)
            return hewn_fail(error, HEWN_LIMIT, "object '%s' is larger than GLB's indices can name",
                             of->objects[i].name);
        bytes += object_bytes(model);
        for (uint64_t k = 0; k < 3 * model->vertex_count; k++)
            if (!(fabs(model->positions[k]) <= (double)FLT_MAX))
                return hewn_fail(error, HEWN_LIMIT, "a vertex of '%s' lies too far out for GLB's floats",
                                 of->objects[i].name);
    }
    if (bytes > UINT32_MAX - (1u << 20))
        return hewn_fail(error, HEWN_LIMIT, "the meshes need %llu bytes, more than the 4 GiB that a GLB file can hold",
                         (unsigned long long)bytes);
    return HEWN_OK;
}

/* --- JSON ----------------------------------------------------------------------------------------------------------
 */

/* glTF's colours are linear. */
static double linear(uint8_t value)
{
    return hewn_srgb_to_linear(value / 255.0);
}

static void print_nodes(const file *of, hewn_json *json)
{
    hewn_json_array(json, "nodes");
    for (size_t i = 0, mesh = 0; i < of->count; i++) {
        hewn_json_object(json, NULL);
        hewn_json_string(json, "name", of->objects[i].name);
        if (of->objects[i].model->face_count > 0)
            hewn_json_unsigned(json, "mesh", mesh++);
        if (of->numbers) {
            hewn_json_object(json, "extras");
            hewn_json_integer(json, "label", of->numbers[i]);
            hewn_json_end_object(json);
        }
        hewn_json_end_object(json);
    }
    hewn_json_end_array(json);
}

static void print_meshes(const file *of, hewn_json *json)
{
    hewn_json_array(json, "meshes");
    for (size_t i = 0, mesh = 0; i < of->count; i++) {
        if (of->objects[i].model->face_count == 0)
            continue;
        hewn_json_object(json, NULL);
        hewn_json_string(json, "name", of->objects[i].name);
        hewn_json_array(json, "primitives");
        hewn_json_object(json, NULL);
        hewn_json_object(json, "attributes");
        hewn_json_unsigned(json, "POSITION", 3 * mesh);
        hewn_json_unsigned(json, "NORMAL", 3 * mesh + 1);
        hewn_json_end_object(json);
        hewn_json_unsigned(json, "indices", 3 * mesh + 2);
        hewn_json_unsigned(json, "material", mesh++);
        hewn_json_end_object(json);
        hewn_json_end_array(json);
        hewn_json_end_object(json);
    }
    hewn_json_end_array(json);
    hewn_json_array(json, "materials");
    for (size_t i = 0; i < of->count; i++) {
        const hewn_object *object = &of->objects[i];
        if (object->model->face_count == 0)
            continue;
        hewn_json_object(json, NULL);
        hewn_json_string(json, "name", object->name);
        hewn_json_object(json, "pbrMetallicRoughness");
        hewn_json_array(json, "baseColorFactor");
        for (int k = 0; k < 3; k++)
            hewn_json_number(json, NULL, linear(object->color[k]));
        hewn_json_number(json, NULL, object->color[3] / 255.0);
        hewn_json_end_array(json);
        hewn_json_number(json, "metallicFactor", 0);
        hewn_json_number(json, "roughnessFactor", 0.7);
        hewn_json_end_object(json);
        if (object->color[3] < 255)
            hewn_json_string(json, "alphaMode", "BLEND");
        hewn_json_end_object(json);
    }
    hewn_json_end_array(json);
}

/* Least and greatest of the positions as floats. */
static void print_bounds(hewn_json *json, const hewn_model *model)
{
    float lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (uint64_t v = 0; v < model->vertex_count; v++)
        for (int axis = 0; axis < 3; axis++) {
            float at = (float)model->positions[3 * v + (uint64_t)axis] + 0.0f; /* no -0 */
            lo[axis] = at < lo[axis] ? at : lo[axis];
            hi[axis] = at > hi[axis] ? at : hi[axis];
        }
    hewn_json_array(json, "min");
    for (int axis = 0; axis < 3; axis++)
        hewn_json_number(json, NULL, (double)lo[axis]);
    hewn_json_end_array(json);
    hewn_json_array(json, "max");
    for (int axis = 0; axis < 3; axis++)
        hewn_json_number(json, NULL, (double)hi[axis]);
    hewn_json_end_array(json);
}

static void print_accessors(const file *of, hewn_json *json)
{
    hewn_json_array(json, "accessors");
    for (size_t i = 0, view = 0; i < of->count; i++) {
        const hewn_model *model = of->objects[i].model;
        for (int part = 0; model->face_count > 0 && part < 3; part++, view++) {
            hewn_json_object(json, NULL);
            hewn_json_unsigned(json, "bufferView", view);
            hewn_json_unsigned(json, "componentType", part < 2 ? FLOATS : INDICES);
            hewn_json_unsigned(json, "count", part < 2 ? model->vertex_count : 3 * model->face_count);
            hewn_json_string(json, "type", part < 2 ? "VEC3" : "SCALAR");
            if (part == 0)
                print_bounds(json, model);
            hewn_json_end_object(json);
        }
    }
    hewn_json_end_array(json);
    uint64_t offset = 0;
    hewn_json_array(json, "bufferViews");
    for (size_t i = 0; i < of->count; i++) {
        const hewn_model *model = of->objects[i].model;
        for (int part = 0; model->face_count > 0 && part < 3; part++) {
            uint64_t length = part < 2 ? position_bytes(model) : index_bytes(model);
            hewn_json_object(json, NULL);
            hewn_json_unsigned(json, "buffer", 0);
            hewn_json_unsigned(json, "byteOffset", offset);
            hewn_json_unsigned(json, "byteLength", length);
            hewn_json_unsigned(json, "target", part < 2 ? VERTICES_TARGET : INDICES_TARGET);
            hewn_json_end_object(json);
            offset += length;
        }
    }
    hewn_json_end_array(json);
    hewn_json_array(json, "buffers");
    hewn_json_object(json, NULL);
    hewn_json_unsigned(json, "byteLength", offset);
    hewn_json_end_object(json);
    hewn_json_end_array(json);
}

/* `bytes` is what the binary chunk has. */
static void print_document(const file *of, uint64_t bytes, hewn_text *text)
{
    char generator[64];
    hewn_json json = hewn_json_begin(text);
    snprintf(generator, sizeof generator, "Hewn %s", hewn_version());
    hewn_json_object(&json, NULL);
    hewn_json_object(&json, "asset");
    hewn_json_string(&json, "version", "2.0");
    hewn_json_string(&json, "generator", generator);
    if (of->space) {
        hewn_json_object(&json, "extras");
        hewn_json_string(&json, "space", of->space);
        hewn_json_end_object(&json);
    }
    hewn_json_end_object(&json);
    hewn_json_unsigned(&json, "scene", 0);
    hewn_json_array(&json, "scenes");
    hewn_json_object(&json, NULL);
    if (of->count > 0) {
        hewn_json_array(&json, "nodes");
        for (size_t i = 0; i < of->count; i++)
            hewn_json_unsigned(&json, NULL, i);
        hewn_json_end_array(&json);
    }
    hewn_json_end_object(&json);
    hewn_json_end_array(&json);
    if (of->count > 0)
        print_nodes(of, &json);
    if (bytes > 0) {
        print_meshes(of, &json);
        print_accessors(of, &json);
    }
    hewn_json_end_object(&json);
}

/* --- the body ------------------------------------------------------------------------------------------------------
 */

/* Normals of vertices: of the faces around, by their areas. A vertex without any points up. */
static float *make_normals(const hewn_model *model)
{
    double *sums = hewn_alloc_zero(model->vertex_count, 3 * sizeof *sums);
    float *normals = hewn_alloc(model->vertex_count, 3 * sizeof *normals);
    for (uint64_t t = 0; sums && t < model->face_count; t++) {
        const uint32_t *corner = model->corners + 3 * t;
        const double *a = model->positions + 3 * (size_t)corner[0], *b = model->positions + 3 * (size_t)corner[1],
                     *c = model->positions + 3 * (size_t)corner[2];
        double u[3], v[3];
        for (int k = 0; k < 3; k++) {
            u[k] = b[k] - a[k];
            v[k] = c[k] - a[k];
        }
        const double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
        for (int k = 0; k < 9; k++)
            sums[3 * (size_t)corner[k / 3] + (size_t)(k % 3)] += n[k % 3];
    }
    for (uint64_t v = 0; sums && normals && v < model->vertex_count; v++) {
        const double *n = sums + 3 * v;
        double largest = fmax(fabs(n[0]), fmax(fabs(n[1]), fabs(n[2])));
        double x = n[0] / largest, y = n[1] / largest, z = n[2] / largest, length = sqrt(x * x + y * y + z * z);
        bool usable = largest > 0 && isfinite(length);
        normals[3 * v] = usable ? (float)(x / length) : 0.0f;
        normals[3 * v + 1] = usable ? (float)(y / length) : 1.0f;
        normals[3 * v + 2] = usable ? (float)(z / length) : 0.0f;
    }
    bool made = sums && normals;
    hewn_free(sums);
    if (!made)
        hewn_free(normals);
    return made ? normals : NULL;
}

/* Puts number `at` of an array at `to`, as 4 bytes; what follows them. */
typedef char *(*put_number)(const void *numbers, uint64_t at, char *to);

static char *put_rounded(const void *numbers, uint64_t at, char *to)
{
    return hewn_put_float(to, (float)((const double *)numbers)[at]);
}

static char *put_float(const void *numbers, uint64_t at, char *to)
{
    return hewn_put_float(to, ((const float *)numbers)[at]);
}

static char *put_index(const void *numbers, uint64_t at, char *to)
{
    return hewn_put_u32(to, ((const uint32_t *)numbers)[at]);
}

static hewn_result write_numbers(const file *of, put_number put, const void *numbers, uint64_t count, hewn_error *error)
{
    char block[4096];
    for (uint64_t at = 0; at < count;) {
        char *to = block;
        for (; at < count && to < block + sizeof block; at++)
            to = put(numbers, at, to);
        HEWN_TRY(hewn_output_write(of->output, block, (size_t)(to - block), error));
    }
    return HEWN_OK;
}

static hewn_result write_object(const file *of, const hewn_model *model, hewn_error *error)
{
    if (model->face_count == 0)
        return HEWN_OK;
    float *normals = make_normals(model);
    if (!normals)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for writing");
    hewn_result result = write_numbers(of, put_rounded, model->positions, 3 * model->vertex_count, error);
    if (result == HEWN_OK)
        result = write_numbers(of, put_float, normals, 3 * model->vertex_count, error);
    if (result == HEWN_OK)
        result = write_numbers(of, put_index, model->corners, 3 * model->face_count, error);
    hewn_free(normals);
    return result;
}

static hewn_result write_head(const file *of, const hewn_text *json, uint64_t bytes, hewn_error *error)
{
    uint64_t text = (json->length + 3) & ~(uint64_t)3, whole = 20 + text + (bytes > 0 ? 8 + bytes : 0);
    char head[20], spaces[4] = "   ";
    if (whole > UINT32_MAX)
        return hewn_fail(error, HEWN_LIMIT, "the meshes need %llu bytes, more than the 4 GiB that a GLB file can hold",
                         (unsigned long long)whole);
    char *at = hewn_put_u32(hewn_put_u32(hewn_put_u32(head, MAGIC), 2), (uint32_t)whole);
    hewn_put_u32(hewn_put_u32(at, (uint32_t)text), JSON_CHUNK);
    HEWN_TRY(hewn_output_write(of->output, head, sizeof head, error));
    HEWN_TRY(hewn_output_write(of->output, json->bytes, json->length, error));
    HEWN_TRY(hewn_output_write(of->output, spaces, (size_t)(text - json->length), error));
    hewn_put_u32(hewn_put_u32(head, (uint32_t)bytes), BINARY_CHUNK);
    return bytes > 0 ? hewn_output_write(of->output, head, 8, error) : HEWN_OK;
}

static hewn_result write_all(const file *of, const hewn_text *json, uint64_t bytes, hewn_error *error)
{
    HEWN_TRY(write_head(of, json, bytes, error));
    for (size_t i = 0; i < of->count; i++) {
        HEWN_TRY(write_object(of, of->objects[i].model, error));
        HEWN_TRY(hewn_progress_report(of->progress, "write", (double)(i + 1) / (double)of->count, error));
    }
    return HEWN_OK;
}

hewn_result hewn_objects_write_glb(const hewn_object *objects, size_t count, const int64_t *numbers, const char *space,
                                   const char *path, const hewn_progress *progress, hewn_error *error)
{
    file of = {objects, count, numbers, space, progress, NULL};
    uint64_t bytes = 0;
    hewn_text json = {0};
    HEWN_TRY(check(&of, error));
    for (size_t i = 0; i < count; i++)
        bytes += object_bytes(objects[i].model);
    print_document(&of, bytes, &json);
    hewn_result result = hewn_text_status(&json, error);
    if (result == HEWN_OK)
        result = hewn_output_create(path, &of.output, error);
    if (result == HEWN_OK)
        result = write_all(&of, &json, bytes, error);
    if (result == HEWN_OK)
        result = hewn_output_finish(&of.output, error);
    hewn_output_destroy(&of.output);
    hewn_text_clear(&json);
    return result;
}
