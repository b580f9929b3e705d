#include "mesh/ears.h"

#include <math.h>

#include "base/alloc.h"
#include "geom/predicates.h"

/* How much is asked of an ear. A proper polygon has ears of the first kind; the others are for polygons that touch or
 * cross themselves or have no area, so that cutting always goes on. */
typedef enum demand {
    DEMAND_EMPTY,  /* convex, no other corner in it or on its border */
    DEMAND_HOLLOW, /* convex, no other corner strictly inside */
    DEMAND_CONVEX,
    DEMAND_NONE,
    DEMAND_COUNT
} demand;

/* More ways than this are not tried where an edge is forbidden. In polygons that are not proper the strictest demand is
 * made anew after each cut while at most SMALL_POLYGON corners are left. */
enum { MOST_TRIES = 16, SMALL_POLYGON = 64 };

typedef struct ear_cutting {
    const double *plane;
    uint32_t count;
    uint32_t *next, *prev; /* the corners that are left, in a ring */
    double *shape;         /* of the ear at each: higher is better; NAN: to be found again; -INFINITY: none */
    bool *forbidden;       /* by may_join(), as long as the ear stays the same */
    demand demand;
} ear_cutting;

static const double *at(const ear_cutting *cutting, uint32_t corner)
{
    return cutting->plane + 2 * (size_t)corner;
}

static bool same_place(const double *a, const double *b)
{
    return a[0] == b[0] && a[1] == b[1];
}

/* Whether a corner that is left, but for the ear's own and those in the same places, lies in the ear. */
static bool holds_corner(const ear_cutting *cutting, uint32_t ear)
{
    uint32_t before = cutting->prev[ear], after = cutting->next[ear];
    const double *a = at(cutting, before), *b = at(cutting, ear), *c = at(cutting, after);
    int least = cutting->demand == DEMAND_EMPTY ? 0 : 1;
    for (uint32_t i = cutting->next[after]; i != before; i = cutting->next[i]) {
        const double *p = at(cutting, i);
        if (same_place(p, a) || same_place(p, b) || same_place(p, c))
            continue;
        if (hewn_orient2d(a, b, p) >= least && hewn_orient2d(b, c, p) >= least && hewn_orient2d(c, a, p) >= least)
            return true;
    }
    return false;
}

/* Twice the area over the sum of the squared sides: greatest for equal sides. */
static double find_shape(const ear_cutting *cutting, uint32_t ear)
{
    const double *a = at(cutting, cutting->prev[ear]), *b = at(cutting, ear), *c = at(cutting, cutting->next[ear]);
    if (cutting->demand < DEMAND_NONE) {
        if (hewn_orient2d(a, b, c) <= 0)
            return -INFINITY;
        if (cutting->demand < DEMAND_CONVEX && holds_corner(cutting, ear))
            return -INFINITY;
    }
    double ux = b[0] - a[0], uy = b[1] - a[1], vx = c[0] - b[0], vy = c[1] - b[1], wx = a[0] - c[0], wy = a[1] - c[1];
    double sides = ux * ux + uy * uy + vx * vx + vy * vy + wx * wx + wy * wy;
    return sides > 0 ? (ux * vy - uy * vx) / sides : 0;
}

/* The best ear of those allowed, the first of equals from `start`, or simply the first; `count` where there is none.
 * `*refused` tells whether there were any that are not allowed. */
static uint32_t choose_ear(ear_cutting *cutting, uint32_t start, bool first_fit, bool *refused)
{
    uint32_t best = cutting->count, i = start;
    *refused = false;
    do {
        if (isnan(cutting->shape[i]))
            cutting->shape[i] = find_shape(cutting, i);
        if (cutting->shape[i] > -INFINITY) {
            *refused |= cutting->forbidden[i];
            if (!cutting->forbidden[i] && (best == cutting->count || cutting->shape[i] > cutting->shape[best]))
                best = i;
        }
        i = cutting->next[i];
    } while (i != start && !(first_fit && best < cutting->count));
    return best;
}

static void forget_shapes(ear_cutting *cutting)
{
    for (uint32_t i = 0; i < cutting->count; i++)
        cutting->shape[i] = NAN;
}

static void cut(ear_cutting *cutting, uint32_t ear)
{
    uint32_t before = cutting->prev[ear], after = cutting->next[ear];
    cutting->next[before] = after;
    cutting->prev[after] = before;
    cutting->shape[before] = cutting->shape[after] = NAN;
    cutting->forbidden[before] = cutting->forbidden[after] = false;
}

static void begin(ear_cutting *cutting)
{
    for (uint32_t i = 0; i < cutting->count; i++) {
        cutting->next[i] = i + 1 < cutting->count ? i + 1 : 0;
        cutting->prev[i] = i > 0 ? i - 1 : cutting->count - 1;
        cutting->forbidden[i] = false;
    }
    cutting->demand = DEMAND_EMPTY;
    forget_shapes(cutting);
}

/* One way of cutting. In a proper polygon a cut changes only the ears beside it; in others a corner that left may have
 * been the only one that an ear held, so where no ear is left all are looked at again before less is asked of them. */
static bool try_cutting(ear_cutting *cutting, hewn_may_join may_join, const void *user, uint32_t start, bool first_fit,
                        uint32_t *order)
{
    bool fresh = true;
    begin(cutting);
    for (uint32_t left = cutting->count; left > 3;) {
        bool refused;
        uint32_t ear = choose_ear(cutting, start, first_fit, &refused);
        if (ear < cutting->count) {
            if (!may_join(user, cutting->prev[ear], cutting->next[ear])) {
                cutting->forbidden[ear] = true;
                continue;
            }
            order[cutting->count - left--] = ear;
            start = cutting->next[ear];
            cut(cutting, ear);
            fresh = false;
            if (cutting->demand == DEMAND_EMPTY || left > SMALL_POLYGON)
                continue;
            cutting->demand = DEMAND_EMPTY;
        } else if (!fresh) {
            fresh = true;
        } else if (refused || ++cutting->demand == DEMAND_COUNT) {
            return false;
        }
        forget_shapes(cutting);
    }
    return true;
}

hewn_result hewn_ears_cut(const double *plane, uint32_t count, hewn_may_join may_join, const void *user,
                          uint32_t *order, bool *found, hewn_error *error)
{
    ear_cutting cutting = {.plane = plane, .count = count};
    cutting.next = hewn_alloc(count, sizeof *cutting.next);
    cutting.prev = hewn_alloc(count, sizeof *cutting.prev);
    cutting.shape = hewn_alloc(count, sizeof *cutting.shape);
    cutting.forbidden = hewn_alloc(count, sizeof *cutting.forbidden);
    hewn_result result = HEWN_OK;
    *found = false;
    if (!cutting.next || !cutting.prev || !cutting.shape || !cutting.forbidden)
        result = hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory cutting a polygon of %u corners", count);
    for (uint32_t way = 0; result == HEWN_OK && !*found && way <= count && way < MOST_TRIES; way++)
        *found = try_cutting(&cutting, may_join, user, way == 0 ? 0 : way - 1, way > 0, order);
    hewn_free(cutting.next);
    hewn_free(cutting.prev);
    hewn_free(cutting.shape);
    hewn_free(cutting.forbidden);
    return result;
}
