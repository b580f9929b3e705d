/* Questions on the device: one invocation each. */
#include <math.h>
#include <string.h>

#include "base/error.h"
#include "eval/lists.h"
#include "query/internal.h"

extern const char hewn_text_query_head[], hewn_text_answer[];

enum { GROUP = 64, PIECE = 1 << 16 };
#define FAR_AWAY 3.0e38F

static hewn_result compile(hewn_query_device *on, const hewn_field *field, hewn_node root, bool *listed,
                           hewn_error *error)
{
    const hewn_kernel_desc desc = {.name = "answer",
                                   .head = hewn_text_query_head,
                                   .body = hewn_text_answer,
                                   .flavours = HEWN_FLAVOUR_POINT | HEWN_FLAVOUR_GRADIENT | HEWN_FLAVOUR_INTERVAL,
                                   .push_bytes = sizeof(struct hewn_query_push)};
    HEWN_TRY(hewn_code_create(on->device, field, root, &on->code, error));
    *listed = hewn_code_is_listed(on->code);
    if (*listed)
        return HEWN_OK;
    HEWN_TRY(hewn_code_program(on->device, on->code, &desc, &on->program, error));
    HEWN_TRY(hewn_buffer_create(on->device, "questions", (uint64_t)PIECE * HEWN_QUESTION_WORDS * sizeof(float),
                                HEWN_BUFFER_UPLOAD, &on->in, error));
    return hewn_buffer_create(on->device, "answers", (uint64_t)PIECE * HEWN_ANSWER_WORDS * sizeof(float),
                              HEWN_BUFFER_READBACK, &on->out, error);
}

hewn_result hewn_query_open_device(hewn_query *query, hewn_device *device, const hewn_field *field, hewn_node root,
                                   hewn_error *error)
{
    bool listed = false;
    query->on = (hewn_query_device){.device = device};
    hewn_result result = compile(&query->on, field, root, &listed, error);
    if (result != HEWN_OK || listed)
        hewn_query_close_device(query);
    return result;
}

void hewn_query_close_device(hewn_query *query)
{
    hewn_query_device *on = &query->on;
    if (on->device) {
        hewn_program_destroy(on->device, &on->program);
        hewn_code_destroy(on->device, &on->code);
        hewn_buffer_destroy(on->device, &on->in);
        hewn_buffer_destroy(on->device, &on->out);
    }
    *on = (hewn_query_device){0};
}

static void write_question(const hewn_question *q, float *to)
{
    memcpy(to, q->from, sizeof q->from);
    to[3] = q->begin;
    memcpy(to + 4, q->along, sizeof q->along);
    to[7] = fminf(q->end, FAR_AWAY);
    to[8] = q->radius;
    memcpy(to + 9, &q->kind, sizeof q->kind);
}

static void read_answer(const hewn_query *query, const hewn_query_limits *limits, const float *from, hewn_answer *out)
{
    uint32_t flags;
    double fine = (double)query->fine;
    memcpy(&flags, from + 8, sizeof flags);
    *out = (hewn_answer){.found = from[1] < FAR_AWAY, .inside = (flags & HEWN_ANSWER_INSIDE) != 0};
    out->high = out->found ? (double)from[1] : INFINITY;
    out->low = from[0] < FAR_AWAY ? fmax(0, (double)from[0] - fine) : INFINITY;
    out->complete = !(flags & HEWN_ANSWER_RAN_OUT) && !(out->high - out->low > (double)limits->tolerance + 2 * fine);
    out->complete = out->complete || (!out->found && !(out->low < INFINITY));
    for (int axis = 0; axis < 3 && out->found; axis++) {
        out->point[axis] = (double)from[2 + axis];
        out->normal[axis] = (double)from[5 + axis];
    }
}

static struct hewn_query_push make_push(const hewn_query *query, const hewn_query_limits *limits)
{
    struct hewn_query_push push = {.questions = query->on.in.address,
                                   .answers = query->on.out.address,
                                   .tolerance = limits->tolerance,
                                   .fine = query->fine};
    for (int axis = 0; axis < 3; axis++) {
        push.lo[axis] = query->octree.cells->lo[axis];
        push.hi[axis] = query->octree.cells->hi[axis];
        push.wide_lo[axis] = (float)query->wide.lo[axis];
        push.wide_hi[axis] = (float)query->wide.hi[axis];
    }
    push.steepness = isfinite(query->steepness) ? nextafterf((float)query->steepness, INFINITY) : 0;
    push.wide_steepness = isfinite(query->wide_steepness) ? nextafterf((float)query->wide_steepness, INFINITY) : 0;
    double smallest = fmax(0.25 * (double)limits->tolerance, (double)query->fine);
    while (push.levels < HEWN_QUERY_LEVELS && ldexp(query->diagonal, -(int)push.levels) > smallest)
        push.levels++;
    uint64_t steps = 8 * (uint64_t)limits->most_boxes, lanes = hewn_device_get_info(query->on.device)->subgroup_size;
    uint64_t most = HEWN_QUERY_STEPS / (lanes > 0 ? lanes : 1);
    push.most_steps = (uint32_t)(steps < most ? steps : most);
    return push;
}

hewn_result hewn_query_ask_device(hewn_query *query, const hewn_question *questions, size_t count,
                                  const hewn_query_limits *limits, hewn_answer *answers, hewn_error *error)
{
    hewn_query_device *on = &query->on;
    struct hewn_query_push push = make_push(query, limits);
    for (size_t first = 0; first < count; first += PIECE) {
        push.count = (uint32_t)(count - first < PIECE ? count - first : PIECE);
        for (size_t i = 0; i < push.count; i++)
            write_question(&questions[first + i], (float *)on->in.mapped + i * HEWN_QUESTION_WORDS);
        hewn_commands *commands;
        HEWN_TRY(hewn_commands_begin(on->device, &commands, error));
        hewn_commands_dispatch(commands, on->program, &push, hewn_code_uniforms(on->code),
                               (hewn_dispatch_size){(push.count + GROUP - 1) / GROUP, 1, 1});
        HEWN_TRY(hewn_commands_submit(&commands, NULL, error));
        for (size_t i = 0; i < push.count; i++)
            read_answer(query, limits, (const float *)on->out.mapped + i * HEWN_ANSWER_WORDS, &answers[first + i]);
    }
    return HEWN_OK;
}
