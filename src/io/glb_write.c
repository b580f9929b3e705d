/* GLB: metres, +Y up. tinygltf makes the JSON, the binary chunk is streamed. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/progress.h"
#include "io/bytes.h"
#include "io/glb_body.h"
#include "io/glb_plan.h"
#include "io/stream.h"
#include "io/target.h"

enum { MAGIC = 0x46546C67, JSON_CHUNK = 0x4E4F534A, BINARY_CHUNK = 0x004E4942 };

/* What lives from prepare to release. */
typedef struct writer {
    hewn_glb_plan plan;
    const hewn_glb_layer *layer; /* that is being streamed */
} writer;

/* --- items -------------------------------------------------------------------------------------------------------- */

/* glTF wants length 1. What nearly has it keeps its bits, what has none points up. */
static void put_unit(const double n[3], float out[3])
{
    for (int axis = 0; axis < 3; axis++)
        out[axis] = (float)n[axis];
    double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (fabs(length - 1) < 1e-4)
        return;
    bool usable = isfinite(length) && length > 0;
    out[0] = usable ? (float)(n[0] / length) : 0.0f;
    out[1] = usable ? (float)(n[1] / length) : 1.0f;
    out[2] = usable ? (float)(n[2] / length) : 0.0f;
}

static char *put_position(const hewn_writing *job, uint64_t v, char *to)
{
    const writer *own = job->own;
    float position[3];
    hewn_glb_position(job, &own->plan, v, position);
    for (int axis = 0; axis < 3; axis++)
        to = hewn_put_float(to, position[axis]);
    return to;
}

/* The numbers of a vertex of the file, as the layer's channel has them; 0 where no corner says. */
static void get_numbers(const hewn_writing *job, uint64_t v, double *numbers)
{
    const writer *own = job->own;
    const hewn_channel *channel = own->layer->channel;
    uint64_t at = hewn_glb_source(job, &own->plan, v);
    if (channel->info.domain == HEWN_DOMAIN_CORNER)
        at = own->plan.vertex_corners[v];
    for (uint32_t k = 0; k < channel->info.components; k++)
        numbers[k] =
            channel->info.domain == HEWN_DOMAIN_CORNER && at == HEWN_NONE ? 0 : hewn_channel_number(channel, at, k);
}

/* Doubles that no float comes near go to the largest, since glTF has no infinity. */
static float nearest_float(double value)
{
    return (float)fmax(-(double)FLT_MAX, fmin((double)FLT_MAX, value));
}

static char *put_components(const hewn_gltf_stream *stream, const double *numbers, char *to)
{
    char *end = to + stream->item;
    for (int k = 0; k < stream->components; k++) {
        if (stream->component_type == HEWN_GLTF_FLOAT)
            to = hewn_put_float(to, nearest_float(numbers[k]));
        else if (stream->component_type == HEWN_GLTF_UBYTE)
            *to++ = (char)(unsigned char)numbers[k];
        else
            to = hewn_put_u16(to, (uint32_t)(int32_t)numbers[k] & 0xffff);
    }
    memset(to, 0, (size_t)(end - to));
    return end;
}

static char *put_layer(const hewn_writing *job, uint64_t v, char *to)
{
    const writer *own = job->own;
    const hewn_gltf_stream *stream = &own->layer->stream;
    double numbers[16] = {0}, turned[3];
    float unit[3];
    get_numbers(job, v, numbers);
    if (own->layer->kind == HEWN_GLB_NORMAL) {
        hewn_target_turn(&own->plan.conversion, numbers, turned);
        put_unit(turned, unit);
        for (int axis = 0; axis < 3; axis++)
            numbers[axis] = (double)unit[axis];
    } else if (own->layer->kind == HEWN_GLB_UV) {
        numbers[1] = 1 - numbers[1]; /* from the lower left corner to the upper left */
    } else if (own->layer->kind == HEWN_GLB_COLOR && stream->component_type == HEWN_GLTF_FLOAT) {
        for (int k = 0; k < stream->components; k++)
            numbers[k] = fmax(0, fmin(1, numbers[k])); /* glTF admits no others */
    }
    return put_components(stream, numbers, to);
}

/* 65535 restarts a primitive and must not be an index. */
static bool has_short_indices(const hewn_writing *job, const hewn_glb_plan *plan)
{
    return hewn_glb_vertex_count(job, plan) <= UINT16_MAX;
}

static char *put_one(const hewn_writing *job, uint64_t vertex, char *to)
{
    const writer *own = job->own;
    return has_short_indices(job, &own->plan) ? hewn_put_u16(to, (uint32_t)vertex) : hewn_put_u32(to, (uint32_t)vertex);
}

static char *put_index(const hewn_writing *job, uint64_t index, char *to)
{
    const writer *own = job->own;
    return put_one(job, hewn_glb_index(job, &own->plan, index), to);
}

static char *put_merge_place(const hewn_writing *job, uint64_t index, char *to)
{
    const writer *own = job->own;
    return hewn_glb_index(job, &own->plan, index) < job->vertex_count ? to : hewn_put_u32(to, (uint32_t)index);
}

static char *put_merge_vertex(const hewn_writing *job, uint64_t index, char *to)
{
    const writer *own = job->own;
    uint64_t vertex = hewn_glb_index(job, &own->plan, index);
    return vertex < job->vertex_count ? to : put_one(job, hewn_glb_source(job, &own->plan, vertex), to);
}

/* --- sizes -------------------------------------------------------------------------------------------------------- */

/* Bytes of the binary chunk, before padding: up to the end of the indices, and the whole. */
typedef struct sizes {
    uint64_t indices_end, whole;
} sizes;

static sizes find_sizes(const hewn_writing *job, const hewn_glb_plan *plan)
{
    uint64_t vertex = 12, index = has_short_indices(job, plan) ? 2 : 4;
    if (job->triangle_count == 0)
        return (sizes){0, 0};
    for (size_t i = 0; i < plan->layer_count; i++)
        vertex += plan->layers[i].stream.item;
    sizes result;
    result.indices_end = hewn_glb_vertex_count(job, plan) * vertex + 3 * job->triangle_count * index;
    result.whole = result.indices_end;
    if (plan->merge_count > 0)
        result.whole = ((result.indices_end + 3) & ~(uint64_t)3) + plan->merge_count * (4 + index);
    return result;
}

/* What positions, indices and normals need at the least. */
static hewn_result fits(const hewn_writing *job, hewn_error *error)
{
    uint64_t vertex = hewn_writing_channel(job, HEWN_DOMAIN_VERT, "normal") ? 24 : 12;
    uint64_t triangle = job->vertex_count <= UINT16_MAX ? 6 : 12;
    bool fit = job->triangle_count == 0 || (job->vertex_count <= UINT32_MAX && job->triangle_count <= UINT32_MAX &&
                                            job->vertex_count * vertex + job->triangle_count * triangle <= UINT32_MAX);
    if (!fit)
        return hewn_fail(error, HEWN_LIMIT,
                         "%llu vertices and %llu triangles need more than the 4 GiB that a GLB file can hold",
                         (unsigned long long)job->vertex_count, (unsigned long long)job->triangle_count);
    return HEWN_OK;
}

/* --- the head ----------------------------------------------------------------------------------------------------- */

static hewn_result find_bounds(const hewn_writing *job, const hewn_glb_plan *plan, hewn_gltf_desc *desc,
                               hewn_error *error)
{
    for (uint64_t v = 0; v < job->vertex_count; v++) {
        float p[3];
        hewn_glb_position(job, plan, v, p);
        for (int axis = 0; axis < 3; axis++) {
            float value = p[axis] + 0.0f; /* no -0 */
            desc->lo[axis] = v == 0 || value < desc->lo[axis] ? value : desc->lo[axis];
            desc->hi[axis] = v == 0 || value > desc->hi[axis] ? value : desc->hi[axis];
        }
        if ((v + 1) % (16 * HEWN_WRITE_BLOCK) == 0)
            HEWN_TRY(hewn_progress_report(job->progress, "write", 0, error));
    }
    return HEWN_OK;
}

hewn_result hewn_glb_head(const hewn_text *json, uint64_t binary, char **out, size_t *length, hewn_error *error)
{
    uint64_t text = (json->length + 3) & ~(uint64_t)3;
    uint64_t head = 20 + text + (binary > 0 ? 8 : 0);
    if (head + binary > UINT32_MAX)
        return hewn_fail(error, HEWN_LIMIT, "the mesh needs %llu bytes, more than the 4 GiB that a GLB file can hold",
                         (unsigned long long)(head + binary));
    *out = hewn_alloc(head, 1);
    if (!*out)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for writing");
    *length = head;
    char *at = hewn_put_u32(*out, MAGIC);
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

/* The texts that the JSON needs, and the streams, are there for the time of this call only. */
static hewn_result compose(const hewn_writing *job, const hewn_glb_plan *plan, hewn_text *texts,
                           hewn_gltf_stream *streams, hewn_text *json, hewn_error *error)
{
    hewn_text_print(&texts[0], "Hewn %s", hewn_version());
    hewn_target_print(&plan->conversion, &texts[1]);
    HEWN_TRY(hewn_text_status(&texts[0], error));
    HEWN_TRY(hewn_text_status(&texts[1], error));
    for (size_t i = 0; i < plan->layer_count; i++)
        streams[i] = plan->layers[i].stream;
    hewn_gltf_desc desc = {.name = job->name,
                           .generator = texts[0].bytes,
                           .vertex_count = hewn_glb_vertex_count(job, plan),
                           .index_count = 3 * job->triangle_count,
                           .short_indices = has_short_indices(job, plan),
                           .streams = streams,
                           .stream_count = plan->layer_count,
                           .runs = plan->runs,
                           .run_count = plan->run_count,
                           .topology = plan->topology,
                           .merge_count = plan->merge_count,
                           .conversion = hewn_target_changes(&plan->conversion) ? texts[1].bytes : NULL,
                           .space = job->space};
    HEWN_TRY(find_bounds(job, plan, &desc, error));
    return hewn_gltf_compose(&desc, json, error);
}

hewn_result hewn_glb_compose(hewn_writing *job, hewn_text *json, uint64_t *binary, hewn_error *error)
{
    writer *own = job->own = hewn_alloc_zero(1, sizeof *own);
    if (!own)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for writing");
    HEWN_TRY(hewn_glb_plan_make(job, &own->plan, error));
    hewn_text texts[2] = {{0}, {0}};
    hewn_gltf_stream *streams = hewn_alloc(own->plan.layer_count, sizeof *streams);
    hewn_result result = streams ? compose(job, &own->plan, texts, streams, json, error)
                                 : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for writing");
    *binary = (find_sizes(job, &own->plan).whole + 3) & ~(uint64_t)3;
    hewn_text_clear(&texts[0]);
    hewn_text_clear(&texts[1]);
    hewn_free(streams);
    return result;
}

static hewn_result prepare(hewn_writing *job, hewn_error *error)
{
    hewn_text json = {0};
    uint64_t binary;
    hewn_result result = hewn_glb_compose(job, &json, &binary, error);
    if (result == HEWN_OK)
        result = hewn_glb_head(&json, binary, &job->head, &job->head_length, error);
    hewn_text_clear(&json);
    return result;
}

static void release(hewn_writing *job)
{
    writer *own = job->own;
    if (own)
        hewn_glb_plan_free(&own->plan);
    hewn_free(own);
    job->own = NULL;
}

/* --- the body ----------------------------------------------------------------------------------------------------- */

static hewn_result pad(hewn_output *output, uint64_t length, hewn_error *error)
{
    return hewn_output_write(output, "\0\0\0", (size_t)(-length & 3), error);
}

hewn_result hewn_glb_write_body(const hewn_writing *job, hewn_output *output, hewn_error *error)
{
    writer *own = job->own;
    const hewn_glb_plan *plan = &own->plan;
    uint64_t vertices = hewn_glb_vertex_count(job, plan), corners = 3 * job->triangle_count;
    sizes size = find_sizes(job, plan);
    if (job->triangle_count == 0)
        return HEWN_OK;
    double share = 0.7 / (double)(plan->layer_count + 1);
    hewn_stream stream = {.put = put_position, .count = vertices, .room = 12, .span = share};
    HEWN_TRY(hewn_stream_write(job, &stream, output, error));
    for (size_t i = 0; i < plan->layer_count; i++) {
        own->layer = &plan->layers[i];
        stream =
            (hewn_stream){put_layer, vertices, own->layer->stream.item, NULL, share * (double)(i + 1), share, NULL};
        HEWN_TRY(hewn_stream_write(job, &stream, output, error));
    }
    stream = (hewn_stream){put_index, corners, 4, NULL, 0.7, 0.3, NULL};
    HEWN_TRY(hewn_stream_write(job, &stream, output, error));
    if (plan->merge_count > 0) {
        HEWN_TRY(pad(output, size.indices_end, error));
        stream = (hewn_stream){put_merge_place, corners, 4, NULL, 1, 0, NULL};
        HEWN_TRY(hewn_stream_write(job, &stream, output, error));
        stream.put = put_merge_vertex;
        HEWN_TRY(hewn_stream_write(job, &stream, output, error));
    }
    return pad(output, size.whole, error);
}

static hewn_result write(const hewn_writing *job, hewn_output *output, hewn_error *error)
{
    const writer *own = job->own;
    hewn_output_expect(output, job->head_length + ((find_sizes(job, &own->plan).whole + 3) & ~(uint64_t)3));
    HEWN_TRY(hewn_output_write(output, job->head, job->head_length, error));
    return hewn_glb_write_body(job, output, error);
}

const hewn_format_writer hewn_glb_writer = {
    .triangles = true, .fits = fits, .prepare = prepare, .write = write, .release = release};
