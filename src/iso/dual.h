/* A uniform dual surface on the host, with the crossings that it was made from: what adaptive collapse reads. */
#ifndef HEWN_SRC_ISO_DUAL_H
#define HEWN_SRC_ISO_DUAL_H

#include "hewn/base.h"

#include "shared/iso.h"

/* One vertex a loop of a cell, one quad a crossed grid edge that has four cells around it. Points and lengths are in
 * scene units. Whoever made the struct owns the arrays. */
typedef struct hewn_dual_surface {
    struct hewn_grid grid;
    uint64_t vertex_count;
    const uint32_t *cells;  /* 3 a vertex: the cell it lies in */
    const float *positions; /* 3 a vertex */
    const float *normals;   /* 3 a vertex, of unit length */
    const float *residuals; /* 1 a vertex: how far it is from the surface, |f| / |grad f|; NULL: all are on it */
    uint64_t quad_count;
    const uint32_t *quads;  /* 4 a quad: vertices, counter-clockwise seen from outside; cut along the first and third */
    const float *points;    /* 3 a quad: the crossing on its grid edge */
    const float *gradients; /* 3 a quad: the outward unit normal there */
} hewn_dual_surface;

#endif
