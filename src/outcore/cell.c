#include "outcore/cell.h"

#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "outcore/locks.h"

/* What a vertex is to the region. */
enum { OWN = 1, AROUND = 2 /* has triangles of several regions */, LOCKED = 4 /* by the caller */ };

enum { POINT = 3 * sizeof(double), NAMES = 3 * sizeof(uint32_t) };

/* Channels by which vertices and faces of the result say what they were. */
static const char vertex_channel[] = "hewn vertex", face_channel[] = "hewn around";

typedef struct cell_work {
    const hewn_cell *cell;
    uint64_t own, triangles, taken;
    uint32_t *corners; /* vertices of the store, while triangles are read */
    uint32_t *names;   /* those vertices, in order */
    uint64_t count;
    hewn_model model;
    uint8_t *kinds, *frozen;
    char *record;
} cell_work;

/* What simplification leaves. */
typedef struct cell_result {
    hewn_simplified mesh;    /* where nothing is carried along, */
    hewn_model model;        /* or else */
    const uint32_t *corners; /* of either */
    const double *positions;
    uint64_t vertices, faces;
} cell_result;

static hewn_result out_of_memory(hewn_error *error)
{
    return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a part of a mesh");
}

/* Whether there is more than positions. */
static bool has_values(const hewn_store *store)
{
    return store->value_bytes[HEWN_DOMAIN_VERT] + store->value_bytes[HEWN_DOMAIN_CORNER] +
               store->value_bytes[HEWN_DOMAIN_FACE] >
           0;
}

/* --- from disk ---------------------------------------------------------------------------------------------------- */

static hewn_result take_corners(void *user, const void *record, hewn_error *error)
{
    cell_work *work = user;
    (void)error;
    memcpy(work->corners + 3 * work->taken++, record, NAMES);
    return HEWN_OK;
}

static hewn_result take_values(void *user, const void *record, hewn_error *error)
{
    cell_work *work = user;
    const hewn_store *store = work->cell->store;
    const size_t each = store->value_bytes[HEWN_DOMAIN_CORNER];
    const char *at = (const char *)record + NAMES;
    const uint64_t t = work->taken++;
    (void)error;
    for (uint64_t k = 0; k < 3; k++)
        hewn_store_get_values(store, HEWN_DOMAIN_CORNER, at + each * k, &work->model, 3 * t + k);
    hewn_store_get_values(store, HEWN_DOMAIN_FACE, at + 3 * each, &work->model, t);
    return HEWN_OK;
}

static hewn_result read_both(cell_work *work, bool consume, hewn_chain_take take, hewn_error *error)
{
    hewn_chains *chains = &work->cell->store->chains;
    work->taken = 0;
    HEWN_TRY(hewn_chain_read(chains, work->cell->own, consume, take, work, error));
    return hewn_chain_read(chains, work->cell->around, consume, take, work, error);
}

static int compare_names(const void *a, const void *b)
{
    const uint32_t one = *(const uint32_t *)a, two = *(const uint32_t *)b;
    return one < two ? -1 : one > two;
}

static hewn_result list_names(cell_work *work, hewn_error *error)
{
    const uint64_t corners = 3 * work->triangles;
    work->names = hewn_alloc(corners, sizeof *work->names);
    if (!work->names)
        return out_of_memory(error);
    memcpy(work->names, work->corners, corners * sizeof *work->names);
    qsort(work->names, corners, sizeof *work->names, compare_names);
    for (uint64_t c = 0; c < corners; c++)
        if (c == 0 || work->names[c] != work->names[c - 1])
            work->names[work->count++] = work->names[c];
    uint32_t *less = hewn_realloc(work->names, work->count, sizeof *work->names);
    work->names = less ? less : work->names;
    return HEWN_OK;
}

static hewn_result get_vertices(cell_work *work, hewn_error *error)
{
    const hewn_store *store = work->cell->store;
    const size_t flags = POINT + store->value_bytes[HEWN_DOMAIN_VERT];
    for (uint64_t v = 0; v < work->count; v++) {
        double *at = work->model.positions + 3 * v;
        HEWN_TRY(hewn_pages_get(store->vertices, work->names[v], work->record, error));
        memcpy(at, work->record, POINT);
        hewn_store_get_values(store, HEWN_DOMAIN_VERT, work->record + POINT, &work->model, v);
        if (hewn_region_of(work->cell->regions, at) == work->cell->region)
            work->kinds[v] |= OWN;
        if (work->record[flags] & HEWN_STORE_LOCKED)
            work->kinds[v] |= LOCKED;
    }
    return HEWN_OK;
}

/* Vertices of the model are those of the store in order, triangles the own ones and then those around. */
static hewn_result load(cell_work *work, hewn_error *error)
{
    const hewn_store *store = work->cell->store;
    work->corners = hewn_alloc(work->triangles, NAMES);
    work->record = hewn_alloc(1, hewn_store_vertex_bytes(store));
    if (!work->corners || !work->record)
        return out_of_memory(error);
    HEWN_TRY(read_both(work, false, take_corners, error));
    HEWN_TRY(list_names(work, error));
    HEWN_TRY(hewn_store_make_model(store, work->count, work->triangles, false, &work->model, error));
    for (uint64_t c = 0; c < 3 * work->triangles; c++) {
        const uint32_t *found =
            bsearch(&work->corners[c], work->names, work->count, sizeof *work->names, compare_names);
        work->model.corners[c] = (uint32_t)(found - work->names);
    }
    hewn_free(work->corners);
    work->corners = NULL;
    HEWN_TRY(read_both(work, true, take_values, error));
    work->kinds = hewn_alloc_zero(work->count, 1);
    work->frozen = hewn_alloc_zero(work->count, 1);
    if (!work->kinds || !work->frozen)
        return out_of_memory(error);
    for (uint64_t c = 3 * work->own; c < 3 * work->triangles; c++)
        work->kinds[work->model.corners[c]] |= AROUND;
    return get_vertices(work, error);
}

/* --- what stays --------------------------------------------------------------------------------------------------- */

static hewn_result lock(cell_work *work, hewn_error *error)
{
    const hewn_cell *cell = work->cell;
    if (cell->find_locks) {
        HEWN_TRY(hewn_locks_find(&work->model, cell->desc, cell->store->preserve, work->frozen, error));
        for (uint64_t v = 0; v < work->count; v++)
            work->kinds[v] |= work->frozen[v] && (work->kinds[v] & OWN) ? LOCKED : 0;
    }
    for (uint64_t v = 0; v < work->count; v++)
        work->frozen[v] = work->kinds[v] != OWN;
    return HEWN_OK;
}

/* Own triangles of which an edge stays: there are as many in the end. */
static uint64_t count_fixed(const cell_work *work)
{
    uint64_t count = 0;
    for (uint64_t t = 0; t < work->own; t++) {
        int fixed = 0;
        for (uint64_t k = 0; k < 3; k++)
            fixed += work->frozen[work->model.corners[3 * t + k]];
        count += fixed >= 2;
    }
    return count;
}

static hewn_simplify_desc describe(const cell_work *work)
{
    const hewn_cell *cell = work->cell;
    const uint64_t fixed = cell->strictly ? 0 : count_fixed(work);
    const uint64_t left = fixed + (uint64_t)(cell->share * (double)(work->own - fixed));
    hewn_simplify_desc desc = *cell->desc;
    desc.faces = work->triangles - work->own + (left > 0 ? left : 1);
    desc.ratio = desc.relative_error = 0;
    desc.error = cell->error;
    desc.measure = desc.measure || cell->error > 0; /* tells how little was used of it, which is left for others then */
    desc.lock_boundary = desc.lock_labels = false;
    desc.lock_angle = 0;
    desc.labels = NULL;
    desc.frozen = work->frozen;
    desc.progress = cell->progress;
    return desc;
}

/* --- simplification ----------------------------------------------------------------------------------------------- */

static hewn_result add_marks(cell_work *work, hewn_error *error)
{
    static const hewn_attribute_info vertices = {vertex_channel, HEWN_DOMAIN_VERT, HEWN_SCALAR_INT32, 1};
    static const hewn_attribute_info faces = {face_channel, HEWN_DOMAIN_FACE, HEWN_SCALAR_UINT8, 1};
    hewn_channel *channel;
    HEWN_TRY(hewn_model_add_channel(&work->model, &vertices, &channel, error));
    for (uint64_t v = 0; v < work->count; v++)
        ((int32_t *)channel->values)[v] = (int32_t)v;
    HEWN_TRY(hewn_model_add_channel(&work->model, &faces, &channel, error));
    memset((uint8_t *)channel->values + work->own, 1, work->triangles - work->own);
    return HEWN_OK;
}

static hewn_result simplify(cell_work *work, cell_result *out, hewn_simplify_report *report, hewn_error *error)
{
    const hewn_simplify_desc desc = describe(work);
    *out = (cell_result){0};
    if (has_values(work->cell->store)) {
        HEWN_TRY(add_marks(work, error));
        HEWN_TRY(hewn_model_simplify(&work->model, &desc, report, error));
        out->model = work->model;
        work->model = (hewn_model){0};
        out->corners = out->model.corners;
        out->positions = out->model.positions;
        out->vertices = out->model.vertex_count;
        out->faces = out->model.face_count;
        return HEWN_OK;
    }
    const hewn_polygons polygons = hewn_model_polygons(&work->model);
    HEWN_TRY(hewn_polygons_simplify(&polygons, &desc, &out->mesh, report, error));
    hewn_model_destroy(&work->model);
    out->corners = out->mesh.corners;
    out->positions = out->mesh.positions;
    out->vertices = out->mesh.vertex_count;
    out->faces = out->mesh.face_count;
    return HEWN_OK;
}

/* --- to disk ------------------------------------------------------------------------------------------------------ */

/* Vertices of other regions, and those that are around, are as they were in every region. */
static hewn_result put_vertices(cell_work *work, const cell_result *result, const uint32_t *origins, hewn_error *error)
{
    const hewn_store *store = work->cell->store;
    const size_t flags = POINT + store->value_bytes[HEWN_DOMAIN_VERT];
    for (uint64_t v = 0; v < result->vertices; v++) {
        if (work->kinds[origins[v]] != OWN)
            continue;
        memcpy(work->record, result->positions + 3 * v, POINT);
        hewn_store_put_values(store, HEWN_DOMAIN_VERT, work->record + POINT, &result->model, v);
        work->record[flags] = 0;
        HEWN_TRY(hewn_pages_put(store->vertices, work->names[origins[v]], work->record, error));
    }
    return HEWN_OK;
}

static hewn_result put_locks(cell_work *work, hewn_error *error)
{
    const hewn_store *store = work->cell->store;
    const size_t flags = POINT + store->value_bytes[HEWN_DOMAIN_VERT];
    for (uint64_t v = 0; work->cell->find_locks && v < work->count; v++) {
        if (!(work->kinds[v] & OWN) || !(work->kinds[v] & LOCKED))
            continue;
        HEWN_TRY(hewn_pages_get(store->vertices, work->names[v], work->record, error));
        work->record[flags] |= HEWN_STORE_LOCKED;
        HEWN_TRY(hewn_pages_put(store->vertices, work->names[v], work->record, error));
    }
    return HEWN_OK;
}

static bool is_around(const cell_work *work, const cell_result *result, uint64_t face)
{
    const hewn_channel *marks = hewn_model_find_channel(&result->model, HEWN_DOMAIN_FACE, face_channel);
    return marks ? ((const uint8_t *)marks->values)[face] != 0 : result->mesh.face_origins[face] >= work->own;
}

static hewn_result put_triangles(const cell_work *work, const cell_result *result, const uint32_t *origins,
                                 hewn_cell_report *report, hewn_error *error)
{
    hewn_store *store = work->cell->store;
    const size_t each = store->value_bytes[HEWN_DOMAIN_CORNER];
    char *record = hewn_alloc(1, hewn_store_triangle_bytes(store));
    hewn_result done = record ? HEWN_OK : out_of_memory(error);
    for (uint64_t f = 0; done == HEWN_OK && f < result->faces; f++) {
        uint32_t names[3];
        if (is_around(work, result, f))
            continue;
        for (uint64_t k = 0; k < 3; k++) {
            names[k] = work->names[origins[result->corners[3 * f + k]]];
            hewn_store_put_values(store, HEWN_DOMAIN_CORNER, record + NAMES + each * k, &result->model, 3 * f + k);
        }
        memcpy(record, names, NAMES);
        hewn_store_put_values(store, HEWN_DOMAIN_FACE, record + NAMES + 3 * each, &result->model, f);
        done = hewn_chain_add(&store->chains, work->cell->out, record, error);
        report->triangles++;
    }
    hewn_free(record);
    return done;
}

static hewn_result save(cell_work *work, const cell_result *result, hewn_cell_report *report, hewn_error *error)
{
    const hewn_channel *marks = hewn_model_find_channel(&result->model, HEWN_DOMAIN_VERT, vertex_channel);
    const uint32_t *origins = marks ? (const uint32_t *)marks->values : result->mesh.vertex_origins;
    if (!origins || !result->corners || !result->positions)
        return hewn_fail(error, HEWN_INTERNAL, "a part of a mesh came back without what its vertices were");
    HEWN_TRY(put_vertices(work, result, origins, error));
    HEWN_TRY(put_locks(work, error));
    return put_triangles(work, result, origins, report, error);
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

static hewn_result run(cell_work *work, hewn_cell_report *report, hewn_error *error)
{
    cell_result result = {0};
    hewn_simplify_report done = {0};
    HEWN_TRY(load(work, error));
    HEWN_TRY(lock(work, error));
    for (uint64_t v = 0; v < work->count; v++)
        report->vertices += work->kinds[v] & OWN;
    hewn_result status = simplify(work, &result, &done, error);
    if (status == HEWN_OK)
        status = save(work, &result, report, error);
    report->distance = done.distance;
    report->distance_low = done.distance_low;
    hewn_simplified_destroy(&result.mesh);
    hewn_model_destroy(&result.model);
    return status;
}

hewn_result hewn_cell_simplify(const hewn_cell *cell, hewn_cell_report *report, hewn_error *error)
{
    cell_work work = {.cell = cell, .own = cell->own->count, .triangles = cell->own->count + cell->around->count};
    *report = (hewn_cell_report){0};
    hewn_result result = work.triangles > 0 ? run(&work, report, error) : HEWN_OK;
    hewn_free(work.corners);
    hewn_free(work.names);
    hewn_model_destroy(&work.model);
    hewn_free(work.kinds);
    hewn_free(work.frozen);
    hewn_free(work.record);
    return result;
}
