/* Thresholds from a histogram. */
#ifndef HEWN_SRC_VOLUME_OTSU_H
#define HEWN_SRC_VOLUME_OTSU_H

#include "hewn/volume.h"

/* Threshold number `threshold` (from 1) of the `classes` - 1 that part a histogram so that the variance between classes
 * is greatest (Otsu 1979, "A threshold selection method from gray-level histograms"; Liao, Chen and Chung 2001, "A fast
 * algorithm for multilevel thresholding"), in the histogram's unit. It lies in the middle of the empty parts around it.
 * HEWN_BAD_INPUT where fewer parts than classes hold anything; HEWN_OUT_OF_MEMORY. */
hewn_result hewn_otsu(const hewn_volume_histogram *histogram, uint32_t threshold, uint32_t classes, double *out,
                      hewn_error *error);

#endif
