/* Samplings as fields. */
#include "field/compose.h"
#include "field/sampling.h"

static hewn_node sampled_at(hewn_field *f, const hewn_sampling *sampling, hewn_node x, hewn_node y, hewn_node z)
{
    return hewn_field_add_node(
        f, &(hewn_node_data){.op = HEWN_OP_SAMPLED, .operand = {x.id, y.id, z.id}, .samples = sampling});
}

/* A coordinate counted in cells from the middle of the lattice. */
static hewn_node counted(hewn_field *f, int axis, double middle, double cell)
{
    double row[4] = {0, 0, 0, -middle / cell};
    row[axis] = 1 / cell;
    return affine(f, hewn_x(f), hewn_y(f), hewn_z(f), row);
}

hewn_node hewn_sampled(hewn_field *f, const hewn_sampling *sampling, const hewn_sampling_place *place)
{
    if (!sampling || !place)
        return hewn_field_refuse(f, HEWN_INVALID_ARGUMENT, "sampled: there are no samples");
    if (!all_above_0(f, "sampled", 1, &place->cell) || !isfinite(1 / place->cell))
        return HEWN_NODE_NONE;
    if (!sampling->enclosed)
        return hewn_field_refuse(f, HEWN_INVALID_ARGUMENT, "sampled: the shape reaches past its samples");
    hewn_node at[3];
    for (int i = 0; i < 3; i++) {
        double middle = place->origin[i] + 0.5 * sampling->cells[i] * place->cell;
        if (!isfinite(middle))
            return hewn_field_refuse(f, HEWN_INVALID_ARGUMENT, "sampled: its place is not finite");
        at[i] = counted(f, i, middle, place->cell);
    }
    return times(f, sampled_at(f, sampling, at[0], at[1], at[2]), place->cell);
}

hewn_node hewn_heights(hewn_field *f, const hewn_sampling *sampling, double width, double depth, double height)
{
    if (!sampling || sampling->cells[2] != 0 || !sampling->endless)
        return hewn_field_refuse(f, HEWN_INVALID_ARGUMENT, "heights: there are no heights");
    if (!all_above_0(f, "heights", 2, (const double[2]){width, depth}) || !isfinite(height))
        return isfinite(height) ? HEWN_NODE_NONE
                                : hewn_field_refuse(f, HEWN_INVALID_ARGUMENT, "heights: the height is not finite");
    double across = width / sampling->cells[0], along = depth / sampling->cells[1];
    double slope = fabs(height) * (double)sampling->steepest / fmin(across, along);
    hewn_node heights = sampled_at(f, sampling, counted(f, 0, 0, across), counted(f, 1, 0, along), hewn_constant(f, 0));
    hewn_node land = hewn_sub(f, hewn_z(f), times(f, heights, height));
    return times(f, land, 1 / sqrt(1 + slope * slope));
}
