#include "io/glb_plan.h"

#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/progress.h"
#include "io/glb_topology.h"
#include "io/target.h"

static hewn_result fail_memory(hewn_error *error)
{
    return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for writing");
}

void hewn_glb_position(const hewn_writing *job, const hewn_glb_plan *plan, uint64_t vertex, float out[3])
{
    double given[3], position[3];
    hewn_writing_position(job, hewn_glb_source(job, plan, vertex), given);
    hewn_target_convert(&plan->conversion, given, position);
    for (int axis = 0; axis < 3; axis++)
        out[axis] = (float)position[axis];
}

/* --- attributes --------------------------------------------------------------------------------------------------- */

static bool is_real(const hewn_channel *channel)
{
    return channel->info.scalar == HEWN_SCALAR_FLOAT || channel->info.scalar == HEWN_SCALAR_DOUBLE;
}

/* The narrowest of glTF's types that holds all whole numbers of a channel exactly; 0: none does. */
static int whole_type(const hewn_writing *job, const hewn_channel *channel)
{
    uint64_t count =
        (channel->info.domain == HEWN_DOMAIN_VERT ? job->vertex_count : job->corner_count) * channel->info.components;
    const int32_t *values = channel->values;
    int32_t lo = 0, hi = 0;
    for (uint64_t i = 0; i < count; i++) {
        lo = values[i] < lo ? values[i] : lo;
        hi = values[i] > hi ? values[i] : hi;
    }
    if (lo >= 0 && hi <= UINT16_MAX)
        return HEWN_GLTF_USHORT;
    if (lo >= INT16_MIN && hi <= INT16_MAX)
        return HEWN_GLTF_SHORT;
    return lo >= -(1 << 24) && hi <= 1 << 24 ? HEWN_GLTF_FLOAT : 0;
}

/* How a user's channel is written; false where glTF has no type for it. */
static bool find_user_type(const hewn_writing *job, const hewn_channel *channel, hewn_gltf_stream *stream)
{
    uint32_t components = channel->info.components;
    int type = is_real(channel)                            ? HEWN_GLTF_FLOAT
               : channel->info.scalar == HEWN_SCALAR_UINT8 ? HEWN_GLTF_UBYTE
                                                           : whole_type(job, channel);
    bool matrix = components == 9 || components == 16; /* whose columns only floats fill without gaps */
    stream->component_type = type;
    stream->normalised = type == HEWN_GLTF_UBYTE;
    return type != 0 && (components <= 4 || (matrix && type == HEWN_GLTF_FLOAT));
}

/* How a channel is written; false where it is not. */
static bool find_layer(const hewn_writing *job, const hewn_channel *channel, hewn_glb_layer *out)
{
    const hewn_attribute_info *info = &channel->info;
    *out = (hewn_glb_layer){.channel = channel, .kind = HEWN_GLB_OTHER};
    hewn_gltf_stream *stream = &out->stream;
    bool right = false;
    stream->component_type = HEWN_GLTF_FLOAT;
    if (strcmp(info->name, "normal") == 0) {
        stream->semantic = "NORMAL";
        out->kind = HEWN_GLB_NORMAL;
        right = is_real(channel) && info->components == 3;
    } else if (strcmp(info->name, "uv") == 0) {
        stream->semantic = "TEXCOORD_0";
        out->kind = HEWN_GLB_UV;
        right = is_real(channel) && info->components == 2;
    } else if (strcmp(info->name, "color") == 0) {
        stream->semantic = "COLOR_0";
        out->kind = HEWN_GLB_COLOR;
        right = find_user_type(job, channel, stream) && (info->components == 3 || info->components == 4) &&
                info->scalar != HEWN_SCALAR_INT32;
    } else {
        right = find_user_type(job, channel, stream);
    }
    stream->components = (int)info->components;
    uint32_t size = stream->component_type == HEWN_GLTF_FLOAT ? 4 : stream->component_type == HEWN_GLTF_UBYTE ? 1 : 2;
    stream->item = (size * info->components + 3) & ~3u;
    return right;
}

/* Corners come before vertices where both have a channel of a name. */
static bool is_written(const hewn_writing *job, const hewn_channel *channel, hewn_glb_layer *out)
{
    if (channel->info.domain == HEWN_DOMAIN_FACE || !find_layer(job, channel, out))
        return false;
    return channel->info.domain == HEWN_DOMAIN_CORNER ||
           !hewn_writing_channel(job, HEWN_DOMAIN_CORNER, channel->info.name);
}

/* A user's name gets an underscore, but for those that got theirs by being read (gltf_channels.c). */
static char *semantic_of(const hewn_glb_layer *layer)
{
    const char *name = layer->channel->info.name;
    if (layer->stream.semantic)
        return hewn_strdup(layer->stream.semantic);
    if (strcmp(name, "_normal") == 0 || strcmp(name, "_uv") == 0 || strcmp(name, "_color") == 0)
        return hewn_strdup(name);
    size_t length = strlen(name) + 1;
    char *semantic = hewn_alloc(length + 1, 1);
    if (semantic) {
        semantic[0] = '_';
        memcpy(semantic + 1, name, length);
    }
    return semantic;
}

static hewn_result add_layer(hewn_glb_plan *plan, hewn_glb_layer layer, hewn_error *error)
{
    layer.stream.semantic = semantic_of(&layer);
    if (!layer.stream.semantic)
        return fail_memory(error);
    plan->layers[plan->layer_count++] = layer;
    plan->corners = plan->corners || layer.channel->info.domain == HEWN_DOMAIN_CORNER;
    return HEWN_OK;
}

/* Normals, texture coordinates and colours come first. */
static hewn_result plan_layers(const hewn_writing *job, hewn_glb_plan *plan, hewn_error *error)
{
    static const char *const first[] = {"NORMAL", "TEXCOORD_0", "COLOR_0"};
    hewn_glb_layer layer;
    plan->layers = hewn_alloc(job->channel_count, sizeof *plan->layers);
    if (!plan->layers)
        return fail_memory(error);
    for (size_t k = 0; k <= sizeof first / sizeof *first; k++)
        for (uint32_t i = 0; i < job->channel_count; i++) {
            if (!is_written(job, &job->channels[i], &layer))
                continue;
            const char *semantic = layer.stream.semantic;
            if (k < 3 ? semantic && strcmp(semantic, first[k]) == 0 : !semantic)
                HEWN_TRY(add_layer(plan, layer, error));
        }
    return HEWN_OK;
}

/* --- copies ------------------------------------------------------------------------------------------------------- */

/* Vertices of the file that were split off, found by the model's vertex and the corners' values. */
typedef struct splitter {
    const hewn_writing *job;
    hewn_glb_plan *plan;
    uint32_t *slots; /* copies; HEWN_NONE is free */
    size_t slot_count;
    size_t copy_room, corner_room;
} splitter;

static size_t value_size(const hewn_glb_layer *layer)
{
    return layer->channel->info.components * hewn_scalar_size(layer->channel->info.scalar);
}

static const char *corner_value(const hewn_glb_layer *layer, uint32_t corner)
{
    return (const char *)layer->channel->values + value_size(layer) * corner;
}

static bool same_values(const hewn_glb_plan *plan, uint32_t a, uint32_t b)
{
    for (size_t i = 0; i < plan->layer_count; i++) {
        const hewn_glb_layer *layer = &plan->layers[i];
        if (layer->channel->info.domain == HEWN_DOMAIN_CORNER &&
            memcmp(corner_value(layer, a), corner_value(layer, b), value_size(layer)) != 0)
            return false;
    }
    return true;
}

static uint64_t hash_corner(const splitter *from, uint32_t corner)
{
    uint32_t vertex = from->job->corners[corner];
    hewn_hash hash = hewn_hash_bytes(hewn_hash_begin(), &vertex, sizeof vertex);
    for (size_t i = 0; i < from->plan->layer_count; i++) {
        const hewn_glb_layer *layer = &from->plan->layers[i];
        if (layer->channel->info.domain == HEWN_DOMAIN_CORNER)
            hash = hewn_hash_bytes(hash, corner_value(layer, corner), value_size(layer));
    }
    return hash.a;
}

static size_t find_slot(const splitter *from, uint32_t corner)
{
    const hewn_glb_plan *plan = from->plan;
    size_t mask = from->slot_count - 1, at = (size_t)hash_corner(from, corner) & mask;
    for (; from->slots[at] != HEWN_NONE; at = (at + 1) & mask) {
        uint32_t copy = from->slots[at];
        if (plan->copied[copy] == from->job->corners[corner] &&
            same_values(plan, plan->vertex_corners[from->job->vertex_count + copy], corner))
            break;
    }
    return at;
}

static hewn_result grow_slots(splitter *of, hewn_error *error)
{
    size_t count = of->slot_count ? 2 * of->slot_count : 1024;
    uint32_t *slots = hewn_alloc(count, sizeof *slots);
    if (!slots)
        return fail_memory(error);
    memset(slots, 0xff, count * sizeof *slots);
    hewn_free(of->slots);
    of->slots = slots;
    of->slot_count = count;
    for (uint32_t copy = 0; copy < of->plan->copy_count; copy++)
        slots[find_slot(of, of->plan->vertex_corners[of->job->vertex_count + copy])] = copy;
    return HEWN_OK;
}

static hewn_result add_copy(splitter *to, uint32_t corner, size_t slot, hewn_error *error)
{
    hewn_glb_plan *plan = to->plan;
    uint64_t vertex = hewn_glb_vertex_count(to->job, plan);
    if (vertex >= HEWN_NONE)
        return hewn_fail(error, HEWN_LIMIT, "more vertices than indices can name");
    void *items = plan->copied;
    HEWN_TRY(hewn_reserve(&items, &to->copy_room, plan->copy_count + 1, sizeof *plan->copied, error));
    plan->copied = items;
    items = plan->vertex_corners;
    HEWN_TRY(hewn_reserve(&items, &to->corner_room, vertex + 1, sizeof *plan->vertex_corners, error));
    plan->vertex_corners = items;
    plan->copied[plan->copy_count] = to->job->corners[corner];
    plan->vertex_corners[vertex] = corner;
    to->slots[slot] = (uint32_t)plan->copy_count++;
    return HEWN_OK;
}

/* The file's vertex of a corner. */
static hewn_result place_corner(splitter *to, uint32_t corner, uint32_t *out, hewn_error *error)
{
    hewn_glb_plan *plan = to->plan;
    *out = to->job->corners[corner];
    uint32_t *first = &plan->vertex_corners[*out];
    if (*first == HEWN_NONE)
        *first = corner;
    if (*first == corner || same_values(plan, *first, corner))
        return HEWN_OK;
    if (!to->slots || 2 * (plan->copy_count + 1) > to->slot_count)
        HEWN_TRY(grow_slots(to, error));
    size_t slot = find_slot(to, corner);
    if (to->slots[slot] == HEWN_NONE)
        HEWN_TRY(add_copy(to, corner, slot, error));
    *out = (uint32_t)to->job->vertex_count + to->slots[slot];
    plan->merge_count++;
    return HEWN_OK;
}

static hewn_result place_corners(splitter *to, hewn_error *error)
{
    for (uint64_t t = 0; t < to->job->triangle_count; t++) {
        uint64_t corner[3];
        hewn_writing_triangle(to->job, t, corner);
        for (int k = 0; k < 3; k++)
            HEWN_TRY(place_corner(to, (uint32_t)corner[k], &to->plan->indices[3 * t + k], error));
        if (t % (16 * HEWN_WRITE_BLOCK) == 0)
            HEWN_TRY(hewn_progress_report(to->job->progress, "write", 0, error));
    }
    return HEWN_OK;
}

static hewn_result plan_copies(const hewn_writing *job, hewn_glb_plan *plan, hewn_error *error)
{
    splitter of = {.job = job, .plan = plan, .corner_room = job->vertex_count};
    if (!plan->corners)
        return HEWN_OK;
    if (job->corner_count >= HEWN_NONE || job->vertex_count >= HEWN_NONE)
        return hewn_fail(error, HEWN_LIMIT, "more corners than indices can name");
    plan->vertex_corners = hewn_alloc(job->vertex_count, sizeof *plan->vertex_corners);
    plan->indices = hewn_alloc(job->triangle_count, 3 * sizeof *plan->indices);
    if (!plan->vertex_corners || !plan->indices)
        return fail_memory(error);
    memset(plan->vertex_corners, 0xff, job->vertex_count * sizeof *plan->vertex_corners);
    hewn_result result = place_corners(&of, error);
    hewn_free(of.slots);
    return result;
}

/* --- materials ---------------------------------------------------------------------------------------------------- */

enum { MOST_RUNS = 1 << 16 };

/* The face of each triangle. */
static hewn_result find_faces(const hewn_writing *job, uint32_t **out, hewn_error *error)
{
    *out = hewn_alloc(job->triangle_count, sizeof **out);
    if (!*out)
        return fail_memory(error);
    uint64_t triangle = 0;
    for (uint64_t face = 0; face < job->face_count; face++) {
        uint64_t corners = hewn_writing_first(job, face + 1) - hewn_writing_first(job, face);
        for (uint64_t k = 2; k < corners && triangle < job->triangle_count; k++)
            (*out)[triangle++] = (uint32_t)face;
    }
    return HEWN_OK;
}

/* Numbers materials as triangles come to them: afterwards `runs` of triangles has the run of each. */
static bool number_runs(const hewn_writing *job, const hewn_channel *channel, hewn_glb_plan *plan, uint32_t *ranks,
                        uint32_t *triangles)
{
    bool sorted = true;
    for (uint64_t t = 0; t < job->triangle_count; t++) {
        int32_t value = ((const int32_t *)channel->values)[triangles[t]];
        uint32_t key = value >= 0 && (uint32_t)value < channel->name_count ? (uint32_t)value : channel->name_count;
        if (ranks[key] == HEWN_NONE) {
            ranks[key] = (uint32_t)plan->run_count++;
            plan->runs[ranks[key]] = (hewn_gltf_run){.material = key < channel->name_count ? channel->names[key] : NULL,
                                                     .first_index = 3 * t};
        }
        triangles[t] = ranks[key];
        plan->runs[triangles[t]].index_count += 3;
        sorted = sorted && (t == 0 || triangles[t - 1] <= triangles[t]);
    }
    return sorted;
}

/* A stable counting sort of triangles by their runs. */
static hewn_result sort_triangles(const hewn_writing *job, hewn_glb_plan *plan, const uint32_t *runs, hewn_error *error)
{
    uint64_t *next = hewn_alloc(plan->run_count, sizeof *next), first = 0;
    plan->order = hewn_alloc(job->triangle_count, sizeof *plan->order);
    if (!next || !plan->order) {
        hewn_free(next);
        return fail_memory(error);
    }
    for (size_t i = 0; i < plan->run_count; i++) {
        plan->runs[i].first_index = 3 * first;
        next[i] = first;
        first += plan->runs[i].index_count / 3;
    }
    for (uint64_t t = 0; t < job->triangle_count; t++)
        plan->order[next[runs[t]]++] = (uint32_t)t;
    hewn_free(next);
    return HEWN_OK;
}

static hewn_result split_runs(const hewn_writing *job, const hewn_channel *channel, hewn_glb_plan *plan,
                              hewn_error *error)
{
    uint32_t *triangles = NULL, *ranks = hewn_alloc((size_t)channel->name_count + 1, sizeof *ranks);
    hewn_free(plan->runs);
    plan->run_count = 0;
    plan->runs = hewn_alloc((size_t)channel->name_count + 1, sizeof *plan->runs);
    hewn_result result = ranks && plan->runs ? find_faces(job, &triangles, error) : fail_memory(error);
    if (result == HEWN_OK) {
        memset(ranks, 0xff, ((size_t)channel->name_count + 1) * sizeof *ranks);
        if (!number_runs(job, channel, plan, ranks, triangles))
            result = sort_triangles(job, plan, triangles, error);
    }
    hewn_free(ranks);
    hewn_free(triangles);
    return result;
}

/* Whether the names of a face channel become materials. */
static bool makes_runs(const hewn_channel *channel)
{
    return channel->info.scalar == HEWN_SCALAR_INT32 && channel->info.components == 1 && channel->name_count > 0 &&
           channel->name_count <= MOST_RUNS;
}

static hewn_result plan_runs(const hewn_writing *job, hewn_glb_plan *plan, hewn_error *error)
{
    plan->runs = hewn_alloc_zero(1, sizeof *plan->runs);
    if (!plan->runs)
        return fail_memory(error);
    plan->runs[0].index_count = 3 * job->triangle_count;
    plan->run_count = 1;
    const hewn_channel *channel = hewn_writing_channel(job, HEWN_DOMAIN_FACE, "material");
    return channel && makes_runs(channel) ? split_runs(job, channel, plan, error) : HEWN_OK;
}

bool hewn_glb_keeps(const hewn_writing *job, const hewn_channel *channel)
{
    hewn_glb_layer layer;
    if (channel->info.domain == HEWN_DOMAIN_FACE)
        return strcmp(channel->info.name, "material") == 0 && makes_runs(channel);
    return is_written(job, channel, &layer);
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

static hewn_result check_positions(const hewn_writing *job, const hewn_glb_plan *plan, hewn_error *error)
{
    for (uint64_t v = 0; v < job->vertex_count; v++) {
        float p[3];
        hewn_glb_position(job, plan, v, p);
        if (!(isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2])))
            return hewn_fail(error, HEWN_LIMIT, "vertex %llu lies too far out for GLB's floats in metres",
                             (unsigned long long)v);
        if ((v + 1) % (16 * HEWN_WRITE_BLOCK) == 0)
            HEWN_TRY(hewn_progress_report(job->progress, "write", 0, error));
    }
    return HEWN_OK;
}

hewn_result hewn_glb_plan_make(const hewn_writing *job, hewn_glb_plan *out, hewn_error *error)
{
    *out = (hewn_glb_plan){0};
    HEWN_TRY(hewn_target_find(job, hewn_unit_find("m"), HEWN_AXIS_PLUS_Y, &out->conversion, error));
    HEWN_TRY(check_positions(job, out, error));
    if (job->triangle_count == 0)
        return HEWN_OK;
    HEWN_TRY(plan_layers(job, out, error));
    HEWN_TRY(plan_copies(job, out, error));
    HEWN_TRY(plan_runs(job, out, error));
    return hewn_glb_find_topology(job, out, &out->topology, error);
}

void hewn_glb_plan_free(hewn_glb_plan *plan)
{
    for (size_t i = 0; i < plan->layer_count; i++)
        hewn_free((void *)plan->layers[i].stream.semantic);
    hewn_free(plan->layers);
    hewn_free(plan->vertex_corners);
    hewn_free(plan->copied);
    hewn_free(plan->indices);
    hewn_free(plan->order);
    hewn_free(plan->runs);
    *plan = (hewn_glb_plan){0};
}
