#include <math.h>
#include <stdlib.h>

#include "mesh/soup.h"

/* Angles run from 0 to 4 (quarter turns, by ratios instead of arcs, so that they are the same on every machine). Closer
 * than this they count as equal. */
static const double same_angle = 1e-9;

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* To a length near 1 without overflow; what has no direction becomes 0. */
static void normalise(double v[3])
{
    double most = fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
    if (!(most > 0) || !isfinite(most)) {
        v[0] = v[1] = v[2] = 0;
        return;
    }
    double scaled[3] = {v[0] / most, v[1] / most, v[2] / most}, length = sqrt(dot(scaled, scaled));
    for (int axis = 0; axis < 3; axis++)
        v[axis] = scaled[axis] / length;
}

/* The direction from an edge into the face of one of its half-edges, at right angles to the edge (0 if there is none).
 */
static void inward(const hewn_soup *soup, const hewn_sides *sides, uint32_t side, const double along[3], bool forward,
                   double out[3])
{
    double normal[3];
    hewn_soup_face_normal(soup, sides->faces[side], normal);
    normalise(normal);
    cross(normal, along, out);
    for (int axis = 0; axis < 3 && !forward; axis++)
        out[axis] = -out[axis];
    normalise(out);
}

static double diamond_angle(double x, double y)
{
    double sum = fabs(x) + fabs(y);
    if (!(sum > 0))
        return 0;
    double angle = y >= 0 ? 1 - x / sum : 3 + x / sum;
    return angle > 4 - same_angle ? 0 : angle;
}

static int compare_angles(const void *a, const void *b)
{
    const hewn_pair_item *x = a, *y = b;
    if (x->angle != y->angle)
        return x->angle < y->angle ? -1 : 1;
    return (x->side > y->side) - (x->side < y->side);
}

/* Where faces lie on each other, those that close a wedge come before those that open the next one. */
static int compare_ways(const void *a, const void *b)
{
    const hewn_pair_item *x = a, *y = b;
    if (x->forward != y->forward)
        return x->forward ? -1 : 1;
    return (x->side > y->side) - (x->side < y->side);
}

static void sort_items(hewn_pair_item *items, uint32_t count)
{
    qsort(items, count, sizeof *items, compare_angles);
    for (uint32_t begin = 0, end; begin < count; begin = end) {
        for (end = begin + 1; end < count && items[end].angle - items[end - 1].angle < same_angle;)
            end++;
        qsort(items + begin, end - begin, sizeof *items, compare_ways);
    }
}

/* Counter-clockwise around the edge from its lower to its higher vertex, the inside lies behind a face that runs
 * forward and ahead of one that runs backward: brackets that open and close, on a circle, so the row is read twice. */
static void match(const hewn_pair_item *items, uint32_t count, uint32_t *stack, uint32_t *mates)
{
    uint32_t height = 0;
    for (uint32_t i = 0; i < 2 * count; i++) {
        const hewn_pair_item *item = items + i % count;
        if (mates[item->side] != HEWN_NONE)
            continue;
        if (!item->forward && i < count) {
            stack[height++] = item->side;
        } else if (item->forward && height > 0) {
            uint32_t open = stack[--height];
            mates[open] = item->side;
            mates[item->side] = open;
        }
    }
}

void hewn_soup_pair(const hewn_soup *soup, const hewn_sides *sides, uint32_t group, hewn_pair_item *items,
                    uint32_t *stack, uint32_t *mates)
{
    uint32_t begin = sides->group[group], count = sides->group[group + 1] - begin;
    uint32_t lead = sides->sides[begin], a = hewn_side_tail(soup, lead), b = hewn_side_head(soup, sides, lead);
    uint32_t low = a < b ? a : b, high = a < b ? b : a;
    const double *p = soup->positions + 3 * (size_t)low, *q = soup->positions + 3 * (size_t)high;
    double along[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]}, zero[3], right[3];
    normalise(along);
    inward(soup, sides, lead, along, a == low, zero);
    cross(along, zero, right);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t side = sides->sides[begin + i];
        bool forward = hewn_side_tail(soup, side) == low;
        double into[3];
        inward(soup, sides, side, along, forward, into);
        items[i] = (hewn_pair_item){diamond_angle(dot(into, zero), dot(into, right)), side, forward};
        mates[side] = HEWN_NONE;
    }
    sort_items(items, count);
    match(items, count, stack, mates);
}
