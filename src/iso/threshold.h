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

#endif
