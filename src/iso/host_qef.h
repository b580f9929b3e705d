/* The point of a cell that is nearest to a few planes in the sense of least squares, on the host: the work of
 * shaders/iso/qef.h, which says what it means. */
#ifndef HEWN_SRC_ISO_HOST_QEF_H
#define HEWN_SRC_ISO_HOST_QEF_H

#include "iso/host_vector.h"

#define HEWN_QEF_MOST 18

typedef struct hewn_qef {
    vec planes[HEWN_QEF_MOST]; /* unit normal, and its product with the plane's points */
    vec points;                /* sum of the crossings, and how many */
    uint32_t count;
    uint32_t taken; /* a bit for each plane that counts */
} hewn_qef;

typedef struct hewn_qef_solution {
    vec at;
    vec best;      /* the best point anywhere */
    vec free;      /* where the rank is 2, the direction of the edge */
    uint32_t rank; /* directions that count: 1 in smooth places, 2 at edges, 3 at corners */
} hewn_qef_solution;

void hewn_qef_begin(hewn_qef *qef);

/* Planes beyond the most that are held are not taken; nor are normals that are no directions. */
void hewn_qef_add_plane(hewn_qef *qef, vec point, vec normal);
void hewn_qef_add_crossing(hewn_qef *qef, vec point, vec normal);

/* The mean of the crossings, kept in the box; its middle where there are none. */
vec hewn_qef_mass_point(const hewn_qef *qef, vec lo, vec hi);

/* The point of the box lo..hi that fits the planes best. */
hewn_qef_solution hewn_qef_solve(const hewn_qef *qef, vec lo, vec hi);

#endif
