#include "voxelize/lattice.h"

#include <math.h>

#include "base/error.h"

enum { BRICK = HEWN_SAMPLING_BRICK };

hewn_result hewn_voxel_lattice_lay(const hewn_box *box, double cell, double margin, hewn_voxel_lattice *out,
                                   hewn_error *error)
{
    *out = (hewn_voxel_lattice){.place = {.cell = cell}, .brick_count = 1};
    if (!(cell > 0) || !isfinite(cell))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the cell must be above 0 and finite, not %g", cell);
    for (int i = 0; i < 3; i++) {
        double side = box->hi[i] - box->lo[i], far = fmax(fabs(box->lo[i]), fabs(box->hi[i]));
        if (!(side >= 0) || !isfinite(side))
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "there is no box to sample: along %c it goes from %g to %g",
                             "xyz"[i], box -> lo[i], box -> hi[i]);
        if (far > cell * 0x1p40)
            return hewn_fail(error, HEWN_LIMIT, "a cell of %g is too small for coordinates of %g", cell, far);
        double bricks = ceil((side / cell + 2 * margin) / BRICK);
        if (bricks > (double)HEWN_SAMPLING_CELLS_MOST / BRICK)
            return hewn_fail(error, HEWN_LIMIT, "a cell of %g makes %.0f cells along %c, more than %d", cell,
                             bricks * BRICK, "xyz"[i], (int)HEWN_SAMPLING_CELLS_MOST);
        out->bricks[i] = (uint32_t)fmax(bricks, 1);
        out->cells[i] = BRICK * out->bricks[i];
        out->brick_count *= out->bricks[i];
        out->place.origin[i] = 0.5 * (box->lo[i] + box->hi[i]) - 0.5 * out->cells[i] * cell;
    }
    return HEWN_OK;
}

void hewn_voxel_brick(const hewn_voxel_lattice *lattice, uint64_t brick, uint32_t out[3])
{
    out[0] = BRICK * (uint32_t)(brick % lattice->bricks[0]);
    out[1] = BRICK * (uint32_t)(brick / lattice->bricks[0] % lattice->bricks[1]);
    out[2] = BRICK * (uint32_t)(brick / ((uint64_t)lattice->bricks[0] * lattice->bricks[1]));
}

void hewn_voxel_point(const hewn_voxel_lattice *lattice, const double cells[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = lattice->place.origin[i] + lattice->place.cell * cells[i];
}

/* A band around a surface takes memory by the square of the resolution, all of space by its cube. */
hewn_result hewn_voxel_check_size(const hewn_voxel_lattice *lattice, uint64_t fine, uint64_t limit, hewn_error *error)
{
    uint64_t needed = hewn_sampling_bytes(lattice->cells, fine), most = limit ? limit : HEWN_VOXEL_MEMORY;
    if (needed <= most)
        return HEWN_OK;
    double share = (double)needed / (double)most;
    double power = 2 * fine < lattice->brick_count && fine > 0 ? 0.5 : 1.0 / 3;
    return hewn_fail(
        error, HEWN_LIMIT,
        "samples at a cell of %g take %.0f MiB, more than the %.0f MiB they may: a cell of about %.3g would "
        "do",
        lattice->place.cell, (double)needed * 0x1p-20, (double)most * 0x1p-20,
        1.05 * lattice->place.cell * pow(share, power));
}
