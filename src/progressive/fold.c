/* Wedges and triangles of a model. */
#include "progressive/fold.h"

#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/hash.h"
#include "mesh/cut.h"

void hewn_fold_release(fold *of)
{
    hewn_free(of->positions);
    hewn_free(of->wedge_vertices);
    hewn_free(of->wedge_places);
    hewn_free(of->corner_wedges);
    hewn_free(of->triangles);
    hewn_free(of->faces);
    hewn_free(of->removed);
    hewn_free(of->labels);
    hewn_free(of->deviations);
    hewn_free(of->states);
    hewn_free(of->quadrics);
    hewn_free(of->list_first);
    hewn_free(of->list_count);
    hewn_free(of->pool);
    hewn_free(of->stamps);
    hewn_free(of->records);
    hewn_free(of->changes);
    hewn_free(of->gone);
    *of = (fold){0};
}

static hewn_result no_memory(hewn_error *error)
{
    return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a progressive mesh");
}

/* --- positions ---------------------------------------------------------------------------------------------------- */

/* Relative to the middle of the box and divided by a power of two, so that nothing overflows and little is rounded. */
static void place(fold *of)
{
    double lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY}, side = 0;
    for (size_t i = 0; i < 3 * (size_t)of->vertex_count; i++) {
        lo[i % 3] = fmin(lo[i % 3], of->model->positions[i]);
        hi[i % 3] = fmax(hi[i % 3], of->model->positions[i]);
    }
    for (int axis = 0; of->vertex_count > 0 && axis < 3; axis++) {
        of->origin[axis] = lo[axis] / 2 + hi[axis] / 2;
        side = fmax(side, hi[axis] / 2 - lo[axis] / 2);
    }
    int exponent = 0;
    if (side > 0)
        frexp(side, &exponent);
    of->scale = ldexp(1, exponent);
    for (size_t i = 0; i < 3 * (size_t)of->vertex_count; i++)
        of->positions[i] = (of->model->positions[i] - of->origin[i % 3]) / of->scale;
}

/* --- wedges ------------------------------------------------------------------------------------------------------- */

/* Corners by vertex and values: an open table of wedges. */
typedef struct table {
    uint32_t *slots;
    uint64_t mask;
    const hewn_model *model;
    size_t bytes; /* of a row */
    unsigned char *row, *other;
} table;

static uint32_t *find_wedge(const fold *of, table *in, uint32_t vertex, uint64_t corner)
{
    hewn_progressive_row_get(in->model, HEWN_DOMAIN_CORNER, corner, in->row);
    hewn_hash hash = hewn_hash_bytes(hewn_hash_begin(), &vertex, sizeof vertex);
    hash = hewn_hash_bytes(hash, in->row, in->bytes);
    for (uint64_t at = hash.a & in->mask;; at = (at + 1) & in->mask) {
        const uint32_t wedge = in->slots[at];
        if (wedge == HEWN_NONE)
            return &in->slots[at];
        if (of->wedge_vertices[wedge] != vertex)
            continue;
        hewn_progressive_row_get(in->model, HEWN_DOMAIN_CORNER, of->wedge_places[wedge], in->other);
        if (memcmp(in->row, in->other, in->bytes) == 0)
            return &in->slots[at];
    }
}

static void fill_wedges(fold *of, table *in)
{
    const uint64_t corners = hewn_model_corner_count(of->model);
    memset(in->slots, 0xff, (in->mask + 1) * sizeof *in->slots);
    for (uint64_t c = 0; c < corners; c++) {
        uint32_t *slot = find_wedge(of, in, of->model->corners[c], c);
        if (*slot == HEWN_NONE) {
            of->wedge_vertices[of->wedge_count] = of->model->corners[c];
            of->wedge_places[of->wedge_count] = (uint32_t)c;
            *slot = of->wedge_count++;
        }
        of->corner_wedges[c] = *slot;
    }
}

static hewn_result find_wedges(fold *of, size_t bytes, hewn_error *error)
{
    const uint64_t corners = hewn_model_corner_count(of->model);
    table in = {.model = of->model, .bytes = bytes, .mask = 15};
    while (in.mask < 2 * corners)
        in.mask = 2 * in.mask + 1;
    in.slots = hewn_alloc(in.mask + 1, sizeof *in.slots);
    in.row = hewn_alloc(bytes, 2);
    hewn_result result = in.slots && in.row ? HEWN_OK : no_memory(error);
    if (result == HEWN_OK) {
        in.other = in.row + bytes;
        fill_wedges(of, &in);
    }
    hewn_free(in.slots);
    hewn_free(in.row);
    return result;
}

/* Without values of corners every vertex is its own wedge. */
static void take_vertices(fold *of)
{
    const uint64_t corners = hewn_model_corner_count(of->model);
    of->wedge_count = of->vertex_count;
    for (uint32_t v = 0; v < of->vertex_count; v++) {
        of->wedge_vertices[v] = v;
        of->wedge_places[v] = HEWN_NONE;
    }
    for (uint64_t c = 0; c < corners; c++)
        of->corner_wedges[c] = of->model->corners[c];
}

static hewn_result make_wedges(fold *of, hewn_error *error)
{
    const uint64_t corners = hewn_model_corner_count(of->model);
    size_t bytes = 0;
    for (uint32_t i = 0; i < of->model->channel_count; i++) {
        const hewn_attribute_info *info = &of->model->channels[i].info;
        bytes += info->domain == HEWN_DOMAIN_CORNER ? info->components * hewn_scalar_size(info->scalar) : 0;
    }
    const uint64_t most = bytes > 0 ? corners : of->vertex_count;
    of->wedge_vertices = hewn_alloc(most, sizeof *of->wedge_vertices);
    of->wedge_places = hewn_alloc(most, sizeof *of->wedge_places);
    of->corner_wedges = hewn_alloc(corners, sizeof *of->corner_wedges);
    if (!of->wedge_vertices || !of->wedge_places || !of->corner_wedges)
        return no_memory(error);
    if (bytes > 0)
        return find_wedges(of, bytes, error);
    take_vertices(of);
    return HEWN_OK;
}

/* --- triangles ---------------------------------------------------------------------------------------------------- */

static hewn_result alloc_triangles(fold *of, hewn_error *error)
{
    const size_t count = of->triangle_count;
    of->triangles = hewn_alloc(count, 3 * sizeof *of->triangles);
    of->faces = hewn_alloc(count, sizeof *of->faces);
    of->removed = hewn_alloc_zero(count, sizeof *of->removed);
    of->deviations = hewn_alloc_zero(count, sizeof *of->deviations);
    return of->triangles && of->faces && of->removed && of->deviations ? HEWN_OK : no_memory(error);
}

static hewn_result make_triangles(fold *of, const hewn_progress *progress, hewn_error *error)
{
    const hewn_model *model = of->model;
    uint64_t count = model->face_count;
    uint32_t *places = NULL;
    if (model->first) {
        const hewn_polygons polygons = hewn_model_polygons(model);
        HEWN_TRY(hewn_cut_polygons(&polygons, &places, &count, progress, error));
    }
    of->triangle_count = of->live_triangles = (uint32_t)count;
    hewn_result result = alloc_triangles(of, error);
    for (uint64_t c = 0; result == HEWN_OK && c < 3 * count; c++)
        of->triangles[c] = of->corner_wedges[places ? places[c] : c];
    for (uint64_t t = 0, f = 0; result == HEWN_OK && t < count; t++) {
        while (places && places[3 * t] >= model->first[f + 1])
            f++;
        of->faces[t] = (uint32_t)(places ? f : t);
    }
    hewn_free(places);
    return result;
}

/* Triangles that differ in a whole number of their faces (label, material, group, object) are told apart. */
static hewn_result make_labels(fold *of, hewn_error *error)
{
    for (uint32_t i = 0; i < of->model->channel_count; i++) {
        const hewn_channel *channel = &of->model->channels[i];
        if (channel->info.domain != HEWN_DOMAIN_FACE || channel->info.scalar != HEWN_SCALAR_INT32)
            continue;
        if (!of->labels && !(of->labels = hewn_alloc_zero(of->triangle_count, sizeof *of->labels)))
            return no_memory(error);
        for (uint32_t t = 0; t < of->triangle_count; t++)
            for (uint32_t k = 0; k < channel->info.components; k++) {
                const int32_t value =
                    ((const int32_t *)channel->values)[(size_t)of->faces[t] * channel->info.components + k];
                of->labels[t] = (int32_t)((uint32_t)of->labels[t] * 0x9E3779B1u + (uint32_t)value);
            }
    }
    return HEWN_OK;
}

/* --- lists -------------------------------------------------------------------------------------------------------- */

static hewn_result make_lists(fold *of, hewn_error *error)
{
    of->pool_count = of->pool_room = 3 * (size_t)of->triangle_count;
    of->pool = hewn_alloc(of->pool_room, sizeof *of->pool);
    of->list_first = hewn_alloc_zero((size_t)of->vertex_count + 1, sizeof *of->list_first);
    of->list_count = hewn_alloc_zero(of->vertex_count, sizeof *of->list_count);
    if (!of->pool || !of->list_first || !of->list_count)
        return no_memory(error);
    for (size_t c = 0; c < of->pool_count; c++)
        of->list_first[of->wedge_vertices[of->triangles[c]] + 1]++;
    for (uint32_t v = 0; v < of->vertex_count; v++)
        of->list_first[v + 1] += of->list_first[v];
    for (size_t c = 0; c < of->pool_count; c++) {
        const uint32_t v = of->wedge_vertices[of->triangles[c]];
        of->pool[of->list_first[v] + of->list_count[v]++] = (uint32_t)(c / 3);
    }
    return HEWN_OK;
}

hewn_result hewn_fold_begin(const hewn_model *model, const hewn_progress *progress, fold *out, hewn_error *error)
{
    const uint64_t corners = hewn_model_corner_count(model);
    *out = (fold){.model = model, .vertex_count = (uint32_t)model->vertex_count};
    if (model->vertex_count >= UINT32_MAX / 4 || corners >= UINT32_MAX / 4 || model->face_count >= UINT32_MAX / 4)
        return hewn_fail(error, HEWN_LIMIT, "%llu corners are too many for a progressive mesh",
                         (unsigned long long)corners);
    out->positions = hewn_alloc(out->vertex_count, 3 * sizeof *out->positions);
    out->states = hewn_alloc_zero(out->vertex_count, sizeof *out->states);
    out->quadrics = hewn_alloc_zero(out->vertex_count, sizeof *out->quadrics);
    out->stamps = hewn_alloc_zero(out->vertex_count, sizeof *out->stamps);
    if (!out->positions || !out->states || !out->quadrics || !out->stamps)
        return no_memory(error);
    place(out);
    HEWN_TRY(make_wedges(out, error));
    HEWN_TRY(make_triangles(out, progress, error));
    HEWN_TRY(make_labels(out, error));
    return make_lists(out, error);
}
