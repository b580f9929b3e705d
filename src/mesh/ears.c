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
 * made anew after each cut while at most SMALL_POLYGON corners are left. A leaf of the tree has that many corners. */
enum { MOST_TRIES = 16, SMALL_POLYGON = 64, LEAF = 8 };

/* Looks at boxes that are spent on a polygon; after that ears are only asked to be convex. Proper polygons take about
 * 100 a corner, tangled ones could take the square of their number. */
static uint64_t most_work(uint64_t count)
{
    uint64_t usual = 1024 * count, of_giants = (1u << 27) + 64 * count;
    return usual < of_giants ? usual : of_giants;
}

typedef struct corner_box {
    double lo[2], hi[2];
} corner_box;

typedef struct heap_entry {
    double key;
    uint32_t corner;
    uint32_t before, after; /* the ear is out of date where it has other neighbours by now */
} heap_entry;

typedef struct ear_cutting {
    const double *plane;
    uint32_t count;
    hewn_may_join may_join;
    const void *user;
    uint32_t *next, *prev; /* the corners that are left, in a ring; of one that was cut off `next` is `count` */
    bool *forbidden;       /* by may_join(), as long as the ear stays the same */
    /* Boxes of the corners that are left: boxes[1] holds all, boxes[i] those of 2i and 2i + 1, and leaf_count + k the
     * corners from k * LEAF. Neighbours along a polygon are neighbours in the plane, so no sorting is needed. */
    corner_box *boxes;
    uint32_t leaf_count;
    heap_entry *heap; /* ears, the best on top */
    uint32_t heap_count;
    demand demand;
    uint64_t work;
    uint32_t way;
} ear_cutting;

static const double *at(const ear_cutting *cutting, uint32_t corner)
{
    return cutting->plane + 2 * (size_t)corner;
}

static bool same_place(const double *a, const double *b)
{
    return a[0] == b[0] && a[1] == b[1];
}

/* Twice the area over the sum of the squared sides: greatest for equal sides. */
static double measure_shape(const double *a, const double *b, const double *c)
{
    double ux = b[0] - a[0], uy = b[1] - a[1], vx = c[0] - b[0], vy = c[1] - b[1], wx = a[0] - c[0], wy = a[1] - c[1];
    double sides = ux * ux + uy * uy + vx * vx + vy * vy + wx * wx + wy * wy;
    return sides > 0 ? (ux * vy - uy * vx) / sides : 0;
}

/* --- the tree of corners ------------------------------------------------------------------------------------------ */

static corner_box bound_leaf(const ear_cutting *cutting, uint32_t leaf)
{
    corner_box box = {{INFINITY, INFINITY}, {-INFINITY, -INFINITY}};
    for (uint64_t i = (uint64_t)leaf * LEAF; i < (leaf + 1ull) * LEAF && i < cutting->count; i++) {
        const double *p = at(cutting, (uint32_t)i);
        for (int k = 0; k < 2 && cutting->next[i] < cutting->count; k++) {
            box.lo[k] = fmin(box.lo[k], p[k]);
            box.hi[k] = fmax(box.hi[k], p[k]);
        }
    }
    return box;
}

static void join_children(ear_cutting *cutting, uint32_t node)
{
    const corner_box *children = cutting->boxes + 2 * (size_t)node;
    for (int k = 0; k < 2; k++) {
        cutting->boxes[node].lo[k] = fmin(children[0].lo[k], children[1].lo[k]);
        cutting->boxes[node].hi[k] = fmax(children[0].hi[k], children[1].hi[k]);
    }
}

static void build_tree(ear_cutting *cutting)
{
    for (uint32_t leaf = 0; leaf < cutting->leaf_count; leaf++)
        cutting->boxes[cutting->leaf_count + leaf] = bound_leaf(cutting, leaf);
    for (uint32_t node = cutting->leaf_count - 1; node > 0; node--)
        join_children(cutting, node);
}

static void shrink_tree(ear_cutting *cutting, uint32_t corner)
{
    uint32_t node = cutting->leaf_count + corner / LEAF;
    cutting->boxes[node] = bound_leaf(cutting, corner / LEAF);
    while ((node /= 2) > 0)
        join_children(cutting, node);
}

/* The triangle of an ear, and the least turn at which a corner counts as inside. */
typedef struct ear_triangle {
    const double *corner[3];
    uint32_t number[3];
    corner_box box;
    int least;
} ear_triangle;

/* Whether c lies surely to the right of the line from a to b: the filter of hewn_orient2d() without what follows. */
static bool surely_right(const double a[2], const double b[2], const double c[2])
{
    double left = (a[0] - c[0]) * (b[1] - c[1]), right = (a[1] - c[1]) * (b[0] - c[0]);
    return right - left > 0x1p-51 * (fabs(left) + fabs(right) + HEWN_PREDICATE_TINY);
}

/* False only where all of a box is outside: beside the triangle's box, or beyond one of its sides. The box's corner
 * that is farthest to the inner side decides for all. */
static bool box_may_meet(const corner_box *box, const ear_triangle *ear)
{
    for (int k = 0; k < 2; k++)
        if (!(box->lo[k] <= ear->box.hi[k] && box->hi[k] >= ear->box.lo[k]))
            return false;
    for (int side = 0; side < 3; side++) {
        const double *a = ear->corner[side], *b = ear->corner[(side + 1) % 3];
        double innermost[2] = {b[1] > a[1] ? box->lo[0] : box->hi[0], b[0] > a[0] ? box->hi[1] : box->lo[1]};
        if (surely_right(a, b, innermost))
            return false;
    }
    return true;
}

static bool leaf_meets(const ear_cutting *cutting, uint32_t leaf, const ear_triangle *ear)
{
    const double *a = ear->corner[0], *b = ear->corner[1], *c = ear->corner[2];
    for (uint64_t i = (uint64_t)leaf * LEAF; i < (leaf + 1ull) * LEAF && i < cutting->count; i++) {
        const double *p = at(cutting, (uint32_t)i);
        if (cutting->next[i] == cutting->count || same_place(p, a) || same_place(p, b) || same_place(p, c))
            continue;
        if (hewn_orient2d(a, b, p) >= ear->least && hewn_orient2d(b, c, p) >= ear->least &&
            hewn_orient2d(c, a, p) >= ear->least)
            return true;
    }
    return false;
}

/* Whether a corner that is left, but for the ear's own and those in the same places, lies in the ear. */
static bool holds_corner(ear_cutting *cutting, uint32_t corner)
{
    ear_triangle ear = {.least = cutting->demand == DEMAND_EMPTY ? 0 : 1};
    ear.corner[0] = at(cutting, cutting->prev[corner]);
    ear.corner[1] = at(cutting, corner);
    ear.corner[2] = at(cutting, cutting->next[corner]);
    for (int k = 0; k < 2; k++) {
        ear.box.lo[k] = fmin(ear.corner[0][k], fmin(ear.corner[1][k], ear.corner[2][k]));
        ear.box.hi[k] = fmax(ear.corner[0][k], fmax(ear.corner[1][k], ear.corner[2][k]));
    }
    uint32_t stack[64], depth = 1;
    stack[0] = 1;
    while (depth > 0 && cutting->work > 0) {
        uint32_t node = stack[--depth];
        uint64_t cost = node < cutting->leaf_count ? 1 : LEAF / 2;
        cutting->work = cutting->work > cost ? cutting->work - cost : 0;
        if (!box_may_meet(&cutting->boxes[node], &ear))
            continue;
        if (node < cutting->leaf_count) {
            stack[depth++] = 2 * node;
            stack[depth++] = 2 * node + 1;
        } else if (leaf_meets(cutting, node - cutting->leaf_count, &ear)) {
            return true;
        }
    }
    return false;
}

/* --- the heap of ears --------------------------------------------------------------------------------------------- */

static bool goes_before(const heap_entry *a, const heap_entry *b)
{
    return a->key > b->key || (a->key == b->key && a->corner < b->corner);
}

static void push(ear_cutting *cutting, heap_entry entry)
{
    uint32_t i = cutting->heap_count++;
    for (; i > 0 && goes_before(&entry, &cutting->heap[(i - 1) / 2]); i = (i - 1) / 2)
        cutting->heap[i] = cutting->heap[(i - 1) / 2];
    cutting->heap[i] = entry;
}

static heap_entry pop(ear_cutting *cutting)
{
    heap_entry top = cutting->heap[0], last = cutting->heap[--cutting->heap_count];
    uint64_t i = 0, count = cutting->heap_count;
    for (uint64_t child; (child = 2 * i + 1) < count; i = child) {
        child += child + 1 < count && goes_before(&cutting->heap[child + 1], &cutting->heap[child]);
        if (!goes_before(&cutting->heap[child], &last))
            break;
        cutting->heap[i] = cutting->heap[child];
    }
    cutting->heap[i] = last;
    return top;
}

/* A number from 0 to below 0.25 that differs from way to way: what ears are preferred for where shape led nowhere. */
static double whim(const ear_cutting *cutting, uint32_t corner)
{
    uint32_t hash = (corner + 1) * 0x9e3779b9u ^ cutting->way * 0x85ebca6bu;
    hash = (hash ^ hash >> 15) * 0x2c1b3c6du;
    hash = (hash ^ hash >> 12) * 0x297a2d39u;
    return cutting->way == 0 ? 0 : (hash ^ hash >> 15) * 0x1p-34;
}

static bool is_ear(ear_cutting *cutting, uint32_t corner)
{
    const double *a = at(cutting, cutting->prev[corner]), *b = at(cutting, corner),
                 *c = at(cutting, cutting->next[corner]);
    if (cutting->demand == DEMAND_NONE)
        return true;
    return hewn_orient2d(a, b, c) > 0 && (cutting->demand == DEMAND_CONVEX || !holds_corner(cutting, corner));
}

static void look_at(ear_cutting *cutting, uint32_t corner)
{
    uint32_t before = cutting->prev[corner], after = cutting->next[corner];
    if (cutting->forbidden[corner] || !is_ear(cutting, corner))
        return;
    double shape = measure_shape(at(cutting, before), at(cutting, corner), at(cutting, after));
    push(cutting, (heap_entry){shape + whim(cutting, corner), corner, before, after});
}

static void look_at_all(ear_cutting *cutting, uint32_t start)
{
    uint32_t i = start;
    cutting->heap_count = 0;
    do {
        look_at(cutting, i);
        i = cutting->next[i];
    } while (i != start);
}

/* The best ear that may be cut, `count` where there is none. */
static uint32_t take_ear(ear_cutting *cutting)
{
    while (cutting->heap_count > 0) {
        heap_entry top = pop(cutting);
        uint32_t ear = top.corner;
        if (cutting->next[ear] != top.after || cutting->prev[ear] != top.before || cutting->forbidden[ear])
            continue;
        if (!cutting->may_join || cutting->may_join(cutting->user, top.before, top.after))
            return ear;
        cutting->forbidden[ear] = true;
    }
    return cutting->count;
}

/* --- cutting ------------------------------------------------------------------------------------------------------ */

/* Whether there are ears of the present kind that must not be cut. */
static bool is_refused(ear_cutting *cutting, uint32_t start)
{
    bool refused = false;
    uint32_t i = start;
    do {
        refused = cutting->forbidden[i] && is_ear(cutting, i);
        i = cutting->next[i];
    } while (i != start && !refused);
    return refused;
}

static void cut(ear_cutting *cutting, uint32_t ear)
{
    uint32_t before = cutting->prev[ear], after = cutting->next[ear];
    cutting->next[before] = after;
    cutting->prev[after] = before;
    cutting->next[ear] = cutting->count;
    cutting->forbidden[before] = cutting->forbidden[after] = false;
    shrink_tree(cutting, ear);
    look_at(cutting, before);
    look_at(cutting, after);
}

static void begin(ear_cutting *cutting, uint32_t way)
{
    for (uint32_t i = 0; i < cutting->count; i++) {
        cutting->next[i] = i + 1 < cutting->count ? i + 1 : 0;
        cutting->prev[i] = i > 0 ? i - 1 : cutting->count - 1;
        cutting->forbidden[i] = false;
    }
    cutting->way = way;
    cutting->demand = DEMAND_EMPTY;
    build_tree(cutting);
    look_at_all(cutting, 0);
}

/* One way of cutting. In a proper polygon a cut changes only the ears beside it; in others a corner that left may have
 * been the only one that an ear held, so where no ear is left all are looked at again before less is asked of them. */
static bool try_cutting(ear_cutting *cutting, uint32_t way, uint32_t *order)
{
    bool fresh = true;
    begin(cutting, way);
    for (uint32_t left = cutting->count, start = 0; left > 3;) {
        uint32_t ear = take_ear(cutting);
        if (ear < cutting->count) {
            order[cutting->count - left--] = ear;
            start = cutting->next[ear];
            cut(cutting, ear);
            fresh = false;
            if (cutting->demand == DEMAND_EMPTY || left > SMALL_POLYGON)
                continue;
            cutting->demand = DEMAND_EMPTY;
        } else if (!fresh) {
            fresh = true;
        } else if (is_refused(cutting, start) || ++cutting->demand == DEMAND_COUNT) {
            return false;
        }
        look_at_all(cutting, start);
    }
    return true;
}

/* All arrays in one block: most polygons are small. */
static void *make_room(ear_cutting *cutting)
{
    size_t count = cutting->count;
    cutting->leaf_count = 1;
    while ((size_t)cutting->leaf_count * LEAF < count)
        cutting->leaf_count *= 2;
    size_t boxes = 2 * (size_t)cutting->leaf_count * sizeof *cutting->boxes, heap = 3 * count * sizeof *cutting->heap;
    char *block = hewn_alloc(boxes + heap + count * (2 * sizeof *cutting->next + sizeof *cutting->forbidden), 1);
    if (!block)
        return NULL;
    cutting->boxes = (corner_box *)(void *)block;
    cutting->heap = (heap_entry *)(void *)(block + boxes);
    cutting->next = (uint32_t *)(void *)(block + boxes + heap);
    cutting->prev = cutting->next + count;
    cutting->forbidden = (bool *)(void *)(cutting->prev + count);
    return block;
}

hewn_result hewn_ears_cut(const double *plane, uint32_t count, hewn_may_join may_join, const void *user,
                          uint32_t *order, bool *found, hewn_error *error)
{
    *found = count <= 3;
    if (count == 4) {
        uint32_t from = hewn_quad_cut(plane, may_join, user);
        *found = from < 2;
        order[0] = 1 - (from & 1);
    }
    if (count <= 4)
        return HEWN_OK;
    ear_cutting cutting = {
        .plane = plane, .count = count, .may_join = may_join, .user = user, .work = most_work(count)};
    void *block = make_room(&cutting);
    if (!block)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory cutting a polygon of %u corners", count);
    for (uint32_t way = 0; !*found && way <= count && way < MOST_TRIES; way++)
        *found = try_cutting(&cutting, way, order);
    hewn_free(block);
    return HEWN_OK;
}

/* --- quadrilaterals ----------------------------------------------------------------------------------------------- */

uint32_t hewn_quad_cut(const double plane[8], hewn_may_join may_join, const void *user)
{
    int inside[2];
    double shape[2];
    for (uint32_t from = 0; from < 2; from++) {
        const double *a = plane, *b = plane + 2, *c = plane + 4, *d = plane + 6;
        const double *first = from == 0 ? c : d, *second = from == 0 ? a : b; /* (a, b, first), (second, c, d) */
        int turn = hewn_orient2d(a, b, first), other = hewn_orient2d(second, c, d);
        inside[from] = turn < other ? turn : other;
        shape[from] = fmin(measure_shape(a, b, first), measure_shape(second, c, d));
    }
    uint32_t better = inside[1] > inside[0] || (inside[1] == inside[0] && shape[1] > shape[0]);
    if (!may_join || may_join(user, better, better + 2))
        return better;
    return inside[0] == inside[1] && may_join(user, 1 - better, 3 - better) ? 1 - better : 2;
}
