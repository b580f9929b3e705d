/* One pass over a mesh on disk: it is cut into regions, and these are simplified one after the other. What lies between
 * regions stays for the next pass, whose regions are others. */
#ifndef HEWN_SRC_OUTCORE_PASS_H
#define HEWN_SRC_OUTCORE_PASS_H

#include "outcore/cell.h"

typedef struct hewn_pass {
    hewn_store *store;
    const hewn_simplify_desc *desc; /* its locks are looked for in the first pass */
    bool first;
    double shift;       /* of the regions' planes, see hewn_regions_make() */
    uint64_t capacity;  /* triangles that a region may have, with those around it */
    size_t list_memory; /* bytes for lists while they are added to */
    uint64_t aim;       /* triangles to be left */
    bool strictly;      /* see hewn_cell */
    double error;       /* a length; 0: none is given */
    double began, span; /* its share of the whole work, for progress */
    const hewn_progress *progress;
} hewn_pass;

typedef struct hewn_pass_report {
    uint32_t regions;
    uint64_t vertices;             /* that triangles named when it began */
    double distance, distance_low; /* of the mesh before and after, where they were measured */
} hewn_pass_report;

/* Simplifies the store's triangles. HEWN_OUT_OF_MEMORY where regions cannot be made small enough, saying why; HEWN_IO;
 * HEWN_CANCELLED; and what hewn_model_simplify() returns. */
hewn_result hewn_pass_run(const hewn_pass *pass, hewn_pass_report *report, hewn_error *error);

/* The box of all vertices that triangles name, and checks these names. HEWN_BAD_INPUT, HEWN_IO. */
hewn_result hewn_store_bounds(hewn_store *store, double low[3], double high[3], hewn_error *error);

#endif
