/* Which samples of a volume are inside, as one comparison in the samples' own type. */
#ifndef HEWN_SRC_ISO_THRESHOLD_H
#define HEWN_SRC_ISO_THRESHOLD_H

#include "hewn/volume.h"

/* Samples in rising order are numbered by keys: integers by themselves, floats by their bits. A sample is inside where
 * its key is at least `key` (`least`), or at most `key`; none is where `none`. NaN is never inside. */
typedef struct hewn_threshold {
    bool none, least;
    int64_t key; /* of uint64: less 2^63 */
} hewn_threshold;

/* Inside is slope × sample + intercept >= iso or, with `below`, < iso, in double precision. */
hewn_threshold hewn_threshold_find(const hewn_volume *volume, double iso, bool below);

/* Writes 1 for each sample that is inside, else 0, for `count` samples from number `at` on (counted from frame 0). */
void hewn_threshold_apply(const hewn_threshold *threshold, const hewn_volume *volume, uint64_t at, size_t count,
                          uint8_t *out);

/* Eight bytes that are 0 or 1 become eight bits: the product moves byte i from bit 8 i to bit 56 + i, and no two of its
 * terms meet. */
static inline uint64_t hewn_threshold_pack_eight(const uint8_t *bytes)
{
    uint64_t eight = 0;
    for (int i = 0; i < 8; i++)
        eight |= (uint64_t)bytes[i] << 8 * i; /* one load where memory has this order */
    return eight * 0x0102040810204080u >> 56;
}

/* 64 of what hewn_threshold_apply() writes, a bit each. */
static inline uint64_t hewn_threshold_pack(const uint8_t bytes[64])
{
    uint64_t word = 0;
    for (int i = 0; i < 8; i++)
        word |= hewn_threshold_pack_eight(bytes + 8 * i) << 8 * i;
    return word;
}

#endif
