/* Space cut into boxes with about as many points in each: a tree of planes (Bentley 1975, 'Multidimensional binary
 * search trees used for associative searching'), made from a sample of the points. */
#ifndef HEWN_SRC_OUTCORE_REGIONS_H
#define HEWN_SRC_OUTCORE_REGIONS_H

#include "hewn/base.h"

/* Points that stand for many: those whose number has a small hash, so that no order of the points matters. Zero is
 * empty. */
typedef struct hewn_sample {
    double *points; /* 3 each */
    uint64_t *hashes;
    size_t count, room;
    uint64_t most; /* the greatest hash that is still taken; 0: all are */
} hewn_sample;

/* Takes point `number` where its hash says so; the same points for the same numbers. HEWN_OUT_OF_MEMORY. The other
 * tells whether it would. */
bool hewn_sample_takes(const hewn_sample *sample, uint64_t number);
hewn_result hewn_sample_add(hewn_sample *sample, uint64_t number, const double point[3], hewn_error *error);
void hewn_sample_free(hewn_sample *sample);

/* A plane, or a leaf. */
typedef struct hewn_region_node {
    double at;       /* points below are in the first child */
    uint32_t second; /* the other child; the first follows its parent */
    uint32_t axis;   /* 3: a leaf, whose number is in `second` */
} hewn_region_node;

typedef struct hewn_regions {
    hewn_region_node *nodes;
    uint32_t node_count;
    uint32_t count; /* of leaves */
} hewn_regions;

/* Cuts into at most `count` regions, along the longest axis of the sample's box each time. `shift`, between -1/2 and
 * 1/2: by how much of a region every plane lies elsewhere than where it parts the points evenly. Orders the sample
 * anew. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_regions_make(hewn_sample *sample, uint32_t count, double shift, hewn_regions *out, hewn_error *error);
void hewn_regions_free(hewn_regions *regions);

/* The region that a point is in. */
uint32_t hewn_region_of(const hewn_regions *regions, const double point[3]);

#endif
