/* What goes into a GLB file: which attributes, how vertices are split for them, how triangles are ordered. */
#ifndef HEWN_SRC_IO_GLB_PLAN_H
#define HEWN_SRC_IO_GLB_PLAN_H

#include "io/formats.h"
#include "io/shim/gltf.h"

typedef enum hewn_glb_kind { HEWN_GLB_NORMAL, HEWN_GLB_UV, HEWN_GLB_COLOR, HEWN_GLB_OTHER } hewn_glb_kind;

/* A channel of vertices or corners that is written. */
typedef struct hewn_glb_layer {
    const hewn_channel *channel;
    hewn_glb_kind kind;
    hewn_gltf_stream stream; /* its semantic is owned */
} hewn_glb_layer;

/* glTF has attributes for vertices only, so those whose corners differ are split: the file's vertices are the model's,
 * with the values of the first corner that uses each, and then copies, in the order in which triangles need them. */
typedef struct hewn_glb_plan {
    hewn_conversion conversion;
    hewn_glb_layer *layers;
    size_t layer_count;
    bool corners;             /* some layer is of corners: the next four are there */
    uint32_t *vertex_corners; /* for each vertex of the file, where its corners' values are; HEWN_NONE: nowhere */
    uint32_t *copied;         /* the model's vertex of each copy */
    uint32_t *indices;        /* the file's vertex of each corner of the triangles, in their old order */
    uint64_t copy_count;
    uint32_t *order; /* the triangles in the file's order; NULL: as they are */
    hewn_gltf_run *runs;
    size_t run_count;
    hewn_gltf_topology topology;
    uint64_t merge_count; /* corners at copies */
} hewn_glb_plan;

/* Makes the plan of a job of triangles; free it also after an error. HEWN_LIMIT for a position that GLB's floats cannot
 * hold; HEWN_CANCELLED; HEWN_OUT_OF_MEMORY. */
hewn_result hewn_glb_plan_make(const hewn_writing *job, hewn_glb_plan *out, hewn_error *error);
void hewn_glb_plan_free(hewn_glb_plan *plan);

/* Whether the file will have a channel's values; looks at counts, channels and labels of the job only. */
bool hewn_glb_keeps(const hewn_writing *job, const hewn_channel *channel);

static inline uint64_t hewn_glb_vertex_count(const hewn_writing *job, const hewn_glb_plan *plan)
{
    return job->vertex_count + plan->copy_count;
}

/* The model's vertex behind one of the file's. */
static inline uint64_t hewn_glb_source(const hewn_writing *job, const hewn_glb_plan *plan, uint64_t vertex)
{
    return vertex < job->vertex_count ? vertex : plan->copied[vertex - job->vertex_count];
}

/* Index `index` of the file. */
static inline uint64_t hewn_glb_index(const hewn_writing *job, const hewn_glb_plan *plan, uint64_t index)
{
    uint64_t triangle = plan->order ? plan->order[index / 3] : index / 3, place[3];
    if (plan->indices)
        return plan->indices[3 * triangle + index % 3];
    hewn_writing_triangle(job, triangle, place);
    return job->corners[place[index % 3]];
}

/* A vertex' position in the file. */
void hewn_glb_position(const hewn_writing *job, const hewn_glb_plan *plan, uint64_t vertex, float out[3]);

#endif
