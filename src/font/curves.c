#include "font/curves.h"

#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "font/bezier.h"

static bool is_near(hewn_grid_point p)
{
    return p.x > -HEWN_GRID_MOST && p.x < HEWN_GRID_MOST && p.y > -HEWN_GRID_MOST && p.y < HEWN_GRID_MOST;
}

hewn_result hewn_grid_add(hewn_grid_sides *sides, hewn_grid_point a, hewn_grid_point b, hewn_error *error)
{
    if (hewn_grid_same(a, b))
        return HEWN_OK;
    if (!is_near(a) || !is_near(b))
        return hewn_fail(error, HEWN_LIMIT, "the outline reaches too far");
    void *items = sides->items;
    HEWN_TRY(hewn_reserve(&items, &sides->room, sides->count + 1, sizeof *sides->items, error));
    sides->items = items;
    sides->items[sides->count++] = (hewn_grid_side){a, b, 1, sides->tag};
    return HEWN_OK;
}

void hewn_grid_sides_clear(hewn_grid_sides *sides)
{
    hewn_free(sides->items);
    *sides = (hewn_grid_sides){0};
}

static hewn_grid_point rounded(const double p[2])
{
    return (hewn_grid_point){llround(fmin(fmax(p[0], -2e9), 2e9)), llround(fmin(fmax(p[1], -2e9), 2e9))};
}

/* How many chords: the second differences of the controls bound the second derivative, and that how far a chord is off.
 */
static unsigned chord_count(unsigned degree, const double (*p)[2], double off)
{
    double bend = 0;
    for (unsigned k = 0; k + 2 <= degree; k++)
        bend = fmax(bend, hypot(p[k][0] - 2 * p[k + 1][0] + p[k + 2][0], p[k][1] - 2 * p[k + 1][1] + p[k + 2][1]));
    return (unsigned)fmin(fmax(ceil(sqrt(bend * degree * (degree - 1) / (8 * off))), 1), 256);
}

hewn_result hewn_grid_add_curve(hewn_grid_sides *sides, unsigned degree, const double (*points)[2], double off,
                                hewn_error *error)
{
    hewn_bezier curve = {.degree = degree};
    memcpy(curve.p, points, (degree + 1) * sizeof *curve.p);
    unsigned chords = chord_count(degree, points, off);
    hewn_grid_point last = rounded(points[0]);
    for (unsigned i = 1; i <= chords; i++) {
        double p[2];
        hewn_bezier_point(&curve, (double)i / chords, p);
        hewn_grid_point next = rounded(i == chords ? points[degree] : p);
        HEWN_TRY(hewn_grid_add(sides, last, next, error));
        sides->tag++;
        last = next;
    }
    return HEWN_OK;
}
