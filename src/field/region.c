/* Where a field can be below a level, read off its graph. Each node is asked at most two questions: which box holds all
 * points with a value at or below a level, and which holds all with one at or above a level. Questions run from the
 * root down (several users: the loosest level, which serves all), answers from the leaves up; both in one walk over the
 * nodes in order, so that depth costs no stack. */
#include <float.h>
#include <math.h>

#include "base/alloc.h"
#include "base/error.h"
#include "field/internal.h"
#include "field/sampling.h"

typedef struct question {
    uint32_t step;
    bool above; /* value >= level, else value <= level */
    double level;
} question;

typedef struct answers {
    double level[2]; /* of the questions below [0] and above [1]; -inf and +inf where not asked */
    hewn_region region[2];
} answers;

typedef enum rule_kind {
    RULE_UNKNOWN, /* nothing is known: all of space */
    RULE_LEAF,    /* the node itself says */
    RULE_HULL,    /* the points of any of the questions */
    RULE_MEET     /* the points of all of them */
} rule_kind;

enum { ASKED_MOST = 6 };

typedef struct rule {
    rule_kind kind;
    int count;
    question ask[ASKED_MOST];
} rule;

static const rule unknown = {RULE_UNKNOWN, 0, {{0}}};

/* What the rules look at: `everywhere[i]` bounds step i's value over all of space. */
typedef struct graph_view {
    const hewn_tape *tape;
    const hewn_field *field;
    const hewn_interval *everywhere;
} graph_view;

static hewn_region everywhere(void)
{
    return (hewn_region){{{-INFINITY, -INFINITY, -INFINITY}, {INFINITY, INFINITY, INFINITY}}, false};
}

static hewn_region nowhere(void)
{
    return (hewn_region){{{0, 0, 0}, {0, 0, 0}}, true};
}

/* --- rules ---------------------------------------------------------------------------------------------------------
 */

/* Levels are moved to the side that holds more points by more than their arithmetic can round. */
static question ask(uint32_t step, bool above, double level)
{
    double slack = 0x1p-50 * fabs(level) + DBL_MIN;
    return (question){step, above, above ? level - slack : level + slack};
}

static rule ask_one(question only)
{
    return (rule){RULE_HULL, 1, {only}};
}

static rule ask_both(rule_kind kind, const hewn_step *step, bool above, double level)
{
    return (rule){kind, 2, {ask(step->in[0], above, level), ask(step->in[1], above, level)}};
}

static bool constant_of(const hewn_tape *tape, uint32_t step, double *value)
{
    const hewn_node_data *node = tape->steps[step].node;
    *value = node->parameter[0];
    return node->op == HEWN_OP_CONSTANT && isfinite(*value);
}

static void add_question(rule *out, question asked)
{
    out->kind = RULE_MEET;
    out->ask[out->count++] = asked;
}

/* Of a sum at or below a level each part is below what the least of the rest leaves (and so for above). `factor` is
 * what each part is multiplied by. */
static rule parts_rule(const graph_view *view, const hewn_step *step, int count, const double *factor, double last,
                       bool above, double level)
{
    rule out = unknown;
    for (int i = 0; i < count; i++) {
        double rest = last;
        for (int k = 0; k < count; k++) {
            if (k == i || factor[k] == 0)
                continue;
            hewn_interval part = view->everywhere[step->in[k]];
            rest += factor[k] * (above == (factor[k] > 0) ? part.hi : part.lo);
        }
        double asked = (level - rest) / factor[i];
        if (factor[i] != 0 && isfinite(rest) && isfinite(asked)) {
            question one = ask(step->in[i], above == (factor[i] > 0), asked);
            double slack = 0x1p-48 * ((fabs(rest) + fabs(level)) / fabs(factor[i]));
            one.level += one.above ? -slack : slack;
            add_question(&out, one);
        }
    }
    return out;
}

static rule sum_rule(const graph_view *view, const hewn_step *step, bool above, double level)
{
    const double factor[2] = {1, step->node->op == HEWN_OP_SUB ? -1 : 1};
    return parts_rule(view, step, 2, factor, 0, above, level);
}

static rule product_rule(const hewn_tape *tape, const hewn_step *step, bool above, double level)
{
    double value;
    bool divides = step->node->op == HEWN_OP_DIV;
    uint32_t other = step->in[0];
    bool known = constant_of(tape, step->in[1], &value);
    if (!known && !divides && constant_of(tape, step->in[0], &value)) {
        known = true;
        other = step->in[1];
    }
    double asked = divides ? level * value : level / value;
    if (!known || value == 0 || !isfinite(asked))
        return unknown;
    return ask_one(ask(other, value < 0 ? !above : above, asked));
}

/* Between two values. */
static rule within_rule(uint32_t step, double low, double high)
{
    rule out = unknown;
    add_question(&out, ask(step, false, high));
    add_question(&out, ask(step, true, low));
    return out;
}

/* Roots lie above 0 and grow with their operands, so do squares of sizes. */
static rule root_rule(const hewn_step *step, bool above, double level)
{
    if (above)
        return level > 0 ? ask_one(ask(step->in[0], true, level * level)) : unknown;
    return ask_one(ask(step->in[0], false, level < 0 ? -DBL_MIN : level * level));
}

static rule square_rule(const hewn_step *step, bool above, double level)
{
    double size = level < 0 ? -DBL_MIN : sqrt(level);
    return above ? unknown : within_rule(step->in[0], -size, size);
}

/* The box around the corners of a chain of edges. */
static rule outline_rule(const graph_view *view, const hewn_step *step, double level)
{
    double lo[2] = {INFINITY, INFINITY}, hi[2] = {-INFINITY, -INFINITY};
    for (const hewn_node_data *link = &view->field->nodes[step->node->operand[0]]; link->op == HEWN_OP_EDGE;
         link = &view->field->nodes[link->operand[0]])
        for (int i = 0; i < 4; i++) {
            lo[i & 1] = fmin(lo[i & 1], link->parameter[i]);
            hi[i & 1] = fmax(hi[i & 1], link->parameter[i]);
        }
    rule out = unknown;
    for (int i = 0; i < 2; i++) {
        add_question(&out, ask(step->in[1 + i], false, hi[i] + level));
        add_question(&out, ask(step->in[1 + i], true, lo[i] - level));
    }
    return out;
}

static void half_sizes(const hewn_node_data *node, double half[3]);

/* How much a shape's box grows with the level. Samples may be steeper than distances, so their box does not shrink. */
static double grown_by(const hewn_node_data *node, double level)
{
    return node->op == HEWN_OP_SAMPLED ? fmax(level, 0) : level;
}

/* A shape whose coordinates are no affine ones: each of them lies in the shape's box, grown by the level. */
static rule shape_rule(const graph_view *view, const hewn_step *step, double level)
{
    double row[4], half[3];
    bool plain = true;
    for (int i = 0; i < 3; i++)
        plain = plain && hewn_node_row(view->field, step->node->operand[i], row);
    if (plain)
        return (rule){RULE_LEAF, 0, {{0}}};
    rule out = unknown;
    half_sizes(step->node, half);
    level = grown_by(step->node, level);
    for (int i = 0; i < 3; i++) {
        add_question(&out, ask(step->in[i], false, half[i] + level));
        add_question(&out, ask(step->in[i], true, -half[i] - level));
    }
    return out;
}

static rule affine_rule(const graph_view *view, const hewn_step *step, bool above, double level)
{
    double row[4];
    if (hewn_node_row(view->field, (uint32_t)(step->node - view->field->nodes), row))
        return (rule){RULE_LEAF, 0, {{0}}};
    return parts_rule(view, step, 3, step->node->parameter, step->node->parameter[3], above, level);
}

/* How points of the children answer a question about the node. */
static rule rule_of(const graph_view *view, const hewn_step *step, bool above, double level)
{
    hewn_op op = step->node->op;
    if ((op >= HEWN_OP_SPHERE && op <= HEWN_OP_CONE) || (op == HEWN_OP_SAMPLED && !step->node->samples->endless))
        return above ? unknown : shape_rule(view, step, level);
    switch (op) {
    case HEWN_OP_NEG: return ask_one(ask(step->in[0], !above, -level));
    case HEWN_OP_MIN: return ask_both(above ? RULE_MEET : RULE_HULL, step, above, level);
    case HEWN_OP_MAX: return ask_both(above ? RULE_HULL : RULE_MEET, step, above, level);
    case HEWN_OP_BLEND_QUADRATIC:
    case HEWN_OP_BLEND_CUBIC:
    case HEWN_OP_BLEND_CIRCULAR:
    case HEWN_OP_BLEND_EXPONENTIAL: /* between the minimum and the minimum less the blend's depth */
        return above ? ask_both(RULE_MEET, step, true, level)
                     : ask_both(RULE_HULL, step, false, level + hewn_blend_depth(step->node));
    case HEWN_OP_ADD:
    case HEWN_OP_SUB: return sum_rule(view, step, above, level);
    case HEWN_OP_MUL:
    case HEWN_OP_DIV: return product_rule(view->tape, step, above, level);
    case HEWN_OP_ABS: return above ? unknown : within_rule(step->in[0], -level, level);
    case HEWN_OP_SQRT: return root_rule(step, above, level);
    case HEWN_OP_SQUARE: return square_rule(step, above, level);
    case HEWN_OP_OUTLINE: return above ? unknown : outline_rule(view, step, level);
    case HEWN_OP_AFFINE: return affine_rule(view, step, above, level);
    case HEWN_OP_X:
    case HEWN_OP_Y:
    case HEWN_OP_Z:
    case HEWN_OP_CONSTANT:
    case HEWN_OP_PLANE: return (rule){RULE_LEAF, 0, {{0}}};
    default: return unknown;
    }
}

/* --- leaves --------------------------------------------------------------------------------------------------------
 */

/* a x + b y + c z + d at or below (above) a level: a half-space, which a box can say where it lies along an axis. */
static hewn_region half_space(const double row[4], bool above, double level)
{
    hewn_region out = everywhere();
    int axis = -1;
    for (int i = 0; i < 3; i++) {
        if (row[i] == 0)
            continue;
        if (axis >= 0)
            return out;
        axis = i;
    }
    if (axis < 0)
        return (above ? row[3] >= level : row[3] <= level) ? out : nowhere();
    double edge = (level - row[3]) / row[axis];
    double slack = 0x1p-49 * (fabs(level / row[axis]) + fabs(row[3] / row[axis]));
    if (!isfinite(edge) || !isfinite(slack))
        return out;
    if (above == (row[axis] > 0))
        out.box.lo[axis] = edge - slack;
    else
        out.box.hi[axis] = edge + slack;
    return out;
}

static void half_sizes(const hewn_node_data *node, double half[3])
{
    const double *p = node->parameter;
    double across = p[0], along = p[0];
    switch (node->op) {
    case HEWN_OP_SPHERE: break;
    case HEWN_OP_TORUS: across = p[0] + p[1], along = p[1]; break;
    case HEWN_OP_CYLINDER: along = p[1]; break;
    case HEWN_OP_CAPSULE: along = p[0] + p[1]; break;
    case HEWN_OP_CONE: across = fmax(p[0], p[1]), along = p[2]; break;
    case HEWN_OP_SAMPLED:
        for (int i = 0; i < 3; i++)
            half[i] = 0.5 * node->samples->cells[i];
        return;
    default: /* BOX, ROUNDED_BOX */
        for (int i = 0; i < 3; i++)
            half[i] = p[i] + (node->op == HEWN_OP_ROUNDED_BOX ? p[3] : 0);
        return;
    }
    half[0] = half[2] = across;
    half[1] = along;
}

/* The inverse of the rows' 3x3 part; false where it is singular or too near to it for its rounding to be small. */
static bool invert(const double m[3][4], double out[3][3])
{
    double size = 1;
    for (int i = 0; i < 3; i++) {
        size *= sqrt(m[i][0] * m[i][0] + m[i][1] * m[i][1] + m[i][2] * m[i][2]);
        for (int j = 0; j < 3; j++) {
            int a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
            out[j][i] = m[a][c] * m[b][d] - m[a][d] * m[b][c];
        }
    }
    double determinant = m[0][0] * out[0][0] + m[0][1] * out[1][0] + m[0][2] * out[2][0];
    if (!(fabs(determinant) > 1e-6 * size) || !(size > 0) || !isfinite(size))
        return false;
    for (int i = 0; i < 9; i++)
        out[i / 3][i % 3] /= determinant;
    return true;
}

/* The points m p + t within `half` of the origin, as a box around p. */
static hewn_region pulled_back(const double m[3][4], const double half[3])
{
    double inverse[3][3], centre[3];
    hewn_region out = everywhere();
    if (!invert(m, inverse))
        return out;
    for (int j = 0; j < 3; j++)
        centre[j] = -(inverse[j][0] * m[0][3] + inverse[j][1] * m[1][3] + inverse[j][2] * m[2][3]);
    for (int j = 0; j < 3; j++) {
        double reach = 0, slack = 0;
        for (int i = 0; i < 3; i++) {
            double weight = fabs(inverse[j][i]);
            double terms = fabs(m[i][3]) + half[i];
            for (int k = 0; k < 3; k++)
                terms += fabs(m[i][k] * centre[k]);
            reach += weight * half[i];
            slack += weight * terms * 0x1p-44;
        }
        if (!isfinite(centre[j] + reach + slack))
            return everywhere();
        out.box.lo[j] = centre[j] - reach - slack;
        out.box.hi[j] = centre[j] + reach + slack;
    }
    return out;
}

static hewn_region leaf(const hewn_field *field, const hewn_node_data *node, bool above, double level)
{
    double rows[3][4], half[3];
    if (hewn_op_infos[node->op].operands == 0 || node->op == HEWN_OP_AFFINE) {
        uint32_t id = (uint32_t)(node - field->nodes);
        return hewn_node_row(field, id, rows[0]) ? half_space(rows[0], above, level) : everywhere();
    }
    for (int i = 0; i < 3; i++)
        if (!hewn_node_row(field, node->operand[i], rows[i]))
            return everywhere();
    if (node->op == HEWN_OP_PLANE) {
        double row[4] = {0};
        for (int j = 0; j < 4; j++)
            for (int i = 0; i < 3; i++)
                row[j] += node->parameter[i] * rows[i][j];
        return half_space(row, above, level + node->parameter[3]);
    }
    /* The distance is exact outside and 1-Lipschitz inside: where it is at most the level (of either sign) lies within
     * the shape's box grown by the level. */
    half_sizes(node, half);
    level = grown_by(node, level);
    for (int i = 0; i < 3; i++) {
        half[i] += level;
        if (half[i] < 0)
            return nowhere();
    }
    return pulled_back((const double(*)[4])rows, half);
}

/* --- the two walks -------------------------------------------------------------------------------------------------
 */

static hewn_region combine(rule_kind kind, hewn_region a, hewn_region b)
{
    if (a.empty || b.empty)
        return kind == RULE_MEET || a.empty ? (kind == RULE_MEET ? nowhere() : b) : a;
    for (int i = 0; i < 3; i++) {
        double lo = fmin(a.box.lo[i], b.box.lo[i]), hi = fmax(a.box.hi[i], b.box.hi[i]);
        if (kind == RULE_MEET) {
            lo = fmax(a.box.lo[i], b.box.lo[i]);
            hi = fmin(a.box.hi[i], b.box.hi[i]);
            if (lo > hi)
                return nowhere();
        }
        a.box.lo[i] = lo;
        a.box.hi[i] = hi;
    }
    return a;
}

static void pass_questions(const graph_view *view, answers *all, size_t at)
{
    for (int above = 0; above < 2; above++) {
        double level = all[at].level[above];
        if (isinf(level))
            continue;
        rule r = rule_of(view, &view->tape->steps[at], above, level);
        for (int i = 0; i < r.count; i++) {
            double *asked = &all[r.ask[i].step].level[r.ask[i].above];
            *asked = r.ask[i].above ? fmin(*asked, r.ask[i].level) : fmax(*asked, r.ask[i].level);
        }
    }
}

static void answer_questions(const graph_view *view, answers *all, size_t at)
{
    const hewn_step *step = &view->tape->steps[at];
    for (int above = 0; above < 2; above++) {
        double level = all[at].level[above];
        hewn_region *out = &all[at].region[above];
        *out = everywhere();
        if (isinf(level))
            continue;
        rule r = rule_of(view, step, above, level);
        if (r.kind == RULE_LEAF)
            *out = leaf(view->field, step->node, above, level);
        for (int i = 0; i < r.count; i++) {
            hewn_region child = all[r.ask[i].step].region[r.ask[i].above];
            *out = i == 0 ? child : combine(r.kind, *out, child);
        }
    }
}

hewn_result hewn_tape_region(const hewn_tape *tape, const hewn_field *field, hewn_region *out, hewn_error *error)
{
    static const hewn_box space = {{-INFINITY, -INFINITY, -INFINITY}, {INFINITY, INFINITY, INFINITY}};
    answers *all = hewn_alloc(tape->count, sizeof *all);
    hewn_interval *bounds = hewn_alloc(tape->count, sizeof *bounds);
    if (!all || !bounds) {
        hewn_free(all);
        hewn_free(bounds);
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory finding a box around a field");
    }
    hewn_tape_bound(tape, &space, bounds);
    const graph_view view = {tape, field, bounds};
    for (size_t i = 0; i < tape->count; i++) {
        all[i].level[0] = -INFINITY;
        all[i].level[1] = INFINITY;
    }
    all[tape->count - 1].level[0] = 0;
    for (size_t i = tape->count; i-- > 0;)
        pass_questions(&view, all, i);
    for (size_t i = 0; i < tape->count; i++)
        answer_questions(&view, all, i);
    *out = all[tape->count - 1].region[0];
    hewn_free(all);
    hewn_free(bounds);
    return HEWN_OK;
}

bool hewn_field_known_box(const hewn_field *field, hewn_node node, hewn_box *out)
{
    hewn_tape tape;
    hewn_region region = {.empty = true};
    if (hewn_tape_create(&tape, field, node, NULL) != HEWN_OK)
        return false;
    hewn_result result = hewn_tape_region(&tape, field, &region, NULL);
    hewn_tape_destroy(&tape);
    *out = region.box;
    return result == HEWN_OK && !region.empty;
}
