/* Constant folding, and identities that hold bit for bit (at most the sign of a zero may differ), so that a folded
 * graph gives the values that the builder asked for. */
#include <math.h>
#include <string.h>

#include "field/internal.h"

static bool is_constant(const hewn_field *field, uint32_t id)
{
    return field->nodes[id].op == HEWN_OP_CONSTANT;
}

static bool is_value(const hewn_field *field, uint32_t id, double value)
{
    return is_constant(field, id) && field->nodes[id].parameter[0] == value;
}

static void become(hewn_node_data *data, hewn_op op, uint32_t a, uint32_t b)
{
    *data = (hewn_node_data){.op = op, .operand = {a, b, HEWN_NO_ID}};
}

static void become_constant(hewn_node_data *data, double value)
{
    become(data, HEWN_OP_CONSTANT, HEWN_NO_ID, HEWN_NO_ID);
    data->parameter[0] = isnan(value) ? (double)NAN : value;
}

bool hewn_node_row(const hewn_field *field, uint32_t id, double row[4])
{
    const hewn_node_data *node = &field->nodes[id];
    memset(row, 0, 4 * sizeof *row);
    switch (node->op) {
    case HEWN_OP_X: row[0] = 1; return true;
    case HEWN_OP_Y: row[1] = 1; return true;
    case HEWN_OP_Z: row[2] = 1; return true;
    case HEWN_OP_CONSTANT: row[3] = node->parameter[0]; return isfinite(row[3]);
    case HEWN_OP_AFFINE:
        memcpy(row, node->parameter, 4 * sizeof *row);
        return node->operand[0] == HEWN_ID_X && node->operand[1] == HEWN_ID_Y && node->operand[2] == HEWN_ID_Z;
    default: return false;
    }
}

/* --- affine: rows over the variables multiply out, so nested transforms leave one row ----------------------------- */

static bool compose(const hewn_field *field, hewn_node_data *data)
{
    double total[4] = {0, 0, 0, data->parameter[3]};
    for (int i = 0; i < 3; i++) {
        double row[4];
        if (!hewn_node_row(field, data->operand[i], row))
            return false;
        for (int j = 0; j < 4; j++)
            total[j] += data->parameter[i] == 0 ? 0 : data->parameter[i] * row[j];
    }
    for (int j = 0; j < 4; j++) {
        if (!isfinite(total[j]))
            return false;
        total[j] += 0.0; /* one zero only, or equal rows would be two nodes */
    }
    memcpy(data->parameter, total, sizeof total);
    data->operand[0] = HEWN_ID_X;
    data->operand[1] = HEWN_ID_Y;
    data->operand[2] = HEWN_ID_Z;
    return true;
}

static bool fold_affine(const hewn_field *field, hewn_node_data *data, uint32_t *existing)
{
    if (!compose(field, data))
        return false;
    const double *p = data->parameter;
    int zeros = (p[0] == 0) + (p[1] == 0) + (p[2] == 0);
    if (zeros == 3) {
        become_constant(data, p[3]);
        return false;
    }
    for (uint32_t i = 0; i < 3; i++)
        if (zeros == 2 && p[i] == 1 && p[3] == 0) {
            *existing = i; /* the variables' ids are 0, 1, 2 */
            return true;
        }
    return false;
}

/* --- one operand ---------------------------------------------------------------------------------------------------
 */

static bool is_whole(hewn_op op)
{
    return op == HEWN_OP_FLOOR || op == HEWN_OP_CEIL || op == HEWN_OP_ROUND || op == HEWN_OP_NOT ||
           op == HEWN_OP_COMPARE;
}

/* Returns true when the value is that of the operand or of its operand; sets *again when `data` was rewritten. */
static bool fold_unary(const hewn_field *field, hewn_node_data *data, uint32_t *existing, bool *again)
{
    uint32_t a = data->operand[0];
    const hewn_node_data *inner = &field->nodes[a];
    switch (data->op) {
    case HEWN_OP_NEG: *existing = inner->operand[0]; return inner->op == HEWN_OP_NEG;
    case HEWN_OP_ABS:
        *again = inner->op == HEWN_OP_NEG;
        if (*again)
            become(data, HEWN_OP_ABS, inner->operand[0], HEWN_NO_ID);
        *existing = a;
        return inner->op == HEWN_OP_ABS || inner->op == HEWN_OP_SQUARE || inner->op == HEWN_OP_EXP;
    case HEWN_OP_SQUARE:
        *again = inner->op == HEWN_OP_NEG || inner->op == HEWN_OP_ABS;
        if (*again)
            become(data, HEWN_OP_SQUARE, inner->operand[0], HEWN_NO_ID);
        return false;
    case HEWN_OP_FLOOR:
    case HEWN_OP_CEIL:
    case HEWN_OP_ROUND: *existing = a; return is_whole(inner->op);
    case HEWN_OP_PAINT: /* the outer paint covers the inner one */
        for (int i = 0; i < 4 && inner->op == HEWN_OP_PAINT; i++)
            if (data->parameter[i] < 0)
                data->parameter[i] = inner->parameter[i];
        if (inner->op == HEWN_OP_PAINT)
            data->operand[0] = inner->operand[0];
        return false;
    default: return false;
    }
}

/* --- two operands --------------------------------------------------------------------------------------------------
 */

/* Sums and products do not depend on the order, bit for bit: constants go last, else the older node first. (min and max
 * keep theirs: a tie takes the first operand's gradient.) */
static void order_operands(const hewn_field *field, hewn_node_data *data)
{
    uint32_t a = data->operand[0], b = data->operand[1];
    bool swap = is_constant(field, a) != is_constant(field, b) ? is_constant(field, a) : a > b;
    if (swap) {
        data->operand[0] = b;
        data->operand[1] = a;
    }
}

static bool fold_add(const hewn_field *field, hewn_node_data *data, uint32_t *existing, bool *again)
{
    order_operands(field, data);
    uint32_t a = data->operand[0], b = data->operand[1];
    *existing = a;
    if (is_value(field, b, 0))
        return true;
    *again = true;
    if (field->nodes[b].op == HEWN_OP_NEG)
        become(data, HEWN_OP_SUB, a, field->nodes[b].operand[0]);
    else if (field->nodes[a].op == HEWN_OP_NEG)
        become(data, HEWN_OP_SUB, b, field->nodes[a].operand[0]);
    else
        *again = false;
    return false;
}

static bool fold_mul(const hewn_field *field, hewn_node_data *data, uint32_t *existing, bool *again)
{
    order_operands(field, data);
    uint32_t a = data->operand[0], b = data->operand[1];
    *existing = a;
    if (is_value(field, b, 1))
        return true;
    *again = true;
    if (is_value(field, b, -1))
        become(data, HEWN_OP_NEG, a, HEWN_NO_ID);
    else if (a == b)
        become(data, HEWN_OP_SQUARE, a, HEWN_NO_ID);
    else
        *again = false;
    return false;
}

static bool fold_logic(const hewn_field *field, const hewn_node_data *data, uint32_t *existing)
{
    uint32_t a = data->operand[0], b = data->operand[1];
    if (!is_constant(field, a))
        return false;
    bool zero = is_value(field, a, 0);
    *existing = (data->op == HEWN_OP_AND) == zero ? a : b;
    return true;
}

static bool fold_binary(const hewn_field *field, hewn_node_data *data, uint32_t *existing, bool *again)
{
    uint32_t a = data->operand[0], b = data->operand[1];
    *existing = a;
    switch (data->op) {
    case HEWN_OP_ADD: return fold_add(field, data, existing, again);
    case HEWN_OP_MUL: return fold_mul(field, data, existing, again);
    case HEWN_OP_SUB:
        *again = field->nodes[b].op == HEWN_OP_NEG;
        if (*again)
            become(data, HEWN_OP_ADD, a, field->nodes[b].operand[0]);
        return is_value(field, b, 0);
    case HEWN_OP_DIV:
        *again = is_value(field, b, -1);
        if (*again)
            become(data, HEWN_OP_NEG, a, HEWN_NO_ID);
        return is_value(field, b, 1);
    case HEWN_OP_MIN:
    case HEWN_OP_MAX: return a == b;
    case HEWN_OP_AND:
    case HEWN_OP_OR: return fold_logic(field, data, existing);
    default: return false;
    }
}

/* --- all -----------------------------------------------------------------------------------------------------------
 */

static bool fold_constants(const hewn_field *field, hewn_node_data *data)
{
    int operands = hewn_op_infos[data->op].operands;
    double in[HEWN_MAX_OPERANDS] = {0};
    for (int i = 0; i < operands; i++) {
        if (!is_constant(field, data->operand[i]))
            return false;
        in[i] = field->nodes[data->operand[i]].parameter[0];
    }
    if (operands > 0)
        become_constant(data, hewn_op_point(data, in));
    return operands > 0;
}

bool hewn_node_fold(const hewn_field *field, hewn_node_data *data, uint32_t *existing)
{
    if (data->op == HEWN_OP_CONSTANT)
        become_constant(data, data->parameter[0]);
    else if (data->op != HEWN_OP_AFFINE)
        for (int i = 0; i < HEWN_MAX_PARAMETERS; i++)
            data->parameter[i] += 0.0; /* -0 becomes 0 */
    bool again = true;
    while (again) {
        again = false;
        if (fold_constants(field, data))
            return false;
        int operands = hewn_op_infos[data->op].operands;
        if (data->op == HEWN_OP_AFFINE)
            return fold_affine(field, data, existing);
        if (operands == 1 && fold_unary(field, data, existing, &again))
            return true;
        if (operands == 2 && fold_binary(field, data, existing, &again))
            return true;
    }
    return false;
}
