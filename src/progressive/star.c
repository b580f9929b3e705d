/* What is around a vertex, and whether it may be folded into a neighbour. */
#include <math.h>
#include <string.h>

#include "geom/near_triangle.h"
#include "progressive/fold.h"

/* A triangle may turn by 78 degrees. */
static const double LEAST_COSINE = 0.2;
/* The least shape that a triangle may get, where it had a better one; equal sides have 1. */
static const double LEAST_SHAPE = 0.02;

static inline void area_vector(const double a[3], const double b[3], const double c[3], double out[3])
{
    const double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    out[0] = u[1] * v[2] - u[2] * v[1];
    out[1] = u[2] * v[0] - u[0] * v[2];
    out[2] = u[0] * v[1] - u[1] * v[0];
}

static inline double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline double distance_squared(const double a[3], const double b[3])
{
    const double d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    return dot(d, d);
}

static inline uint32_t vertex_of(const fold *of, uint32_t wedge)
{
    return of->wedge_vertices[wedge];
}

/* --- stars -------------------------------------------------------------------------------------------------------- */

static bool gather(const fold *of, uint32_t vertex, fold_star *out)
{
    const uint32_t *list = of->pool + of->list_first[vertex];
    out->count = 0;
    for (uint32_t i = 0; i < of->list_count[vertex]; i++) {
        if (of->removed[list[i]])
            continue;
        if (out->count == FOLD_MOST)
            return false;
        const uint32_t *corner = of->triangles + 3 * (size_t)list[i];
        const uint32_t k = vertex_of(of, corner[0]) == vertex ? 0 : vertex_of(of, corner[1]) == vertex ? 1 : 2;
        out->triangle[out->count] = list[i];
        out->own[out->count] = corner[k];
        out->next[out->count] = corner[(k + 1) % 3];
        out->previous[out->count++] = corner[(k + 2) % 3];
    }
    return out->count > 0;
}

static void swap(fold_star *star, uint32_t a, uint32_t b)
{
    uint32_t *const arrays[] = {star->triangle, star->own, star->next, star->previous};
    for (int i = 0; i < 4; i++) {
        const uint32_t other = arrays[i][a];
        arrays[i][a] = arrays[i][b];
        arrays[i][b] = other;
    }
}

/* The place from `from` on whose triangle begins at this vertex; the count where there is none. */
static uint32_t find_next(const fold *of, const fold_star *star, uint32_t from, uint32_t vertex)
{
    while (from < star->count && vertex_of(of, star->next[from]) != vertex)
        from++;
    return from;
}

/* The triangle that none comes before, or the first one in a ring. */
static uint32_t find_start(const fold *of, const fold_star *star)
{
    for (uint32_t i = 0; i < star->count; i++) {
        const uint32_t vertex = vertex_of(of, star->next[i]);
        bool preceded = false;
        for (uint32_t k = 0; k < star->count; k++)
            preceded |= vertex_of(of, star->previous[k]) == vertex;
        if (!preceded)
            return i;
    }
    return 0;
}

/* Whether neighbours are different ones, as in a fan that closes at most once. */
static bool has_distinct_neighbours(const fold *of, const fold_star *star)
{
    for (uint32_t i = 0; i < star->count; i++)
        for (uint32_t k = i + 1; k < star->count; k++)
            if (vertex_of(of, star->next[i]) == vertex_of(of, star->next[k]) ||
                vertex_of(of, star->previous[i]) == vertex_of(of, star->previous[k]))
                return false;
    return true;
}

bool hewn_fold_star_find(const fold *of, uint32_t vertex, fold_star *out)
{
    if (!gather(of, vertex, out))
        return false;
    for (uint32_t i = 0; i < out->count; i++) {
        const uint32_t next = vertex_of(of, out->next[i]), previous = vertex_of(of, out->previous[i]);
        if (next == vertex || previous == vertex || next == previous)
            return false;
    }
    if (!has_distinct_neighbours(of, out))
        return false;
    swap(out, 0, find_start(of, out));
    for (uint32_t i = 1; i < out->count; i++) {
        const uint32_t next = find_next(of, out, i, vertex_of(of, out->previous[i - 1]));
        if (next == out->count)
            return false;
        swap(out, i, next);
    }
    out->open = vertex_of(of, out->previous[out->count - 1]) != vertex_of(of, out->next[0]);
    return true;
}

uint32_t hewn_fold_neighbour(const fold *of, const fold_star *star, uint32_t i)
{
    return vertex_of(of, i < star->count ? star->next[i] : star->previous[star->count - 1]);
}

/* The triangles before and after neighbour i; HEWN_NONE where the fan ends. */
static uint32_t before(const fold_star *star, uint32_t i)
{
    return i > 0 ? i - 1 : star->open ? HEWN_NONE : star->count - 1;
}

static uint32_t after(const fold_star *star, uint32_t i)
{
    return i < star->count ? i : HEWN_NONE;
}

bool hewn_fold_feature(const fold *of, const fold_star *star, uint32_t i)
{
    const uint32_t a = before(star, i), b = after(star, i);
    if (a == HEWN_NONE || b == HEWN_NONE)
        return true;
    return star->own[a] != star->own[b] || star->previous[a] != star->next[b] ||
           (of->labels && of->labels[star->triangle[a]] != of->labels[star->triangle[b]]);
}

/* --- what is allowed ---------------------------------------------------------------------------------------------- */

/* The wedge of neighbour i that takes the place of one of the vertex' own; HEWN_NONE: it is not told, or in two ways.
 */
static uint32_t wedge_for(const fold_star *star, uint32_t i, uint32_t own)
{
    const uint32_t a = before(star, i), b = after(star, i);
    const uint32_t from_a = a != HEWN_NONE && star->own[a] == own ? star->previous[a] : HEWN_NONE;
    const uint32_t from_b = b != HEWN_NONE && star->own[b] == own ? star->next[b] : HEWN_NONE;
    if (from_a != HEWN_NONE && from_b != HEWN_NONE && from_a != from_b)
        return HEWN_NONE;
    return from_a != HEWN_NONE ? from_a : from_b;
}

static bool has_wedges(const fold_star *star, uint32_t i)
{
    for (uint32_t t = 0; t < star->count; t++)
        if (wedge_for(star, i, star->own[t]) == HEWN_NONE)
            return false;
    return true;
}

/* How many vertices are neighbours of `vertex` and in the set of the stamp; each is counted once, and leaves the set.
 * `*third` becomes whether a triangle of it has both of `a` and `b`, and is not around the star's own vertex. */
static uint32_t count_common(fold *of, uint32_t vertex, uint32_t center, uint32_t a, uint32_t b, bool *third)
{
    const uint32_t *list = of->pool + of->list_first[vertex];
    uint32_t common = 0;
    *third = false;
    for (uint32_t i = 0; i < of->list_count[vertex]; i++) {
        if (of->removed[list[i]])
            continue;
        bool has_a = false, has_b = false, has_center = false;
        for (uint32_t k = 0; k < 3; k++) {
            const uint32_t v = vertex_of(of, of->triangles[3 * (size_t)list[i] + k]);
            has_a |= v == a;
            has_b |= v == b;
            has_center |= v == center;
            if (v != vertex && of->stamps[v] == of->stamp) {
                of->stamps[v] = of->stamp - 1;
                common++;
            }
        }
        *third |= has_a && has_b && !has_center;
    }
    return common;
}

/* Whether neighbour i would get an edge to another vertex of the border, which may be there out of sight too. */
static bool joins_borders(const fold *of, const fold_star *star, uint32_t i)
{
    const uint32_t around = star->count + (star->open ? 1 : 0), last = around - 1;
    const uint32_t a = i > 0 ? i - 1 : star->open ? i : last, b = i < last ? i + 1 : star->open ? i : 0;
    for (uint32_t k = 0; k < around; k++)
        if (k != i && k != a && k != b && of->states[hewn_fold_neighbour(of, star, k)] == FOLD_BORDER)
            return true;
    return false;
}

/* The link condition (Dey, Edelsbrunner, Guha and Nekhayev 1999): the two vertices have no neighbours in common but
 * those of the triangles that go. */
static bool keeps_topology(fold *of, uint32_t vertex, const fold_star *star, uint32_t i)
{
    const uint32_t v = hewn_fold_neighbour(of, star, i), around = star->count + (star->open ? 1 : 0);
    if (of->states[v] != FOLD_FREE && of->states[v] != FOLD_BORDER)
        return false;
    if (of->states[v] == FOLD_BORDER && joins_borders(of, star, i))
        return false;
    if (of->stamp > UINT32_MAX - 4) {
        memset(of->stamps, 0, of->vertex_count * sizeof *of->stamps);
        of->stamp = 0;
    }
    of->stamp += 2;
    for (uint32_t k = 0; k < around; k++)
        of->stamps[hewn_fold_neighbour(of, star, k)] = of->stamp;
    of->stamps[v] = 0;
    const bool edge = star->open && (i == 0 || i == star->count);
    const uint32_t last = around - 1;
    const uint32_t a = hewn_fold_neighbour(of, star, i > 0 ? i - 1 : star->open ? 1 : last);
    const uint32_t b = hewn_fold_neighbour(of, star, i < last ? i + 1 : star->open ? last - 1 : 0);
    bool third;
    if (count_common(of, v, vertex, a, b, &third) != (edge ? 1u : 2u))
        return false;
    if (star->open && star->count == 1) /* its only triangle goes: another must hold the far edge */
        return third;
    return !(star->count == 3 && !star->open && third);
}

/* Whether the edge from a triangle's corner `from` to `to` is a feature: another triangle does not go on there. */
static bool breaks_across(const fold *of, uint32_t triangle, uint32_t from, uint32_t to)
{
    const uint32_t v = vertex_of(of, from), w = vertex_of(of, to);
    const uint32_t *list = of->pool + of->list_first[v];
    for (uint32_t i = 0; i < of->list_count[v]; i++) {
        const uint32_t *corner = of->triangles + 3 * (size_t)list[i];
        uint32_t at_v = HEWN_NONE, at_w = HEWN_NONE;
        if (of->removed[list[i]] || list[i] == triangle)
            continue;
        for (int k = 0; k < 3; k++) {
            at_v = vertex_of(of, corner[k]) == v ? corner[k] : at_v;
            at_w = vertex_of(of, corner[k]) == w ? corner[k] : at_w;
        }
        if (at_v != HEWN_NONE && at_w != HEWN_NONE)
            return at_v != from || at_w != to || (of->labels && of->labels[list[i]] != of->labels[triangle]);
    }
    return true;
}

/* The link condition of lines: the triangles that go must not lay one line upon another. */
static bool keeps_lines(const fold *of, const fold_star *star, uint32_t i)
{
    const uint32_t a = before(star, i), b = after(star, i);
    if (a != HEWN_NONE && hewn_fold_feature(of, star, a) &&
        breaks_across(of, star->triangle[a], star->previous[a], star->next[a]))
        return false;
    return b == HEWN_NONE || !hewn_fold_feature(of, star, b + 1 == star->count && !star->open ? 0 : b + 1) ||
           !breaks_across(of, star->triangle[b], star->next[b], star->previous[b]);
}

static bool keeps_shape(const fold *of, uint32_t vertex, const fold_star *star, uint32_t i)
{
    const uint32_t v = hewn_fold_neighbour(of, star, i);
    const double *from = fold_at(of, vertex), *to = fold_at(of, v);
    for (uint32_t t = 0; t < star->count; t++) {
        const uint32_t n = vertex_of(of, star->next[t]), p = vertex_of(of, star->previous[t]);
        if (n == v || p == v)
            continue;
        const double *b = fold_at(of, n), *c = fold_at(of, p);
        double old[3], new[3];
        area_vector(from, b, c, old);
        area_vector(to, b, c, new);
        const double old_area = dot(old, old), new_area = dot(new, new), side = distance_squared(b, c);
        if (!(new_area > 0) && old_area > 0)
            return false;
        if (old_area > 0 && !(dot(old, new) > LEAST_COSINE * sqrt(old_area * new_area)))
            return false;
        const double old_sum = distance_squared(from, b) + distance_squared(from, c) + side;
        const double new_sum = distance_squared(to, b) + distance_squared(to, c) + side;
        const double unit = 2 * sqrt(3.0);
        const double new_shape = unit * sqrt(new_area) / new_sum, old_shape = unit * sqrt(old_area) / old_sum;
        if (new_shape < LEAST_SHAPE && new_shape < old_shape)
            return false;
    }
    return true;
}

/* --- costs -------------------------------------------------------------------------------------------------------- */

static void add_plane(fold_quadric *to, const double n[3], const double at[3], double weight)
{
    const double away = -dot(n, at);
    static const int row[] = {0, 0, 0, 1, 1, 2}, column[] = {0, 1, 2, 1, 2, 2};
    for (int i = 0; i < 6; i++)
        to->a[i] += weight * n[row[i]] * n[column[i]];
    for (int i = 0; i < 3; i++)
        to->b[i] += weight * n[i] * away;
    to->c += weight * away * away;
}

static void add_point(fold_quadric *to, const double at[3], double weight)
{
    to->a[0] += weight;
    to->a[3] += weight;
    to->a[5] += weight;
    for (int i = 0; i < 3; i++)
        to->b[i] -= weight * at[i];
    to->c += weight * dot(at, at);
}

static double value(const fold_quadric *of, const double x[3])
{
    const double *a = of->a;
    const double sum = a[0] * x[0] * x[0] + a[3] * x[1] * x[1] + a[5] * x[2] * x[2] +
                       2 * (a[1] * x[0] * x[1] + a[2] * x[0] * x[2] + a[4] * x[1] * x[2]) + 2 * dot(of->b, x) + of->c;
    return fmax(sum, 0);
}

/* Features are held in place by planes across them, ten times as heavy as surface. */
static void weigh_features(fold *of, uint32_t vertex, const fold_star *star)
{
    const uint32_t around = star->count + (star->open ? 1 : 0);
    const double *at = fold_at(of, vertex);
    for (uint32_t i = 0; i < around; i++) {
        if (!hewn_fold_feature(of, star, i))
            continue;
        const uint32_t t = after(star, i) != HEWN_NONE ? after(star, i) : before(star, i);
        const double *to = fold_at(of, hewn_fold_neighbour(of, star, i));
        double n[3], across[3];
        area_vector(at, fold_at(of, vertex_of(of, star->next[t])), fold_at(of, vertex_of(of, star->previous[t])), n);
        const double along[3] = {to[0] - at[0], to[1] - at[1], to[2] - at[2]};
        across[0] = n[1] * along[2] - n[2] * along[1];
        across[1] = n[2] * along[0] - n[0] * along[2];
        across[2] = n[0] * along[1] - n[1] * along[0];
        const double length = sqrt(dot(across, across));
        for (int axis = 0; length > 0 && axis < 3; axis++)
            across[axis] /= length;
        if (length > 0)
            add_plane(&of->quadrics[vertex], across, at, 10 * dot(along, along));
    }
}

void hewn_fold_weigh(fold *of)
{
    fold_star star;
    for (uint32_t t = 0; t < of->triangle_count; t++) {
        uint32_t v[3];
        double n[3];
        for (int k = 0; k < 3; k++)
            v[k] = vertex_of(of, of->triangles[3 * (size_t)t + (size_t)k]);
        area_vector(fold_at(of, v[0]), fold_at(of, v[1]), fold_at(of, v[2]), n);
        const double area = sqrt(dot(n, n));
        for (int axis = 0; area > 0 && axis < 3; axis++)
            n[axis] /= area;
        for (int k = 0; area > 0 && k < 3; k++) {
            add_plane(&of->quadrics[v[k]], n, fold_at(of, v[k]), area);
            add_point(&of->quadrics[v[k]], fold_at(of, v[k]), 1e-7 * area);
        }
    }
    for (uint32_t v = 0; v < of->vertex_count; v++) {
        if (hewn_fold_star_find(of, v, &star))
            weigh_features(of, v, &star);
        else
            of->states[v] = FOLD_STAYS;
    }
}

static double cost_of(const fold *of, uint32_t vertex, uint32_t into)
{
    const double *at = fold_at(of, into);
    return value(&of->quadrics[vertex], at) + value(&of->quadrics[into], at);
}

uint32_t hewn_fold_choose(fold *of, uint32_t vertex, fold_star *star, double *cost)
{
    if (of->states[vertex] != FOLD_FREE || !hewn_fold_star_find(of, vertex, star))
        return HEWN_NONE;
    const uint32_t around = star->count + (star->open ? 1 : 0);
    uint32_t features = 0, best = HEWN_NONE;
    for (uint32_t i = 0; i < around; i++)
        features += hewn_fold_feature(of, star, i);
    if (features != 0 && features != 2)
        return HEWN_NONE;
    for (uint32_t i = 0; i < around; i++) {
        if (features == 2 && !hewn_fold_feature(of, star, i))
            continue;
        const double at = cost_of(of, vertex, hewn_fold_neighbour(of, star, i));
        if (best != HEWN_NONE && !(at < *cost))
            continue;
        if (!has_wedges(star, i) || (features > 0 && !keeps_lines(of, star, i)) || !keeps_shape(of, vertex, star, i) ||
            !keeps_topology(of, vertex, star, i))
            continue;
        best = i;
        *cost = at;
    }
    return best;
}

/* --- doing it ----------------------------------------------------------------------------------------------------- */

double hewn_fold_distance(const fold *of, uint32_t vertex, const fold_star *star, uint32_t i)
{
    const uint32_t v = hewn_fold_neighbour(of, star, i), around = star->count + (star->open ? 1 : 0);
    const double *from = fold_at(of, vertex), *to = fold_at(of, v);
    double most = INFINITY;
    for (uint32_t t = 0; t < star->count; t++) {
        const uint32_t n = vertex_of(of, star->next[t]), p = vertex_of(of, star->previous[t]);
        if (n != v && p != v)
            most = fmin(most, hewn_triangle_distance_squared(from, to, fold_at(of, n), fold_at(of, p)));
    }
    if (most == INFINITY) /* nothing is left here but what lies beside it */
        most = distance_squared(from, to);
    for (uint32_t k = 0; k < around; k++) {
        const double *end = fold_at(of, hewn_fold_neighbour(of, star, k));
        const double middle[3] = {(to[0] + end[0]) / 2, (to[1] + end[1]) / 2, (to[2] + end[2]) / 2};
        double least = INFINITY;
        for (uint32_t t = 0; t < star->count; t++)
            least = fmin(least, hewn_triangle_distance_squared(middle, from, fold_at(of, vertex_of(of, star->next[t])),
                                                               fold_at(of, vertex_of(of, star->previous[t]))));
        most = fmax(most, least);
    }
    return sqrt(most);
}
