/* Guide normals: what the normal of each triangle would be if a noisy mesh were cleaner. For each triangle the most
 * even one of the patches that hold it is taken, so that noise is averaged away and yet nothing is averaged across a
 * sharp edge (Zhang, Deng, Zhang, Bouaziz and Liu 2015, 'Guided mesh normal filtering'). */
#ifndef HEWN_SRC_SMOOTH_GUIDE_H
#define HEWN_SRC_SMOOTH_GUIDE_H

#include "smooth/rows.h"

typedef struct smooth_guide {
    smooth_rows near;  /* the triangles that share a vertex with each, itself among them: its patch */
    uint32_t *beside;  /* three a triangle: those that share an edge with it, itself where there is none */
    double *means;     /* three a triangle: the mean normal of its patch */
    double *roughness; /* of its patch */
} smooth_guide;

/* For the triangles `cut`, of which `fans` are the corners at each vertex. HEWN_OUT_OF_MEMORY, HEWN_LIMIT. */
hewn_result hewn_smooth_guide_init(smooth_guide *guide, const hewn_polygons *cut, const smooth_rows *fans,
                                   hewn_error *error);
void hewn_smooth_guide_free(smooth_guide *guide);

/* Guide normals from unit normals (zero for triangles without area) and areas. */
void hewn_smooth_guide_find(const smooth_guide *guide, const double *normals, const double *areas, double *guides);

#endif
