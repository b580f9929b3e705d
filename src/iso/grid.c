#include "iso/grid.h"

#include <math.h>

#include "base/error.h"

/* Where a side is a whole number of cells but for rounding, it does not grow by one more. */
#define WHOLE_CELL_SLACK 1e-6

/* A level fine enough to start with has at most this many blocks along an axis. */
#define TOP_BLOCKS 16u

static hewn_result check_bounds(const hewn_box *bounds, hewn_error *error)
{
    for (int axis = 0; axis < 3; axis++) {
        double lo = bounds->lo[axis], hi = bounds->hi[axis];
        if (!isfinite(lo) || !isfinite(hi) || !(lo < hi))
            return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                             "bounds along %c run from %g to %g; they must be finite and grow", "xyz"[axis], lo, hi);
    }
    return HEWN_OK;
}

static hewn_result choose_cell(const hewn_extract_desc *desc, double *cell, hewn_error *error)
{
    double longest = 0;
    for (int axis = 0; axis < 3; axis++)
        longest = fmax(longest, desc->bounds.hi[axis] - desc->bounds.lo[axis]);
    if (desc->cell != 0) {
        if (!(desc->cell > 0) || !isfinite(desc->cell))
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a cell of side %g makes no sense", desc->cell);
        *cell = desc->cell;
    } else {
        *cell = longest / (desc->resolution ? desc->resolution : 128);
    }
    if (longest / *cell > HEWN_MAX_RESOLUTION + 0.5)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "%.0f cells on the longest side are more than the %u that are supported",
                         ceil(longest / *cell), HEWN_MAX_RESOLUTION);
    return HEWN_OK;
}

/* Vertices keep 2^-12 of a cell from grid points; floats at the bounds must be at least that fine. */
static hewn_result check_precision(const hewn_box *grown, double cell, hewn_error *error)
{
    for (int axis = 0; axis < 3; axis++) {
        double most = fmax(fabs(grown->lo[axis]), fabs(grown->hi[axis]));
        double spacing = ldexp(1.0, (int)floor(log2(most * (1 - 1e-7))) - 23);
        if (most > 1e30 || cell < 1e-30 || spacing > cell / 4096)
            return hewn_fail(
                error, HEWN_INVALID_ARGUMENT,
                "bounds reach %g along %c, too far from the origin for cells of %g: 32-bit positions there cannot "
                "tell the vertices of a cell apart; use larger cells or move the shape nearer",
                most, "xyz"[axis], cell);
    }
    return HEWN_OK;
}

hewn_result hewn_grid_lay(const hewn_extract_desc *desc, struct hewn_grid *out, hewn_box *grown, hewn_error *error)
{
    double cell = 0;
    *out = (struct hewn_grid){.open = desc->open, .rim = desc->open && hewn_method_is_dual(desc->method)};
    HEWN_TRY(check_bounds(&desc->bounds, error));
    HEWN_TRY(choose_cell(desc, &cell, error));
    for (int axis = 0; axis < 3; axis++) {
        double lo = desc->bounds.lo[axis], hi = desc->bounds.hi[axis];
        double cells = fmax(1, ceil((hi - lo) / cell - WHOLE_CELL_SLACK));
        double growth = cells * cell - (hi - lo);
        bool exact = fabs(growth) <= WHOLE_CELL_SLACK * cell;
        grown->lo[axis] = exact ? lo : lo - growth / 2;
        grown->hi[axis] = exact ? hi : hi + growth / 2;
        out->cells[axis] = (uint32_t)cells + 2 * out->rim;
        out->origin[axis] = (float)grown->lo[axis];
        out->far[axis] = (float)grown->hi[axis];
    }
    out->cell = (float)cell;
    return check_precision(grown, cell, error);
}

uint32_t hewn_grid_bricks(const struct hewn_grid *grid, int axis)
{
    uint32_t samples =
        grid->cells[axis] + grid->open; /* the last layer of a closed grid is outside: no brick needs it */
    return (samples + 7) / 8;
}

uint64_t hewn_grid_blocks(const struct hewn_grid *grid, uint32_t shrink, uint32_t blocks[3])
{
    uint64_t product = 1;
    for (int axis = 0; axis < 3; axis++) {
        blocks[axis] = (hewn_grid_bricks(grid, axis) + shrink - 1) / shrink;
        product *= blocks[axis];
    }
    return product;
}

uint32_t hewn_grid_levels(const struct hewn_grid *grid, uint32_t *levels, uint32_t top[3])
{
    uint32_t shrink = 1;
    for (*levels = 1;; (*levels)++, shrink *= HEWN_LEVEL_RATIO) {
        hewn_grid_blocks(grid, shrink, top);
        uint32_t most = top[0];
        for (int axis = 1; axis < 3; axis++)
            most = top[axis] > most ? top[axis] : most;
        if (most <= TOP_BLOCKS || *levels == HEWN_MAX_LEVELS)
            return 8 * shrink;
    }
}
