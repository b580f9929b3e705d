/* The inside of a hewn_extractor: a field's kernels and the fixed ones, and the buffers of one run. */
#ifndef HEWN_SRC_ISO_EXTRACTOR_H
#define HEWN_SRC_ISO_EXTRACTOR_H

#include "hewn/extract.h"

#include "eval/lists.h"
#include "gpu/gpu.h"
#include "iso/grid.h"

/* What only the trilinear interpolant's topology needs, made when it is first asked for. */
typedef struct hewn_mc33_programs {
    hewn_buffer table; /* hewn_mc33_table */
    hewn_program *ask, *decide, *count, *spread, *triangles, *centres;
} hewn_mc33_programs;

struct hewn_extractor {
    hewn_device *device;
    hewn_code *code;
    hewn_scan *scan;
    hewn_buffer table;                                            /* hewn_mc_table */
    hewn_program *cull, *signs, *vertices;                        /* made of the field */
    hewn_program *choose, *keep_lists, *gather;                   /* instead of `cull` where it is in lists */
    hewn_program *compact, *link, *classify, *spread, *triangles; /* the same for all */
    hewn_mc33_programs mc33;
};

/* As hewn_extractor_create(), with a say in where the field's numbers live. */
hewn_result hewn_extractor_create_with(hewn_device *device, const hewn_field *field, hewn_node root,
                                       hewn_numbers numbers, hewn_extractor **out, hewn_error *error);

/* As hewn_extractor_create(), with a say in how the field is evaluated. */
hewn_result hewn_extractor_create_as(hewn_device *device, const hewn_field *field, hewn_node root,
                                     const hewn_code_desc *desc, hewn_extractor **out, hewn_error *error);

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

/* The bricks that culling kept. */
typedef struct hewn_bricks {
    uint32_t count;
    uint32_t levels;
    uint32_t top[3];                            /* blocks of the coarsest level */
    const hewn_buffer *list;                    /* packed coordinates */
    const hewn_buffer *states[HEWN_MAX_LEVELS]; /* coarsest first */
} hewn_bricks;

/* Finds the bricks that may hold surface. */
hewn_result hewn_bricks_cull(const hewn_extractor *extractor, const struct hewn_grid *grid, hewn_workspace *workspace,
                             hewn_bricks *out, hewn_error *error);

/* The same for a field in lists, of which `extractor->code` then has those of the bricks. */
hewn_result hewn_bricks_cull_lists(const hewn_extractor *extractor, const struct hewn_grid *grid,
                                   hewn_workspace *workspace, hewn_bricks *out, hewn_error *error);

/* Levels of culling, blocks of the coarsest, and the cells along their sides. Bricks come in the order of their blocks,
 * so that vertices do in every kind of culling. */
uint32_t hewn_grid_levels(const struct hewn_grid *grid, uint32_t *levels, uint32_t top[3]);

/* The surface in those bricks, as counts and ranks on the device. */
typedef struct hewn_surface {
    uint64_t vertex_count; /* in cells too */
    uint64_t triangle_count;
    uint32_t centre_count; /* vertices in cells: the last ones */
    double sign_seconds;   /* of the seconds that the call took, those that went into the field's signs */
    const hewn_buffer *links, *signs, *edges, *vertex_bases, *triangle_bases;
    const hewn_buffer *centre_bases, *ranks, *asked; /* of the trilinear interpolant's topology, else NULL */
} hewn_surface;

hewn_result hewn_surface_classify(const hewn_extractor *extractor, const struct hewn_grid *grid,
                                  const hewn_bricks *bricks, hewn_workspace *workspace, hewn_surface *out,
                                  hewn_error *error);

/* Makes what the trilinear interpolant's topology needs, if it is not there yet; and lets go of it. */
hewn_result hewn_mc33_prepare(hewn_extractor *extractor, hewn_error *error);
void hewn_mc33_clear(hewn_extractor *extractor);

/* Counts a classified surface again with that topology. */
hewn_result hewn_mc33_refine(const hewn_extractor *extractor, const struct hewn_grid *grid, const hewn_bricks *bricks,
                             hewn_workspace *workspace, hewn_surface *surface, hewn_error *error);

/* Parts of the emission of a refined surface: the records, and after the vertices on edges those in cells. */
void hewn_mc33_record_spread(const hewn_extractor *extractor, const struct hewn_grid *grid, const hewn_bricks *bricks,
                             const hewn_surface *surface, const hewn_buffer buffers[3], hewn_commands *commands);
void hewn_mc33_record_centres(const hewn_extractor *extractor, const struct hewn_grid *grid, const hewn_bricks *bricks,
                              const hewn_surface *surface, const hewn_buffer buffers[3], const hewn_buffer *summary,
                              hewn_commands *commands);

/* What emission adds up. */
typedef struct hewn_emission {
    uint32_t caps;
    float max_residual;
} hewn_emission;

/* Writes vertices and triangles into the three buffers. */
hewn_result hewn_surface_emit(const hewn_extractor *extractor, const struct hewn_grid *grid, const hewn_bricks *bricks,
                              const hewn_surface *surface, const hewn_buffer buffers[3], hewn_workspace *workspace,
                              hewn_emission *out, hewn_error *error);

/* Workgroups of `size` invocations for `count` of them, laid out in two dimensions as shaders/shared/invocation.h reads
 * them. */
hewn_dispatch_size hewn_groups_for(uint64_t count, uint32_t size);

#endif
