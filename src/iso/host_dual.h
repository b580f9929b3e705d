/* The stages of the dual methods that need no field on the host, for devices that share its memory and its processors:
 * the work of dual_link.comp, dual_classify.comp, dual_spread.comp and dual_quads.comp on the same buffers. Counts,
 * records and numbers are the same; which way a quad is cut is decided in the same arithmetic, but drivers round their
 * own way. */
#ifndef HEWN_SRC_ISO_HOST_DUAL_H
#define HEWN_SRC_ISO_HOST_DUAL_H

#include "iso/dual_cells.h"
#include "iso/host_surface.h"
#include "shared/iso.h"

/* Views of the buffers that shaders/shared/iso.h describes. `bricks` has links, signs, edges and, in the place of bases
 * of vertices and triangles, those of crossings and quads; its records of vertices are those of crossings. */
typedef struct hewn_host_dual {
    hewn_host_surface bricks;
    const hewn_dual_table *table;
    struct hewn_grid grid;
    uint32_t *lower, *loops, *vertex_bases;
    float *positions, *points; /* only for emission, as what follows */
    uint32_t *passed, *indices;
    uint32_t *crossings; /* of quads; NULL where `keep` is HEWN_KEEP_NONE */
    uint32_t keep;
} hewn_host_dual;

/* Writes neighbours below, masks of crossed edges, loops, and bases; the totals are of crossings, vertices and quads,
 * in two words each. These functions use all threads of OpenMP, and write the same for any number of them. */
void hewn_host_dual_count(const hewn_host_dual *dual, uint32_t totals[6]);

/* Writes the records of crossings and vertices. */
void hewn_host_dual_spread(const hewn_host_dual *dual);

/* Writes the two triangles of each quad of the bricks from `first` up to before `end`, as dual_quads.comp does: the
 * vertices are where they will be. */
void hewn_host_dual_quads(const hewn_host_dual *dual, uint32_t first, uint32_t end);

/* The number of the crossing on an edge of the cell at `at` of a brick. Where a part of the grid ends, nobody may own
 * the edge: then what comes out is some number, and of no use. */
uint32_t hewn_host_dual_crossing(const hewn_host_surface *bricks, uint32_t slot, const uint32_t at[3], uint32_t edge);

#endif
