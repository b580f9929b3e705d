/* Where the voxels of a volume are. */
#include <math.h>
#include <string.h>

#include "hewn/volume.h"

void hewn_volume_to_world(const hewn_volume *volume, const double ijk[3], double out[3])
{
    const double *m = volume->to_world;
    double from[3] = {ijk[0], ijk[1], ijk[2]};
    for (int row = 0; row < 3; row++)
        out[row] = m[4 * row] * from[0] + m[4 * row + 1] * from[1] + m[4 * row + 2] * from[2] + m[4 * row + 3];
}

void hewn_volume_spacing(const hewn_volume *volume, double out[3])
{
    const double *m = volume->to_world;
    for (int axis = 0; axis < 3; axis++)
        out[axis] = hypot(hypot(m[axis], m[4 + axis]), m[8 + axis]);
}

double hewn_volume_determinant(const hewn_volume *volume)
{
    const double *m = volume->to_world;
    return m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) +
           m[2] * (m[4] * m[9] - m[5] * m[8]);
}

void hewn_volume_from_world(const hewn_volume *volume, double out[12])
{
    const double *m = volume->to_world;
    double scale = 1 / hewn_volume_determinant(volume);
    for (int row = 0; row < 3; row++) {
        for (int column = 0; column < 3; column++) {
            /* The cofactor of the transposed place, cyclic indices giving its sign. */
            int a = (column + 1) % 3, b = (column + 2) % 3, c = (row + 1) % 3, d = (row + 2) % 3;
            out[4 * row + column] = scale * (m[4 * a + c] * m[4 * b + d] - m[4 * a + d] * m[4 * b + c]);
        }
        out[4 * row + 3] = -(out[4 * row] * m[3] + out[4 * row + 1] * m[7] + out[4 * row + 2] * m[11]);
    }
}

void hewn_volume_orientation(const hewn_volume *volume, char out[4])
{
    static const char letters[3][2] = {{'R', 'L'}, {'A', 'P'}, {'S', 'I'}};
    double spacing[3];
    bool axis_done[3] = {false}, side_done[3] = {false};
    memcpy(out, "???", 4);
    if (!volume->anatomical)
        return;
    hewn_volume_spacing(volume, spacing);
    for (int step = 0; step < 3; step++) { /* the clearest pair of those that are left */
        int axis = -1, side = -1;
        double most = -1;
        for (int i = 0; i < 9; i++) {
            double share = fabs(volume->to_world[4 * (i / 3) + i % 3]) / spacing[i % 3];
            if (!axis_done[i % 3] && !side_done[i / 3] && share > most) {
                most = share;
                axis = i % 3;
                side = i / 3;
            }
        }
        if (axis < 0)
            return;
        axis_done[axis] = side_done[side] = true;
        out[axis] = letters[side][volume->to_world[4 * side + axis] < 0];
    }
}

hewn_box hewn_volume_bounds(const hewn_volume *volume)
{
    hewn_box box = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (int corner = 0; corner < 8; corner++) {
        double ijk[3], at[3];
        for (int axis = 0; axis < 3; axis++)
            ijk[axis] = corner >> axis & 1 ? (double)volume->dims[axis] - 1 : 0;
        hewn_volume_to_world(volume, ijk, at);
        for (int axis = 0; axis < 3; axis++) {
            box.lo[axis] = at[axis] < box.lo[axis] ? at[axis] : box.lo[axis];
            box.hi[axis] = at[axis] > box.hi[axis] ? at[axis] : box.hi[axis];
        }
    }
    return box;
}
