/* What the topology of the trilinear interpolant needs between signs and vertices on the host, for devices that share
 * its memory and its processors: which cells their values decide, how many triangles and vertices each brick has, and
 * the triangles. They do the work of mc33_ask.comp, mc33_count.comp, mc33_spread.comp and mc33_triangles.comp on the
 * same buffers and write the same bytes; the device only decides (mc33_decide.glsl), and such a driver has four kernels
 * less to compile. */
#ifndef HEWN_SRC_ISO_HOST_MC33_H
#define HEWN_SRC_ISO_HOST_MC33_H

#include "iso/host_surface.h"

/* Views of the buffers that shaders/shared/iso.h describes. */
typedef struct hewn_host_mc33 {
    hewn_host_surface surface; /* its triangle_bases are those of this topology */
    const uint32_t *table;     /* hewn_mc33_table */
    uint32_t *ranks;           /* a brick: asked cells before it */
    uint32_t *asked;           /* two words each */
    uint32_t *centre_bases;
    uint64_t first_centre; /* number of the first vertex in a cell; only for emission */
} hewn_host_mc33;

/* Counts the cells that are asked and writes the ranks; the total in two words, as hewn_scan_record() leaves it. These
 * functions use all threads of OpenMP, and write the same for any number of them. */
void hewn_host_mc33_rank(const hewn_host_mc33 *mc33, uint32_t total[2]);

/* Writes the cells that are asked. */
void hewn_host_mc33_ask(const hewn_host_mc33 *mc33);

/* Once they are decided: the bases and totals of triangles and of vertices in cells. */
void hewn_host_mc33_count(const hewn_host_mc33 *mc33, uint32_t totals[4]);

/* Writes the numbers of vertices beside the masks, and the records of all vertices; then the triangles of the bricks
 * from `first` up to before `end`. */
void hewn_host_mc33_emit(const hewn_host_mc33 *mc33, uint32_t first, uint32_t end);

#endif
