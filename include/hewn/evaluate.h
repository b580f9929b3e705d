/* Values and gradients of a field on a device, many points at once. On the host they are hewn_field_eval() and
 * hewn_field_gradient(). */
#ifndef HEWN_EVALUATE_H
#define HEWN_EVALUATE_H

#include "hewn/device.h"
#include "hewn/field.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A field compiled for a device. */
typedef struct hewn_evaluator hewn_evaluator;

/* The device must outlive it; the field may be changed or destroyed afterwards. Serves one thread at a time. A field of
 * so many operations that devices would walk over lists of them is none for it: `*out` is then NULL, and the result
 * HEWN_OK. HEWN_INVALID_ARGUMENT for a node of no field; HEWN_LIMIT, HEWN_OUT_OF_MEMORY, device errors. */
HEWN_API hewn_result hewn_evaluator_create(hewn_device *device, const hewn_field *field, hewn_node root,
                                           hewn_evaluator **out, hewn_error *error);
HEWN_API void hewn_evaluator_destroy(hewn_evaluator **evaluator);

/* The value at each of `count` points (x, y, z triples), in single precision, off the true one by no more than
 * docs/evaluation.md says; points are rounded to it first. HEWN_OUT_OF_MEMORY, device errors. */
HEWN_API hewn_result hewn_evaluator_values(hewn_evaluator *evaluator, const double *points, size_t count,
                                           double *values, hewn_error *error);

/* Value and gradient of each: (value, d/dx, d/dy, d/dz). */
HEWN_API hewn_result hewn_evaluator_gradients(hewn_evaluator *evaluator, const double *points, size_t count,
                                              double *values_and_gradients, hewn_error *error);

#ifdef __cplusplus
}
#endif
#endif
