/* Samples of fields and tables of outlines, brought to the device once for all kernels of a code. Private to this room.
 */
#ifndef HEWN_SRC_EVAL_SAMPLES_H
#define HEWN_SRC_EVAL_SAMPLES_H

#include "eval/listing.h"
#include "field/sampling.h"

typedef struct hewn_held_samples {
    hewn_sampling *sampling; /* or NULL: of a table, whose words these are */
    uint32_t *words;
    size_t word_count;
    hewn_buffer buffer;
} hewn_held_samples;

/* Zero is the empty one. */
typedef struct hewn_samples {
    hewn_held_samples *held;
    size_t count, capacity;
} hewn_samples;

/* Brings what the listing's steps read to the device, each sampling and table once, and writes the addresses into the
 * listing. HEWN_OUT_OF_DEVICE_MEMORY, HEWN_LIMIT, HEWN_OUT_OF_MEMORY, HEWN_DEVICE_LOST. */
hewn_result hewn_samples_bring(hewn_device *device, hewn_samples *samples, hewn_listing *listing, hewn_error *error);

/* Writes the addresses of what is there already; false where something is not. */
bool hewn_samples_find(const hewn_samples *samples, hewn_listing *listing);

void hewn_samples_destroy(hewn_device *device, hewn_samples *samples);

#endif
