/* One region's part of a mesh on disk, simplified in memory. */
#ifndef HEWN_SRC_OUTCORE_CELL_H
#define HEWN_SRC_OUTCORE_CELL_H

#include "hewn/simplify.h"
#include "outcore/regions.h"
#include "outcore/store.h"

/* A region and what is to be done there. Vertices belong to the region that they lie in. Triangles all of whose corners
 * do are the region's own. Those of several regions are around each of them: they stay as they are, and so do their
 * corners. So every triangle at a vertex that may go is here, and so is every edge between two vertices of the region:
 * no collapse here can make an edge that another region has or makes. */
typedef struct hewn_cell {
    hewn_store *store;
    const hewn_regions *regions;
    uint32_t region;
    hewn_chain *own, *around;       /* consumed */
    hewn_chain *out;                /* gets what the own triangles become */
    const hewn_simplify_desc *desc; /* its locks are looked for, once for all, where `find_locks` */
    bool find_locks;
    double share;  /* of the own triangles that can go, to stay; above 0 */
    double error;  /* a length; 0: none is given */
    bool strictly; /* the share is one of all own triangles, so that as few are left as is asked for */
    const hewn_progress *progress;
} hewn_cell;

/* What came of it. */
typedef struct hewn_cell_report {
    uint64_t vertices;             /* of the region, that triangles name */
    uint64_t triangles;            /* own ones that are left */
    double distance, distance_low; /* where it was measured */
} hewn_cell_report;

/* Simplifies, puts vertices back and adds triangles to `out`. The errors of hewn_model_simplify(), and HEWN_IO. */
hewn_result hewn_cell_simplify(const hewn_cell *cell, hewn_cell_report *report, hewn_error *error);

#endif
