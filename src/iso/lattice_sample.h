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

#endif
