/* From a field to a mesh, on a device. */
#ifndef HEWN_EXTRACT_H
#define HEWN_EXTRACT_H

#include "hewn/device.h"
#include "hewn/field.h"
#include "hewn/triangles.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The most cells on a side. */
#define HEWN_MAX_RESOLUTION 8184u

typedef struct hewn_extractor hewn_extractor;

typedef enum hewn_method {
    HEWN_METHOD_DEFAULT,        /* what is best for a field: HEWN_METHOD_DC */
    HEWN_METHOD_MARCHING_CUBES, /* after Lorensen and Cline 1987, with one rule for ambiguous faces */
    HEWN_METHOD_MC33,           /* the same with the topology of the samples' trilinear interpolant (Chernyaev 1995) */
    HEWN_METHOD_NETS, /* vertices in cells, at the mean of the crossings (surface nets, Gibson 1998), always manifold */
    HEWN_METHOD_DC    /* the same where crossings and normals put them (dual contouring, Ju and others 2002) */
} hewn_method;

/* What commands and reports call a method: mc, mc33, nets, dc. The default's is that of the method it stands for; NULL
 * past the last one. Static storage. */
HEWN_API const char *hewn_method_name(hewn_method method);

/* The method of that name. False where there is none. */
HEWN_API bool hewn_method_named(const char *name, hewn_method *out);

/* Whether a method's vertices lie in cells, so that it makes quads. */
HEWN_API bool hewn_method_is_dual(hewn_method method);

/* Where and how finely. Zero everywhere but `bounds` is a sensible default. */
typedef struct hewn_extract_desc {
    hewn_box bounds;     /* scene units; the sides grow symmetrically to whole cells */
    uint32_t resolution; /* cells on the longest side; 0: 128 (ignored where `cell` is given) */
    double cell;         /* length of a cell's side in scene units; 0: from `resolution` */
    hewn_method method;
    bool open;  /* leave the surface open where it leaves the bounds, instead of closing it there with a cap */
    bool quads; /* by a dual method: two triangles for each quad and nothing else, see hewn_triangles.paired */
    /* By dual contouring: how far, in scene units, the surface may move where triangles are merged to fewer and larger
     * ones, see docs/extraction.md; 0: all cells are of one size. Not together with `quads`. */
    double adaptive;
    /* Bytes that a run may take at once, of the device and the host together (of the host: what the run itself and a
     * sink take; not the program, the field, the driver and what they held before); 0: no limit. A single mesh that
     * does not fit is HEWN_OUT_OF_DEVICE_MEMORY; hewn_extract_parts() makes parts of which two fit. */
    uint64_t max_memory;
    const hewn_progress *progress;
} hewn_extract_desc;

/* What an extraction did. Seconds are wall time on the caller's thread; begin counts from the start of the run. */
typedef struct hewn_extract_stage {
    const char *name; /* prepare, cull, evaluate, extract, suspects, read_back; where it is adaptive collapse; in parts
                         prepare, count, extract */
    double begin, end;
} hewn_extract_stage;

typedef struct hewn_extract_stats {
    hewn_method method; /* that was used: not the default */
    hewn_box bounds;    /* as grown to whole cells */
    double cell;
    uint64_t cells[3];
    uint64_t cells_visited; /* cells whose corners were evaluated */
    uint64_t bricks_active; /* 8-cell bricks that could hold surface */
    uint64_t cap_vertices;  /* that lie on the bounds because the surface was cut there */
    bool left_bounds;       /* the surface reaches the bounds */
    float max_residual;     /* see hewn_certificate */
    /* Cells beyond the neighbourhood of the surface, in which the field may be of the other sign between the samples:
     * features thinner than a cell, which the mesh lacks. docs/extraction.md has the definition. */
    uint64_t suspect_cells;
    hewn_box first_suspect;   /* where there are any: the first of them, in the order of the grid, x fastest */
    uint64_t undefined_cells; /* cells out there for which the field has no bounds, and so may not be a number */
    uint64_t fans;            /* by the dual methods: quads that became four triangles, so that they meet no others */
    /* By dual contouring: */
    uint64_t edge_vertices;   /* on sharp edges */
    uint64_t corner_vertices; /* at corners */
    uint64_t planes_found;    /* that no crossing of the cell had seen */
    uint64_t features_lost;   /* vertices still off the surface: what their cell holds is finer than it can tell */
    /* By adaptive dual contouring; the features above are the uniform surface's too: */
    uint64_t uniform_vertices, uniform_triangles; /* before the merges */
    uint64_t octree_merges, pair_merges;          /* in nodes of the octree, and afterwards of neighbours */
    /* By hewn_extract_parts(): */
    uint64_t parts;               /* that the mesh came in */
    uint64_t peak_memory;         /* most bytes in use at once, as max_memory counts them */
    uint64_t vertices, triangles; /* of the whole */
    hewn_extract_stage stages[8];
    uint32_t stage_count;
} hewn_extract_stats;

/* Compiles a field for a device. The field may be changed or destroyed afterwards. Serves one thread at a time, as its
 * device does, which must outlive it. */
HEWN_API hewn_result hewn_extractor_create(hewn_device *device, const hewn_field *field, hewn_node root,
                                           hewn_extractor **out, hewn_error *error);

/* Takes a field that differs from the extractor's in its numbers only (sizes, places, constants), and compiles nothing:
 * for programs in which somebody turns a knob. `*taken` tells whether it could. Where it is false the extractor is as
 * it was, and the field needs another one; that is so where the expression is another one (also where a factor became
 * 0 or 1, or ceased to be), or where it has so many numbers that the device has them in the code. Meshes made before
 * keep what they are. HEWN_OUT_OF_MEMORY. */
HEWN_API hewn_result hewn_extractor_renumber(hewn_extractor *extractor, const hewn_field *field, hewn_node root,
                                             bool *taken, hewn_error *error);
HEWN_API void hewn_extractor_destroy(hewn_extractor **extractor);

/* Meshes the field: f < 0 is inside, everything else (0 and NaN too) outside. The triangles may live in memory of the
 * device: destroy them before the device. HEWN_INVALID_ARGUMENT for bounds or a resolution that make no sense, or so
 * far from the origin that float positions cannot tell vertices apart; HEWN_BAD_INPUT where there is no surface, saying
 * why; HEWN_LIMIT; HEWN_CANCELLED; device errors. Vertices on grid edges are solved on the field itself;
 * docs/extraction.md says what each method guarantees. */
HEWN_API hewn_result hewn_extract(hewn_extractor *extractor, const hewn_extract_desc *desc, hewn_triangles *out,
                                  hewn_extract_stats *stats, hewn_error *error);

/* The same mesh in parts, which a sink takes one by one: for meshes that are larger than memory. The field is evaluated
 * twice, first to count. The sink takes a part on a thread of its own while the next one is made; both count for
 * `max_memory`. Parts are the same in every run, however long the sink takes; without a limit there is one. When this
 * returns the sink is done. Vertices and triangles are the bits that hewn_extract() gives, at the same places; so are
 * the statistics, but for the stages. Not for `adaptive` (HEWN_INVALID_ARGUMENT). HEWN_LIMIT for 2^32 - 1 vertices or
 * more and as hewn_extract(); HEWN_OUT_OF_DEVICE_MEMORY where even the least part needs more than `max_memory`, saying
 * how much; else as hewn_extract() and as the sink. After an error the sink may have taken some parts, also where there
 * is no surface but a cap (HEWN_BAD_INPUT). */
HEWN_API hewn_result hewn_extract_parts(hewn_extractor *extractor, const hewn_extract_desc *desc,
                                        const hewn_mesh_sink *sink, hewn_extract_stats *stats, hewn_error *error);

#ifdef __cplusplus
}
#endif
#endif
