/* Sets of points: sharp ones are min and max, smooth ones a blend. */
#include <math.h>

#include "field/internal.h"

hewn_node hewn_union(hewn_field *field, hewn_node a, hewn_node b)
{
    return hewn_min(field, a, b);
}

hewn_node hewn_intersection(hewn_field *field, hewn_node a, hewn_node b)
{
    return hewn_max(field, a, b);
}

hewn_node hewn_difference(hewn_field *field, hewn_node a, hewn_node b)
{
    return hewn_max(field, a, hewn_neg(field, b));
}

hewn_node hewn_complement(hewn_field *field, hewn_node a)
{
    return hewn_neg(field, a);
}

hewn_node hewn_smooth_union(hewn_field *field, hewn_node a, hewn_node b, hewn_blend blend, double size)
{
    hewn_op op;
    switch (blend) {
    case HEWN_BLEND_QUADRATIC: op = HEWN_OP_BLEND_QUADRATIC; break;
    case HEWN_BLEND_CUBIC: op = HEWN_OP_BLEND_CUBIC; break;
    case HEWN_BLEND_CIRCULAR: op = HEWN_OP_BLEND_CIRCULAR; break;
    case HEWN_BLEND_EXPONENTIAL: op = HEWN_OP_BLEND_EXPONENTIAL; break;
    default: return hewn_field_refuse(field, HEWN_INVALID_ARGUMENT, "there is no such blend");
    }
    /* A blend over no length is the sharp union; an exponential one of size 0 would reach everywhere. */
    if (size == 0 && op != HEWN_OP_BLEND_EXPONENTIAL)
        return hewn_min(field, a, b);
    return hewn_field_add_node(field,
                               &(hewn_node_data){.op = op, .operand = {a.id, b.id, HEWN_NO_ID}, .parameter = {size}});
}

hewn_node hewn_smooth_intersection(hewn_field *field, hewn_node a, hewn_node b, hewn_blend blend, double size)
{
    if (size == 0 && blend != HEWN_BLEND_EXPONENTIAL)
        return hewn_max(field, a, b);
    return hewn_neg(field, hewn_smooth_union(field, hewn_neg(field, a), hewn_neg(field, b), blend, size));
}

hewn_node hewn_smooth_difference(hewn_field *field, hewn_node a, hewn_node b, hewn_blend blend, double size)
{
    return hewn_smooth_intersection(field, a, hewn_neg(field, b), blend, size);
}
