/* View-dependent refinement of progressive meshes (Hoppe 1997, 'View-dependent refinement of progressive meshes'): a
 * mesh that is fine where that is seen, and changes from view to view by the splits that differ. */
#ifndef HEWN_REFINEMENT_H
#define HEWN_REFINEMENT_H

#include "hewn/progressive.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A mesh between the base and all splits. A split is done or undone only where all that is around its two vertices is
 * as it was when it was folded (De Floriani, Magillo and Puppo 1997, 'Building and traversing a surface at variable
 * resolution'), so every mesh is one that a simplification could have made: of the input's topology, closed where it is
 * closed, without cracks or T-junctions. Serves one thread at a time. */
typedef struct hewn_refinement hewn_refinement;

/* From where the mesh is seen, and how exact it shall be there.
 *
 * pixels: how many a length of 1 at a distance of 1 has in the picture (lines / (2 tan(fov / 2))). tolerance: pixels
 * that the mesh may be off by; 0: all splits. The errors are estimates, which add up from fold to fold: distances at
 * the vertex that went and at the middles of the edges that came.
 *
 * planes: the inside of the picture is where all are positive, a x + b y + c z + d with (a, b, c) of length 1; 0: no
 * bounds. Tolerances are multiplied by `outside` for what lies wholly outside (no less than `back`, infinite for the
 * base's; 0: `back`), by `back` for what is wholly turned away (1 and more; 0: 1), by `silhouette` for what may be part
 * of an outline (above 0 to 1; 0: 1). */
typedef struct hewn_refinement_view {
    double eye[3];
    double pixels, tolerance;
    double planes[6][4];
    uint32_t plane_count;
    double outside, back, silhouette;
} hewn_refinement_view;

/* What an update did. */
typedef struct hewn_refinement_stats {
    uint64_t splits, folds; /* that were done */
    uint64_t tested;        /* splits whose error was projected */
    bool settled;           /* nothing is left to be done for this view */
} hewn_refinement_stats;

/* Starts at the base, with what splits are there. The progressive mesh must outlive it. HEWN_OUT_OF_MEMORY. About 250
 * bytes a vertex of memory. */
HEWN_API hewn_result hewn_refinement_create(const hewn_progressive *progressive, hewn_refinement **out,
                                            hewn_error *error);
HEWN_API void hewn_refinement_destroy(hewn_refinement **refinement);

/* Brings the mesh to a view, from where it is. Splits whose errors show are done, with those that they stand on, and
 * all others are folded. Stops after so many splits and folds (0: as many as it takes), but not between a split and
 * what it stands on. Once it is settled, the mesh is the view's, whichever way it came there. Takes time in proportion
 * to the mesh, not to the input. HEWN_INVALID_ARGUMENT for a view that makes no sense; HEWN_OUT_OF_MEMORY, after which
 * the mesh is sound, but not settled. `stats` may be NULL. */
HEWN_API hewn_result hewn_refinement_update(hewn_refinement *refinement, const hewn_refinement_view *view,
                                            uint64_t most, hewn_refinement_stats *stats, hewn_error *error);

/* The triangles that there are, 3 vertices each by their numbers in the stream, in no particular order, for drawing.
 * They stay where they are until the next update. */
HEWN_API const uint32_t *hewn_refinement_triangles(const hewn_refinement *refinement, uint64_t *count);

/* The mesh as a model, with attributes; triangles in the order of the stream, vertices without triangles left out.
 * HEWN_OUT_OF_MEMORY. */
HEWN_API hewn_result hewn_refinement_model(const hewn_refinement *refinement, hewn_model *out, hewn_error *error);

#ifdef __cplusplus
}
#endif
#endif
