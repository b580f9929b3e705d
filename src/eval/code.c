#include "eval/code.h"

#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "eval/internal.h"
#include "gpu/device.h"

extern const char hewn_text_keep[];

/* --- parameters -------------------------------------------------------------------------------------------------- */

/* Every device lets a workgroup share this much memory (Vulkan's least maxComputeSharedMemorySize). */
enum { TABLE_BYTES = 16384 };

/* Tables of more are slower to compile and to run than literals on lavapipe, and one of 5 KiB with the code of
 * Prospero crashes SwiftShader's compiler. */
enum { CHOSEN_TABLE_BYTES = 4096 };

/* Whole vectors, and at least one: a uniform block cannot be empty. */
static uint64_t parameter_bytes(const hewn_listing *listing)
{
    size_t vectors = (listing->parameter_count + 3) / 4;
    return (vectors > 0 ? vectors : 1) * 4 * sizeof(float);
}

/* Their addresses are among the numbers and differ from run to run: code that has them would be compiled each time. */
static bool has_addresses(const hewn_listing *listing)
{
    for (size_t i = 0; i < listing->count; i++)
        if (hewn_listing_has_address(&listing->steps[i]))
            return true;
    return false;
}

static hewn_number_place choose_place(const hewn_device *device, const hewn_listing *listing, hewn_numbers numbers)
{
    uint64_t bytes = parameter_bytes(listing);
    bool on_cpu = device->info.kind == HEWN_DEVICE_CPU;
    uint64_t most = numbers == HEWN_NUMBERS_AUTO ? CHOSEN_TABLE_BYTES : TABLE_BYTES;
    bool table = bytes <= most && bytes <= device->max_uniform_range;
    bool in_code = numbers == HEWN_NUMBERS_IN_CODE || (numbers == HEWN_NUMBERS_AUTO && on_cpu && !table);
    if (in_code && !has_addresses(listing))
        return HEWN_PLACE_CODE;
    if (on_cpu && table)
        return HEWN_PLACE_TABLE;
    return bytes <= device->max_uniform_range ? HEWN_PLACE_UNIFORM : HEWN_PLACE_ADDRESS;
}

/* Where the numbers themselves are on the device. */
static const hewn_buffer *number_buffer(const hewn_code *code)
{
    return code->place == HEWN_PLACE_ADDRESS ? &code->parameters : &code->uniforms;
}

static hewn_result create_filled(hewn_device *device, uint64_t bytes, const void *start, size_t length,
                                 hewn_buffer *out, hewn_error *error)
{
    HEWN_TRY(hewn_buffer_create(device, "parameters", bytes, HEWN_BUFFER_UPLOAD, out, error));
    memset(out->mapped, 0, bytes);
    memcpy(out->mapped, start, length);
    return HEWN_OK;
}

static size_t number_bytes(const hewn_instructions *instructions)
{
    return (size_t)instructions->count * instructions->set.words * sizeof(uint32_t);
}

static size_t entry_bytes(const hewn_instructions *instructions)
{
    return (size_t)instructions->count * HEWN_LIST_ENTRY;
}

/* Invocations that read an instruction together: as many as a subgroup of a CPU device has. GPUs have subgroups that
 * may not be full, and read what all want once anyway. */
static uint32_t invocations_together(const hewn_device *device)
{
    uint32_t size = device->subgroup_size;
    bool divides = size == 2 || size == 4 || size == HEWN_TOGETHER_MOST;
    return device->info.kind == HEWN_DEVICE_CPU && divides ? size : 0;
}

static hewn_result write_instructions(hewn_device *device, hewn_code *code, hewn_error *error)
{
    const hewn_instructions *list = &code->instructions;
    size_t numbers = number_bytes(list), entries = entry_bytes(list);
    code->walking = (hewn_walking){.masked = device->info.kind == HEWN_DEVICE_CPU,
                                   .whole = code->walking.whole,
                                   .together = invocations_together(device)};
    HEWN_TRY(
        create_filled(device, numbers + entries + HEWN_LIST_SLACK, list->words, numbers, &code->parameters, error));
    memcpy((char *)code->parameters.mapped + numbers, list->entries, entries);
    code->entries_at = numbers;
    const hewn_list_block block = {.numbers = code->parameters.address,
                                   .whole = code->parameters.address + code->entries_at,
                                   .whole_count = list->count};
    return create_filled(device, sizeof block, &block, sizeof block, &code->uniforms, error);
}

static hewn_result write_parameters(hewn_device *device, hewn_code *code, hewn_error *error)
{
    if (code->listed)
        return write_instructions(device, code, error);
    const hewn_listing *listing = &code->listing;
    size_t length = code->place == HEWN_PLACE_CODE ? 0 : listing->parameter_count * sizeof(float);
    uint64_t bytes = code->place == HEWN_PLACE_CODE ? 16 : parameter_bytes(listing);
    if (code->place != HEWN_PLACE_ADDRESS)
        return create_filled(device, bytes, listing->parameters, length, &code->uniforms, error);
    HEWN_TRY(create_filled(device, bytes, listing->parameters, length, &code->parameters, error));
    const uint64_t address = code->parameters.address;
    return create_filled(device, 16, &address, sizeof address, &code->uniforms, error);
}

static void write_uniform_block(unsigned vectors, hewn_text *text)
{
    hewn_text_print(text, "layout(set = 0, binding = 0) uniform hewn_parameter_block { vec4 hewn_parameters[%u]; };\n",
                    vectors);
}

/* Declares where parameters are and what P(i) is. Uniforms are read with addresses that all invocations share, which is
 * a plain load on CPUs, while reads through a buffer's address are gathered lane by lane there. */
static void write_parameter_block(const hewn_code *code, hewn_text *text)
{
    unsigned vectors = (unsigned)(code->uniforms.size / 16);
    switch (code->place) {
    case HEWN_PLACE_CODE: break;
    case HEWN_PLACE_TABLE:
        write_uniform_block(vectors, text);
        hewn_text_print(text, "shared vec4 hewn_table[%u];\nvec4 hewn_numbers[%u];\n", vectors, vectors);
        hewn_text_append(text, "#define P(i) hewn_numbers[(i) >> 2][(i) & 3]\n");
        break;
    case HEWN_PLACE_UNIFORM:
        write_uniform_block(vectors, text);
        hewn_text_append(text, "#define P(i) hewn_parameters[(i) >> 2][(i) & 3]\n");
        break;
    case HEWN_PLACE_ADDRESS:
        hewn_text_append(text, "layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer "
                               "hewn_parameter_list { float at[]; };\n"
                               "layout(set = 0, binding = 0) uniform hewn_parameter_block { hewn_parameter_list "
                               "hewn_parameters; };\n"
                               "#define P(i) hewn_parameters.at[i]\n");
        break;
    }
}

/* Mesa's llvmpipe compiles each read of a uniform, and of anything inside a condition or a loop, as a branch or as a
 * loop over its lanes; only reads of shared memory that stand before all of these become plain loads. So the uniforms
 * are brought into shared memory by one loop, and from there into variables, before the kernel's own main() begins. */
static void write_body(const hewn_code *code, const char *body, hewn_text *text)
{
    if (code->place != HEWN_PLACE_TABLE) {
        hewn_text_append(text, body);
        return;
    }
    unsigned vectors = (unsigned)(code->uniforms.size / 16);
    hewn_text_append(text, "#define main hewn_main\n");
    hewn_text_append(text, body);
    hewn_text_print(text,
                    "\n#undef main\nvoid main()\n{\n"
                    "for (uint i = gl_LocalInvocationIndex; i < %uu; i += gl_WorkGroupSize.x)\n"
                    "hewn_table[i] = hewn_parameters[i];\nbarrier();\n",
                    vectors);
    for (unsigned i = 0; i < vectors; i++)
        hewn_text_print(text, "hewn_numbers[%u] = hewn_table[%u];\n", i, i);
    hewn_text_append(text, "hewn_main();\n}\n");
}

/* --- life -------------------------------------------------------------------------------------------------------- */

static hewn_result choose_blocks(hewn_code *code, hewn_error *error)
{
    HEWN_TRY(hewn_library_read(&code->library, error));
    HEWN_TRY(hewn_library_choose(&code->library, "core", &code->choice, error));
    for (size_t i = 0; i < code->listing.count; i++)
        if (code->listing.steps[i].function)
            HEWN_TRY(hewn_library_choose(&code->library, code->listing.steps[i].function, &code->choice, error));
    return HEWN_OK;
}

/* Lists pay where all of the field costs about this many times what one instruction of a list does, which on CPU
 * devices is the sum of all its kinds and of reading it (docs/performance.md). */
enum { LISTED_FROM = 12, READING = 60, A_SLOT = 6 };

/* More edges of outlines than this are walked over whatever else there is: each is the same code with other numbers,
 * and written out one by one they take longer to compile than lists take to run. */
enum { LISTED_EDGES = 64 };

/* Drivers that bound loops give an invocation 65,535 iterations: one that solves sixteen vertices asks up to fourteen
 * values for each, so that this much of a value's tables is walked over to its end. With lists it is four times four
 * vertices, and most of the lists are short. */
enum { WAY_MOST = 280, LISTED_WAY_MOST = 560 };

static uint64_t longest_way(const hewn_listing *listing)
{
    uint64_t sum = 0;
    for (size_t i = 0; i < listing->table_count; i++)
        sum += listing->tables[i].longest;
    return sum;
}

static bool lists_pay(const hewn_code *code)
{
    const hewn_instruction_set *set = &code->instructions.set;
    uint64_t all = 0, one = READING + (uint64_t)A_SLOT * set->slots;
    size_t edges = 0;
    for (size_t i = 0; i < code->listing.count; i++) {
        all += hewn_listing_weight(&code->listing.steps[i]);
        edges += code->listing.steps[i].op == HEWN_OP_EDGE;
    }
    if (edges > LISTED_EDGES || longest_way(&code->listing) > WAY_MOST)
        return true;
    for (uint32_t i = 0; i < set->body_count; i++)
        one += set->bodies[i].weight;
    for (uint32_t i = 0; i < set->combination_count; i++)
        one += set->combinations[i].weight;
    return code->instructions.prunable * 3 >= code->instructions.count && all >= LISTED_FROM * one;
}

static hewn_result choose_evaluation(hewn_code *code, hewn_evaluation evaluation, hewn_error *error)
{
    if (evaluation == HEWN_EVALUATION_STRAIGHT)
        return HEWN_OK;
    HEWN_TRY(hewn_instructions_create(&code->instructions, &code->listing, NULL, &code->listed, error));
    if (code->listed && evaluation == HEWN_EVALUATION_AUTO && !lists_pay(code)) {
        hewn_instructions_destroy(&code->instructions);
        code->listed = false;
    }
    return HEWN_OK;
}

static hewn_result list_field(hewn_device *device, hewn_code *code, const hewn_field *field, hewn_node root,
                              const hewn_code_desc *desc, hewn_error *error)
{
    HEWN_TRY(hewn_listing_create(&code->listing, field, root, code->chained, error));
    code->place = choose_place(device, &code->listing, desc->numbers);
    code->listing.fixed = code->place == HEWN_PLACE_CODE;
    HEWN_TRY(choose_blocks(code, error));
    HEWN_TRY(hewn_samples_bring(device, &code->samples, &code->listing, error));
    return choose_evaluation(code, desc->evaluation, error);
}

/* With tables of outlines, unless walking over them would take too many turns. */
static hewn_result write_field(hewn_device *device, hewn_code *code, const hewn_field *field, hewn_node root,
                               const hewn_code_desc *desc, hewn_error *error)
{
    code->chained = desc->chained;
    HEWN_TRY(list_field(device, code, field, root, desc, error));
    if (longest_way(&code->listing) > (code->listed ? LISTED_WAY_MOST : WAY_MOST)) {
        hewn_instructions_destroy(&code->instructions);
        hewn_listing_destroy(&code->listing);
        code->choice = (hewn_library_choice){0};
        code->chained = true;
        HEWN_TRY(list_field(device, code, field, root, desc, error));
    }
    return write_parameters(device, code, error);
}

hewn_result hewn_code_create_as(hewn_device *device, const hewn_field *field, hewn_node root,
                                const hewn_code_desc *desc, hewn_code **out, hewn_error *error)
{
    *out = NULL;
    hewn_code *code = hewn_alloc_zero(1, sizeof *code);
    if (code)
        code->batches = hewn_alloc_zero(1, sizeof *code->batches);
    if (!code || !code->batches) {
        hewn_free(code);
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a field's code");
    }
    code->walking.whole = desc->whole;
    hewn_result result = write_field(device, code, field, root, desc, error);
    if (result != HEWN_OK)
        hewn_code_destroy(device, &code);
    *out = code;
    return result;
}

hewn_result hewn_code_create_with(hewn_device *device, const hewn_field *field, hewn_node root, hewn_numbers numbers,
                                  hewn_code **out, hewn_error *error)
{
    return hewn_code_create_as(device, field, root, &(hewn_code_desc){.numbers = numbers}, out, error);
}

hewn_result hewn_code_create(hewn_device *device, const hewn_field *field, hewn_node root, hewn_code **out,
                             hewn_error *error)
{
    return hewn_code_create_with(device, field, root, HEWN_NUMBERS_AUTO, out, error);
}

void hewn_code_destroy(hewn_device *device, hewn_code **code)
{
    if (!*code)
        return;
    hewn_batches_destroy(device, (*code)->batches);
    hewn_buffer_destroy(device, &(*code)->parameters);
    hewn_buffer_destroy(device, &(*code)->uniforms);
    hewn_instructions_destroy(&(*code)->instructions);
    hewn_listing_destroy(&(*code)->listing);
    hewn_samples_destroy(device, &(*code)->samples);
    hewn_free(*code);
    *code = NULL;
}

/* The texts tell best whether two fields make the same code: nothing else is compiled. */
static hewn_result same_text(const hewn_listing *a, const hewn_listing *b, bool *same, hewn_error *error)
{
    const uint32_t all = HEWN_FLAVOUR_POINT | HEWN_FLAVOUR_INTERVAL | HEWN_FLAVOUR_GRADIENT | HEWN_FLAVOUR_ROW |
                         HEWN_FLAVOUR_ALONG | HEWN_FLAVOUR_NEAR; /* which tells most: what is sure depends on numbers */
    hewn_text texts[2] = {{0}, {0}};
    hewn_listing_write(a, all, &texts[0]);
    hewn_listing_write(b, all, &texts[1]);
    hewn_result result = hewn_text_status(&texts[0], error);
    if (result == HEWN_OK)
        result = hewn_text_status(&texts[1], error);
    *same = result == HEWN_OK && strcmp(texts[0].bytes, texts[1].bytes) == 0;
    hewn_text_clear(&texts[0]);
    hewn_text_clear(&texts[1]);
    return result;
}

/* Any field of the same kinds will do, as long as its instructions fit where the old ones are. */
static hewn_result renumber_list(hewn_code *code, hewn_listing *listing, bool *taken, hewn_error *error)
{
    hewn_instructions made;
    hewn_result result = hewn_instructions_create(&made, listing, &code->instructions.set, taken, error);
    if (*taken && number_bytes(&made) > code->entries_at) {
        hewn_instructions_destroy(&made);
        *taken = false;
    }
    if (!*taken) {
        hewn_listing_destroy(listing);
        return result;
    }
    memcpy(code->parameters.mapped, made.words, number_bytes(&made));
    memcpy((char *)code->parameters.mapped + code->entries_at, made.entries, entry_bytes(&made));
    ((hewn_list_block *)code->uniforms.mapped)->whole_count = made.count;
    hewn_instructions_destroy(&code->instructions);
    hewn_listing_destroy(&code->listing);
    code->instructions = made;
    code->listing = *listing;
    return HEWN_OK;
}

hewn_result hewn_code_renumber(hewn_code *code, const hewn_field *field, hewn_node root, bool *taken, hewn_error *error)
{
    *taken = false;
    if (code->place == HEWN_PLACE_CODE && !code->listed)
        return HEWN_OK;
    hewn_listing listing;
    HEWN_TRY(hewn_listing_create(&listing, field, root, code->chained, error));
    if (!hewn_samples_find(&code->samples, &listing)) {
        hewn_listing_destroy(&listing);
        return HEWN_OK;
    }
    if (code->listed)
        return renumber_list(code, &listing, taken, error);
    bool same = false;
    hewn_result result = HEWN_OK;
    if (listing.parameter_count == code->listing.parameter_count)
        result = same_text(&code->listing, &listing, &same, error);
    if (same) {
        memcpy(number_buffer(code)->mapped, listing.parameters, listing.parameter_count * sizeof(float));
        hewn_listing_destroy(&code->listing);
        code->listing = listing;
        *taken = true;
    } else {
        hewn_listing_destroy(&listing);
    }
    return result;
}

const hewn_buffer *hewn_code_uniforms(const hewn_code *code)
{
    return &code->uniforms;
}

/* --- lists ------------------------------------------------------------------------------------------------------- */

bool hewn_code_is_listed(const hewn_code *code)
{
    return code->listed;
}

uint32_t hewn_code_instruction_count(const hewn_code *code)
{
    return code->instructions.count;
}

const uint32_t *hewn_code_whole_list(const hewn_code *code)
{
    return code->instructions.entries;
}

static uint64_t address_of(const hewn_buffer *buffer)
{
    return buffer ? buffer->address : 0;
}

void hewn_code_use_lists(hewn_code *code, const hewn_code_lists *lists)
{
    hewn_list_block *block = code->uniforms.mapped;
    block->lists = address_of(lists->lists);
    block->ranges = address_of(lists->ranges);
    block->around = address_of(lists->around);
    block->around_ranges = address_of(lists->around_ranges);
    block->origins = address_of(lists->origins);
}

/* --- kernels ----------------------------------------------------------------------------------------------------- */

static void write_kernel(const hewn_code *code, const hewn_kernel_desc *desc, hewn_text *text)
{
    hewn_walking how = code->walking;
    how.together = desc->flavours & HEWN_FLAVOUR_TOGETHER ? how.together : 0;
    /* An extension may only be asked for before anything is declared, so right after #version. */
    size_t version = strcspn(desc->head, "\n");
    version += desc->head[version] == '\n';
    hewn_text_append_bytes(text, desc->head, version);
    if (code->listed)
        hewn_text_append(text, "#extension GL_EXT_buffer_reference : require\n"
                               "#extension GL_EXT_buffer_reference_uvec2 : require\n"
                               "#extension GL_EXT_control_flow_attributes : require\n"
                               "#extension GL_KHR_shader_subgroup_basic : enable\n"
                               "#extension GL_KHR_shader_subgroup_vote : enable\n"
                               "#extension GL_KHR_shader_subgroup_shuffle : enable\n");
    else if (code->place == HEWN_PLACE_ADDRESS)
        hewn_text_append(text, "#extension GL_EXT_buffer_reference : require\n");
    if (code->samples.count > 0)
        hewn_text_append(text, "#extension GL_EXT_buffer_reference : require\n"
                               "#extension GL_EXT_buffer_reference_uvec2 : require\n"
                               "#extension GL_EXT_scalar_block_layout : require\n");
    hewn_text_append(text, desc->head + version);
    hewn_text_append(text, "\n");
    if (code->listed) {
        hewn_instruction_set_declare(&code->instructions.set, &how, text);
    } else {
        write_parameter_block(code, text);
        hewn_text_append(text, "void field_select(uint list)\n{\n}\n"
                               "void field_narrow(vec2 x, vec2 y, vec2 z, bool matters, uint least)\n{\n}\n");
    }
    hewn_library_write(&code->library, code->choice, HEWN_LIBRARY_POINT, text);
    bool narrows = how.together && (desc->flavours & (HEWN_FLAVOUR_FOUR | HEWN_FLAVOUR_WORD | HEWN_FLAVOUR_ROW));
    if (narrows || desc->flavours & (HEWN_FLAVOUR_INTERVAL | HEWN_FLAVOUR_CHOICES))
        hewn_library_write(&code->library, code->choice, HEWN_LIBRARY_INTERVAL, text);
    if (desc->flavours & (HEWN_FLAVOUR_GRADIENT | HEWN_FLAVOUR_FOUR | HEWN_FLAVOUR_ALONG))
        hewn_library_write(&code->library, code->choice, HEWN_LIBRARY_GRADIENT, text);
    if (!code->listed) {
        hewn_listing_write(&code->listing, desc->flavours, text);
        write_body(code, desc->body, text);
        return;
    }
    if (narrows || desc->flavours & HEWN_FLAVOUR_CHOICES)
        hewn_text_append(text, hewn_text_keep);
    hewn_instruction_set_write(&code->instructions.set, &how, desc->flavours, text);
    hewn_text_append(text, desc->body);
}

hewn_result hewn_code_program(hewn_device *device, const hewn_code *code, const hewn_kernel_desc *desc,
                              hewn_program **out, hewn_error *error)
{
    *out = NULL;
    hewn_text text = {0};
    write_kernel(code, desc, &text);
    hewn_result result = hewn_text_status(&text, error);
    if (result == HEWN_OK) {
        const hewn_program_desc program = {.name = desc->name,
                                           .glsl = text.bytes,
                                           .push_bytes = desc->push_bytes,
                                           .uniforms = true,
                                           .soon = desc->soon};
        result = hewn_program_create(device, &program, out, error);
    }
    hewn_text_clear(&text);
    return result;
}
