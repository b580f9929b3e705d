/* Shared by the tests of fields: a seeded generator of numbers, boxes and random graphs. */
#ifndef HEWN_TEST_FIELD_SUPPORT_H
#define HEWN_TEST_FIELD_SUPPORT_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "field/graph.h"

typedef struct random_state {
    uint64_t at;
} random_state;

static inline uint64_t random_bits(random_state *random)
{
    uint64_t z = random->at += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
}

/* Uniform in [0, 1). */
static inline double random_unit(random_state *random)
{
    return (double)(random_bits(random) >> 11) * 0x1p-53;
}

static inline double random_between(random_state *random, double lo, double hi)
{
    return lo + (hi - lo) * random_unit(random);
}

static inline uint32_t random_below(random_state *random, uint32_t count)
{
    return (uint32_t)(random_bits(random) % count);
}

/* A number of the kinds that arithmetic trips over. */
static inline double random_awkward(random_state *random)
{
    static const double special[] = {
        0.0,   -0.0,   1,      -1,      0.5,  -0.5, M_PI_2,  -M_PI_2,  M_PI,   -M_PI,   3,   -3,   INFINITY, -INFINITY,
        1e300, -1e300, 1e-310, -1e-310, 1e18, -1e6, DBL_MAX, -DBL_MAX, 1e-160, -1e-160, 1.5, -2.5, 2,        -2};
    switch (random_below(random, 4)) {
    case 0: return special[random_below(random, sizeof special / sizeof *special)];
    case 1: return random_between(random, -2, 2);
    case 2: return random_between(random, -20, 20);
    default: return ldexp(random_between(random, -1, 1), (int)random_below(random, 80) - 40);
    }
}

static inline hewn_interval random_interval(random_state *random)
{
    double a = random_awkward(random), b = random_awkward(random);
    switch (random_below(random, 4)) {
    case 0: b = a; break;
    case 1: b = a + fabs(a) * random_unit(random) * 0.01; break;
    case 2: b = a + random_unit(random); break;
    default: break;
    }
    if (isnan(b))
        b = a;
    return (hewn_interval){fmin(a, b), fmax(a, b), false};
}

/* A member of an interval: its ends, the zeros of both signs, or something between. */
static inline double random_member(random_state *random, hewn_interval in)
{
    double at;
    switch (random_below(random, 6)) {
    case 0: return in.lo;
    case 1: return in.hi;
    case 2: at = random_below(random, 2) ? 0.0 : -0.0; break;
    case 3: at = random_awkward(random); break;
    default: {
        double lo = fmax(in.lo, -DBL_MAX / 4), hi = fmin(in.hi, DBL_MAX / 4);
        at = random_between(random, lo, hi);
    }
    }
    return at >= in.lo && at <= in.hi ? at : random_below(random, 2) ? in.lo : in.hi;
}

static inline bool interval_has(hewn_interval in, double value)
{
    return isnan(value) ? in.maybe_nan : in.lo <= value && value <= in.hi;
}

/* Parameters that an operation accepts. */
static inline void random_parameters(random_state *random, hewn_op op, double *p)
{
    for (int i = 0; i < HEWN_MAX_PARAMETERS; i++)
        p[i] = random_between(random, 0.1, 1.5);
    if (op == HEWN_OP_CONSTANT)
        p[0] = random_between(random, -2, 2);
    if (op == HEWN_OP_AFFINE || op == HEWN_OP_PLANE)
        for (int i = 0; i < 4; i++)
            p[i] = random_below(random, 4) == 0 ? 0 : random_between(random, -2, 2);
    if (op >= HEWN_OP_NOISE_VALUE && op <= HEWN_OP_NOISE_CELLULAR)
        p[0] = random_below(random, 0x1000000u);
    if (op == HEWN_OP_CONE && random_below(random, 3) == 0)
        p[random_below(random, 2)] = 0;
    if (op == HEWN_OP_BLEND_EXPONENTIAL)
        p[0] = random_between(random, 0.5, 30);
    if (op == HEWN_OP_PLANE) {
        p[0] += 3;
        double length = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
        for (int i = 0; i < 3; i++)
            p[i] /= length;
    }
}

/* A graph of about `count` random operations; `calm` leaves out those that jump or leave the real numbers. */
static inline hewn_node random_graph(random_state *random, hewn_field *field, int count, bool calm)
{
    hewn_node nodes[256] = {hewn_x(field), hewn_y(field), hewn_z(field)};
    int have = 3;
    while (have < count && have < 256) {
        hewn_node_data data = {.op = (hewn_op)random_below(random, HEWN_OP_COUNT)};
        bool wild = data.op == HEWN_OP_SQRT || (data.op >= HEWN_OP_TAN && data.op <= HEWN_OP_ACOS) ||
                    (data.op >= HEWN_OP_EXP && data.op <= HEWN_OP_NOT) || data.op == HEWN_OP_DIV ||
                    (data.op >= HEWN_OP_MOD && data.op <= HEWN_OP_OR);
        wild = wild || data.op == HEWN_OP_NOISE_SIMPLEX; /* huge coordinates leave no digits to its lattice */
        if ((calm && wild) || hewn_op_is_link(data.op))
            continue;
        for (int k = 0; k < hewn_op_infos[data.op].operands; k++) {
            int recent = have < 12 ? have : 12;
            data.operand[k] = nodes[random_below(random, 4) ? have - 1 - (int)random_below(random, (uint32_t)recent)
                                                            : (int)random_below(random, (uint32_t)have)]
                                  .id;
        }
        random_parameters(random, data.op, data.parameter);
        nodes[have++] = hewn_field_add_node(field, &data);
    }
    return nodes[have - 1];
}

static inline hewn_field *new_field(void)
{
    hewn_field *field = NULL;
    assert_int_equal(hewn_field_create(&field, NULL), HEWN_OK);
    assert_non_null(field);
    return field;
}

/* Fails with the field's own words where a node could not be built. */
static inline void assert_field_ok(const hewn_field *field)
{
    hewn_error error = {0};
    if (hewn_field_status(field, &error) != HEWN_OK)
        fail_msg("%s", error.message);
}

static inline double value_at(const hewn_field *field, hewn_node node, double x, double y, double z)
{
    double value = 0;
    assert_int_equal(hewn_field_eval(field, node, (const double[3]){x, y, z}, 1, &value, NULL), HEWN_OK);
    return value;
}

/* How many times the usual work: long runs on request. */
static inline int effort(int usual)
{
    return getenv("HEWN_LONG") ? usual * 50 : usual;
}

#endif
