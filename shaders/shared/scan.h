/* What the host and the prefix sum's shaders agree on. A level is an array to be summed; each block of it gives one
 * value of the level above. Level 0 holds the caller's 32-bit values; in the others the high words of sums stand in an
 * array of their own, since sums may pass 2^32. */
#ifndef HEWN_SHADERS_SHARED_SCAN_H
#define HEWN_SHADERS_SHARED_SCAN_H

#include "shared/types.h"

#define HEWN_SCAN_GROUP 64u /* invocations of a workgroup */
#define HEWN_SCAN_ITEMS 32u /* values of an invocation */
#define HEWN_SCAN_BLOCK 2048u
#define HEWN_SCAN_ROW 32768u /* workgroups along x; further ones go along y */
#define HEWN_SCAN_LEVELS 4u  /* enough for 2^32 - 1 values */

/* How much there is of one level, as the device counts it. */
struct hewn_scan_level {
    HEWN_UINT groups[3]; /* of a dispatch with one workgroup a block; at least one */
    HEWN_UINT count;     /* values */
};

struct hewn_scan_push {
    HEWN_UINTS values; /* the level: low words */
    HEWN_UINTS highs;  /* high words of the level, or 0 where all are zero; only reduce looks at them */
    HEWN_UINTS sums;   /* the level above: written by reduce, read by apply; none (0) at the top of apply */
    HEWN_UINTS sum_highs;
    HEWN_UINTS counter; /* where the count stands, or 0: then it is `count` */
    HEWN_UINT count;
    HEWN_UINT pad;
};

struct hewn_scan_prepare_push {
    HEWN_UINTS counter; /* the caller's count */
    HEWN_UINTS levels;  /* out: HEWN_SCAN_LEVELS of hewn_scan_level */
    HEWN_UINT capacity;
    HEWN_UINT pad;
};

#endif
