#include "base/alloc.h"
#include "base/error.h"
#include "field/internal.h"

/* Points that go through a step together, so that one switch serves many; fewer for graphs whose values would not stay
 * in a cache or in memory. */
static size_t batch_size(size_t steps)
{
    size_t batch = ((size_t)1 << 16) / steps;
    return batch < 1 ? 1 : batch > 64 ? 64 : batch;
}

/* `values` holds `stride` values a step. */
static void run_step(const hewn_step *step, const double *points, size_t count, size_t stride, double *values,
                     double *out)
{
    if (step->node->op <= HEWN_OP_Z) {
        for (size_t p = 0; p < count; p++)
            out[p] = points[3 * p + (size_t)(step->node->op - HEWN_OP_X)];
        return;
    }
    int operands = hewn_op_infos[step->node->op].operands;
    double in[HEWN_MAX_OPERANDS] = {0};
    for (size_t p = 0; p < count; p++) {
        for (int k = 0; k < operands; k++)
            in[k] = values[step->in[k] * stride + p];
        out[p] = hewn_op_point(step->node, in);
    }
}

hewn_result hewn_field_eval(const hewn_field *field, hewn_node node, const double *points, size_t count, double *values,
                            hewn_error *error)
{
    if (count > 0 && (!points || !values))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "hewn_field_eval: no points or no place for their values");
    hewn_tape tape;
    HEWN_TRY(hewn_tape_create(&tape, field, node, error));
    size_t batch = batch_size(tape.count);
    double *scratch = hewn_alloc(tape.count * batch, sizeof *scratch);
    if (!scratch) {
        hewn_tape_destroy(&tape);
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory evaluating a field");
    }
    for (size_t first = 0; first < count; first += batch) {
        size_t taken = count - first < batch ? count - first : batch;
        for (size_t i = 0; i < tape.count; i++) {
            double *out = i + 1 == tape.count ? values + first : scratch + i * batch;
            run_step(&tape.steps[i], points + 3 * first, taken, batch, scratch, out);
        }
    }
    hewn_free(scratch);
    hewn_tape_destroy(&tape);
    return HEWN_OK;
}
