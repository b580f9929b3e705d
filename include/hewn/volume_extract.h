/* From a volume to a mesh, straight from its samples, on the host. */
#ifndef HEWN_VOLUME_EXTRACT_H
#define HEWN_VOLUME_EXTRACT_H

#include "hewn/extract.h"
#include "hewn/triangles.h"
#include "hewn/volume.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What is inside the surface. */
typedef enum hewn_inside {
    HEWN_INSIDE_DEFAULT, /* below for a level set (hewn_volume.level_set), else above */
    HEWN_INSIDE_ABOVE,   /* samples whose value is at least the iso value */
    HEWN_INSIDE_BELOW    /* samples whose value is less than the iso value */
} hewn_inside;

/* Zero everywhere but `iso` is a sensible default. */
typedef struct hewn_volume_extract_desc {
    uint64_t frame;
    double iso;         /* a value, not a sample: see hewn_volume */
    hewn_method method; /* HEWN_METHOD_MC33 where it is the default */
    hewn_inside inside;
    bool open;           /* leave the surface open at the outermost samples, instead of closing it there with a cap */
    bool no_normals;     /* leave them out */
    const double *place; /* 16 numbers, row by row: from (i, j, k, 1) to the mesh's space; NULL: to_world */
    const hewn_body_choice *keep;  /* NULL: everything. Not with `open`, where there is no inside to tell apart */
    uint64_t max_memory;           /* for hewn_volume_extract_parts(): bytes that it may take; 0: no limit */
    const hewn_progress *progress; /* or NULL; the stage is "extract" */
} hewn_volume_extract_desc;

typedef struct hewn_volume_extract_stats {
    hewn_method method;     /* that was used */
    bool below;             /* what was taken for inside: values below the iso value */
    uint64_t cells[3];      /* between samples, 0 along an axis with one sample */
    uint64_t active_cells;  /* that hold surface, with those between the outermost samples and their cap */
    uint64_t decided_cells; /* of these: where values decided how the surface is connected */
    uint64_t cap_vertices;  /* that lie on the bounds because the surface was cut there */
    hewn_body_counts bodies;
    uint64_t vertices, triangles; /* of the mesh */
    uint64_t parts;               /* that it came in; 0 where it was made at once */
    uint64_t peak_memory;         /* of parts: most bytes in use, as max_memory counts them */
    hewn_extract_stage stages[5]; /* signs, count, vertices, triangles, bodies, or for parts count,
                                     extract; seconds from the begin of the call */
    uint32_t stage_count;
} hewn_volume_extract_stats;

/* Meshes the surface between the samples that are inside and those that are not; NaN never is. Samples are compared in
 * their own type: the sample's value is slope × sample + intercept, computed in double precision, and whatever that
 * says of each single sample is exactly what the mesh is made of. Between samples the field is their trilinear
 * interpolant: vertices lie where it has the iso value on an edge of the lattice, but at least 2^-14 of an edge away
 * from its ends (more where floats are coarser), and by HEWN_METHOD_MC33 the mesh is connected as the interpolant's
 * surface is, by exact decisions (docs/extraction.md). Normals are the gradients of the samples by central differences.
 *
 * By HEWN_METHOD_NETS and HEWN_METHOD_DC vertices lie in cells instead, one for each loop of the surface around the
 * cell: at the mean of the crossings, or where their planes meet (docs/volumes.md tells how these are found). Normals
 * are the means of theirs; there is a quad around each crossed edge, cut in two triangles.
 *
 * The mesh is a closed, oriented 2-manifold for any samples, in which no vertex is used by more than one sheet. A
 * surface that reaches the outermost samples is closed there by a cap, 2^-14 of an edge beyond them, or with `open` has
 * a manifold border there. Positions are in the space of `place`, faces turned over where that mirrors. The same bytes
 * for any number of threads.
 *
 * Memory beside the mesh: a bit a sample and 24 bytes a row of samples; with `keep`, 4 bytes a vertex; of dual
 * methods, 24 bytes a crossing. Of a volume in blocks a bit a sample of these, and 1.5 kB for each block that the
 * surface passes.
 *
 * HEWN_INVALID_ARGUMENT for a frame that is not there, an iso value or least volume that is not finite, another method,
 * a place that is singular or not finite, or `keep` with `open`; HEWN_BAD_INPUT where there is no surface
 * (hewn_volume_range tells why), a volume of one slice is to be left open, no body that is large enough, or where the
 * place is so far from the origin that float positions cannot tell vertices apart; HEWN_LIMIT for more vertices than
 * indices can name, or a surface through more than 2^26 blocks; HEWN_OUT_OF_MEMORY; HEWN_CANCELLED. `stats` may be
 * NULL. Safe from several threads at once. */
HEWN_API hewn_result hewn_volume_extract(const hewn_volume *volume, const hewn_volume_extract_desc *desc,
                                         hewn_triangles *out, hewn_volume_extract_stats *stats, hewn_error *error);

/* The same mesh in parts, slabs of slices (along k): vertices and triangles of each are runs of the whole's. Two passes
 * go over the samples, counting first. A slab takes its signs (a bit a sample), 24 bytes a row, its vertices and
 * triangles (by dual methods also those of the slice before it), and what the sink takes; and where samples are left in
 * a file, those of its slices, which are let go after it. All that together stays within `max_memory`, and so do
 * samples on the heap. HEWN_OUT_OF_MEMORY with what is needed where a slice does not fit; else as
 * hewn_volume_extract(), and what the sink fails with. */
HEWN_API hewn_result hewn_volume_extract_parts(const hewn_volume *volume, const hewn_volume_extract_desc *desc,
                                               const hewn_mesh_sink *sink, hewn_volume_extract_stats *stats,
                                               hewn_error *error);

#ifdef __cplusplus
}
#endif
#endif
