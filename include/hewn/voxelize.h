/* Meshes and fields into samplings: distances on a lattice, close to the surface at every cell. */
#ifndef HEWN_VOXELIZE_H
#define HEWN_VOXELIZE_H

#include "hewn/mesh.h"
#include "hewn/sampling.h"

#ifdef __cplusplus
extern "C" {
#endif

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
 * 1 - 2 |w - r|, w being the winding number of the mesh about the sample and r the nearest whole number (less than 0.02
 * is none). Meshes with holes or faces that are turned over have less, and 0 is a guess. `doubtful` is the share of the
 * samples whose winding number is farther than 0.25 from a whole one. */
typedef struct hewn_mesh_sampling_report {
    uint32_t cells[3];
    uint64_t samples; /* that were computed */
    double confidence, doubtful;
} hewn_mesh_sampling_report;

/* Samples the signed distance to a mesh: exact distances, and inside where the generalised winding number (Jacobson,
 * Kavan and Sorkine-Hornung 2013, 'Robust inside-outside segmentation using generalized winding numbers') is nearer to
 * a whole number other than 0; so a mesh may have holes, may pass through itself, and may be turned inside out as a
 * whole. Winding numbers of far parts are those of their dipoles (Barill and others 2018, 'Fast winding numbers for
 * soups and clouds'); near ones are exact. Where it is in doubt, near holes, distances fade
 * to 0 as the winding number nears a half, so that a hole is closed by a smooth membrane. Polygons are cut into
 * triangles. `*place` says where samples lie; `report`
 * may be NULL. The same for any number of threads.
 *
 * HEWN_BAD_INPUT for polygons that cannot be used and for a mesh without faces; HEWN_LIMIT where the samples would take
 * more than the limit, saying what would fit; HEWN_INVALID_ARGUMENT, HEWN_OUT_OF_MEMORY, HEWN_CANCELLED. */
HEWN_API hewn_result hewn_sampling_from_mesh(const hewn_polygons *mesh, const hewn_mesh_sampling_desc *desc,
                                             hewn_sampling **out, hewn_sampling_place *place,
                                             hewn_mesh_sampling_report *report, hewn_error *error);

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
