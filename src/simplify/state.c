#include "simplify/state.h"

#include <string.h>

#include "base/alloc.h"
#include "base/error.h"

/* NULL stays NULL. */
static bool copy(void **to, const void *from, size_t count, size_t size)
{
    if (!from)
        return true;
    *to = hewn_alloc(count, size);
    if (*to)
        memcpy(*to, from, count * size);
    return *to != NULL;
}

/* All arrays of `to` become copies of those of `from`; what both share is not owned by either. */
static bool copy_work(const simplify_work *from, simplify_work *to)
{
    const size_t verts = from->vertex_count, faces = from->face_count, halves = 3 * faces;
    *to = *from;
    to->positions = NULL;
    to->quadrics = NULL;
    to->facing = NULL;
    to->half = NULL;
    to->rank = NULL;
    to->origins = NULL;
    to->limit = NULL;
    to->tie = NULL;
    to->tail = to->twin = NULL;
    to->key = NULL;
    to->flags = NULL;
    to->face_origins = NULL;
    to->wedge = NULL;
    to->into = NULL;
    return copy((void **)&to->positions, from->positions, verts, 3 * sizeof *to->positions) &&
           copy((void **)&to->quadrics, from->quadrics, verts, sizeof *to->quadrics) &&
           copy((void **)&to->facing, from->facing, verts, 3 * sizeof *to->facing) &&
           copy((void **)&to->half, from->half, verts, sizeof *to->half) &&
           copy((void **)&to->rank, from->rank, verts, sizeof *to->rank) &&
           copy((void **)&to->origins, from->origins, verts, sizeof *to->origins) &&
           copy((void **)&to->limit, from->limit, verts, sizeof *to->limit) &&
           copy((void **)&to->tie, from->tie, verts, sizeof *to->tie) &&
           copy((void **)&to->tail, from->tail, halves, sizeof *to->tail) &&
           copy((void **)&to->twin, from->twin, halves, sizeof *to->twin) &&
           copy((void **)&to->key, from->key, halves, sizeof *to->key) &&
           copy((void **)&to->flags, from->flags, halves, sizeof *to->flags) &&
           copy((void **)&to->face_origins, from->face_origins, faces, sizeof *to->face_origins) &&
           copy((void **)&to->wedge, from->wedge, halves, sizeof *to->wedge) &&
           copy((void **)&to->into, from->into, from->input_count, sizeof *to->into);
}

/* --- wedges ------------------------------------------------------------------------------------------------------- */

static bool list_wedges(const simplify_work *work, simplify_state *state)
{
    const size_t halves = 3 * (size_t)work->face_count;
    uint8_t *seen = hewn_alloc_zero(work->wedges->count, 1);
    state->wedges = hewn_alloc(halves, sizeof *state->wedges);
    for (size_t h = 0; seen && state->wedges && h < halves; h++)
        if (!seen[work->wedge[h]]) {
            seen[work->wedge[h]] = 1;
            state->wedges[state->wedge_count++] = work->wedge[h];
        }
    hewn_free(seen);
    return seen && state->wedges;
}

static bool save_wedges(const simplify_work *work, simplify_state *state)
{
    const simplify_wedges *wedges = work->wedges;
    const size_t stride = simplify_wedge_stride(wedges), scalars = wedges->scalars;
    if (!list_wedges(work, state))
        return false;
    state->values = hewn_alloc(state->wedge_count * scalars, sizeof *state->values);
    state->sums = wedges->sums ? hewn_alloc(state->wedge_count * stride, sizeof *state->sums) : NULL;
    if (!state->values || (wedges->sums && !state->sums))
        return false;
    for (size_t i = 0; i < state->wedge_count; i++) {
        const size_t w = state->wedges[i];
        memcpy(state->values + i * scalars, wedges->values + w * scalars, scalars * sizeof *state->values);
        if (state->sums)
            memcpy(state->sums + i * stride, wedges->sums + w * stride, stride * sizeof *state->sums);
    }
    return true;
}

static void restore_wedges(const simplify_state *state, const simplify_wedges *wedges)
{
    const size_t stride = simplify_wedge_stride(wedges), scalars = wedges->scalars;
    for (size_t i = 0; i < state->wedge_count; i++) {
        const size_t w = state->wedges[i];
        memcpy(wedges->values + w * scalars, state->values + i * scalars, scalars * sizeof *state->values);
        if (state->sums)
            memcpy(wedges->sums + w * stride, state->sums + i * stride, stride * sizeof *state->sums);
    }
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

void hewn_simplify_forget(simplify_state *state)
{
    hewn_simplify_release(&state->work);
    hewn_free(state->wedges);
    hewn_free(state->values);
    hewn_free(state->sums);
    *state = (simplify_state){0};
}

hewn_result hewn_simplify_save(const simplify_work *work, simplify_state *state, hewn_error *error)
{
    hewn_simplify_forget(state);
    if (copy_work(work, &state->work) && (!work->wedges || save_wedges(work, state)))
        return HEWN_OK;
    hewn_simplify_forget(state);
    return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
}

hewn_result hewn_simplify_restore(const simplify_state *state, simplify_work *work, hewn_error *error)
{
    simplify_work copied;
    const bool done = copy_work(&state->work, &copied);
    hewn_simplify_release(done ? work : &copied);
    if (!done)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
    *work = copied;
    if (work->wedges)
        restore_wedges(state, work->wedges);
    return HEWN_OK;
}
