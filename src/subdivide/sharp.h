/* Sharpness, and which rule it makes a vertex follow. */
#ifndef HEWN_SRC_SUBDIVIDE_SHARP_H
#define HEWN_SRC_SUBDIVIDE_SHARP_H

#include "subdivide/level.h"

typedef enum sub_rule { SUB_SMOOTH, SUB_DART, SUB_CREASE, SUB_CORNER } sub_rule;

/* How a vertex is refined: by `rule`, or, where some of its sharpness ends within this level, by a mixture of that and
 * the rule that its child has. ends: the other vertices of the two sharp edges of a crease. */
typedef struct sub_vert_rule {
    sub_rule rule, child;
    uint32_t ends[2], child_ends[2];
    double share; /* of `rule` */
} sub_vert_rule;

/* One level later. */
static inline float sub_decrease(float sharpness)
{
    return sharpness >= SHARP_FOREVER ? sharpness : sharpness > 1 ? sharpness - 1 : 0;
}

/* The sharpness of the half of an edge that stays at vertex v. */
float hewn_sub_child_sharpness(const sub_level *level, uint32_t edge, uint32_t v, hewn_creasing creasing);

/* The share of the midpoint in the point of an edge; the rest, which may be negative, is that of the smooth rule. */
double hewn_sub_edge_share(const sub_level *level, uint32_t edge, hewn_creasing creasing);

sub_vert_rule hewn_sub_rule_of(const sub_level *level, uint32_t v, hewn_creasing creasing);

#endif
