/* The shipped scenes written by hand as dense sampling in C: what a careful programmer without Hewn would time. */
#ifndef HEWN_BENCH_DENSE_H
#define HEWN_BENCH_DENSE_H

#include <stddef.h>

typedef struct dense_field {
    const char *name;
    float lo, hi; /* the cube that is sampled */
    /* Values of a row: x = x0 + i * step for i below count. */
    void (*row)(float x0, float step, size_t count, float y, float z, float *values);
    void (*points)(float lo, float step, size_t samples, float *values);
} dense_field;

/* One shape of assets/scenes/random.lua: local coordinates are rows of `frame` (three factors and a shift). */
typedef struct dense_shape {
    enum { DENSE_BALL, DENSE_BOX, DENSE_RING } kind;
    float frame[3][4];
    float size[3];
    float melt; /* with all shapes before it */
} dense_shape;

/* Fills samples^3 values of the shapes melted together in order, on all OpenMP threads. */
void dense_sample_heap(const dense_shape *shapes, size_t count, float lo, float hi, size_t samples, float *values);

extern const dense_field dense_csg, dense_gyroid, dense_menger4;

/* Fills samples^3 values, x fastest, on all OpenMP threads. */
void dense_sample(const dense_field *field, size_t samples, float *values);

/* The same by a function of a point that is called for each of them: nothing is shared that the compiler does not
 * see to. */
void dense_sample_points(const dense_field *field, size_t samples, float *values);

#endif
