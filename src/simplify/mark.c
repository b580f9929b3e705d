#include "base/alloc.h"
#include "base/error.h"
#include "simplify/work.h"

/* Edges are bent by the angle between the normals of their faces; one without area bends nothing. */
static bool is_bent(const simplify_work *work, uint32_t h, double cosine)
{
    double normals[2][3];
    for (int side = 0; side < 2; side++) {
        uint32_t g = side ? work->twin[h] : h;
        simplify_area_vector(simplify_at(work, work->tail[g]), simplify_at(work, simplify_head(work, g)),
                             simplify_at(work, work->tail[simplify_prev(g)]), normals[side]);
    }
    return simplify_bends(normals[0], normals[1], cosine);
}

static bool is_label_border(const simplify_work *work, uint32_t h)
{
    const int32_t *labels = work->desc->labels;
    return labels && labels[work->face_origins[h / 3]] != labels[work->face_origins[work->twin[h] / 3]];
}

/* Whether corners that meet along an edge have different values. */
static bool is_seam(const simplify_work *work, uint32_t h)
{
    const uint32_t g = work->twin[h];
    return work->wedge &&
           (work->wedge[h] != work->wedge[simplify_next(g)] || work->wedge[simplify_next(h)] != work->wedge[g]);
}

/* What one edge is to its ends. */
static void mark_edge(simplify_work *work, uint32_t h, double cosine)
{
    const hewn_simplify_desc *desc = work->desc;
    const bool boundary = work->twin[h] == HEWN_NONE;
    const bool border = !boundary && is_label_border(work, h);
    const bool bent = !boundary && desc->lock_angle > 0 && is_bent(work, h, cosine);
    work->flags[h] = boundary || border || is_seam(work, h) ? SIMPLIFY_FEATURE : 0;
    if (!((boundary && desc->lock_boundary) || (border && desc->lock_labels) || bent))
        return;
    for (int end = 0; end < 2; end++) {
        uint8_t *rank = &work->rank[end ? simplify_head(work, h) : work->tail[h]];
        uint8_t now;
#pragma omp atomic read
        now = *rank;
        if (now < SIMPLIFY_LOCKED) {
#pragma omp atomic write
            *rank = SIMPLIFY_LOCKED;
        }
    }
}

static void rank_vertex(simplify_work *work, uint32_t v)
{
    uint32_t first = work->half[v], h = first, features = 0;
    if (first == SIMPLIFY_GONE || work->rank[v] >= SIMPLIFY_LOCKED)
        return;
    do {
        features += work->flags[simplify_name(work, h)] & SIMPLIFY_FEATURE;
        uint32_t in = simplify_prev(h);
        features += work->twin[in] == HEWN_NONE;
        h = work->twin[in];
    } while (h != HEWN_NONE && h != first);
    work->rank[v] = features == 0 ? SIMPLIFY_SMOOTH : features == 2 ? SIMPLIFY_CREASE : SIMPLIFY_CORNER;
}

/* A vertex of a complex may move along its curve where it is on one, and on that alone: each of its fans lies between
 * the same two neighbours. Else all of its fans stay where they are. */
static void rank_tied(simplify_work *work, uint32_t v)
{
    uint32_t ends[2] = {HEWN_NONE, HEWN_NONE}, count = 0, at = v;
    uint8_t most = 0;
    bool curve = true;
    do {
        most = work->rank[at] > most ? work->rank[at] : most;
        curve = curve && work->rank[at] == SIMPLIFY_CREASE && work->twin[work->half[at]] == HEWN_NONE &&
                ++count <= SIMPLIFY_MOST_TIED;
        if (curve) {
            uint32_t h = work->half[at], in = simplify_prev(h);
            const uint32_t one = simplify_group(work, simplify_head(work, h));
            for (; work->twin[in] != HEWN_NONE; in = simplify_prev(h))
                h = work->twin[in];
            const uint32_t two = simplify_group(work, work->tail[in]);
            ends[0] = at == v ? one : ends[0];
            ends[1] = at == v ? two : ends[1];
            curve = one != two && ((one == ends[0] && two == ends[1]) || (one == ends[1] && two == ends[0]));
        }
        at = work->tie[at];
    } while (at != v);
    const uint8_t rank = curve ? SIMPLIFY_CREASE : most > SIMPLIFY_CORNER ? SIMPLIFY_LOCKED : SIMPLIFY_CORNER;
    do {
        work->rank[at] = work->rank[at] == SIMPLIFY_APART ? SIMPLIFY_APART : rank;
        at = work->tie[at];
    } while (at != v);
}

hewn_result hewn_simplify_mark(simplify_work *work, hewn_error *error)
{
    const uint32_t halves = 3 * work->face_count;
    const double cosine = cos(work->desc->lock_angle * (M_PI / 180));
    work->flags = hewn_alloc_zero(halves, sizeof *work->flags);
    work->key = hewn_alloc_zero(halves, sizeof *work->key);
    work->quadrics = hewn_alloc_zero(work->vertex_count, sizeof *work->quadrics);
    work->facing = hewn_alloc_zero(work->vertex_count, 3 * sizeof *work->facing);
    if (!work->flags || !work->key || !work->quadrics || !work->facing)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying %u triangles", work->face_count);
#pragma omp parallel for schedule(static) if (work->vertex_count > SIMPLIFY_FEW)
    for (uint32_t h = 0; h < halves; h++)
        if (simplify_name(work, h) == h)
            mark_edge(work, h, cosine);
#pragma omp parallel for schedule(static) if (work->vertex_count > SIMPLIFY_FEW)
    for (uint32_t v = 0; v < work->vertex_count; v++) {
        const uint32_t origin = work->origins[v];
        const bool frozen =
            (work->desc->frozen && work->desc->frozen[origin]) || (work->frozen && work->frozen[origin]);
        if ((frozen || (work->limit && work->limit[v] <= 0)) && work->rank[v] < SIMPLIFY_LOCKED)
            work->rank[v] = SIMPLIFY_LOCKED;
        rank_vertex(work, v);
    }
    for (uint32_t v = 0; work->tie && v < work->vertex_count; v++)
        if (work->tie[v] > v && work->half[v] != SIMPLIFY_GONE) /* the same again from each but the greatest */
            rank_tied(work, v);
    return HEWN_OK;
}
