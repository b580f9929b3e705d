#include "simplify/collapse.h"

/* The most neighbours of a vertex that may be part of a collapse: what is beyond waits until others have made it less.
 */
enum { MOST_RING = 192 };

/* A triangle may turn by this much at a time (the cosine between its normals). Its shape, 1 for equal sides and 0
 * without area, may get as bad as the last, or worse where it was worse; below the one before, it is a sliver. */
static const double least_cosine = 0.2, least_shape = 0.02, no_shape = 1e-4;

/* --- edges of a complex ------------------------------------------------------------------------------------------- */

uint32_t hewn_simplify_sides(const simplify_work *work, const simplify_plan *plan,
                             simplify_side sides[SIMPLIFY_MOST_TIED])
{
    const uint32_t group = simplify_group(work, plan->kept);
    uint32_t count = 0, at = plan->gone;
    if (!simplify_is_tied(work, plan->gone)) {
        sides[0] = (simplify_side){plan->half, plan->gone, plan->kept};
        return 1;
    }
    do {
        uint32_t h = work->half[at], in = simplify_prev(h);
        if (count == SIMPLIFY_MOST_TIED || work->twin[h] != HEWN_NONE)
            return 0;
        if (simplify_group(work, simplify_head(work, h)) == group) {
            sides[count++] = (simplify_side){h, at, simplify_head(work, h)};
        } else {
            for (; work->twin[in] != HEWN_NONE; in = simplify_prev(h))
                h = work->twin[in];
            if (simplify_group(work, work->tail[in]) != group)
                return 0;
            sides[count++] = (simplify_side){in, at, work->tail[in]};
        }
        at = work->tie[at];
    } while (at != plan->gone);
    return count;
}

/* The sum of both ends' quadrics, of all fans. */
static void sum_ends(const simplify_work *work, const simplify_plan *plan, simplify_quadric *sum)
{
    simplify_side sides[SIMPLIFY_MOST_TIED];
    simplify_quadric_sum(&work->quadrics[plan->gone], &work->quadrics[plan->kept], sum);
    const uint32_t count = simplify_is_tied(work, plan->gone) ? hewn_simplify_sides(work, plan, sides) : 0;
    for (uint32_t i = 0; i < count; i++)
        if (sides[i].gone != plan->gone) {
            simplify_quadric_add(sum, &work->quadrics[sides[i].gone]);
            simplify_quadric_add(sum, &work->quadrics[sides[i].kept]);
        }
}

/* --- what it costs ------------------------------------------------------------------------------------------------ */

static void try_place(const simplify_quadric *q, const double at[3], simplify_plan *plan)
{
    double cost = simplify_quadric_value(q, at);
    if (cost < plan->cost) {
        plan->cost = cost;
        for (int axis = 0; axis < 3; axis++)
            plan->at[axis] = at[axis];
    }
}

/* The best place for both ends: where the quadric is least, unless that is undetermined or far away. */
static void place(const simplify_quadric *q, const double a[3], const double b[3], simplify_plan *plan)
{
    double middle[3], best[3], along[3], away[3];
    for (int axis = 0; axis < 3; axis++)
        middle[axis] = (a[axis] + b[axis]) / 2;
    simplify_between(a, b, along);
    if (simplify_quadric_least(q, middle, best)) {
        simplify_between(middle, best, away);
        if (simplify_dot(away, away) <= 4 * simplify_dot(along, along)) {
            try_place(q, best, plan);
            return;
        }
    }
    try_place(q, middle, plan);
    try_place(q, a, plan);
    try_place(q, b, plan);
}

simplify_plan hewn_simplify_plan(const simplify_work *work, uint32_t half)
{
    uint32_t a = work->tail[half], b = simplify_head(work, half);
    if (work->rank[a] > work->rank[b]) {
        uint32_t held = a;
        a = b;
        b = held;
    }
    simplify_plan plan = {.half = half, .gone = a, .kept = b, .cost = INFINITY};
    const uint8_t low = work->rank[a], high = work->rank[b];
    const bool feature = work->flags[half] & SIMPLIFY_FEATURE;
    if (low >= SIMPLIFY_CORNER || high == SIMPLIFY_APART || (low == SIMPLIFY_CREASE && !feature))
        return plan;
    simplify_quadric q;
    sum_ends(work, &plan, &q);
    const bool counted = work->wedges && work->wedges->counted > 0;
    const simplify_pairs pairs = counted ? hewn_simplify_pair(work, half, a) : (simplify_pairs){0};
    if (low < high) {
        try_place(&q, simplify_at(work, b), &plan);
        plan.cost += counted ? hewn_simplify_pairs_cost(work, &pairs, plan.at) : 0;
    } else if (counted) {
        simplify_quadric all = q;
        hewn_simplify_add_pairs(work, &pairs, &all);
        place(&all, simplify_at(work, a), simplify_at(work, b), &plan);
    } else {
        place(&q, simplify_at(work, a), simplify_at(work, b), &plan);
    }
    if (work->limit) {
        const double limit = (double)fminf(work->limit[a], work->limit[b]);
        plan.far = simplify_quadric_value(&q, plan.at) > limit * limit * q.weight;
    }
    return plan;
}

/* --- whether it may ----------------------------------------------------------------------------------------------- */

/* The neighbours of a vertex in order; on a boundary the last has no half-edge from it. */
typedef struct ring {
    uint32_t count, faces;
    uint32_t neighbours[MOST_RING];
} ring;

/* False where there are too many. */
static bool gather(const simplify_work *work, uint32_t v, ring *out)
{
    uint32_t first = work->half[v], h = first;
    out->count = 0;
    for (;;) {
        if (out->count + 2 > MOST_RING)
            return false;
        out->neighbours[out->count++] = simplify_head(work, h);
        uint32_t in = simplify_prev(h), next = work->twin[in];
        if (next == HEWN_NONE) {
            out->faces = out->count;
            out->neighbours[out->count++] = work->tail[in];
            return true;
        }
        h = next;
        if (h == first)
            break;
    }
    out->faces = out->count;
    return true;
}

static bool is_feature(const simplify_work *work, uint32_t h)
{
    return work->flags[simplify_name(work, h)] & SIMPLIFY_FEATURE;
}

/* One side of the edge: its triangle must not be all there is, and two features must not become one edge. */
static bool side_allowed(const simplify_work *work, uint32_t h)
{
    if (h == HEWN_NONE)
        return true;
    uint32_t next = simplify_next(h), prev = simplify_prev(h);
    return !(is_feature(work, next) && is_feature(work, prev));
}

/* The link condition (Dey, Edelsbrunner, Guha and Nekhayev 1999), of the surface and of the features on it. */
static bool links_allowed(const simplify_work *work, uint32_t half, const ring *a, const ring *b)
{
    const uint32_t twin = work->twin[half], beside = twin == HEWN_NONE ? 1 : 2;
    uint32_t common = 0;
    for (uint32_t i = 0; i < a->count; i++)
        for (uint32_t k = 0; k < b->count; k++)
            common += a->neighbours[i] == b->neighbours[k];
    if (common != beside || (a->count == 3 && b->count == 3 && a->faces == 3 && b->faces == 3))
        return false;
    bool a_open = a->faces < a->count, b_open = b->faces < b->count;
    if (a_open && b_open && twin != HEWN_NONE)
        return false;
    return side_allowed(work, half) && side_allowed(work, twin);
}

/* 1 for three equal sides; `normal` is twice the area. */
static double shape(const double a[3], const double b[3], const double c[3], double doubled_area)
{
    double u[3], v[3], w[3];
    simplify_between(a, b, u);
    simplify_between(b, c, v);
    simplify_between(c, a, w);
    double sides = simplify_dot(u, u) + simplify_dot(v, v) + simplify_dot(w, w);
    return sides > 0 ? 3.4641016151377544 * doubled_area / sides : 0;
}

/* Where a triangle's surface faced in the input, by what has joined its corners. */
static void facing_of(const simplify_work *work, uint32_t p, uint32_t q, double out[3])
{
    for (size_t axis = 0; axis < 3; axis++)
        out[axis] = (double)work->facing[3 * (size_t)p + axis] + (double)work->facing[3 * (size_t)q + axis];
}

/* Whether the triangle of a vertex and two neighbours stays sound when the vertex moves: it turns little and does not
 * turn away from where the input faced. `*slim` where it becomes a sliver. */
static bool turn_allowed(const double from[3], const double to[3], const double p[3], const double q[3],
                         const double facing[3], bool *slim)
{
    double before[3], after[3];
    simplify_area_vector(from, p, q, before);
    simplify_area_vector(to, p, q, after);
    double old_area = sqrt(simplify_dot(before, before)), new_area = sqrt(simplify_dot(after, after));
    if (simplify_dot(before, after) < least_cosine * old_area * new_area)
        return false;
    if (simplify_dot(after, facing) < 0 && simplify_dot(before, facing) >= 0)
        return false;
    double now = shape(to, p, q, new_area);
    if (now < no_shape && now < shape(from, p, q, old_area))
        return false;
    *slim |= now < least_shape && now < shape(from, p, q, old_area);
    return true;
}

/* The triangles around `v` but for those with `other`. */
static bool turns_allowed(const simplify_work *work, uint32_t v, uint32_t other, const ring *around,
                          simplify_plan *plan)
{
    const double *to = plan->at;
    const double *from = simplify_at(work, v);
    double own[3], facing[3];
    facing_of(work, v, other != HEWN_NONE ? other : v, own);
    for (uint32_t i = 0; i < around->faces; i++) {
        uint32_t p = around->neighbours[i], q = around->neighbours[i + 1 < around->count ? i + 1 : 0];
        if (p == other || q == other)
            continue;
        facing_of(work, p, q, facing);
        for (int axis = 0; axis < 3; axis++)
            facing[axis] += own[axis];
        if (!turn_allowed(from, to, simplify_at(work, p), simplify_at(work, q), facing, &plan->slim))
            return false;
    }
    return true;
}

/* --- complexes ---------------------------------------------------------------------------------------------------- */

enum { MOST_AROUND = 1024 };

/* What is around all fans of a vertex, each once; false where it is too much or cannot be walked. */
static bool gather_all(const simplify_work *work, uint32_t v, uint32_t *out, uint32_t *count)
{
    uint32_t at = v;
    *count = 0;
    do {
        ring around;
        if (work->rank[at] == SIMPLIFY_APART || !gather(work, at, &around))
            return false;
        for (uint32_t i = 0; i < around.count; i++) {
            const uint32_t group = simplify_group(work, around.neighbours[i]);
            uint32_t k = 0;
            while (k < *count && out[k] != group)
                k++;
            if (k == MOST_AROUND)
                return false;
            out[k] = group;
            *count += k == *count;
        }
        at = work->tie ? work->tie[at] : at;
    } while (at != v);
    return true;
}

/* The link condition of the whole complex: what is next to both ends is across a triangle of the edge. With
 * side_allowed() that holds of every shell too: an edge of a triangle beside it is in a shell without that triangle
 * only where fans meet, and not both are. A vertex amid three triangles stays if what they would become may be there.
 */
static bool complex_allowed(const simplify_work *work, const simplify_plan *plan, const ring *gone, uint32_t across)
{
    uint32_t one[MOST_AROUND], two[MOST_AROUND], ones, twos, common = 0;
    if (gone->count == 3 && gone->faces == 3 && simplify_is_tied(work, plan->kept))
        return false;
    if (!gather_all(work, plan->gone, one, &ones) || !gather_all(work, plan->kept, two, &twos))
        return false;
    for (uint32_t i = 0; i < ones; i++)
        for (uint32_t k = 0; k < twos; k++)
            common += one[i] == two[k];
    return common == across;
}

/* The fans of a tied edge. */
static bool sides_allowed(const simplify_work *work, simplify_plan *plan)
{
    simplify_side sides[SIMPLIFY_MOST_TIED];
    const uint32_t count = hewn_simplify_sides(work, plan, sides);
    ring gone, kept;
    plan->slim = false;
    for (uint32_t i = 0; i < count; i++)
        if (!gather(work, sides[i].gone, &gone) || !gather(work, sides[i].kept, &kept) ||
            !links_allowed(work, sides[i].half, &gone, &kept) ||
            !turns_allowed(work, sides[i].gone, sides[i].kept, &gone, plan) ||
            !turns_allowed(work, sides[i].kept, sides[i].gone, &kept, plan))
            return false;
    return count > 0 && complex_allowed(work, plan, &gone, count);
}

/* --- volume ------------------------------------------------------------------------------------------------------- */

/* Adds the triangles around `v`, but for those with `other`: area vectors, and their products with a corner. */
static void add_volume(const simplify_work *work, uint32_t v, uint32_t other, const ring *around, double sum[4])
{
    const double *at = simplify_at(work, v);
    for (uint32_t i = 0; i < around->faces; i++) {
        const uint32_t p = around->neighbours[i], q = around->neighbours[i + 1 < around->count ? i + 1 : 0];
        double n[3];
        if (p == other || q == other)
            continue;
        simplify_area_vector(at, simplify_at(work, p), simplify_at(work, q), n);
        for (int axis = 0; axis < 3; axis++)
            sum[axis] += n[axis];
        sum[3] += simplify_dot(n, at);
    }
}

/* Quadrics put vertices outside of what is round, so it grows. The place is moved to the nearest one, as the quadric
 * measures, that keeps the volume (Lindstrom and Turk 1998, 'Fast and memory efficient polygonal simplification'). */
static void keep_volume(const simplify_work *work, const ring *gone, const ring *kept, simplify_plan *plan)
{
    double sum[4] = {0}, step[3], moved[3];
    if (work->rank[plan->gone] != SIMPLIFY_SMOOTH || work->rank[plan->kept] != SIMPLIFY_SMOOTH)
        return;
    add_volume(work, plan->gone, HEWN_NONE, gone, sum);
    add_volume(work, plan->kept, plan->gone, kept, sum);
    simplify_quadric q = work->quadrics[plan->gone];
    simplify_quadric_add(&q, &work->quadrics[plan->kept]);
    const double off = sum[3] - simplify_dot(sum, plan->at);
    if (!simplify_quadric_solve(&q, sum, step))
        return;
    const double along = simplify_dot(sum, step);
    if (!(along > 0))
        return;
    double square = 0;
    for (int axis = 0; axis < 3; axis++) {
        moved[axis] = plan->at[axis] + step[axis] * off / along;
        square += (moved[axis] - plan->at[axis]) * (moved[axis] - plan->at[axis]);
    }
    double edge[3];
    simplify_between(simplify_at(work, plan->gone), simplify_at(work, plan->kept), edge);
    if (!(square <= 0.02 * simplify_dot(edge, edge)))
        return;
    for (int axis = 0; axis < 3; axis++)
        plan->at[axis] = moved[axis];
}

bool hewn_simplify_allowed(const simplify_work *work, simplify_plan *plan)
{
    ring gone, kept;
    if (simplify_is_tied(work, plan->gone))
        return sides_allowed(work, plan);
    if (!gather(work, plan->gone, &gone) || !gather(work, plan->kept, &kept) ||
        !links_allowed(work, plan->half, &gone, &kept) ||
        (work->groups && !complex_allowed(work, plan, &gone, work->twin[plan->half] == HEWN_NONE ? 1 : 2)))
        return false;
    keep_volume(work, &gone, &kept, plan);
    plan->slim = false;
    return turns_allowed(work, plan->gone, plan->kept, &gone, plan) &&
           turns_allowed(work, plan->kept, plan->gone, &kept, plan);
}

bool hewn_simplify_may_move(const simplify_work *work, uint32_t v, const double to[3])
{
    ring around;
    simplify_plan plan = {.gone = v, .kept = HEWN_NONE};
    for (int axis = 0; axis < 3; axis++)
        plan.at[axis] = to[axis];
    return gather(work, v, &around) && turns_allowed(work, v, HEWN_NONE, &around, &plan) && !plan.slim;
}

/* --- doing it ----------------------------------------------------------------------------------------------------- */

/* Takes the triangle of `h` away; the edges of its other two sides become one. `out` is then a half-edge that leaves
 * `kept`, unless there is none here. */
static void close_face(simplify_work *work, uint32_t h, uint32_t *out)
{
    const uint32_t next = simplify_next(h), prev = simplify_prev(h), tip = work->tail[prev];
    const uint32_t across_next = work->twin[next], across_prev = work->twin[prev];
    const uint32_t name_next = simplify_name(work, next), name_prev = simplify_name(work, prev);
    const uint8_t feature = (work->flags[name_next] | work->flags[name_prev]) & SIMPLIFY_FEATURE;
    const float one = work->key[name_next], two = work->key[name_prev];
    const bool bounds = !(work->flags[name_next] & SIMPLIFY_RAISED) && !(work->flags[name_prev] & SIMPLIFY_RAISED);
    const float key = isinf(one) ? two : isinf(two) ? one : bounds ? fmaxf(one, two) : fminf(one, two);
    if (across_next != HEWN_NONE)
        work->twin[across_next] = across_prev;
    if (across_prev != HEWN_NONE)
        work->twin[across_prev] = across_next;
    const uint32_t name = across_next < across_prev ? across_next : across_prev;
    work->key[name] = key;
    work->flags[name] = feature;
    if (work->half[tip] == prev && across_next != HEWN_NONE) /* always there where the tip is manifold */
        work->half[tip] = across_next;
    /* of the two, the one whose tail is at the joined vertex: twins of `prev` leave the head of `prev` */
    *out = across_prev != HEWN_NONE ? across_prev : across_next != HEWN_NONE ? simplify_next(across_next) : *out;
    work->tail[h - h % 3] = HEWN_NONE;
}

/* Walks clockwise to the end of a fan. */
static uint32_t fan_start(const simplify_work *work, uint32_t h)
{
    const uint32_t first = h;
    while (work->twin[h] != HEWN_NONE) {
        h = simplify_next(work->twin[h]);
        if (h == first)
            break;
    }
    return h;
}

/* Costs around a changed vertex are lower bounds from now on. */
static void stir(simplify_work *work, uint32_t v)
{
    uint32_t first = work->half[v], h = first;
    do {
        uint32_t in = simplify_prev(h);
        work->flags[simplify_name(work, h)] &= (uint8_t)~SIMPLIFY_FRESH;
        work->flags[simplify_name(work, in)] &= (uint8_t)~SIMPLIFY_FRESH;
        h = work->twin[in];
    } while (h != HEWN_NONE && h != first);
}

static void join_wedges(simplify_work *work, const simplify_plan *plan)
{
    const double *from = simplify_at(work, plan->kept), *to = simplify_at(work, plan->gone);
    double whole[3], part[3];
    simplify_between(from, to, whole);
    simplify_between(from, plan->at, part);
    const double length = simplify_dot(whole, whole);
    double share = length > 0 ? simplify_dot(part, whole) / length : 0;
    share = share < 0 ? 0 : share > 1 ? 1 : share;
    const simplify_pairs pairs = hewn_simplify_pair(work, plan->half, plan->gone);
    hewn_simplify_join_wedges(work, &pairs, plan->gone, plan->at, share,
                              work->rank[plan->gone] < work->rank[plan->kept]);
}

/* One fan. */
static uint32_t collapse(simplify_work *work, const simplify_side *side, const double place_at[3])
{
    const uint32_t gone = side->gone, kept = side->kept, half = side->half, twin = work->twin[half];
    uint32_t first = work->half[gone], h = first;
    do {
        uint32_t turned = simplify_turn(work, h);
        work->tail[h] = kept;
        h = turned;
    } while (h != HEWN_NONE && h != first);
    uint32_t out = HEWN_NONE;
    close_face(work, half, &out);
    if (twin != HEWN_NONE)
        close_face(work, twin, &out);
    work->half[kept] = fan_start(work, out);
    work->half[gone] = SIMPLIFY_GONE;
    work->rank[kept] = work->rank[gone] > work->rank[kept] ? work->rank[gone] : work->rank[kept];
    simplify_quadric_add(&work->quadrics[kept], &work->quadrics[gone]);
    for (size_t axis = 0; axis < 3; axis++)
        work->facing[3 * (size_t)kept + axis] += work->facing[3 * (size_t)gone + axis];
    for (size_t axis = 0; axis < 3; axis++)
        work->positions[3 * (size_t)kept + axis] = place_at[axis];
    work->into[work->origins[gone]] = work->origins[kept];
    if (work->limit)
        work->limit[kept] = fminf(work->limit[kept], work->limit[gone]);
    stir(work, kept);
    return twin == HEWN_NONE ? 1 : 2;
}

uint32_t hewn_simplify_collapse(simplify_work *work, const simplify_plan *plan)
{
    simplify_side sides[SIMPLIFY_MOST_TIED];
    const uint32_t count = hewn_simplify_sides(work, plan, sides);
    uint32_t removed = 0;
    if (work->wedges)
        join_wedges(work, plan);
    for (uint32_t i = 0; i < count; i++)
        removed += collapse(work, &sides[i], plan->at);
    return removed;
}
