/* Shapes in bent, repeated and mirrored space: the graph again with other coordinates. Bounds of these are those of the
 * arithmetic, so nothing is claimed that could drop surface. Where the shape's own box is known, one around the result
 * is added, which culls what lies far away. */
#include "field/compose.h"

static bool is_axis(hewn_field *f, const char *name, int axis)
{
    if (axis >= 0 && axis < 3)
        return true;
    hewn_field_refuse(f, HEWN_INVALID_ARGUMENT, "%s: there is no axis %d", name, axis);
    return false;
}

static bool is_finite(hewn_field *f, const char *name, double value)
{
    if (isfinite(value))
        return true;
    hewn_field_refuse(f, HEWN_INVALID_ARGUMENT, "%s: %g is not finite", name, value);
    return false;
}

static hewn_node remap_one(hewn_field *f, hewn_node shape, int axis, hewn_node to)
{
    hewn_node at[3] = {hewn_x(f), hewn_y(f), hewn_z(f)};
    at[axis] = to;
    return hewn_remap(f, shape, at[0], at[1], at[2]);
}

static hewn_node axis_of(hewn_field *f, int axis)
{
    return axis == 0 ? hewn_x(f) : axis == 1 ? hewn_y(f) : hewn_z(f);
}

/* The largest size of a coordinate in the box. */
static double farthest(const hewn_box *box, int axis)
{
    return fmax(fabs(box->lo[axis]), fabs(box->hi[axis]));
}

/* --- mirrors --------------------------------------------------------------------------------------------------------
 */

hewn_node hewn_mirror(hewn_field *f, hewn_node shape, int axis)
{
    if (!is_axis(f, "mirror", axis))
        return HEWN_NODE_NONE;
    double row[4] = {0};
    row[axis] = -1;
    return remap_one(f, shape, axis, affine(f, hewn_x(f), hewn_y(f), hewn_z(f), row));
}

hewn_node hewn_symmetric(hewn_field *f, hewn_node shape, int axis)
{
    hewn_box box;
    if (!is_axis(f, "symmetric", axis))
        return HEWN_NODE_NONE;
    hewn_node out = remap_one(f, shape, axis, hewn_abs(f, axis_of(f, axis)));
    if (!hewn_field_known_box(f, shape, &box))
        return out;
    box.lo[axis] = -box.hi[axis];
    return bounded(f, out, &box);
}

/* --- copies ---------------------------------------------------------------------------------------------------------
 */

/* All of them in a balanced tree, which pruning cuts down fastest. */
static hewn_node join_copies(hewn_field *f, hewn_node shape, size_t from, size_t to,
                             hewn_node (*copy)(hewn_field *, hewn_node, size_t, const double *), const double *how)
{
    if (to - from == 1)
        return copy(f, shape, from, how);
    size_t middle = from + (to - from) / 2;
    hewn_node a = join_copies(f, shape, from, middle, copy, how);
    return hewn_min(f, a, join_copies(f, shape, middle, to, copy, how));
}

static bool few_enough(hewn_field *f, const char *name, hewn_node shape, double copies)
{
    enum { NODES_MOST = 1 << 20 };
    if (copies < 1 || copies > HEWN_COPIES_MOST || copies * (double)hewn_field_size(f, shape) > NODES_MOST) {
        hewn_field_refuse(f, HEWN_INVALID_ARGUMENT, "%s: %.0f copies of the shape are too many, or too few", name,
                          copies);
        return false;
    }
    return true;
}

static hewn_node copy_in_grid(hewn_field *f, hewn_node shape, size_t which, const double *how)
{
    size_t nx = (size_t)how[0], ny = (size_t)how[1];
    size_t at[3] = {which % nx, which / nx % ny, which / nx / ny};
    return hewn_translate(f, shape, (double)at[0] * how[3], (double)at[1] * how[4], (double)at[2] * how[5]);
}

hewn_node hewn_array(hewn_field *f, hewn_node shape, unsigned nx, unsigned ny, unsigned nz, double dx, double dy,
                     double dz)
{
    const double how[6] = {nx, ny, nz, dx, dy, dz};
    double copies = how[0] * how[1] * how[2];
    if (hewn_node_is_none(shape) || !few_enough(f, "array", shape, copies))
        return HEWN_NODE_NONE;
    return join_copies(f, shape, 0, (size_t)copies, copy_in_grid, how);
}

static hewn_node copy_around(hewn_field *f, hewn_node shape, size_t which, const double *how)
{
    double axis[3] = {0};
    axis[(int)how[1]] = 1;
    return hewn_rotate(f, shape, axis[0], axis[1], axis[2], 2 * acos(-1) * (double)which / how[0]);
}

hewn_node hewn_radial(hewn_field *f, hewn_node shape, unsigned count, int axis)
{
    const double how[2] = {count, axis};
    if (!is_axis(f, "radial", axis) || hewn_node_is_none(shape) || !few_enough(f, "radial", shape, count))
        return HEWN_NODE_NONE;
    return join_copies(f, shape, 0, count, copy_around, how);
}

/* --- without end ----------------------------------------------------------------------------------------------------
 */

static bool spacing_is_fine(hewn_field *f, const char *name, const double *d)
{
    bool some = false, fine = true;
    for (int i = 0; i < 3; i++) {
        some = some || d[i] > 0;
        fine = fine && d[i] >= 0 && isfinite(d[i]);
    }
    if (!some || !fine)
        hewn_field_refuse(f, HEWN_INVALID_ARGUMENT,
                          "%s: the distances (%g, %g, %g) must not be below 0, and not all of them 0", name, d[0], d[1],
                          d[2]);
    return some && fine;
}

/* A point sees the copies at the lattice places before and behind it, along each axis: all that reach it, where the
 * shape reaches no farther from its origin than the distance between copies. */
hewn_node hewn_tile(hewn_field *f, hewn_node shape, double dx, double dy, double dz)
{
    const double d[3] = {dx, dy, dz};
    if (!spacing_is_fine(f, "tile", d))
        return HEWN_NODE_NONE;
    hewn_node at[3][2], out = HEWN_NODE_NONE;
    for (int i = 0; i < 3; i++) {
        at[i][0] = at[i][1] = axis_of(f, i);
        if (d[i] > 0) {
            at[i][0] = hewn_mod(f, at[i][0], hewn_constant(f, d[i]));
            at[i][1] = plus(f, at[i][0], -d[i]);
        }
    }
    for (int which = 0; which < 8; which++) {
        int k[3] = {which & 1, which >> 1 & 1, which >> 2};
        if ((k[0] && dx == 0) || (k[1] && dy == 0) || (k[2] && dz == 0))
            continue;
        hewn_node copy = hewn_remap(f, shape, at[0][k[0]], at[1][k[1]], at[2][k[2]]);
        out = which == 0 ? copy : hewn_min(f, out, copy);
    }
    return out;
}

/* The distance from the nearest whole multiple is what x is between mirrors at 0 and half the period. */
hewn_node hewn_mirror_tile(hewn_field *f, hewn_node shape, double dx, double dy, double dz)
{
    const double d[3] = {dx, dy, dz};
    if (!spacing_is_fine(f, "mirror_tile", d))
        return HEWN_NODE_NONE;
    hewn_node at[3];
    for (int i = 0; i < 3; i++) {
        at[i] = axis_of(f, i);
        if (d[i] > 0) /* mirrors at -d/2 and d/2: counted from the first */
            at[i] = plus(f,
                         hewn_field_add_node(
                             f, &(hewn_node_data){.op = HEWN_OP_ZIGZAG,
                                                  .operand = {plus(f, at[i], 0.5 * d[i]).id, HEWN_NO_ID, HEWN_NO_ID},
                                                  .parameter = {2 * d[i]}}),
                         -0.5 * d[i]);
    }
    return hewn_remap(f, shape, at[0], at[1], at[2]);
}

/* --- bent space -----------------------------------------------------------------------------------------------------
 */

hewn_node hewn_twist(hewn_field *f, hewn_node shape, double angle)
{
    hewn_box box;
    if (!is_finite(f, "twist", angle))
        return HEWN_NODE_NONE;
    hewn_node x = hewn_x(f), y = hewn_y(f), z = hewn_z(f), turn = times(f, y, angle);
    hewn_node c = hewn_cos(f, turn), s = hewn_sin(f, turn);
    hewn_node to_x = hewn_sub(f, hewn_mul(f, x, c), hewn_mul(f, z, s));
    hewn_node to_z = hewn_add(f, hewn_mul(f, x, s), hewn_mul(f, z, c));
    hewn_node out = hewn_remap(f, shape, to_x, y, to_z);
    if (!hewn_field_known_box(f, shape, &box))
        return out;
    return bounded_by_cylinder(f, out, hypot(farthest(&box, 0), farthest(&box, 2)), box.lo[1], box.hi[1]);
}

/* The line y = 0 becomes a circle through the origin around (0, 1 / angle): lengths along it stay. Where the shape's
 * box is known, a wedge keeps away the half-plane behind the centre, where angles jump. */
hewn_node hewn_bend(hewn_field *f, hewn_node shape, double angle)
{
    hewn_box box;
    if (!is_finite(f, "bend", angle))
        return HEWN_NODE_NONE;
    if (angle == 0)
        return shape;
    double radius = 1 / angle;
    hewn_node x = hewn_x(f), down = plus(f, hewn_neg(f, hewn_y(f)), radius);
    if (radius < 0)
        down = hewn_neg(f, down);
    hewn_node around = times(f, hewn_atan2(f, x, down), fabs(radius));
    hewn_node away = times(f, plus(f, length_of_two(f, x, down), -fabs(radius)), radius < 0 ? 1 : -1);
    hewn_node out = hewn_remap(f, shape, around, away, hewn_z(f));
    if (!hewn_field_known_box(f, shape, &box))
        return out;
    double half = farthest(&box, 0) * fabs(angle), inner = farthest(&box, 1);
    if (half < 3) {
        hewn_node wedge = hewn_sub(f, times(f, hewn_abs(f, x), cos(half)), times(f, down, sin(half)));
        out = hewn_max(f, out, wedge);
    }
    double reach = fabs(radius) + inner, across = half < 0.5 * acos(-1) ? reach * sin(half) : reach;
    double low = fabs(radius) * (1 - cos(fmin(half, acos(-1)))) + inner;
    hewn_box around_box = {{-across, radius > 0 ? -inner : -low, box.lo[2]},
                           {across, radius > 0 ? low : inner, box.hi[2]}};
    return bounded(f, out, &around_box);
}

hewn_node hewn_taper(hewn_field *f, hewn_node shape, double bottom, double top, double height)
{
    hewn_box box;
    if (!all_above_0(f, "taper", 3, (const double[3]){bottom, top, height}))
        return HEWN_NODE_NONE;
    hewn_node part = clamped(f, plus(f, times(f, hewn_y(f), 1 / height), 0.5), 0, 1);
    hewn_node factor = plus(f, times(f, part, top - bottom), bottom);
    hewn_node x = hewn_div(f, hewn_x(f), factor), z = hewn_div(f, hewn_z(f), factor);
    hewn_node out = times(f, hewn_remap(f, shape, x, hewn_y(f), z), fmin(fmin(bottom, top), 1));
    if (!hewn_field_known_box(f, shape, &box))
        return out;
    double least = fmin(bottom, top), most = fmax(bottom, top);
    for (int i = 0; i < 3; i += 2) {
        box.lo[i] *= box.lo[i] < 0 ? most : least;
        box.hi[i] *= box.hi[i] < 0 ? least : most;
    }
    return bounded(f, out, &box);
}

hewn_node hewn_elongate(hewn_field *f, hewn_node shape, double x, double y, double z)
{
    const double length[3] = {x, y, z};
    hewn_node at[3];
    for (int i = 0; i < 3; i++) {
        at[i] = axis_of(f, i);
        if (!(length[i] >= 0) || !isfinite(length[i]))
            return hewn_field_refuse(f, HEWN_INVALID_ARGUMENT, "elongate: the length %g must be finite and not below 0",
                                     length[i]);
        if (length[i] > 0) /* away from where the middle part ends */
            at[i] = hewn_sub(f, at[i], clamped(f, at[i], -0.5 * length[i], 0.5 * length[i]));
    }
    hewn_node out = hewn_remap(f, shape, at[0], at[1], at[2]);
    hewn_box box;
    if (!hewn_field_known_box(f, shape, &box))
        return out;
    for (int i = 0; i < 3; i++) {
        box.lo[i] = box.lo[i] < 0 ? box.lo[i] - 0.5 * length[i] : fmin(box.lo[i], -0.5 * length[i]);
        box.hi[i] = box.hi[i] > 0 ? box.hi[i] + 0.5 * length[i] : fmax(box.hi[i], 0.5 * length[i]);
    }
    return bounded(f, out, &box);
}

hewn_node hewn_warp(hewn_field *f, hewn_node shape, double amount, double size, uint32_t seed)
{
    hewn_box box;
    if (!all_above_0(f, "warp", 2, (const double[2]){amount, size}))
        return HEWN_NODE_NONE;
    hewn_node at[3];
    for (uint32_t i = 0; i < 3; i++)
        at[i] = hewn_add(f, axis_of(f, (int)i),
                         times(f, hewn_noise(f, HEWN_NOISE_GRADIENT, size, (seed + i) % 0x1000000u), amount));
    hewn_node out = hewn_remap(f, shape, at[0], at[1], at[2]);
    if (!hewn_field_known_box(f, shape, &box))
        return out;
    for (int i = 0; i < 3; i++) {
        box.lo[i] -= amount;
        box.hi[i] += amount;
    }
    return bounded(f, out, &box);
}
