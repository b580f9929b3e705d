/* One smoothing under way, and the methods. Positions are three doubles a vertex, in a frame whose origin is near. */
#ifndef HEWN_SRC_SMOOTH_WORK_H
#define HEWN_SRC_SMOOTH_WORK_H

#include "base/progress.h"
#include "hewn/smooth.h"
#include "smooth/rows.h"

typedef struct smooth_work {
    const hewn_polygons *polygons;
    const hewn_smooth_desc *desc; /* with the defaults filled in */
    hewn_smooth_report *report;
    uint32_t count;    /* vertices */
    hewn_polygons cut; /* the triangles that faces are cut into, positions unset; corners may be those of polygons */
    uint32_t *cut_corners; /* owned; NULL where all faces are triangles */
    smooth_rows neighbours;
    smooth_rows fans;   /* triangles' corners at each vertex (IMPLICIT, BILATERAL) */
    bool weighs;        /* whether `sides` are those of triangles */
    smooth_sides sides; /* of corners at each vertex, until their room is taken */
    uint8_t *flags;     /* SMOOTH_USED and SMOOTH_RIM of each vertex */
    double *freedom;    /* of each vertex, or NULL where all are free */
    double *at;         /* positions now, and one number more, so that four may be read at each vertex */
    double *next;       /* room for those after the step, the same; NULL until it is taken */
} smooth_work;

/* Each takes `at` through all iterations. HEWN_OUT_OF_MEMORY, HEWN_CANCELLED. */
hewn_result hewn_smooth_umbrella(smooth_work *work, hewn_error *error); /* LAPLACIAN, TAUBIN */
hewn_result hewn_smooth_hc(smooth_work *work, hewn_error *error);
hewn_result hewn_smooth_flow(smooth_work *work, hewn_error *error); /* COTAN */
hewn_result hewn_smooth_implicit(smooth_work *work, hewn_error *error);
hewn_result hewn_smooth_bilateral(smooth_work *work, hewn_error *error);

/* Makes room for `next`, that of the sides where it will do: pages that the kernel need not clear once more. The sides
 * are gone then. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_smooth_take_room(smooth_work *work, hewn_error *error);

/* Fills in `freedom` from what is locked. */
hewn_result hewn_smooth_lock(smooth_work *work, hewn_error *error);

/* Moves what is free along its normals until closed components have the volume that they had with positions `before`;
 * how many there are goes to the report. */
hewn_result hewn_smooth_keep_volume(smooth_work *work, const double *before, hewn_error *error);

static inline void smooth_swap(smooth_work *work)
{
    double *at = work->at;
    work->at = work->next;
    work->next = at;
}

static inline double smooth_freedom(const smooth_work *work, uint32_t v)
{
    return work->freedom ? work->freedom[v] : 1;
}

/* --- three doubles ------------------------------------------------------------------------------------------------ */

static inline void smooth_between(const double *a, const double *b, double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = b[i] - a[i];
}

static inline void smooth_cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static inline double smooth_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

#endif
