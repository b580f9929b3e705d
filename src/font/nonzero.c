/* What polygons wind around, without the sides within. Sides are cut where they meet, on the grid, until they meet at
 * ends alone (snap rounding: Hobby 1999, here by whole passes); then a ray from the middle of each counts what winds
 * around either side of it, in exact arithmetic, so that what is left is closed again. */
#include <math.h>
#include <stdlib.h>

#include "base/alloc.h"
#include "base/error.h"
#include "font/curves.h"

/* --- where sides meet ----------------------------------------------------------------------------------------------
 */

/* A point within a side at which it is cut. */
typedef struct cut {
    size_t side;
    hewn_grid_point at;
} cut;

typedef struct cuts {
    cut *items;
    size_t count, room, most;
} cuts;

static hewn_result add_cut(cuts *own, size_t side, hewn_grid_point at, hewn_error *error)
{
    if (own->count >= own->most)
        return hewn_fail(error, HEWN_LIMIT, "the outline crosses itself too often");
    void *items = own->items;
    HEWN_TRY(hewn_reserve(&items, &own->room, own->count + 1, sizeof *own->items, error));
    own->items = items;
    own->items[own->count++] = (cut){side, at};
    return HEWN_OK;
}

static int sign_of(int64_t value)
{
    return (value > 0) - (value < 0);
}

static bool is_end(const hewn_grid_side *side, hewn_grid_point p)
{
    return hewn_grid_same(side->a, p) || hewn_grid_same(side->b, p);
}

/* Of a point on the side's line: whether it lies between its ends. */
static bool is_within(const hewn_grid_side *side, hewn_grid_point p)
{
    int64_t dx = side->b.x - side->a.x, dy = side->b.y - side->a.y;
    int64_t along = (p.x - side->a.x) * dx + (p.y - side->a.y) * dy;
    return along > 0 && along < dx * dx + dy * dy;
}

/* Where the lines of two sides that cross do, on the grid. */
static hewn_grid_point crossing(const hewn_grid_side *one, int64_t before, int64_t after)
{
    long double t = (long double)before / ((long double)before - (long double)after);
    return (hewn_grid_point){one->a.x + llroundl(t * (one->b.x - one->a.x)),
                             one->a.y + llroundl(t * (one->b.y - one->a.y))};
}

static hewn_result meet(const hewn_grid_side *sides, size_t i, size_t k, cuts *out, hewn_error *error)
{
    const hewn_grid_side *one = &sides[i], *other = &sides[k];
    int64_t a = hewn_grid_turn(other->a, other->b, one->a), b = hewn_grid_turn(other->a, other->b, one->b);
    int64_t c = hewn_grid_turn(one->a, one->b, other->a), d = hewn_grid_turn(one->a, one->b, other->b);
    if (sign_of(a) * sign_of(b) < 0 && sign_of(c) * sign_of(d) < 0) {
        hewn_grid_point at = crossing(one, a, b);
        if (!is_end(one, at))
            HEWN_TRY(add_cut(out, i, at, error));
        return is_end(other, at) ? HEWN_OK : add_cut(out, k, at, error);
    }
    if (a == 0 && is_within(other, one->a))
        HEWN_TRY(add_cut(out, k, one->a, error));
    if (b == 0 && is_within(other, one->b))
        HEWN_TRY(add_cut(out, k, one->b, error));
    if (c == 0 && is_within(one, other->a))
        HEWN_TRY(add_cut(out, i, other->a, error));
    if (d == 0 && is_within(one, other->b))
        HEWN_TRY(add_cut(out, i, other->b, error));
    return HEWN_OK;
}

static int64_t least(int64_t a, int64_t b)
{
    return a < b ? a : b;
}

static int64_t most(int64_t a, int64_t b)
{
    return a > b ? a : b;
}

static int by_left_end(const void *left, const void *right)
{
    const hewn_grid_side *p = left, *q = right;
    int64_t a = least(p->a.x, p->b.x), b = least(q->a.x, q->b.x);
    return (a > b) - (a < b);
}

static hewn_result find_cuts(hewn_grid_sides *sides, cuts *out, hewn_error *error)
{
    if (sides->count > 1)
        qsort(sides->items, sides->count, sizeof *sides->items, by_left_end);
    for (size_t i = 0; i < sides->count; i++) {
        const hewn_grid_side *one = &sides->items[i];
        int64_t right = most(one->a.x, one->b.x), low = least(one->a.y, one->b.y), high = most(one->a.y, one->b.y);
        for (size_t k = i + 1; k < sides->count; k++) {
            const hewn_grid_side *other = &sides->items[k];
            if (least(other->a.x, other->b.x) > right)
                break;
            if (least(other->a.y, other->b.y) <= high && most(other->a.y, other->b.y) >= low)
                HEWN_TRY(meet(sides->items, i, k, out, error));
        }
    }
    return HEWN_OK;
}

/* --- cutting -------------------------------------------------------------------------------------------------------
 */

/* A cut with what qsort() needs to order it along its side. */
typedef struct placed {
    cut cut;
    int64_t along;
} placed;

static int by_place(const void *left, const void *right)
{
    const placed *p = left, *q = right;
    if (p->cut.side != q->cut.side)
        return p->cut.side < q->cut.side ? -1 : 1;
    return (p->along > q->along) - (p->along < q->along);
}

static hewn_result apply_cuts(hewn_grid_sides *sides, const cuts *all, hewn_error *error)
{
    placed *order = hewn_alloc(all->count, sizeof *order);
    if (!order)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for an outline");
    for (size_t i = 0; i < all->count; i++) {
        const hewn_grid_side *side = &sides->items[all->items[i].side];
        hewn_grid_point at = all->items[i].at;
        order[i] = (placed){all->items[i], (at.x - side->a.x) * (side->b.x - side->a.x) +
                                               (at.y - side->a.y) * (side->b.y - side->a.y)};
    }
    qsort(order, all->count, sizeof *order, by_place);
    hewn_result result = HEWN_OK;
    for (size_t i = 0; i < all->count && result == HEWN_OK;) {
        size_t which = order[i].cut.side;
        hewn_grid_point last, end = sides->items[which].b;
        int64_t winding = sides->items[which].winding;
        sides->tag = sides->items[which].tag;
        sides->items[which].b = order[i].cut.at; /* the first part stays where it is; it may have no length */
        for (last = order[i++].cut.at; i <= all->count && result == HEWN_OK; i++) {
            bool more = i < all->count && order[i].cut.side == which;
            hewn_grid_point next = more ? order[i].cut.at : end;
            size_t before = sides->count;
            result = hewn_grid_add(sides, last, next, error);
            if (sides->count > before)
                sides->items[before].winding = winding;
            last = next;
            if (!more)
                break;
        }
    }
    hewn_free(order);
    return result;
}

static bool is_smaller(hewn_grid_point a, hewn_grid_point b)
{
    return a.x != b.x ? a.x < b.x : a.y < b.y;
}

static int by_ends(const void *left, const void *right)
{
    const hewn_grid_side *p = left, *q = right;
    if (!hewn_grid_same(p->a, q->a))
        return is_smaller(p->a, q->a) ? -1 : 1;
    if (!hewn_grid_same(p->b, q->b))
        return is_smaller(p->b, q->b) ? -1 : 1;
    return (p->tag > q->tag) - (p->tag < q->tag); /* so that the order does not depend on that of before */
}

static bool have_same_ends(const hewn_grid_side *p, const hewn_grid_side *q)
{
    return hewn_grid_same(p->a, q->a) && hewn_grid_same(p->b, q->b);
}

/* Sides between the same two points become one; what cancels out goes. */
static void merge(hewn_grid_sides *sides)
{
    size_t count = 0;
    for (size_t i = 0; i < sides->count; i++) {
        hewn_grid_side *side = &sides->items[i];
        if (is_smaller(side->b, side->a))
            *side = (hewn_grid_side){side->b, side->a, -side->winding, side->tag};
    }
    if (sides->count > 1)
        qsort(sides->items, sides->count, sizeof *sides->items, by_ends);
    for (size_t i = 0; i < sides->count;) {
        hewn_grid_side sum = sides->items[i++];
        for (; i < sides->count && have_same_ends(&sum, &sides->items[i]); i++)
            sum.winding += sides->items[i].winding;
        if (sum.winding != 0 && !hewn_grid_same(sum.a, sum.b))
            sides->items[count++] = sum;
    }
    sides->count = count;
}

/* --- inside and outside --------------------------------------------------------------------------------------------
 */

/* A quarter turn, after which what was level is upright. */
static hewn_grid_side turned(const hewn_grid_side *side, bool quarter)
{
    if (!quarter)
        return *side;
    return (hewn_grid_side){{-side->a.y, side->a.x}, {-side->b.y, side->b.x}, side->winding, side->tag};
}

/* How often the polygons wind around what lies left of the middle of side `i`: all the sides that a ray from far left
 * crosses before it gets there. Coordinates count twice, so that the middle is a point of the grid. */
static int64_t winding_before(const hewn_grid_sides *sides, size_t i, bool quarter)
{
    hewn_grid_side own = turned(&sides->items[i], quarter);
    hewn_grid_point middle = {own.a.x + own.b.x, own.a.y + own.b.y};
    int64_t sum = 0;
    for (size_t k = 0; k < sides->count; k++) {
        hewn_grid_side other = turned(&sides->items[k], quarter);
        bool rises = 2 * other.a.y <= middle.y;
        if (k == i || rises == (2 * other.b.y <= middle.y))
            continue;
        hewn_grid_point a = {2 * other.a.x, 2 * other.a.y}, b = {2 * other.b.x, 2 * other.b.y};
        if ((hewn_grid_turn(a, b, middle) < 0) == rises)
            sum += rises ? -other.winding : other.winding;
    }
    return sum;
}

static void keep_borders(const hewn_grid_sides *sides, hewn_grid_side *out, size_t *count)
{
    *count = 0;
    for (size_t i = 0; i < sides->count; i++) {
        const hewn_grid_side *side = &sides->items[i];
        bool quarter = side->a.y == side->b.y;
        hewn_grid_side upright = turned(side, quarter);
        bool rises = upright.b.y > upright.a.y;
        int64_t left = winding_before(sides, i, quarter), right = left + (rises ? -side->winding : side->winding);
        if ((left != 0) == (right != 0))
            continue;
        bool keeps = (left != 0) == rises; /* the inside comes to lie on the left */
        out[(*count)++] = (hewn_grid_side){keeps ? side->a : side->b, keeps ? side->b : side->a, 1, side->tag};
    }
}

hewn_result hewn_grid_nonzero(hewn_grid_sides *sides, size_t most_sides, hewn_error *error)
{
    enum { PASSES = 100 };
    for (int pass = 0;; pass++) {
        cuts all = {.most = 4 * most_sides};
        merge(sides);
        hewn_result result = find_cuts(sides, &all, error);
        if (result == HEWN_OK && all.count > 0)
            result = apply_cuts(sides, &all, error);
        bool done = all.count == 0;
        hewn_free(all.items);
        HEWN_TRY(result);
        if (sides->count > most_sides || pass == PASSES)
            return hewn_fail(error, HEWN_LIMIT, "the outline is too involved");
        if (done)
            break;
    }
    hewn_grid_side *kept = hewn_alloc(sides->count, sizeof *kept);
    if (!kept)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for an outline");
    size_t count;
    keep_borders(sides, kept, &count);
    hewn_free(sides->items);
    *sides = (hewn_grid_sides){kept, count, sides->count, 0};
    return HEWN_OK;
}
