/* Fields: implicit shapes as an expression graph. f > 0 outside, 0 on the surface, f < 0 inside.
 *
 * A hewn_field owns the nodes of one graph; a hewn_node is a small index into it. Nodes are hash-consed (the same
 * expression is the same node) and constants are folded. Operands must be nodes of the same field.
 *
 * Building cannot fail at a node: a bad operand or parameter, or a lack of memory, gives HEWN_NODE_NONE, every node
 * built from that is HEWN_NODE_NONE too, and hewn_field_status() says what went wrong first. So build freely and check
 * once.
 *
 * A field is changed by one thread at a time; any number of threads may evaluate it while nobody changes it. */
#ifndef HEWN_FIELD_H
#define HEWN_FIELD_H

#include "hewn/base.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct hewn_field hewn_field;

typedef struct hewn_node {
    uint32_t id;
} hewn_node;

#define HEWN_NODE_NONE ((hewn_node){0xFFFFFFFFu})

static inline bool hewn_node_is_none(hewn_node node)
{
    return node.id == 0xFFFFFFFFu;
}

/* An axis-aligned box, in scene units. */
typedef struct hewn_box {
    double lo[3];
    double hi[3];
} hewn_box;

/* A closed interval; lo > hi never occurs. "Anything, also NaN" is [-inf, inf] with `maybe_nan`. */
typedef struct hewn_interval {
    double lo;
    double hi;
    bool maybe_nan;
} hewn_interval;

/* --- life ------------------------------------------------------------------------------------------------------- */

HEWN_API hewn_result hewn_field_create(hewn_field **out, hewn_error *error);
HEWN_API void hewn_field_destroy(hewn_field **field);

/* HEWN_OK while every node asked for so far could be built; else the first failure. */
HEWN_API hewn_result hewn_field_status(const hewn_field *field, hewn_error *error);

/* Which node is the shape. HEWN_INVALID_ARGUMENT for none or a node of no field. */
HEWN_API hewn_result hewn_field_set_root(hewn_field *field, hewn_node root, hewn_error *error);
HEWN_API hewn_node hewn_field_root(const hewn_field *field);

/* --- arithmetic ------------------------------------------------------------------------------------------------- */

HEWN_API hewn_node hewn_x(hewn_field *field);
HEWN_API hewn_node hewn_y(hewn_field *field);
HEWN_API hewn_node hewn_z(hewn_field *field);
HEWN_API hewn_node hewn_constant(hewn_field *field, double value);

HEWN_API hewn_node hewn_neg(hewn_field *field, hewn_node a);
HEWN_API hewn_node hewn_abs(hewn_field *field, hewn_node a);
HEWN_API hewn_node hewn_sqrt(hewn_field *field, hewn_node a); /* NaN below 0 */
HEWN_API hewn_node hewn_square(hewn_field *field, hewn_node a);
HEWN_API hewn_node hewn_sin(hewn_field *field, hewn_node a); /* radians, as everywhere */
HEWN_API hewn_node hewn_cos(hewn_field *field, hewn_node a);
HEWN_API hewn_node hewn_tan(hewn_field *field, hewn_node a);
HEWN_API hewn_node hewn_asin(hewn_field *field, hewn_node a); /* NaN outside [-1, 1] */
HEWN_API hewn_node hewn_acos(hewn_field *field, hewn_node a);
HEWN_API hewn_node hewn_atan(hewn_field *field, hewn_node a);
HEWN_API hewn_node hewn_exp(hewn_field *field, hewn_node a);
HEWN_API hewn_node hewn_ln(hewn_field *field, hewn_node a); /* NaN below 0, -inf at 0 */
HEWN_API hewn_node hewn_floor(hewn_field *field, hewn_node a);
HEWN_API hewn_node hewn_ceil(hewn_field *field, hewn_node a);
HEWN_API hewn_node hewn_round(hewn_field *field, hewn_node a); /* halves away from zero */

HEWN_API hewn_node hewn_add(hewn_field *field, hewn_node a, hewn_node b);
HEWN_API hewn_node hewn_sub(hewn_field *field, hewn_node a, hewn_node b);
HEWN_API hewn_node hewn_mul(hewn_field *field, hewn_node a, hewn_node b);
HEWN_API hewn_node hewn_div(hewn_field *field, hewn_node a, hewn_node b);
HEWN_API hewn_node hewn_min(hewn_field *field, hewn_node a, hewn_node b); /* NaN if either is */
HEWN_API hewn_node hewn_max(hewn_field *field, hewn_node a, hewn_node b);
HEWN_API hewn_node hewn_mod(hewn_field *field, hewn_node a, hewn_node b); /* Euclidean: in [0, |b|) */
HEWN_API hewn_node hewn_atan2(hewn_field *field, hewn_node y, hewn_node x);

/* As fidget defines them: compare is -1, 0 or 1 (NaN if either is); `and` is a where a = 0, else b; `or` is a where a
 * != 0, else b; `not` is 1 where a = 0, else 0. */
HEWN_API hewn_node hewn_compare(hewn_field *field, hewn_node a, hewn_node b);
HEWN_API hewn_node hewn_logic_and(hewn_field *field, hewn_node a, hewn_node b);
HEWN_API hewn_node hewn_logic_or(hewn_field *field, hewn_node a, hewn_node b);
HEWN_API hewn_node hewn_logic_not(hewn_field *field, hewn_node a);

/* --- shapes, centred at the origin; lengths in scene units, all exact distances ------------------------------------
 */

HEWN_API hewn_node hewn_sphere(hewn_field *field, double radius);
HEWN_API hewn_node hewn_box_shape(hewn_field *field, double width, double height,
                                  double depth); /* full sizes along x, y, z */
/* The same outer size as the box, its edges rounded by `radius` (at most half the least size). */
HEWN_API hewn_node hewn_rounded_box(hewn_field *field, double width, double height, double depth, double radius);
/* A ring around the y axis: `major` from the centre to the tube's middle, `minor` the tube's radius. */
HEWN_API hewn_node hewn_torus(hewn_field *field, double major, double minor);
/* Around the y axis, from -height/2 to height/2. */
HEWN_API hewn_node hewn_cylinder(hewn_field *field, double radius, double height);
/* Around the y axis; `height` is between the centres of the two half-spheres. */
HEWN_API hewn_node hewn_capsule(hewn_field *field, double radius, double height);
/* A cone frustum around the y axis, `bottom` and `top` its radii at -height/2 and height/2; one of them may be 0. */
HEWN_API hewn_node hewn_cone(hewn_field *field, double bottom, double top, double height);
/* The half-space whose bounding plane lies `distance` from the origin along the normal, which points outward; the
 * normal need not be of length 1, but not 0. */
HEWN_API hewn_node hewn_plane(hewn_field *field, double nx, double ny, double nz, double distance);

/* --- combining --------------------------------------------------------------------------------------------------- */

typedef enum hewn_blend {
    HEWN_BLEND_QUADRATIC,  /* size: |a-b| below which the two melt together, a length */
    HEWN_BLEND_CUBIC,      /* size: the same, with a continuous second derivative */
    HEWN_BLEND_CIRCULAR,   /* size: the radius of the fillet between two planes at right angles */
    HEWN_BLEND_EXPONENTIAL /* size: k of -ln(e^-ka + e^-kb)/k, a reciprocal length */
} hewn_blend;

HEWN_API hewn_node hewn_union(hewn_field *field, hewn_node a, hewn_node b);        /* min(a, b) */
HEWN_API hewn_node hewn_intersection(hewn_field *field, hewn_node a, hewn_node b); /* max(a, b) */
HEWN_API hewn_node hewn_difference(hewn_field *field, hewn_node a, hewn_node b);   /* max(a, -b) */
HEWN_API hewn_node hewn_complement(hewn_field *field, hewn_node a);                /* -a */
HEWN_API hewn_node hewn_smooth_union(hewn_field *field, hewn_node a, hewn_node b, hewn_blend blend, double size);
HEWN_API hewn_node hewn_smooth_intersection(hewn_field *field, hewn_node a, hewn_node b, hewn_blend blend, double size);
HEWN_API hewn_node hewn_smooth_difference(hewn_field *field, hewn_node a, hewn_node b, hewn_blend blend, double size);

/* --- moving ------------------------------------------------------------------------------------------------------ */

HEWN_API hewn_node hewn_translate(hewn_field *field, hewn_node shape, double x, double y, double z);
/* About an axis through the origin, right-handed, `angle` in radians; the axis need not be of length 1, but not 0. */
HEWN_API hewn_node hewn_rotate(hewn_field *field, hewn_node shape, double x, double y, double z, double angle);
/* Uniform, factor > 0: distances stay exact. */
HEWN_API hewn_node hewn_scale(hewn_field *field, hewn_node shape, double factor);
/* Non-uniform, factors > 0: the value is scaled by the least factor, so that it stays a lower bound of the distance. */
HEWN_API hewn_node hewn_stretch(hewn_field *field, hewn_node shape, double x, double y, double z);
/* The shape with x, y, z replaced by other expressions. */
HEWN_API hewn_node hewn_remap(hewn_field *field, hewn_node shape, hewn_node x, hewn_node y, hewn_node z);

/* --- asking: the CPU oracle -------------------------------------------------------------------------------------- */

/* The field's value at `count` points (x, y, z triples, scene units), in double. HEWN_OUT_OF_MEMORY,
 * HEWN_INVALID_ARGUMENT for a node of no field. */
HEWN_API hewn_result hewn_field_eval(const hewn_field *field, hewn_node node, const double *points, size_t count,
                                     double *values, hewn_error *error);

/* Value and gradient by forward differentiation: four doubles a point (value, d/dx, d/dy, d/dz). Where a min or max
 * ties, the gradient is that of its first operand. */
HEWN_API hewn_result hewn_field_gradient(const hewn_field *field, hewn_node node, const double *points, size_t count,
                                         double *values_and_gradients, hewn_error *error);

/* Bounds on all values in a box, rounded outward; the box's sides may be infinite. */
HEWN_API hewn_result hewn_field_bound(const hewn_field *field, hewn_node node, const hewn_box *box, hewn_interval *out,
                                      hewn_error *error);

/* A box, proven to contain all points with a value of 0 or below (among those with coordinates up to 2^60), found from
 * the shapes in the graph and by interval arithmetic. HEWN_BAD_INPUT if none can be proven (the shape is infinite, or
 * too involved) or if the shape is empty. */
HEWN_API hewn_result hewn_field_find_box(const hewn_field *field, hewn_node node, hewn_box *out, hewn_error *error);

/* How many distinct nodes the value of `node` depends on, itself included. */
HEWN_API size_t hewn_field_size(const hewn_field *field, hewn_node node);

#ifdef __cplusplus
}
#endif
#endif
