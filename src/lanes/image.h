/* A field over a plane, sample by sample: tiles that bounds decide are filled, in others the tape is cut down from
 * level to level before samples are computed. */
#ifndef HEWN_SRC_LANES_IMAGE_H
#define HEWN_SRC_LANES_IMAGE_H

#include "lanes/tape.h"

/* Samples are at (x[i], y[j], z) for column i and row j; both rise or both fall strictly, or are of one sample. */
typedef struct hewn_lane_image_desc {
    const float *x, *y;
    float z;
    uint32_t width, height;        /* 1 to 2^20 each */
    const hewn_progress *progress; /* or NULL; the stage is "evaluate" */
} hewn_lane_image_desc;

typedef struct hewn_lane_image_stats {
    uint64_t whole_steps; /* of the tape of the whole field */
    uint64_t value_steps; /* that were run for samples: a step at one sample each */
    uint64_t bound_steps; /* that were run for boxes, a step at one box each */
    uint64_t filled;      /* samples in tiles that bounds decided */
} hewn_lane_image_stats;

/* Whether the field is below 0 at each sample: bytes of 0 or 1, row by row. The same for any number of threads.
 * HEWN_OUT_OF_MEMORY, HEWN_CANCELLED, and what hewn_lane_tape_create() returns. */
hewn_result hewn_lanes_inside(const hewn_lane_tape *whole, const hewn_lane_image_desc *desc, uint8_t *inside,
                              hewn_lane_image_stats *stats, hewn_error *error);

/* The value at each sample, with the bits of the whole tape's. */
hewn_result hewn_lanes_values(const hewn_lane_tape *whole, const hewn_lane_image_desc *desc, float *values,
                              hewn_lane_image_stats *stats, hewn_error *error);

#endif
