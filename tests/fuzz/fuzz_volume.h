/* What the fuzzers of volume readers have in common: whatever the bytes are, reading them gives a volume that is valid,
 * whose samples can all be looked at, or an error and nothing. */
#ifndef HEWN_FUZZ_VOLUME_H
#define HEWN_FUZZ_VOLUME_H

#include <stdlib.h>
#include <string.h>

#include "io/volume/formats.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static inline void demand(bool holds)
{
    if (!holds)
        abort();
}

/* Everything that is found in a volume can be found in this one. */
static inline void demand_measurable(const hewn_volume *volume)
{
    hewn_volume_bricks bricks;
    hewn_volume_range range = hewn_volume_find_range(volume, volume->frame_count - 1);
    uint64_t size = hewn_volume_frame_size(volume);
    char orientation[4];
    double back[12], percentile;
    demand(range.finite_count + range.nan_count + range.infinite_count == size);
    hewn_volume_orientation(volume, orientation);
    hewn_volume_from_world(volume, back);
    demand(hewn_volume_find_bricks(volume, 0, &bricks, NULL) == HEWN_OK);
    hewn_volume_bricks_destroy(&bricks);
    if (range.finite_count > 0 && size % 16 == 0) { /* slow, so for some only */
        demand(hewn_volume_find_percentile(volume, volume->frame_count - 1, 50, &percentile, NULL) == HEWN_OK);
        demand(range.lo <= percentile && percentile <= range.hi);
    }
}

/* Reads the bytes as they are, and lets the reader take over a block of them. Readers that run in a process of their
 * own (io/volume/apart.h) take over nothing. */
static inline void fuzz_volume(hewn_volume_format_read read, bool apart, const void *data, size_t size)
{
    static const hewn_volume_read_desc desc = {.memory_limit = 1 << 24};
    uint32_t sum = 0;
    for (size_t i = 0; i < size; i++)
        sum = 31 * sum + ((const uint8_t *)data)[i];
    if (apart && sum % 32 != 0)
        return; /* a process takes a thousand times as long as a reader does */
    for (int owned = 0; owned < (apart ? 1 : 2); owned++) {
        char *copy = owned ? malloc(size > 0 ? size : 1) : NULL;
        if (copy)
            memcpy(copy, data, size);
        hewn_volume_source source = {.bytes = copy ? copy : data,
                                     .length = size,
                                     .name = "fuzz",
                                     .desc = &desc,
                                     .memory = copy,
                                     .memory_length = size};
        hewn_volume volume = {.frame_count = 1};
        hewn_error error = {0};
        hewn_result result = read(&source, &volume, &error);
        if (result == HEWN_OK) {
            demand(hewn_volume_check(&volume, NULL) == HEWN_OK);
            demand((uintptr_t)volume.samples % hewn_voxel_size(volume.type) == 0);
            demand_measurable(&volume);
        } else {
            const hewn_volume nothing = {0};
            demand(memcmp(&volume, &nothing, sizeof volume) == 0);
            demand(error.code == result && error.message[0] != '\0');
            demand(result == HEWN_BAD_INPUT || result == HEWN_LIMIT || result == HEWN_IO ||
                   result == HEWN_OUT_OF_MEMORY);
        }
        hewn_volume_destroy(&volume);
        hewn_volume_source_close(&source);
    }
}

#endif
