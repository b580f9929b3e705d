#include "dense.h"

#include <math.h>

static void csg_row(float x0, float step, size_t count, float y, float z, float *values)
{
    for (size_t i = 0; i < count; i++) {
        float x = x0 + step * (float)i;
        float sphere = sqrtf(x * x + y * y + z * z) - 0.8f;
        float box = fmaxf(fmaxf(fabsf(x - 0.5f), fabsf(y - 0.5f)), fabsf(z - 0.5f)) - 0.45f;
        float cut = fmaxf(sphere, -box);
        float ring = sqrtf(x * x + y * y) - 0.7f;
        float torus = sqrtf(ring * ring + (z + 0.35f) * (z + 0.35f)) - 0.15f;
        float melt = fmaxf(0.2f - fabsf(cut - torus), 0.0f);
        values[i] = fminf(cut, torus) - melt * melt / 0.8f;
    }
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

const dense_field dense_csg = {"csg", -1.0f, 1.0f, csg_row};
const dense_field dense_gyroid = {"gyroid", -1.0f, 1.0f, gyroid_row};
const dense_field dense_menger4 = {"menger L=4", -1.2f, 1.2f, menger_row};

void dense_sample(const dense_field *field, size_t samples, float *values)
{
    float step = (field->hi - field->lo) / (float)(samples - 1);
#pragma omp parallel for schedule(static)
    for (size_t k = 0; k < samples; k++)
        for (size_t j = 0; j < samples; j++)
            field->row(field->lo, step, samples, field->lo + step * (float)j, field->lo + step * (float)k,
                       values + (k * samples + j) * samples);
}
