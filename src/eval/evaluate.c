#include "hewn/evaluate.h"

#include "base/alloc.h"
#include "base/error.h"
#include "eval/lists.h"

enum { PIECE = 1 << 16 };

struct hewn_evaluator {
    hewn_device *device;
    hewn_code *code;
    float points[3 * PIECE], results[4 * PIECE];
};

hewn_result hewn_evaluator_create(hewn_device *device, const hewn_field *field, hewn_node root, hewn_evaluator **out,
                                  hewn_error *error)
{
    *out = NULL;
    hewn_evaluator *own = hewn_alloc(1, sizeof *own);
    if (!own)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for an evaluator");
    own->device = device;
    own->code = NULL;
    hewn_result result = hewn_code_create(device, field, root, &own->code, error);
    if (result == HEWN_OK && !hewn_code_is_listed(own->code))
        *out = own;
    else
        hewn_evaluator_destroy(&own);
    return result;
}

void hewn_evaluator_destroy(hewn_evaluator **evaluator)
{
    if (*evaluator)
        hewn_code_destroy((*evaluator)->device, &(*evaluator)->code);
    hewn_free(*evaluator);
    *evaluator = NULL;
}

/* In pieces; `width` numbers a point. */
static hewn_result evaluate(hewn_evaluator *own, const double *points, size_t count, unsigned width, double *out,
                            hewn_error *error)
{
    for (size_t first = 0; first < count; first += PIECE) {
        size_t taken = count - first < PIECE ? count - first : PIECE;
        for (size_t i = 0; i < 3 * taken; i++)
            own->points[i] = (float)points[3 * first + i];
        HEWN_TRY(width == 1
                     ? hewn_code_eval_points(own->device, own->code, own->points, taken, own->results, error)
                     : hewn_code_eval_gradients(own->device, own->code, own->points, taken, own->results, error));
        for (size_t i = 0; i < width * taken; i++)
            out[width * first + i] = (double)own->results[i];
    }
    return HEWN_OK;
}

hewn_result hewn_evaluator_values(hewn_evaluator *evaluator, const double *points, size_t count, double *values,
                                  hewn_error *error)
{
    return evaluate(evaluator, points, count, 1, values, error);
}

hewn_result hewn_evaluator_gradients(hewn_evaluator *evaluator, const double *points, size_t count,
                                     double *values_and_gradients, hewn_error *error)
{
    return evaluate(evaluator, points, count, 4, values_and_gradients, error);
}
