#include <math.h>

#include "base/alloc.h"
#include "base/error.h"
#include "field/internal.h"
#include "field/interval.h"

static hewn_interval unary(const hewn_node_data *node, hewn_interval a)
{
    switch (node->op) {
    case HEWN_OP_PAINT: return a;
    case HEWN_OP_NEG: return hewn_interval_neg(a);
    case HEWN_OP_ABS: return hewn_interval_abs(a);
    case HEWN_OP_SQRT: return hewn_interval_sqrt(a);
    case HEWN_OP_SQUARE: return hewn_interval_square(a);
    case HEWN_OP_SIN: return hewn_interval_sin(a);
    case HEWN_OP_COS: return hewn_interval_cos(a);
    case HEWN_OP_TAN: return hewn_interval_tan(a);
    case HEWN_OP_ASIN: return hewn_interval_asin(a);
    case HEWN_OP_ACOS: return hewn_interval_acos(a);
    case HEWN_OP_ATAN: return hewn_interval_atan(a);
    case HEWN_OP_EXP: return hewn_interval_exp(a);
    case HEWN_OP_LN: return hewn_interval_ln(a);
    case HEWN_OP_FLOOR: return hewn_interval_floor(a);
    case HEWN_OP_CEIL: return hewn_interval_ceil(a);
    case HEWN_OP_ROUND: return hewn_interval_round(a);
    case HEWN_OP_NOT: return hewn_interval_not(a);
    case HEWN_OP_ZIGZAG: return hewn_interval_zigzag(a, node->parameter[0]);
    default: return hewn_interval_all();
    }
}

static hewn_interval binary(const hewn_node_data *node, hewn_interval a, hewn_interval b)
{
    switch (node->op) {
    case HEWN_OP_ADD: return hewn_interval_add(a, b);
    case HEWN_OP_SUB: return hewn_interval_sub(a, b);
    case HEWN_OP_MUL: return hewn_interval_mul(a, b);
    case HEWN_OP_DIV: return hewn_interval_div(a, b);
    case HEWN_OP_MIN: return hewn_interval_min(a, b);
    case HEWN_OP_MAX: return hewn_interval_max(a, b);
    case HEWN_OP_MOD: return hewn_interval_mod(a, b);
    case HEWN_OP_ATAN2: return hewn_interval_atan2(a, b);
    case HEWN_OP_COMPARE: return hewn_interval_compare(a, b);
    case HEWN_OP_AND: return hewn_interval_and(a, b);
    case HEWN_OP_OR: return hewn_interval_or(a, b);
    default: return hewn_interval_blend(node, a, b);
    }
}

hewn_interval hewn_op_bound(const hewn_node_data *node, const hewn_interval in[3])
{
    switch (hewn_op_infos[node->op].operands) {
    case 0: return hewn_interval_of(node->parameter[0]);
    case 1: return unary(node, in[0]);
    case 2: return binary(node, in[0], in[1]);
    default: return hewn_interval_shape(node, in);
    }
}

hewn_interval hewn_tape_bound(const hewn_tape *tape, const hewn_box *bounds, hewn_interval *scratch)
{
    for (size_t i = 0; i < tape->count; i++) {
        const hewn_step *step = &tape->steps[i];
        const hewn_node_data *node = step->node;
        if (node->op <= HEWN_OP_Z) {
            int axis = (int)(node->op - HEWN_OP_X);
            scratch[i] = (hewn_interval){bounds->lo[axis], bounds->hi[axis], false};
            continue;
        }
        hewn_interval in[HEWN_MAX_OPERANDS] = {{0}};
        for (int k = 0; k < hewn_op_infos[node->op].operands; k++)
            in[k] = scratch[step->in[k]];
        scratch[i] = hewn_op_bound(node, in);
    }
    return scratch[tape->count - 1];
}

hewn_result hewn_field_bound(const hewn_field *field, hewn_node node, const hewn_box *box, hewn_interval *out,
                             hewn_error *error)
{
    if (!out)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "hewn_field_bound: no place for the bounds");
    *out = (hewn_interval){0, 0, false};
    if (!box)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "hewn_field_bound: no box");
    for (int i = 0; i < 3; i++)
        if (!(box->lo[i] <= box->hi[i]))
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the box has no inside along %c (%g to %g)", "xyz"[i],
                             box -> lo[i], box -> hi[i]);
    hewn_tape tape;
    HEWN_TRY(hewn_tape_create(&tape, field, node, error));
    hewn_interval *scratch = hewn_alloc(tape.count, sizeof *scratch);
    hewn_result result = HEWN_OK;
    if (scratch)
        *out = hewn_tape_bound(&tape, box, scratch);
    else
        result = hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory bounding a field");
    hewn_free(scratch);
    hewn_tape_destroy(&tape);
    return result;
}
