#include "simplify/wedge.h"

#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "simplify/work.h"

static double *sums_of(const simplify_wedges *wedges, uint32_t wedge)
{
    return wedges->sums + wedge * simplify_wedge_stride(wedges);
}

static double *values_of(const simplify_wedges *wedges, uint32_t wedge)
{
    return wedges->values + (size_t)wedge * wedges->scalars;
}

simplify_pairs hewn_simplify_pair(const simplify_work *work, uint32_t half, uint32_t gone)
{
    simplify_pairs out = {0};
    const uint32_t sides[2] = {half, work->twin[half]};
    for (int i = 0; i < 2 && sides[i] != HEWN_NONE; i++) {
        const uint32_t at_tail = work->wedge[sides[i]], at_head = work->wedge[simplify_next(sides[i])];
        const bool tail_goes = work->tail[sides[i]] == gone;
        const uint32_t from = tail_goes ? at_tail : at_head, to = tail_goes ? at_head : at_tail;
        if (out.count == 1 && out.gone[0] == from && out.kept[0] == to)
            continue;
        out.gone[out.count] = from;
        out.kept[out.count++] = to;
    }
    return out;
}

/* --- sums --------------------------------------------------------------------------------------------------------- */

/* The slope of a scalar over a triangle, and its value at the origin of coordinates: (g, d) of g x + d. */
static void slope_of(const double *const at[3], const double values[3], double out[4])
{
    double u[3], v[3], n[3], un[3], nv[3];
    simplify_between(at[0], at[1], u);
    simplify_between(at[0], at[2], v);
    simplify_cross(u, v, n);
    simplify_cross(v, n, nv);
    simplify_cross(n, u, un);
    const double square = simplify_dot(n, n), first = values[1] - values[0], second = values[2] - values[0];
    out[3] = values[0];
    for (int axis = 0; axis < 3; axis++) {
        out[axis] = square > 0 ? (first * nv[axis] + second * un[axis]) / square : 0;
        out[3] -= out[axis] * at[0][axis];
    }
}

/* Adds one triangle to the wedge of one of its corners. */
static void add_face(const simplify_work *work, uint32_t face, double *sums)
{
    const simplify_wedges *wedges = work->wedges;
    const double *at[3];
    double normal[3];
    for (uint32_t k = 0; k < 3; k++)
        at[k] = simplify_at(work, work->tail[3 * face + k]);
    simplify_area_vector(at[0], at[1], at[2], normal);
    const double area = sqrt(simplify_dot(normal, normal)) / 2;
    simplify_quadric own;
    memcpy(&own, sums, sizeof own);
    own.weight += area;
    for (uint32_t s = 0; s < wedges->counted; s++) {
        double values[3], slope[4], *sum = sums + sizeof own / sizeof *sums + 4 * (size_t)s;
        for (uint32_t k = 0; k < 3; k++)
            values[k] = wedges->weights[s] * values_of(wedges, work->wedge[3 * face + k])[s];
        slope_of(at, values, slope);
        const double g[3] = {slope[0], slope[1], slope[2]}, d = slope[3];
        for (int axis = 0; axis < 3; axis++) {
            own.b[axis] += area * d * g[axis];
            sum[axis] += area * g[axis];
        }
        own.a[0] += area * g[0] * g[0];
        own.a[1] += area * g[0] * g[1];
        own.a[2] += area * g[0] * g[2];
        own.a[3] += area * g[1] * g[1];
        own.a[4] += area * g[1] * g[2];
        own.a[5] += area * g[2] * g[2];
        own.c += area * d * d;
        sum[3] += area * d;
    }
    memcpy(sums, &own, sizeof own);
}

/* All wedges at a vertex are only there, so vertices do not get into each other's way. */
hewn_result hewn_simplify_weigh_wedges(simplify_work *work, hewn_error *error)
{
    simplify_wedges *wedges = work->wedges;
    if (!wedges || wedges->counted == 0)
        return HEWN_OK;
    wedges->sums = hewn_alloc_zero(wedges->count, simplify_wedge_stride(wedges) * sizeof *wedges->sums);
    if (!wedges->sums)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the attributes of %u corners", wedges->count);
#pragma omp parallel for schedule(static) if (work->vertex_count > SIMPLIFY_FEW)
    for (uint32_t v = 0; v < work->vertex_count; v++) {
        const uint32_t first = work->half[v];
        uint32_t h = first;
        if (first == SIMPLIFY_GONE || work->rank[v] == SIMPLIFY_APART)
            continue;
        do {
            add_face(work, h / 3, sums_of(wedges, work->wedge[h]));
            h = simplify_turn(work, h);
        } while (h != HEWN_NONE && h != first);
    }
    return HEWN_OK;
}

/* --- costs -------------------------------------------------------------------------------------------------------- */

static void add_up(const simplify_wedges *wedges, uint32_t gone, uint32_t kept, simplify_wedge_sum *out)
{
    const double *one = sums_of(wedges, gone), *two = sums_of(wedges, kept);
    const size_t own = sizeof out->own / sizeof *one;
    memcpy(&out->own, one, sizeof out->own);
    simplify_quadric other;
    memcpy(&other, two, sizeof other);
    simplify_quadric_add(&out->own, &other);
    for (uint32_t s = 0; s < wedges->counted; s++)
        for (size_t i = 0; i < 4; i++)
            out->slope[s][i] = one[own + 4 * s + i] + two[own + 4 * s + i];
}

void hewn_simplify_add_pairs(const simplify_work *work, const simplify_pairs *pairs, simplify_quadric *q)
{
    simplify_wedge_sum sum;
    for (uint32_t p = 0; p < pairs->count; p++) {
        add_up(work->wedges, pairs->gone[p], pairs->kept[p], &sum);
        if (!(sum.own.weight > 0))
            continue;
        const double weight = q->weight, inverse = 1 / sum.own.weight;
        simplify_quadric_add(q, &sum.own);
        q->weight = weight;
        for (uint32_t s = 0; s < work->wedges->counted; s++) {
            const double *g = sum.slope[s], x = inverse * g[0], y = inverse * g[1], z = inverse * g[2];
            q->a[0] -= x * g[0];
            q->a[1] -= x * g[1];
            q->a[2] -= x * g[2];
            q->a[3] -= y * g[1];
            q->a[4] -= y * g[2];
            q->a[5] -= z * g[2];
            q->b[0] -= x * g[3];
            q->b[1] -= y * g[3];
            q->b[2] -= z * g[3];
            q->c -= inverse * g[3] * g[3];
        }
    }
}

double hewn_simplify_pairs_cost(const simplify_work *work, const simplify_pairs *pairs, const double at[3])
{
    const simplify_wedges *wedges = work->wedges;
    simplify_wedge_sum sum;
    double cost = 0;
    for (uint32_t p = 0; p < pairs->count; p++) {
        const double *values = values_of(wedges, pairs->kept[p]);
        add_up(wedges, pairs->gone[p], pairs->kept[p], &sum);
        double part = simplify_quadric_value(&sum.own, at);
        for (uint32_t s = 0; s < wedges->counted; s++) {
            const double value = wedges->weights[s] * values[s];
            part += value * (value * sum.own.weight - 2 * (simplify_dot(sum.slope[s], at) + sum.slope[s][3]));
        }
        cost += part > 0 ? part : 0;
    }
    return cost;
}

/* --- joining ------------------------------------------------------------------------------------------------------ */

/* The best scalar for the place, between those of the two ends; what does not count is blended. */
static void blend(const simplify_wedges *wedges, const simplify_wedge_sum *sum, uint32_t from, uint32_t into,
                  const double at[3], double share)
{
    const double *gone = values_of(wedges, from);
    double *kept = values_of(wedges, into);
    for (uint32_t s = 0; s < wedges->scalars; s++) {
        double value = kept[s] + share * (gone[s] - kept[s]);
        if (wedges->fixed && wedges->fixed[s])
            value = share > 0.5 ? gone[s] : kept[s];
        if (s < wedges->counted && sum->own.weight > 0 && wedges->weights[s] > 0) {
            const double least = fmin(kept[s], gone[s]), most = fmax(kept[s], gone[s]);
            value = (simplify_dot(sum->slope[s], at) + sum->slope[s][3]) / (sum->own.weight * wedges->weights[s]);
            value = fmin(fmax(value, least), most);
        }
        kept[s] = value;
    }
}

void hewn_simplify_join_wedges(simplify_work *work, const simplify_pairs *pairs, uint32_t gone, const double at[3],
                               double share, bool fixed)
{
    simplify_wedges *wedges = work->wedges;
    for (uint32_t p = 0; p < pairs->count; p++) {
        simplify_wedge_sum sum = {0};
        const uint32_t from = pairs->gone[p], into = pairs->kept[p];
        const bool again = p == 1 && into == pairs->kept[0];
        if (wedges->counted > 0)
            add_up(wedges, from, into, &sum);
        if (!fixed && !again)
            blend(wedges, &sum, from, into, at, share);
        if (wedges->counted > 0) {
            double *sums = sums_of(wedges, into);
            memcpy(sums, &sum.own, sizeof sum.own);
            memcpy(sums + sizeof sum.own / sizeof *sums, sum.slope, 4 * (size_t)wedges->counted * sizeof *sums);
        }
    }
    const uint32_t first = work->half[gone];
    uint32_t h = first;
    do {
        const bool second = pairs->count == 2 && work->wedge[h] == pairs->gone[1];
        work->wedge[h] = pairs->kept[second ? 1 : 0];
        h = simplify_turn(work, h);
    } while (h != HEWN_NONE && h != first);
}
