/* Vectors of floats, written as shaders write them, for the host's twins of kernels. The fourth lane of what is a place
 * or a direction is 0. Private to these. */
#ifndef HEWN_SRC_ISO_HOST_VECTOR_H
#define HEWN_SRC_ISO_HOST_VECTOR_H

#include <math.h>

#include "hewn/base.h"

typedef float vec __attribute__((vector_size(16)));

static inline vec vec3(float x, float y, float z)
{
    return (vec){x, y, z, 0};
}

static inline vec vec_load(const float *from)
{
    return (vec){from[0], from[1], from[2], 0};
}

static inline float dot3(vec a, vec b)
{
    vec product = a * b;
    return product[0] + product[1] + product[2];
}

static inline float length3(vec a)
{
    return sqrtf(dot3(a, a));
}

static inline vec cross3(vec a, vec b)
{
    return (vec){a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0], 0};
}

/* As in shaders, what is not a number counts as the bound. */
static inline float least(float a, float b)
{
    return b < a ? b : a;
}

static inline float most(float a, float b)
{
    return a < b ? b : a;
}

static inline float clamp1(float a, float lo, float hi)
{
    return least(most(a, lo), hi);
}

static inline vec clamp3(vec a, vec lo, vec hi)
{
    return vec3(clamp1(a[0], lo[0], hi[0]), clamp1(a[1], lo[1], hi[1]), clamp1(a[2], lo[2], hi[2]));
}

/* Whether a lies between lo and hi in all lanes; false where something is not a number. */
static inline bool within3(vec a, vec lo, vec hi)
{
    return a[0] >= lo[0] && a[1] >= lo[1] && a[2] >= lo[2] && a[0] <= hi[0] && a[1] <= hi[1] && a[2] <= hi[2];
}

#endif
