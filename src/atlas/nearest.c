#include "atlas/nearest.h"

#include <math.h>
#include <string.h>

void hewn_edge_prepare(hewn_edge *edge)
{
    unsigned degree = edge->curve.degree;
    for (int axis = 0; axis < 2; axis++) {
        edge->lo[axis] = INFINITY;
        edge->hi[axis] = -INFINITY;
    }
    hewn_bezier_bound(&edge->curve, edge->lo, edge->hi);
    hewn_bezier_powers(&edge->curve, edge->powers);
    hewn_bezier_direction(&edge->curve, 0, edge->ends[0]);
    hewn_bezier_direction(&edge->curve, 1, edge->ends[1]);
    memset(edge->slope, 0, sizeof edge->slope);
    memset(edge->itself, 0, sizeof edge->itself);
    for (int axis = 0; axis < 2; axis++) {
        for (unsigned k = 0; k < degree; k++)
            edge->slope[k][axis] = (k + 1) * edge->powers[k + 1][axis];
        for (unsigned k = 0; k <= degree; k++)
            for (unsigned i = 0; i < degree; i++)
                edge->itself[k + i] += edge->powers[k][axis] * edge->slope[i][axis];
    }
    const double rise[6] = {edge->slope[0][1], edge->slope[1][1], edge->slope[2][1]};
    edge->turns = degree > 1 ? hewn_sign_changes(rise, degree - 1, edge->turn + 1) : 0;
    edge->turn[0] = 0;
    edge->turn[edge->turns + 1] = 1;
    for (unsigned i = 0; i <= edge->turns + 1; i++) {
        double at[2];
        hewn_bezier_point(&edge->curve, edge->turn[i], at);
        edge->height[i] = at[1];
    }
    edge->height[0] = edge->curve.p[0][1]; /* to the bit what the neighbours have */
    edge->height[edge->turns + 1] = edge->curve.p[degree][1];
}

/* --- one edge ------------------------------------------------------------------------------------------------------
 */

static void consider(hewn_near *best, const hewn_near *other)
{
    if (other->distance < best->distance || (other->distance == best->distance && other->skew <= best->skew))
        *best = *other;
}

static void try_end(const hewn_edge *edge, int last, const double p[2], hewn_near *best)
{
    const double *end = edge->curve.p[last ? edge->curve.degree : 0], *along = edge->ends[last];
    double dx = p[0] - end[0], dy = p[1] - end[1], distance = hypot(dx, dy);
    double skew = distance > 0 ? fabs(dx * along[0] + dy * along[1]) / distance : 0;
    consider(best, &(hewn_near){distance, skew, last, edge});
}

static hewn_near nearest_on(const hewn_edge *edge, const double p[2])
{
    unsigned degree = edge->curve.degree, most = 2 * degree - 1, count;
    double c[6], places[5];
    hewn_near best = {.distance = INFINITY};
    memcpy(c, edge->itself, sizeof c);
    for (unsigned k = 0; k < degree; k++)
        c[k] -= p[0] * edge->slope[k][0] + p[1] * edge->slope[k][1];
    if (degree == 1) {
        places[0] = -c[0] / c[1];
        count = places[0] > 0 && places[0] < 1;
    } else {
        count = hewn_sign_changes(c, most, places);
    }
    try_end(edge, 0, p, &best);
    try_end(edge, 1, p, &best);
    for (unsigned i = 0; i < count; i++) {
        double t = places[i], at[2];
        for (int axis = 0; axis < 2; axis++)
            at[axis] = edge->powers[0][axis] +
                       t * (edge->powers[1][axis] + t * (edge->powers[2][axis] + t * edge->powers[3][axis]));
        double distance = hypot(p[0] - at[0], p[1] - at[1]);
        if (distance < best.distance)
            best = (hewn_near){distance, 0, t, edge};
    }
    return best;
}

/* --- all edges -----------------------------------------------------------------------------------------------------
 */

static double distance_to_box(const hewn_edge *edge, const double p[2])
{
    double dx = fmax(fmax(edge->lo[0] - p[0], p[0] - edge->hi[0]), 0);
    double dy = fmax(fmax(edge->lo[1] - p[1], p[1] - edge->hi[1]), 0);
    return dx * dx + dy * dy;
}

void hewn_shape_nearest(const hewn_shape *shape, const double p[2], hewn_near near[4])
{
    for (size_t i = 0; i < shape->count; i++) {
        const hewn_edge *edge = &shape->edges[i];
        double most = near[3].distance;
        for (int k = 0; k < 3; k++)
            if (edge->colour & (1U << k))
                most = fmax(most, near[k].distance);
        if (distance_to_box(edge, p) * (1 - 1e-12) > most * most)
            continue;
        hewn_near own = nearest_on(edge, p);
        for (int k = 0; k < 3; k++)
            if (edge->colour & (1U << k))
                consider(&near[k], &own);
        consider(&near[3], &own);
    }
}

static void direction_at(const hewn_near *near, double out[2])
{
    if (near->t == 0 || near->t == 1)
        memcpy(out, near->edge->ends[near->t == 1], 2 * sizeof *out);
    else
        hewn_bezier_direction(&near->edge->curve, near->t, out);
}

static double side_of(const hewn_near *near, const double p[2])
{
    double along[2], at[2];
    direction_at(near, along);
    hewn_bezier_point(&near->edge->curve, near->t, at);
    return along[0] * (p[1] - at[1]) - along[1] * (p[0] - at[0]);
}

double hewn_near_straight(const hewn_near *near, const double p[2])
{
    double along[2], side = side_of(near, p);
    if (near->t == 0 || near->t == 1) {
        const double *end = near->edge->curve.p[near->t == 1 ? near->edge->curve.degree : 0];
        direction_at(near, along);
        double ahead = along[0] * (p[0] - end[0]) + along[1] * (p[1] - end[1]);
        if (near->t == 1 ? ahead > 0 : ahead < 0)
            return side;
    }
    return side >= 0 ? near->distance : -near->distance;
}

/* How often an edge winds around a point: its crossings of the level ray to the left. */
static int winding(const hewn_edge *edge, const double p[2])
{
    int sum = 0;
    if (p[0] < edge->lo[0] || p[1] < edge->lo[1] || p[1] > edge->hi[1])
        return 0;
    for (unsigned i = 0; i <= edge->turns; i++) {
        bool before = edge->height[i] > p[1], rises = edge->height[i + 1] > p[1];
        if (before == rises)
            continue;
        double x = edge->lo[0];
        if (p[0] < edge->hi[0]) {
            const double c[4] = {edge->powers[0][1] - p[1], edge->powers[1][1], edge->powers[2][1], edge->powers[3][1]};
            double t = hewn_root_between(c, edge->curve.degree, edge->turn[i], edge->turn[i + 1], rises), at[2];
            hewn_bezier_point(&edge->curve, t, at);
            x = at[0];
        }
        sum += x < p[0] ? (rises ? 1 : -1) : 0;
    }
    return sum;
}

bool hewn_shape_holds(const hewn_shape *shape, const double p[2])
{
    int sum = 0;
    for (size_t i = 0; i < shape->count; i++)
        sum += winding(&shape->edges[i], p);
    return sum != 0;
}

double hewn_shape_distance(const hewn_shape *shape, const double p[2], double most)
{
    hewn_near near = {.distance = most, .skew = INFINITY};
    for (size_t i = 0; i < shape->count; i++)
        if (distance_to_box(&shape->edges[i], p) * (1 - 1e-12) <= near.distance * near.distance) {
            hewn_near own = nearest_on(&shape->edges[i], p);
            consider(&near, &own);
        }
    return hewn_shape_holds(shape, p) ? near.distance : -near.distance;
}
