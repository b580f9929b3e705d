/* The stages between signs and vertices on the host, for devices that share its memory and its processors: which edges
 * are crossed, how many vertices and triangles each brick has, where they go, and the triangles themselves. They do the
 * work of classify.comp, spread.comp and triangles.comp on the same buffers and write the same bytes.
 *
 * They read whole layers of 64 samples as one word, and find a brick's vertices once for all of its triangles, which a
 * CPU driver's kernels cannot: those read memory lane by lane (docs/performance.md). */
#ifndef HEWN_SRC_ISO_HOST_SURFACE_H
#define HEWN_SRC_ISO_HOST_SURFACE_H

#include "hewn/base.h"

/* Views of the buffers that shaders/shared/iso.h describes. */
typedef struct hewn_host_surface {
    uint32_t cells[3];
    uint32_t count; /* bricks */
    const uint32_t *bricks, *links, *signs;
    uint32_t *edges;
    uint32_t *vertex_bases, *triangle_bases;
    uint32_t *vertices; /* of hewn_spread_push; only for emission */
    uint32_t *indices;  /* final ones; only for emission */
} hewn_host_surface;

/* Writes the masks of crossed edges, and the bases and totals of vertices and triangles as hewn_scan_record() leaves
 * them. These functions use all threads of OpenMP, and write the same for any number of them. */
void hewn_host_surface_count(const hewn_host_surface *surface, uint32_t totals[4]);

/* Writes the numbers of vertices beside the masks, and the records of vertices. */
void hewn_host_surface_spread(const hewn_host_surface *surface);

/* Writes the triangles of the bricks from `first` up to before `end` of a surface that was spread; all its bricks have
 * `triangle_count` of them. */
void hewn_host_surface_triangulate(const hewn_host_surface *surface, uint32_t first, uint32_t end,
                                   uint64_t triangle_count);

/* Writes the blocks of 2 x 2 x 2 cells with surface, two words a brick as in hewn_cut_push: the work of cuts.comp. Of
 * the views it reads those that are const. */
void hewn_host_surface_cut(const hewn_host_surface *surface, uint32_t *cuts);

#endif
