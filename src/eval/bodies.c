#include "eval/bodies.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"

static bool is_prunable(const hewn_code_step *step)
{
    return step->op == HEWN_OP_MIN || step->op == HEWN_OP_MAX ||
           (step->op >= HEWN_OP_BLEND_QUADRATIC && step->op <= HEWN_OP_BLEND_EXPONENTIAL);
}

/* --- gathering --------------------------------------------------------------------------------------------------- */

bool hewn_body_absorbable(const hewn_listing *listing, const hewn_gathering *gathered, uint32_t step)
{
    enum { CHEAP = 3 };
    const hewn_gathering *own = &gathered[step];
    if (!listing->steps[step].function)
        return true;
    return !own->prunable && (own->uses == 1 || (own->input_count == 0 && own->step_count <= CHEAP));
}

static void add_input(uint32_t inputs[], uint32_t *count, uint32_t step)
{
    for (uint32_t i = 0; i < *count; i++)
        if (inputs[i] == step)
            return;
    inputs[(*count)++] = step;
}

/* The step as a body with these operands absorbed; false where that is too much. */
static bool gather_with(const hewn_listing *listing, hewn_gathering *gathered, uint32_t at, uint8_t absorbed)
{
    const hewn_code_step *step = &listing->steps[at];
    uint32_t inputs[HEWN_BODY_INPUTS * HEWN_MAX_OPERANDS], input_count = 0, steps = 1, numbers = step->parameter_count;
    for (uint32_t k = 0; k < step->in_count; k++) {
        uint32_t operand = step->in[k];
        const hewn_gathering *part = &gathered[operand];
        if ((absorbed >> k & 1) == 0) {
            add_input(inputs, &input_count, operand);
            continue;
        }
        for (uint32_t i = 0; i < part->input_count; i++)
            add_input(inputs, &input_count, part->inputs[i]);
        steps += part->step_count;
        numbers += part->number_count;
    }
    if (input_count > HEWN_BODY_INPUTS || steps > HEWN_BODY_STEPS || numbers > HEWN_BODY_NUMBERS - HEWN_SLOPE_NUMBERS)
        return false;
    hewn_gathering *own = &gathered[at];
    for (uint32_t i = 0; i < input_count; i++)
        own->inputs[i] = inputs[i];
    own->input_count = (uint8_t)input_count;
    own->step_count = (uint8_t)steps;
    own->number_count = (uint8_t)numbers;
    own->absorbed = absorbed;
    return true;
}

static void gather_step(const hewn_listing *listing, hewn_gathering *gathered, uint32_t at)
{
    const hewn_code_step *step = &listing->steps[at];
    hewn_gathering *own = &gathered[at];
    own->prunable = is_prunable(step);
    own->owns = own->prunable;
    if (!step->function) {
        own->number_count = step->op == HEWN_OP_CONSTANT;
        return;
    }
    if (own->prunable)
        return;
    uint8_t absorbed = 0; /* variables and numbers are never read from slots */
    for (uint32_t k = 0; k < step->in_count; k++)
        absorbed |= (uint8_t)(!listing->steps[step->in[k]].function ? 1u << k : 0);
    gather_with(listing, gathered, at, absorbed);
    for (uint32_t k = 0; k < step->in_count; k++)
        if ((absorbed >> k & 1) == 0 && hewn_body_absorbable(listing, gathered, step->in[k]) &&
            gather_with(listing, gathered, at, (uint8_t)(absorbed | 1u << k)))
            absorbed |= (uint8_t)(1u << k);
}

hewn_result hewn_bodies_gather(const hewn_listing *listing, hewn_gathering **out, hewn_error *error)
{
    hewn_gathering *gathered = hewn_alloc_zero(listing->count, sizeof *gathered);
    if (!gathered)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %zu instructions", listing->count);
    for (size_t i = 0; i < listing->count; i++)
        for (uint32_t k = 0; k < listing->steps[i].in_count; k++)
            gathered[listing->steps[i].in[k]].uses++;
    gathered[listing->count - 1].uses++;
    for (size_t i = 0; i < listing->count; i++)
        gather_step(listing, gathered, (uint32_t)i);
    *out = gathered;
    return HEWN_OK;
}

/* --- text -------------------------------------------------------------------------------------------------------- */

typedef struct body_writer {
    const hewn_listing *listing;
    const hewn_gathering *gathered;
    const hewn_gathering *body;
    hewn_text *texts;
    float *numbers;
    uint32_t number_count, written;
    bool centred;
    const hewn_code_step *rooted; /* the last step, where as a point it is left under its root */
} body_writer;

/* Points, intervals, gradients, and what is written beside intervals: the point in the middle of the box. */
enum { POINT, INTERVAL, GRADIENT, MIDDLE, FORMS };

/* How a value is called in each, and whether it may be handed over bare. */
typedef struct value_name {
    char whole[FORMS][24];
    char bare[8];
    bool number;
} value_name;

static const char *const body_types[FORMS] = {"float", "vec2", "vec4", "float"};

static value_name name_number(body_writer *writer, uint32_t parameter)
{
    value_name name = {.number = true};
    writer->numbers[writer->number_count] = writer->listing->parameters[parameter];
    snprintf(name.bare, sizeof name.bare, "q%u", writer->number_count++);
    snprintf(name.whole[0], sizeof name.whole[0], "%s", name.bare);
    snprintf(name.whole[1], sizeof name.whole[1], "f_number(%s)", name.bare);
    snprintf(name.whole[2], sizeof name.whole[2], "vec4(vec3(0.0),%s)", name.bare);
    snprintf(name.whole[3], sizeof name.whole[3], "%s", name.bare);
    return name;
}

static value_name name_all(const char *prefix, uint32_t number)
{
    value_name name = {0};
    for (int i = 0; i < FORMS; i++)
        if (number == HEWN_NO_STEP)
            snprintf(name.whole[i], sizeof name.whole[i], "%s%s", i == MIDDLE ? "middle." : "", prefix);
        else
            snprintf(name.whole[i], sizeof name.whole[i], "%s%u", i == MIDDLE ? "m" : prefix, number);
    return name;
}

static value_name write_value(body_writer *writer, uint32_t at);

static value_name write_operand(body_writer *writer, const hewn_gathering *own, const hewn_code_step *step, uint32_t k)
{
    static const char *const slots[HEWN_BODY_INPUTS] = {"b", "c", "d"};
    uint32_t operand = step->in[k];
    if (own->absorbed >> k & 1)
        return write_value(writer, operand);
    uint32_t slot = 0;
    while (slot + 1 < HEWN_BODY_INPUTS && writer->body->inputs[slot] != operand)
        slot++;
    return name_all(slots[slot], HEWN_NO_STEP);
}

static void write_call(const body_writer *writer, const hewn_code_step *step, const value_name *operands,
                       uint32_t first_number, uint32_t made, int flavour)
{
    hewn_text *text = &writer->texts[flavour == MIDDLE ? INTERVAL : flavour];
    bool guard = flavour == INTERVAL && hewn_listing_needs_guard(writer->listing, step);
    bool rooted = flavour == POINT && step == writer->rooted;
    hewn_text_print(text, "%s %s%u=%sf_%s%s(", rooted ? "f_radicand" : body_types[flavour],
                    flavour == MIDDLE ? "m" : "n", made, guard ? "f_guard(" : "", step->function,
                    rooted ? "_radicand" : "");
    for (uint32_t k = 0; k < step->in_count; k++)
        hewn_text_print(text, "%s%s", k ? "," : "",
                        hewn_listing_is_plain(writer->listing, step, k) ? operands[k].bare
                                                                        : operands[k].whole[flavour]);
    for (uint32_t i = 0; i < step->parameter_count; i++)
        hewn_text_print(text, ",q%u", first_number + i);
    if (guard) {
        hewn_text_append(text, ")");
        for (uint32_t k = 0; k < step->in_count; k++)
            hewn_text_print(text, ",%s", operands[k].whole[flavour]);
    }
    hewn_text_append(text, ");\n");
}

static value_name write_value(body_writer *writer, uint32_t at)
{
    const hewn_code_step *step = &writer->listing->steps[at];
    if (step->op <= HEWN_OP_Z) {
        const char name[2] = {"xyz"[step->op - HEWN_OP_X], 0};
        return name_all(name, HEWN_NO_STEP);
    }
    if (step->op == HEWN_OP_CONSTANT)
        return name_number(writer, step->parameter);
    value_name operands[HEWN_MAX_OPERANDS] = {0};
    for (uint32_t k = 0; k < step->in_count; k++)
        operands[k] = write_operand(writer, &writer->gathered[at], step, k);
    uint32_t first = writer->number_count, made = writer->written++;
    for (uint32_t i = 0; i < step->parameter_count; i++)
        writer->numbers[writer->number_count++] = writer->listing->parameters[step->parameter + i];
    for (int flavour = 0; flavour < FORMS; flavour++)
        if (flavour != (writer->centred ? INTERVAL : MIDDLE))
            write_call(writer, step, operands, first, made, flavour);
    return name_all("n", made);
}

/* The row (factors of x, y, z, then what is added) of an operand that is affine in the variables. */
static bool frame_row(const hewn_listing *listing, const hewn_code_step *step, double row[4])
{
    row[0] = row[1] = row[2] = row[3] = 0;
    const float *p = listing->parameters + step->parameter;
    if (step->op <= HEWN_OP_Z) {
        row[step->op - HEWN_OP_X] = 1;
        return true;
    }
    if (step->op == HEWN_OP_CONSTANT) {
        row[3] = (double)p[0];
        return true;
    }
    if (step->op != HEWN_OP_AFFINE && step->op != HEWN_OP_PLANE)
        return false;
    bool shift = step->parameter_count == 1;
    for (uint32_t i = 0; i < step->in_count; i++) {
        const hewn_code_step *in = &listing->steps[step->in[i]];
        if (in->op > HEWN_OP_Z)
            return false;
        row[in->op - HEWN_OP_X] += shift ? 1 : (double)p[i];
    }
    row[3] = (double)p[step->parameter_count - 1];
    return true;
}

/* Something not below the largest singular value of three rows: the fourth root of the trace of (A A')^2 is, and for a
 * turned frame with one scale it would be that times the fourth root of 3; so squares of A A' are taken until the trace
 * tells the greatest eigenvalue to a millionth. */
static double steepness(double rows[3][4])
{
    double m[3][3], log_scale = 0, power = 1;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            m[i][k] = rows[i][0] * rows[k][0] + rows[i][1] * rows[k][1] + rows[i][2] * rows[k][2];
    for (int round = 0; round < 22; round++) {
        double trace = m[0][0] + m[1][1] + m[2][2], square[3][3];
        if (!(trace > 0))
            return 0;
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++)
                square[i][k] = (m[i][0] * m[0][k] + m[i][1] * m[1][k] + m[i][2] * m[2][k]) / (trace * trace);
        memcpy(m, square, sizeof m);
        log_scale += log(trace) / power;
        power *= 2;
    }
    log_scale += log(m[0][0] + m[1][1] + m[2][2]) / power;
    return exp(0.5 * log_scale) * (1 + 1e-6);
}

/* Of a shape in a turned frame how steep it is at most, and what its rounding errors grow with: the sum of all factors,
 * by which coordinates come in, and the sum of everything else. False for others. */
static bool slope_numbers(const hewn_listing *listing, const hewn_code_step *step, float numbers[HEWN_SLOPE_NUMBERS])
{
    double rows[3][4], factors = 0, rest = 0;
    bool turned = false;
    if (step->op < HEWN_OP_SPHERE || step->op > HEWN_OP_CONE || !step->sure)
        return false;
    for (int i = 0; i < 3; i++)
        if (!frame_row(listing, &listing->steps[step->in[i]], rows[i]))
            return false;
    for (int i = 0; i < 3; i++) {
        turned = turned || (rows[i][0] != 0) + (rows[i][1] != 0) + (rows[i][2] != 0) > 1;
        for (int k = 0; k < 3; k++)
            factors += fabs(rows[i][k]);
        rest += fabs(rows[i][3]);
    }
    for (uint32_t i = 0; i < step->parameter_count; i++)
        rest += fabs((double)listing->parameters[step->parameter + i]);
    numbers[0] = (float)(steepness(rows) * (1 + 1e-6));
    numbers[1] = (float)(factors * (1 + 1e-6));
    numbers[2] = (float)(rest * (1 + 1e-6));
    return turned && numbers[0] < 1e15f && numbers[1] < 1e15f && numbers[2] < 1e15f;
}

/* Shapes whose distance ends with a root and one addition: the library has them without these, too. */
static bool ends_with_root(hewn_op op)
{
    return op == HEWN_OP_SPHERE || op == HEWN_OP_BOX || op == HEWN_OP_TORUS || op == HEWN_OP_CYLINDER ||
           op == HEWN_OP_CAPSULE;
}

uint32_t hewn_body_weight(const hewn_listing *listing, const hewn_gathering *gathered, uint32_t step)
{
    const hewn_code_step *own = &listing->steps[step];
    uint32_t weight = hewn_listing_weight(own);
    for (uint32_t k = 0; k < own->in_count; k++)
        if (gathered[step].absorbed >> k & 1)
            weight += hewn_body_weight(listing, gathered, own->in[k]);
    return weight;
}

void hewn_body_write(const hewn_listing *listing, const hewn_gathering *gathered, uint32_t step, hewn_text texts[3],
                     float numbers[HEWN_BODY_NUMBERS], uint32_t *number_count)
{
    float slope[HEWN_SLOPE_NUMBERS];
    bool centred = gathered[step].input_count == 0 && slope_numbers(listing, &listing->steps[step], slope);
    body_writer writer = {.listing = listing,
                          .gathered = gathered,
                          .body = &gathered[step],
                          .texts = texts,
                          .numbers = numbers,
                          .centred = centred,
                          .rooted = ends_with_root(listing->steps[step].op) ? &listing->steps[step] : NULL};
    if (centred)
        hewn_text_append(&texts[INTERVAL], "vec3 middle=f_middle(x,y,z);\n");
    value_name result = write_value(&writer, step);
    if (centred) {
        uint32_t first = writer.number_count;
        hewn_text_print(&texts[INTERVAL], "vec2 %s=f_about(%s,middle,x,y,z,q%u,q%u,q%u);\n", result.whole[INTERVAL],
                        result.whole[MIDDLE], first, first + 1, first + 2);
        for (uint32_t i = 0; i < HEWN_SLOPE_NUMBERS; i++)
            numbers[writer.number_count++] = slope[i];
    }
    for (int flavour = 0; flavour < 3; flavour++)
        hewn_text_print(&texts[flavour],
                        flavour == POINT && writer.rooted ? "return " HEWN_BODY_ROOT "%s);\n" : "return %s;\n",
                        result.whole[flavour]);
    *number_count = writer.number_count;
}
