/* Vertices on edges, written one after the other: where they are and which way is out, from values that whoever reads
 * the samples has found. */
#ifndef HEWN_SRC_ISO_LATTICE_PEN_H
#define HEWN_SRC_ISO_LATTICE_PEN_H

#include "iso/lattice.h"

typedef struct hewn_lattice_pen {
    const hewn_lattice *lattice;
    uint32_t axis; /* that edges run along */
    float *position, *normal;
} hewn_lattice_pen;

/* An edge between a sample and the rim, a hair beyond the sample; its normal points along the edge. `end` tells that
 * the edge ends in the rim, `at` is the sample, without the rim. */
void hewn_lattice_put_cap(hewn_lattice_pen *pen, const uint32_t at[3], bool end);

/* How far along an edge the vertex is, from the values at its ends, which have different signs. */
static inline double hewn_lattice_share(const hewn_lattice *lattice, double here, double there)
{
    double share = here != there ? here / (here - there) : 0.5;
    return share < lattice->margin ? lattice->margin : share > 1 - lattice->margin ? 1 - lattice->margin : share;
}

/* Where planes are to meet and gradients at an edge's ends differ much, two of them meet on it: the field is taken for
 * straight from each end to there (subcell resolution, Harten 1989), which says where it is 0, and only the gradient of
 * that side counts. `here` and `there` are the values at the ends. */
void hewn_lattice_follow_bend(const hewn_lattice *lattice, uint32_t axis, double here, double there, double *share,
                              double first[3], double last[3]);

/* An edge from sample `from` on, `inside` or not. Gradients of the field are those at its ends; not looked at where
 * there are no normals. */
void hewn_lattice_put_edge(hewn_lattice_pen *pen, const uint32_t from[3], double share, bool inside,
                           const double first[3], const double last[3]);

#endif
