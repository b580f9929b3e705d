#include "dense.h"

#include <math.h>

/* A field at one point, and beside it a row of samples in which what they share is computed once. */
static inline float csg_at(float x, float y, float z)
{
    float sphere = sqrtf(x * x + y * y + z * z) - 0.8f;
    float box = fmaxf(fmaxf(fabsf(x - 0.5f), fabsf(y - 0.5f)), fabsf(z - 0.5f)) - 0.45f;
    float cut = fmaxf(sphere, -box);
    float ring = sqrtf(x * x + y * y) - 0.7f;
    float torus = sqrtf(ring * ring + (z + 0.35f) * (z + 0.35f)) - 0.15f;
    float melt = fmaxf(0.2f - fabsf(cut - torus), 0.0f);
    return fminf(cut, torus) - melt * melt / 0.8f;
}

static void csg_row(float x0, float step, size_t count, float y, float z, float *values)
{
    for (size_t i = 0; i < count; i++)
        values[i] = csg_at(x0 + step * (float)i, y, z);
}

static inline float gyroid_at(float x, float y, float z)
{
    float gyroid = sinf(12 * x) * cosf(12 * y) + sinf(12 * y) * cosf(12 * z) + sinf(12 * z) * cosf(12 * x);
    return fmaxf(fabsf(gyroid) - 0.4f, sqrtf(x * x + y * y + z * z) - 0.9f);
}

static void gyroid_row(float x0, float step, size_t count, float y, float z, float *values)
{
    float sy = sinf(12 * y), cy = cosf(12 * y), sz = sinf(12 * z), cz = cosf(12 * z);
    for (size_t i = 0; i < count; i++) {
        float x = x0 + step * (float)i;
        float gyroid = sinf(12 * x) * cy + sy * cz + sz * cosf(12 * x);
        values[i] = fmaxf(fabsf(gyroid) - 0.4f, sqrtf(x * x + y * y + z * z) - 0.9f);
    }
}

#define MENGER_LEVELS 4

/* The distance to the middle of the nearest of `holes` equal parts of [-1, 1]. */
static inline float hole_distance(float t, int holes)
{
    float nearest = fabsf(t - (-1.0f + 1.0f / (float)holes));
    for (int i = 1; i < holes; i++)
        nearest = fminf(nearest, fabsf(t - (-1.0f + (float)(2 * i + 1) / (float)holes)));
    return nearest;
}

static void menger_row(float x0, float step, size_t count, float y, float z, float *values)
{
    static const int holes[MENGER_LEVELS] = {1, 3, 9, 27};
    float dy[MENGER_LEVELS], dz[MENGER_LEVELS];
    for (int l = 0; l < MENGER_LEVELS; l++) {
        dy[l] = hole_distance(y, holes[l]);
        dz[l] = hole_distance(z, holes[l]);
    }
    float yz = fmaxf(fabsf(y), fabsf(z));
    for (size_t i = 0; i < count; i++) {
        float x = x0 + step * (float)i, drilled = 1e30f;
        float d[MENGER_LEVELS] = {hole_distance(x, 1), hole_distance(x, 3), hole_distance(x, 9), hole_distance(x, 27)};
        for (int l = 0; l < MENGER_LEVELS; l++) {
            float nearest = fminf(fminf(fmaxf(d[l], dy[l]), fmaxf(dy[l], dz[l])), fmaxf(dz[l], d[l]));
            drilled = fminf(drilled, nearest - 1.0f / (3.0f * (float)holes[l]));
        }
        values[i] = fmaxf(fmaxf(fabsf(x), yz) - 1.0f, -drilled);
    }
}

static inline float menger_at(float x, float y, float z)
{
    float drilled = 1e30f;
    for (int l = 0, holes = 1; l < MENGER_LEVELS; l++, holes *= 3) {
        float dx = hole_distance(x, holes), dy = hole_distance(y, holes), dz = hole_distance(z, holes);
        float nearest = fminf(fminf(fmaxf(dx, dy), fmaxf(dy, dz)), fmaxf(dz, dx));
        drilled = fminf(drilled, nearest - 1.0f / (3.0f * (float)holes));
    }
    return fmaxf(fmaxf(fmaxf(fabsf(x), fabsf(y)), fabsf(z)) - 1.0f, -drilled);
}

/* All samples, point by point. */
#define DEFINE_POINTS(NAME)                                                                                            \
    static void NAME##_points(float lo, float step, size_t samples, float *values)                                     \
    {                                                                                                                  \
        _Pragma("omp parallel for schedule(static)") for (size_t k = 0; k < samples; k++)                              \
        {                                                                                                              \
            for (size_t j = 0; j < samples; j++)                                                                       \
                for (size_t i = 0; i < samples; i++)                                                                   \
                    values[(k * samples + j) * samples + i] =                                                          \
                        NAME##_at(lo + step * (float)i, lo + step * (float)j, lo + step * (float)k);                   \
        }                                                                                                              \
    }

DEFINE_POINTS(csg)
DEFINE_POINTS(gyroid)
DEFINE_POINTS(menger)

const dense_field dense_csg = {"csg", -1.0f, 1.0f, csg_row, csg_points};
const dense_field dense_gyroid = {"gyroid", -1.0f, 1.0f, gyroid_row, gyroid_points};
const dense_field dense_menger4 = {"menger L=4", -1.2f, 1.2f, menger_row, menger_points};

static float step_of(const dense_field *field, size_t samples)
{
    return (field->hi - field->lo) / (float)(samples - 1);
}

void dense_sample(const dense_field *field, size_t samples, float *values)
{
    float step = step_of(field, samples);
#pragma omp parallel for schedule(static)
    for (size_t k = 0; k < samples; k++)
        for (size_t j = 0; j < samples; j++)
            field->row(field->lo, step, samples, field->lo + step * (float)j, field->lo + step * (float)k,
                       values + (k * samples + j) * samples);
}

void dense_sample_points(const dense_field *field, size_t samples, float *values)
{
    field->points(field->lo, step_of(field, samples), samples, values);
}

/* --- shapes melted together -------------------------------------------------------------------------------------- */

/* How far a shape is from a row of points: local coordinates are a start and a step for each point. */
static inline float ball(float a, float b, float c, const float *size)
{
    return sqrtf(a * a + b * b + c * c) - size[0];
}

static inline float box(float a, float b, float c, const float *size)
{
    float x = fabsf(a) - size[0], y = fabsf(b) - size[1], z = fabsf(c) - size[2];
    float p = fmaxf(x, 0), q = fmaxf(y, 0), r = fmaxf(z, 0);
    return sqrtf(p * p + q * q + r * r) + fminf(fmaxf(fmaxf(x, y), z), 0);
}

static inline float ring(float a, float b, float c, const float *size)
{
    float around = sqrtf(a * a + c * c) - size[0];
    return sqrtf(around * around + b * b) - size[1];
}

static inline float melted(float a, float b, float size)
{
    float h = fmaxf(size - fabsf(a - b), 0);
    return fminf(a, b) - 0.25f * h * h / size;
}

#define HEAP_LOOP(FUNCTION)                                                                                            \
    for (int i = 0; i < (int)count; i++) {                                                                             \
        float t = (float)i;                                                                                            \
        float d = FUNCTION(at[0] + step[0] * t, at[1] + step[1] * t, at[2] + step[2] * t, shape->size);                \
        values[i] = melted(values[i], d, shape->melt);                                                                 \
    }

static void melt_row(const dense_shape *shape, float x0, float pitch, size_t count, float y, float z, float *values)
{
    float at[3], step[3];
    for (int k = 0; k < 3; k++) {
        const float *f = shape->frame[k];
        at[k] = f[0] * x0 + f[1] * y + f[2] * z + f[3];
        step[k] = f[0] * pitch;
    }
    switch (shape->kind) {
    case DENSE_BALL: HEAP_LOOP(ball) break;
    case DENSE_BOX: HEAP_LOOP(box) break;
    default: HEAP_LOOP(ring)
    }
}

void dense_sample_heap(const dense_shape *shapes, size_t count, float lo, float hi, size_t samples, float *values)
{
    float step = (hi - lo) / (float)(samples - 1);
#pragma omp parallel for schedule(static)
    for (size_t k = 0; k < samples; k++)
        for (size_t j = 0; j < samples; j++) {
            float *row = values + (k * samples + j) * samples;
            for (size_t i = 0; i < samples; i++)
                row[i] = 1e18f;
            for (size_t s = 0; s < count; s++)
                melt_row(&shapes[s], lo, step, samples, lo + step * (float)j, lo + step * (float)k, row);
        }
}
