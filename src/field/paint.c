/* Colours and labels: a PAINT node is its operand with a colour or a label to it. Evaluators pass it over; here it is
 * what counts. Along with its value each node carries the colour that its derivatives by the painted parts make
 * (forward mode, as in gradient.c, with colours for directions), so that what mixes values mixes colours in the same
 * proportion: blends by their own weights, a morph by its part. Minima and maxima choose. What is cut away from a
 * painted shape by one without paint leaves the shape its paint. */
#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/srgb.h"
#include "field/internal.h"
#include "field/interval.h"

enum { KINDS = 2, BLOCK = 128 };

/* Which paint a step depends on. */
enum { COLOR = 1, LABEL = 2 };

/* What a step carries: sums of colours and of derivatives, the colour for where those cancel out, the direction in
 * which the nearest painted part counts. */
typedef struct ink {
    double sum[3], weight, last[3];
    double sign;
    int32_t label;
} ink;

typedef struct painter {
    hewn_step *steps;
    uint8_t *kinds; /* of each step */
    size_t count;
} painter;

/* One thread's room. */
typedef struct easel {
    double *values;
    ink *inks;
    hewn_interval *bounds;
    uint32_t *active; /* the steps that matter in a block, in order */
    size_t active_count;
    uint8_t *choice; /* 1, 2: only that operand matters; 0: all do; 255: the step does not */
} easel;

static const double unpainted[3] = {0.62, 0.64, 0.67}; /* as pictures show shapes without a colour */

/* --- building ------------------------------------------------------------------------------------------------------
 */

static hewn_node paint(hewn_field *f, hewn_node shape, const double parameter[4])
{
    hewn_node_data data = {.op = HEWN_OP_PAINT, .operand = {shape.id, HEWN_NO_ID, HEWN_NO_ID}};
    memcpy(data.parameter, parameter, sizeof data.parameter);
    return hewn_field_add_node(f, &data);
}

hewn_node hewn_color(hewn_field *f, hewn_node shape, double red, double green, double blue)
{
    const double given[3] = {red, green, blue};
    double parameter[4] = {0, 0, 0, -1};
    for (int i = 0; i < 3; i++) {
        if (!(given[i] >= 0) || !(given[i] <= 1))
            return hewn_field_refuse(f, HEWN_INVALID_ARGUMENT, "color: red, green and blue lie between 0 and 1, not %g",
                                     given[i]);
        parameter[i] = hewn_srgb_to_linear(given[i]);
    }
    return paint(f, shape, parameter);
}

hewn_node hewn_label(hewn_field *f, hewn_node shape, uint32_t label)
{
    if (label > HEWN_LABEL_MOST)
        return hewn_field_refuse(f, HEWN_INVALID_ARGUMENT, "label: %u is more than %d", label, (int)HEWN_LABEL_MOST);
    return paint(f, shape, (const double[4]){-1, -1, -1, label});
}

/* --- which steps count ---------------------------------------------------------------------------------------------
 */

static uint8_t own_kinds(const hewn_node_data *node)
{
    if (node->op != HEWN_OP_PAINT)
        return 0;
    return (uint8_t)((node->parameter[0] >= 0 ? COLOR : 0) | (node->parameter[3] >= 0 ? LABEL : 0));
}

static int kinds_under(const hewn_field *field, hewn_node node)
{
    uint32_t *ids = NULL;
    size_t count = 0;
    int found = 0;
    if (hewn_field_live_nodes(field, node, &ids, &count, NULL) == HEWN_OK)
        for (size_t i = 0; i < count; i++)
            found |= own_kinds(&field->nodes[ids[i]]);
    hewn_free(ids);
    return found;
}

bool hewn_field_has_colors(const hewn_field *field, hewn_node node)
{
    return kinds_under(field, node) & COLOR;
}

bool hewn_field_has_labels(const hewn_field *field, hewn_node node)
{
    return kinds_under(field, node) & LABEL;
}

static void painter_destroy(painter *own)
{
    hewn_free(own->steps);
    hewn_free(own->kinds);
}

static hewn_result painter_create(painter *own, const hewn_field *field, hewn_node root, hewn_error *error)
{
    uint32_t *ids = NULL;
    size_t count = 0;
    *own = (painter){0};
    HEWN_TRY(hewn_field_live_nodes(field, root, &ids, &count, error));
    uint32_t *position = hewn_alloc((size_t)root.id + 1, sizeof *position);
    *own = (painter){hewn_alloc(count, sizeof *own->steps), hewn_alloc(count, 1), count};
    bool enough = position && own->steps && own->kinds;
    for (size_t i = 0; enough && i < count; i++) {
        const hewn_node_data *node = &field->nodes[ids[i]];
        position[ids[i]] = (uint32_t)i;
        own->steps[i] = (hewn_step){node, {HEWN_NO_ID, HEWN_NO_ID, HEWN_NO_ID}};
        own->kinds[i] = own_kinds(node);
        for (int k = 0; k < hewn_op_infos[node->op].operands; k++) {
            own->steps[i].in[k] = position[node->operand[k]];
            own->kinds[i] |= own->kinds[position[node->operand[k]]];
        }
    }
    hewn_free(position);
    hewn_free(ids);
    if (!enough)
        painter_destroy(own);
    return enough ? HEWN_OK : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a field's colours");
}

/* --- what matters in a box ------------------------------------------------------------------------------------------
 */

static bool chooses(hewn_op op)
{
    return op == HEWN_OP_MIN || op == HEWN_OP_MAX || (op >= HEWN_OP_BLEND_QUADRATIC && op <= HEWN_OP_BLEND_EXPONENTIAL);
}

/* The operand that alone decides the value and paint of a choice in the box; 0 where both may. */
static uint8_t only_operand(const painter *own, const easel *room, const hewn_step *step)
{
    const hewn_interval *a = &room->bounds[step->in[0]], *b = &room->bounds[step->in[1]];
    if (!chooses(step->node->op) || step->node->op == HEWN_OP_BLEND_EXPONENTIAL || a->maybe_nan || b->maybe_nan)
        return 0;
    double apart = step->node->op >= HEWN_OP_BLEND_QUADRATIC ? step->node->parameter[0] * 1.001 : 0;
    bool first_less = a->hi + apart < b->lo, second_less = b->hi + apart < a->lo;
    if (!first_less && !second_less)
        return 0;
    uint8_t kept = first_less == (step->node->op != HEWN_OP_MAX) ? 1 : 2;
    return (own->kinds[step->in[2 - kept]] & ~own->kinds[step->in[kept - 1]]) ? 0 : kept; /* paint may be inherited */
}

static void bound_steps(const painter *own, easel *room, const hewn_box *box)
{
    for (size_t i = 0; i < own->count; i++) {
        const hewn_step *step = &own->steps[i];
        int operands = hewn_op_infos[step->node->op].operands;
        hewn_interval in[3] = {{0}};
        for (int k = 0; k < operands; k++)
            in[k] = room->bounds[step->in[k]];
        if (step->node->op <= HEWN_OP_Z) {
            int axis = (int)(step->node->op - HEWN_OP_X);
            room->bounds[i] = (hewn_interval){box->lo[axis], box->hi[axis], false};
        } else {
            room->bounds[i] = step->node->op == HEWN_OP_PAINT ? in[0] : hewn_op_bound(step->node, in);
        }
    }
}

static void choose_active(const painter *own, easel *room, const hewn_box *box)
{
    bound_steps(own, room, box);
    memset(room->choice, 255, own->count);
    room->choice[own->count - 1] = 0;
    for (size_t i = own->count; i-- > 0;) {
        if (room->choice[i] == 255)
            continue;
        const hewn_step *step = &own->steps[i];
        room->choice[i] = hewn_op_infos[step->node->op].operands == 2 ? only_operand(own, room, step) : 0;
        for (int k = 0; k < hewn_op_infos[step->node->op].operands; k++)
            if (room->choice[i] == 0 || room->choice[i] == k + 1)
                room->choice[step->in[k]] = 0;
    }
    room->active_count = 0;
    for (size_t i = 0; i < own->count; i++)
        if (room->choice[i] != 255)
            room->active[room->active_count++] = (uint32_t)i;
}

/* --- a point -------------------------------------------------------------------------------------------------------
 */

/* How much of the second operand is in a choice of values a and b: the derivative by it. */
static double share_of_second(const hewn_node_data *node, double a, double b)
{
    if (node->op == HEWN_OP_MIN)
        return b < a ? 1 : 0;
    if (node->op == HEWN_OP_MAX)
        return b > a ? 1 : 0;
    double k = node->parameter[0], apart = fabs(a - b), t = fmax(k - apart, 0) / k, farther;
    switch (node->op) {
    case HEWN_OP_BLEND_QUADRATIC: farther = t / 2; break;
    case HEWN_OP_BLEND_CUBIC: farther = t * t / 2; break;
    case HEWN_OP_BLEND_CIRCULAR: farther = 0.5 * (1 - (1 - t) / sqrt(1 + t * (2 - t))); break;
    default: farther = 1 / (1 + exp(k * apart)); break;
    }
    farther = a == b ? 0.5 : farther;
    return b < a ? 1 - farther : farther;
}

static void color_of(const ink *of, double out[3])
{
    for (int i = 0; i < 3; i++) {
        double value = of->sum[i] / of->weight;
        out[i] = fabs(of->weight) > 1e-9 && isfinite(value) ? fmin(fmax(value, 0), 1) : of->last[i];
    }
}

static void put_color(ink *to, const double color[3])
{
    memcpy(to->sum, color, sizeof to->sum);
    memcpy(to->last, color, sizeof to->last);
    to->weight = 1;
}

/* Whether a choice leaves all to one painted operand: what is left of a painted shape that something without paint cuts
 * keeps its paint, and numbers have none. */
static bool inherits(const painter *own, const hewn_step *step, int painted, const ink *from)
{
    const hewn_node_data *other = own->steps[step->in[1 - painted]].node;
    bool cuts = (step->node->op == HEWN_OP_MAX) == (from->sign > 0);
    return cuts || other->op == HEWN_OP_CONSTANT;
}

static void choose(const painter *own, const easel *room, const hewn_step *step, ink *out)
{
    const uint32_t in[2] = {step->in[0], step->in[1]};
    uint8_t choice = room->choice[step - own->steps];
    double share = choice ? choice - 1 : share_of_second(step->node, room->values[in[0]], room->values[in[1]]);
    int nearer = share > 0.5, other = 1 - nearer;
    for (int kind = COLOR; kind <= LABEL; kind <<= 1) {
        bool painted[2] = {own->kinds[in[0]] & kind, own->kinds[in[1]] & kind};
        if (!painted[0] && !painted[1])
            continue;
        int only = painted[1];
        bool inherited = painted[0] != painted[1] && inherits(own, step, only, &room->inks[in[only]]);
        int from = inherited ? only : nearer;
        if (kind == LABEL) {
            out->label = painted[from] ? room->inks[in[from]].label : 0;
            continue;
        }
        bool pure = inherited || share == 0 || share == 1;
        double color[2][3];
        for (int k = 0; k < 2; k++)
            if (painted[k] && !(choice && k != choice - 1))
                color_of(&room->inks[in[k]], color[k]);
            else
                memcpy(color[k], unpainted, sizeof unpainted);
        for (int i = 0; i < 3 && !pure; i++)
            color[from][i] = (1 - share) * color[0][i] + share * color[1][i];
        put_color(out, color[from]);
        if (from != nearer &&
            own->steps[in[nearer]].node->op == HEWN_OP_CONSTANT) { /* the value does not depend on it */
            memset(out->sum, 0, sizeof out->sum);
            out->weight = 0;
        }
    }
    bool any = own->kinds[in[nearer]] != 0;
    out->sign = room->inks[in[any ? nearer : other]].sign;
}

static double derivative(const hewn_node_data *node, int k, const double in[3])
{
    double out = 1;
    switch (node->op) {
    case HEWN_OP_NEG: return -1;
    case HEWN_OP_ABS: return in[0] < 0 ? -1 : 1;
    case HEWN_OP_ZIGZAG: return remainder(in[0], node->parameter[0]) < 0 ? -1 : 1;
    case HEWN_OP_SQRT: out = 0.5 / sqrt(in[0]); break;
    case HEWN_OP_SQUARE: out = 2 * in[0]; break;
    case HEWN_OP_EXP: out = exp(in[0]); break;
    case HEWN_OP_LN: out = 1 / in[0]; break;
    case HEWN_OP_SUB: return k == 0 ? 1 : -1;
    case HEWN_OP_MUL: out = in[1 - k]; break;
    case HEWN_OP_DIV: out = k == 0 ? 1 / in[1] : -in[0] / (in[1] * in[1]); break;
    case HEWN_OP_AFFINE: return node->parameter[k];
    case HEWN_OP_AND: return (k == 0) == (in[0] == 0);
    case HEWN_OP_OR: return (k == 0) == (in[0] != 0);
    default: break;
    }
    return isfinite(out) ? out : 1;
}

static void combine(const painter *own, const easel *room, const hewn_step *step, const double in[3], ink *out)
{
    double strongest = -1;
    for (int k = 0; k < hewn_op_infos[step->node->op].operands; k++) {
        const ink *from = &room->inks[step->in[k]];
        if (own->kinds[step->in[k]] == 0)
            continue;
        double by = derivative(step->node, k, in), strength = fabs(by * from->weight);
        for (int i = 0; i < 3; i++)
            out->sum[i] += by * from->sum[i];
        out->weight += by * from->weight;
        if (strength <= strongest)
            continue;
        strongest = strength;
        out->sign = by < 0 ? -from->sign : from->sign;
        color_of(from, out->last);
        if (own->kinds[step->in[k]] & LABEL)
            out->label = from->label;
    }
}

static void apply(const painter *own, easel *room, uint32_t i, const double in[3])
{
    const hewn_step *step = &own->steps[i];
    ink out = {.sign = 1, .weight = 0};
    memcpy(out.last, unpainted, sizeof unpainted);
    if (step->node->op == HEWN_OP_PAINT) {
        const double *p = step->node->parameter;
        if (own->kinds[step->in[0]] != 0)
            out = room->inks[step->in[0]];
        else
            put_color(&out, unpainted);
        out.sign = 1;
        if (p[0] >= 0)
            put_color(&out, p);
        if (p[3] >= 0)
            out.label = (int32_t)p[3];
    } else if (chooses(step->node->op)) {
        choose(own, room, step, &out);
    } else {
        combine(own, room, step, in, &out);
    }
    room->inks[i] = out;
}

static void run_point(const painter *own, easel *room, const double *point)
{
    for (size_t n = 0; n < room->active_count; n++) {
        uint32_t i = room->active[n];
        const hewn_step *step = &own->steps[i];
        double in[3] = {0};
        for (int k = 0; k < hewn_op_infos[step->node->op].operands; k++)
            in[k] = room->values[step->in[k]]; /* that of an operand that does not matter is not looked at */
        if (step->node->op <= HEWN_OP_Z)
            room->values[i] = point[step->node->op - HEWN_OP_X];
        else if (step->node->op == HEWN_OP_PAINT)
            room->values[i] = in[0];
        else
            room->values[i] = room->choice[i] ? in[room->choice[i] - 1] : hewn_op_point(step->node, in);
        if (own->kinds[i])
            apply(own, room, i, in);
    }
}

/* --- all -----------------------------------------------------------------------------------------------------------
 */

static bool easel_create(easel *room, size_t count)
{
    *room = (easel){.values = hewn_alloc_zero(count, sizeof *room->values),
                    .inks = hewn_alloc_zero(count, sizeof *room->inks),
                    .bounds = hewn_alloc(count, sizeof *room->bounds),
                    .active = hewn_alloc(count, sizeof *room->active),
                    .choice = hewn_alloc(count, 1)};
    return room->values && room->inks && room->bounds && room->active && room->choice;
}

static void easel_destroy(easel *room)
{
    hewn_free(room->values);
    hewn_free(room->inks);
    hewn_free(room->bounds);
    hewn_free(room->active);
    hewn_free(room->choice);
}

static void run_block(const painter *own, easel *room, const double *points, size_t count, float *colors,
                      int32_t *labels)
{
    hewn_box box = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (size_t i = 0; i < 3 * count; i++) {
        box.lo[i % 3] = fmin(box.lo[i % 3], points[i]);
        box.hi[i % 3] = fmax(box.hi[i % 3], points[i]);
    }
    choose_active(own, room, &box);
    const ink *last = &room->inks[own->count - 1];
    for (size_t i = 0; i < count; i++) {
        double color[3];
        run_point(own, room, points + 3 * i);
        color_of(last, color);
        for (int k = 0; k < 3 && colors; k++)
            colors[3 * i + (size_t)k] = (float)(own->kinds[own->count - 1] & COLOR ? color[k] : unpainted[k]);
        if (labels)
            labels[i] = own->kinds[own->count - 1] & LABEL ? last->label : 0;
    }
}

hewn_result hewn_field_paint(const hewn_field *field, hewn_node node, const double *points, size_t count, float *colors,
                             int32_t *labels, hewn_error *error)
{
    painter own;
    if (count > 0 && !points)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "hewn_field_paint: no points");
    HEWN_TRY(painter_create(&own, field, node, error));
    bool enough = true;
#pragma omp parallel reduction(&& : enough)
    {
        easel room;
        enough = easel_create(&room, own.count);
#pragma omp for schedule(dynamic, 4)
        for (size_t first = 0; first < count; first += BLOCK)
            if (enough)
                run_block(&own, &room, points + 3 * first, count - first < BLOCK ? count - first : BLOCK,
                          colors ? colors + 3 * first : NULL, labels ? labels + first : NULL);
        easel_destroy(&room);
    }
    painter_destroy(&own);
    return enough ? HEWN_OK : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a field's colours");
}
