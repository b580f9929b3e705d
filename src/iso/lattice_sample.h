/* Samples of a lattice by their number in the volume. `type` is the volume's; where it is a constant, what remains
 * after inlining is the code for that type alone. */
#ifndef HEWN_SRC_ISO_LATTICE_SAMPLE_H
#define HEWN_SRC_ISO_LATTICE_SAMPLE_H

#include <math.h>

#include "iso/lattice.h"
#include "volume/voxel.h"

#define HEWN_LATTICE_INLINE static inline __attribute__((always_inline))

/* Larger values are taken for this, so that squares of differences are finite. */
#define HEWN_LATTICE_MOST 1e150

HEWN_LATTICE_INLINE double hewn_lattice_raw(const void *samples, uint64_t at, hewn_voxel type)
{
    switch (type) {
#define CASE(enumerator, type)                                                                                         \
    case enumerator: return (double)((const type *)samples)[at];
        HEWN_VOXEL_TYPES(CASE)
#undef CASE
    case HEWN_VOXEL_HALF: return (double)hewn_float_of_half(((const uint16_t *)samples)[at]);
    }
    return 0;
}

/* The field that is meshed, of a sample; 0 where that is not a number. */
HEWN_LATTICE_INLINE double hewn_lattice_field(const hewn_lattice *lattice, double raw, hewn_voxel type)
{
    double value = lattice->rise * (raw - lattice->level);
    if (type == HEWN_VOXEL_HALF || type == HEWN_VOXEL_FLOAT || type == HEWN_VOXEL_DOUBLE) {
        value = value > HEWN_LATTICE_MOST ? HEWN_LATTICE_MOST : value;
        value = value < -HEWN_LATTICE_MOST ? -HEWN_LATTICE_MOST : value;
        value = value != value ? 0 : value;
    }
    return value;
}

HEWN_LATTICE_INLINE double hewn_lattice_value(const hewn_lattice *lattice, uint64_t at, hewn_voxel type)
{
    return hewn_lattice_field(lattice, hewn_lattice_raw(lattice->volume->samples, at, type), type);
}

/* The same where its sign is that of the sample's bit, else 0: the level is rounded, the bits are not. */
HEWN_LATTICE_INLINE double hewn_lattice_agree(const hewn_lattice *lattice, double value, bool inside)
{
    bool below = inside != lattice->above;
    return (value < 0) == below ? value : 0;
}

HEWN_LATTICE_INLINE double hewn_lattice_signed(const hewn_lattice *lattice, uint64_t at, bool inside, hewn_voxel type)
{
    return hewn_lattice_agree(lattice, hewn_lattice_value(lattice, at, type), inside);
}

/* --- slopes ------------------------------------------------------------------------------------------------------- */

/* Samples that slopes look at on each side: what lies beyond the next one tells on which side there is a bend. */
enum { HEWN_LATTICE_REACH = 2 };

/* The field along an axis around a sample: value[2] is its own. */
typedef struct hewn_lattice_line {
    double value[2 * HEWN_LATTICE_REACH + 1];
    uint32_t before, after; /* samples that there are on each side, 2 at most; others have no value */
} hewn_lattice_line;

/* The difference between neighbours, central where there are samples on both sides. */
HEWN_LATTICE_INLINE double hewn_lattice_slope(const hewn_lattice_line *line)
{
    const double *f = line->value + HEWN_LATTICE_REACH;
    if (line->before > 0 && line->after > 0)
        return (f[1] - f[-1]) / 2;
    return line->after > 0 ? f[1] - f[0] : line->before > 0 ? f[0] - f[-1] : 0;
}

/* The gradient at a sample. Where planes are to meet, that of the smoother side counts for more, so that an edge of the
 * surface does not blur over its neighbours (after Liu, Osher and Chan 1994, 'Weighted essentially non-oscillatory
 * schemes'). */
static inline void hewn_lattice_gradient(const hewn_lattice *lattice, const hewn_lattice_line lines[3], double out[3])
{
    double size = 0;
    for (int axis = 0; axis < 3; axis++) {
        out[axis] = hewn_lattice_slope(&lines[axis]);
        size += out[axis] * out[axis];
    }
    for (int axis = 0; axis < 3 && lattice->planes; axis++) {
        const hewn_lattice_line *line = &lines[axis];
        const double *f = line->value + HEWN_LATTICE_REACH, smooth = 1e-4 * size;
        if (line->before == 0 || line->after == 0)
            continue;
        const double here = f[-1] - 2 * f[0] + f[1];
        const double below = line->before > 1 ? f[-2] - 2 * f[-1] + f[0] : here;
        const double above = line->after > 1 ? f[2] - 2 * f[1] + f[0] : here;
        const double a = smooth + below * below, b = smooth + above * above, most = a > b ? a : b;
        if (most > 0)
            out[axis] = ((f[0] - f[-1]) * (b / most) + (f[1] - f[0]) * (a / most)) / (a / most + b / most);
    }
}

#endif
