#include "eval/instructions.h"

#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "eval/bodies.h"

#define NO_ITEM 0xFFFFFFFFu

/* An instruction before it has slots: its operands are other items. */
typedef struct item {
    uint32_t body;    /* the last step of the body, or HEWN_NO_STEP: a copy of operand 1 */
    uint32_t combine; /* the step that combines, or HEWN_NO_STEP */
    bool swapped;
    uint32_t in[1 + HEWN_BODY_INPUTS]; /* a, b, c, d */
    uint32_t need;                     /* slots that computing it takes */
    uint32_t slot;
} item;

typedef struct assembly {
    const hewn_listing *listing;
    hewn_gathering *gathered;
    item *items;
    uint32_t item_count;
    uint32_t *item_of; /* a step */
    uint32_t *order;   /* items, operands first */
} assembly;

/* --- items ------------------------------------------------------------------------------------------------------- */

/* Which operand of a combination becomes its body (2: neither, a copy does). */
static uint32_t body_operand(const assembly *parts, const hewn_code_step *step)
{
    if (hewn_body_absorbable(parts->listing, parts->gathered, step->in[1]))
        return 1;
    return hewn_body_absorbable(parts->listing, parts->gathered, step->in[0]) ? 0 : 2;
}

static void own(assembly *parts, uint32_t step)
{
    hewn_gathering *gathered = &parts->gathered[step];
    if (!hewn_body_absorbable(parts->listing, parts->gathered, step)) {
        gathered->owns = true;
        return;
    }
    for (uint32_t i = 0; i < gathered->input_count; i++)
        parts->gathered[gathered->inputs[i]].owns = true;
}

static void find_owners(assembly *parts)
{
    uint32_t count = (uint32_t)parts->listing->count;
    for (uint32_t i = 0; i < count; i++)
        parts->gathered[i].owns = i + 1 == count;
    for (uint32_t i = count; i-- > 0;) {
        const hewn_gathering *gathered = &parts->gathered[i];
        if (!gathered->owns)
            continue;
        for (uint32_t k = 0; gathered->prunable && k < 2; k++)
            own(parts, parts->listing->steps[i].in[k]);
        for (uint32_t k = 0; k < gathered->input_count; k++)
            parts->gathered[gathered->inputs[k]].owns = true;
    }
}

static uint32_t add_item(assembly *parts, uint32_t body, uint32_t combine)
{
    item *made = &parts->items[parts->item_count];
    *made = (item){.body = body, .combine = combine, .in = {NO_ITEM, NO_ITEM, NO_ITEM, NO_ITEM}};
    if (body != HEWN_NO_STEP)
        for (uint32_t i = 0; i < parts->gathered[body].input_count; i++)
            made->in[1 + i] = parts->item_of[parts->gathered[body].inputs[i]];
    return parts->item_count++;
}

/* The item of a step whose value a slot must hold. */
static uint32_t slot_item(assembly *parts, uint32_t step)
{
    return parts->gathered[step].owns ? parts->item_of[step] : add_item(parts, step, HEWN_NO_STEP);
}

static void make_item(assembly *parts, uint32_t at)
{
    const hewn_code_step *step = &parts->listing->steps[at];
    if (!parts->gathered[at].prunable) {
        parts->item_of[at] = add_item(parts, at, HEWN_NO_STEP);
        return;
    }
    uint32_t which = body_operand(parts, step);
    uint32_t a = slot_item(parts, step->in[which == 0 ? 1 : 0]);
    uint32_t b = which == 2 ? slot_item(parts, step->in[1]) : NO_ITEM;
    uint32_t made = add_item(parts, which == 2 ? HEWN_NO_STEP : step->in[which], at);
    parts->items[made].swapped = which == 0;
    parts->items[made].in[0] = a;
    if (which == 2)
        parts->items[made].in[1] = b;
    parts->item_of[at] = made;
}

/* --- order ------------------------------------------------------------------------------------------------------- */

/* Operands, the one that needs most slots first (Sethi and Ullman 1970; for trees that is the least there is). */
static uint32_t operands_by_need(const assembly *parts, const item *one, uint32_t sorted[4])
{
    uint32_t count = 0;
    for (uint32_t k = 0; k < 4; k++) {
        if (one->in[k] == NO_ITEM)
            continue;
        uint32_t place = count++;
        for (; place > 0 && parts->items[sorted[place - 1]].need < parts->items[one->in[k]].need; place--)
            sorted[place] = sorted[place - 1];
        sorted[place] = one->in[k];
    }
    return count;
}

static void find_needs(assembly *parts)
{
    for (uint32_t i = 0; i < parts->item_count; i++) {
        uint32_t sorted[4], count = operands_by_need(parts, &parts->items[i], sorted), need = 1;
        for (uint32_t k = 0; k < count; k++)
            need = parts->items[sorted[k]].need + k > need ? parts->items[sorted[k]].need + k : need;
        parts->items[i].need = need;
    }
}

/* Depth first without recursion: a chain may be as deep as it is long. Marks what is placed by slot 1. */
static hewn_result put_in_order(assembly *parts, uint32_t root, uint32_t *count, hewn_error *error)
{
    uint32_t *stack = hewn_alloc((size_t)parts->item_count * 4 + 1, sizeof *stack), depth = 0;
    if (!stack)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %u instructions", parts->item_count);
    *count = 0;
    stack[depth++] = root;
    while (depth > 0) {
        item *one = &parts->items[stack[depth - 1]];
        uint32_t sorted[4], operands = operands_by_need(parts, one, sorted), waiting = NO_ITEM;
        for (uint32_t k = operands; k-- > 0;)
            waiting = parts->items[sorted[k]].slot == 0 ? sorted[k] : waiting;
        if (waiting != NO_ITEM) {
            stack[depth++] = waiting;
            continue;
        }
        depth--;
        if (one->slot == 0)
            parts->order[(*count)++] = (uint32_t)(one - parts->items);
        one->slot = 1;
    }
    hewn_free(stack);
    return HEWN_OK;
}

/* Backwards: a value takes the lowest free slot at its last use and gives it back where it is made. Returns how many
 * slots that takes, at most one more than there may be. */
static uint32_t assign_slots(assembly *parts, uint32_t count)
{
    uint32_t used = 0, most = 0;
    for (uint32_t i = 0; i < count; i++)
        parts->items[parts->order[i]].slot = HEWN_NO_SLOT;
    parts->items[parts->order[count - 1]].slot = 0;
    used = 1;
    most = 1;
    for (uint32_t i = count; i-- > 0;) {
        const item *one = &parts->items[parts->order[i]];
        used &= ~(1u << one->slot);
        for (uint32_t k = 0; k < 4; k++) {
            if (one->in[k] == NO_ITEM || parts->items[one->in[k]].slot != HEWN_NO_SLOT)
                continue;
            uint32_t slot = 0;
            while (used >> slot & 1)
                slot++;
            if (slot >= HEWN_SLOTS_MAX)
                return HEWN_SLOTS_MAX + 1;
            used |= 1u << slot;
            most = slot + 1 > most ? slot + 1 : most;
            parts->items[one->in[k]].slot = slot;
        }
    }
    return most;
}

/* --- kinds ------------------------------------------------------------------------------------------------------- */

static void clear_body(hewn_body *body)
{
    for (int i = 0; i < 3; i++)
        hewn_text_clear(&body->texts[i]);
}

static bool same_body(const hewn_body *a, const hewn_body *b)
{
    for (int i = 0; i < 3; i++)
        if (a->texts[i].failed || b->texts[i].failed || strcmp(a->texts[i].bytes, b->texts[i].bytes) != 0)
            return false;
    return true;
}

/* The kind of the body (which is taken over or cleared), added where there is room; HEWN_BODIES_MAX where not. */
static uint32_t find_body(hewn_instruction_set *set, hewn_body *body, bool may_add)
{
    uint32_t i = 0;
    while (i < set->body_count && !same_body(&set->bodies[i], body))
        i++;
    if (i == set->body_count && may_add && i < HEWN_BODIES_MAX) {
        set->bodies[set->body_count++] = *body;
        return i;
    }
    clear_body(body);
    return i < set->body_count ? i : HEWN_BODIES_MAX;
}

static uint32_t find_combination(hewn_instruction_set *set, const hewn_combination *wanted, bool may_add)
{
    uint32_t i = 0;
    for (; i < set->combination_count; i++) {
        const hewn_combination *one = &set->combinations[i];
        if (one->op == wanted->op && one->swapped == wanted->swapped && one->guarded == wanted->guarded)
            return i;
    }
    if (!may_add || i == HEWN_COMBINATIONS_MAX)
        return HEWN_COMBINATIONS_MAX;
    set->combinations[set->combination_count++] = *wanted;
    return i;
}

static hewn_result start_set(hewn_instruction_set *set, const hewn_instruction_set *known, hewn_error *error)
{
    uint32_t count = known ? known->body_count : 1;
    for (uint32_t i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++)
            hewn_text_append(&set->bodies[i].texts[k], known ? known->bodies[i].texts[k].bytes : "return b;\n");
        set->bodies[i].numbers = known ? known->bodies[i].numbers : 0;
        set->bodies[i].inputs = known ? known->bodies[i].inputs : 1;
        set->bodies[i].weight = known ? known->bodies[i].weight : 0;
        set->body_count++;
    }
    if (known) {
        memcpy(set->combinations, known->combinations, sizeof set->combinations);
        set->combination_count = known->combination_count;
        set->blends = known->blends;
        set->words = known->words;
        set->slots = known->slots;
    }
    for (uint32_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++)
            HEWN_TRY(hewn_text_status(&set->bodies[i].texts[k], error));
    return HEWN_OK;
}

/* --- words ------------------------------------------------------------------------------------------------------- */

/* Room for the longest instruction; they are brought to the set's length once that is known. */
enum { WORDS_MOST = (2 + HEWN_BODY_NUMBERS + HEWN_TOGETHER_MOST - 1) / HEWN_TOGETHER_MOST * HEWN_TOGETHER_MOST };

static uint32_t float_bits(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static hewn_result write_one(const assembly *parts, const item *one, hewn_instruction_set *set, bool may_add,
                             uint32_t *head, uint32_t words[WORDS_MOST], bool *fits, hewn_error *error)
{
    hewn_body body = {0};
    float numbers[HEWN_BODY_NUMBERS];
    uint32_t which = 0, combine = 0;
    if (one->body != HEWN_NO_STEP) {
        hewn_body_write(parts->listing, parts->gathered, one->body, body.texts, numbers, &body.numbers);
        hewn_result result = HEWN_OK;
        for (int i = 0; result == HEWN_OK && i < 3; i++)
            result = hewn_text_status(&body.texts[i], error);
        if (result != HEWN_OK) {
            clear_body(&body);
            return result;
        }
        uint32_t count = body.numbers;
        body.weight = hewn_body_weight(parts->listing, parts->gathered, one->body);
        body.inputs = parts->gathered[one->body].input_count;
        which = find_body(set, &body, may_add);
        for (uint32_t i = 0; i < count; i++)
            words[2 + i] = float_bits(numbers[i]);
    }
    if (one->combine != HEWN_NO_STEP) {
        const hewn_code_step *step = &parts->listing->steps[one->combine];
        const hewn_combination wanted = {step->op, step->function, one->swapped,
                                         hewn_listing_needs_guard(parts->listing, step), hewn_listing_weight(step)};
        combine = 1 + find_combination(set, &wanted, may_add);
        set->blends = set->blends || (may_add && step->parameter_count > 0);
        for (uint32_t i = 0; i < step->parameter_count; i++)
            words[i] = float_bits(parts->listing->parameters[step->parameter + i]);
    }
    *fits = *fits && which < HEWN_BODIES_MAX && combine <= HEWN_COMBINATIONS_MAX;
    *head = which | combine << 8 | one->slot << 12;
    for (uint32_t k = 0; k < 4; k++)
        *head |= (one->in[k] == NO_ITEM ? (uint32_t)HEWN_NO_SLOT : parts->items[one->in[k]].slot) << (16 + 4 * k);
    return HEWN_OK;
}

static uint32_t words_of(const hewn_instruction_set *set)
{
    uint32_t most = 0;
    for (uint32_t i = 0; i < set->body_count; i++)
        most = set->bodies[i].numbers > most ? set->bodies[i].numbers : most;
    uint32_t words = (set->blends ? 2 : 0) + (most > 0 ? most : 1);
    return (words + HEWN_TOGETHER_MOST - 1) / HEWN_TOGETHER_MOST * HEWN_TOGETHER_MOST;
}

static hewn_result write_words(hewn_instructions *out, const assembly *parts, const hewn_instruction_set *known,
                               bool *fits, hewn_error *error)
{
    uint32_t *wide = hewn_alloc_zero((size_t)out->count * WORDS_MOST, sizeof *wide);
    out->words = wide;
    out->entries = hewn_alloc((size_t)2 * out->count, sizeof *out->entries);
    if (!wide || !out->entries)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %u instructions", out->count);
    hewn_result result = HEWN_OK;
    for (uint32_t i = 0; result == HEWN_OK && *fits && i < out->count; i++) {
        const item *one = &parts->items[parts->order[i]];
        out->prunable += one->combine != HEWN_NO_STEP;
        uint32_t *entry = out->entries + (size_t)2 * i;
        entry[1] = i;
        result = write_one(parts, one, &out->set, !known, entry, wide + (size_t)i * WORDS_MOST, fits, error);
    }
    if (!known)
        out->set.words = words_of(&out->set);
    uint32_t first = out->set.blends ? 0 : 2;
    for (uint32_t i = 0; result == HEWN_OK && i < out->count; i++) /* towards the front, so in place */
        for (uint32_t k = 0; k < out->set.words; k++) {
            uint32_t from = k + first;
            wide[(size_t)i * out->set.words + k] = from < WORDS_MOST ? wide[(size_t)i * WORDS_MOST + from] : 0;
        }
    return result;
}

static hewn_result assemble(hewn_instructions *out, assembly *parts, const hewn_instruction_set *known, bool *fits,
                            hewn_error *error)
{
    uint32_t steps = (uint32_t)parts->listing->count;
    find_owners(parts);
    for (uint32_t i = 0; i < steps; i++)
        if (parts->gathered[i].owns)
            make_item(parts, i);
    find_needs(parts);
    HEWN_TRY(put_in_order(parts, parts->item_of[steps - 1], &out->count, error));
    uint32_t slots = assign_slots(parts, out->count);
    *fits = slots <= (known ? known->slots : (uint32_t)HEWN_SLOTS_MAX) && out->count <= HEWN_INSTRUCTIONS_MAX;
    if (!*fits)
        return HEWN_OK;
    HEWN_TRY(start_set(&out->set, known, error));
    if (!known)
        out->set.slots = slots;
    return write_words(out, parts, known, fits, error);
}

hewn_result hewn_instructions_create(hewn_instructions *out, const hewn_listing *listing,
                                     const hewn_instruction_set *known, bool *fits, hewn_error *error)
{
    memset(out, 0, sizeof *out);
    *fits = false;
    assembly parts = {.listing = listing};
    HEWN_TRY(hewn_bodies_gather(listing, &parts.gathered, error));
    parts.items = hewn_alloc(2 * listing->count, sizeof *parts.items);
    parts.order = hewn_alloc(2 * listing->count, sizeof *parts.order);
    parts.item_of = hewn_alloc(listing->count, sizeof *parts.item_of);
    hewn_result result = parts.items && parts.order && parts.item_of
                             ? assemble(out, &parts, known, fits, error)
                             : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %zu steps", listing->count);
    hewn_free(parts.item_of);
    hewn_free(parts.order);
    hewn_free(parts.items);
    hewn_free(parts.gathered);
    if (result != HEWN_OK || !*fits)
        hewn_instructions_destroy(out);
    *fits = *fits && result == HEWN_OK;
    return result;
}

void hewn_instructions_destroy(hewn_instructions *instructions)
{
    for (uint32_t i = 0; i < instructions->set.body_count; i++)
        clear_body(&instructions->set.bodies[i]);
    hewn_free(instructions->entries);
    hewn_free(instructions->words);
    memset(instructions, 0, sizeof *instructions);
}
