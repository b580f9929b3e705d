/* A field made into shader code: one emitter, three flavours (point, interval, gradient). */
#ifndef HEWN_SRC_EVAL_CODE_H
#define HEWN_SRC_EVAL_CODE_H

#include "field/graph.h"
#include "gpu/gpu.h"

typedef struct hewn_code hewn_code;

/* Which functions a kernel calls; or them together. */
typedef enum hewn_flavour {
    HEWN_FLAVOUR_POINT = 1,    /* float field_point(float x, float y, float z) */
    HEWN_FLAVOUR_INTERVAL = 2, /* vec2 field_interval(vec2 x, vec2 y, vec2 z): (lo, hi), contains all values that
                                  field_point computes for arguments in there; [-inf, inf] where NaN is possible */
    HEWN_FLAVOUR_GRADIENT = 4, /* vec4 field_gradient(float x, float y, float z): (d/dx, d/dy, d/dz, value), value with
                                  field_point's bits */
    HEWN_FLAVOUR_WORD = 16,    /* uint field_word_inside(uint i, vec4 y, float z): the bits of four such rows, the first
                                  row's lowest */
    HEWN_FLAVOUR_CHOICES = 32, /* in listed code: see eval/lists.h */
    HEWN_FLAVOUR_FOUR = 64,    /* in listed code: values and gradients of four points at once */
    HEWN_FLAVOUR_TOGETHER = 128, /* all invocations of a subgroup, none of which has left, evaluate the same list at
                                    the same time */
    HEWN_FLAVOUR_NEAR =
        256, /* no coordinate is larger than HEWN_REACH: what is never NaN there is not asked whether it is */
    HEWN_FLAVOUR_ALONG = 512, /* in straight code: places that differ along one axis from one that is told first by
                                 void field_stand(vec3 start, uint axis). float field_along(float at) is field_point()
                                 where that coordinate is `at`, and vec4 field_slope_along(float at) field_gradient(),
                                 but for signs of zeros. What does not depend on the axis is evaluated once. */
    HEWN_FLAVOUR_ROW = 8 /* uint field_row_inside(uint i, float y, float z): bit k set where field_point(sample_x(i +
                            k), y, z) < 0, k = 0..7. The kernel declares `float sample_x(uint i);` before the field's
                            code and defines it. What does not depend on x is evaluated once a row. */
} hewn_flavour;

/* Up to here the emitter knows how large values get; farther out intervals are everything. The shader has the same
 * number. */
#define HEWN_REACH 0x1p30

/* Where the field's numbers live. In a buffer, another number of the same field needs no compilation. In the code it
 * does, and the first compilation is a little shorter. Values, bounds and gradients have the same bits either way. */
typedef enum hewn_numbers {
    HEWN_NUMBERS_AUTO, /* in a buffer; in the code on CPU devices where there are more than 1,024 */
    HEWN_NUMBERS_IN_BUFFER,
    HEWN_NUMBERS_IN_CODE
} hewn_numbers;

/* Reads what it needs of the field, which may change or go afterwards. */
hewn_result hewn_code_create(hewn_device *device, const hewn_field *field, hewn_node root, hewn_code **out,
                             hewn_error *error);
hewn_result hewn_code_create_with(hewn_device *device, const hewn_field *field, hewn_node root, hewn_numbers numbers,
                                  hewn_code **out, hewn_error *error);
void hewn_code_destroy(hewn_device *device, hewn_code **code);

/* Takes another field's numbers, for this code and all programs made of it, where the code would be the same but for
 * them; `*taken` tells whether. False where the numbers are in the code. No dispatch may be under way. */
hewn_result hewn_code_renumber(hewn_code *code, const hewn_field *field, hewn_node root, bool *taken,
                               hewn_error *error);

/* A kernel that calls the field. Its text is `head` (starts with #version and extensions; `common` below is appended by
 * the callee), then the field's functions, then `body`. Its dispatches must pass hewn_code_uniforms(). */
typedef struct hewn_kernel_desc {
    const char *name;
    const char *head;
    const char *body;
    uint32_t flavours; /* of hewn_flavour */
    uint32_t push_bytes;
    bool soon; /* as in hewn_program_desc */
} hewn_kernel_desc;

hewn_result hewn_code_program(hewn_device *device, const hewn_code *code, const hewn_kernel_desc *desc,
                              hewn_program **out, hewn_error *error);

const hewn_buffer *hewn_code_uniforms(const hewn_code *code);

/* Values, bounds and gradients in batches, for tests and queries. Points are float triples; boxes are six floats (lo x,
 * y, z, hi x, y, z); intervals come back as (lo, hi), gradients as (value, d/dx, d/dy, d/dz). Any count. */
hewn_result hewn_code_eval_points(hewn_device *device, const hewn_code *code, const float *points, size_t count,
                                  float *values, hewn_error *error);
hewn_result hewn_code_eval_boxes(hewn_device *device, const hewn_code *code, const float *boxes, size_t count,
                                 float *intervals, hewn_error *error);
hewn_result hewn_code_eval_gradients(hewn_device *device, const hewn_code *code, const float *points, size_t count,
                                     float *values_and_gradients, hewn_error *error);

#endif
