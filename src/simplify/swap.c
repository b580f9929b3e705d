#include "simplify/swap.h"

#include "simplify/across.h"

/* Cosines between a triangle's normal and the mean of both before, and the shape below which it is a sliver. */
static const double least_cosine = 0.5, least_shape = 0.02;

/* The corners of the two triangles of an edge: its ends a and b, and what is across from it on both sides. */
typedef struct swap_corners {
    uint32_t a, b, c, d;
} swap_corners;

static swap_corners corners_of(const simplify_work *work, uint32_t h)
{
    const uint32_t t = work->twin[h];
    return (swap_corners){work->tail[h], work->tail[t], work->tail[simplify_prev(h)], work->tail[simplify_prev(t)]};
}

/* --- whether it may ----------------------------------------------------------------------------------------------- */

static bool is_joined(const simplify_work *work, uint32_t v, uint32_t other)
{
    const uint32_t first = work->half[v];
    uint32_t h = first;
    do {
        const uint32_t in = simplify_prev(h);
        if (simplify_head(work, h) == other || work->tail[in] == other)
            return true;
        h = work->twin[in];
    } while (h != HEWN_NONE && h != first);
    return false;
}

/* The value of a corner is the same on both sides of the edge. */
static bool is_seamless(const simplify_work *work, uint32_t h)
{
    const uint32_t t = work->twin[h];
    return !work->wedge ||
           (work->wedge[h] == work->wedge[simplify_next(t)] && work->wedge[simplify_next(h)] == work->wedge[t]);
}

/* 1 for three equal sides. */
static double shape_of(const simplify_work *work, uint32_t a, uint32_t b, uint32_t c, double normal[3])
{
    double u[3], v[3], w[3];
    simplify_between(simplify_at(work, a), simplify_at(work, b), u);
    simplify_between(simplify_at(work, b), simplify_at(work, c), v);
    simplify_between(simplify_at(work, c), simplify_at(work, a), w);
    simplify_cross(u, v, normal);
    const double sides = simplify_dot(u, u) + simplify_dot(v, v) + simplify_dot(w, w);
    return sides > 0 ? 3.4641016151377544 * sqrt(simplify_dot(normal, normal)) / sides : 0;
}

static bool turns_little(const double normal[3], const double mean[3])
{
    return simplify_dot(normal, mean) >= least_cosine * sqrt(simplify_dot(normal, normal) * simplify_dot(mean, mean));
}

/* Whether a new triangle faces where the surface that became its corners did. */
static bool faces_along(const simplify_work *work, const double normal[3], uint32_t a, uint32_t b, uint32_t c)
{
    double sum = 0;
    for (size_t axis = 0; axis < 3; axis++)
        sum += normal[axis] * ((double)work->facing[3 * (size_t)a + axis] + (double)work->facing[3 * (size_t)b + axis] +
                               (double)work->facing[3 * (size_t)c + axis]);
    return sum >= 0;
}

static bool is_sound(const simplify_work *work, const swap_corners *at)
{
    double old[2][3], new[2][3], mean[3];
    const double before =
        fmin(shape_of(work, at->a, at->b, at->c, old[0]), shape_of(work, at->b, at->a, at->d, old[1]));
    const double after = fmin(shape_of(work, at->c, at->a, at->d, new[0]), shape_of(work, at->d, at->b, at->c, new[1]));
    for (int axis = 0; axis < 3; axis++)
        mean[axis] = old[0][axis] + old[1][axis];
    return (after >= least_shape || after > before) && turns_little(new[0], mean) && turns_little(new[1], mean) &&
           faces_along(work, new[0], at->c, at->a, at->d) && faces_along(work, new[1], at->d, at->b, at->c);
}

bool hewn_simplify_may_swap(const simplify_work *work, uint32_t h)
{
    if (work->groups || work->twin[h] == HEWN_NONE || work->flags[simplify_name(work, h)] & SIMPLIFY_FEATURE)
        return false;
    const swap_corners at = corners_of(work, h);
    const uint8_t *rank = work->rank;
    if (rank[at.a] == SIMPLIFY_APART || rank[at.b] == SIMPLIFY_APART || rank[at.c] == SIMPLIFY_APART ||
        rank[at.d] == SIMPLIFY_APART || (rank[at.a] >= SIMPLIFY_CORNER && rank[at.b] >= SIMPLIFY_CORNER))
        return false;
    return at.c != at.d && is_seamless(work, h) && is_sound(work, &at) && !is_joined(work, at.c, at.d);
}

/* --- doing it ----------------------------------------------------------------------------------------------------- */

void hewn_simplify_swap(simplify_work *work, uint32_t h)
{
    const uint32_t t = work->twin[h], hn = simplify_next(h), hp = simplify_prev(h), tn = simplify_next(t),
                   tp = simplify_prev(t);
    const swap_corners at = corners_of(work, h);
    const simplify_across bc = simplify_across_take(work, hn), ca = simplify_across_take(work, hp),
                          ad = simplify_across_take(work, tn), db = simplify_across_take(work, tp);
    simplify_across_give(work, hn, at.c, &ca);
    simplify_across_give(work, hp, at.a, &ad);
    simplify_across_give(work, tn, at.d, &db);
    simplify_across_give(work, tp, at.b, &bc);
    work->tail[h] = at.d;
    work->tail[t] = at.c;
    if (work->wedge) {
        work->wedge[h] = db.wedge;
        work->wedge[t] = ca.wedge;
    }
    work->half[at.a] = work->half[at.a] == h || work->half[at.a] == tn ? hp : work->half[at.a];
    work->half[at.b] = work->half[at.b] == t || work->half[at.b] == hn ? tp : work->half[at.b];
    work->half[at.c] = work->half[at.c] == hp ? hn : work->half[at.c];
    work->half[at.d] = work->half[at.d] == tp ? tn : work->half[at.d];
}
