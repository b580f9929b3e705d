/* Which splits stand on which, and how far the surface is off without each. */
#ifndef HEWN_SRC_PROGRESSIVE_HIERARCHY_H
#define HEWN_SRC_PROGRESSIVE_HIERARCHY_H

#include "progressive/stream.h"

/* Where a split matters: a sphere and a cone that hold those of its children, and an error that is no less than theirs,
 * so that what is decided against it is decided against them too. */
typedef struct progressive_region {
    double center[3], radius;
    double axis[3], angle; /* of normals; pi and more: all */
    double error;
} progressive_region;

/* Splits stand on coarser ones (`below`), which must be done before, and carry finer ones (`above`), which must be
 * folded before they are. Those of split i are at first[i] to first[i + 1] - 1. */
typedef struct progressive_links {
    uint32_t *first, *to;
} progressive_links;

/* A split makes two vertices of one; its children are the next splits of either (HEWN_NONE: none), its parent is the
 * last one before it that its own vertex took part in. Parents are among what a split stands on. */
typedef struct progressive_hierarchy {
    progressive_links below, above;
    uint32_t *parents, *children; /* 1 and 2 of each split */
    progressive_region *regions;
} progressive_hierarchy;

/* HEWN_OUT_OF_MEMORY, HEWN_LIMIT. Release it also after an error. */
hewn_result hewn_hierarchy_make(const hewn_progressive *from, progressive_hierarchy *out, hewn_error *error);
void hewn_hierarchy_release(progressive_hierarchy *of);

#endif
