#include "eval/bodies.h"

#include <stdio.h>

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
    if (input_count > HEWN_BODY_INPUTS || steps > HEWN_BODY_STEPS || numbers > HEWN_BODY_NUMBERS)
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
    uint32_t *numbers;
    uint32_t number_count, written;
} body_writer;

/* How a value is called: in points, in intervals, in gradients, and whether it may be handed over bare. */
typedef struct value_name {
    char whole[3][24];
    char bare[8];
    bool number;
} value_name;

static const char *const body_types[3] = {"float", "vec2", "vec4"};

static value_name name_number(body_writer *writer, uint32_t parameter)
{
    value_name name = {.number = true};
    writer->numbers[writer->number_count] = parameter;
    snprintf(name.bare, sizeof name.bare, "q%u", writer->number_count++);
    snprintf(name.whole[0], sizeof name.whole[0], "%s", name.bare);
    snprintf(name.whole[1], sizeof name.whole[1], "f_number(%s)", name.bare);
    snprintf(name.whole[2], sizeof name.whole[2], "vec4(vec3(0.0),%s)", name.bare);
    return name;
}

static value_name name_all(const char *prefix, uint32_t number)
{
    value_name name = {0};
    for (int i = 0; i < 3; i++)
        snprintf(name.whole[i], sizeof name.whole[i], number == HEWN_NO_STEP ? "%s" : "%s%u", prefix, number);
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
    while (writer->body->inputs[slot] != operand)
        slot++;
    return name_all(slots[slot], HEWN_NO_STEP);
}

static void write_call(const body_writer *writer, const hewn_code_step *step, const value_name *operands,
                       uint32_t first_number, uint32_t made, int flavour)
{
    hewn_text *text = &writer->texts[flavour];
    bool guard = flavour == 1 && hewn_listing_needs_guard(writer->listing, step);
    hewn_text_print(text, "%s n%u=%sf_%s(", body_types[flavour], made, guard ? "f_guard(" : "", step->function);
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
        writer->numbers[writer->number_count++] = step->parameter + i;
    for (int flavour = 0; flavour < 3; flavour++)
        write_call(writer, step, operands, first, made, flavour);
    return name_all("n", made);
}

void hewn_body_write(const hewn_listing *listing, const hewn_gathering *gathered, uint32_t step, hewn_text texts[3],
                     uint32_t numbers[HEWN_BODY_NUMBERS], uint32_t *number_count)
{
    body_writer writer = {.listing = listing,
                          .gathered = gathered,
                          .body = &gathered[step],
                          .texts = texts,
                          .numbers = numbers};
    value_name result = write_value(&writer, step);
    for (int flavour = 0; flavour < 3; flavour++)
        hewn_text_print(&texts[flavour], "return %s;\n", result.whole[flavour]);
    *number_count = writer.number_count;
}
