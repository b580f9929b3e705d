/* A box around a shape: what the graph says of itself, then interval proofs that the rest of space is empty. */
#include <math.h>

#include "base/alloc.h"
#include "base/error.h"
#include "field/internal.h"

/* The world that the proof covers: beyond it squares overflow the floats that shaders compute with. */
#define WORLD 0x1p60

/* Largest cube tried around the origin, in scene units. */
#define LARGEST 0x1p20

/* Node evaluations that one search may spend; where the graph's shapes say nothing, at the least so many boxes, however
 * large the graph. */
#define BUDGET ((size_t)1 << 21)
#define LEAST_BOXES 200

#define LAYERS 32      /* slices of a side's length that shrinking takes off one by one */
#define LAYER_DEPTH 10 /* halvings of such a slice: 32 by 32 cells */
#define SLAB_DEPTH 40  /* halvings of an unbounded slab */
#define ROUNDS 12

typedef struct box_search {
    hewn_tape tape;
    hewn_interval *scratch;
    size_t boxes_left;
    double unit; /* lengths beyond it count by ratio; infinite where all count as they are */
} box_search;

/* --- proofs --------------------------------------------------------------------------------------------------------
 */

static double warp(double at, double unit)
{
    return at < 0 ? -log2(1 - at / unit) : log2(1 + at / unit);
}

static double unwarp(double at, double unit)
{
    return at < 0 ? -unit * (exp2(-at) - 1) : unit * (exp2(at) - 1);
}

/* How much of a side there is to look at: octaves beyond `unit`, so that a slab a world long is cut near the shape
 * first. */
static double extent(double lo, double hi, double unit)
{
    return isinf(unit) ? hi - lo : warp(hi, unit) - warp(lo, unit);
}

/* Halves the box along its longest side. A long side across 0 is cut at 0: fields made of squares and sums change
 * behaviour there. */
static void halve(const hewn_box *box, double unit, hewn_box half[2])
{
    int axis = 0;
    for (int i = 1; i < 3; i++)
        if (extent(box->lo[i], box->hi[i], unit) > extent(box->lo[axis], box->hi[axis], unit))
            axis = i;
    double lo = box->lo[axis], hi = box->hi[axis];
    double cut = lo + 0.5 * (hi - lo);
    if (lo < 0 && hi > 0 && hi - lo > unit)
        cut = 0;
    else if (hi - lo > unit)
        cut = unwarp(0.5 * (warp(lo, unit) + warp(hi, unit)), unit);
    cut = fmin(fmax(cut, lo), hi);
    half[0] = half[1] = *box;
    half[0].hi[axis] = cut;
    half[1].lo[axis] = cut;
}

/* Whether the field is above 0 in all of the box. Depth first, so that a part that cannot be proven ends it soon. */
static bool is_outside(box_search *search, const hewn_box *box, int depth)
{
    if (search->boxes_left == 0)
        return false;
    search->boxes_left--;
    hewn_interval value = hewn_tape_bound(&search->tape, box, search->scratch);
    if (value.lo > 0 && !value.maybe_nan)
        return true;
    if (depth == 0 || value.hi <= 0)
        return false;
    hewn_box half[2];
    halve(box, search->unit, half);
    return is_outside(search, &half[0], depth - 1) && is_outside(search, &half[1], depth - 1);
}

/* --- the first box -------------------------------------------------------------------------------------------------
 */

static bool is_bounded(const hewn_box *box)
{
    for (int i = 0; i < 3; i++)
        if (box->lo[i] <= -WORLD || box->hi[i] >= WORLD)
            return false;
    return true;
}

/* Whether what of `box` lies outside [-radius, radius] along some axis is outside the shape. */
static bool cube_holds(box_search *search, const hewn_box *box, double radius)
{
    search->unit = radius;
    for (int axis = 0; axis < 3; axis++) {
        hewn_box slab = *box;
        slab.lo[axis] = fmax(box->lo[axis], radius);
        if (slab.lo[axis] < slab.hi[axis] && !is_outside(search, &slab, SLAB_DEPTH))
            return false;
        slab = *box;
        slab.hi[axis] = fmin(box->hi[axis], -radius);
        if (slab.lo[axis] < slab.hi[axis] && !is_outside(search, &slab, SLAB_DEPTH))
            return false;
    }
    return true;
}

/* Cuts `box` to the least power-of-two cube that is proven to hold the shape. Half of the budget is kept for shrinking,
 * and no one cube may use all of the rest. */
static bool find_cube(box_search *search, hewn_box *box)
{
    size_t total = search->boxes_left < LEAST_BOXES ? LEAST_BOXES : search->boxes_left;
    size_t share = total / 40 + 8;
    size_t left = total;
    bool found = false;
    double radius = 0.5;
    while (!found && radius < LARGEST) {
        radius *= 2;
        search->boxes_left = share;
        found = cube_holds(search, box, radius);
        size_t spent = share - search->boxes_left;
        left -= spent < left ? spent : left;
    }
    search->boxes_left = left;
    for (int i = 0; i < 3 && found; i++) {
        box->lo[i] = fmin(fmax(box->lo[i], -radius), radius);
        box->hi[i] = fmin(fmax(box->hi[i], -radius), radius);
    }
    return found;
}

/* --- shrinking -----------------------------------------------------------------------------------------------------
 */

/* Takes layers off one side while they are proven to be outside; returns false when nothing is left. */
static bool shrink_side(box_search *search, hewn_box *box, int axis, bool upper)
{
    double lo = box->lo[axis], hi = box->hi[axis];
    double thickness = (hi - lo) / LAYERS;
    double near = upper ? hi : lo;
    int taken = 0;
    for (; taken < LAYERS; taken++) {
        double far = upper ? hi - thickness * (taken + 1) : lo + thickness * (taken + 1);
        if (taken + 1 == LAYERS)
            far = upper ? lo : hi;
        hewn_box layer = *box;
        layer.lo[axis] = upper ? far : near;
        layer.hi[axis] = upper ? near : far;
        if (!(layer.lo[axis] <= layer.hi[axis]) || !is_outside(search, &layer, LAYER_DEPTH))
            break;
        near = far;
    }
    if (upper)
        box->hi[axis] = near;
    else
        box->lo[axis] = near;
    return taken < LAYERS;
}

static bool shrink(box_search *search, hewn_box *box)
{
    search->unit = INFINITY; /* even halves */
    bool better = true;
    for (int round = 0; better && round < ROUNDS; round++) {
        better = false;
        for (int axis = 0; axis < 3; axis++) {
            double before = box->hi[axis] - box->lo[axis];
            if (!shrink_side(search, box, axis, true) || !shrink_side(search, box, axis, false))
                return false;
            better = better || box->hi[axis] - box->lo[axis] < 0.9 * before;
        }
    }
    return true;
}

/* --- all -----------------------------------------------------------------------------------------------------------
 */

/* A margin, so that the surface is strictly inside. */
static void inflate(hewn_box *box)
{
    double longest = 0;
    for (int i = 0; i < 3; i++)
        longest = fmax(longest, box->hi[i] - box->lo[i]);
    for (int i = 0; i < 3; i++) {
        double margin = 1e-6 * longest + 0x1p-50 * fmax(fabs(box->lo[i]), fabs(box->hi[i])) + 0x1p-100;
        box->lo[i] -= margin;
        box->hi[i] += margin;
    }
}

static hewn_result search_box(box_search *search, const hewn_field *field, hewn_box *out, hewn_error *error)
{
    hewn_region region;
    HEWN_TRY(hewn_tape_region(&search->tape, field, &region, error));
    hewn_box box = region.box;
    bool empty = region.empty;
    for (int i = 0; i < 3; i++) {
        box.lo[i] = fmax(box.lo[i], -WORLD);
        box.hi[i] = fmin(box.hi[i], WORLD);
        empty = empty || box.lo[i] > box.hi[i];
    }
    if (!empty && !is_bounded(&box) && !find_cube(search, &box))
        return hewn_fail(error, HEWN_BAD_INPUT,
                         "no box around the shape could be proven: it is infinite or too involved; give its bounds");
    if (empty || !shrink(search, &box))
        return hewn_fail(error, HEWN_BAD_INPUT, "the shape is empty: its field is above 0 everywhere");
    inflate(&box);
    *out = box;
    return HEWN_OK;
}

hewn_result hewn_field_find_box(const hewn_field *field, hewn_node node, hewn_box *out, hewn_error *error)
{
    if (!out)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "hewn_field_find_box: no place for the box");
    *out = (hewn_box){{0, 0, 0}, {0, 0, 0}};
    box_search search = {.unit = 1};
    HEWN_TRY(hewn_tape_create(&search.tape, field, node, error));
    search.boxes_left = BUDGET / search.tape.count;
    search.scratch = hewn_alloc(search.tape.count, sizeof *search.scratch);
    hewn_result result = search.scratch
                             ? search_box(&search, field, out, error)
                             : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory finding a box around a field");
    hewn_free(search.scratch);
    hewn_tape_destroy(&search.tape);
    return result;
}
