/* Samplings: values on a lattice, as leaves of fields. A mesh file, a heightmap or another field is sampled once, and
 * what comes of it is a shape like any other: it can be moved, cut, blended and meshed.
 *
 * Between samples values are trilinear. Where nothing happens (no surface near), eight cells a side may be one large
 * cell: a sampling takes memory for the surface, not for the volume. */
#ifndef HEWN_SAMPLING_H
#define HEWN_SAMPLING_H

#include "hewn/field.h"
#include "hewn/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Never changed once it is made; may be read by any number of threads. Fields that use it hold it on their own. */
typedef struct hewn_sampling hewn_sampling;

HEWN_API void hewn_sampling_destroy(hewn_sampling **sampling);

/* What it takes in memory, on the host and again on a device. */
HEWN_API uint64_t hewn_sampling_size(const hewn_sampling *sampling);

/* --- as a field --------------------------------------------------------------------------------------------------- */

/* Where samples lie: sample (i, j, k) at origin + cell (i, j, k). */
typedef struct hewn_sampling_place {
    double origin[3];
    double cell;
} hewn_sampling_place;

/* The field of samples that are distances. Past the lattice values grow with the distance from it: a lower bound of the
 * distance to what lies in the lattice, as long as values at its sides are above 0. HEWN_NODE_NONE for no sampling, a
 * cell that is not above 0, places that are not finite. */
HEWN_API hewn_node hewn_sampled(hewn_field *field, const hewn_sampling *sampling, const hewn_sampling_place *place);

/* The land below heights: z less the height above (x, y), over the root of 1 + the square of the greatest slope, so
 * that it is a lower bound of the distance. The sampling is flat; samples are spread over `width` along x and `depth`
 * along y about the origin and multiplied by `height`. Past its sides the heights there carry on. */
HEWN_API hewn_node hewn_heights(hewn_field *field, const hewn_sampling *sampling, double width, double depth,
                                double height);

/* --- making them -------------------------------------------------------------------------------------------------- */

/* What to do with a mesh; zero means the default.
 *
 * cell: the distance of samples; 0: a 128th of the longest side of the mesh's box.
 * band: how far from the surface samples stand at every cell, in cells; 0: 3. Farther away values come from samples
 * eight cells apart.
 * dense: samples at every cell everywhere.
 * memory_limit: bytes of samples; 0 is 2 GiB. */
typedef struct hewn_mesh_sampling_desc {
    double cell;
    double band;
    bool dense;
    uint64_t memory_limit;
    const hewn_progress *progress; /* or NULL; the stage is "sample" */
} hewn_mesh_sampling_desc;

/* What became of it.
 *
 * confidence: 1 where the mesh leaves no doubt what is inside; of the samples around the surface the mean of
 * 1 - 2 |w - r|, w being the winding number of the mesh about the sample and r the nearest whole number. Meshes with
 * holes or faces that are turned over have less, and 0 is a guess. `doubtful` is the share of the samples whose winding
 * number is farther than 0.25 from a whole one. */
typedef struct hewn_mesh_sampling_report {
    uint32_t cells[3];
    uint64_t samples; /* that were computed */
    double confidence, doubtful;
} hewn_mesh_sampling_report;

/* Samples the signed distance to a mesh: exact distances, and inside where the generalised winding number (Jacobson,
 * Kavan and Sorkine-Hornung 2013, 'Robust inside-outside segmentation using generalized winding numbers') is nearer to
 * a whole number other than 0; so a mesh may have holes, may pass through itself, and may be turned inside out as a
 * whole. Winding numbers of far parts are those of their dipoles (Barill and others 2018, 'Fast winding numbers for
 * soups and clouds'); near ones are exact. Polygons are cut into triangles. `*place` says where samples lie; `report`
 * may be NULL. The same for any number of threads.
 *
 * HEWN_BAD_INPUT for polygons that cannot be used and for a mesh without faces; HEWN_LIMIT where the samples would take
 * more than the limit, saying what would fit; HEWN_INVALID_ARGUMENT, HEWN_OUT_OF_MEMORY, HEWN_CANCELLED. */
HEWN_API hewn_result hewn_sampling_from_mesh(const hewn_polygons *mesh, const hewn_mesh_sampling_desc *desc,
                                             hewn_sampling **out, hewn_sampling_place *place,
                                             hewn_mesh_sampling_report *report, hewn_error *error);

/* A flat sampling of `columns` x `rows` values, each at least 2, row by row from the one with the least y. Values are
 * finite. HEWN_BAD_INPUT names the first that is not; HEWN_INVALID_ARGUMENT, HEWN_LIMIT, HEWN_OUT_OF_MEMORY. */
HEWN_API hewn_result hewn_sampling_from_heights(const float *values, uint32_t columns, uint32_t rows,
                                                hewn_sampling **out, hewn_error *error);

/* What to do with a field; `bounds` is needed, and `cell` above 0. Else as for meshes. */
typedef struct hewn_field_sampling_desc {
    hewn_box bounds; /* where to look: the lattice is a little larger */
    double cell;
    double band;
    bool dense;
    uint64_t memory_limit;
    const hewn_progress *progress;
} hewn_field_sampling_desc;

/* Samples the root of a field, by the host's processors; bricks away from the surface are found by interval bounds, so
 * none with surface is missed. HEWN_LIMIT, HEWN_INVALID_ARGUMENT, HEWN_OUT_OF_MEMORY, HEWN_CANCELLED; HEWN_BAD_INPUT
 * where the field is no number at a sample. */
HEWN_API hewn_result hewn_sampling_from_field(const hewn_field *field, const hewn_field_sampling_desc *desc,
                                              hewn_sampling **out, hewn_sampling_place *place, hewn_error *error);

#ifdef __cplusplus
}
#endif
#endif
