/* From a field's graph to the whole tape: shapes become arithmetic, constants numbers of the steps that use them. */
#include <float.h>
#include <math.h>

#include "base/alloc.h"
#include "base/error.h"
#include "field/sampling.h"
#include "lanes/internal.h"
#include "lanes/outline.h"

enum { MOST_STEPS_A_NODE = 24 };

typedef struct builder {
    hewn_lane_tape *tape;   /* no registers yet; outlines have their own arrays */
    hewn_lane_operands *in; /* of each step */
    uint32_t other_count, factor_count;
    size_t outline_room;
} builder;

/* As the shaders have numbers. */
static float rounded(double value)
{
    float single = (float)value;
    return fabsf(single) < FLT_MIN ? 0.0F : single;
}

static uint32_t put(builder *b, hewn_lane_kind kind, uint32_t a, uint32_t c, float number)
{
    uint32_t at = b->tape->count++;
    hewn_lane_step *step = &b->tape->steps[at];
    *step = (hewn_lane_step){.kind = (uint8_t)kind, .number = number};
    b->in[at][0] = a;
    b->in[at][1] = c;
    b->in[at][2] = HEWN_NO_STEP;
    step->input_count = (uint8_t)((a != HEWN_NO_STEP) + (c != HEWN_NO_STEP));
    return at;
}

static uint32_t one(builder *b, hewn_lane_kind kind, uint32_t a)
{
    return put(b, kind, a, HEWN_NO_STEP, 0);
}

static uint32_t with(builder *b, hewn_lane_kind kind, uint32_t a, double number)
{
    return put(b, kind, a, HEWN_NO_STEP, rounded(number));
}

static uint32_t two(builder *b, hewn_lane_kind kind, uint32_t a, uint32_t c)
{
    return put(b, kind, a, c, 0);
}

static uint32_t number(builder *b, double value)
{
    return put(b, HEWN_LANE_NUMBER, HEWN_NO_STEP, HEWN_NO_STEP, rounded(value));
}

/* --- shapes, step by step as in shaders/field/point.glsl ------------------------------------------------------------
 */

/* Of two or three. */
static uint32_t length_of(builder *b, const uint32_t *in, int count)
{
    uint32_t at = two(b, HEWN_LANE_LENGTH, in[0], in[1]);
    b->in[at][2] = count > 2 ? in[2] : HEWN_NO_STEP;
    b->tape->steps[at].input_count = (uint8_t)count;
    return at;
}

static uint32_t length2(builder *b, uint32_t x, uint32_t y)
{
    return length_of(b, (uint32_t[]){x, y}, 2);
}

/* Lengths take a number along. */
static uint32_t plus(builder *b, uint32_t a, double number)
{
    hewn_lane_step *step = &b->tape->steps[a];
    if (step->kind != HEWN_LANE_LENGTH || step->number != 0)
        return with(b, HEWN_LANE_PLUS, a, number);
    uint32_t at = put(b, HEWN_LANE_LENGTH, b->in[a][0], b->in[a][1], rounded(number));
    b->in[at][2] = b->in[a][2];
    b->tape->steps[at].input_count = step->input_count;
    return at;
}

static uint32_t positive(builder *b, uint32_t a)
{
    return with(b, HEWN_LANE_FLOOR_AT, a, 0);
}

static uint32_t over(builder *b, uint32_t a, double half)
{
    return with(b, HEWN_LANE_OVER, a, -half);
}

static uint32_t box(builder *b, const double *half, const uint32_t *in)
{
    uint32_t past[3], outside[3];
    for (int i = 0; i < 3; i++) {
        past[i] = over(b, in[i], half[i]);
        outside[i] = positive(b, past[i]);
    }
    uint32_t most = two(b, HEWN_LANE_MAX, two(b, HEWN_LANE_MAX, past[0], past[1]), past[2]);
    return two(b, HEWN_LANE_ADD, length_of(b, outside, 3), with(b, HEWN_LANE_CEIL_AT, most, 0));
}

static uint32_t cylinder(builder *b, const double *p, const uint32_t *in)
{
    uint32_t x = plus(b, length2(b, in[0], in[2]), -p[0]), y = over(b, in[1], p[1]);
    uint32_t outside = length2(b, positive(b, x), positive(b, y));
    return two(b, HEWN_LANE_ADD, outside, with(b, HEWN_LANE_CEIL_AT, two(b, HEWN_LANE_MAX, x, y), 0));
}

/* Terms with a factor of zero are left out, as they are in shaders; a factor of one changes no bit. */
static uint32_t affine(builder *b, const double *factors, double last, const uint32_t *in)
{
    float *held = b->tape->factors[b->factor_count];
    uint32_t parts[HEWN_LANE_INPUTS] = {HEWN_NO_STEP, HEWN_NO_STEP, HEWN_NO_STEP}, count = 0;
    for (int i = 0; i < 3; i++) {
        float factor = rounded(factors[i]);
        if (factor == 0)
            continue;
        held[count] = factor;
        parts[count++] = in[i];
    }
    if (count == 0)
        return number(b, last);
    if (count == 1 && held[0] == 1)
        return with(b, HEWN_LANE_PLUS, parts[0], last);
    uint32_t at = put(b, HEWN_LANE_AFFINE, parts[0], parts[1], rounded(last));
    b->in[at][2] = parts[2];
    b->tape->steps[at].input_count = (uint8_t)count;
    b->tape->steps[at].node = b->factor_count++;
    return at;
}

/* --- arithmetic ----------------------------------------------------------------------------------------------------
 */

static bool is_number(const builder *b, uint32_t step)
{
    return b->tape->steps[step].kind == HEWN_LANE_NUMBER;
}

static uint32_t sum(builder *b, uint32_t a, uint32_t c, hewn_lane_kind with_number, hewn_lane_kind otherwise)
{
    if (is_number(b, a)) {
        uint32_t held = a;
        a = c;
        c = held;
    }
    return is_number(b, c) ? put(b, with_number, a, HEWN_NO_STEP, b->tape->steps[c].number) : two(b, otherwise, a, c);
}

static uint32_t difference(builder *b, uint32_t a, uint32_t c)
{
    if (is_number(b, c))
        return put(b, HEWN_LANE_PLUS, a, HEWN_NO_STEP, -b->tape->steps[c].number);
    if (is_number(b, a))
        return put(b, HEWN_LANE_LESS, c, HEWN_NO_STEP, b->tape->steps[a].number);
    return two(b, HEWN_LANE_SUB, a, c);
}

/* The root of a sum of two or three squares is a length. The squares stay where something else needs them. */
static uint32_t root(builder *b, uint32_t a)
{
    const hewn_lane_step *steps = b->tape->steps;
    uint32_t parts[HEWN_LANE_INPUTS], count = 0, last = a;
    if (steps[a].kind == HEWN_LANE_ADD && steps[b->in[a][0]].kind == HEWN_LANE_ADD)
        last = b->in[a][0];
    if (steps[last].kind != HEWN_LANE_ADD)
        return one(b, HEWN_LANE_SQRT, a);
    const uint32_t terms[HEWN_LANE_INPUTS] = {b->in[last][0], b->in[last][1], b->in[a][1]};
    for (uint32_t i = 0; i < (last == a ? 2U : 3U); i++) {
        if (steps[terms[i]].kind != HEWN_LANE_SQUARE)
            return one(b, HEWN_LANE_SQRT, a);
        parts[count++] = b->in[terms[i]][0];
    }
    return length_of(b, parts, (int)count);
}

static uint32_t other(builder *b, const hewn_node_data *node, const uint32_t *in)
{
    bool blend = node->op >= HEWN_OP_BLEND_QUADRATIC && node->op <= HEWN_OP_BLEND_EXPONENTIAL;
    uint32_t at = put(b, blend ? HEWN_LANE_OTHER_BLEND : HEWN_LANE_OTHER, HEWN_NO_STEP, HEWN_NO_STEP, 0);
    hewn_lane_step *step = &b->tape->steps[at];
    step->input_count = hewn_op_infos[node->op].operands;
    for (uint32_t i = 0; i < step->input_count; i++)
        b->in[at][i] = in[i];
    step->number = (float)node->parameter[0];
    step->node = b->other_count;
    if (node->samples)
        hewn_sampling_share(node->samples);
    b->tape->others[b->other_count++] = *node;
    return at;
}

static uint32_t shape(builder *b, const hewn_node_data *node, const uint32_t *in)
{
    const double *p = node->parameter;
    switch (node->op) {
    case HEWN_OP_AFFINE: return affine(b, p, p[3], in);
    case HEWN_OP_PLANE: return affine(b, p, -p[3], in);
    case HEWN_OP_SPHERE: return plus(b, length_of(b, in, 3), -p[0]);
    case HEWN_OP_BOX: return box(b, p, in);
    case HEWN_OP_ROUNDED_BOX: return with(b, HEWN_LANE_PLUS, box(b, p, in), -p[3]);
    case HEWN_OP_TORUS: {
        uint32_t ring = plus(b, length2(b, in[0], in[2]), -p[0]);
        return plus(b, length2(b, ring, in[1]), -p[1]);
    }
    case HEWN_OP_CYLINDER: return cylinder(b, p, in);
    case HEWN_OP_CAPSULE: {
        uint32_t parts[3] = {in[0], positive(b, over(b, in[1], p[1])), in[2]};
        return plus(b, length_of(b, parts, 3), -p[0]);
    }
    default: return other(b, node, in);
    }
}

static uint32_t add_node(builder *b, const hewn_node_data *node, const uint32_t *in)
{
    switch (node->op) {
    case HEWN_OP_X: return put(b, HEWN_LANE_X, HEWN_NO_STEP, HEWN_NO_STEP, 0);
    case HEWN_OP_Y: return put(b, HEWN_LANE_Y, HEWN_NO_STEP, HEWN_NO_STEP, 0);
    case HEWN_OP_Z: return put(b, HEWN_LANE_Z, HEWN_NO_STEP, HEWN_NO_STEP, 0);
    case HEWN_OP_CONSTANT: return number(b, node->parameter[0]);
    case HEWN_OP_NEG: return one(b, HEWN_LANE_NEG, in[0]);
    case HEWN_OP_ABS: return one(b, HEWN_LANE_ABS, in[0]);
    case HEWN_OP_SQRT: return root(b, in[0]);
    case HEWN_OP_SQUARE: return one(b, HEWN_LANE_SQUARE, in[0]);
    case HEWN_OP_ADD: return sum(b, in[0], in[1], HEWN_LANE_PLUS, HEWN_LANE_ADD);
    case HEWN_OP_MUL: return sum(b, in[0], in[1], HEWN_LANE_TIMES, HEWN_LANE_MUL);
    case HEWN_OP_MIN: return sum(b, in[0], in[1], HEWN_LANE_CEIL_AT, HEWN_LANE_MIN);
    case HEWN_OP_MAX: return sum(b, in[0], in[1], HEWN_LANE_FLOOR_AT, HEWN_LANE_MAX);
    case HEWN_OP_SUB: return difference(b, in[0], in[1]);
    case HEWN_OP_BLEND_QUADRATIC: {
        uint32_t at = put(b, HEWN_LANE_BLEND, in[0], in[1], rounded(node->parameter[0]));
        b->tape->steps[at].inverse = rounded(1 / node->parameter[0]);
        return at;
    }
    default: return shape(b, node, in);
    }
}

/* An outline is one step in place of its links; `*place` stays none where it is not to be read. */
static hewn_result add_outline(builder *b, const hewn_field *field, const hewn_node_data *node, const uint32_t *in,
                               uint32_t *place, hewn_error *error)
{
    hewn_lane_tape *tape = b->tape;
    hewn_lane_outline read;
    *place = HEWN_NO_STEP;
    HEWN_TRY(hewn_reserve((void **)&tape->outlines, &b->outline_room, (size_t)tape->outline_count + 1,
                          sizeof *tape->outlines, error));
    HEWN_TRY(hewn_lane_outline_read(field, node, &read, error));
    if (!read.sides)
        return HEWN_OK;
    *place = two(b, HEWN_LANE_OUTLINE, in[1], in[2]);
    tape->steps[*place].node = tape->outline_count;
    tape->outlines[tape->outline_count++] = read;
    return HEWN_OK;
}

static hewn_result fill(builder *b, const hewn_field *field, const uint32_t *ids, size_t count, uint32_t *places,
                        hewn_error *error)
{
    for (size_t i = 0; i < count; i++) {
        const hewn_node_data *node = hewn_field_node(field, ids[i]);
        uint32_t in[HEWN_MAX_OPERANDS] = {HEWN_NO_STEP, HEWN_NO_STEP, HEWN_NO_STEP}, *place = &places[ids[i]];
        for (int k = 0; k < hewn_op_infos[node->op].operands; k++)
            in[k] = places[node->operand[k]];
        *place = HEWN_NO_STEP;
        if (node->op == HEWN_OP_PAINT)
            *place = in[0];
        else if (node->op == HEWN_OP_OUTLINE)
            HEWN_TRY(add_outline(b, field, node, in, place, error));
        if (*place == HEWN_NO_STEP)
            *place = add_node(b, node, in);
    }
    return HEWN_OK;
}

static void free_builder(builder *b)
{
    for (uint32_t i = 0; b->tape && i < b->tape->outline_count; i++)
        hewn_lane_outline_free(&b->tape->outlines[i]);
    if (b->tape)
        hewn_free(b->tape->outlines);
    hewn_free(b->tape);
    hewn_free(b->in);
}

static void free_others(hewn_node_data *others, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        hewn_sampling *samples = (hewn_sampling *)others[i].samples;
        hewn_sampling_destroy(&samples);
    }
    hewn_free(others);
}

hewn_result hewn_lane_tape_create(const hewn_field *field, hewn_node root, hewn_lane_tape **out, hewn_error *error)
{
    *out = NULL;
    uint32_t *ids = NULL;
    size_t count = 0;
    HEWN_TRY(hewn_field_live_nodes(field, root, &ids, &count, error));
    builder b = {.tape = hewn_alloc(1, sizeof *b.tape + count * MOST_STEPS_A_NODE * sizeof *b.tape->steps),
                 .in = hewn_alloc(count * MOST_STEPS_A_NODE, sizeof *b.in)};
    hewn_node_data *others = hewn_alloc(count, sizeof *others);
    hewn_lane_factors *factors = hewn_alloc_zero(count, sizeof *factors);
    uint32_t *places = hewn_alloc((size_t)root.id + 1, sizeof *places);
    hewn_result result = HEWN_OK;
    if (b.tape)
        *b.tape = (hewn_lane_tape){0};
    if (b.tape && b.in && others && factors && places) {
        *b.tape = (hewn_lane_tape){.others = others, .factors = factors};
        result = fill(&b, field, ids, count, places, error);
        if (result == HEWN_OK)
            result = hewn_lane_tape_settle(b.tape, b.in, places[root.id], out, error);
    } else {
        result = hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the tape of a field");
    }
    if (result == HEWN_OK) {
        (*out)->owns = true;
        (*out)->other_count = b.other_count;
    } else {
        free_others(others, b.other_count);
        hewn_free(factors);
    }
    hewn_free(places);
    hewn_free(ids);
    free_builder(&b);
    return result;
}

void hewn_lane_tape_destroy(hewn_lane_tape **tape)
{
    if (*tape && (*tape)->owns) {
        free_others((*tape)->others, (*tape)->other_count);
        hewn_free((*tape)->factors);
    }
    if (*tape)
        hewn_free((*tape)->outlines);
    hewn_free(*tape);
    *tape = NULL;
}

/* --- work -----------------------------------------------------------------------------------------------------------
 */

hewn_result hewn_lane_work_create(const hewn_lane_tape *whole, hewn_lane_work *out, hewn_error *error)
{
    enum { ROWS = 4 }; /* a register's value and three derivatives, or two bounds */
    *out =
        (hewn_lane_work){.values = hewn_alloc((size_t)(whole->registers + 1) * ROWS * HEWN_LANES, sizeof *out->values),
                         .choices = hewn_alloc((size_t)(whole->cuts + 1) * HEWN_LANES, sizeof *out->choices),
                         .scratch = hewn_alloc((size_t)whole->count * 7, sizeof *out->scratch),
                         .held = hewn_alloc((size_t)whole->registers + 1, sizeof *out->held),
                         .places = hewn_alloc((size_t)whole->outline_count * 4 * HEWN_LANES, sizeof *out->places),
                         .distances = hewn_alloc(whole->side_count, sizeof *out->distances),
                         .picked = hewn_lane_outlines_room(whole)};
    if (out->values && out->choices && out->scratch && out->held && out->places && out->distances && out->picked)
        return HEWN_OK;
    hewn_lane_work_destroy(out);
    return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory evaluating a field");
}

void hewn_lane_work_destroy(hewn_lane_work *work)
{
    hewn_free(work->values);
    hewn_free(work->choices);
    hewn_free(work->scratch);
    hewn_free(work->held);
    hewn_free(work->places);
    hewn_free(work->distances);
    hewn_free(work->picked);
    *work = (hewn_lane_work){0};
}
