/* How steep a field can be: a bound of each operation's slope, from those of its operands and from interval bounds of
 * their values over the whole box. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "field/operate.h"
#include "render/tracer.h"

/* What is known of a node: its values, its slope, and, where it is a linear form of x, y and z, that. */
typedef struct steep {
    hewn_interval range;
    double bound;
    bool linear;
    double row[3];
} steep;

static double length(const double *v)
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* The largest singular value of a matrix, from above: the power 2^-5 of the trace of the 32nd power of its square. */
static double spectral_norm(const double rows[3][3])
{
    double s[9], scale = 0;
    for (int i = 0; i < 9; i++) {
        const double *a = rows[i / 3], *b = rows[i % 3];
        s[i] = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        scale = fmax(scale, fabs(s[i]));
    }
    if (!(scale > 0) || !isfinite(scale))
        return sqrt(scale);
    for (int i = 0; i < 9; i++)
        s[i] /= scale;
    for (int power = 0; power < 5; power++) {
        double t[9];
        for (int i = 0; i < 9; i++)
            t[i] = s[i / 3 * 3] * s[i % 3] + s[i / 3 * 3 + 1] * s[3 + i % 3] + s[i / 3 * 3 + 2] * s[6 + i % 3];
        memcpy(s, t, sizeof s);
    }
    return sqrt(scale * pow(s[0] + s[4] + s[8], 1.0 / 32)) * (1 + 1e-12);
}

/* How steep (a, b, c) is as a vector. */
static double joint(const steep *in, uint32_t count)
{
    double rows[3][3] = {{0}}, sum = 0;
    bool linear = true;
    for (uint32_t k = 0; k < count; k++) {
        linear = linear && in[k].linear;
        sum += in[k].bound * in[k].bound;
        for (int j = 0; j < 3; j++)
            rows[k][j] = in[k].row[j];
    }
    return linear ? fmin(spectral_norm((const double(*)[3])rows), sqrt(sum)) : sqrt(sum);
}

static double size(hewn_interval range)
{
    return fmax(fabs(range.lo), fabs(range.hi));
}

/* A zero slope stays zero, whatever it is multiplied with. */
static double times(double factor, double bound)
{
    return bound == 0 ? 0 : factor * bound;
}

static double unary(hewn_op op, const steep *a)
{
    double lo = a->range.lo;
    switch (op) {
    case HEWN_OP_NEG:
    case HEWN_OP_ABS:
    case HEWN_OP_SIN:
    case HEWN_OP_COS:
    case HEWN_OP_ZIGZAG:
    case HEWN_OP_ATAN: return a->bound;
    case HEWN_OP_SQUARE: return times(2 * size(a->range), a->bound);
    case HEWN_OP_SQRT: return times(lo > 0 ? 0.5 / sqrt(lo) : INFINITY, a->bound);
    case HEWN_OP_EXP: return times(exp(a->range.hi), a->bound);
    case HEWN_OP_LN: return times(lo > 0 ? 1 / lo : INFINITY, a->bound);
    default: return times(INFINITY, a->bound);
    }
}

static double binary(hewn_op op, const steep *a, const steep *b)
{
    double nearest = b->range.lo > 0 ? b->range.lo : b->range.hi < 0 ? -b->range.hi : 0;
    switch (op) {
    case HEWN_OP_ADD:
    case HEWN_OP_SUB: return a->bound + b->bound;
    case HEWN_OP_MUL: return times(size(b->range), a->bound) + times(size(a->range), b->bound);
    case HEWN_OP_DIV: return nearest > 0 ? (a->bound + times(size(a->range) / nearest, b->bound)) / nearest : INFINITY;
    case HEWN_OP_MIN:
    case HEWN_OP_MAX:
    case HEWN_OP_BLEND_QUADRATIC: /* the gradient of a blend is a mean of its operands' */
    case HEWN_OP_BLEND_CUBIC:
    case HEWN_OP_BLEND_CIRCULAR:
    case HEWN_OP_BLEND_EXPONENTIAL: return fmax(a->bound, b->bound);
    default: return times(INFINITY, a->bound + b->bound);
    }
}

/* The root of a sum of squares is a length, and no steeper than what is squared is as a vector. */
static double root(const hewn_field *field, const hewn_node_data *node, const steep *known)
{
    steep parts[3];
    uint32_t count = 0, left[4] = {node->operand[0]}, open = 1;
    while (open > 0) {
        const hewn_node_data *at = hewn_field_node(field, left[--open]);
        if (at->op == HEWN_OP_ADD && open < 2) {
            left[open++] = at->operand[0];
            left[open++] = at->operand[1];
        } else if (at->op == HEWN_OP_SQUARE && count < 3) {
            parts[count++] = known[at->operand[0]];
        } else if (!(at->op == HEWN_OP_CONSTANT && at->parameter[0] >= 0)) {
            return unary(HEWN_OP_SQRT, &known[node->operand[0]]);
        }
    }
    return joint(parts, count);
}

static double shape(const hewn_node_data *node, const steep *in)
{
    switch (node->op) {
    case HEWN_OP_SPHERE:
    case HEWN_OP_BOX:
    case HEWN_OP_ROUNDED_BOX:
    case HEWN_OP_TORUS:
    case HEWN_OP_CYLINDER:
    case HEWN_OP_CAPSULE:
    case HEWN_OP_CONE: return joint(in, 3);
    case HEWN_OP_OUTLINE: return joint(in + 1, 2); /* a distance, whatever its chain's values do */
    case HEWN_OP_PLANE: return times(length(node->parameter), joint(in, 3));
    case HEWN_OP_AFFINE:
        return times(fabs(node->parameter[0]), in[0].bound) + times(fabs(node->parameter[1]), in[1].bound) +
               times(fabs(node->parameter[2]), in[2].bound);
    default: return INFINITY;
    }
}

static steep find(const hewn_field *field, const hewn_node_data *node, const hewn_box *box, const steep *known)
{
    steep out = {.bound = 0}, in[HEWN_MAX_OPERANDS] = {out, out, out};
    hewn_interval ranges[HEWN_MAX_OPERANDS] = {{0}};
    uint32_t operands = hewn_op_infos[node->op].operands;
    if (node->op <= HEWN_OP_Z) {
        int axis = (int)(node->op - HEWN_OP_X);
        out = (steep){.range = {box->lo[axis], box->hi[axis], false}, .bound = 1, .linear = true};
        out.row[axis] = 1;
        return out;
    }
    for (uint32_t k = 0; k < operands; k++) {
        in[k] = known[node->operand[k]];
        ranges[k] = in[k].range;
    }
    out.range = hewn_op_bound(node, ranges);
    if (operands == 0)
        out.linear = true;
    else if (node->op == HEWN_OP_SQRT)
        out.bound = root(field, node, known);
    else if (operands == 1)
        out.bound = unary(node->op, &in[0]);
    else if (operands == 2)
        out.bound = binary(node->op, &in[0], &in[1]);
    else
        out.bound = shape(node, in);
    if (node->op == HEWN_OP_AFFINE && in[0].linear && in[1].linear && in[2].linear) {
        out.linear = true;
        for (int j = 0; j < 3; j++)
            out.row[j] = node->parameter[0] * in[0].row[j] + node->parameter[1] * in[1].row[j] +
                         node->parameter[2] * in[2].row[j];
        out.bound = length(out.row) * (1 + 1e-12);
    }
    if (out.range.maybe_nan || isnan(out.bound))
        out.bound = INFINITY;
    return out;
}

hewn_result hewn_steepness_bound(const hewn_field *field, hewn_node root_node, const hewn_box *box, double *out,
                                 hewn_error *error)
{
    *out = INFINITY;
    uint32_t *ids = NULL;
    size_t count = 0;
    HEWN_TRY(hewn_field_live_nodes(field, root_node, &ids, &count, error));
    steep *known = hewn_alloc((size_t)root_node.id + 1, sizeof *known);
    for (size_t i = 0; known && i < count; i++) {
        const hewn_node_data *node = hewn_field_node(field, ids[i]);
        known[ids[i]] = node->op == HEWN_OP_PAINT ? known[node->operand[0]] : find(field, node, box, known);
    }
    if (known)
        *out = known[root_node.id].bound;
    bool enough = known != NULL;
    hewn_free(known);
    hewn_free(ids);
    return enough ? HEWN_OK : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a field's slope");
}

static int by_size(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Newton's steps take points of a lattice to the surface; the median of the slopes there. */
hewn_result hewn_common_slope(const hewn_field *field, hewn_node root_node, const hewn_box *box, double *out,
                              hewn_error *error)
{
    enum { SIDE = 5, COUNT = SIDE * SIDE * SIDE, ROUNDS = 4 };
    double points[COUNT][3], values[COUNT][4], slopes[COUNT];
    for (int i = 0; i < COUNT; i++)
        for (int axis = 0, rest = i; axis < 3; axis++, rest /= SIDE)
            points[i][axis] = box->lo[axis] + (box->hi[axis] - box->lo[axis]) * (rest % SIDE + 0.47) / SIDE;
    size_t found = 0;
    for (int round = 0; round <= ROUNDS; round++) {
        HEWN_TRY(hewn_field_gradient(field, root_node, points[0], COUNT, values[0], error));
        for (int i = 0; i < COUNT; i++) {
            double square = values[i][1] * values[i][1] + values[i][2] * values[i][2] + values[i][3] * values[i][3];
            for (int axis = 0; axis < 3; axis++) {
                double moved = points[i][axis] - values[i][0] * values[i][axis + 1] / square;
                points[i][axis] = isfinite(moved) ? fmin(fmax(moved, box->lo[axis]), box->hi[axis]) : points[i][axis];
            }
            if (round == ROUNDS && square > 0 && isfinite(square))
                slopes[found++] = sqrt(square);
        }
    }
    qsort(slopes, found, sizeof *slopes, by_size);
    *out = found > 0 ? slopes[found / 2] : 1;
    return HEWN_OK;
}
