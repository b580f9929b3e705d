/* Smoothing: vertices move, faces and their connections stay. Works on any polygons, manifold or not. */
#ifndef HEWN_SMOOTH_H
#define HEWN_SMOOTH_H

#include "hewn/model.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum hewn_smooth_method {
    HEWN_SMOOTH_TAUBIN,    /* Taubin 1995, 'A signal processing approach to fair surface design': hardly shrinks */
    HEWN_SMOOTH_LAPLACIAN, /* to the mean of the neighbours: shrinks */
    HEWN_SMOOTH_COTAN,     /* mean curvature flow in small steps (Meyer, Desbrun, Schroeder, Barr 2003) */
    HEWN_SMOOTH_IMPLICIT,  /* the same by backward Euler (Desbrun, Meyer, Schroeder, Barr 1999): any step is stable */
    HEWN_SMOOTH_BILATERAL, /* normals that agree are averaged, and vertices follow (Zheng, Fu, Au, Tai 2011; Zhang and
                              others 2015; Sun, Rosin, Martin, Langbein 2007): sharp edges stay sharp */
    HEWN_SMOOTH_HC,        /* Vollmer, Mencl, Mueller 1999, 'Improved Laplacian smoothing of noisy surface meshes' */
    HEWN_SMOOTH_COUNT
} hewn_smooth_method;

/* "taubin", "laplacian", "cotan", "implicit", "bilateral", "hc"; NULL for none. And back: false for other words. */
HEWN_API const char *hewn_smooth_method_name(hewn_smooth_method method);
HEWN_API bool hewn_smooth_method_find(const char *name, hewn_smooth_method *out);

/* Whether closed, oriented components get the volume back that they had, by an offset along their normals of what is
 * free to move. */
typedef enum hewn_smooth_volume {
    HEWN_SMOOTH_VOLUME_DEFAULT, /* kept by TAUBIN, which is meant to keep shapes as large as they are; else free */
    HEWN_SMOOTH_VOLUME_KEPT,
    HEWN_SMOOTH_VOLUME_FREE
} hewn_smooth_volume;

/* What to do; zero everywhere smooths by ten steps of Taubin's method.
 *
 * iterations: steps; 0 stands for 10, for one step of IMPLICIT, and for 8 of BILATERAL.
 *
 * strength (TAUBIN, LAPLACIAN): the share of the way to the mean of its neighbours that a vertex goes in a step, above
 * 0 to 1; 0 stands for 0.5. passband (TAUBIN): the eigenvalue of the mesh's normalised Laplacian, 0 to 2, below which
 * shapes stay; 0 stands for 0.02. Each step scales an eigenvector of eigenvalue k by (1 - lambda k) (1 + mu k), lambda
 * the strength and 1 / mu = 1 / lambda - passband.
 *
 * step (COTAN, IMPLICIT): a length; a step smooths as a Gaussian of this standard deviation would on a flat surface,
 * that is for a time of step^2 / 2. n steps reach sqrt(n) as far. 0 stands for the mean edge. COTAN goes less far at
 * vertices where so long a step would not be stable, and counts them.
 * remeasure (COTAN, IMPLICIT): weights and areas are measured anew every so many steps; 0 keeps those of the start, so
 * that all steps are one linear filter (and IMPLICIT factors once).
 *
 * angle (BILATERAL): degrees; faces whose normals, noise aside, differ by much more do not mix. 0 stands for 20.
 * radius: the same for the distance between faces; 0 stands for the mean one of neighbours.
 *
 * original, push (HC): how much a vertex is drawn to where it was at the start (against the step before), and how much
 * of that pull it takes from itself (against its neighbours), 0 to 1. Negative or both zero: 0 and 0.5.
 *
 * A vertex on a boundary, or on an edge of three or more faces, is smoothed along it by TAUBIN, LAPLACIAN and HC; where
 * not exactly two such edges meet it stays. COTAN and IMPLICIT never move it. lock_boundary makes it stay in any case;
 * lock_angle above 0 does so with both ends of edges whose faces bend by more than so many degrees; `labels`, one a
 * face, with vertices where faces of different labels meet. `freedom`, one a vertex from 0 (stays) to 1, scales how far
 * each moves. Vertices without faces stay. */
typedef struct hewn_smooth_desc {
    hewn_smooth_method method;
    uint32_t iterations;
    double strength;
    double passband;
    double step;
    uint32_t remeasure;
    double angle;
    double radius;
    double original, push;
    bool lock_boundary;
    double lock_angle;
    const int32_t *labels;
    const double *freedom;
    hewn_smooth_volume volume;
    const hewn_progress *progress; /* or NULL; the stage is "smooth" */
} hewn_smooth_desc;
HEWN_API hewn_smooth_desc hewn_smooth_desc_default(void);

/* What was done. Volumes and areas are those of the triangles that faces are cut into. */
typedef struct hewn_smooth_report {
    uint32_t iterations;
    double strength, passband, step, angle, radius; /* in force; 0 where the method has none */
    uint64_t locked_vertices;                       /* with faces, but not free to move */
    uint64_t clamped_vertices;  /* whose step was shortened (COTAN), when weights were last measured */
    uint64_t closed_components; /* whose volume was kept */
    double volume_before, volume_after;
    double area_before, area_after;
    double largest_move, mean_move; /* distances between a vertex before and after; the mean is over all */
} hewn_smooth_report;

/* Smooths into `positions` (3 a vertex), which may be those of `polygons`. `desc` and `report` may be NULL. The same
 * bytes for any number of threads. About 25 bytes a corner of memory (BILATERAL: 90; IMPLICIT: some 500 a vertex).
 *
 * HEWN_INVALID_ARGUMENT for parameters out of range, naming them; HEWN_BAD_INPUT for a position, freedom or index that
 * cannot be used, naming the vertex or face; HEWN_LIMIT for 2^31 corners or more, or where a position would not stay
 * finite; HEWN_OUT_OF_MEMORY; HEWN_CANCELLED. `positions` then are as they were. Safe from any thread while nobody
 * changes the polygons. */
HEWN_API hewn_result hewn_polygons_smooth(const hewn_polygons *polygons, const hewn_smooth_desc *desc,
                                          double *positions, hewn_smooth_report *report, hewn_error *error);

/* The same of a model: channels "normal" of vertices and corners are made anew (corners of a vertex that had the same
 * one get the same one), all others stay. */
HEWN_API hewn_result hewn_model_smooth(hewn_model *model, const hewn_smooth_desc *desc, hewn_smooth_report *report,
                                       hewn_error *error);

/* The same of the extraction's triangles; normals, where there are any, are made anew. Positions are rounded to floats
 * again; HEWN_LIMIT where one does not fit. */
HEWN_API hewn_result hewn_triangles_smooth(hewn_triangles *triangles, const hewn_smooth_desc *desc,
                                           hewn_smooth_report *report, hewn_error *error);

/* The same of a half-edge mesh without holes (hewn_mesh_compact()); HEWN_INVALID_ARGUMENT for one with holes. */
HEWN_API hewn_result hewn_mesh_smooth(hewn_mesh *mesh, const hewn_smooth_desc *desc, hewn_smooth_report *report,
                                      hewn_error *error);

/* The mean curvature vector (3 a vertex; its length is the sum of both principal curvatures, it points to the inside of
 * a sphere) and the mixed Voronoi area of each vertex (Meyer and others 2003), over the triangles that faces are cut
 * into. Either array may be NULL. Zero for vertices without area; without meaning on boundaries. The errors of
 * hewn_polygons_smooth(). */
HEWN_API hewn_result hewn_mean_curvature(const hewn_polygons *polygons, double *curvature, double *areas,
                                         hewn_error *error);

#ifdef __cplusplus
}
#endif
#endif
