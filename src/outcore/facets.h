/* Triangles that share no vertices, as STL has them, made a store's: corners at equal positions become one vertex. */
#ifndef HEWN_SRC_OUTCORE_FACETS_H
#define HEWN_SRC_OUTCORE_FACETS_H

#include "outcore/regions.h"
#include "outcore/store.h"

typedef struct hewn_facets {
    const char *output; /* beside which temporary files go; the caller's */
    hewn_model schema;  /* channels of faces, unit and axes */
    size_t value_bytes;
    hewn_chains corners; /* a position and the number of the corner, each */
    hewn_chain corner_list;
    hewn_chains values; /* of faces */
    hewn_chain value_list;
    hewn_sample sample;
    uint64_t corner_count;
    bool known; /* the channels */
} hewn_facets;

void hewn_facets_begin(const char *output, hewn_facets *out);
void hewn_facets_free(hewn_facets *facets);

/* Adds triangles, three vertices each, with channels of faces that are the same in all parts. HEWN_BAD_INPUT for a
 * position that is not finite, HEWN_LIMIT for more corners than indices can name; HEWN_IO; HEWN_OUT_OF_MEMORY. */
hewn_result hewn_facets_add(hewn_facets *facets, const hewn_model *part, hewn_error *error);

/* Adds all to an empty store, within about `memory` bytes. Vertices come region by region, so that near ones have near
 * numbers. HEWN_IO; HEWN_OUT_OF_MEMORY, also where more corners lie in one place than that memory holds. */
hewn_result hewn_facets_weld(hewn_facets *facets, uint64_t memory, hewn_store *store, hewn_error *error);

#endif
