/* How steep a field can be: a bound of each operation's slope, from those of its operands and from interval bounds of
 * their values over the whole box. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "field/operate.h"
#include "field/sampling.h"
#include "render/tracer.h"

/* What is known of a node: its values, its slope, and, where it is a linear form of x, y and z, that. Its gradient g
 * lies within an ellipsoid: (g v)² <= v F v for each vector v. */
typedef struct steep {
    hewn_interval range;
    double bound;
    double form[3][3]; /* F */
    bool linear;
    double row[3];
} steep;

static double length(const double *v)
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* --- forms ----------------------------------------------------------------------------------------------------------
 */

/* The largest eigenvalue of a form, from above: the power 2^-24 of the trace of its power 2^24, where factors that keep
 * numbers from growing are taken out of each square. */
static double greatest_eigenvalue(const double form[3][3])
{
    double s[9], logarithm = 0, weight = 1;
    for (int i = 0; i < 9; i++)
        s[i] = form[i / 3][i % 3];
    for (int power = 0; power < 24; power++, weight *= 0.5) {
        double t[9], trace = s[0] + s[4] + s[8];
        if (!(trace > 0) || !isfinite(trace))
            return trace;
        logarithm += weight * log(trace);
        for (int i = 0; i < 9; i++)
            s[i] /= trace;
        for (int i = 0; i < 9; i++)
            t[i] = s[i / 3 * 3] * s[i % 3] + s[i / 3 * 3 + 1] * s[3 + i % 3] + s[i / 3 * 3 + 2] * s[6 + i % 3];
        memcpy(s, t, sizeof s);
    }
    return exp(logarithm + weight * log(s[0] + s[4] + s[8])) * (1 + 1e-12);
}

/* The form of a gradient of which only the length is known. */
static void set_round(steep *out)
{
    memset(out->form, 0, sizeof out->form);
    for (int i = 0; i < 3; i++)
        out->form[i][i] = out->bound * out->bound;
}

static void set_scaled(steep *out, const steep *from)
{
    double factor = from->bound > 0 && isfinite(from->bound) ? out->bound / from->bound : 0;
    for (int i = 0; i < 9; i++)
        out->form[i / 3][i % 3] = factor * factor * from->form[i / 3][i % 3];
}

static bool is_diagonal(const steep *a)
{
    return a->form[0][1] == 0 && a->form[0][2] == 0 && a->form[1][2] == 0;
}

/* Of what has one of two gradients, or a mean of them. */
static void set_either(steep *out, const steep *a, const steep *b)
{
    out->bound = fmax(a->bound, b->bound);
    if (a->bound == 0 || b->bound == 0 || memcmp(a->form, b->form, sizeof a->form) == 0) {
        memcpy(out->form, b->bound == 0 ? a->form : b->form, sizeof out->form);
    } else if (is_diagonal(a) && is_diagonal(b)) {
        memset(out->form, 0, sizeof out->form);
        for (int i = 0; i < 3; i++)
            out->form[i][i] = fmax(a->form[i][i], b->form[i][i]);
    } else {
        set_round(out);
    }
}

/* Of what grows with the vector (a, b, c) no faster than that is long. */
static void set_joint(steep *out, const steep *in, uint32_t count)
{
    double sum = 0;
    memset(out->form, 0, sizeof out->form);
    for (uint32_t k = 0; k < count; k++) {
        sum += in[k].bound * in[k].bound;
        for (int i = 0; i < 9; i++)
            out->form[i / 3][i % 3] += in[k].form[i / 3][i % 3];
    }
    out->bound = sqrt(isfinite(sum) ? fmin(greatest_eigenvalue((const double(*)[3])out->form), sum) : sum);
}

/* --- operations -----------------------------------------------------------------------------------------------------
 */

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
    default: return times(INFINITY, a->bound + b->bound);
    }
}

/* What is squared in the root of a sum of up to three squares and positive numbers; none where it is something else. */
static uint32_t squares_of(const hewn_field *field, const hewn_node_data *node, uint32_t parts[3])
{
    uint32_t count = 0, left[4] = {node->operand[0]}, open = 1;
    while (open > 0) {
        const hewn_node_data *at = hewn_field_node(field, left[--open]);
        if (at->op == HEWN_OP_ADD && open < 2) {
            left[open++] = at->operand[0];
            left[open++] = at->operand[1];
        } else if (at->op == HEWN_OP_SQUARE && count < 3) {
            parts[count++] = at->operand[0];
        } else if (!(at->op == HEWN_OP_CONSTANT && at->parameter[0] >= 0)) {
            return 0;
        }
    }
    return count;
}

/* The root of a sum of squares is a length, and no steeper than what is squared is as a vector. */
static void set_root(steep *out, const hewn_field *field, const hewn_node_data *node, const steep *known)
{
    uint32_t squared[3], count = squares_of(field, node, squared);
    steep parts[3];
    for (uint32_t k = 0; k < count; k++)
        parts[k] = known[squared[k]];
    if (count > 0) {
        set_joint(out, parts, count);
    } else {
        out->bound = unary(HEWN_OP_SQRT, &known[node->operand[0]]);
        set_round(out);
    }
}

/* The operand of a min or max with a number; NULL where it is none of that kind. */
static const hewn_node_data *clamped(const hewn_field *field, uint32_t id, hewn_op op, double *number)
{
    const hewn_node_data *at = hewn_field_node(field, id);
    for (int k = 0; at->op == op && k < 2; k++) {
        const hewn_node_data *other = hewn_field_node(field, at->operand[1 - k]);
        if (other->op == HEWN_OP_CONSTANT) {
            *number = other->parameter[0];
            return hewn_field_node(field, at->operand[k]);
        }
    }
    return NULL;
}

/* Whether `part` is number - a. */
static bool is_less(const hewn_field *field, const hewn_node_data *part, uint32_t a, double number)
{
    const hewn_node_data *from = part->op == HEWN_OP_SUB ? hewn_field_node(field, part->operand[0]) : part;
    return part->op == HEWN_OP_SUB && part->operand[1] == a && from->op == HEWN_OP_CONSTANT &&
           from->parameter[0] == number;
}

/* Corners are min(max(a, b), 0) + |max(a, 0), max(b, 0)|, and rounded ones max(min(a, b), s) - |max(s - a, 0), max(s -
 * b, 0)|: everywhere one of the two terms does not change. */
static bool is_corner(const hewn_field *field, const hewn_node_data *sum, uint32_t flat_term, uint32_t long_term)
{
    bool rounded = sum->op == HEWN_OP_SUB;
    double number, zero;
    uint32_t squared[3];
    const hewn_node_data *term = hewn_field_node(field, long_term);
    const hewn_node_data *flat = clamped(field, flat_term, rounded ? HEWN_OP_MAX : HEWN_OP_MIN, &number);
    if (!flat || flat->op != (rounded ? HEWN_OP_MIN : HEWN_OP_MAX) || (!rounded && number != 0) ||
        term->op != HEWN_OP_SQRT || squares_of(field, term, squared) != 2)
        return false;
    for (int k = 0; k < 2; k++) {
        const hewn_node_data *part = clamped(field, squared[k], HEWN_OP_MAX, &zero);
        bool found = false;
        for (int j = 0; part && j < 2; j++)
            found = found || (rounded ? is_less(field, part, flat->operand[j], number)
                                      : part == hewn_field_node(field, flat->operand[j]));
        if (!found || zero != 0)
            return false;
    }
    return squared[0] != squared[1];
}

static bool either_changes(const hewn_field *field, const hewn_node_data *node)
{
    switch (node->op) {
    case HEWN_OP_MIN:
    case HEWN_OP_MAX:
    case HEWN_OP_BLEND_QUADRATIC: /* the gradient of a blend is a mean of its operands' */
    case HEWN_OP_BLEND_CUBIC:
    case HEWN_OP_BLEND_CIRCULAR:
    case HEWN_OP_BLEND_EXPONENTIAL: return true;
    case HEWN_OP_SUB: return is_corner(field, node, node->operand[0], node->operand[1]);
    case HEWN_OP_ADD:
        return is_corner(field, node, node->operand[0], node->operand[1]) ||
               is_corner(field, node, node->operand[1], node->operand[0]);
    default: return false;
    }
}

static void set_two(steep *out, const hewn_field *field, const hewn_node_data *node, const steep *in)
{
    if (either_changes(field, node)) {
        set_either(out, &in[0], &in[1]);
        return;
    }
    out->bound = binary(node->op, &in[0], &in[1]);
    if (in[1].bound == 0 || in[0].bound == 0)
        set_scaled(out, in[1].bound == 0 ? &in[0] : &in[1]);
    else
        set_round(out);
}

static void set_shape(steep *out, const hewn_node_data *node, const steep *in)
{
    switch (node->op) {
    case HEWN_OP_SPHERE:
    case HEWN_OP_BOX:
    case HEWN_OP_ROUNDED_BOX:
    case HEWN_OP_TORUS:
    case HEWN_OP_CYLINDER:
    case HEWN_OP_CAPSULE:
    case HEWN_OP_CONE: set_joint(out, in, 3); return;
    case HEWN_OP_OUTLINE: set_joint(out, in + 1, 2); return; /* a distance, whatever its chain's values do */
    case HEWN_OP_NOISE_VALUE:
    case HEWN_OP_NOISE_GRADIENT:
    case HEWN_OP_NOISE_SIMPLEX:
    case HEWN_OP_NOISE_CELLULAR:
        set_joint(out, in, 3);
        out->bound = times(hewn_op_noise_slope(node->op), out->bound);
        break;
    case HEWN_OP_SAMPLED:
        set_joint(out, in, 3);
        out->bound = times(
            hewn_sampling_steepest(node->samples, (const hewn_interval[3]){in[0].range, in[1].range, in[2].range}),
            out->bound);
        break;
    case HEWN_OP_PLANE:
        set_joint(out, in, 3);
        out->bound = times(length(node->parameter), out->bound);
        break;
    case HEWN_OP_AFFINE:
        out->bound = times(fabs(node->parameter[0]), in[0].bound) + times(fabs(node->parameter[1]), in[1].bound) +
                     times(fabs(node->parameter[2]), in[2].bound);
        break;
    default: out->bound = INFINITY;
    }
    set_round(out);
}

static void set_linear(steep *out, const hewn_node_data *node, const steep *in)
{
    out->linear = true;
    for (int j = 0; j < 3; j++)
        out->row[j] =
            node->parameter[0] * in[0].row[j] + node->parameter[1] * in[1].row[j] + node->parameter[2] * in[2].row[j];
    out->bound = length(out->row) * (1 + 1e-12);
    for (int i = 0; i < 9; i++)
        out->form[i / 3][i % 3] = out->row[i / 3] * out->row[i % 3];
}

static steep find(const hewn_field *field, const hewn_node_data *node, const hewn_box *box, const steep *known)
{
    steep out = {.bound = 0}, in[HEWN_MAX_OPERANDS] = {out, out, out};
    hewn_interval ranges[HEWN_MAX_OPERANDS] = {{0}};
    uint32_t operands = hewn_op_infos[node->op].operands;
    if (node->op <= HEWN_OP_Z) {
        int axis = (int)(node->op - HEWN_OP_X);
        out = (steep){.range = {box->lo[axis], box->hi[axis], false}, .bound = 1, .linear = true};
        out.row[axis] = out.form[axis][axis] = 1;
        return out;
    }
    for (uint32_t k = 0; k < operands; k++) {
        in[k] = known[node->operand[k]];
        ranges[k] = in[k].range;
    }
    out.range = hewn_op_bound(node, ranges);
    if (operands == 0) {
        out.linear = true;
    } else if (node->op == HEWN_OP_SQRT) {
        set_root(&out, field, node, known);
    } else if (operands == 1) {
        out.bound = unary(node->op, &in[0]);
        set_scaled(&out, &in[0]);
    } else if (operands == 2) {
        set_two(&out, field, node, in);
    } else if (node->op == HEWN_OP_AFFINE && in[0].linear && in[1].linear && in[2].linear) {
        set_linear(&out, node, in);
    } else {
        set_shape(&out, node, in);
    }
    if (out.range.maybe_nan || isnan(out.bound))
        out.bound = INFINITY;
    if (out.bound == INFINITY)
        set_round(&out);
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
