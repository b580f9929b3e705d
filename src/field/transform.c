/* Moving a shape is evaluating it elsewhere: its graph is built again with x, y, z replaced. */
#include <math.h>

#include "base/alloc.h"
#include "base/error.h"
#include "field/internal.h"

/* An edge along x = 0 of an outline. Turned around that axis it lies inside, and a ray along x from a point beside it
 * does not cross it. */
static bool is_on_axis(const hewn_node_data *data)
{
    return data->op == HEWN_OP_EDGE && data->operand[1] == HEWN_ID_X && data->parameter[0] == 0 &&
           data->parameter[2] == 0;
}

/* One walk over the nodes in order, operands first: linear and without recursion. */
static hewn_node rebuild(hewn_field *field, hewn_node shape, const uint32_t *ids, size_t count, uint32_t *moved,
                         const uint32_t variables[3], bool revolved)
{
    for (size_t i = 0; i < count; i++) {
        hewn_node_data data = field->nodes[ids[i]]; /* a copy: adding may move the nodes */
        if (data.op <= HEWN_OP_Z) {
            moved[ids[i]] = variables[data.op - HEWN_OP_X];
            continue;
        }
        if (revolved && is_on_axis(&data)) {
            moved[ids[i]] = moved[data.operand[0]];
            continue;
        }
        bool changed = false;
        for (int k = 0; k < hewn_op_infos[data.op].operands; k++) {
            uint32_t operand = moved[data.operand[k]];
            changed = changed || operand != data.operand[k];
            data.operand[k] = operand;
        }
        hewn_node node = changed ? hewn_field_add_node(field, &data) : (hewn_node){ids[i]};
        if (hewn_node_is_none(node))
            return node;
        moved[ids[i]] = node.id;
    }
    return (hewn_node){moved[shape.id]};
}

static hewn_node remap(hewn_field *field, hewn_node shape, hewn_node x, hewn_node y, hewn_node z, bool revolved)
{
    if (!field)
        return HEWN_NODE_NONE;
    const uint32_t variables[3] = {x.id, y.id, z.id};
    for (int i = 0; i < 3; i++)
        if (variables[i] >= field->count)
            return hewn_field_refuse(field, HEWN_INVALID_ARGUMENT, "remap: the new %c is no node of this field",
                                     "xyz"[i]);
    uint32_t *ids = NULL;
    size_t count = 0;
    hewn_error error;
    hewn_result result = hewn_field_live_nodes(field, shape, &ids, &count, &error);
    if (result != HEWN_OK)
        return hewn_field_refuse(field, result, "the shape to move: %s", error.message);
    uint32_t *moved = hewn_alloc((size_t)shape.id + 1, sizeof *moved); /* set for live ids only */
    hewn_node out = moved ? rebuild(field, shape, ids, count, moved, variables, revolved)
                          : hewn_field_refuse(field, HEWN_OUT_OF_MEMORY, "out of memory moving a shape");
    hewn_free(moved);
    hewn_free(ids);
    return out;
}

hewn_node hewn_remap(hewn_field *field, hewn_node shape, hewn_node x, hewn_node y, hewn_node z)
{
    return remap(field, shape, x, y, z, false);
}

hewn_node hewn_remap_revolved(hewn_field *field, hewn_node shape, hewn_node x, hewn_node y, hewn_node z)
{
    return remap(field, shape, x, y, z, true);
}

static hewn_node remap_affine(hewn_field *field, hewn_node shape, const double rows[3][4])
{
    hewn_node moved[3];
    for (int i = 0; i < 3; i++)
        moved[i] = hewn_field_add_node(
            field, &(hewn_node_data){.op = HEWN_OP_AFFINE,
                                     .operand = {HEWN_ID_X, HEWN_ID_Y, HEWN_ID_Z},
                                     .parameter = {rows[i][0], rows[i][1], rows[i][2], rows[i][3]}});
    return hewn_remap(field, shape, moved[0], moved[1], moved[2]);
}

hewn_node hewn_translate(hewn_field *field, hewn_node shape, double x, double y, double z)
{
    if (!isfinite(x) || !isfinite(y) || !isfinite(z))
        return hewn_field_refuse(field, HEWN_INVALID_ARGUMENT, "translate: (%g, %g, %g) is not finite", x, y, z);
    const double rows[3][4] = {{1, 0, 0, -x}, {0, 1, 0, -y}, {0, 0, 1, -z}};
    return remap_affine(field, shape, rows);
}

/* Sines and cosines of right angles miss 0 and 1 by less than their own rounding; as 0 and 1 they keep shapes that were
 * aligned with the axes aligned. */
static double snapped(double value)
{
    if (fabs(value) < 0x1p-52)
        return 0;
    return fabs(fabs(value) - 1) < 0x1p-52 ? copysign(1, value) : value;
}

hewn_node hewn_rotate(hewn_field *field, hewn_node shape, double x, double y, double z, double angle)
{
    double largest = fmax(fabs(x), fmax(fabs(y), fabs(z)));
    double u[3] = {x / largest, y / largest, z / largest};
    double length = sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
    if (!(largest > 0) || !isfinite(length) || !isfinite(angle))
        return hewn_field_refuse(field, HEWN_INVALID_ARGUMENT, "rotate: axis (%g, %g, %g), angle %g", x, y, z, angle);
    for (int i = 0; i < 3; i++)
        u[i] /= length;
    /* Rodrigues' formula for the turn back, by which a point is looked up in the shape as it was. */
    double c = cos(angle), s = -sin(angle);
    double rows[3][4] = {{0}};
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        rows[i][i] = snapped(c + u[i] * u[i] * (1 - c));
        rows[i][j] = snapped(u[i] * u[j] * (1 - c) - s * u[k]);
        rows[i][k] = snapped(u[i] * u[k] * (1 - c) + s * u[j]);
    }
    return remap_affine(field, shape, (const double(*)[4])rows);
}

hewn_node hewn_stretch(hewn_field *field, hewn_node shape, double x, double y, double z)
{
    const double factor[3] = {x, y, z};
    double rows[3][4] = {{0}};
    for (int i = 0; i < 3; i++) {
        rows[i][i] = 1 / factor[i];
        if (!(factor[i] > 0) || !isfinite(factor[i]) || !isfinite(rows[i][i]))
            return hewn_field_refuse(field, HEWN_INVALID_ARGUMENT, "a scale factor must be above 0 and finite, not %g",
                                     factor[i]);
    }
    hewn_node moved = remap_affine(field, shape, (const double(*)[4])rows);
    return hewn_mul(field, moved, hewn_constant(field, fmin(x, fmin(y, z))));
}

hewn_node hewn_scale(hewn_field *field, hewn_node shape, double factor)
{
    return hewn_stretch(field, shape, factor, factor, factor);
}
