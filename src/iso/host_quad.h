/* How to cut the quad around a grid edge, on the host: the work of shaders/iso/quad.h, which says why. */
#ifndef HEWN_SRC_ISO_HOST_QUAD_H
#define HEWN_SRC_ISO_HOST_QUAD_H

#include "hewn/base.h"

typedef struct hewn_quad_cut {
    uint32_t turn; /* 0: along corners 0 and 2; 1: along 1 and 3 */
    bool fan;      /* neither stays in the quad's envelope, only a fan around a point of the edge does */
} hewn_quad_cut;

/* `low` and `high` are the grid edge's ends, `surface` where the surface crosses it, along `axis`. */
hewn_quad_cut hewn_quad_cut_find(const float corners[4][3], const float low[3], float high, float surface,
                                 uint32_t axis);

/* Where on the edge a fan has its middle. */
float hewn_quad_fan_height(float low, float high, float surface);

#endif
