/* The public shape builders: full sizes in, half sizes in the node. What a shape cannot be is refused when the node is
 * added (ops.c). */
#include <math.h>

#include "field/internal.h"

static hewn_node shape(hewn_field *field, hewn_op op, double p0, double p1, double p2, double p3)
{
    hewn_node_data data = {.op = op, .operand = {HEWN_ID_X, HEWN_ID_Y, HEWN_ID_Z}, .parameter = {p0, p1, p2, p3}};
    return hewn_field_add_node(field, &data);
}

hewn_node hewn_sphere(hewn_field *field, double radius)
{
    return shape(field, HEWN_OP_SPHERE, radius, 0, 0, 0);
}

hewn_node hewn_box_shape(hewn_field *field, double width, double height, double depth)
{
    return shape(field, HEWN_OP_BOX, 0.5 * width, 0.5 * height, 0.5 * depth, 0);
}

hewn_node hewn_rounded_box(hewn_field *field, double width, double height, double depth, double radius)
{
    return shape(field, HEWN_OP_ROUNDED_BOX, 0.5 * width - radius, 0.5 * height - radius, 0.5 * depth - radius, radius);
}

hewn_node hewn_torus(hewn_field *field, double major, double minor)
{
    return shape(field, HEWN_OP_TORUS, major, minor, 0, 0);
}

hewn_node hewn_cylinder(hewn_field *field, double radius, double height)
{
    return shape(field, HEWN_OP_CYLINDER, radius, 0.5 * height, 0, 0);
}

hewn_node hewn_capsule(hewn_field *field, double radius, double height)
{
    return shape(field, HEWN_OP_CAPSULE, radius, 0.5 * height, 0, 0);
}

hewn_node hewn_cone(hewn_field *field, double bottom, double top, double height)
{
    return shape(field, HEWN_OP_CONE, bottom, top, 0.5 * height, 0);
}

hewn_node hewn_plane(hewn_field *field, double nx, double ny, double nz, double distance)
{
    /* Scaled by the largest part first, so that neither a huge nor a tiny normal leaves the range of its squares. */
    double largest = fmax(fabs(nx), fmax(fabs(ny), fabs(nz)));
    double x = nx / largest, y = ny / largest, z = nz / largest;
    double length = sqrt(x * x + y * y + z * z);
    if (!(largest > 0) || !isfinite(length))
        return hewn_field_refuse(field, HEWN_INVALID_ARGUMENT, "plane: its normal (%g, %g, %g) has no direction", nx,
                                 ny, nz);
    return shape(field, HEWN_OP_PLANE, x / length, y / length, z / length, distance);
}
