#include "outcore/store.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "hewn/simplify.h"
#include "mesh/cut.h"

enum { POINT = 3 * sizeof(double), NAMES = 3 * sizeof(uint32_t) };

void hewn_store_begin(const char *output, uint32_t preserve, size_t memory, hewn_store *out)
{
    *out = (hewn_store){.output = output, .preserve = preserve, .memory = memory};
}

void hewn_store_free(hewn_store *store)
{
    hewn_model_destroy(&store->schema);
    hewn_free(store->places);
    hewn_pages_destroy(&store->vertices);
    hewn_chain_free(&store->triangles);
    hewn_chain_free(&store->polygon_corners);
    hewn_chains_close(&store->chains);
    hewn_chains_close(&store->polygons);
    hewn_free(store->record);
    *store = (hewn_store){0};
}

size_t hewn_store_triangle_bytes(const hewn_store *store)
{
    return NAMES + 3 * store->value_bytes[HEWN_DOMAIN_CORNER] + store->value_bytes[HEWN_DOMAIN_FACE];
}

size_t hewn_store_vertex_bytes(const hewn_store *store)
{
    return POINT + store->value_bytes[HEWN_DOMAIN_VERT] + 1;
}

/* A corner of a polygon: its vertex, how many of the polygon's corners follow, its values and those of the face. */
static size_t corner_bytes(const hewn_store *store)
{
    return 2 * sizeof(uint32_t) + store->value_bytes[HEWN_DOMAIN_CORNER] + store->value_bytes[HEWN_DOMAIN_FACE];
}

/* --- channels ----------------------------------------------------------------------------------------------------- */

static bool is_named(const hewn_channel *channel, const char *name)
{
    return strncmp(channel->info.name, name, strlen(name)) == 0;
}

/* As simplification does: texture coordinates that do not count are dropped, and normals made anew. */
static hewn_store_fate fate_of(const hewn_channel *channel, uint32_t preserve)
{
    const bool uv = is_named(channel, "uv"), normal = is_named(channel, "normal");
    const bool real = channel->info.scalar == HEWN_SCALAR_FLOAT || channel->info.scalar == HEWN_SCALAR_DOUBLE;
    if (channel->info.domain == HEWN_DOMAIN_FACE || !(uv || normal) || (uv && (preserve & HEWN_PRESERVE_UV)) ||
        (normal && (preserve & HEWN_PRESERVE_NORMAL)))
        return HEWN_STORE_KEPT;
    const bool direction = strcmp(channel->info.name, "normal") == 0 && channel->info.components == 3 && real;
    return direction ? HEWN_STORE_RENEWED : HEWN_STORE_DROPPED;
}

static hewn_result learn_channel(hewn_store *store, const hewn_channel *channel, hewn_error *error)
{
    hewn_channel *mine;
    HEWN_TRY(hewn_model_add_channel(&store->schema, &channel->info, &mine, error));
    hewn_store_place *more = hewn_realloc(store->places, store->schema.channel_count, sizeof *more);
    if (!more)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for channels");
    store->places = more;
    hewn_store_place *place = &store->places[store->schema.channel_count - 1];
    size_t *bytes = &store->value_bytes[channel->info.domain];
    *place = (hewn_store_place){.fate = fate_of(channel, store->preserve), .offset = *bytes};
    if (place->fate == HEWN_STORE_KEPT) {
        place->size = channel->info.components * hewn_scalar_size(channel->info.scalar);
        *bytes += place->size;
    }
    return HEWN_OK;
}

static hewn_result learn(hewn_store *store, const hewn_model *part, bool vertices, hewn_error *error)
{
    for (uint32_t i = 0; i < part->channel_count; i++)
        if ((part->channels[i].info.domain == HEWN_DOMAIN_VERT) == vertices)
            HEWN_TRY(learn_channel(store, &part->channels[i], error));
    if (vertices) {
        store->vertices_known = true;
        return hewn_pages_create(store->output, hewn_store_vertex_bytes(store), store->memory, &store->vertices, error);
    }
    store->faces_known = true;
    HEWN_TRY(hewn_chains_open(store->output, hewn_store_triangle_bytes(store), &store->chains, error));
    return hewn_chains_open(store->output, corner_bytes(store), &store->polygons, error);
}

static bool are_alike(const hewn_channel *a, const hewn_channel *b)
{
    return a && b && a->info.scalar == b->info.scalar && a->info.components == b->info.components;
}

/* All channels of a part must be known, and all that are known be there. */
static hewn_result compare(const hewn_store *store, const hewn_model *part, bool vertices, hewn_error *error)
{
    const hewn_model *one = part, *two = &store->schema;
    for (int turn = 0; turn < 2; turn++) {
        for (uint32_t i = 0; i < one->channel_count; i++) {
            const hewn_channel *channel = &one->channels[i];
            if ((channel->info.domain == HEWN_DOMAIN_VERT) != vertices)
                continue;
            if (!are_alike(channel, hewn_model_find_channel(two, channel->info.domain, channel->info.name)))
                return hewn_fail(error, HEWN_LIMIT,
                                 "some %s have \"%s\" and others have not, which a mesh that does not fit in the "
                                 "memory allowed cannot have",
                                 vertices ? "vertices" : "faces", channel->info.name);
        }
        one = &store->schema;
        two = part;
    }
    return HEWN_OK;
}

/* What values of a part are called is a number of the whole's own. */
static hewn_result rename_values(hewn_store *store, hewn_model *part, hewn_error *error)
{
    for (uint32_t i = 0; i < part->channel_count; i++) {
        const hewn_channel *channel = &part->channels[i];
        hewn_channel *mine = hewn_model_find_channel(&store->schema, channel->info.domain, channel->info.name);
        const uint64_t count = hewn_model_domain_count(part, channel->info.domain) * channel->info.components;
        if (!mine || channel->name_count == 0 || channel->info.scalar != HEWN_SCALAR_INT32)
            continue;
        int32_t *names = hewn_alloc(channel->name_count, sizeof *names);
        hewn_result result = names ? HEWN_OK : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for names");
        for (uint32_t k = 0; result == HEWN_OK && k < channel->name_count; k++)
            result = hewn_channel_value(mine, channel->names[k], &names[k], error);
        for (uint64_t k = 0; result == HEWN_OK && k < count; k++) {
            int32_t *value = (int32_t *)channel->values + k;
            if (*value >= 0 && (uint32_t)*value < channel->name_count)
                *value = names[*value];
        }
        hewn_free(names);
        HEWN_TRY(result);
    }
    return HEWN_OK;
}

static void copy_values(const hewn_store *store, hewn_domain domain, char *record, hewn_model *model, uint64_t element,
                        bool to_record)
{
    for (uint32_t i = 0; store->value_bytes[domain] > 0 && i < store->schema.channel_count; i++) {
        const hewn_channel *mine = &store->schema.channels[i];
        const hewn_store_place *place = &store->places[i];
        if (mine->info.domain != domain || place->fate != HEWN_STORE_KEPT)
            continue;
        const hewn_channel *channel = hewn_model_find_channel(model, domain, mine->info.name);
        if (!channel)
            continue;
        char *value = (char *)channel->values + element * place->size;
        memcpy(to_record ? record + place->offset : value, to_record ? value : record + place->offset, place->size);
    }
}

void hewn_store_get_values(const hewn_store *store, hewn_domain domain, const char *record, hewn_model *model,
                           uint64_t element)
{
    copy_values(store, domain, (char *)record, model, element, false);
}

void hewn_store_put_values(const hewn_store *store, hewn_domain domain, char *record, const hewn_model *model,
                           uint64_t element)
{
    hewn_model view = *model;
    copy_values(store, domain, record, &view, element, true);
}

hewn_result hewn_store_make_model(const hewn_store *store, uint64_t vertices, uint64_t faces, bool renewed,
                                  hewn_model *out, hewn_error *error)
{
    const hewn_model *schema = &store->schema;
    *out = (hewn_model){.vertex_count = vertices,
                        .face_count = faces,
                        .positions = hewn_alloc(vertices, POINT),
                        .corners = hewn_alloc(faces, NAMES),
                        .unit = schema->unit,
                        .up = schema->up,
                        .up_known = schema->up_known};
    hewn_result result = out->positions && out->corners
                             ? HEWN_OK
                             : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a part of a mesh");
    for (uint32_t i = 0; result == HEWN_OK && i < schema->channel_count; i++) {
        hewn_channel *made;
        const hewn_store_fate fate = store->places[i].fate;
        if (fate == HEWN_STORE_DROPPED || (fate == HEWN_STORE_RENEWED && !renewed))
            continue;
        result = hewn_model_add_channel(out, &schema->channels[i].info, &made, error);
        for (uint32_t k = 0; result == HEWN_OK && k < schema->channels[i].name_count; k++) {
            int32_t value;
            result = hewn_channel_value(made, schema->channels[i].names[k], &value, error);
        }
    }
    if (result != HEWN_OK)
        hewn_model_destroy(out);
    return result;
}

/* --- vertices and triangles --------------------------------------------------------------------------------------- */

hewn_result hewn_store_vertex(hewn_store *store, uint32_t vertex, double position[3], hewn_error *error)
{
    HEWN_TRY(hewn_pages_get(store->vertices, vertex, store->record, error));
    memcpy(position, store->record, POINT);
    return HEWN_OK;
}

static hewn_result add_vertices(hewn_store *store, const hewn_model *part, char *record, hewn_error *error)
{
    if (store->vertex_count + part->vertex_count >= HEWN_NONE)
        return hewn_fail(error, HEWN_LIMIT, "more vertices than indices can name");
    for (uint64_t v = 0; v < part->vertex_count; v++) {
        const double *at = part->positions + 3 * v;
        if (!(isfinite(at[0]) && isfinite(at[1]) && isfinite(at[2])))
            return hewn_fail(error, HEWN_BAD_INPUT, "the position of vertex %llu is not finite",
                             (unsigned long long)(store->vertex_count + v));
        memset(record, 0, hewn_store_vertex_bytes(store));
        memcpy(record, at, POINT);
        hewn_store_put_values(store, HEWN_DOMAIN_VERT, record + POINT, part, v);
        HEWN_TRY(hewn_pages_put(store->vertices, store->vertex_count + v, record, error));
    }
    store->vertex_count += part->vertex_count;
    return HEWN_OK;
}

/* Corners are places in the corners of `part`, which name vertices of the whole. */
static hewn_result add_triangle(hewn_store *store, const hewn_model *part, const uint64_t corners[3], uint64_t face,
                                char *record, hewn_error *error)
{
    const size_t each = store->value_bytes[HEWN_DOMAIN_CORNER];
    uint32_t names[3];
    for (int k = 0; k < 3; k++) {
        names[k] = part->corners[corners[k]];
        hewn_store_put_values(store, HEWN_DOMAIN_CORNER, record + NAMES + each * (size_t)k, part, corners[k]);
    }
    memcpy(record, names, NAMES);
    hewn_store_put_values(store, HEWN_DOMAIN_FACE, record + NAMES + 3 * each, part, face);
    store->triangles_before++;
    if (names[0] == names[1] || names[1] == names[2] || names[2] == names[0]) {
        store->dropped_faces++;
        return HEWN_OK;
    }
    return hewn_chain_add(&store->chains, &store->triangles, record, error);
}

static hewn_result add_polygon(hewn_store *store, const hewn_model *part, uint64_t face, char *record,
                               hewn_error *error)
{
    for (uint64_t c = part->first[face]; c < part->first[face + 1]; c++) {
        const uint32_t head[2] = {part->corners[c], (uint32_t)(part->first[face + 1] - 1 - c)};
        memcpy(record, head, sizeof head);
        hewn_store_put_values(store, HEWN_DOMAIN_CORNER, record + sizeof head, part, c);
        hewn_store_put_values(store, HEWN_DOMAIN_FACE, record + sizeof head + store->value_bytes[HEWN_DOMAIN_CORNER],
                              part, face);
        HEWN_TRY(hewn_chain_add(&store->polygons, &store->polygon_corners, record, error));
    }
    return HEWN_OK;
}

static hewn_result add_faces(hewn_store *store, const hewn_model *part, char *record, hewn_error *error)
{
    for (uint64_t f = 0; f < part->face_count; f++) {
        const uint64_t first = part->first ? part->first[f] : 3 * f;
        const uint64_t corners[3] = {first, first + 1, first + 2};
        if (part->first && part->first[f + 1] - first != 3)
            HEWN_TRY(add_polygon(store, part, f, record, error));
        else
            HEWN_TRY(add_triangle(store, part, corners, f, record, error));
    }
    return HEWN_OK;
}

/* Room for any record. */
static hewn_result make_record(const hewn_store *store, char **out, hewn_error *error)
{
    const size_t vertex = hewn_store_vertex_bytes(store), triangle = hewn_store_triangle_bytes(store);
    *out = hewn_alloc(1, vertex > triangle ? vertex : triangle);
    return *out ? HEWN_OK : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a part of a mesh");
}

hewn_result hewn_store_add(hewn_store *store, hewn_model *part, hewn_error *error)
{
    const uint64_t counts[2] = {part->face_count, part->vertex_count};
    char *record;
    for (int vertices = 1; vertices >= 0; vertices--) {
        if (counts[vertices] == 0)
            continue;
        if (vertices ? store->vertices_known : store->faces_known)
            HEWN_TRY(compare(store, part, vertices, error));
        else
            HEWN_TRY(learn(store, part, vertices, error));
    }
    HEWN_TRY(rename_values(store, part, error));
    HEWN_TRY(make_record(store, &record, error));
    hewn_result result = add_vertices(store, part, record, error);
    if (result == HEWN_OK)
        result = add_faces(store, part, record, error);
    store->faces_before += part->face_count;
    hewn_free(record);
    return result;
}

/* --- polygons ----------------------------------------------------------------------------------------------------- */

/* Polygons that are cut in one go. */
enum { CUT_CORNERS = 1 << 15 };

typedef struct polygon_run {
    hewn_store *store;
    char *record;
    char *corners; /* records */
    size_t count, room;
} polygon_run;

static int compare_names(const void *a, const void *b)
{
    const uint32_t one = *(const uint32_t *)a, two = *(const uint32_t *)b;
    return one < two ? -1 : one > two;
}

static uint32_t name_at(const polygon_run *run, size_t corner, uint32_t *left)
{
    uint32_t head[2];
    memcpy(head, run->corners + corner * corner_bytes(run->store), sizeof head);
    if (left)
        *left = head[1];
    return head[0];
}

/* Faces over vertices of their own, in the order of the vertices' numbers; `names` gets these. */
static hewn_result gather(const polygon_run *run, uint32_t *names, hewn_model *out, hewn_error *error)
{
    hewn_store *store = run->store;
    uint64_t verts = 0;
    uint32_t left;
    for (size_t c = 0; c < run->count; c++)
        names[c] = name_at(run, c, NULL);
    qsort(names, run->count, sizeof *names, compare_names);
    for (size_t c = 0; c < run->count; c++)
        if (c == 0 || names[c] != names[c - 1])
            names[verts++] = names[c];
    out->vertex_count = verts;
    for (uint64_t v = 0; v < verts; v++) {
        if (names[v] >= store->vertex_count)
            return hewn_fail(error, HEWN_BAD_INPUT, "a face names vertex %u, but there are %llu vertices", names[v],
                             (unsigned long long)store->vertex_count);
        HEWN_TRY(hewn_store_vertex(store, names[v], out->positions + 3 * v, error));
    }
    out->first[0] = 0;
    for (size_t c = 0; c < run->count; c++) {
        const uint32_t name = name_at(run, c, &left);
        const uint32_t *found = bsearch(&name, names, verts, sizeof *names, compare_names);
        out->corners[c] = (uint32_t)(found - names);
        if (left == 0)
            out->first[++out->face_count] = c + 1;
    }
    return HEWN_OK;
}

/* The triangle of three corners that lie in the run. */
static hewn_result add_cut(const polygon_run *run, const uint32_t corners[3], hewn_error *error)
{
    hewn_store *store = run->store;
    const size_t each = store->value_bytes[HEWN_DOMAIN_CORNER], head = 2 * sizeof(uint32_t);
    uint32_t names[3];
    for (int k = 0; k < 3; k++) {
        const char *from = run->corners + corners[k] * corner_bytes(store);
        names[k] = name_at(run, corners[k], NULL);
        memcpy(run->record + NAMES + each * (size_t)k, from + head, each);
        memcpy(run->record + NAMES + 3 * each, from + head + each, store->value_bytes[HEWN_DOMAIN_FACE]);
    }
    memcpy(run->record, names, NAMES);
    store->triangles_before++;
    if (names[0] == names[1] || names[1] == names[2] || names[2] == names[0]) {
        store->dropped_faces++;
        return HEWN_OK;
    }
    return hewn_chain_add(&store->chains, &store->triangles, run->record, error);
}

static hewn_result cut_run(polygon_run *run, hewn_error *error)
{
    uint32_t *names = hewn_alloc(run->count, sizeof *names), *cut = NULL;
    uint64_t count = 0;
    hewn_model polygons = {.positions = hewn_alloc(run->count, POINT),
                           .first = hewn_alloc(run->count + 1, sizeof *polygons.first),
                           .corners = hewn_alloc(run->count, sizeof *polygons.corners)};
    hewn_result result = names && polygons.positions && polygons.first && polygons.corners
                             ? gather(run, names, &polygons, error)
                             : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory cutting polygons");
    if (result == HEWN_OK) {
        const hewn_polygons view = hewn_model_polygons(&polygons);
        result = hewn_cut_polygons(&view, &cut, &count, NULL, error);
    }
    for (uint64_t t = 0; result == HEWN_OK && t < count; t++)
        result = add_cut(run, cut + 3 * t, error);
    hewn_free(names);
    hewn_free(cut);
    hewn_model_destroy(&polygons);
    run->count = 0;
    return result;
}

static hewn_result take_corner(void *user, const void *record, hewn_error *error)
{
    polygon_run *run = user;
    const size_t size = corner_bytes(run->store);
    void *items = run->corners;
    uint32_t left;
    HEWN_TRY(hewn_reserve(&items, &run->room, run->count + 1, size, error));
    run->corners = items;
    memcpy(run->corners + run->count++ * size, record, size);
    (void)name_at(run, run->count - 1, &left);
    return left == 0 && run->count >= CUT_CORNERS ? cut_run(run, error) : HEWN_OK;
}

hewn_result hewn_store_finish(hewn_store *store, hewn_error *error)
{
    if (!store->vertices_known || !store->faces_known)
        return hewn_fail(error, HEWN_BAD_INPUT, "there are no faces to simplify");
    polygon_run run = {.store = store};
    HEWN_TRY(make_record(store, &store->record, error));
    hewn_result result = make_record(store, &run.record, error);
    if (result == HEWN_OK)
        result = hewn_chain_settle(&store->polygons, &store->polygon_corners, error);
    if (result == HEWN_OK)
        result = hewn_chain_read(&store->polygons, &store->polygon_corners, true, take_corner, &run, error);
    if (result == HEWN_OK && run.count > 0)
        result = cut_run(&run, error);
    if (result == HEWN_OK)
        result = hewn_chain_settle(&store->chains, &store->triangles, error);
    hewn_free(run.record);
    hewn_free(run.corners);
    hewn_chains_close(&store->polygons);
    return result;
}
