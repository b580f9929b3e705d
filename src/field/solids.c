/* Solids made of other expressions. Round ones are distances; those with flat faces are the greatest distance to the
 * plane of a face, which is exact inside and over the faces, and past edges and corners is less than the distance. */
#include "base/alloc.h"
#include "field/compose.h"

hewn_node hewn_half_space(hewn_field *f, double nx, double ny, double nz, double distance)
{
    return hewn_plane(f, nx, ny, nz, distance);
}

/* Twelve bars, four at a time. */
hewn_node hewn_box_frame(hewn_field *f, double width, double height, double depth, double edge)
{
    const double size[3] = {width, height, depth};
    if (!all_above_0(f, "box_frame", 4, (const double[4]){width, height, depth, edge}))
        return HEWN_NODE_NONE;
    if (2 * edge >= fmin(width, fmin(height, depth)))
        return hewn_field_refuse(f, HEWN_INVALID_ARGUMENT,
                                 "box_frame: its edge, %g, must be below half of the least size", edge);
    hewn_node axis[3] = {hewn_x(f), hewn_y(f), hewn_z(f)}, frame = HEWN_NODE_NONE;
    for (int along = 0; along < 3; along++) {
        hewn_node_data bars = {.op = HEWN_OP_BOX};
        for (int i = 0; i < 3; i++) {
            hewn_node from = i == along ? axis[i] : plus(f, hewn_abs(f, axis[i]), -0.5 * (size[i] - edge));
            bars.operand[i] = from.id;
            bars.parameter[i] = 0.5 * (i == along ? size[i] : edge);
        }
        hewn_node four = hewn_field_add_node(f, &bars);
        frame = along == 0 ? four : hewn_min(f, frame, four);
    }
    return bounded_by(f, frame, 0.5 * width, 0.5 * height, 0.5 * depth);
}

hewn_node hewn_ellipsoid(hewn_field *f, double x, double y, double z)
{
    if (!all_above_0(f, "ellipsoid", 3, (const double[3]){x, y, z}))
        return HEWN_NODE_NONE;
    return hewn_stretch(f, hewn_sphere(f, 1), x, y, z);
}

/* The least distance to balls in between, whose radii change evenly: found without cases, as the best of them is known.
 */
hewn_node hewn_round_cone(hewn_field *f, double bottom, double top, double height)
{
    if (!all_above_0(f, "round_cone", 3, (const double[3]){bottom, top, height}))
        return HEWN_NODE_NONE;
    double lean = (bottom - top) / height;
    if (fabs(lean) >= 1)
        return hewn_field_refuse(f, HEWN_INVALID_ARGUMENT,
                                 "round_cone: with radii %g and %g and the height %g one ball lies in the other",
                                 bottom, top, height);
    hewn_node r = length_of_two(f, hewn_x(f), hewn_z(f)), y = plus(f, hewn_y(f), 0.5 * height);
    hewn_node best = hewn_sub(f, y, times(f, r, lean / sqrt(1 - lean * lean)));
    best = clamped(f, times(f, best, 1 / height), 0, 1);
    hewn_node away = length_of_two(f, r, hewn_sub(f, y, times(f, best, height)));
    hewn_node cone = hewn_sub(f, away, plus(f, times(f, best, top - bottom), bottom));
    double wide = fmax(bottom, top);
    return bounded(f, cone, &(hewn_box){{-wide, -0.5 * height - bottom, -wide}, {wide, 0.5 * height + top, wide}});
}

hewn_node hewn_link(hewn_field *f, double length, double major, double minor)
{
    if (!all_above_0(f, "link", 2, (const double[2]){major, minor}))
        return HEWN_NODE_NONE;
    if (!(length >= 0) || !isfinite(length))
        return hewn_field_refuse(f, HEWN_INVALID_ARGUMENT, "link: its length must not be below 0, but is %g", length);
    hewn_node y = at_least(f, plus(f, hewn_abs(f, hewn_y(f)), -0.5 * length), 0);
    hewn_node ring = plus(f, length_of_two(f, hewn_x(f), y), -major);
    hewn_node link = plus(f, length_of_two(f, ring, hewn_z(f)), -minor);
    return bounded_by(f, link, major + minor, 0.5 * length + major + minor, minor);
}

/* --- flat faces ----------------------------------------------------------------------------------------------------
 */

/* The greatest of planes at this distance, whose normals are given for the octant where all three coordinates are
 * positive. */
static hewn_node planes_of_octants(hewn_field *f, const double (*normals)[3], int count, double inner, double radius)
{
    hewn_node axis[3] = {hewn_abs(f, hewn_x(f)), hewn_abs(f, hewn_y(f)), hewn_abs(f, hewn_z(f))};
    hewn_node out = HEWN_NODE_NONE;
    for (int i = 0; i < count; i++) {
        const double *n = normals[i];
        double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        hewn_node face = affine(f, axis[0], axis[1], axis[2],
                                (const double[4]){n[0] / length, n[1] / length, n[2] / length, -inner});
        out = i == 0 ? face : hewn_max(f, out, face);
    }
    return hewn_max(f, out, hewn_sphere(f, radius * (1 + ROOM)));
}

hewn_node hewn_octahedron(hewn_field *f, double radius)
{
    static const double normals[1][3] = {{1, 1, 1}};
    if (!all_above_0(f, "octahedron", 1, &radius))
        return HEWN_NODE_NONE;
    return planes_of_octants(f, normals, 1, radius / sqrt(3), radius);
}

/* The golden ratio, and the radius of the ball in an icosahedron or a dodecahedron over that around it. */
#define GOLDEN 1.6180339887498948482
#define INNER 0.79465447229176612

hewn_node hewn_icosahedron(hewn_field *f, double radius)
{
    static const double normals[4][3] = {
        {1, 1, 1}, {0, 1 / GOLDEN, GOLDEN}, {GOLDEN, 0, 1 / GOLDEN}, {1 / GOLDEN, GOLDEN, 0}};
    if (!all_above_0(f, "icosahedron", 1, &radius))
        return HEWN_NODE_NONE;
    return planes_of_octants(f, normals, 4, INNER * radius, radius);
}

hewn_node hewn_dodecahedron(hewn_field *f, double radius)
{
    static const double normals[3][3] = {{0, 1, GOLDEN}, {GOLDEN, 0, 1}, {1, GOLDEN, 0}};
    if (!all_above_0(f, "dodecahedron", 1, &radius))
        return HEWN_NODE_NONE;
    return planes_of_octants(f, normals, 3, INNER * radius, radius);
}

/* Corners at (1, 1, 1), (1, -1, -1), (-1, 1, -1) and (-1, -1, 1) times radius / sqrt(3). */
hewn_node hewn_tetrahedron(hewn_field *f, double radius)
{
    static const double signs[4][3] = {{-1, -1, -1}, {-1, 1, 1}, {1, -1, 1}, {1, 1, -1}};
    if (!all_above_0(f, "tetrahedron", 1, &radius))
        return HEWN_NODE_NONE;
    hewn_node out = HEWN_NODE_NONE;
    for (int i = 0; i < 4; i++) {
        const double k = 1 / sqrt(3), *n = signs[i];
        const double row[4] = {k * n[0], k * n[1], k * n[2], -radius / 3};
        hewn_node face = affine(f, hewn_x(f), hewn_y(f), hewn_z(f), row);
        out = i == 0 ? face : hewn_max(f, out, face);
    }
    double side = radius / sqrt(3);
    return bounded_by(f, out, side, side, side);
}

hewn_node hewn_pyramid(hewn_field *f, double width, double height)
{
    if (!all_above_0(f, "pyramid", 2, (const double[2]){width, height}))
        return HEWN_NODE_NONE;
    double half = 0.5 * width, slant = sqrt(height * height + half * half);
    hewn_node out = hewn_max(f, hewn_abs(f, hewn_x(f)), hewn_abs(f, hewn_z(f)));
    hewn_node side =
        hewn_add(f, times(f, out, height / slant), times(f, plus(f, hewn_y(f), -0.5 * height), half / slant));
    hewn_node floor = plus(f, hewn_neg(f, hewn_y(f)), -0.5 * height);
    return bounded_by(f, hewn_max(f, side, floor), half, 0.5 * height, half);
}

/* --- along curves --------------------------------------------------------------------------------------------------
 */

static hewn_node capsule_between(hewn_field *f, const double *a, const double *b, double radius)
{
    double d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]), across = sqrt(d[0] * d[0] + d[2] * d[2]);
    hewn_node out = hewn_capsule(f, radius, length);
    if (across > 0) /* about y cross d */
        out = hewn_rotate(f, out, d[2], 0, -d[0], atan2(across, d[1]));
    return hewn_translate(f, out, 0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), 0.5 * (a[2] + b[2]));
}

hewn_node hewn_tube(hewn_field *f, const double *points, size_t count, double radius)
{
    if (!all_above_0(f, "tube", 1, &radius))
        return HEWN_NODE_NONE;
    if (!points || count < 2 || count > HEWN_COPIES_MOST)
        return hewn_field_refuse(f, HEWN_INVALID_ARGUMENT, "tube: it has 2 to %d points, not %zu",
                                 (int)HEWN_COPIES_MOST, count);
    hewn_node out = HEWN_NODE_NONE;
    for (size_t i = 0; i < 3 * count; i++)
        if (!isfinite(points[i]))
            return hewn_field_refuse(f, HEWN_INVALID_ARGUMENT, "tube: point %zu is not finite", i / 3 + 1);
    for (size_t i = 0; i + 1 < count; i++) {
        hewn_node part = capsule_between(f, points + 3 * i, points + 3 * i + 3, radius);
        out = i == 0 ? part : hewn_min(f, out, part);
    }
    return out;
}

static void cubic_at(const double *p, double t, double out[3])
{
    double s = 1 - t;
    for (int i = 0; i < 3; i++)
        out[i] = s * s * s * p[i] + 3 * s * s * t * p[3 + i] + 3 * s * t * t * p[6 + i] + t * t * t * p[9 + i];
}

/* How many chords stay within `off` of a cubic: its second derivative bounds how far each bends away. */
static size_t chords_of(const double *p, double off)
{
    double bend = 0;
    for (int k = 0; k < 2; k++) {
        double square = 0;
        for (int i = 0; i < 3; i++) {
            double d = p[3 * k + i] - 2 * p[3 * k + 3 + i] + p[3 * k + 6 + i];
            square += d * d;
        }
        bend = fmax(bend, 6 * sqrt(square));
    }
    return (size_t)fmin(fmax(ceil(sqrt(bend / (8 * off))), 1), 256);
}

hewn_node hewn_bezier_tube(hewn_field *f, const double *points, size_t count, double radius)
{
    if (!all_above_0(f, "bezier_tube", 1, &radius))
        return HEWN_NODE_NONE;
    if (!points || count < 4 || count % 3 != 1)
        return hewn_field_refuse(
            f, HEWN_INVALID_ARGUMENT,
            "bezier_tube: it needs 4, 7, 10 ... points (ends and two controls between them), not %zu", count);
    for (size_t i = 0; i < 3 * count; i++)
        if (!isfinite(points[i]))
            return hewn_field_refuse(f, HEWN_INVALID_ARGUMENT, "bezier_tube: point %zu is not finite", i / 3 + 1);
    size_t all = 0;
    for (size_t i = 0; i + 3 < count; i += 3)
        all += chords_of(points + 3 * i, 0.01 * radius);
    if (all > HEWN_COPIES_MOST)
        return hewn_field_refuse(f, HEWN_INVALID_ARGUMENT, "bezier_tube: it comes to %zu chords, more than %d", all,
                                 (int)HEWN_COPIES_MOST);
    hewn_node out = HEWN_NODE_NONE;
    for (size_t i = 0; i + 3 < count; i += 3) {
        const double *p = points + 3 * i;
        size_t chords = chords_of(p, 0.01 * radius);
        for (size_t k = 0; k < chords; k++) {
            double a[3], b[3];
            cubic_at(p, (double)k / (double)chords, a);
            cubic_at(p, (double)(k + 1) / (double)chords, b);
            hewn_node part = capsule_between(f, a, b, radius);
            out = hewn_node_is_none(out) ? part : hewn_min(f, out, part);
        }
    }
    return out;
}

/* The point is turned back by its height, so that the wire's middle line becomes one point (radius, 0) of a plane. A
 * step along the circle there is one across the wire times the sine of the wire's slope; no angle is taken, whose jump
 * would leave bounds open. The ends are cut level. */
hewn_node hewn_helix(hewn_field *f, double radius, double pitch, double height, double wire)
{
    if (!all_above_0(f, "helix", 4, (const double[4]){radius, pitch, height, wire}))
        return HEWN_NODE_NONE;
    const double turn = 2 * acos(-1);
    double around = turn * radius, sine = pitch / sqrt(pitch * pitch + around * around);
    if (2 * wire >= pitch * around / sqrt(pitch * pitch + around * around) || wire >= radius)
        return hewn_field_refuse(f, HEWN_INVALID_ARGUMENT,
                                 "helix: its turns meet: the wire's radius %g is too large for "
                                 "the radius %g and the pitch %g",
                                 wire, radius, pitch);
    hewn_node x = hewn_x(f), z = hewn_z(f), r = length_of_two(f, x, z), angle = times(f, hewn_y(f), turn / pitch);
    hewn_node along = hewn_add(f, hewn_mul(f, x, hewn_cos(f, angle)), hewn_mul(f, z, hewn_sin(f, angle)));
    hewn_node gap = times(f, at_least(f, hewn_sub(f, r, along), 0), 2 * radius * sine * sine);
    hewn_node coil = plus(f, hewn_sqrt(f, hewn_add(f, hewn_square(f, plus(f, r, -radius)), gap)), -wire);
    hewn_node level = plus(f, hewn_abs(f, hewn_y(f)), -0.5 * height);
    return bounded_by_cylinder(f, hewn_max(f, coil, level), radius + wire, -0.5 * height, 0.5 * height);
}
