#include "simplify/split.h"

#include "simplify/across.h"

/* Cosines between a triangle's normal and the one that it is cut from, and the shape below which it is a sliver. */
static const double least_cosine = 0.3, least_shape = 0.02;

/* --- whether it may ----------------------------------------------------------------------------------------------- */

bool hewn_simplify_may_split(const simplify_work *work, uint32_t h)
{
    const uint32_t t = work->twin[h];
    if (work->groups || work->wedge || t == HEWN_NONE || work->flags[simplify_name(work, h)] & SIMPLIFY_FEATURE)
        return false;
    const uint32_t corners[4] = {work->tail[h], work->tail[t], work->tail[simplify_prev(h)],
                                 work->tail[simplify_prev(t)]};
    for (int k = 0; k < 4; k++)
        if (work->rank[corners[k]] == SIMPLIFY_APART)
            return false;
    return true;
}

uint32_t hewn_simplify_free_origin(const simplify_work *work, uint32_t sample)
{
    const simplify_samples *samples = work->samples;
    const double *at = samples->items[sample].at;
    if (samples->rings[sample] == samples->rings[sample + 1])
        return HEWN_NONE;
    const uint32_t *corner = samples->input.corners + 3 * (size_t)samples->faces[samples->rings[sample]];
    for (int k = 0; k < 3; k++) {
        const double *place = samples->positions + 3 * (size_t)corner[k];
        if (!(place[0] < at[0] || place[0] > at[0] || place[1] < at[1] || place[1] > at[1] || place[2] < at[2] ||
              place[2] > at[2]))
            return work->into[corner[k]] == corner[k] ? HEWN_NONE : corner[k];
    }
    return HEWN_NONE;
}

/* 1 for three equal sides. */
static double shape_of(const double a[3], const double b[3], const double c[3], double normal[3])
{
    double u[3], v[3], w[3];
    simplify_between(a, b, u);
    simplify_between(b, c, v);
    simplify_between(c, a, w);
    simplify_cross(u, v, normal);
    const double sides = simplify_dot(u, u) + simplify_dot(v, v) + simplify_dot(w, w);
    return sides > 0 ? 3.4641016151377544 * sqrt(simplify_dot(normal, normal)) / sides : 0;
}

/* The two parts of the triangle of a half-edge. */
static bool is_sound(const simplify_work *work, uint32_t h, const double at[3])
{
    const double *a = simplify_at(work, work->tail[h]), *b = simplify_at(work, simplify_head(work, h)),
                 *c = simplify_at(work, work->tail[simplify_prev(h)]);
    double old[3], new[2][3];
    const double before = shape_of(a, b, c, old);
    const double after = fmin(shape_of(a, at, c, new[0]), shape_of(at, b, c, new[1]));
    bool sound = after >= least_shape || after > before;
    for (int i = 0; i < 2; i++)
        sound &=
            simplify_dot(new[i], old) >= least_cosine * sqrt(simplify_dot(new[i], new[i]) * simplify_dot(old, old));
    return sound;
}

bool hewn_simplify_split_allowed(const simplify_work *work, const simplify_split *split)
{
    const double *at = work->samples->items[split->sample].at;
    return is_sound(work, split->half, at) && is_sound(work, work->twin[split->half], at);
}

/* --- doing it ----------------------------------------------------------------------------------------------------- */

/* By the input's triangles around the sample. */
static void set_quadric(simplify_work *work, const simplify_split *split)
{
    const simplify_samples *samples = work->samples;
    simplify_quadric q = {0};
    for (uint32_t i = samples->rings[split->sample]; i < samples->rings[split->sample + 1]; i++) {
        const uint32_t *corner = samples->input.corners + 3 * (size_t)samples->faces[i];
        const double *a = samples->positions + 3 * (size_t)corner[0];
        double n[3];
        simplify_area_vector(a, samples->positions + 3 * (size_t)corner[1], samples->positions + 3 * (size_t)corner[2],
                             n);
        const double length = sqrt(simplify_dot(n, n));
        if (!(length > 0))
            continue;
        for (int axis = 0; axis < 3; axis++)
            n[axis] /= length;
        simplify_quadric_add_plane(&q, n, a, length / 2);
        q.weight += length / 2;
    }
    simplify_quadric_add_point(&q, samples->items[split->sample].at, 1e-12 * q.weight);
    work->quadrics[split->vertex] = q;
}

static void set_vertex(simplify_work *work, const simplify_split *split)
{
    const simplify_sample *sample = &work->samples->items[split->sample];
    const uint32_t m = split->vertex, h = split->half;
    set_quadric(work, split);
    for (size_t axis = 0; axis < 3; axis++) {
        work->positions[3 * (size_t)m + axis] = sample->at[axis];
        work->facing[3 * (size_t)m + axis] = sample->normal[axis];
    }
    work->rank[m] = SIMPLIFY_SMOOTH;
    work->origins[m] = work->into[split->origin] = split->origin;
    work->half[m] = 3 * split->faces[0];
    if (work->limit)
        work->limit[m] = fminf(work->limit[work->tail[h]], work->limit[work->tail[work->twin[h]]]);
    work->live_vertices++;
}

static void join_halves(simplify_work *work, uint32_t h, uint32_t t)
{
    work->twin[h] = t;
    work->twin[t] = h;
    const uint32_t name = simplify_name(work, h);
    work->key[name] = 0; /* a lower bound */
    work->flags[name] = 0;
}

/* Edge ab with c and d beside it: triangles amc and mad stay, mbc and bmd are new. */
void hewn_simplify_split(simplify_work *work, const simplify_split *split)
{
    const uint32_t h = split->half, t = work->twin[h], hn = simplify_next(h), tp = simplify_prev(t);
    const uint32_t b = work->tail[t], c = work->tail[simplify_prev(h)], d = work->tail[tp], m = split->vertex;
    const uint32_t x = 3 * split->faces[0], y = 3 * split->faces[1];
    const simplify_across bc = simplify_across_take(work, hn), db = simplify_across_take(work, tp);
    work->face_origins[x / 3] = work->face_origins[h / 3];
    work->face_origins[y / 3] = work->face_origins[t / 3];
    work->tail[x] = m;
    work->tail[x + 2] = c;
    work->tail[y] = b;
    work->tail[y + 1] = m;
    simplify_across_give(work, x + 1, b, &bc);
    simplify_across_give(work, y + 2, d, &db);
    work->tail[hn] = m;
    work->tail[t] = m;
    join_halves(work, h, t);
    join_halves(work, hn, x + 2);
    join_halves(work, tp, y + 1);
    join_halves(work, x, y);
    work->half[b] = work->half[b] == hn ? x + 1 : work->half[b] == t ? y : work->half[b];
    work->half[d] = work->half[d] == tp ? y + 2 : work->half[d];
    set_vertex(work, split);
    work->live_faces += 2;
}
