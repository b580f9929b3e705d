/* Short names for building expressions out of others, for the files that define shapes and operators. */
#ifndef HEWN_SRC_FIELD_COMPOSE_H
#define HEWN_SRC_FIELD_COMPOSE_H

#include <math.h>

#include "field/internal.h"

static inline hewn_node plus(hewn_field *f, hewn_node a, double b)
{
    return hewn_add(f, a, hewn_constant(f, b));
}

static inline hewn_node times(hewn_field *f, hewn_node a, double b)
{
    return hewn_mul(f, a, hewn_constant(f, b));
}

static inline hewn_node at_least(hewn_field *f, hewn_node a, double least)
{
    return hewn_max(f, a, hewn_constant(f, least));
}

static inline hewn_node at_most(hewn_field *f, hewn_node a, double most)
{
    return hewn_min(f, a, hewn_constant(f, most));
}

static inline hewn_node clamped(hewn_field *f, hewn_node a, double least, double most)
{
    return at_most(f, at_least(f, a, least), most);
}

static inline hewn_node length_of_two(hewn_field *f, hewn_node a, hewn_node b)
{
    return hewn_sqrt(f, hewn_add(f, hewn_square(f, a), hewn_square(f, b)));
}

/* p a + q b + r c + s */
static inline hewn_node affine(hewn_field *f, hewn_node a, hewn_node b, hewn_node c, const double p[4])
{
    return hewn_field_add_node(
        f,
        &(hewn_node_data){.op = HEWN_OP_AFFINE, .operand = {a.id, b.id, c.id}, .parameter = {p[0], p[1], p[2], p[3]}});
}

/* The distance to where both are below 0, from two distances along directions at right angles. What stands first says
 * the same as the rest, but of both operands alone: boxes are found by it. */
static inline hewn_node corner(hewn_field *f, hewn_node a, hewn_node b)
{
    hewn_node most = hewn_max(f, a, b);
    hewn_node outside = length_of_two(f, at_least(f, a, 0), at_least(f, b, 0));
    return hewn_max(f, most, hewn_add(f, outside, at_most(f, most, 0)));
}

/* The middle, or 0 where only rounding keeps it from there: then there is nothing to add, whatever the numbers are. */
static inline double middle_of(double low, double high)
{
    double middle = 0.5 * (low + high);
    return fabs(middle) < 0x1p-40 * (high - low) ? 0 : middle;
}

static inline hewn_node box_around(hewn_field *f, const hewn_box *box)
{
    hewn_node_data data = {.op = HEWN_OP_BOX};
    hewn_node axis[3] = {hewn_x(f), hewn_y(f), hewn_z(f)};
    for (int i = 0; i < 3; i++) {
        double row[4] = {0, 0, 0, -middle_of(box->lo[i], box->hi[i])};
        row[i] = 1;
        data.operand[i] = affine(f, axis[0], axis[1], axis[2], row).id;
        data.parameter[i] = 0.5 * (box->hi[i] - box->lo[i]);
    }
    return hewn_field_add_node(f, &data);
}

/* How much larger than a shape the box around it is made, so that the two never touch. */
#define ROOM 0x1p-10

/* A shape that is known to lie in this box. The distance to a shape is never below that to a box around it, so this
 * changes nothing of a distance; of other fields it betters what lies far outside. Boxes are found, and far bricks
 * culled, by it. */
static inline hewn_node bounded(hewn_field *f, hewn_node shape, const hewn_box *box)
{
    hewn_box larger;
    for (int i = 0; i < 3; i++) {
        double side = box->hi[i] - box->lo[i];
        if (!(side > 0) || !isfinite(side))
            return shape;
        larger.lo[i] = box->lo[i] - ROOM * side;
        larger.hi[i] = box->hi[i] + ROOM * side;
    }
    return hewn_max(f, shape, box_around(f, &larger));
}

static inline hewn_node bounded_by(hewn_field *f, hewn_node shape, double x, double y, double z)
{
    return bounded(f, shape, &(hewn_box){{-x, -y, -z}, {x, y, z}});
}

/* The same around the y axis. */
static inline hewn_node bounded_by_cylinder(hewn_field *f, hewn_node shape, double radius, double low, double high)
{
    if (!(radius > 0) || !(high > low) || !isfinite(radius + high - low))
        return shape;
    hewn_node around = hewn_cylinder(f, radius * (1 + ROOM), (high - low) * (1 + 2 * ROOM));
    return hewn_max(f, shape, hewn_translate(f, around, 0, middle_of(low, high), 0));
}

/* Whether all are finite and above 0; else the field remembers that `name` is refused. */
static inline bool all_above_0(hewn_field *f, const char *name, int count, const double *values)
{
    for (int i = 0; i < count; i++)
        if (!(values[i] > 0) || !isfinite(values[i])) {
            hewn_field_refuse(f, HEWN_INVALID_ARGUMENT, "%s: its sizes must be above 0 and finite, not %g", name,
                              values[i]);
            return false;
        }
    return true;
}

#endif
