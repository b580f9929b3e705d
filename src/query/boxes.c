#include <math.h>
#include <string.h>

#include "query/internal.h"

enum { PARTS = 8 };

hewn_search_box hewn_search_root(const hewn_query *query)
{
    const hewn_cell *root = query->octree.cells;
    hewn_search_box box = {.cell = 0, .tape = query->octree.whole};
    memcpy(box.lo, root->lo, sizeof box.lo);
    memcpy(box.hi, root->hi, sizeof box.hi);
    return box;
}

/* Cells of the octree were bounded when it was made. */
static uint32_t take_cells(hewn_asker *asker, const hewn_search_box *box, bool solid, hewn_search_box *parts)
{
    const hewn_octree *octree = &asker->query->octree;
    uint32_t first = octree->cells[box->cell].children, count = 0;
    for (uint32_t i = first; i < first + PARTS; i++) {
        const hewn_cell *cell = &octree->cells[i];
        bool full = cell->state == HEWN_CELL_FULL;
        if (cell->state == HEWN_CELL_EMPTY || (full && !solid))
            continue;
        hewn_search_box *part = &parts[count++];
        *part = (hewn_search_box){.lower = box->lower, .cell = i, .full = full, .tape = cell->tape};
        memcpy(part->lo, cell->lo, sizeof part->lo);
        memcpy(part->hi, cell->hi, sizeof part->hi);
    }
    return count;
}

static void split(const hewn_search_box *box, uint32_t which, hewn_search_box *part)
{
    *part = (hewn_search_box){.lower = box->lower, .cell = HEWN_NO_CELL, .full = box->full, .tape = box->tape};
    for (int axis = 0; axis < 3; axis++) {
        float middle = 0.5F * (box->lo[axis] + box->hi[axis]);
        bool upper = which >> axis & 1;
        part->lo[axis] = upper ? middle : box->lo[axis];
        part->hi[axis] = upper ? box->hi[axis] : middle;
    }
}

uint32_t hewn_search_divide(hewn_asker *asker, const hewn_search_box *box, bool solid, hewn_search_box parts[8])
{
    if (box->cell != HEWN_NO_CELL && asker->query->octree.cells[box->cell].children != 0)
        return take_cells(asker, box, solid, parts);
    hewn_lane_boxes boxes;
    float lo[HEWN_LANES], hi[HEWN_LANES];
    for (uint32_t i = 0; i < PARTS; i++) {
        split(box, i, &parts[i]);
        for (int axis = 0; axis < 3; axis++) {
            boxes.lo[axis][i] = parts[i].lo[axis];
            boxes.hi[axis][i] = parts[i].hi[axis];
        }
    }
    if (box->full)
        return PARTS;
    hewn_lanes_bound(box->tape, &asker->work, &boxes, PARTS, lo, hi);
    uint32_t count = 0;
    for (uint32_t i = 0; i < PARTS; i++) {
        if (lo[i] > 0 || (hi[i] < 0 && !solid))
            continue;
        parts[count] = parts[i];
        parts[count++].full = hi[i] < 0;
    }
    return count;
}
