/* What follows rays, and where they are lit. */
#ifndef HEWN_SRC_RENDER_TRACER_H
#define HEWN_SRC_RENDER_TRACER_H

#include "hewn/render.h"
#include "shared/render.h"

typedef struct hewn_ray {
    float from[3];
    float begin;
    float along[3]; /* unit, no component 0 */
    float end;
} hewn_ray;

typedef struct hewn_met {
    float t; /* where on the ray; large where nothing was met */
    float normal[3];
    float light, openness;
    uint32_t what; /* HEWN_MET_... */
    uint32_t ran_out;
} hewn_met;

/* What rays look for. */
typedef struct hewn_stage {
    float light[3]; /* unit, towards it, no component 0 */
    float softness; /* tangent of the angle that it fills */
    float reach;    /* how far openness looks */
    float ground;   /* its height */
    uint32_t up;    /* axis */
    uint32_t flags; /* HEWN_TRACE_... */
    float nearness, spread;
    const float *corner_colors; /* of triangles, nine numbers each; NULL: nobody asks for colours */
    float *colors;              /* where they are asked for: three numbers a ray that meets the surface */
} hewn_stage;

typedef struct hewn_tracer {
    void *self;
    bool on_host;
    /* Follows `count` rays; neighbours should be alike. */
    hewn_result (*trace)(void *self, const hewn_stage *stage, const hewn_ray *rays, size_t count, hewn_met *met,
                         hewn_error *error);
    void (*destroy)(void *self);
} hewn_tracer;

hewn_result hewn_tracer_on_device(hewn_device *device, const hewn_field *field, hewn_node root, const hewn_box *box,
                                  hewn_tracer *out, bool *listed, hewn_error *error);
hewn_result hewn_tracer_on_host(const hewn_field *field, hewn_node root, const hewn_box *box, hewn_tracer *out,
                                hewn_error *error);
hewn_result hewn_tracer_of_triangles(const hewn_triangles *triangles, hewn_tracer *out, hewn_box *box,
                                     hewn_error *error);

/* A bound on how steep the field is anywhere in a box: |f(p) - f(q)| <= bound |p - q| for the real function. Infinite
 * where none is known. */
hewn_result hewn_steepness_bound(const hewn_field *field, hewn_node root, const hewn_box *box, double *out,
                                 hewn_error *error);

/* That bound counts for nothing where it is this many times the slope that is common: intervals then get on faster. */
#define HEWN_STEEPEST 6.0

/* The slope that is common where the field is near 0 in a box, 1 where nothing can be said; from a fixed set of points.
 */
hewn_result hewn_common_slope(const hewn_field *field, hewn_node root, const hewn_box *box, double *out,
                              hewn_error *error);

#endif
