/* What the kernel that follows rays shares with its host. */
#ifndef HEWN_SHADERS_SHARED_RENDER_H
#define HEWN_SHADERS_SHARED_RENDER_H

#include "shared/types.h"

/* What a ray met. */
#define HEWN_MET_NOTHING 0u
#define HEWN_MET_SURFACE 1u
#define HEWN_MET_GROUND 2u

/* A ray is eight floats: origin, where it begins, direction (unit), where it ends. What it met is eight words: place
 * along it, normal, light (0: in shadow, to 1), openness (1: nothing around, to 0), one of the above, and 1 where it
 * ran out of steps. */
#define HEWN_RAY_WORDS 8u

/* Evaluations that a ray may take; with those of its shadow they stay far below what CPU drivers let an invocation do.
 */
#define HEWN_RAY_STEPS 4096u
#define HEWN_SHADOW_STEPS 512u
#define HEWN_SKIP_STEPS 256u
#define HEWN_LIGHT_STEPS 48u

#define HEWN_TRACE_SHADE 1u  /* flags: find out about light and openness */
#define HEWN_TRACE_GROUND 2u /* there is a ground */

/* Follows rays. Cells divide the box: byte (x + n (y + n z)) says how many cells away, counted along the axis where
 * that is most, the nearest cell is that may hold surface; 0: this one. */
struct hewn_trace_push {
    HEWN_FLOATS rays;
    HEWN_FLOATS hits;
    HEWN_UINTS cells;
    float lo[3], hi[3];     /* the box: what is outside is not there */
    float light[3];         /* unit, towards it */
    float softness;         /* tangent of the angle that the light fills */
    float reach;            /* how far openness looks */
    float ground;           /* its height along the axis that is up */
    float steepness;        /* no slope of the field is steeper; 0: there is no bound, so intervals decide */
    float slope;            /* of the field, as it is common near the surface: turns values into distances */
    float slack;            /* rounding errors of values are below this */
    float nearness, spread; /* how near is on the surface: nearness + spread t */
    HEWN_UINT count;
    HEWN_UINT cells_across;
    HEWN_UINT up; /* axis */
    HEWN_UINT flags;
    HEWN_UINT pad;
};

#endif
