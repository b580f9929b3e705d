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

/* The same as hewn_plane. */
HEWN_API hewn_node hewn_half_space(hewn_field *field, double nx, double ny, double nz, double distance);
/* The edges of a box of these outer sizes, `edge` thick (below half of the least size). */
HEWN_API hewn_node hewn_box_frame(hewn_field *field, double width, double height, double depth, double edge);
/* Radii along x, y, z; a lower bound of the distance. */
HEWN_API hewn_node hewn_ellipsoid(hewn_field *field, double x, double y, double z);
/* What a ball sweeps over from (0, -height/2, 0) to (0, height/2, 0) while its radius goes from `bottom` to `top`. */
HEWN_API hewn_node hewn_round_cone(hewn_field *field, double bottom, double top, double height);
/* A link of a chain in the xy plane: a torus that is cut and pulled apart by `length` along y. */
HEWN_API hewn_node hewn_link(hewn_field *field, double length, double major, double minor);
/* A regular polygon with this many corners at `radius`, along the y axis, a corner towards -z. */
HEWN_API hewn_node hewn_prism(hewn_field *field, unsigned sides, double radius, double height);
/* On a square of `width`, from -height/2 to the tip at height/2. Lower bounds of the distance, as the next four. */
HEWN_API hewn_node hewn_pyramid(hewn_field *field, double width, double height);
/* Regular solids by the radius of the ball around them; corners of the octahedron lie on the axes. */
HEWN_API hewn_node hewn_tetrahedron(hewn_field *field, double radius);
HEWN_API hewn_node hewn_octahedron(hewn_field *field, double radius);
HEWN_API hewn_node hewn_dodecahedron(hewn_field *field, double radius);
HEWN_API hewn_node hewn_icosahedron(hewn_field *field, double radius);
/* A round wire through `count` points (x, y, z triples; two or more); along cubic Bezier curves (an end, two controls,
 * an end, and so on), whose chords stay within a hundredth of the radius. Distances outside, lower bounds inside. */
HEWN_API hewn_node hewn_tube(hewn_field *field, const double *points, size_t count, double radius);
HEWN_API hewn_node hewn_bezier_tube(hewn_field *field, const double *points, size_t count, double radius);
/* A wire wound about the y axis, right-handed, `pitch` a turn, cut level at -height/2 and height/2. Near the wire about
 * a distance; no bound of one. */
HEWN_API hewn_node hewn_helix(hewn_field *field, double radius, double pitch, double height, double wire);

/* --- flat shapes: fields of x and y alone, endless along z -------------------------------------------------------- */

enum { HEWN_OUTLINE_MOST = 65536 /* points of a polygon */ };

HEWN_API hewn_node hewn_circle(hewn_field *field, double radius);
HEWN_API hewn_node hewn_rectangle(hewn_field *field, double width, double height);
HEWN_API hewn_node hewn_ellipse(hewn_field *field, double x, double y); /* a lower bound */
/* `count` corners (x, y pairs) in order, either way round; where sides cross, what lies within an odd number of loops
 * is inside. */
HEWN_API hewn_node hewn_polygon(hewn_field *field, const double *points, size_t count);
/* Several closed polygons at once, `counts[i]` corners of polygon i after those before it: inside is what an odd number
 * of loops is around, so that one within another is a hole. */
HEWN_API hewn_node hewn_contours(hewn_field *field, const double *points, const size_t *counts, size_t count);
/* Corners at `radius` (of the star in turn at `outer` and `inner`), the first one on the y axis. */
HEWN_API hewn_node hewn_regular_polygon(hewn_field *field, unsigned sides, double radius);
HEWN_API hewn_node hewn_star(hewn_field *field, unsigned corners, double outer, double inner);

/* A straight line (degree 1) or a Bezier curve from where the last one ended: `degree` points, the last of them its
 * end. */
typedef struct hewn_curve {
    unsigned degree; /* 1, 2 or 3 */
    double points[3][2];
} hewn_curve;

/* A closed outline; the first curve starts where the last one ends. Curves become chords, off by less than a 4,000th of
 * the greatest coordinate. */
HEWN_API hewn_node hewn_outline(hewn_field *field, const hewn_curve *curves, size_t count);

/* Along z from -height/2 to height/2. */
HEWN_API hewn_node hewn_extrude(hewn_field *field, hewn_node shape, double height);
/* Around the y axis what of the shape lies at x >= 0. */
HEWN_API hewn_node hewn_revolve(hewn_field *field, hewn_node shape);
/* From one shape at z = -height/2 to another at height/2, in between a mix of the two. */
HEWN_API hewn_node hewn_loft(hewn_field *field, hewn_node bottom, hewn_node top, double height);

/* --- periodic surfaces ----------------------------------------------------------------------------------------------
 * A walled sheet of about `thickness` (never less), or, where that is 0, one of the two halves of space. 1-Lipschitz.
 */

HEWN_API hewn_node hewn_gyroid(hewn_field *field, double period, double thickness);
HEWN_API hewn_node hewn_schwarz_p(hewn_field *field, double period, double thickness);
HEWN_API hewn_node hewn_schwarz_d(hewn_field *field, double period, double thickness);
HEWN_API hewn_node hewn_neovius(hewn_field *field, double period, double thickness);
HEWN_API hewn_node hewn_lidinoid(hewn_field *field, double period, double thickness);
HEWN_API hewn_node hewn_iwp(hewn_field *field, double period, double thickness);
HEWN_API hewn_node hewn_frd(hewn_field *field, double period, double thickness);
HEWN_API hewn_node hewn_fischer_koch_s(hewn_field *field, double period, double thickness);

/* --- noise: fields from -1 to 1, the same on every device --------------------------------------------------------- */

typedef enum hewn_noise_kind {
    HEWN_NOISE_VALUE,    /* random values at the corners of cells, and between them */
    HEWN_NOISE_GRADIENT, /* random slopes at the corners (Perlin) */
    HEWN_NOISE_SIMPLEX,  /* the same on a lattice of tetrahedra */
    HEWN_NOISE_CELLULAR  /* the distance to the nearest of one random point a cell (Worley): -1 there, 1 a cell away */
} hewn_noise_kind;

/* Cells of `size`; seeds below 2^24. */
HEWN_API hewn_node hewn_noise(hewn_field *field, hewn_noise_kind kind, double size, uint32_t seed);

typedef struct hewn_octaves {
    hewn_noise_kind kind;
    double size;       /* of the coarsest one's cells */
    unsigned octaves;  /* 1 to 16 */
    double gain;       /* how much less each octave counts; 0 is 0.5 */
    double lacunarity; /* how much finer it is; 0 is 2 */
    uint32_t seed;
} hewn_octaves;

HEWN_API hewn_node hewn_fbm(hewn_field *field, const hewn_octaves *octaves);    /* the octaves' weighted mean */
HEWN_API hewn_node hewn_ridged(hewn_field *field, const hewn_octaves *octaves); /* of 1 - 2 |noise|: crests */
HEWN_API hewn_node hewn_billow(hewn_field *field, const hewn_octaves *octaves); /* of 2 |noise| - 1: humps */

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

/* In one of the two, not in both. */
HEWN_API hewn_node hewn_xor(hewn_field *field, hewn_node a, hewn_node b);
/* Corners cut by a plane, rounded by a quarter circle, or cut into steps; `size` away from where the two meet. */
HEWN_API hewn_node hewn_chamfer_union(hewn_field *field, hewn_node a, hewn_node b, double size);
HEWN_API hewn_node hewn_chamfer_intersection(hewn_field *field, hewn_node a, hewn_node b, double size);
HEWN_API hewn_node hewn_chamfer_difference(hewn_field *field, hewn_node a, hewn_node b, double size);
HEWN_API hewn_node hewn_round_union(hewn_field *field, hewn_node a, hewn_node b, double size);
HEWN_API hewn_node hewn_round_intersection(hewn_field *field, hewn_node a, hewn_node b, double size);
HEWN_API hewn_node hewn_round_difference(hewn_field *field, hewn_node a, hewn_node b, double size);
HEWN_API hewn_node hewn_stairs_union(hewn_field *field, hewn_node a, hewn_node b, double size, unsigned steps);
HEWN_API hewn_node hewn_stairs_intersection(hewn_field *field, hewn_node a, hewn_node b, double size, unsigned steps);
HEWN_API hewn_node hewn_stairs_difference(hewn_field *field, hewn_node a, hewn_node b, double size, unsigned steps);

/* A wall of this thickness along the surface, half of it on either side. */
HEWN_API hewn_node hewn_shell(hewn_field *field, hewn_node shape, double thickness);
/* Grown by a distance (above 0: convex edges become round; below 0: concave ones). */
HEWN_API hewn_node hewn_offset(hewn_field *field, hewn_node shape, double distance);
/* Where `by` is above 0 the surface moves inwards by about that. */
HEWN_API hewn_node hewn_displace(hewn_field *field, hewn_node shape, hewn_node by);
/* a where `part` is 0, b where it is 1. */
HEWN_API hewn_node hewn_morph(hewn_field *field, hewn_node a, hewn_node b, hewn_node part);

/* --- paint --------------------------------------------------------------------------------------------------------
 * The shape with a colour or a label to it, which go wherever it goes. Of paint over paint the outer one counts. Blends
 * mix colours (in linear light) as they mix values, and take the label of the nearer part. What a shape without paint
 * cuts away from a painted one leaves it its paint; a painted one leaves its own on the cut. */

enum { HEWN_LABEL_MOST = 1 << 30 };

/* As on a screen (sRGB), 0 to 1. */
HEWN_API hewn_node hewn_color(hewn_field *field, hewn_node shape, double red, double green, double blue);
HEWN_API hewn_node hewn_label(hewn_field *field, hewn_node shape, uint32_t label);

/* Whether anything that the node depends on has a colour, or a label. */
HEWN_API bool hewn_field_has_colors(const hewn_field *field, hewn_node node);
HEWN_API bool hewn_field_has_labels(const hewn_field *field, hewn_node node);

/* The paint at points (x, y, z triples), meant for those on the surface: three linear components each to `colors`,
 * where nothing is painted a light grey, and a label each to `labels`, 0 for none. Either may be NULL. The same for any
 * number of threads. HEWN_OUT_OF_MEMORY, HEWN_INVALID_ARGUMENT for a node of no field. */
HEWN_API hewn_result hewn_field_paint(const hewn_field *field, hewn_node node, const double *points, size_t count,
                                      float *colors, int32_t *labels, hewn_error *error);

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

/* --- bending space ------------------------------------------------------------------------------------------------
 * Axes are 0, 1, 2 for x, y, z. */

enum { HEWN_COPIES_MOST = 65536 };

/* The mirror image; the half at positive coordinates with its mirror image. */
HEWN_API hewn_node hewn_mirror(hewn_field *field, hewn_node shape, int axis);
HEWN_API hewn_node hewn_symmetric(hewn_field *field, hewn_node shape, int axis);
/* nx ny nz copies, the first one in place, the others at multiples of (dx, dy, dz). */
HEWN_API hewn_node hewn_array(hewn_field *field, hewn_node shape, unsigned nx, unsigned ny, unsigned nz, double dx,
                              double dy, double dz);
/* Copies around an axis. */
HEWN_API hewn_node hewn_radial(hewn_field *field, hewn_node shape, unsigned count, int axis);
/* Copies without end, at multiples of these distances (0: not along that axis). The shape may reach as far as its
 * neighbours' origins. */
HEWN_API hewn_node hewn_tile(hewn_field *field, hewn_node shape, double dx, double dy, double dz);
/* The same with every other copy mirrored; only what lies within half a distance of the origin is repeated. */
HEWN_API hewn_node hewn_mirror_tile(hewn_field *field, hewn_node shape, double dx, double dy, double dz);
/* Turned about the y axis by `angle` (radians) for every unit of y. */
HEWN_API hewn_node hewn_twist(hewn_field *field, hewn_node shape, double angle);
/* The x axis bent to a circle in the xy plane, towards +y, by `angle` (radians) for every unit of x. */
HEWN_API hewn_node hewn_bend(hewn_field *field, hewn_node shape, double angle);
/* Scaled across y: by `bottom` at -height/2 and below, by `top` at height/2 and above, evenly between. */
HEWN_API hewn_node hewn_taper(hewn_field *field, hewn_node shape, double bottom, double top, double height);
/* Cut at the origin and pulled apart by these lengths, what is between filled straight. */
HEWN_API hewn_node hewn_elongate(hewn_field *field, hewn_node shape, double x, double y, double z);
/* Space pushed about by gradient noise, up to `amount` along each axis. */
HEWN_API hewn_node hewn_warp(hewn_field *field, hewn_node shape, double amount, double size, uint32_t seed);

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
