/* OpenSubdiv behind a C face: the same control mesh refined by it, told in Hewn's numbering. */
#ifndef HEWN_TEST_OSD_PEER_H
#define HEWN_TEST_OSD_PEER_H

#ifdef __cplusplus
extern "C" {
#endif
#include "subdivide/subdivision.h"

/* Whether the tests were built with it. */
bool osd_is_there(void);

typedef struct osd_request {
    const hewn_polygons *polygons;
    const hewn_subdivide_desc *desc;
    const hewn_subdivision *subdivision; /* Hewn's, for its numbering */
    const double *control;               /* 3 a vertex */
    const double *uv;                    /* 2 a corner, or NULL */
} osd_request;

/* Writes values of the last level: `points` 3 a vertex; `limits` and `normals` likewise or NULL; `uv` 2 a corner, or
 * NULL. False where OpenSubdiv refuses the mesh. */
bool osd_refine(const osd_request *request, double *points, double *limits, double *normals, double *uv);

#ifdef __cplusplus
}
#endif
#endif
