/* Rays on the device: cells by interval bounds, then one invocation a ray. */
#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/text.h"
#include "eval/lists.h"
#include "field/graph.h"
#include "render/cells.h"
#include "render/tracer.h"

extern const char hewn_text_render_head[], hewn_text_trace[];

enum { CELLS = 48, GROUP = 64, PIECE = 1 << 18 };

typedef struct device_tracer {
    hewn_device *device;
    hewn_code *code;
    hewn_program *program;
    hewn_box box;
    double steepness, slope;
    hewn_buffer cells, rays, met;
} device_tracer;

static void destroy(void *self)
{
    device_tracer *tracer = self;
    hewn_program_destroy(tracer->device, &tracer->program);
    hewn_code_destroy(tracer->device, &tracer->code);
    hewn_buffer_destroy(tracer->device, &tracer->cells);
    hewn_buffer_destroy(tracer->device, &tracer->rays);
    hewn_buffer_destroy(tracer->device, &tracer->met);
    hewn_free(tracer);
}

/* Boxes of cells, a little larger than they are: rays leave a cell by a small step beyond it. */
static void box_cells(const hewn_box *box, uint32_t z, float *boxes)
{
    for (uint32_t i = 0; i < CELLS * CELLS; i++) {
        const uint32_t at[3] = {i % CELLS, i / CELLS, z};
        double least = INFINITY;
        for (int axis = 0; axis < 3; axis++)
            least = fmin(least, (box->hi[axis] - box->lo[axis]) / CELLS);
        for (int axis = 0; axis < 3; axis++) {
            double cell = (box->hi[axis] - box->lo[axis]) / CELLS, begin = box->lo[axis] + cell * at[axis];
            double margin = 0.004 * least + 1e-6 * (fabs(box->lo[axis]) + fabs(box->hi[axis]));
            boxes[6 * i + (uint32_t)axis] = (float)(begin - margin);
            boxes[6 * i + 3 + (uint32_t)axis] = (float)(begin + cell + margin);
        }
    }
}

static hewn_result fill_cells(device_tracer *tracer, hewn_error *error)
{
    uint8_t *cells = tracer->cells.mapped;
    float *boxes = hewn_alloc((size_t)CELLS * CELLS * 6, sizeof *boxes);
    float *bounds = hewn_alloc((size_t)CELLS * CELLS * 2, sizeof *bounds);
    hewn_result result = boxes && bounds ? HEWN_OK : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for cells");
    for (uint32_t z = 0; z < CELLS && result == HEWN_OK; z++) {
        box_cells(&tracer->box, z, boxes);
        result = hewn_code_eval_boxes(tracer->device, tracer->code, boxes, (size_t)CELLS * CELLS, bounds, error);
        for (size_t i = 0; i < (size_t)CELLS * CELLS; i++)
            cells[z * (size_t)CELLS * CELLS + i] = bounds[2 * i] > 0 ? 255 : 0;
    }
    hewn_free(boxes);
    hewn_free(bounds);
    if (result == HEWN_OK)
        hewn_cells_measure(cells, CELLS);
    return result;
}

/* Whether rays go on by spheres. */
static bool is_bounded(const device_tracer *tracer)
{
    return tracer->steepness > 0 && tracer->steepness <= HEWN_STEEPEST * tracer->slope;
}

static hewn_result create_program(device_tracer *tracer, hewn_error *error)
{
    hewn_text body = {0};
    hewn_text_append(&body, is_bounded(tracer) ? "#define HEWN_BY_SPHERES\n" : "");
    hewn_text_append(&body, hewn_text_trace);
    hewn_result result = hewn_text_status(&body, error);
    const uint32_t by_interval = is_bounded(tracer) ? 0 : HEWN_FLAVOUR_INTERVAL;
    const hewn_kernel_desc desc = {.name = "trace",
                                   .head = hewn_text_render_head,
                                   .body = body.bytes,
                                   .flavours = HEWN_FLAVOUR_POINT | HEWN_FLAVOUR_GRADIENT | by_interval,
                                   .push_bytes = sizeof(struct hewn_trace_push)};
    if (result == HEWN_OK)
        result = hewn_code_program(tracer->device, tracer->code, &desc, &tracer->program, error);
    hewn_text_clear(&body);
    return result;
}

static hewn_result prepare(device_tracer *tracer, const hewn_field *field, hewn_node root, hewn_error *error)
{
    hewn_device *device = tracer->device;
    HEWN_TRY(hewn_steepness_bound(field, root, &tracer->box, &tracer->steepness, error));
    HEWN_TRY(hewn_common_slope(field, root, &tracer->box, &tracer->slope, error));
    HEWN_TRY(hewn_buffer_create(device, "cells", (uint64_t)CELLS * CELLS * CELLS, HEWN_BUFFER_UPLOAD, &tracer->cells,
                                error));
    HEWN_TRY(hewn_buffer_create(device, "rays", (uint64_t)PIECE * sizeof(hewn_ray), HEWN_BUFFER_UPLOAD, &tracer->rays,
                                error));
    HEWN_TRY(hewn_buffer_create(device, "hits", (uint64_t)PIECE * sizeof(hewn_met), HEWN_BUFFER_READBACK, &tracer->met,
                                error));
    HEWN_TRY(fill_cells(tracer, error));
    return create_program(tracer, error);
}

static struct hewn_trace_push make_push(const device_tracer *tracer, const hewn_stage *stage)
{
    struct hewn_trace_push push = {.rays = tracer->rays.address,
                                   .hits = tracer->met.address,
                                   .cells = tracer->cells.address,
                                   .softness = stage->softness,
                                   .reach = stage->reach,
                                   .ground = stage->ground,
                                   .slope = (float)tracer->slope,
                                   .nearness = stage->nearness,
                                   .spread = stage->spread,
                                   .cells_across = CELLS,
                                   .up = stage->up,
                                   .flags = stage->flags};
    double farthest = 0;
    for (int axis = 0; axis < 3; axis++) {
        push.lo[axis] = (float)tracer->box.lo[axis];
        push.hi[axis] = (float)tracer->box.hi[axis];
        push.light[axis] = stage->light[axis];
        farthest = fmax(farthest, fmax(fabs(tracer->box.lo[axis]), fabs(tracer->box.hi[axis])));
    }
    push.steepness = is_bounded(tracer) ? nextafterf((float)tracer->steepness, INFINITY) : 0;
    push.slack = push.steepness * (float)farthest * 0x1p-18F;
    return push;
}

static hewn_result trace(void *self, const hewn_stage *stage, const hewn_ray *rays, size_t count, hewn_met *met,
                         hewn_error *error)
{
    device_tracer *tracer = self;
    struct hewn_trace_push push = make_push(tracer, stage);
    for (size_t first = 0; first < count; first += PIECE) {
        push.count = (uint32_t)(count - first < PIECE ? count - first : PIECE);
        memcpy(tracer->rays.mapped, rays + first, push.count * sizeof *rays);
        hewn_commands *commands;
        HEWN_TRY(hewn_commands_begin(tracer->device, &commands, error));
        hewn_commands_dispatch(commands, tracer->program, &push, hewn_code_uniforms(tracer->code),
                               (hewn_dispatch_size){(push.count + GROUP - 1) / GROUP, 1, 1});
        HEWN_TRY(hewn_commands_submit(&commands, NULL, error));
        memcpy(met + first, tracer->met.mapped, push.count * sizeof *met);
    }
    return HEWN_OK;
}

/* Whether the host runs an operation in vector code, or as fast as a CPU device in any case. */
static bool is_plain(hewn_op op)
{
    switch (op) {
    case HEWN_OP_SQRT:
    case HEWN_OP_CONE:
    case HEWN_OP_EDGE:
    case HEWN_OP_OUTLINE:
    case HEWN_OP_SAMPLED:
    case HEWN_OP_PAINT: return true;
    default: break;
    }
    bool arithmetic = op == HEWN_OP_CONSTANT || op == HEWN_OP_NEG || op == HEWN_OP_ABS || op == HEWN_OP_SQUARE ||
                      op == HEWN_OP_ADD || op == HEWN_OP_SUB || op == HEWN_OP_MUL || op == HEWN_OP_MIN ||
                      op == HEWN_OP_MAX;
    bool shape = op >= HEWN_OP_AFFINE && op <= HEWN_OP_PLANE, blend = op >= HEWN_OP_BLEND_QUADRATIC;
    return op <= HEWN_OP_Z || arithmetic || shape || blend;
}

/* Fields with fewer operations are compiled in no time. */
enum { LEAST_ON_HOST = 48 };

static hewn_result choose_host(const hewn_device *device, const hewn_field *field, hewn_node root, bool *out,
                               hewn_error *error)
{
    uint32_t *ids;
    size_t count;
    HEWN_TRY(hewn_field_live_nodes(field, root, &ids, &count, error));
    *out = hewn_device_get_info(device)->kind == HEWN_DEVICE_CPU && count >= LEAST_ON_HOST;
    for (size_t i = 0; i < count && *out; i++)
        *out = is_plain(hewn_field_node(field, ids[i])->op);
    hewn_free(ids);
    return HEWN_OK;
}

hewn_result hewn_tracer_on_device(hewn_device *device, const hewn_field *field, hewn_node root, const hewn_box *box,
                                  hewn_tracer *out, bool *on_host, hewn_error *error)
{
    *out = (hewn_tracer){0};
    HEWN_TRY(choose_host(device, field, root, on_host, error));
    if (*on_host)
        return HEWN_OK;
    device_tracer *tracer = hewn_alloc_zero(1, sizeof *tracer);
    if (!tracer)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a renderer");
    *tracer = (device_tracer){.device = device, .box = *box};
    hewn_result result = hewn_code_create(device, field, root, &tracer->code, error);
    if (result == HEWN_OK)
        *on_host = hewn_code_is_listed(tracer->code);
    if (result == HEWN_OK && !*on_host)
        result = prepare(tracer, field, root, error);
    if (result != HEWN_OK || *on_host)
        destroy(tracer);
    else
        *out = (hewn_tracer){.self = tracer, .trace = trace, .destroy = destroy};
    return result;
}
