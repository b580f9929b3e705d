/* What the tests of generated code share: awkward numbers, one-operation fields, random graphs. */
#ifndef HEWN_TESTS_TEST_CODE_SUPPORT_H
#define HEWN_TESTS_TEST_CODE_SUPPORT_H

#include <float.h>
#include <math.h>

#include "gpu_test.h"

#include "base/alloc.h"
#include "eval/code.h"
#include "field/graph.h"

/* From 0 to 1, both possible. */
static inline double code_uniform(uint64_t *state)
{
    return gpu_test_random(state) / 4294967295.0;
}

static inline double code_between(uint64_t *state, double lo, double hi)
{
    return lo + (hi - lo) * code_uniform(state);
}

/* A number of any size: its logarithm is uniform, its sign too. */
static inline float code_any_size(uint64_t *state, double least, double most)
{
    double size = exp2(code_between(state, log2(least), log2(most)));
    return (float)(gpu_test_random(state) & 1 ? -size : size);
}

/* Numbers that break careless arithmetic; each is used with both signs. */
static const float code_awkward[] = {0.0f,        1e-45f,      5e-39f,  FLT_MIN,     1.5e-38f,    1e-20f,      1e-7f,
                                     0.1f,        0.25f,       0.5f,    0.99999994f, 1.0f,        1.00000012f, 1.5f,
                                     1.57079637f, 2.0f,        2.5f,    3.14159274f, 4.71238899f, 6.28318548f, 10.0f,
                                     88.5f,       100.530968f, 1000.0f, 12867.0f,    8388607.5f,  16777216.0f, 1e10f,
                                     1e18f,       1e30f,       FLT_MAX, INFINITY,    NAN};

enum { CODE_AWKWARD = 2 * sizeof code_awkward / sizeof *code_awkward };

static inline float code_awkward_at(size_t i)
{
    float value = code_awkward[i / 2];
    return i % 2 ? -value : value;
}

/* Parameters in the range that an operation takes. */
static inline void code_parameters(hewn_op op, uint64_t *state, double *p)
{
    for (int i = 0; i < HEWN_MAX_PARAMETERS; i++)
        p[i] = (double)(float)code_between(state, 0.05, 1.5);
    if (op == HEWN_OP_AFFINE || op == HEWN_OP_CONSTANT)
        for (int i = 0; i < HEWN_MAX_PARAMETERS; i++)
            p[i] = (double)(float)code_between(state, -2, 2);
    if (op == HEWN_OP_PLANE) {
        double n[3] = {code_between(state, -1, 1), code_between(state, -1, 1), code_between(state, 0.1, 1)};
        double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        for (int i = 0; i < 3; i++)
            p[i] = n[i] / length;
    }
    if (op >= HEWN_OP_NOISE_VALUE && op <= HEWN_OP_NOISE_CELLULAR)
        p[0] = gpu_test_random(state) % 0x1000000u;
    if (op == HEWN_OP_CONE && gpu_test_random(state) % 3 == 0)
        p[gpu_test_random(state) % 2] = 0;
    if (op == HEWN_OP_BLEND_EXPONENTIAL)
        p[0] *= 20;
}

static inline hewn_node code_node(hewn_field *field, hewn_op op, const uint32_t *operands, const double *parameters)
{
    hewn_node_data data = {.op = op, .operand = {0xFFFFFFFFu, 0xFFFFFFFFu, 0xFFFFFFFFu}};
    for (int i = 0; i < hewn_op_infos[op].operands; i++)
        data.operand[i] = operands[i];
    for (int i = 0; i < hewn_op_infos[op].parameters; i++)
        data.parameter[i] = parameters[i];
    return hewn_field_add_node(field, &data);
}

/* A field of one operation on x, y, z. */
static inline hewn_field *code_one_op(hewn_op op, const double *parameters, hewn_node *root)
{
    hewn_field *field;
    GPU_TEST_TRY(hewn_field_create(&field, &error));
    const uint32_t operands[3] = {hewn_x(field).id, hewn_y(field).id, hewn_z(field).id};
    *root = code_node(field, op, operands, parameters);
    GPU_TEST_TRY(hewn_field_status(field, &error));
    return field;
}

static inline hewn_code *code_with(hewn_device *device, const hewn_field *field, hewn_node root, hewn_numbers numbers)
{
    hewn_code *code;
    GPU_TEST_TRY(hewn_code_create_with(device, field, root, numbers, &code, &error));
    return code;
}

static inline hewn_code *code_of(hewn_device *device, const hewn_field *field, hewn_node root)
{
    return code_with(device, field, root, HEWN_NUMBERS_AUTO);
}

/* A graph of about `size` nodes whose operands are mostly recent, so that it is deep and shares. */
static inline hewn_field *code_random_graph(uint64_t *state, size_t size, hewn_node *root)
{
    hewn_field *field;
    GPU_TEST_TRY(hewn_field_create(&field, &error));
    uint32_t ids[256] = {hewn_x(field).id, hewn_y(field).id, hewn_z(field).id};
    size_t count = 3;
    while (count < size && count < 256) {
        uint32_t operands[3];
        double parameters[HEWN_MAX_PARAMETERS];
        for (int i = 0; i < 3; i++) {
            size_t back = gpu_test_random(state) % (gpu_test_random(state) % 3 ? 8 : count);
            operands[i] = back < count ? ids[count - 1 - back] : ids[gpu_test_random(state) % 3];
        }
        hewn_op op = (hewn_op)(gpu_test_random(state) % HEWN_OP_COUNT);
        if (op <= HEWN_OP_Z || hewn_op_is_link(op))
            continue;
        if (hewn_op_infos[op].operands == 3 && gpu_test_random(state) % 2)
            for (int i = 0; i < 3; i++)
                operands[i] = ids[i];
        code_parameters(op, state, parameters);
        ids[count++] = code_node(field, op, operands, parameters).id;
    }
    /* The last few together, so that little of the graph is dead. */
    *root = (hewn_node){ids[count - 1]};
    for (size_t i = 2; i <= 6 && i <= count; i++)
        *root = i % 2 ? hewn_min(field, *root, (hewn_node){ids[count - i]})
                      : hewn_add(field, *root, (hewn_node){ids[count - i]});
    GPU_TEST_TRY(hewn_field_status(field, &error));
    return field;
}

/* Shapes in a cube of +-1, combined in every way; the same ones for the same state. */
static inline hewn_node code_many_shapes(hewn_field *field, uint64_t *random, int count)
{
    hewn_node all = hewn_sphere(field, 0.3);
    for (int i = 1; i < count; i++) {
        double size = code_between(random, 0.05, 0.2), at[3];
        for (int k = 0; k < 3; k++)
            at[k] = code_between(random, -1, 1);
        hewn_node shape = i % 3 == 0   ? hewn_sphere(field, size)
                          : i % 3 == 1 ? hewn_box_shape(field, size, size, 2 * size)
                                       : hewn_torus(field, size, size / 4);
        if (i % 5 == 0)
            shape = hewn_rotate(field, shape, 1, at[0], at[1], size * 9);
        shape = hewn_translate(field, shape, at[0], at[1], at[2]);
        all = i % 4 == 0   ? hewn_smooth_union(field, all, shape, HEWN_BLEND_QUADRATIC, 0.05)
              : i % 7 == 0 ? hewn_difference(field, all, shape)
                           : hewn_union(field, all, shape);
    }
    return all;
}

static inline bool code_is_denormal(float a)
{
    return a != 0 && fabsf(a) < FLT_MIN;
}

static inline uint32_t code_bits(float a)
{
    uint32_t bits;
    memcpy(&bits, &a, sizeof bits);
    return bits;
}

/* The same value down to the bits; which NaN, and which zero, does not matter. */
static inline bool code_same(float a, float b)
{
    return (isnan(a) && isnan(b)) || (a == 0 && b == 0) || code_bits(a) == code_bits(b);
}

#endif
