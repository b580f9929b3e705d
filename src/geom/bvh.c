#include "geom/bvh.h"

#include <float.h>
#include <math.h>

#include "base/alloc.h"
#include "base/error.h"

/* Fewer triangles than this are not worth another thread. */
enum { ALONE = 1 << 14 };

/* A triangle on its way to its slot. */
typedef struct item {
    float centre[3];
    uint32_t triangle;
} item;

/* --- boxes -------------------------------------------------------------------------------------------------------- */

static float round_down(double value)
{
    float near = (float)value;
    return (double)near > value ? nextafterf(near, -INFINITY) : near;
}

static float round_up(double value)
{
    float near = (float)value;
    return (double)near < value ? nextafterf(near, INFINITY) : near;
}

void hewn_triangle_box(const hewn_triangle_view *mesh, uint32_t triangle, float lo[3], float hi[3])
{
    double point[3][3];
    for (int k = 0; k < 3; k++)
        hewn_triangle_point(mesh, mesh->corners[3 * (uint64_t)triangle + k], point[k]);
    for (int axis = 0; axis < 3; axis++) {
        double a = point[0][axis], b = point[1][axis], c = point[2][axis];
        double least = a < b ? a : b, most = a < b ? b : a;
        lo[axis] = round_down(c < least ? c : least);
        hi[axis] = round_up(c > most ? c : most);
    }
}

/* Halved, for no sum of two finite numbers may overflow; a double beyond the floats has an infinite box. */
static float middle(float lo, float hi)
{
    return 0.5F * (lo < -FLT_MAX ? -FLT_MAX : lo) + 0.5F * (hi > FLT_MAX ? FLT_MAX : hi);
}

/* The slots of block b that the level below fills. */
static int filled(uint64_t below, uint64_t block)
{
    uint64_t left = below - 4 * block;
    return left < 4 ? (int)left : 4;
}

/* No comparison with these holds, and fminf() and fmaxf() pass them by. Infinities would not do: they meet a box that
 * is infinite itself. */
static void empty_boxes(hewn_boxes4 *boxes)
{
    for (int axis = 0; axis < 3; axis++)
        for (int k = 0; k < 4; k++) {
            boxes->lo[axis][k] = NAN;
            boxes->hi[axis][k] = NAN;
        }
}

static void set_box(hewn_boxes4 *boxes, int k, const float lo[3], const float hi[3])
{
    for (int axis = 0; axis < 3; axis++) {
        boxes->lo[axis][k] = lo[axis];
        boxes->hi[axis][k] = hi[axis];
    }
}

static void box_triangles(const hewn_triangle_view *mesh, const hewn_bvh *bvh, uint64_t block)
{
    hewn_boxes4 *boxes = &bvh->level[0][block];
    empty_boxes(boxes);
    for (int k = 0; k < filled(mesh->triangle_count, block); k++) {
        float lo[3], hi[3];
        hewn_triangle_box(mesh, bvh->order[4 * block + k], lo, hi);
        set_box(boxes, k, lo, hi);
    }
}

static void box_blocks(const hewn_bvh *bvh, uint32_t level, uint64_t block)
{
    hewn_boxes4 *boxes = &bvh->level[level][block];
    empty_boxes(boxes);
    for (int k = 0; k < filled(bvh->block_count[level - 1], block); k++) {
        float lo[3], hi[3];
        hewn_boxes4_all(&bvh->level[level - 1][4 * block + k], lo, hi);
        set_box(boxes, k, lo, hi);
    }
}

/* --- order -------------------------------------------------------------------------------------------------------- */

/* A total order, so that the halves are the same sets whatever way they are found. */
static inline bool before(const item *a, const item *b, int axis)
{
    return a->centre[axis] < b->centre[axis] || (a->centre[axis] == b->centre[axis] && a->triangle < b->triangle);
}

static void swap(item *a, item *b)
{
    item held = *a;
    *a = *b;
    *b = held;
}

/* The median of three items at places that scatter, so that orders met in practice do not make it a bad one. */
static item choose_pivot(const item *items, uint64_t count, int axis)
{
    item chosen[3];
    for (uint64_t k = 0; k < 3; k++)
        chosen[k] = items[(count * (2 * k + 1) / 6 + (count * 0x9e3779b97f4a7c15u >> (40 + k)) % 7) % count];
    if (before(&chosen[1], &chosen[0], axis))
        swap(&chosen[0], &chosen[1]);
    if (before(&chosen[2], &chosen[1], axis))
        swap(&chosen[1], &chosen[2]);
    return before(&chosen[1], &chosen[0], axis) ? chosen[0] : chosen[1];
}

/* Moves the `least` first items along an axis to the front (Hoare's selection). */
static void select_items(item *items, uint64_t count, uint64_t least, int axis)
{
    while (count > 1 && least > 0 && least < count) {
        item pivot = choose_pivot(items, count, axis);
        uint64_t i = 0, j = count - 1;
        for (;;) {
            while (before(&items[i], &pivot, axis))
                i++;
            while (before(&pivot, &items[j], axis))
                j--;
            if (i >= j)
                break;
            swap(&items[i++], &items[j--]);
        }
        /* Items before i are not after the pivot, those from i on not before it; i is at least 1 unless the pivot is
         * the first of all, and then it is in place. */
        uint64_t low = i > 0 ? i : 1;
        if (least < low) {
            count = low;
        } else {
            items += low;
            count -= low;
            least -= low;
        }
    }
}

static int longest_axis(const item *items, uint64_t count)
{
    float lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (uint64_t i = 0; i < count; i++)
        for (int axis = 0; axis < 3; axis++) {
            float at = items[i].centre[axis];
            lo[axis] = at < lo[axis] ? at : lo[axis];
            hi[axis] = at > hi[axis] ? at : hi[axis];
        }
    int longest = 0;
    for (int axis = 1; axis < 3; axis++)
        if (0.5F * hi[axis] - 0.5F * lo[axis] > 0.5F * hi[longest] - 0.5F * lo[longest])
            longest = axis;
    return longest;
}

/* Orders items so that every aligned run of 4^k slots is a compact cluster. `capacity`, a power of two of at least
 * `count`, is how many slots the node has. */
static void arrange(item *items, uint64_t count, uint64_t capacity) /* NOLINT(misc-no-recursion) */
{
    while (capacity > 4) {
        capacity /= 2;
        if (count <= capacity)
            continue;
        select_items(items, count, capacity, longest_axis(items, count));
        item *rest = items + capacity;
        uint64_t rest_count = count - capacity;
#pragma omp task if (rest_count >= ALONE)
        arrange(rest, rest_count, capacity);
        count = capacity;
    }
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

static void fill_last(uint32_t *order, uint64_t count)
{
    for (uint64_t t = count; t % 4 != 0; t++)
        order[t] = order[count - 1];
}

static void fill_order(const hewn_triangle_view *mesh, item *items, uint32_t *order)
{
    uint64_t count = mesh->triangle_count, capacity = 4;
    while (capacity < count)
        capacity *= 2;
#pragma omp parallel if (count >= ALONE)
    {
#pragma omp for schedule(static)
        for (uint64_t t = 0; t < count; t++) {
            float lo[3], hi[3];
            hewn_triangle_box(mesh, (uint32_t)t, lo, hi);
            for (int axis = 0; axis < 3; axis++)
                items[t].centre[axis] = middle(lo[axis], hi[axis]);
            items[t].triangle = (uint32_t)t;
        }
#pragma omp single
        arrange(items, count, capacity);
#pragma omp for schedule(static)
        for (uint64_t t = 0; t < count; t++)
            order[t] = items[t].triangle;
    }
    fill_last(order, count);
}

static void fill_boxes(const hewn_triangle_view *mesh, const hewn_bvh *bvh)
{
#pragma omp parallel for schedule(static) if (mesh->triangle_count >= ALONE)
    for (uint64_t block = 0; block < bvh->block_count[0]; block++)
        box_triangles(mesh, bvh, block);
    for (uint32_t level = 1; level < bvh->level_count; level++) {
#pragma omp parallel for schedule(static) if (bvh->block_count[level] >= ALONE)
        for (uint64_t block = 0; block < bvh->block_count[level]; block++)
            box_blocks(bvh, level, block);
    }
}

/* `order` is NULL where there was no memory for it. */
static hewn_result build_levels(const hewn_triangle_view *mesh, uint32_t *order, hewn_bvh *out, hewn_error *error)
{
    uint64_t blocks = (mesh->triangle_count + 3) / 4, total = 0;
    *out = (hewn_bvh){.order = order};
    for (bool last = false; !last; blocks = (blocks + 3) / 4) {
        last = blocks == 1;
        out->block_count[out->level_count++] = blocks;
        total += blocks;
    }
    hewn_boxes4 *boxes = order ? hewn_alloc(total, sizeof *boxes) : NULL;
    if (!boxes) {
        hewn_free(order);
        *out = (hewn_bvh){0};
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the boxes of %llu triangles",
                         (unsigned long long)mesh->triangle_count);
    }
    for (uint32_t level = 0; level < out->level_count; level++) {
        out->level[level] = boxes;
        boxes += out->block_count[level];
    }
    fill_boxes(mesh, out);
    return HEWN_OK;
}

hewn_result hewn_bvh_build(const hewn_triangle_view *mesh, hewn_bvh *out, hewn_error *error)
{
    uint32_t *order = hewn_alloc(mesh->triangle_count + 3, sizeof *order);
    item *items = hewn_alloc(mesh->triangle_count, sizeof *items);
    if (order && items) {
        fill_order(mesh, items, order);
    } else {
        hewn_free(order);
        order = NULL;
    }
    hewn_free(items);
    return build_levels(mesh, order, out, error);
}

hewn_result hewn_bvh_build_along(const hewn_triangle_view *mesh, uint32_t *order, hewn_bvh *out, hewn_error *error)
{
    fill_last(order, mesh->triangle_count);
    return build_levels(mesh, order, out, error);
}

void hewn_bvh_free(hewn_bvh *bvh)
{
    hewn_free(bvh->order);
    hewn_free(bvh->level[0]);
    *bvh = (hewn_bvh){0};
}

/* --- walking ------------------------------------------------------------------------------------------------------ */

hewn_bvh_walk hewn_bvh_walk_begin(const hewn_bvh *bvh, const float lo[3], const float hi[3], uint64_t first)
{
    hewn_bvh_walk walk;
    walk.bvh = bvh;
    walk.first = first;
    for (int axis = 0; axis < 3; axis++) {
        walk.lo[axis] = lo[axis];
        walk.hi[axis] = hi[axis];
    }
    walk.depth = 1;
    walk.stack[0].block = 0;
    walk.stack[0].level = bvh->level_count - 1;
    return walk;
}

bool hewn_bvh_walk_next(hewn_bvh_walk *walk, uint64_t *block)
{
    while (walk->depth > 0) {
        walk->depth--;
        uint64_t at = walk->stack[walk->depth].block;
        uint32_t level = walk->stack[walk->depth].level;
        if (level == 0) {
            *block = at;
            return true;
        }
        unsigned meets = hewn_boxes4_meet(&walk->bvh->level[level][at], walk->lo, walk->hi);
        for (int k = 3; k >= 0; k--) {
            uint64_t child = 4 * at + k, end = (child + 1) << 2 * (level - 1);
            if ((meets >> k & 1) == 0 || end <= walk->first)
                continue;
            walk->stack[walk->depth].block = child;
            walk->stack[walk->depth++].level = level - 1;
        }
    }
    return false;
}
