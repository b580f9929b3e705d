#include "field/catalogue.h"

#include <math.h>

/* --- calls ---------------------------------------------------------------------------------------------------------
 */

#define V(i) (v[i].number)
#define U(i) ((unsigned)v[i].number)
#define F(i) (v[i].node)
#define CALL(name, ...)                                                                                                \
    static hewn_node call_##name(hewn_field *field, const hewn_argument *v)                                            \
    {                                                                                                                  \
        return hewn_##name(field, __VA_ARGS__);                                                                        \
    }

CALL(sphere, V(0))
CALL(box_shape, V(0), V(1), V(2))
CALL(rounded_box, V(0), V(1), V(2), V(3))
CALL(box_frame, V(0), V(1), V(2), V(3))
CALL(ellipsoid, V(0), V(1), V(2))
CALL(torus, V(0), V(1))
CALL(cylinder, V(0), V(1))
CALL(capsule, V(0), V(1))
CALL(cone, V(0), V(1), V(2))
CALL(round_cone, V(0), V(1), V(2))
CALL(plane, V(0), V(1), V(2), V(3))
CALL(half_space, V(0), V(1), V(2), V(3))
CALL(link, V(0), V(1), V(2))
CALL(prism, U(0), V(1), V(2))
CALL(pyramid, V(0), V(1))
CALL(tetrahedron, V(0))
CALL(octahedron, V(0))
CALL(dodecahedron, V(0))
CALL(icosahedron, V(0))
CALL(tube, v[0].points, v[0].count, V(1))
CALL(bezier_tube, v[0].points, v[0].count, V(1))
CALL(helix, V(0), V(1), V(2), V(3))
CALL(circle, V(0))
CALL(rectangle, V(0), V(1))
CALL(ellipse, V(0), V(1))
CALL(polygon, v[0].points, v[0].count)
CALL(regular_polygon, U(0), V(1))
CALL(star, U(0), V(1), V(2))
CALL(outline, v[0].curves, v[0].count)
CALL(extrude, F(0), V(1))
CALL(revolve, F(0))
CALL(loft, F(0), F(1), V(2))
CALL(gyroid, V(0), V(1))
CALL(schwarz_p, V(0), V(1))
CALL(schwarz_d, V(0), V(1))
CALL(neovius, V(0), V(1))
CALL(lidinoid, V(0), V(1))
CALL(iwp, V(0), V(1))
CALL(frd, V(0), V(1))
CALL(fischer_koch_s, V(0), V(1))
CALL(union, F(0), F(1))
CALL(intersection, F(0), F(1))
CALL(difference, F(0), F(1))
CALL(complement, F(0))
CALL(xor, F(0), F(1))
CALL(smooth_union, F(0), F(1), HEWN_BLEND_QUADRATIC, V(2))
CALL(smooth_intersection, F(0), F(1), HEWN_BLEND_QUADRATIC, V(2))
CALL(smooth_difference, F(0), F(1), HEWN_BLEND_QUADRATIC, V(2))
CALL(chamfer_union, F(0), F(1), V(2))
CALL(chamfer_intersection, F(0), F(1), V(2))
CALL(chamfer_difference, F(0), F(1), V(2))
CALL(round_union, F(0), F(1), V(2))
CALL(round_intersection, F(0), F(1), V(2))
CALL(round_difference, F(0), F(1), V(2))
CALL(stairs_union, F(0), F(1), V(2), U(3))
CALL(stairs_intersection, F(0), F(1), V(2), U(3))
CALL(stairs_difference, F(0), F(1), V(2), U(3))
CALL(shell, F(0), V(1))
CALL(offset, F(0), V(1))
CALL(displace, F(0), F(1))
CALL(morph, F(0), F(1), F(2))
CALL(color, F(0), V(1), V(2), V(3))
CALL(label, F(0), (uint32_t)V(1))
CALL(translate, F(0), V(1), V(2), V(3))
CALL(mirror, F(0), (int)V(1))
CALL(symmetric, F(0), (int)V(1))
CALL(array, F(0), U(1), U(2), U(3), V(4), V(5), V(6))
CALL(radial, F(0), U(1), (int)V(2))
CALL(tile, F(0), V(1), V(2), V(3))
CALL(mirror_tile, F(0), V(1), V(2), V(3))
CALL(twist, F(0), V(1))
CALL(bend, F(0), V(1))
CALL(taper, F(0), V(1), V(2), V(3))
CALL(elongate, F(0), V(1), V(2), V(3))
CALL(warp, F(0), V(1), V(2), (uint32_t)V(3))
CALL(noise, (hewn_noise_kind)V(2), V(0), (uint32_t)V(1))

#define OCTAVES                                                                                                        \
    &(hewn_octaves)                                                                                                    \
    {                                                                                                                  \
        (hewn_noise_kind) V(3), V(0), U(1), V(4), V(5), (uint32_t)V(2)                                                 \
    }
CALL(fbm, OCTAVES)
CALL(ridged, OCTAVES)
CALL(billow, OCTAVES)

static hewn_node call_rotate(hewn_field *field, const hewn_argument *v)
{
    return hewn_rotate(field, F(0), V(1), V(2), V(3), V(4));
}

static hewn_node call_scale(hewn_field *field, const hewn_argument *v)
{
    return hewn_stretch(field, F(0), V(1), V(2), V(3));
}

/* --- arguments -----------------------------------------------------------------------------------------------------
 */

#define SIZE(name)                                                                                                     \
    {                                                                                                                  \
        name, HEWN_ARGUMENT_POSITIVE, 0, 0, false, 0                                                                   \
    }
#define LENGTH(name)                                                                                                   \
    {                                                                                                                  \
        name, HEWN_ARGUMENT_NOT_NEGATIVE, 0, 0, false, 0                                                               \
    }
#define NUMBER(name)                                                                                                   \
    {                                                                                                                  \
        name, HEWN_ARGUMENT_NUMBER, 0, 0, false, 0                                                                     \
    }
#define ANGLE(name)                                                                                                    \
    {                                                                                                                  \
        name, HEWN_ARGUMENT_ANGLE, 0, 0, false, 0                                                                      \
    }
#define FIELD(name)                                                                                                    \
    {                                                                                                                  \
        name, HEWN_ARGUMENT_FIELD, 0, 0, false, 0                                                                      \
    }
#define OPERAND(name)                                                                                                  \
    {                                                                                                                  \
        name, HEWN_ARGUMENT_OPERAND, 0, 0, false, 0                                                                    \
    }
#define WHOLE(name, least, most)                                                                                       \
    {                                                                                                                  \
        name, HEWN_ARGUMENT_WHOLE, least, most, false, 0                                                               \
    }
#define AXIS                                                                                                           \
    {                                                                                                                  \
        "axis", HEWN_ARGUMENT_AXIS, 0, 0, false, 0                                                                     \
    }
#define AXIS_ELSE(otherwise)                                                                                           \
    {                                                                                                                  \
        "axis", HEWN_ARGUMENT_AXIS, 0, 0, true, otherwise                                                              \
    }
#define POINTS                                                                                                         \
    {                                                                                                                  \
        "points", HEWN_ARGUMENT_POINTS, 0, 0, false, 0                                                                 \
    }
#define FLAT_POINTS                                                                                                    \
    {                                                                                                                  \
        "points", HEWN_ARGUMENT_FLAT_POINTS, 0, 0, false, 0                                                            \
    }
#define CURVES                                                                                                         \
    {                                                                                                                  \
        "curves", HEWN_ARGUMENT_CURVES, 0, 0, false, 0                                                                 \
    }
#define PART(name)                                                                                                     \
    {                                                                                                                  \
        name, HEWN_ARGUMENT_PART, 0, 0, false, 0                                                                       \
    }
#define SEED                                                                                                           \
    {                                                                                                                  \
        "seed", HEWN_ARGUMENT_WHOLE, 0, 16777215, true, 0                                                              \
    }
#define KIND                                                                                                           \
    {                                                                                                                  \
        "kind", HEWN_ARGUMENT_NOISE, 0, 0, true, HEWN_NOISE_GRADIENT                                                   \
    }
#define THICKNESS                                                                                                      \
    {                                                                                                                  \
        "thickness", HEWN_ARGUMENT_NOT_NEGATIVE, 0, 0, true, 0                                                         \
    }
#define OCTAVE_ARGUMENTS                                                                                               \
    SIZE("size"), WHOLE("octaves", 1, 16), SEED, KIND, {"gain", HEWN_ARGUMENT_POSITIVE, 0, 0, true, 0.5},              \
    {                                                                                                                  \
        "lacunarity", HEWN_ARGUMENT_POSITIVE, 0, 0, true, 2                                                            \
    }

#define ROOT_OF_2 1.41422

/* clang-format off */
const hewn_function hewn_functions[] = {
    {"sphere", HEWN_SECTION_SOLIDS, HEWN_EXACT, 1, 0, NULL, "ball", {SIZE("radius")}, call_sphere},
    {"box", HEWN_SECTION_SOLIDS, HEWN_EXACT, 1, 0, "box(width, height, depth)",
     "box of these full sizes along x, y and z; `box(size)` is a cube", {SIZE("width"), SIZE("height"), SIZE("depth")},
     call_box_shape},
    {"rounded_box", HEWN_SECTION_SOLIDS, HEWN_EXACT, 1, 0, "rounded_box(width, height, depth, radius)",
     "the same outer sizes with rounded edges; the radius is at most half the least size",
     {SIZE("width"), SIZE("height"), SIZE("depth"), SIZE("radius")}, call_rounded_box},
    {"box_frame", HEWN_SECTION_SOLIDS, HEWN_EXACT_OUTSIDE, 1, 0, NULL,
     "the twelve edges of a box of these outer sizes, `edge` thick",
     {SIZE("width"), SIZE("height"), SIZE("depth"), SIZE("edge")}, call_box_frame},
    {"ellipsoid", HEWN_SECTION_SOLIDS, HEWN_BOUND, 1, 0, NULL, "ball with these radii along x, y and z",
     {SIZE("x"), SIZE("y"), SIZE("z")}, call_ellipsoid},
    {"torus", HEWN_SECTION_SOLIDS, HEWN_EXACT, 1, 0, NULL,
     "ring around the y axis: radius of the ring, radius of the tube", {SIZE("major"), SIZE("minor")}, call_torus},
    {"cylinder", HEWN_SECTION_SOLIDS, HEWN_EXACT, 1, 0, NULL, "along the y axis, from −height/2 to height/2",
     {SIZE("radius"), SIZE("height")}, call_cylinder},
    {"capsule", HEWN_SECTION_SOLIDS, HEWN_EXACT, 1, 0, NULL,
     "along the y axis; the height is between the centres of its two round ends and may be 0",
     {SIZE("radius"), LENGTH("height")}, call_capsule},
    {"cone", HEWN_SECTION_SOLIDS, HEWN_EXACT, 1, 0, "cone(bottom, top, height)",
     "along the y axis; the radii at the lower and the upper end, one of which may be 0",
     {SIZE("bottom"), SIZE("top"), SIZE("height")}, call_cone},
    {"round_cone", HEWN_SECTION_SOLIDS, HEWN_EXACT, 1, 0, NULL,
     "along the y axis between two balls of these radii, whose centres are `height` apart",
     {SIZE("bottom"), SIZE("top"), SIZE("height")}, call_round_cone},
    {"plane", HEWN_SECTION_SOLIDS, HEWN_EXACT, 1, 0, "plane(nx, ny, nz, distance)",
     "the half-space behind a plane: the normal points out of it, the plane lies at `distance` from the origin along the "
     "normal, which need not be of length 1", {NUMBER("nx"), NUMBER("ny"), NUMBER("nz"), NUMBER("distance")}, call_plane},
    {"half_space", HEWN_SECTION_SOLIDS, HEWN_EXACT, 1, 0, "half_space(nx, ny, nz, distance)", "another name of `plane`",
     {NUMBER("nx"), NUMBER("ny"), NUMBER("nz"), NUMBER("distance")}, call_half_space},
    {"link", HEWN_SECTION_SOLIDS, HEWN_EXACT, 1, 0, NULL,
     "link of a chain in the xy plane: a ring pulled apart by `length` along y",
     {LENGTH("length"), SIZE("major"), SIZE("minor")}, call_link},
    {"prism", HEWN_SECTION_SOLIDS, HEWN_EXACT, 1, 0, NULL, "regular polygon, corners at `radius`, along the y axis",
     {WHOLE("sides", 3, 1024), SIZE("radius"), SIZE("height")}, call_prism},
    {"pyramid", HEWN_SECTION_SOLIDS, HEWN_BOUND, 1, 0, NULL, "on a square of `width` at −height/2, its tip at height/2",
     {SIZE("width"), SIZE("height")}, call_pyramid},
    {"tetrahedron", HEWN_SECTION_SOLIDS, HEWN_BOUND, 1, 0, NULL, "4 faces, corners at `radius`", {SIZE("radius")},
     call_tetrahedron},
    {"octahedron", HEWN_SECTION_SOLIDS, HEWN_BOUND, 1, 0, NULL, "8 faces, corners on the axes at `radius`",
     {SIZE("radius")}, call_octahedron},
    {"dodecahedron", HEWN_SECTION_SOLIDS, HEWN_BOUND, 1, 0, NULL, "12 faces, corners at `radius`", {SIZE("radius")},
     call_dodecahedron},
    {"icosahedron", HEWN_SECTION_SOLIDS, HEWN_BOUND, 1, 0, NULL, "20 faces, corners at `radius`", {SIZE("radius")},
     call_icosahedron},
    {"tube", HEWN_SECTION_SOLIDS, HEWN_EXACT_OUTSIDE, 1, 0, NULL, "round wire through a list of points `{x, y, z}`",
     {POINTS, SIZE("radius")}, call_tube},
    {"bezier_tube", HEWN_SECTION_SOLIDS, HEWN_BOUND, 1, 0, NULL,
     "round wire along cubic Bézier curves: an end, two controls, an end, two controls, …", {POINTS, SIZE("radius")},
     call_bezier_tube},
    {"helix", HEWN_SECTION_SOLIDS, HEWN_LOOSE, 0, 0, NULL,
     "wire of radius `wire` wound about the y axis, `pitch` a turn, cut level at −height/2 and height/2",
     {SIZE("radius"), SIZE("pitch"), SIZE("height"), SIZE("wire")}, call_helix},

    {"circle", HEWN_SECTION_FLAT, HEWN_EXACT, 1, 0, NULL, "disk", {SIZE("radius")}, call_circle},
    {"rectangle", HEWN_SECTION_FLAT, HEWN_EXACT, 1, 0, NULL, "of these full sizes along x and y",
     {SIZE("width"), SIZE("height")}, call_rectangle},
    {"ellipse", HEWN_SECTION_FLAT, HEWN_BOUND, 1, 0, NULL, "with these radii along x and y", {SIZE("x"), SIZE("y")},
     call_ellipse},
    {"polygon", HEWN_SECTION_FLAT, HEWN_EXACT, 1, 0, NULL,
     "corners `{x, y}` in a list, either way round; where sides cross, inside is what an odd number of loops is around",
     {FLAT_POINTS}, call_polygon},
    {"regular_polygon", HEWN_SECTION_FLAT, HEWN_EXACT, 1, 0, NULL, "corners at `radius`, the first on the y axis",
     {WHOLE("sides", 3, 1024), SIZE("radius")}, call_regular_polygon},
    {"star", HEWN_SECTION_FLAT, HEWN_EXACT, 1, 0, NULL, "corners in turn at `outer` and `inner`, the first on the y axis",
     {WHOLE("corners", 2, 512), SIZE("outer"), SIZE("inner")}, call_star},
    {"outline", HEWN_SECTION_FLAT, HEWN_EXACT, 1, 0, NULL,
     "closed outline of lines `{x, y}`, quadratic `{cx, cy, x, y}` and cubic `{cx, cy, dx, dy, x, y}` curves, each from "
     "where the one before it ends", {CURVES}, call_outline},

    {"extrude", HEWN_SECTION_SPACE, HEWN_EXACT, 1, 0, NULL, "along z, from −height/2 to height/2",
     {FIELD("shape"), SIZE("height")}, call_extrude},
    {"revolve", HEWN_SECTION_SPACE, HEWN_EXACT, 1, 0, NULL, "what lies at x ≥ 0, turned around the y axis",
     {FIELD("shape")}, call_revolve},
    {"loft", HEWN_SECTION_SPACE, HEWN_LOOSE, 0, 0, NULL,
     "from one shape at z = −height/2 to another at height/2, between them a mix of the two",
     {FIELD("bottom"), FIELD("top"), SIZE("height")}, call_loft},

    {"gyroid", HEWN_SECTION_SURFACES, HEWN_BOUND, 1, 0, NULL, "Schoen's gyroid", {SIZE("period"), THICKNESS}, call_gyroid},
    {"schwarz_p", HEWN_SECTION_SURFACES, HEWN_BOUND, 1, 0, NULL, "Schwarz's primitive surface",
     {SIZE("period"), THICKNESS}, call_schwarz_p},
    {"schwarz_d", HEWN_SECTION_SURFACES, HEWN_BOUND, 1, 0, NULL, "Schwarz's diamond surface",
     {SIZE("period"), THICKNESS}, call_schwarz_d},
    {"neovius", HEWN_SECTION_SURFACES, HEWN_BOUND, 1, 0, NULL, "Neovius' surface", {SIZE("period"), THICKNESS},
     call_neovius},
    {"lidinoid", HEWN_SECTION_SURFACES, HEWN_BOUND, 1, 0, NULL, "Lidin's surface", {SIZE("period"), THICKNESS},
     call_lidinoid},
    {"iwp", HEWN_SECTION_SURFACES, HEWN_BOUND, 1, 0, NULL, "Schoen's I-WP", {SIZE("period"), THICKNESS}, call_iwp},
    {"frd", HEWN_SECTION_SURFACES, HEWN_BOUND, 1, 0, NULL, "Schoen's F-RD", {SIZE("period"), THICKNESS}, call_frd},
    {"fischer_koch_s", HEWN_SECTION_SURFACES, HEWN_BOUND, 1, 0, NULL, "Fischer and Koch's S", {SIZE("period"), THICKNESS},
     call_fischer_koch_s},

    {"noise", HEWN_SECTION_NOISE, HEWN_LOOSE, 12.2, 1, NULL, "noise over cells of `size`", {SIZE("size"), SEED, KIND},
     call_noise},
    {"fbm", HEWN_SECTION_NOISE, HEWN_LOOSE, 0, 0, NULL,
     "octaves of noise, each `lacunarity` times as fine and counting `gain` times as much as the one before",
     {OCTAVE_ARGUMENTS}, call_fbm},
    {"ridged", HEWN_SECTION_NOISE, HEWN_LOOSE, 0, 0, NULL, "the same of 1 − 2 |noise|: crests", {OCTAVE_ARGUMENTS},
     call_ridged},
    {"billow", HEWN_SECTION_NOISE, HEWN_LOOSE, 0, 0, NULL, "the same of 2 |noise| − 1: humps", {OCTAVE_ARGUMENTS},
     call_billow},

    {"mesh_field", HEWN_SECTION_FILES, HEWN_LOOSE, 0, 0, "mesh_field(file [, {cell=, band=, dense=, memory=}])",
     "the shape in a mesh file, sampled at every `cell` near its surface", {{0}}, NULL},
    {"heightmap", HEWN_SECTION_FILES, HEWN_BOUND, 1, 0,
     "heightmap(file, {size= [, height=, dims=, type=, endian=, offset=]})",
     "the land under the heights in an image: PNG, TIFF, raw samples", {{0}}, NULL},

    {"union", HEWN_SECTION_COMBINING, HEWN_EXACT_OUTSIDE, 1, 0, "union(a, ...)",
     "what lies in one of them: the minimum", {FIELD("a"), FIELD("b")}, call_union},
    {"intersection", HEWN_SECTION_COMBINING, HEWN_BOUND, 1, 0, "intersection(a, ...)",
     "what lies in all of them: the maximum", {FIELD("a"), FIELD("b")}, call_intersection},
    {"difference", HEWN_SECTION_COMBINING, HEWN_BOUND, 1, 0, "difference(a, ...)", "the first without the others",
     {FIELD("a"), FIELD("b")}, call_difference},
    {"subtract", HEWN_SECTION_COMBINING, HEWN_BOUND, 1, 0, "subtract(a, ...)", "another name of `difference`", {{0}}, NULL},
    {"complement", HEWN_SECTION_COMBINING, HEWN_EXACT, 1, 0, "complement(a)", "what lies outside", {FIELD("a")},
     call_complement},
    {"xor", HEWN_SECTION_COMBINING, HEWN_BOUND, 1, 0, NULL, "what lies in one of the two and not in both",
     {FIELD("a"), FIELD("b")}, call_xor},
    {"smooth_union", HEWN_SECTION_COMBINING, HEWN_BOUND, 1, 0, "smooth_union(a, b, size [, blend])",
     "union with a fillet", {FIELD("a"), FIELD("b"), SIZE("size")}, call_smooth_union},
    {"smooth_intersection", HEWN_SECTION_COMBINING, HEWN_BOUND, 1, 0, "smooth_intersection(a, b, size [, blend])",
     "intersection with a rounded edge", {FIELD("a"), FIELD("b"), SIZE("size")}, call_smooth_intersection},
    {"smooth_difference", HEWN_SECTION_COMBINING, HEWN_BOUND, 1, 0, "smooth_difference(a, b, size [, blend])",
     "`a` without `b`, with a rounded edge", {FIELD("a"), FIELD("b"), SIZE("size")}, call_smooth_difference},
    {"chamfer_union", HEWN_SECTION_COMBINING, HEWN_LOOSE, ROOT_OF_2, 0, NULL,
     "union whose inner corner is filled by a plane, `size` away along both",
     {FIELD("a"), FIELD("b"), SIZE("size")}, call_chamfer_union},
    {"chamfer_intersection", HEWN_SECTION_COMBINING, HEWN_LOOSE, ROOT_OF_2, 0, NULL,
     "intersection whose edge is cut off by a plane", {FIELD("a"), FIELD("b"), SIZE("size")}, call_chamfer_intersection},
    {"chamfer_difference", HEWN_SECTION_COMBINING, HEWN_LOOSE, ROOT_OF_2, 0, NULL,
     "`a` without `b`, the edge cut off by a plane", {FIELD("a"), FIELD("b"), SIZE("size")}, call_chamfer_difference},
    {"round_union", HEWN_SECTION_COMBINING, HEWN_LOOSE, ROOT_OF_2, 0, NULL,
     "union with a fillet that is a quarter of a circle of this radius",
     {FIELD("a"), FIELD("b"), SIZE("size")}, call_round_union},
    {"round_intersection", HEWN_SECTION_COMBINING, HEWN_LOOSE, ROOT_OF_2, 0, NULL, "intersection with such an edge",
     {FIELD("a"), FIELD("b"), SIZE("size")}, call_round_intersection},
    {"round_difference", HEWN_SECTION_COMBINING, HEWN_LOOSE, ROOT_OF_2, 0, NULL, "`a` without `b` with such an edge",
     {FIELD("a"), FIELD("b"), SIZE("size")}, call_round_difference},
    {"stairs_union", HEWN_SECTION_COMBINING, HEWN_LOOSE, ROOT_OF_2, 0, NULL,
     "union with that many steps in the inner corner",
     {FIELD("a"), FIELD("b"), SIZE("size"), WHOLE("steps", 1, 1024)}, call_stairs_union},
    {"stairs_intersection", HEWN_SECTION_COMBINING, HEWN_LOOSE, ROOT_OF_2, 0, NULL, "intersection with steps at its edge",
     {FIELD("a"), FIELD("b"), SIZE("size"), WHOLE("steps", 1, 1024)}, call_stairs_intersection},
    {"stairs_difference", HEWN_SECTION_COMBINING, HEWN_LOOSE, ROOT_OF_2, 0, NULL,
     "`a` without `b` with steps at its edge", {FIELD("a"), FIELD("b"), SIZE("size"), WHOLE("steps", 1, 1024)},
     call_stairs_difference},

    {"shell", HEWN_SECTION_CHANGING, HEWN_BOUND, 1, 0, NULL, "wall of this thickness along the surface, half on either side",
     {FIELD("shape"), SIZE("thickness")}, call_shell},
    {"offset", HEWN_SECTION_CHANGING, HEWN_BOUND, 1, 0, NULL,
     "grown by a distance, which rounds convex edges; below 0: shrunk", {FIELD("shape"), NUMBER("distance")}, call_offset},
    {"displace", HEWN_SECTION_CHANGING, HEWN_LOOSE, 0, 0, NULL,
     "the surface moved inwards where `by`, a field, is above 0, and outwards where it is below",
     {FIELD("shape"), OPERAND("by")}, call_displace},
    {"morph", HEWN_SECTION_CHANGING, HEWN_LOOSE, 0, 0, NULL,
     "`a` where `part` (a field or a number) is 0, `b` where it is 1, a mix between",
     {FIELD("a"), FIELD("b"), OPERAND("part")}, call_morph},

    {"color", HEWN_SECTION_PAINT, HEWN_EXACT, 1, 0, "color(a, red, green, blue)",
     "the shape in a colour, as on a screen, each from 0 to 1; `color(a, \"#rrggbb\")` too",
     {FIELD("a"), PART("red"), PART("green"), PART("blue")}, call_color},
    {"label", HEWN_SECTION_PAINT, HEWN_EXACT, 1, 0, NULL,
     "the shape with a number, which the mesh's faces carry", {FIELD("a"), WHOLE("label", 0, HEWN_LABEL_MOST)}, call_label},

    {"translate", HEWN_SECTION_MOVING, HEWN_EXACT, 1, 0, "translate(a, x, y, z)", "moved by that much",
     {FIELD("a"), NUMBER("x"), NUMBER("y"), NUMBER("z")}, call_translate},
    {"move", HEWN_SECTION_MOVING, HEWN_EXACT, 1, 0, "move(a, x, y, z)", "another name of `translate`", {{0}}, NULL},
    {"rotate", HEWN_SECTION_MOVING, HEWN_EXACT, 1, 0, "rotate(a, x, y, z, degrees)",
     "turned about the axis with that direction; `rotate(a, axis, degrees)`: about `\"x\"`, `\"y\"` or `\"z\"`",
     {FIELD("a"), SIZE("x"), SIZE("y"), SIZE("z"), ANGLE("degrees")}, call_rotate},
    {"rotate_x", HEWN_SECTION_MOVING, HEWN_EXACT, 1, 0, "rotate_x(a, degrees)", "turned about x", {{0}}, NULL},
    {"rotate_y", HEWN_SECTION_MOVING, HEWN_EXACT, 1, 0, "rotate_y(a, degrees)", "turned about y", {{0}}, NULL},
    {"rotate_z", HEWN_SECTION_MOVING, HEWN_EXACT, 1, 0, "rotate_z(a, degrees)", "turned about z", {{0}}, NULL},
    {"scale", HEWN_SECTION_MOVING, HEWN_BOUND, 1, 0, "scale(a, x, y, z)",
     "stretched differently along the axes; with one factor, `scale(a, factor)`, distances stay exact",
     {FIELD("a"), SIZE("x"), SIZE("y"), SIZE("z")}, call_scale},
    {"mirror", HEWN_SECTION_MOVING, HEWN_EXACT, 1, 0, NULL, "the mirror image along `\"x\"`, `\"y\"` or `\"z\"`",
     {FIELD("a"), AXIS}, call_mirror},
    {"remap", HEWN_SECTION_MOVING, HEWN_LOOSE, 0, 0, "remap(a, x, y, z)",
     "with its coordinates replaced by other fields or numbers", {{0}}, NULL},

    {"symmetric", HEWN_SECTION_BENDING, HEWN_BOUND, 1, 0, NULL,
     "the half at positive coordinates along an axis, with its mirror image", {FIELD("a"), AXIS}, call_symmetric},
    {"array", HEWN_SECTION_BENDING, HEWN_EXACT_OUTSIDE, 1, 0, NULL,
     "nx · ny · nz copies, the first in place, the others at multiples of dx, dy and dz",
     {FIELD("a"), WHOLE("nx", 1, HEWN_COPIES_MOST), WHOLE("ny", 1, HEWN_COPIES_MOST), WHOLE("nz", 1, HEWN_COPIES_MOST),
      NUMBER("dx"), NUMBER("dy"), NUMBER("dz")}, call_array},
    {"radial", HEWN_SECTION_BENDING, HEWN_EXACT_OUTSIDE, 1, 0, NULL, "copies around an axis, `\"y\"` unless another is named",
     {FIELD("a"), WHOLE("count", 1, HEWN_COPIES_MOST), AXIS_ELSE(1)}, call_radial},
    {"tile", HEWN_SECTION_BENDING, HEWN_LOOSE, 0, 0, NULL,
     "copies without end at multiples of dx, dy and dz (0: none along that axis); the shape may reach as far as its "
     "neighbours' origins", {FIELD("a"), LENGTH("dx"), LENGTH("dy"), LENGTH("dz")}, call_tile},
    {"mirror_tile", HEWN_SECTION_BENDING, HEWN_BOUND, 1, 0, NULL,
     "the same with every other copy mirrored; only what lies within half a distance of the origin is repeated",
     {FIELD("a"), LENGTH("dx"), LENGTH("dy"), LENGTH("dz")}, call_mirror_tile},
    {"twist", HEWN_SECTION_BENDING, HEWN_LOOSE, 0, 0, NULL, "turned about the y axis by that angle for every unit of y",
     {FIELD("a"), ANGLE("degrees")}, call_twist},
    {"bend", HEWN_SECTION_BENDING, HEWN_LOOSE, 0, 0, NULL,
     "the x axis bent to a circle towards +y, by that angle for every unit of x", {FIELD("a"), ANGLE("degrees")}, call_bend},
    {"taper", HEWN_SECTION_BENDING, HEWN_LOOSE, 0, 0, NULL,
     "scaled across y: by `bottom` up to −height/2, by `top` from height/2, evenly between",
     {FIELD("a"), SIZE("bottom"), SIZE("top"), SIZE("height")}, call_taper},
    {"elongate", HEWN_SECTION_BENDING, HEWN_BOUND, 1, 0, NULL, "cut at the origin and pulled apart by these lengths",
     {FIELD("a"), LENGTH("x"), LENGTH("y"), LENGTH("z")}, call_elongate},
    {"warp", HEWN_SECTION_BENDING, HEWN_LOOSE, 0, 0, NULL,
     "space pushed about by gradient noise over cells of `size`, up to `amount` along each axis",
     {FIELD("a"), SIZE("amount"), SIZE("size"), SEED}, call_warp},
};
/* clang-format on */

const size_t hewn_function_count = sizeof hewn_functions / sizeof *hewn_functions;

int hewn_function_arguments(const hewn_function *function, int *needed)
{
    int count = 0;
    *needed = 0;
    while (count < HEWN_ARGUMENTS_MOST && function->arguments[count].name) {
        *needed += !function->arguments[count].optional;
        count++;
    }
    return count;
}

/* --- text ----------------------------------------------------------------------------------------------------------
 */

const char *hewn_section_name(hewn_section section)
{
    static const char *const names[HEWN_SECTIONS] = {"solids", "flat shapes", "into space",   "periodic surfaces",
                                                     "noise",  "files",       "combining",    "changing",
                                                     "paint",  "moving",      "bending space"};
    return names[section];
}

static void write_call(const hewn_function *function, hewn_text *text)
{
    if (function->call) {
        hewn_text_append(text, function->call);
        return;
    }
    int needed, count = hewn_function_arguments(function, &needed);
    hewn_text_print(text, "%s(", function->name);
    for (int i = 0; i < count; i++)
        hewn_text_print(text, "%s%s%s", i < needed ? "" : i ? " [" : "[", i ? ", " : "", function->arguments[i].name);
    for (int i = needed; i < count; i++)
        hewn_text_append(text, "]");
    hewn_text_append(text, ")");
}

static void write_slope(const hewn_function *function, hewn_text *text)
{
    if (function->slope == 0)
        hewn_text_append(text, "by intervals");
    else if (function->slope == ROOT_OF_2)
        hewn_text_append(text, "√2");
    else
        hewn_text_print(text, "%g", function->slope);
    if (function->slope_over)
        hewn_text_print(text, " / %s", function->arguments[function->slope_over - 1].name);
}

void hewn_catalogue_write(hewn_section section, hewn_text *text)
{
    static const char *const exactness[] = {"exact", "exact outside", "bound", "neither"};
    hewn_text_append(text, "| function | meaning | distance | slope | |\n| --- | --- | --- | --- | --- |\n");
    for (size_t i = 0; i < hewn_function_count; i++) {
        const hewn_function *function = &hewn_functions[i];
        if (function->section != section)
            continue;
        hewn_text_append(text, "| `");
        write_call(function, text);
        hewn_text_print(text, "` | %s | %s | ", function->meaning, exactness[function->exactness]);
        write_slope(function, text);
        hewn_text_print(text, " | ![](pictures/%s.png) |\n", function->name);
    }
}
