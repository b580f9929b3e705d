/* What combines and changes shapes by their values. Chamfers, rounds and stairs after the Mercury demogroup's operators
 * (hg_sdf, 2015). */
#include "field/compose.h"

hewn_node hewn_xor(hewn_field *f, hewn_node a, hewn_node b)
{
    return hewn_max(f, hewn_min(f, a, b), hewn_neg(f, hewn_max(f, a, b)));
}

typedef hewn_node (*joiner)(hewn_field *, hewn_node, hewn_node, double, unsigned);

/* The intersection is the complement of the complements' union, the difference the intersection with a complement. */
static hewn_node meeting(hewn_field *f, hewn_node a, hewn_node b, double size, unsigned steps, joiner join)
{
    return hewn_neg(f, join(f, hewn_neg(f, a), hewn_neg(f, b), size, steps));
}

static bool size_is_fine(hewn_field *f, double size, unsigned steps)
{
    if (steps < 1 || steps > 1024) {
        hewn_field_refuse(f, HEWN_INVALID_ARGUMENT, "stairs: it has 1 to 1024 steps, not %u", steps);
        return false;
    }
    return all_above_0(f, "chamfer, round and stairs", 1, &size);
}

/* --- chamfer: a plane across the corner, `size` away from it along both ----------------------------------------------
 */

static hewn_node chamfer(hewn_field *f, hewn_node a, hewn_node b, double size, unsigned steps)
{
    (void)steps;
    hewn_node plane = times(f, plus(f, hewn_add(f, a, b), -size), sqrt(0.5));
    return hewn_min(f, hewn_min(f, a, b), plane);
}

hewn_node hewn_chamfer_union(hewn_field *f, hewn_node a, hewn_node b, double size)
{
    return size_is_fine(f, size, 1) ? chamfer(f, a, b, size, 1) : HEWN_NODE_NONE;
}

hewn_node hewn_chamfer_intersection(hewn_field *f, hewn_node a, hewn_node b, double size)
{
    return size_is_fine(f, size, 1) ? meeting(f, a, b, size, 1, chamfer) : HEWN_NODE_NONE;
}

hewn_node hewn_chamfer_difference(hewn_field *f, hewn_node a, hewn_node b, double size)
{
    return hewn_chamfer_intersection(f, a, hewn_neg(f, b), size);
}

/* --- round: a quarter of a circle that touches both -----------------------------------------------------------------
 */

static hewn_node rounding(hewn_field *f, hewn_node a, hewn_node b, double size, unsigned steps)
{
    (void)steps;
    hewn_node x = at_least(f, plus(f, hewn_neg(f, a), size), 0), y = at_least(f, plus(f, hewn_neg(f, b), size), 0);
    return hewn_sub(f, at_least(f, hewn_min(f, a, b), size), length_of_two(f, x, y));
}

hewn_node hewn_round_union(hewn_field *f, hewn_node a, hewn_node b, double size)
{
    return size_is_fine(f, size, 1) ? rounding(f, a, b, size, 1) : HEWN_NODE_NONE;
}

hewn_node hewn_round_intersection(hewn_field *f, hewn_node a, hewn_node b, double size)
{
    return size_is_fine(f, size, 1) ? meeting(f, a, b, size, 1, rounding) : HEWN_NODE_NONE;
}

hewn_node hewn_round_difference(hewn_field *f, hewn_node a, hewn_node b, double size)
{
    return hewn_round_intersection(f, a, hewn_neg(f, b), size);
}

/* --- stairs: treads of size / steps between the two ------------------------------------------------------------------
 */

static hewn_node zigzag(hewn_field *f, hewn_node a, double period)
{
    return hewn_field_add_node(
        f, &(hewn_node_data){.op = HEWN_OP_ZIGZAG, .operand = {a.id, HEWN_NO_ID, HEWN_NO_ID}, .parameter = {period}});
}

static hewn_node stairs(hewn_field *f, hewn_node a, hewn_node b, double size, unsigned steps)
{
    double tread = size / steps;
    hewn_node sum = plus(f, hewn_add(f, a, b), -size), apart = plus(f, hewn_sub(f, b, a), -size);
    hewn_node teeth = zigzag(f, apart, 2 * tread);
    return hewn_min(f, hewn_min(f, a, b), times(f, hewn_add(f, sum, teeth), 0.5));
}

hewn_node hewn_stairs_union(hewn_field *f, hewn_node a, hewn_node b, double size, unsigned steps)
{
    return size_is_fine(f, size, steps) ? stairs(f, a, b, size, steps) : HEWN_NODE_NONE;
}

hewn_node hewn_stairs_intersection(hewn_field *f, hewn_node a, hewn_node b, double size, unsigned steps)
{
    return size_is_fine(f, size, steps) ? meeting(f, a, b, size, steps, stairs) : HEWN_NODE_NONE;
}

hewn_node hewn_stairs_difference(hewn_field *f, hewn_node a, hewn_node b, double size, unsigned steps)
{
    return hewn_stairs_intersection(f, a, hewn_neg(f, b), size, steps);
}

/* --- one shape ------------------------------------------------------------------------------------------------------
 */

hewn_node hewn_shell(hewn_field *f, hewn_node shape, double thickness)
{
    if (!all_above_0(f, "shell", 1, &thickness))
        return HEWN_NODE_NONE;
    return plus(f, hewn_abs(f, shape), -0.5 * thickness);
}

hewn_node hewn_offset(hewn_field *f, hewn_node shape, double distance)
{
    if (!isfinite(distance))
        return hewn_field_refuse(f, HEWN_INVALID_ARGUMENT, "offset: the distance %g is not finite", distance);
    return plus(f, shape, -distance);
}

hewn_node hewn_displace(hewn_field *f, hewn_node shape, hewn_node by)
{
    return hewn_add(f, shape, by);
}

/* What is inside a mix by a part from 0 to 1 is inside one of the two. */
hewn_node hewn_morph(hewn_field *f, hewn_node a, hewn_node b, hewn_node part)
{
    static const hewn_box space = {{-INFINITY, -INFINITY, -INFINITY}, {INFINITY, INFINITY, INFINITY}};
    hewn_node out = hewn_add(f, a, hewn_mul(f, part, hewn_sub(f, b, a)));
    hewn_interval parts;
    hewn_box box, other;
    if (hewn_node_is_none(out) || hewn_field_bound(f, part, &space, &parts, NULL) != HEWN_OK || !(parts.lo >= 0) ||
        !(parts.hi <= 1) || !hewn_field_known_box(f, a, &box) || !hewn_field_known_box(f, b, &other))
        return out;
    for (int i = 0; i < 3; i++) {
        box.lo[i] = fmin(box.lo[i], other.lo[i]);
        box.hi[i] = fmax(box.hi[i], other.hi[i]);
    }
    return bounded(f, out, &box);
}
