/* A part of a grid on its way: its bricks and those around them, their signs and counts, and what of that is its own.
 */
#ifndef HEWN_SRC_ISO_PART_H
#define HEWN_SRC_ISO_PART_H

#include "iso/extraction.h"

typedef struct hewn_part {
    hewn_region region;
    hewn_bricks bricks;
    hewn_surface surface;    /* its counts are those of all bricks, own.vertices and the like those of its own */
    const uint32_t *numbers; /* of the bricks, ascending */
    const uint32_t *packed;  /* coordinates of the bricks, */
    const uint32_t *bases;   /* and the first vertex of each: on edges, or by the dual methods in cells */
    uint64_t named_vertices; /* those that bases tell of: all but those in the cells of mc33 */
} hewn_part;

/* Culls and classifies a part; all that it holds lies in buffers of the run's workspace. `counts_only` leaves out what
 * only emission needs. An empty part has no bricks of its own. */
hewn_result hewn_part_open(hewn_extraction *run, const hewn_region *region, bool counts_only, hewn_part *out,
                           hewn_error *error);

/* The number of own bricks, and the first vertex of brick `at`, which may be the one past the last. */
uint64_t hewn_part_own_bricks(const hewn_part *part);
uint32_t hewn_part_base(const hewn_part *part, uint64_t at);

/* Emits the part's own vertices and triangles; numbers are the part's. `buffers` are positions, normals and indices, to
 * be destroyed also after an error. */
hewn_result hewn_part_emit(hewn_extraction *run, hewn_part *part, hewn_buffer buffers[3], hewn_emission *out,
                           hewn_error *error);

#endif
