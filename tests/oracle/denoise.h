/* What smoothing does to a noisy shape whose clean one is known: the noise that is left, and how sharp edges change. */
#ifndef HEWN_TEST_DENOISE_H
#define HEWN_TEST_DENOISE_H

#include <stddef.h>

#include "hewn/model.h"

/* An edge of two faces, with the angle in degrees by which they bend. */
typedef struct sharp_edge {
    uint32_t vertices[2], faces[2];
    double angle;
} sharp_edge;

/* The edges of a model of triangles that bend by more than `least` degrees. The caller frees them; NULL without
 * memory. */
sharp_edge *sharp_edges_find(const hewn_model *model, double least, size_t *count);

/* The median of how far sharp edges bend otherwise with other positions, in degrees. */
double sharp_edges_change(const hewn_model *model, const double *positions, const sharp_edge *edges, size_t count);

/* How far vertices lie from the planes of the true faces around them, as the root of the mean square: what of noise
 * shows, as sliding along the surface does not. */
double noise_left(const hewn_model *clean, const double *positions);

#endif
