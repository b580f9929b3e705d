#include "font/outline.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"

enum { MOST_SIDES = 16384, NEWTON_STEPS = 8 };

void hewn_glyph_outline_clear(hewn_glyph_outline *outline)
{
    hewn_free(outline->curves);
    hewn_free(outline->ends);
    *outline = (hewn_glyph_outline){0};
}

static hewn_result add_curve(hewn_glyph_outline *outline, const hewn_bezier *curve, hewn_error *error)
{
    void *items = outline->curves;
    HEWN_TRY(hewn_reserve(&items, &outline->room, outline->count + 1, sizeof *outline->curves, error));
    outline->curves = items;
    outline->curves[outline->count++] = *curve;
    return HEWN_OK;
}

static hewn_result take_curve(void *user, unsigned degree, const double (*points)[2], hewn_error *error)
{
    hewn_bezier curve = {.degree = degree};
    memcpy(curve.p, points, (degree + 1) * sizeof *points);
    return hewn_bezier_reach(&curve) > 0 ? add_curve(user, &curve, error) : HEWN_OK;
}

hewn_result hewn_glyph_outline_read(hewn_font *font, uint32_t glyph, hewn_glyph_outline *out, hewn_error *error)
{
    *out = (hewn_glyph_outline){0};
    hewn_result result = hewn_font_walk(font, glyph, 1, (const double[2]){0, 0}, take_curve, out, error);
    if (result != HEWN_OK)
        hewn_glyph_outline_clear(out);
    return result;
}

/* --- chords --------------------------------------------------------------------------------------------------------
 */

/* Which part of which curve a chord stands for. */
typedef struct chord {
    size_t curve;
    double begin, end;
    double from[2], along[2]; /* on the grid */
} chord;

typedef struct chords {
    chord *items;
    size_t count, room;
} chords;

static hewn_result cut_curve(const hewn_bezier *curve, size_t number, double grid, double off, hewn_grid_sides *sides,
                             chords *out, hewn_error *error)
{
    double points[4][2];
    for (unsigned k = 0; k <= curve->degree; k++)
        for (int axis = 0; axis < 2; axis++)
            points[k][axis] = grid * curve->p[k][axis];
    HEWN_TRY(hewn_grid_add_curve(sides, curve->degree, (const double(*)[2])points, off, error));
    size_t parts = sides->tag - out->count;
    void *items = out->items;
    HEWN_TRY(hewn_reserve(&items, &out->room, sides->tag, sizeof *out->items, error));
    out->items = items;
    for (size_t i = 0; i < parts; i++) {
        chord own = {.curve = number, .begin = (double)i / (double)parts, .end = (double)(i + 1) / (double)parts};
        double to[2];
        hewn_bezier_point(curve, own.begin, own.from);
        hewn_bezier_point(curve, own.end, to);
        for (int axis = 0; axis < 2; axis++) {
            own.from[axis] *= grid;
            own.along[axis] = grid * to[axis] - own.from[axis];
        }
        out->items[out->count++] = own;
    }
    return HEWN_OK;
}

/* The parameter of the chord's curve that belongs to a point on it. */
static double place_on(const chord *own, hewn_grid_point at)
{
    double square = own->along[0] * own->along[0] + own->along[1] * own->along[1];
    double share = ((double)at.x - own->from[0]) * own->along[0] + ((double)at.y - own->from[1]) * own->along[1];
    share = square > 0 ? fmin(fmax(share / square, 0), 1) : 0;
    double t = own->begin + share * (own->end - own->begin), near = 1.5 / (sqrt(square) + 1e-300);
    if (share < near && own->begin == 0) /* ends were rounded to the grid */
        return 0;
    return 1 - share < near && own->end == 1 ? 1 : t;
}

/* --- contours of sides ---------------------------------------------------------------------------------------------
 */

static int by_start(const void *left, const void *right)
{
    const hewn_grid_side *p = left, *q = right;
    if (p->a.x != q->a.x)
        return p->a.x < q->a.x ? -1 : 1;
    if (p->a.y != q->a.y)
        return p->a.y < q->a.y ? -1 : 1;
    return (p->tag > q->tag) - (p->tag < q->tag);
}

static size_t first_from(const hewn_grid_side *sides, size_t count, hewn_grid_point from)
{
    size_t low = 0, high = count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        const hewn_grid_point *at = &sides[middle].a;
        if (at->x != from.x ? at->x < from.x : at->y < from.y)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static bool runs_forward(const chord *own, const hewn_grid_side *side)
{
    return own->along[0] * (double)(side->b.x - side->a.x) + own->along[1] * (double)(side->b.y - side->a.y) > 0;
}

/* Whether a side goes on along the same curve where another ended. */
static bool goes_on(const chords *all, const hewn_grid_side *one, const hewn_grid_side *next)
{
    const chord *p = &all->items[one->tag], *q = &all->items[next->tag];
    bool forward = runs_forward(p, one);
    if (p->curve != q->curve || forward != runs_forward(q, next))
        return false;
    double apart = place_on(q, next->a) - place_on(p, one->b);
    return fabs(apart) <= 1.5 * (q->end - q->begin) && (one->tag == next->tag || forward == (next->tag > one->tag));
}

/* The side that follows `at`: where several do, one along the same curve, else the one that turns most to the left, so
 * that shapes which touch in a point stay apart. `count` where all are taken, which a winding of 0 says. */
static size_t side_after(const hewn_grid_side *sides, size_t count, const chords *all, size_t at)
{
    const hewn_grid_side *one = &sides[at];
    double dx = (double)(one->b.x - one->a.x), dy = (double)(one->b.y - one->a.y), most = -10;
    size_t best = count;
    for (size_t i = first_from(sides, count, one->b); i < count && hewn_grid_same(sides[i].a, one->b); i++) {
        if (sides[i].winding == 0)
            continue;
        double ex = (double)(sides[i].b.x - sides[i].a.x), ey = (double)(sides[i].b.y - sides[i].a.y);
        double turn = goes_on(all, one, &sides[i]) ? 10 : atan2(dx * ey - dy * ex, dx * ex + dy * ey);
        if (turn > most) {
            most = turn;
            best = i;
        }
    }
    return best;
}

/* --- contours of curves --------------------------------------------------------------------------------------------
 */

/* A part of a curve on a contour. */
typedef struct run {
    size_t curve;
    double from, to;
    hewn_grid_point last; /* where it ends, on the grid */
} run;

typedef struct runs {
    run *items;
    size_t count, room;
} runs;

/* Cuts a contour of sides where another curve begins. `loop` begins at such a place, if it has one. */
static hewn_result find_runs(const hewn_grid_side *loop, size_t count, const chords *all, runs *out, hewn_error *error)
{
    out->count = 0;
    for (size_t i = 0; i < count; i++) {
        const chord *own = &all->items[loop[i].tag];
        if (i == 0 || !goes_on(all, &loop[i - 1], &loop[i])) {
            void *items = out->items;
            HEWN_TRY(hewn_reserve(&items, &out->room, out->count + 1, sizeof *out->items, error));
            out->items = items;
            out->items[out->count++] = (run){.curve = own->curve, .from = place_on(own, loop[i].a)};
        }
        out->items[out->count - 1].to = place_on(own, loop[i].b);
        out->items[out->count - 1].last = loop[i].b;
    }
    return HEWN_OK;
}

static void turn_to_break(hewn_grid_side *loop, size_t count, hewn_grid_side *spare, const chords *all)
{
    size_t first = 0;
    while (first < count && goes_on(all, &loop[(first + count - 1) % count], &loop[first]))
        first++;
    for (size_t i = 0; i < count && first < count; i++)
        spare[i] = loop[(first + i) % count];
    if (first < count)
        memcpy(loop, spare, count * sizeof *loop);
}

/* Moves the places where two curves come nearest `off` to where they meet, by Newton's method; false where they do not
 * cross there. */
static bool refine(const hewn_bezier *one, const hewn_bezier *other, double off, double *t, double *s, double at[2])
{
    double p[2], q[2], u = *t, v = *s;
    for (int i = 0; i < NEWTON_STEPS; i++) {
        double a[4][2], b[4][2], da[2], db[2];
        hewn_bezier_powers(one, a);
        hewn_bezier_powers(other, b);
        hewn_bezier_point(one, u, p);
        hewn_bezier_point(other, v, q);
        for (int axis = 0; axis < 2; axis++) {
            da[axis] = a[1][axis] + u * (2 * a[2][axis] + u * 3 * a[3][axis]);
            db[axis] = b[1][axis] + v * (2 * b[2][axis] + v * 3 * b[3][axis]);
        }
        double turn = da[0] * db[1] - da[1] * db[0], dx = q[0] - p[0], dy = q[1] - p[1];
        if (!(fabs(turn) > 1e-3 * hypot(da[0], da[1]) * hypot(db[0], db[1])))
            return false;
        u += (dx * db[1] - dy * db[0]) / turn;
        v += (dx * da[1] - dy * da[0]) / turn;
    }
    hewn_bezier_point(one, u, p);
    hewn_bezier_point(other, v, q);
    bool good = u >= 0 && u <= 1 && v >= 0 && v <= 1 && hypot(p[0] - q[0], p[1] - q[1]) < 1e-3 * off &&
                hypot(p[0] - at[0], p[1] - at[1]) < 4 * off;
    if (good) {
        *t = u;
        *s = v;
        memcpy(at, p, sizeof p);
    }
    return good;
}

/* Where run `one` ends and `next` begins: the point that both shall have. */
static void join(const hewn_glyph_outline *raw, run *one, run *next, double grid, double off, double at[2])
{
    const hewn_bezier *p = &raw->curves[one->curve], *q = &raw->curves[next->curve];
    double end[2], begin[2];
    hewn_bezier_point(p, one->to, end);
    hewn_bezier_point(q, next->from, begin);
    at[0] = (double)one->last.x / grid;
    at[1] = (double)one->last.y / grid;
    if (end[0] == begin[0] && end[1] == begin[1])
        memcpy(at, end, sizeof end);
    else
        refine(p, q, off, &one->to, &next->from, at);
}

/* What is left of the curves of one contour. */
static hewn_result add_contour(const hewn_glyph_outline *raw, runs *own, double grid, double off,
                               hewn_glyph_outline *out, hewn_error *error)
{
    size_t count = 0, before = out->count;
    for (size_t i = 0; i < own->count; i++) {
        hewn_bezier part = hewn_bezier_part(&raw->curves[own->items[i].curve], own->items[i].from, own->items[i].to);
        if (hewn_bezier_reach(&part) > 1.5 * off)
            own->items[count++] = own->items[i];
    }
    double(*joints)[2] = hewn_alloc(count, sizeof *joints);
    if (!joints)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for an outline");
    for (size_t i = 0; i < count; i++)
        join(raw, &own->items[i], &own->items[(i + 1) % count], grid, off, joints[i]);
    hewn_result result = HEWN_OK;
    for (size_t i = 0; i < count && result == HEWN_OK; i++) {
        const run *at = &own->items[i];
        hewn_bezier part = hewn_bezier_part(&raw->curves[at->curve], at->from, at->to);
        memcpy(part.p[0], joints[(i + count - 1) % count], sizeof part.p[0]);
        memcpy(part.p[part.degree], joints[i], sizeof part.p[0]);
        if (hewn_bezier_reach(&part) > 0)
            result = add_curve(out, &part, error);
    }
    hewn_free(joints);
    if (result != HEWN_OK || out->count == before)
        return result;
    void *items = out->ends;
    HEWN_TRY(hewn_reserve(&items, &out->contour_room, out->contours + 1, sizeof *out->ends, error));
    out->ends = items;
    out->ends[out->contours++] = out->count;
    return HEWN_OK;
}

static hewn_result follow(const hewn_glyph_outline *raw, hewn_grid_side *sides, size_t count, const chords *all,
                          double grid, double off, hewn_glyph_outline *out, hewn_error *error)
{
    hewn_grid_side *loop = hewn_alloc(2 * count, sizeof *loop);
    runs own = {0};
    hewn_result result = loop ? HEWN_OK : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for an outline");
    for (size_t i = 0; i < count && result == HEWN_OK; i++) {
        size_t length = 0;
        for (size_t at = i; at < count && sides[at].winding != 0;) {
            loop[length++] = sides[at];
            sides[at].winding = 0;
            at = hewn_grid_same(sides[at].b, sides[i].a) ? count : side_after(sides, count, all, at);
        }
        if (length == 0)
            continue;
        turn_to_break(loop, length, loop + count, all);
        result = find_runs(loop, length, all, &own, error);
        if (result == HEWN_OK)
            result = add_contour(raw, &own, grid, off, out, error);
    }
    hewn_free(loop);
    hewn_free(own.items);
    return result;
}

hewn_result hewn_glyph_outline_resolve(hewn_glyph_outline *outline, double grid, double units, hewn_error *error)
{
    hewn_grid_sides sides = {0};
    chords all = {0};
    hewn_glyph_outline out = {0};
    double off = units / 8192;
    hewn_result result = HEWN_OK;
    for (size_t i = 0; i < outline->count && result == HEWN_OK; i++) {
        result = cut_curve(&outline->curves[i], i, grid, off * grid, &sides, &all, error);
        if (result == HEWN_OK && sides.count > MOST_SIDES)
            result = hewn_fail(error, HEWN_LIMIT, "the outline is too involved");
    }
    bool any = all.items != NULL; /* else there is nothing, which is what is left of it */
    if (result == HEWN_OK && any)
        result = hewn_grid_nonzero(&sides, MOST_SIDES, error);
    if (result == HEWN_OK && sides.count > 1)
        qsort(sides.items, sides.count, sizeof *sides.items, by_start);
    if (result == HEWN_OK && any)
        result = follow(outline, sides.items, sides.count, &all, grid, off, &out, error);
    hewn_grid_sides_clear(&sides);
    hewn_free(all.items);
    if (result == HEWN_OK) {
        hewn_glyph_outline_clear(outline);
        *outline = out;
    } else {
        hewn_glyph_outline_clear(&out);
    }
    return result;
}
