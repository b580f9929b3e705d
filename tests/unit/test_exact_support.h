/* Rational numbers for the tests of exact predicates: points, differences and determinants without any rounding. */
#ifndef HEWN_TEST_EXACT_SUPPORT_H
#define HEWN_TEST_EXACT_SUPPORT_H

#include <gmp.h>

#include "test_mesh_support.h"

typedef struct rational_point {
    mpq_t at[3];
} rational_point;

static inline void open_point(rational_point *p)
{
    for (int i = 0; i < 3; i++)
        mpq_init(p->at[i]);
}

static inline void close_point(rational_point *p)
{
    for (int i = 0; i < 3; i++)
        mpq_clear(p->at[i]);
}

static inline void set_point(rational_point *p, const double at[3])
{
    for (int i = 0; i < 3; i++)
        mpq_set_d(p->at[i], at[i]);
}

static inline void subtract_points(rational_point *out, const rational_point *a, const rational_point *b)
{
    for (int i = 0; i < 3; i++)
        mpq_sub(out->at[i], a->at[i], b->at[i]);
}

/* out = a b - c d; out is none of them. */
static inline void cross_term(mpq_t out, const mpq_t a, const mpq_t b, const mpq_t c, const mpq_t d)
{
    mpq_t other;
    mpq_init(other);
    mpq_mul(out, a, b);
    mpq_mul(other, c, d);
    mpq_sub(out, out, other);
    mpq_clear(other);
}

/* out = a × b; out is neither. */
static inline void cross_points(rational_point *out, const rational_point *a, const rational_point *b)
{
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        cross_term(out->at[i], a->at[j], b->at[k], a->at[k], b->at[j]);
    }
}

static inline void dot_points(mpq_t out, const rational_point *a, const rational_point *b)
{
    mpq_t product;
    mpq_init(product);
    mpq_set_ui(out, 0, 1);
    for (int i = 0; i < 3; i++) {
        mpq_mul(product, a->at[i], b->at[i]);
        mpq_add(out, out, product);
    }
    mpq_clear(product);
}

/* How much longer tests run where HEWN_LONG is set. */
static inline int effort(int usual, int times)
{
    return getenv("HEWN_LONG") ? usual * times : usual;
}

/* A double moved by a few units in its last place. */
static inline double nudge(random_state *random, double value)
{
    for (uint32_t steps = random_below(random, 4); steps > 0; steps--)
        value = nextafter(value, random_bits(random) & 1 ? INFINITY : -INFINITY);
    return value;
}

#endif
