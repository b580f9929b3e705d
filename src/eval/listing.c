#include "eval/listing.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "field/sampling.h"

float hewn_listing_rounded(double value)
{
    float single = (float)value;
    return fabsf(single) < FLT_MIN ? 0.0f : single;
}

static void put(hewn_listing *listing, hewn_code_step *step, double value)
{
    listing->parameters[listing->parameter_count++] = hewn_listing_rounded(value);
    step->parameter_count++;
}

/* Terms with a factor of zero are left out, and a lone factor of one is not multiplied: most affine nodes are moves
 * along the axes, and then a coordinate depends on one variable only. This much of the numbers is in the code. */
static void put_affine(hewn_listing *listing, hewn_code_step *step, const double *factors, double last)
{
    uint32_t kept = 0;
    double factor[3];
    for (uint32_t i = 0; i < 3; i++)
        if (hewn_listing_rounded(factors[i]) != 0) {
            factor[kept] = factors[i];
            step->in[kept++] = step->in[i];
        }
    step->in_count = kept;
    step->function = "affine";
    if (kept == 1 && hewn_listing_rounded(factor[0]) == 1) {
        step->function = "shift";
        kept = 0;
    }
    for (uint32_t i = 0; i < kept; i++)
        put(listing, step, factor[i]);
    put(listing, step, last);
    if (step->in_count == 0) { /* nothing is left but the constant */
        step->op = HEWN_OP_CONSTANT;
        step->function = NULL;
    }
}

/* With the slant's unit normal, half its length and its radius in the middle. */
static void put_cone(hewn_listing *listing, hewn_code_step *step, const double *p)
{
    double slant = hypot(2 * p[2], p[0] - p[1]);
    for (int i = 0; i < 3; i++)
        put(listing, step, p[i]);
    put(listing, step, 2 * p[2] / slant);
    put(listing, step, (p[0] - p[1]) / slant);
    put(listing, step, 0.5 * slant);
    put(listing, step, 0.5 * (p[0] + p[1]));
}

static void put_edge(hewn_listing *listing, hewn_code_step *step, const double *p)
{
    float edge[HEWN_TABLE_SIDE];
    hewn_listing_round_edge(p, edge);
    for (int i = 0; i < HEWN_TABLE_SIDE; i++)
        put(listing, step, (double)edge[i]);
}

/* Where the samples are on the device, which whoever brings them there writes over the first three numbers; the cells
 * along each axis, whether values grow past them, and the largest of them. */
static void put_sampled(hewn_listing *listing, hewn_code_step *step, const hewn_sampling *samples)
{
    for (int i = 0; i < HEWN_ADDRESS_NUMBERS; i++)
        put(listing, step, 0);
    for (int i = 0; i < 3; i++)
        put(listing, step, samples->cells[i]);
    put(listing, step, samples->endless ? 0 : 1);
    put(listing, step, fmax(fabs((double)samples->least), fabs((double)samples->greatest)));
    step->samples = samples;
}

void hewn_listing_set_address(hewn_listing *listing, const hewn_code_step *step, uint64_t address)
{
    enum { BITS = 22 }; /* a float holds so many, and on no way does any of them become another float */
    for (int i = 0; i < HEWN_ADDRESS_NUMBERS; i++)
        listing->parameters[step->parameter + (uint32_t)i] = (float)(address >> BITS * i & ((1u << BITS) - 1));
}

static void put_parameters(hewn_listing *listing, hewn_code_step *step, const hewn_node_data *node)
{
    const double *p = node->parameter;
    switch (node->op) {
    case HEWN_OP_X:
    case HEWN_OP_Y:
    case HEWN_OP_Z: step->function = NULL; break;
    case HEWN_OP_CONSTANT:
        step->function = NULL;
        put(listing, step, p[0]);
        break;
    case HEWN_OP_AFFINE: put_affine(listing, step, p, p[3]); break;
    case HEWN_OP_PLANE: put_affine(listing, step, p, -p[3]); break;
    case HEWN_OP_CONE: put_cone(listing, step, p); break;
    case HEWN_OP_EDGE: put_edge(listing, step, p); break;
    case HEWN_OP_SAMPLED: put_sampled(listing, step, node->samples); break;
    case HEWN_OP_ZIGZAG:
    case HEWN_OP_BLEND_QUADRATIC:
    case HEWN_OP_BLEND_CUBIC:
    case HEWN_OP_BLEND_CIRCULAR:
    case HEWN_OP_BLEND_EXPONENTIAL:
        put(listing, step, p[0]);
        put(listing, step, 1 / p[0]);
        break;
    default:
        for (int i = 0; i < hewn_op_infos[node->op].parameters; i++)
            put(listing, step, p[i]);
    }
}

bool hewn_listing_is_plain(const hewn_listing *listing, const hewn_code_step *step, uint32_t i)
{
    const hewn_code_step *in = &listing->steps[step->in[i]];
    hewn_op op = step->op;
    return i == 1 && in->op == HEWN_OP_CONSTANT && in->sure &&
           (op == HEWN_OP_ADD || op == HEWN_OP_SUB || op == HEWN_OP_MUL || op == HEWN_OP_DIV || op == HEWN_OP_MIN ||
            op == HEWN_OP_MAX);
}

/* Where the table is, as with samples, and what it says of itself. */
static void put_table(hewn_listing *listing, hewn_code_step *step, uint32_t table)
{
    for (int i = 0; i < HEWN_ADDRESS_NUMBERS; i++)
        put(listing, step, 0);
    for (int i = 0; i < HEWN_TABLE_NUMBERS; i++)
        put(listing, step, (double)listing->tables[table - 1].numbers[i]);
    step->function = "outline_table";
    step->table = table;
}

static void add_step(hewn_listing *listing, const hewn_node_data *node, const hewn_table_use *use,
                     const uint32_t *places)
{
    const hewn_op_info *info = &hewn_op_infos[node->op];
    hewn_code_step *step = &listing->steps[listing->count++];
    *step = (hewn_code_step){.op = node->op, .function = info->name, .parameter = (uint32_t)listing->parameter_count};
    if (use->table) {
        step->op = HEWN_OP_OUTLINE;
        for (int i = 0; i < 2; i++)
            step->in[step->in_count++] = places[use->at[i]];
        put_table(listing, step, use->table);
    } else {
        for (uint32_t i = 0; i < info->operands; i++)
            step->in[step->in_count++] = places[node->operand[i]];
        put_parameters(listing, step, node);
    }
    if (node->op <= HEWN_OP_Z)
        step->axes = 1u << (node->op - HEWN_OP_X);
    for (uint32_t i = 0; i < step->in_count; i++)
        step->axes |= listing->steps[step->in[i]].axes;
    hewn_code_step_reach(listing, step);
}

static void add_steps(hewn_listing *listing, const hewn_field *field, const uint32_t *ids, size_t count,
                      const hewn_table_use *uses, uint32_t *places)
{
    for (size_t i = 0; i < count; i++) {
        const hewn_node_data *node = hewn_field_node(field, ids[i]);
        if (!uses[ids[i]].needed)
            continue;
        if (node->op == HEWN_OP_PAINT) {
            places[ids[i]] = places[node->operand[0]];
            continue;
        }
        places[ids[i]] = (uint32_t)listing->count;
        add_step(listing, node, &uses[ids[i]], places);
    }
}

static hewn_result fill(hewn_listing *listing, const hewn_field *field, const uint32_t *ids, size_t count, bool chained,
                        hewn_error *error)
{
    enum { PARAMETERS_MAX = 8 };
    size_t nodes = hewn_field_node_count(field);
    uint32_t *places = hewn_alloc(nodes, sizeof *places);
    hewn_table_use *uses = hewn_alloc_zero(nodes, sizeof *uses);
    listing->steps = hewn_alloc_zero(count, sizeof *listing->steps);
    listing->parameters = hewn_alloc(count, PARAMETERS_MAX * sizeof *listing->parameters);
    hewn_result result = HEWN_OK;
    if (!places || !uses || !listing->steps || !listing->parameters)
        result = hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory listing %zu operations", count);
    else
        result = hewn_listing_make_tables(listing, field, ids, count, chained, uses, error);
    if (result == HEWN_OK)
        add_steps(listing, field, ids, count, uses, places);
    hewn_free(uses);
    hewn_free(places);
    return result;
}

hewn_result hewn_listing_create(hewn_listing *out, const hewn_field *field, hewn_node root, bool chained,
                                hewn_error *error)
{
    memset(out, 0, sizeof *out);
    uint32_t *ids;
    size_t count;
    HEWN_TRY(hewn_field_live_nodes(field, root, &ids, &count, error));
    hewn_result result = fill(out, field, ids, count, chained, error);
    hewn_free(ids);
    if (result == HEWN_OK)
        result = hewn_listing_part(out, error);
    if (result != HEWN_OK)
        hewn_listing_destroy(out);
    return result;
}

void hewn_listing_destroy(hewn_listing *listing)
{
    for (size_t i = 0; i < listing->table_count; i++)
        hewn_free(listing->tables[i].words);
    hewn_free(listing->tables);
    hewn_free(listing->steps);
    hewn_free(listing->parameters);
    memset(listing, 0, sizeof *listing);
}

uint32_t hewn_listing_weight(const hewn_code_step *step)
{
    if (!step->function)
        return 0;
    if (step->table)
        return 150;
    switch (step->op) {
    case HEWN_OP_SIN:
    case HEWN_OP_COS:
    case HEWN_OP_TAN:
    case HEWN_OP_ASIN:
    case HEWN_OP_ACOS:
    case HEWN_OP_ATAN:
    case HEWN_OP_ATAN2:
    case HEWN_OP_EXP:
    case HEWN_OP_LN:
    case HEWN_OP_MOD: return 30;
    case HEWN_OP_AFFINE:
    case HEWN_OP_PLANE: return 2 * step->in_count;
    case HEWN_OP_SQRT:
    case HEWN_OP_DIV: return 6;
    case HEWN_OP_SPHERE:
    case HEWN_OP_CAPSULE: return 12;
    case HEWN_OP_BOX:
    case HEWN_OP_ROUNDED_BOX:
    case HEWN_OP_TORUS:
    case HEWN_OP_CYLINDER: return 22;
    case HEWN_OP_CONE:
    case HEWN_OP_BLEND_EXPONENTIAL: return 70;
    case HEWN_OP_NOISE_VALUE: return 150;
    case HEWN_OP_NOISE_GRADIENT:
    case HEWN_OP_NOISE_SIMPLEX: return 220;
    case HEWN_OP_NOISE_CELLULAR: return 700;
    case HEWN_OP_SAMPLED: return 150;
    case HEWN_OP_EDGE: return 24;
    case HEWN_OP_OUTLINE:
    case HEWN_OP_ZIGZAG: return 6;
    case HEWN_OP_BLEND_QUADRATIC:
    case HEWN_OP_BLEND_CUBIC:
    case HEWN_OP_BLEND_CIRCULAR: return 16;
    default: return 2;
    }
}

/* --- text -------------------------------------------------------------------------------------------------------- */

static const char *const types[] = {"float", "vec2", "vec4"};

static void write_number(const hewn_listing *listing, uint32_t i, hewn_text *text)
{
    float value = listing->parameters[i];
    if (!listing->fixed) {
        hewn_text_print(text, "P(%u)", i);
    } else if (!isfinite(value)) {
        hewn_text_append(text, isnan(value) ? "F_NAN" : value > 0 ? "F_INF" : "(-F_INF)");
    } else {
        /* nine digits tell any two floats apart; a point or an exponent makes the literal a float */
        char digits[32];
        snprintf(digits, sizeof digits, "%.9g", (double)value);
        hewn_text_append(text, digits);
        if (!strpbrk(digits, ".e"))
            hewn_text_append(text, ".0");
    }
}

/* What depends on y and not on x there is four times, where rows are written side by side. */
static void write_row_of(const hewn_listing *listing, const hewn_code_step *step, hewn_text *text)
{
    if (listing->row > 0 && (step->axes & (HEWN_AXIS_X | HEWN_AXIS_Y)) == HEWN_AXIS_Y)
        hewn_text_print(text, "[%u]", listing->row - 1);
}

static void write_operand(const hewn_listing *listing, uint32_t at, hewn_listing_flavour flavour, bool plain,
                          hewn_text *text)
{
    const hewn_code_step *step = &listing->steps[at];
    if (step->op <= HEWN_OP_Z) {
        hewn_text_append_bytes(text, &"xyz"[step->op - HEWN_OP_X], 1);
        write_row_of(listing, step, text);
    } else if (step->op == HEWN_OP_CONSTANT) {
        static const char *const openings[] = {"", "f_number(", "vec4(vec3(0.0),"};
        hewn_listing_flavour form = plain ? HEWN_LISTING_POINT : flavour;
        hewn_text_append(text, openings[form]);
        write_number(listing, step->parameter, text);
        hewn_text_append(text, form == HEWN_LISTING_POINT ? "" : ")");
    } else {
        hewn_text_print(text, "n%u", at);
        write_row_of(listing, step, text);
    }
}

/* Operations that give [-inf, inf] of their own accord where finite operands have no finite result. */
static bool guards_itself(hewn_op op)
{
    return op == HEWN_OP_SQRT || op == HEWN_OP_LN || op == HEWN_OP_ASIN || op == HEWN_OP_ACOS || op == HEWN_OP_TAN ||
           op == HEWN_OP_DIV || op == HEWN_OP_MOD;
}

bool hewn_listing_needs_guard(const hewn_listing *listing, const hewn_code_step *step)
{
    for (uint32_t i = 0; i < step->in_count; i++)
        if (!listing->steps[step->in[i]].sure)
            return true;
    return !step->sure && !guards_itself(step->op);
}

static void write_operands(const hewn_listing *listing, const hewn_code_step *step, hewn_listing_flavour flavour,
                           bool always_whole, hewn_text *text)
{
    for (uint32_t i = 0; i < step->in_count; i++) {
        if (i > 0)
            hewn_text_append_bytes(text, ",", 1);
        write_operand(listing, step->in[i], flavour, !always_whole && hewn_listing_is_plain(listing, step, i), text);
    }
}

static void write_step(const hewn_listing *listing, uint32_t at, hewn_listing_flavour flavour, hewn_text *text)
{
    const hewn_code_step *step = &listing->steps[at];
    if (!step->function)
        return;
    bool guard = flavour == HEWN_LISTING_INTERVAL && hewn_listing_needs_guard(listing, step);
    bool known = flavour != HEWN_LISTING_INTERVAL && listing->near && step->sure;
    const char *function = known && step->op == HEWN_OP_MIN   ? "lesser"
                           : known && step->op == HEWN_OP_MAX ? "greater"
                                                              : step->function;
    hewn_text_print(text, "n%u", at);
    write_row_of(listing, step, text);
    hewn_text_print(text, "=%sf_%s(", guard ? "f_guard(" : "", function);
    write_operands(listing, step, flavour, false, text);
    for (uint32_t i = 0; i < step->parameter_count; i++) {
        hewn_text_append(text, ",");
        write_number(listing, step->parameter + i, text);
    }
    if (guard) {
        hewn_text_append(text, "),");
        write_operands(listing, step, flavour, true, text);
    }
    hewn_text_append(text, ");\n");
}

static bool has_x(const hewn_code_step *step)
{
    return (step->axes & HEWN_AXIS_X) != 0;
}

static bool has_no_x(const hewn_code_step *step)
{
    return (step->axes & HEWN_AXIS_X) == 0;
}

enum { GROUP = 32 };

static void declare_steps(const hewn_listing *listing, hewn_listing_flavour flavour, hewn_step_filter wanted,
                          const char *suffix, hewn_text *text)
{
    uint32_t written = 0;
    for (size_t i = 0; i < listing->count; i++) {
        const hewn_code_step *step = &listing->steps[i];
        if (!step->function || (wanted && !wanted(step)))
            continue;
        hewn_text_print(text, "%s n%zu%s", written++ % GROUP == 0 ? types[flavour] : ",", i, suffix);
        if (written % GROUP == 0)
            hewn_text_append(text, ";\n");
    }
    hewn_text_append(text, written % GROUP == 0 ? "" : ";\n");
}

/* In groups: Mesa inlines a call by moving all that follows it in its block, so thousands of calls in one block take
 * minutes. The condition that keeps the groups apart until then is a specialization constant, true, which no front end
 * folds and every driver does. */
static void compute_steps(const hewn_listing *listing, hewn_listing_flavour flavour, hewn_step_filter wanted,
                          hewn_text *text)
{
    uint32_t written = 0;
    for (size_t i = 0; i < listing->count; i++) {
        const hewn_code_step *step = &listing->steps[i];
        if (!step->function || (wanted && !wanted(step)))
            continue;
        if (written++ % GROUP == 0)
            hewn_text_append(text, written > 1 ? "}\nif(f_always){\n" : "if(f_always){\n");
        write_step(listing, (uint32_t)i, flavour, text);
    }
    hewn_text_append(text, written > 0 ? "}\n" : "");
}

void hewn_listing_write_steps(const hewn_listing *listing, hewn_listing_flavour flavour, hewn_step_filter wanted,
                              hewn_text *text)
{
    declare_steps(listing, flavour, wanted, "", text);
    compute_steps(listing, flavour, wanted, text);
}

void hewn_listing_write_root(const hewn_listing *listing, hewn_listing_flavour flavour, hewn_text *text)
{
    write_operand(listing, (uint32_t)(listing->count - 1), flavour, false, text);
}

static void write_function(const hewn_listing *listing, hewn_listing_flavour flavour, const char *opening,
                           hewn_text *text)
{
    hewn_text_append(text, opening);
    hewn_listing_write_steps(listing, flavour, NULL, text);
    hewn_text_append(text, flavour == HEWN_LISTING_INTERVAL ? "return f_result(" : "return ");
    hewn_listing_write_root(listing, flavour, text);
    hewn_text_append(text, flavour == HEWN_LISTING_INTERVAL ? ",x,y,z);\n}\n" : ";\n}\n");
}

/* What does not depend on x comes before the loop over the row's samples. */
static void write_row(const hewn_listing *listing, hewn_text *text)
{
    hewn_text_append(text, "uint field_row_inside(uint i, float y, float z)\n{\n");
    hewn_listing_write_steps(listing, HEWN_LISTING_POINT, has_no_x, text);
    hewn_text_append(text, "uint bits = 0u;\nfor (uint k = 0u; k < 8u; k++) {\nfloat x = sample_x(i + k);\n");
    hewn_listing_write_steps(listing, HEWN_LISTING_POINT, has_x, text);
    hewn_text_append(text, "bits |= uint(");
    hewn_listing_write_root(listing, HEWN_LISTING_POINT, text);
    hewn_text_append(text, " < 0.0) << k;\n}\nreturn bits;\n}\n");
}

/* --- words of four rows ------------------------------------------------------------------------------------------- */

static bool has_x_alone(const hewn_code_step *step)
{
    return (step->axes & (HEWN_AXIS_X | HEWN_AXIS_Y)) == HEWN_AXIS_X;
}

static bool has_y_alone(const hewn_code_step *step)
{
    return (step->axes & (HEWN_AXIS_X | HEWN_AXIS_Y)) == HEWN_AXIS_Y;
}

static bool has_both(const hewn_code_step *step)
{
    return (step->axes & HEWN_AXIS_X) && (step->axes & HEWN_AXIS_Y);
}

static bool has_neither(const hewn_code_step *step)
{
    return !(step->axes & (HEWN_AXIS_X | HEWN_AXIS_Y));
}

/* Side by side, four rows share what does not depend on y, and need the code of what does four times. */
static bool rows_share(const hewn_listing *listing)
{
    enum { MOST_CODE = 400 };
    uint64_t shared = 0, own = 0, code = 0;
    for (size_t i = 0; i < listing->count; i++) {
        const hewn_code_step *step = &listing->steps[i];
        uint32_t weight = hewn_listing_weight(step);
        shared += has_x_alone(step) ? weight : 0;
        own += has_both(step) ? weight : 0;
        code += step->axes & HEWN_AXIS_Y ? weight : 0;
    }
    return shared >= own && code <= MOST_CODE;
}

/* Four rows, the places along which are walked once. */
static void write_rows_together(const hewn_listing *listing, hewn_text *text)
{
    hewn_listing view = *listing;
    hewn_text_append(text, "uint field_word_inside(uint i, vec4 y, float z)\n{\nuint bits = 0u;\n");
    hewn_listing_write_steps(&view, HEWN_LISTING_POINT, has_neither, text);
    declare_steps(&view, HEWN_LISTING_POINT, has_y_alone, "[4]", text);
    for (view.row = 1; view.row <= 4; view.row++)
        compute_steps(&view, HEWN_LISTING_POINT, has_y_alone, text);
    view.row = 0;
    hewn_text_append(text, "for (uint k = 0u; k < 8u; k++) {\nfloat x = sample_x(i + k);\n");
    hewn_listing_write_steps(&view, HEWN_LISTING_POINT, has_x_alone, text);
    for (view.row = 1; view.row <= 4; view.row++) {
        hewn_text_append(text, "{\n");
        hewn_listing_write_steps(&view, HEWN_LISTING_POINT, has_both, text);
        hewn_text_append(text, "bits |= uint(");
        hewn_listing_write_root(&view, HEWN_LISTING_POINT, text);
        hewn_text_print(text, " < 0.0) << (k + %uu);\n}\n", 8 * (view.row - 1));
    }
    hewn_text_append(text, "}\nreturn bits;\n}\n");
}

/* Four rows one after the other. */
static void write_rows_in_turn(hewn_text *text)
{
    hewn_text_append(text, "uint field_word_inside(uint i, vec4 y, float z)\n{\nuint bits = 0u;\n"
                           "for (uint k = 0u; k < 4u; k++)\n"
                           "bits |= field_row_inside(i, k == 0u ? y.x : k == 1u ? y.y : k == 2u ? y.z : y.w, z) << "
                           "8u * k;\nreturn bits;\n}\n");
}

void hewn_listing_write(const hewn_listing *listing, uint32_t flavours, hewn_text *text)
{
    hewn_listing view = *listing;
    view.near = (flavours & HEWN_FLAVOUR_NEAR) != 0;
    bool along = (flavours & HEWN_FLAVOUR_ALONG) != 0;
    if ((flavours & HEWN_FLAVOUR_POINT) || (along && !view.parted))
        write_function(&view, HEWN_LISTING_POINT, "float field_point(float x, float y, float z)\n{\n", text);
    if (flavours & HEWN_FLAVOUR_INTERVAL)
        write_function(&view, HEWN_LISTING_INTERVAL, "vec2 field_interval(vec2 x, vec2 y, vec2 z)\n{\n", text);
    if ((flavours & HEWN_FLAVOUR_GRADIENT) || (along && !view.parted))
        write_function(&view, HEWN_LISTING_GRADIENT,
                       "vec4 field_gradient(float at_x, float at_y, float at_z)\n{\n"
                       "vec4 x=vec4(1.0,0.0,0.0,at_x),y=vec4(0.0,1.0,0.0,at_y),z=vec4(0.0,0.0,1.0,at_z);\n",
                       text);
    if (along)
        hewn_listing_write_along(&view, text);
    bool word = (flavours & HEWN_FLAVOUR_WORD) != 0, together = word && rows_share(listing);
    if ((flavours & HEWN_FLAVOUR_ROW) || (word && !together))
        write_row(&view, text);
    if (together)
        write_rows_together(&view, text);
    else if (word)
        write_rows_in_turn(text);
}
