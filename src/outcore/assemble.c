#include "outcore/assemble.h"

#include <string.h>

#include "base/alloc.h"
#include "base/error.h"

enum { POINT = 3 * sizeof(double), NAMES = 3 * sizeof(uint32_t), WORD = 64 };

/* Which of the store's vertices are there: a bit each, and for each word of bits how many come before. */
typedef struct present_set {
    uint64_t *bits;
    uint32_t *before;
    uint64_t words, count;
} present_set;

typedef struct assemble_work {
    hewn_store *store;
    present_set present;
    hewn_model model;
    uint64_t taken;
    char *record;
} assemble_work;

static hewn_result take_names(void *user, const void *record, hewn_error *error)
{
    assemble_work *work = user;
    uint32_t names[3];
    (void)error;
    memcpy(names, record, NAMES);
    for (int k = 0; k < 3; k++)
        work->present.bits[names[k] / WORD] |= (uint64_t)1 << names[k] % WORD;
    return HEWN_OK;
}

static uint32_t place_of(const present_set *present, uint32_t name)
{
    const uint64_t below = ((uint64_t)1 << name % WORD) - 1;
    return present->before[name / WORD] + (uint32_t)__builtin_popcountll(present->bits[name / WORD] & below);
}

static hewn_result find_present(assemble_work *work, hewn_error *error)
{
    present_set *present = &work->present;
    hewn_store *store = work->store;
    present->words = store->vertex_count / WORD + 1;
    present->bits = hewn_alloc_zero(present->words, sizeof *present->bits);
    present->before = hewn_alloc(present->words, sizeof *present->before);
    work->record = hewn_alloc(1, hewn_store_vertex_bytes(store));
    if (!present->bits || !present->before || !work->record)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for what is left of a mesh");
    HEWN_TRY(hewn_chain_read(&store->chains, &store->triangles, false, take_names, work, error));
    for (uint64_t i = 0; i < present->words; i++) {
        present->before[i] = (uint32_t)present->count;
        present->count += (uint64_t)__builtin_popcountll(present->bits[i]);
    }
    return HEWN_OK;
}

static hewn_result get_vertices(assemble_work *work, uint8_t *frozen, hewn_error *error)
{
    const hewn_store *store = work->store;
    const size_t flags = POINT + store->value_bytes[HEWN_DOMAIN_VERT];
    uint64_t v = 0;
    for (uint64_t name = 0; name < store->vertex_count; name++) {
        if (!(work->present.bits[name / WORD] >> name % WORD & 1))
            continue;
        HEWN_TRY(hewn_pages_get(store->vertices, name, work->record, error));
        memcpy(work->model.positions + 3 * v, work->record, POINT);
        hewn_store_get_values(store, HEWN_DOMAIN_VERT, work->record + POINT, &work->model, v);
        frozen[v++] = (work->record[flags] & HEWN_STORE_LOCKED) != 0;
    }
    return HEWN_OK;
}

static hewn_result take_triangle(void *user, const void *record, hewn_error *error)
{
    assemble_work *work = user;
    const size_t each = work->store->value_bytes[HEWN_DOMAIN_CORNER];
    const char *at = (const char *)record + NAMES;
    const uint64_t t = work->taken++;
    uint32_t names[3];
    (void)error;
    memcpy(names, record, NAMES);
    for (uint64_t k = 0; k < 3; k++) {
        work->model.corners[3 * t + k] = place_of(&work->present, names[k]);
        hewn_store_get_values(work->store, HEWN_DOMAIN_CORNER, at + each * k, &work->model, 3 * t + k);
    }
    hewn_store_get_values(work->store, HEWN_DOMAIN_FACE, at + 3 * each, &work->model, t);
    return HEWN_OK;
}

static hewn_result assemble(assemble_work *work, uint8_t **frozen, hewn_error *error)
{
    hewn_store *store = work->store;
    HEWN_TRY(find_present(work, error));
    HEWN_TRY(hewn_store_make_model(store, work->present.count, store->triangles.count, true, &work->model, error));
    *frozen = hewn_alloc(work->present.count, 1);
    if (!*frozen)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for what is left of a mesh");
    HEWN_TRY(get_vertices(work, *frozen, error));
    return hewn_chain_read(&store->chains, &store->triangles, true, take_triangle, work, error);
}

hewn_result hewn_store_assemble(hewn_store *store, hewn_model *out, uint8_t **frozen, hewn_error *error)
{
    assemble_work work = {.store = store};
    *out = (hewn_model){0};
    *frozen = NULL;
    const hewn_result result = assemble(&work, frozen, error);
    hewn_free(work.present.bits);
    hewn_free(work.present.before);
    hewn_free(work.record);
    if (result == HEWN_OK) {
        *out = work.model;
        return HEWN_OK;
    }
    hewn_model_destroy(&work.model);
    hewn_free(*frozen);
    *frozen = NULL;
    return result;
}
