/* The public builders that are one operation each. */
#include "field/internal.h"

hewn_node hewn_constant(hewn_field *field, double value)
{
    return hewn_field_add_node(field, &(hewn_node_data){.op = HEWN_OP_CONSTANT, .parameter = {value}});
}

static hewn_node build(hewn_field *field, hewn_op op, hewn_node a, hewn_node b)
{
    return hewn_field_add_node(field, &(hewn_node_data){.op = op, .operand = {a.id, b.id, HEWN_NO_ID}});
}

#define VARIABLE(name, NAME)                                                                                           \
    hewn_node hewn_##name(hewn_field *field)                                                                           \
    {                                                                                                                  \
        return build(field, HEWN_OP_##NAME, HEWN_NODE_NONE, HEWN_NODE_NONE);                                           \
    }

#define UNARY(name, NAME)                                                                                              \
    hewn_node hewn_##name(hewn_field *field, hewn_node a)                                                              \
    {                                                                                                                  \
        return build(field, HEWN_OP_##NAME, a, HEWN_NODE_NONE);                                                        \
    }

#define BINARY(name, NAME)                                                                                             \
    hewn_node hewn_##name(hewn_field *field, hewn_node a, hewn_node b)                                                 \
    {                                                                                                                  \
        return build(field, HEWN_OP_##NAME, a, b);                                                                     \
    }

VARIABLE(x, X)
VARIABLE(y, Y)
VARIABLE(z, Z)

UNARY(neg, NEG)
UNARY(abs, ABS)
UNARY(sqrt, SQRT)
UNARY(square, SQUARE)
UNARY(sin, SIN)
UNARY(cos, COS)
UNARY(tan, TAN)
UNARY(asin, ASIN)
UNARY(acos, ACOS)
UNARY(atan, ATAN)
UNARY(exp, EXP)
UNARY(ln, LN)
UNARY(floor, FLOOR)
UNARY(ceil, CEIL)
UNARY(round, ROUND)
UNARY(logic_not, NOT)

BINARY(add, ADD)
BINARY(sub, SUB)
BINARY(mul, MUL)
BINARY(div, DIV)
BINARY(min, MIN)
BINARY(max, MAX)
BINARY(mod, MOD)
BINARY(atan2, ATAN2)
BINARY(compare, COMPARE)
BINARY(logic_and, AND)
BINARY(logic_or, OR)
