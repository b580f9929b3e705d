/* Batches: one invocation an item, in pieces that bound the memory they take. */
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "eval/internal.h"

enum { PIECE = 1 << 19, GROUP = 64 };

typedef struct batch_kind {
    const char *name;
    const char *body; /* defines hewn_one(i): reads item i and writes its results */
    uint32_t flavour, slot, in_floats, out_floats;
} batch_kind;

typedef struct batch_push {
    uint64_t in, out;
    uint32_t count;
} batch_push;

static const char head[] = "#version 460\n"
                           "#extension GL_EXT_buffer_reference : require\n"
                           "#extension GL_EXT_scalar_block_layout : require\n";

#define BATCH_BODY(ONE)                                                                                                \
    "layout(local_size_x = 64) in;\n"                                                                                  \
    "layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer hewn_in { float at[]; };\n"          \
    "layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer hewn_out { float at[]; };\n"        \
    "layout(push_constant, scalar) uniform hewn_push { hewn_in inputs; hewn_out results; uint count; };\n"             \
    "void main()\n{\n"                                                                                                 \
    "uint i = gl_GlobalInvocationID.x;\nif (i >= count)\nreturn;\n" ONE "}\n"

static const batch_kind points_kind = {
    .name = "points",
    .flavour = HEWN_FLAVOUR_POINT,
    .slot = 0,
    .in_floats = 3,
    .out_floats = 1,
    .body = BATCH_BODY("results.at[i] = field_point(inputs.at[3 * i], inputs.at[3 * i + 1], inputs.at[3 * i + 2]);\n")};

static const batch_kind boxes_kind = {
    .name = "boxes",
    .flavour = HEWN_FLAVOUR_INTERVAL,
    .slot = 1,
    .in_floats = 6,
    .out_floats = 2,
    .body = BATCH_BODY("uint b = 6 * i;\n"
                       "vec2 r = field_interval(vec2(inputs.at[b], inputs.at[b + 3]),\n"
                       "vec2(inputs.at[b + 1], inputs.at[b + 4]), vec2(inputs.at[b + 2], inputs.at[b + 5]));\n"
                       "results.at[2 * i] = r.x;\nresults.at[2 * i + 1] = r.y;\n")};

static const batch_kind gradients_kind = {
    .name = "gradients",
    .flavour = HEWN_FLAVOUR_GRADIENT,
    .slot = 2,
    .in_floats = 3,
    .out_floats = 4,
    .body = BATCH_BODY("vec4 r = field_gradient(inputs.at[3 * i], inputs.at[3 * i + 1], inputs.at[3 * i + 2]);\n"
                       "results.at[4 * i] = r.w;\nresults.at[4 * i + 1] = r.x;\n"
                       "results.at[4 * i + 2] = r.y;\nresults.at[4 * i + 3] = r.z;\n")};

void hewn_batches_destroy(hewn_device *device, hewn_batches *batches)
{
    for (size_t i = 0; i < sizeof batches->programs / sizeof *batches->programs; i++)
        hewn_program_destroy(device, &batches->programs[i]);
    hewn_free(batches);
}

static hewn_result prepare(hewn_device *device, const hewn_code *code, const batch_kind *kind, hewn_error *error)
{
    if (code->batches->programs[kind->slot])
        return HEWN_OK;
    const hewn_kernel_desc desc = {.name = kind->name,
                                   .head = head,
                                   .body = kind->body,
                                   .flavours = kind->flavour,
                                   .push_bytes = 2 * sizeof(uint64_t) + sizeof(uint32_t)};
    return hewn_code_program(device, code, &desc, &code->batches->programs[kind->slot], error);
}

static hewn_result run_piece(hewn_device *device, const hewn_code *code, const batch_kind *kind, const hewn_buffer *in,
                             const hewn_buffer *out, uint32_t count, hewn_error *error)
{
    const batch_push push = {.in = in->address, .out = out->address, .count = count};
    hewn_commands *commands;
    HEWN_TRY(hewn_commands_begin(device, &commands, error));
    hewn_commands_dispatch(commands, code->batches->programs[kind->slot], &push, &code->uniforms,
                           (hewn_dispatch_size){(count + GROUP - 1) / GROUP, 1, 1});
    return hewn_commands_submit(&commands, NULL, error);
}

static hewn_result run_pieces(hewn_device *device, const hewn_code *code, const batch_kind *kind, const hewn_buffer *in,
                              const hewn_buffer *out, const float *items, size_t count, float *results,
                              hewn_error *error)
{
    for (size_t first = 0; first < count; first += PIECE) {
        size_t taken = count - first < PIECE ? count - first : PIECE;
        memcpy(in->mapped, items + first * kind->in_floats, taken * kind->in_floats * sizeof(float));
        HEWN_TRY(run_piece(device, code, kind, in, out, (uint32_t)taken, error));
        memcpy(results + first * kind->out_floats, out->mapped, taken * kind->out_floats * sizeof(float));
    }
    return HEWN_OK;
}

static hewn_result run(hewn_device *device, const hewn_code *code, const batch_kind *kind, const float *items,
                       size_t count, float *results, hewn_error *error)
{
    if (count == 0)
        return HEWN_OK;
    HEWN_TRY(prepare(device, code, kind, error));
    uint64_t piece = count < PIECE ? count : PIECE;
    hewn_buffer in, out = {0};
    HEWN_TRY(hewn_buffer_create(device, kind->name, piece * kind->in_floats * sizeof(float), HEWN_BUFFER_UPLOAD, &in,
                                error));
    hewn_result result = hewn_buffer_create(device, kind->name, piece * kind->out_floats * sizeof(float),
                                            HEWN_BUFFER_READBACK, &out, error);
    if (result == HEWN_OK)
        result = run_pieces(device, code, kind, &in, &out, items, count, results, error);
    hewn_buffer_destroy(device, &in);
    hewn_buffer_destroy(device, &out);
    return result;
}

hewn_result hewn_code_eval_points(hewn_device *device, const hewn_code *code, const float *points, size_t count,
                                  float *values, hewn_error *error)
{
    return run(device, code, &points_kind, points, count, values, error);
}

hewn_result hewn_code_eval_boxes(hewn_device *device, const hewn_code *code, const float *boxes, size_t count,
                                 float *intervals, hewn_error *error)
{
    return run(device, code, &boxes_kind, boxes, count, intervals, error);
}

hewn_result hewn_code_eval_gradients(hewn_device *device, const hewn_code *code, const float *points, size_t count,
                                     float *values_and_gradients, hewn_error *error)
{
    return run(device, code, &gradients_kind, points, count, values_and_gradients, error);
}
