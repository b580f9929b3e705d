/* The inside of a hewn_extractor: a field's kernels and the fixed ones, and the buffers of one run. */
#ifndef HEWN_SRC_ISO_EXTRACTOR_H
#define HEWN_SRC_ISO_EXTRACTOR_H

#include "hewn/extract.h"

#include "eval/lists.h"
#include "gpu/gpu.h"
#include "iso/dual.h"
#include "iso/grid.h"
#include "iso/region.h"

/* What only the trilinear interpolant's topology needs, made when it is first asked for. */
typedef struct hewn_mc33_programs {
    hewn_buffer table; /* hewn_mc33_table */
    hewn_program *ask, *decide, *count, *spread, *triangles, *centres;
} hewn_mc33_programs;

/* What looks for features thinner than a cell. */
typedef struct hewn_suspect_programs {
    hewn_program *cuts, *remote, *find;
} hewn_suspect_programs;
/* What only the methods with vertices in cells need, made when one is first asked for. */
typedef struct hewn_dual_programs {
    hewn_buffer table; /* hewn_dual_table */
    hewn_program *link, *classify, *spread, *quads, *fans;
    hewn_program *nets, *dc; /* vertices by each method, */
    hewn_program *asked;     /* or, where the host places them, what it asks */
} hewn_dual_programs;

struct hewn_extractor {
    hewn_device *device;
    hewn_code *code;
    hewn_scan *scan;
    bool far;          /* kernels take coordinates beyond HEWN_REACH too, see hewn_extractor_reach() */
    bool on_host;      /* the device is a CPU: stages that need no field are the host's, see iso/host_surface.h,
                          iso/host_lists.h */
    hewn_buffer table; /* hewn_mc_table */
    hewn_program *cull, *signs, *vertices;                        /* made of the field */
    hewn_program *choose, *keep_lists, *gather;                   /* instead of `cull` where it is in lists */
    hewn_program *clip;                                           /* for parts of a grid */
    hewn_program *compact, *link, *classify, *spread, *triangles; /* the same for all */
    hewn_suspect_programs suspects;
    hewn_mc33_programs mc33;
    hewn_dual_programs dual;
};

/* As hewn_extractor_create(), with a say in where the field's numbers live. */
hewn_result hewn_extractor_create_with(hewn_device *device, const hewn_field *field, hewn_node root,
                                       hewn_numbers numbers, hewn_extractor **out, hewn_error *error);

/* As hewn_extractor_create(), with a say in how the field is evaluated. */
hewn_result hewn_extractor_create_as(hewn_device *device, const hewn_field *field, hewn_node root,
                                     const hewn_code_desc *desc, hewn_extractor **out, hewn_error *error);

/* What kernels of the field add to their flavours. */
uint32_t hewn_extractor_flavour(const hewn_extractor *extractor);

/* Makes the field's kernels again for the first grid that lies farther out than those are for. */
hewn_result hewn_extractor_reach(hewn_extractor *extractor, const struct hewn_grid *grid, hewn_error *error);

/* Buffers that one run needs, all freed together. */
#define HEWN_WORKSPACE_MOST 96
typedef struct hewn_workspace {
    hewn_device *device;
    hewn_buffer buffers[HEWN_WORKSPACE_MOST];
    uint32_t count;
} hewn_workspace;

/* A buffer of the workspace; on failure `*out` is NULL. */
hewn_result hewn_workspace_take(hewn_workspace *workspace, const char *what, uint64_t bytes, hewn_buffer_use use,
                                hewn_buffer **out, hewn_error *error);
void hewn_workspace_clear(hewn_workspace *workspace);

/* Bytes of a device buffer for the host to read: in place where it can, else in a copy of the workspace. */
hewn_result hewn_workspace_read(hewn_workspace *workspace, const hewn_buffer *buffer, uint64_t offset, uint64_t bytes,
                                const void **out, hewn_error *error);

/* Brings a buffer to where the host reads it in place: where it lies elsewhere it becomes another one, of as many
 * bytes. After an error it is as it was. */
hewn_result hewn_buffer_bring_home(hewn_device *device, const char *what, hewn_buffer *buffer, hewn_error *error);

/* The bricks that culling kept. */
typedef struct hewn_bricks {
    uint32_t count;
    uint32_t levels;
    uint32_t top[3];         /* blocks of the coarsest level */
    uint32_t longest;        /* most instructions in a brick's list, where the host makes the lists; else 0 */
    uint32_t beyond;         /* in: so many cells around the blocks above bricks lists of theirs are good for too */
    const hewn_buffer *list; /* packed coordinates */
    const hewn_buffer *states[HEWN_MAX_LEVELS]; /* coarsest first */
} hewn_bricks;

/* Finds the bricks that may hold surface. */
hewn_result hewn_bricks_cull(const hewn_extractor *extractor, const struct hewn_grid *grid, hewn_workspace *workspace,
                             hewn_bricks *out, hewn_error *error);

/* The same for a field in lists, of which `extractor->code` then has those of the bricks. */
hewn_result hewn_bricks_cull_lists(const hewn_extractor *extractor, const struct hewn_grid *grid,
                                   const hewn_region *region, hewn_workspace *workspace, hewn_bricks *out,
                                   hewn_error *error);

/* The same for a part of the grid: the bricks of its own and those that it needs around them, in their order, and
 * memory is taken for what is there, not for what there might be. */
hewn_result hewn_bricks_cull_part(const hewn_extractor *extractor, const struct hewn_grid *grid,
                                  const hewn_region *region, hewn_workspace *workspace, hewn_bricks *out,
                                  hewn_error *error);

/* What of a surface is a part's own, by number: from the first one up to before the second. The rest is there for what
 * it takes to make that. */
typedef struct hewn_own {
    bool part; /* false: all of it is */
    uint64_t bricks[2], crossings[2], vertices[2], centres[2], triangles[2];
    const hewn_buffer *bases[2]; /* numbers of bricks' first crossings: its own, and those after; others have none */
} hewn_own;

/* The surface in those bricks, as counts and ranks on the device. */
typedef struct hewn_surface {
    uint64_t crossing_count; /* crossed edges of the grid */
    uint64_t vertex_count;   /* of the mesh: on those edges and in cells, or by the dual methods in cells only */
    uint64_t triangle_count;
    uint32_t centre_count; /* vertices in cells: the last ones */
    uint32_t fan_count;    /* quads that became fans */
    double sign_seconds;   /* of the seconds that the call took, those that went into the field's signs */
    const hewn_buffer *links, *signs, *edges, *vertex_bases, *triangle_bases;
    const hewn_buffer *centre_bases, *ranks, *asked;   /* of the trilinear interpolant's topology, else NULL */
    const hewn_buffer *lower, *loops, *crossing_bases; /* of the dual methods, whose triangle_bases count quads */
    hewn_own own;
} hewn_surface;

/* What is to be emitted: all of the surface where it is no part. */
hewn_own hewn_surface_own(const hewn_surface *surface);

hewn_result hewn_surface_classify(const hewn_extractor *extractor, const struct hewn_grid *grid,
                                  const hewn_bricks *bricks, hewn_workspace *workspace, hewn_surface *out,
                                  hewn_error *error);

/* The beginning of that: a recording of the signs of the bricks' samples, between its first two marks, and of the
 * bricks' neighbours. */
hewn_result hewn_surface_begin(const hewn_extractor *extractor, const struct hewn_grid *grid, const hewn_bricks *bricks,
                               const hewn_surface *surface, hewn_commands **out, hewn_error *error);

/* Makes what the trilinear interpolant's topology needs, if it is not there yet; and lets go of it. */
hewn_result hewn_mc33_prepare(hewn_extractor *extractor, hewn_error *error);
void hewn_mc33_clear(hewn_extractor *extractor);

/* Counts a classified surface again with that topology. */
hewn_result hewn_mc33_refine(const hewn_extractor *extractor, const struct hewn_grid *grid, const hewn_bricks *bricks,
                             hewn_workspace *workspace, hewn_surface *surface, hewn_error *error);

/* Parts of the emission of a refined surface: on the host the records of vertices and the triangles, on the device
 * records of both; and after the vertices on edges those in cells. */
void hewn_mc33_emit_on_host(const hewn_extractor *extractor, const struct hewn_grid *grid, const hewn_bricks *bricks,
                            const hewn_surface *surface, const hewn_buffer buffers[3]);
void hewn_mc33_record_spread(const hewn_extractor *extractor, const struct hewn_grid *grid, const hewn_bricks *bricks,
                             const hewn_surface *surface, const hewn_buffer buffers[3], hewn_commands *commands);
void hewn_mc33_record_centres(const hewn_extractor *extractor, const struct hewn_grid *grid, const hewn_bricks *bricks,
                              const hewn_surface *surface, const hewn_buffer buffers[3], const hewn_buffer *summary,
                              hewn_commands *commands);

/* Where crossings are solved: their records become positions, with normals beside them. */
typedef struct hewn_crossings {
    uint64_t first, end;      /* numbers */
    bool dual;                /* they are not the mesh's vertices */
    const hewn_buffer *bases; /* number of each brick's first, none outside of those */
    const hewn_buffer *positions, *normals;
    uint64_t summary; /* address of HEWN_SUMMARY_WORDS */
} hewn_crossings;

void hewn_crossings_record(const hewn_extractor *extractor, const struct hewn_grid *grid, const hewn_bricks *bricks,
                           const hewn_crossings *crossings, hewn_commands *commands);

/* What emission adds up; hewn_extract_stats says what it means. */
typedef struct hewn_emission {
    uint32_t caps;             /* vertices */
    uint32_t capped_crossings; /* of the surface's */
    uint32_t edge_vertices, corner_vertices, planes_found, features_lost;
    float max_residual;
    bool cut; /* the device ended loops early: what was made is wrong */
} hewn_emission;

/* The error for that. */
hewn_result hewn_emission_fail_cut(hewn_error *error);

/* Writes vertices and triangles into the three buffers. */
hewn_result hewn_surface_emit(const hewn_extractor *extractor, const struct hewn_grid *grid, const hewn_bricks *bricks,
                              const hewn_surface *surface, const hewn_buffer buffers[3], hewn_workspace *workspace,
                              hewn_emission *out, hewn_error *error);

/* Cells beyond the neighbourhood of the surface that may hold some all the same; docs/extraction.md has the definition.
 */
typedef struct hewn_suspects {
    uint64_t cells;
    uint64_t undefined;       /* not among them: cells for which the field has no bounds */
    uint32_t first[3];        /* of the cells, in the order of the grid, x fastest; its rim does not count */
    const hewn_buffer *marks; /* what they are, as hewn_suspect_push says; freed with the workspace */
} hewn_suspects;

hewn_result hewn_suspects_find(const hewn_extractor *extractor, const struct hewn_grid *grid, const hewn_bricks *bricks,
                               const hewn_surface *surface, hewn_workspace *workspace, hewn_suspects *out,
                               hewn_error *error);
/* --- methods with vertices in cells ------------------------------------------------------------------------------- */

/* Makes what such a method needs, if it is not there yet; and lets go of it. */
hewn_result hewn_dual_prepare(hewn_extractor *extractor, hewn_method method, hewn_error *error);
void hewn_dual_clear(hewn_extractor *extractor);

/* Dual contouring asks the field up to so many cells away from a vertex's cell. */
enum { HEWN_DUAL_BEYOND = 2 };

/* Takes the place of hewn_surface_classify(). */
hewn_result hewn_dual_classify(const hewn_extractor *extractor, const struct hewn_grid *grid, const hewn_bricks *bricks,
                               hewn_workspace *workspace, hewn_surface *out, hewn_error *error);

/* What the vertices were made of, in buffers of the workspace. */
typedef struct hewn_dual_hermite {
    const hewn_buffer *points, *normals; /* three floats a crossing */
    const hewn_buffer *records;          /* three words a vertex, see hewn_dual_spread_push */
    const hewn_buffer *crossings;        /* a quad: number of the crossing on its edge */
} hewn_dual_hermite;

/* Takes the place of hewn_surface_emit(): writes vertices and quads, two triangles each, into the three buffers. `keep`
 * is one of HEWN_KEEP_; `kept` may be NULL where it is HEWN_KEEP_NONE. */
hewn_result hewn_dual_emit(const hewn_extractor *extractor, const struct hewn_grid *grid, const hewn_bricks *bricks,
                           const hewn_surface *surface, hewn_method method, const hewn_buffer buffers[3],
                           hewn_workspace *workspace, uint32_t keep, hewn_dual_hermite *kept, hewn_emission *out,
                           hewn_error *error);

/* Makes fans of quads that two triangles cannot cut without perhaps meeting others, if the emission kept what that
 * needs (HEWN_KEEP_FANS). Where there are any, the buffers are made longer and the surface's counts greater: their
 * vertices follow all others, their further triangles the (part's own) quads. */
hewn_result hewn_dual_add_fans(const hewn_extractor *extractor, const hewn_dual_hermite *kept, hewn_surface *surface,
                               hewn_buffer buffers[3], hewn_workspace *workspace, hewn_error *error);

/* That surface in host memory: arrays of its own, and views of buffers that live as long as the workspace and the
 * buffers do. Zero is the empty one. */
typedef struct hewn_dual_reading {
    hewn_dual_surface surface;
    uint32_t *cells, *quads;
    float *residuals, *points, *gradients;
} hewn_dual_reading;

hewn_result hewn_dual_read(const hewn_extractor *extractor, const struct hewn_grid *grid, const hewn_bricks *bricks,
                           const hewn_surface *surface, const hewn_dual_hermite *kept, const hewn_buffer buffers[3],
                           hewn_workspace *workspace, hewn_dual_reading *out, hewn_error *error);
void hewn_dual_reading_clear(hewn_dual_reading *reading);

/* Workgroups of `size` invocations for `count` of them, laid out in two dimensions as shaders/shared/invocation.h reads
 * them. */
hewn_dispatch_size hewn_groups_for(uint64_t count, uint32_t size);

#endif
