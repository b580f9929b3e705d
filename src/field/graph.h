/* The inside of a hewn_field, for the rooms that compile it: nodes in an order where operands come first. */
#ifndef HEWN_SRC_FIELD_GRAPH_H
#define HEWN_SRC_FIELD_GRAPH_H

#include "hewn/field.h"

/* Each operation: enumerator, name in generated code and messages, operands, parameters. A shape's three operands are
 * its local coordinates. Everything that handles operations one by one is generated from, or tested against, this list.
 */
/* clang-format off */
#define HEWN_OPS(op) \
    op(X, x, 0, 0) \
    op(Y, y, 0, 0) \
    op(Z, z, 0, 0) \
    op(CONSTANT, constant, 0, 1)                   /* value */ \
    op(NEG, neg, 1, 0) \
    op(ABS, abs, 1, 0) \
    op(SQRT, sqrt, 1, 0) \
    op(SQUARE, square, 1, 0) \
    op(SIN, sin, 1, 0) \
    op(COS, cos, 1, 0) \
    op(TAN, tan, 1, 0) \
    op(ASIN, asin, 1, 0) \
    op(ACOS, acos, 1, 0) \
    op(ATAN, atan, 1, 0) \
    op(EXP, exp, 1, 0) \
    op(LN, ln, 1, 0) \
    op(FLOOR, floor, 1, 0) \
    op(CEIL, ceil, 1, 0) \
    op(ROUND, round, 1, 0) \
    op(NOT, not, 1, 0) \
    op(ADD, add, 2, 0) \
    op(SUB, sub, 2, 0) \
    op(MUL, mul, 2, 0) \
    op(DIV, div, 2, 0) \
    op(MIN, min, 2, 0) \
    op(MAX, max, 2, 0) \
    op(MOD, mod, 2, 0) \
    op(ATAN2, atan2, 2, 0) \
    op(COMPARE, compare, 2, 0) \
    op(AND, and, 2, 0) \
    op(OR, or, 2, 0) \
    op(AFFINE, affine, 3, 4)                       /* p0 a + p1 b + p2 c + p3, summed left to right */ \
    op(SPHERE, sphere, 3, 1)                       /* radius */ \
    op(BOX, box, 3, 3)                             /* half sizes */ \
    op(ROUNDED_BOX, rounded_box, 3, 4)             /* half sizes without the radius, radius */ \
    op(TORUS, torus, 3, 2)                         /* major, minor */ \
    op(CYLINDER, cylinder, 3, 2)                   /* radius, half height */ \
    op(CAPSULE, capsule, 3, 2)                     /* radius, half height */ \
    op(CONE, cone, 3, 3)                           /* bottom radius, top radius, half height */ \
    op(PLANE, plane, 3, 4)                         /* unit normal, distance */ \
    op(NOISE_VALUE, noise_value, 3, 1)             /* seed: noise over cells of size 1, from -1 to 1 (noise.c) */ \
    op(NOISE_GRADIENT, noise_gradient, 3, 1)       /* seed */ \
    op(NOISE_SIMPLEX, noise_simplex, 3, 1)         /* seed */ \
    op(NOISE_CELLULAR, noise_cellular, 3, 1)       /* seed; from 0 to 1 */ \
    op(EDGE, edge, 3, 4)                           /* ax, ay, bx, by: a link of a chain, see below */ \
    op(OUTLINE, outline, 3, 1)                     /* the largest size of a coordinate in the chain */ \
    op(SAMPLED, sampled, 3, 0)                     /* of its samples, at a place counted in cells from their middle */ \
    op(ZIGZAG, zigzag, 1, 1)                       /* period: the distance from the nearest of its multiples */ \
    op(PAINT, paint, 1, 4)                         /* red, green, blue (linear) or -1, label or -1: see below */ \
    op(BLEND_QUADRATIC, blend_quadratic, 2, 1)     /* size */ \
    op(BLEND_CUBIC, blend_cubic, 2, 1)             /* size */ \
    op(BLEND_CIRCULAR, blend_circular, 2, 1)       /* size: the fillet's radius, and where |a-b| ends */ \
    op(BLEND_EXPONENTIAL, blend_exponential, 2, 1) /* k */
/* clang-format on */

/* An outline is a chain: an edge for each side of a polygon, from the constant HEWN_OUTLINE_START on, each taking the
 * one before it, x and y; then the outline, which takes the last edge, x and y. An edge's value is the square of the
 * distance from the nearest edge so far, below 0 where a ray along x has crossed an odd number of them. That jumps, so
 * in the other flavours links carry what the outline needs instead: intervals the value in the middle of the box twice,
 * gradients the direction away from the nearest edge. Only the outline is a field like others; no builder hands out an
 * edge. */
#define HEWN_OUTLINE_START 1e29

/* Paint has its operand's value. What evaluates fields passes it over, so that a field with paint and one without are
 * the same code; paint.c evaluates what it says. */

/* The blends, with d = |a-b|, k the parameter; all are min(a, b) where not d < k, and never give NaN but for NaN:
 *   quadratic    min(a, b) - h² / (4 k),   h = k - d
 *   cubic        min(a, b) - h³ / (6 k²)
 *   circular     min(a, b) - (k/2) (1 + t - sqrt(1 + t (2 - t))),   t = (k - d) / k
 *   exponential  min(a, b) - ln(1 + e^(-k d)) / k,   for every d (d = 0 where a = b, also infinite) */
typedef enum hewn_op {
#define HEWN_OP_ENUMERATOR(NAME, name, operands, parameters) HEWN_OP_##NAME,
    HEWN_OPS(HEWN_OP_ENUMERATOR)
#undef HEWN_OP_ENUMERATOR
        HEWN_OP_COUNT
} hewn_op;

typedef struct hewn_op_info {
    const char *name;
    uint8_t operands;
    uint8_t parameters;
} hewn_op_info;

/* Whether the operation is no function of its operands and parameters alone, and no test can make one up: links mean
 * something in a chain only, samples come from elsewhere. */
static inline bool hewn_op_is_link(hewn_op op)
{
    return op == HEWN_OP_EDGE || op == HEWN_OP_OUTLINE || op == HEWN_OP_SAMPLED;
}

extern const hewn_op_info hewn_op_infos[HEWN_OP_COUNT];

#define HEWN_MAX_OPERANDS 3
#define HEWN_MAX_PARAMETERS 4

typedef struct hewn_node_data {
    hewn_op op;
    uint32_t operand[HEWN_MAX_OPERANDS];   /* node ids, all smaller than this node's own; unused ones are 0xFFFFFFFF */
    double parameter[HEWN_MAX_PARAMETERS]; /* unused ones are 0 */
    const struct hewn_sampling *samples;   /* of SAMPLED, else NULL; the field holds it as long as the node */
} hewn_node_data;

/* How many nodes the field has; ids are below it. */
uint32_t hewn_field_node_count(const hewn_field *field);

/* A node by id; valid until the field is changed. */
const hewn_node_data *hewn_field_node(const hewn_field *field, uint32_t id);

/* A node of any operation, folded and hash-consed. For front ends and tests; the public builders end here. */
hewn_node hewn_field_add_node(hewn_field *field, const hewn_node_data *given);

/* The ids that `root` depends on, itself last, operands before users. `*ids` is owned by the caller (hewn_free). */
hewn_result hewn_field_live_nodes(const hewn_field *field, hewn_node root, uint32_t **ids, size_t *count,
                                  hewn_error *error);

#endif
