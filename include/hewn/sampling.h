/* Samplings: values on a lattice, as leaves of fields. A mesh file, a heightmap or another field is sampled once, and
 * what comes of it is a shape like any other: it can be moved, cut, blended and meshed.
 *
 * Between samples values are trilinear. Where nothing happens (no surface near), eight cells a side may be one large
 * cell: a sampling takes memory for the surface, not for the volume. */
#ifndef HEWN_SAMPLING_H
#define HEWN_SAMPLING_H

#include "hewn/field.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Never changed once it is made; may be read by any number of threads. Fields that use it hold it on their own. */
typedef struct hewn_sampling hewn_sampling;

HEWN_API void hewn_sampling_destroy(hewn_sampling **sampling);

/* What it takes in memory, on the host and again on a device. */
HEWN_API uint64_t hewn_sampling_size(const hewn_sampling *sampling);

/* --- as a field --------------------------------------------------------------------------------------------------- */

/* Where samples lie: sample (i, j, k) at origin + cell (i, j, k). */
typedef struct hewn_sampling_place {
    double origin[3];
    double cell;
} hewn_sampling_place;

/* The field of samples that are distances. Past the lattice values grow with the distance from it: a lower bound of the
 * distance to what lies in the lattice, as long as values at its sides are above 0. HEWN_NODE_NONE for no sampling, a
 * cell that is not above 0, places that are not finite. */
HEWN_API hewn_node hewn_sampled(hewn_field *field, const hewn_sampling *sampling, const hewn_sampling_place *place);

/* The land below heights: z less the height above (x, y), over the root of 1 + the square of the greatest slope, so
 * that it is a lower bound of the distance. The sampling is flat; samples are spread over `width` along x and `depth`
 * along y about the origin and multiplied by `height`. Past its sides the heights there carry on. */
HEWN_API hewn_node hewn_heights(hewn_field *field, const hewn_sampling *sampling, double width, double depth,
                                double height);

/* A flat sampling of `columns` x `rows` values, each at least 2, row by row from the one with the least y. Values are
 * finite. HEWN_BAD_INPUT names the first that is not; HEWN_INVALID_ARGUMENT, HEWN_LIMIT, HEWN_OUT_OF_MEMORY. */
HEWN_API hewn_result hewn_sampling_from_heights(const float *values, uint32_t columns, uint32_t rows,
                                                hewn_sampling **out, hewn_error *error);

#ifdef __cplusplus
}
#endif
#endif
