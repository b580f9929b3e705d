#include "render/octree.h"

#include <math.h>
#include <sched.h>

#include "base/alloc.h"
#include "base/error.h"

/* Cells are halved where tapes are long until they are 2^-6 of the box, and where they are short to 2^-4. */
enum { LEVELS = 6, LEVELS_SHORT = 8, SHORT = 32, CHILDREN = 8, ACROSS = 1 << LEVELS };

/* Of numbers in the lattice. */
#define IS_MADE 0x80000000U

/* The last two levels have most of the cells, and rays see few of them. */
enum { LEVELS_AT_ONCE = LEVELS - 2 };

static void box_child(const hewn_cell *cell, uint32_t child, float lo[3], float hi[3])
{
    for (int axis = 0; axis < 3; axis++) {
        float middle = 0.5F * (cell->lo[axis] + cell->hi[axis]);
        bool upper = child >> axis & 1;
        lo[axis] = upper ? middle : cell->lo[axis];
        hi[axis] = upper ? cell->hi[axis] : middle;
    }
}

/* Of a cell's children. */
enum { NOT_DIVIDED, IN_DIVISION, DIVIDED };

/* The eight cells of one, and the tapes of those that nothing is decided of. */
static hewn_result divide(const hewn_octree *octree, const hewn_cell *cell, hewn_lane_work *work, hewn_cell *children,
                          hewn_error *error)
{
    hewn_lane_boxes boxes;
    float lo[HEWN_LANES], hi[HEWN_LANES];
    for (uint32_t i = 0; i < CHILDREN; i++) {
        children[i].tape = cell->tape;
        children[i].owner = cell->owner;
        box_child(cell, i, children[i].lo, children[i].hi);
        for (int axis = 0; axis < 3; axis++) {
            boxes.lo[axis][i] = children[i].lo[axis] - octree->margin;
            boxes.hi[axis][i] = children[i].hi[axis] + octree->margin;
        }
    }
    hewn_lanes_bound(cell->tape, work, &boxes, CHILDREN, lo, hi);
    for (uint32_t i = 0; i < CHILDREN; i++) {
        children[i].state = lo[i] > 0 ? HEWN_CELL_EMPTY : hi[i] < 0 ? HEWN_CELL_FULL : HEWN_CELL_MIXED;
        children[i].least = lo[i];
    }
    uint32_t owners = 0;
    hewn_result result = HEWN_OK;
    for (uint32_t i = 0; i < CHILDREN; i++) {
        if (lo[i] > -INFINITY)
            result = result == HEWN_OK ? hewn_lane_tape_cut(cell->tape, work, i, &children[i].own, error) : result;
        if (children[i].own) {
            children[i].tape = children[i].own;
            children[i].owner = cell->children + i;
            owners++;
        }
        children[i].is_long = hewn_lane_tape_length(children[i].tape) > SHORT;
    }
    if (owners == CHILDREN && !octree->is_whole) /* nobody goes by its tape any more */
        hewn_lane_tape_destroy(&octree->cells[children->parent].own);
    return result;
}

static bool is_divided(const hewn_cell *cell, uint32_t level)
{
    return cell->state == HEWN_CELL_MIXED && level < (cell->is_long ? LEVELS : LEVELS_SHORT);
}

/* Gives places to the children of cells first..end that are divided, which of those that are not made yet all may be.
 */
static hewn_result make_room(hewn_octree *octree, size_t first, size_t end, uint32_t level, hewn_error *error)
{
    size_t count = octree->count;
    bool all = first >= octree->made;
    for (size_t i = first; i < end; i++)
        count += all || is_divided(&octree->cells[i], level) ? CHILDREN : 0;
    if (count >= IS_MADE)
        return hewn_fail(error, HEWN_LIMIT, "the field has too many cells");
    HEWN_TRY(hewn_reserve((void **)&octree->cells, &octree->capacity, count, sizeof *octree->cells, error));
    for (size_t i = first; i < end; i++)
        if (all || is_divided(&octree->cells[i], level)) {
            octree->cells[i].children = (uint32_t)octree->count;
            for (uint32_t k = 0; k < CHILDREN; k++)
                octree->cells[octree->count++] = (hewn_cell){.parent = (uint32_t)i};
        }
    return HEWN_OK;
}

static hewn_result divide_level(hewn_octree *octree, size_t first, size_t end, hewn_error *error)
{
    hewn_result all = HEWN_OK;
    hewn_error reason = {0};
#pragma omp parallel
    {
        hewn_lane_work work;
        hewn_error own = {0};
        hewn_result result = hewn_lane_work_create(octree->whole, &work, &own);
#pragma omp for schedule(dynamic, 16)
        for (size_t i = first; i < end; i++) {
            hewn_cell *cell = &octree->cells[i];
            if (cell->children != 0 && result == HEWN_OK)
                result = divide(octree, cell, &work, &octree->cells[cell->children], &own);
        }
#pragma omp critical(hewn_octree)
        if (result != HEWN_OK && all == HEWN_OK) {
            all = result;
            reason = own;
        }
        hewn_lane_work_destroy(&work);
    }
    if (all != HEWN_OK && error)
        *error = reason;
    return all;
}

static hewn_result grow(hewn_octree *octree, const hewn_box *box, bool whole, hewn_error *error)
{
    HEWN_TRY(hewn_reserve((void **)&octree->cells, &octree->capacity, 1, sizeof *octree->cells, error));
    octree->cells[0] = (hewn_cell){.tape = octree->whole, .state = HEWN_CELL_MIXED, .least = -INFINITY};
    octree->count = octree->made = 1;
    octree->is_whole = whole;
    double most = 0, far = 0;
    for (int axis = 0; axis < 3; axis++) {
        octree->cells[0].lo[axis] = (float)box->lo[axis];
        octree->cells[0].hi[axis] = (float)box->hi[axis];
        most = fmax(most, box->hi[axis] - box->lo[axis]);
        far = fmax(far, fmax(fabs(box->lo[axis]), fabs(box->hi[axis])));
    }
    octree->margin = (float)(HEWN_CELL_MARGIN * most / (1 << LEVELS) + 1e-6 * far);
    size_t first = 0;
    for (uint32_t level = 0; level < LEVELS; level++) {
        size_t end = octree->count;
        HEWN_TRY(make_room(octree, first, end, level, error));
        if (whole || level < LEVELS_AT_ONCE) {
            HEWN_TRY(divide_level(octree, first, end, error));
            octree->made = octree->count;
        }
        first = end;
    }
    octree->divided = hewn_alloc_zero(octree->count, sizeof *octree->divided);
    if (!octree->divided)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the cells of a field");
    return HEWN_OK;
}

/* Enters a cell of level `level` whose first part of the lattice is `at`. */
static void enter(hewn_octree *octree, uint32_t number, const uint32_t at[3], uint32_t level)
{
    uint32_t across = (uint32_t)ACROSS >> level, entry = number < octree->made ? number | IS_MADE : number;
    for (uint32_t z = at[2]; z < at[2] + across; z++)
        for (uint32_t y = at[1]; y < at[1] + across; y++)
            for (uint32_t x = at[0]; x < at[0] + across; x++)
                atomic_init(&octree->finest[x + ACROSS * (y + (size_t)ACROSS * z)], entry);
}

static void enter_below(hewn_octree *octree, uint32_t number, const uint32_t at[3], /* NOLINT(misc-no-recursion) */
                        uint32_t level)
{
    uint32_t children = octree->cells[number].children;
    if (children == 0) {
        enter(octree, number, at, level);
        return;
    }
    for (uint32_t i = 0; i < CHILDREN; i++) {
        uint32_t half = (uint32_t)ACROSS >> (level + 1);
        const uint32_t to[3] = {at[0] + (i & 1) * half, at[1] + (i >> 1 & 1) * half, at[2] + (i >> 2) * half};
        enter_below(octree, children + i, to, level + 1);
    }
}

static hewn_result make_lattice(hewn_octree *octree, hewn_error *error)
{
    octree->finest = hewn_alloc((size_t)ACROSS * ACROSS * ACROSS, sizeof *octree->finest);
    if (!octree->finest)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the cells of a field");
    for (int axis = 0; axis < 3; axis++)
        octree->scale[axis] = ACROSS / (octree->cells[0].hi[axis] - octree->cells[0].lo[axis]);
    enter_below(octree, 0, (const uint32_t[3]){0, 0, 0}, 0);
    return HEWN_OK;
}

hewn_result hewn_octree_create(const hewn_field *field, hewn_node root, const hewn_box *box, bool whole,
                               hewn_octree *out, hewn_error *error)
{
    *out = (hewn_octree){0};
    HEWN_TRY(hewn_lane_tape_create(field, root, &out->whole, error));
    hewn_result result = grow(out, box, whole, error);
    if (result == HEWN_OK)
        result = make_lattice(out, error);
    if (result != HEWN_OK)
        hewn_octree_destroy(out);
    return result;
}

void hewn_octree_destroy(hewn_octree *octree)
{
    for (size_t i = 0; i < octree->count; i++)
        hewn_lane_tape_destroy(&octree->cells[i].own);
    hewn_free(octree->cells);
    hewn_free(octree->finest);
    hewn_free(octree->divided);
    hewn_lane_tape_destroy(&octree->whole);
    *octree = (hewn_octree){0};
}

/* What runs out of memory goes on with the tape of the larger cell, which is as right. */
static void see_divided(const hewn_octree *octree, hewn_lane_work *work, uint32_t number)
{
    atomic_uchar *divided = &octree->divided[number];
    unsigned char before = NOT_DIVIDED;
    if (atomic_load_explicit(divided, memory_order_acquire) == DIVIDED)
        return;
    if (atomic_compare_exchange_strong(divided, &before, IN_DIVISION)) {
        const hewn_cell *cell = &octree->cells[number];
        (void)divide(octree, cell, work, &octree->cells[cell->children], NULL);
        atomic_store(divided, DIVIDED);
    }
    while (atomic_load(divided) != DIVIDED)
        sched_yield();
}

/* Where in the lattice a point is: rounding takes it beyond its cell by less than the margin. */
static atomic_uint *entry_at(const hewn_octree *octree, const float p[3])
{
    uint32_t at[3];
    for (int axis = 0; axis < 3; axis++) {
        float place = (p[axis] - octree->cells[0].lo[axis]) * octree->scale[axis];
        at[axis] = place > 0 ? place < ACROSS - 1 ? (uint32_t)place : ACROSS - 1U : 0;
    }
    return &octree->finest[at[0] + ACROSS * (at[1] + (size_t)ACROSS * at[2])];
}

const hewn_cell *hewn_octree_find(const hewn_octree *octree, const float p[3])
{
    return &octree->cells[atomic_load_explicit(entry_at(octree, p), memory_order_relaxed) & ~IS_MADE];
}

/* Makes the cell of an entry, or finds that its parent stays whole. */
static const hewn_cell *make_cell(const hewn_octree *octree, hewn_lane_work *work, uint32_t number)
{
    uint32_t parent = octree->cells[number].parent;
    see_divided(octree, work, octree->cells[parent].parent);
    if (!is_divided(&octree->cells[parent], LEVELS - 1))
        return &octree->cells[parent];
    see_divided(octree, work, parent);
    return &octree->cells[number];
}

/* The release and acquire of an entry make what a cell holds seen by whoever reads its number. */
const hewn_cell *hewn_octree_reach(const hewn_octree *octree, hewn_lane_work *work, const float p[3])
{
    atomic_uint *entry = entry_at(octree, p);
    uint32_t number = atomic_load_explicit(entry, memory_order_acquire);
    if (number & IS_MADE)
        return &octree->cells[number & ~IS_MADE];
    const hewn_cell *cell = make_cell(octree, work, number);
    atomic_store_explicit(entry, (uint32_t)(cell - octree->cells) | IS_MADE, memory_order_release);
    return cell;
}
