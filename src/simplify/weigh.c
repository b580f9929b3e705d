#include "base/alloc.h"
#include "base/error.h"
#include "simplify/collapse.h"

/* How much more a feature edge counts than a surface of its length squared, and how little the distance to a vertex
 * itself does: just enough that there mostly is a best place, in planes and along lines too. With attributes it is
 * more, so that these are not stretched where the surface is flat. */
static const double feature_weight = 10, stay_weight = 1e-12, stay_with_attributes = 1e-7;

static double unit(double v[3])
{
    double length = sqrt(simplify_dot(v, v));
    for (int axis = 0; axis < 3; axis++)
        v[axis] = length > 0 ? v[axis] / length : 0;
    return length;
}

/* The plane through a feature edge across a face beside it, at both ends. */
static void add_feature(simplify_quadric *q, const double from[3], const double to[3], const double normal[3])
{
    double along[3], across[3];
    simplify_between(from, to, along);
    double length = unit(along);
    simplify_cross(along, normal, across);
    simplify_quadric_add_plane(q, across, from, feature_weight * length * length);
}

static void weigh_vertex(simplify_work *work, uint32_t v)
{
    simplify_quadric q = {0};
    double facing[3] = {0};
    const bool counted = work->wedges && work->wedges->counted > 0;
    uint32_t first = work->half[v], h = first;
    if (first == SIMPLIFY_GONE || work->rank[v] == SIMPLIFY_APART)
        return;
    const double *at = simplify_at(work, v);
    do {
        uint32_t in = simplify_prev(h);
        const double *b = simplify_at(work, simplify_head(work, h)), *c = simplify_at(work, work->tail[in]);
        double normal[3];
        simplify_area_vector(at, b, c, normal);
        for (int axis = 0; axis < 3; axis++)
            facing[axis] += normal[axis];
        const double weight = unit(normal) / 2;
        simplify_quadric_add_plane(&q, normal, at, weight);
        simplify_quadric_add_point(&q, at, weight * (counted ? stay_with_attributes : stay_weight));
        q.weight += weight;
        if (work->flags[simplify_name(work, h)] & SIMPLIFY_FEATURE)
            add_feature(&q, at, b, normal);
        if (work->flags[simplify_name(work, in)] & SIMPLIFY_FEATURE)
            add_feature(&q, c, at, normal);
        h = work->twin[in];
    } while (h != HEWN_NONE && h != first);
    work->quadrics[v] = q;
    for (size_t axis = 0; axis < 3; axis++)
        work->facing[3 * (size_t)v + axis] = (float)facing[axis];
}

/* Keys of all edges, as quadrics are now. */
static void find_keys(simplify_work *work)
{
#pragma omp parallel for schedule(static) if (work->vertex_count > SIMPLIFY_FEW)
    for (uint32_t h = 0; h < 3 * work->face_count; h++)
        if (simplify_name(work, h) == h) {
            work->key[h] = (float)hewn_simplify_plan(work, h).cost;
            work->flags[h] = (uint8_t)((work->flags[h] & ~SIMPLIFY_RAISED) | SIMPLIFY_FRESH);
        }
}

hewn_result hewn_simplify_weigh(simplify_work *work, hewn_error *error)
{
    HEWN_TRY(hewn_simplify_weigh_wedges(work, error));
#pragma omp parallel for schedule(static) if (work->vertex_count > SIMPLIFY_FEW)
    for (uint32_t v = 0; v < work->vertex_count; v++)
        weigh_vertex(work, v);
    find_keys(work);
    return HEWN_OK;
}
