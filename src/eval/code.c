#include "eval/code.h"

#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "eval/internal.h"
#include "gpu/device.h"

/* --- parameters -------------------------------------------------------------------------------------------------- */

static bool by_address(const hewn_code *code)
{
    return code->parameters.size > 0;
}

static hewn_result write_parameters(hewn_device *device, hewn_code *code, hewn_error *error)
{
    const hewn_listing *listing = &code->listing;
    size_t count = listing->fixed ? 0 : listing->parameter_count;
    uint64_t bytes = (count * sizeof(float) + 15) / 16 * 16;
    bytes = bytes < 16 ? 16 : bytes;
    if (bytes <= device->max_uniform_range) {
        HEWN_TRY(hewn_buffer_create(device, "parameters", bytes, HEWN_BUFFER_UPLOAD, &code->uniforms, error));
        memset(code->uniforms.mapped, 0, bytes);
        memcpy(code->uniforms.mapped, listing->parameters, count * sizeof(float));
        return HEWN_OK;
    }
    HEWN_TRY(hewn_buffer_create(device, "parameters", bytes, HEWN_BUFFER_UPLOAD, &code->parameters, error));
    memcpy(code->parameters.mapped, listing->parameters, count * sizeof(float));
    HEWN_TRY(hewn_buffer_create(device, "parameters", 16, HEWN_BUFFER_UPLOAD, &code->uniforms, error));
    memset(code->uniforms.mapped, 0, 16);
    memcpy(code->uniforms.mapped, &code->parameters.address, sizeof code->parameters.address);
    return HEWN_OK;
}

/* Uniforms are read with addresses that all invocations share, which is a plain load on CPUs, while reads through a
 * buffer's address are gathered lane by lane there. */
static void write_parameter_block(const hewn_code *code, hewn_text *text)
{
    if (code->listing.fixed)
        return;
    if (!by_address(code)) {
        hewn_text_print(text,
                        "layout(set = 0, binding = 0) uniform hewn_parameter_block { vec4 hewn_parameters[%u]; };\n",
                        (unsigned)(code->uniforms.size / 16));
        hewn_text_append(text, "#define P(i) hewn_parameters[(i) >> 2][(i) & 3]\n");
        return;
    }
    hewn_text_append(text, "layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer "
                           "hewn_parameter_list { float at[]; };\n"
                           "layout(set = 0, binding = 0) uniform hewn_parameter_block { hewn_parameter_list "
                           "hewn_parameters; };\n"
                           "#define P(i) hewn_parameters.at[i]\n");
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

hewn_result hewn_code_create_with(hewn_device *device, const hewn_field *field, hewn_node root, hewn_numbers numbers,
                                  hewn_code **out, hewn_error *error)
{
    *out = NULL;
    hewn_code *code = hewn_alloc_zero(1, sizeof *code);
    if (code)
        code->batches = hewn_alloc_zero(1, sizeof *code->batches);
    if (!code || !code->batches) {
        hewn_free(code);
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a field's code");
    }
    hewn_result result = hewn_listing_create(&code->listing, field, root, error);
    code->listing.fixed =
        numbers == HEWN_NUMBERS_IN_CODE || (numbers == HEWN_NUMBERS_AUTO && device->info.kind == HEWN_DEVICE_CPU);
    if (result == HEWN_OK)
        result = choose_blocks(code, error);
    if (result == HEWN_OK)
        result = write_parameters(device, code, error);
    if (result != HEWN_OK)
        hewn_code_destroy(device, &code);
    *out = code;
    return result;
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
    hewn_listing_destroy(&(*code)->listing);
    hewn_free(*code);
    *code = NULL;
}

const hewn_buffer *hewn_code_uniforms(const hewn_code *code)
{
    return &code->uniforms;
}

/* --- kernels ----------------------------------------------------------------------------------------------------- */

static void write_kernel(const hewn_code *code, const hewn_kernel_desc *desc, hewn_text *text)
{
    /* An extension may only be asked for before anything is declared, so right after #version. */
    size_t version = strcspn(desc->head, "\n");
    version += desc->head[version] == '\n';
    hewn_text_append_bytes(text, desc->head, version);
    if (by_address(code))
        hewn_text_append(text, "#extension GL_EXT_buffer_reference : require\n");
    hewn_text_append(text, desc->head + version);
    hewn_text_append(text, "\n");
    write_parameter_block(code, text);
    hewn_library_write(&code->library, code->choice, HEWN_LIBRARY_POINT, text);
    if (desc->flavours & HEWN_FLAVOUR_INTERVAL)
        hewn_library_write(&code->library, code->choice, HEWN_LIBRARY_INTERVAL, text);
    if (desc->flavours & HEWN_FLAVOUR_GRADIENT)
        hewn_library_write(&code->library, code->choice, HEWN_LIBRARY_GRADIENT, text);
    hewn_listing_write(&code->listing, desc->flavours, text);
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
        const hewn_program_desc program = {
            .name = desc->name, .glsl = text.bytes, .push_bytes = desc->push_bytes, .uniforms = true};
        result = hewn_program_create(device, &program, out, error);
    }
    hewn_text_clear(&text);
    return result;
}
