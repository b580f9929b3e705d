/* Lengths between points, boxes and rays, in float; those that bound something are rounded to the safe side. */
#include <math.h>

#include "query/internal.h"

#define BELOW (1 - 0x1p-20F)

float hewn_length_to_box(const float p[3], const float lo[3], const float hi[3])
{
    return hewn_length_between(p, p, lo, hi);
}

float hewn_length_between(const float alo[3], const float ahi[3], const float blo[3], const float bhi[3])
{
    float square = 0;
    for (int axis = 0; axis < 3; axis++) {
        float gap = fmaxf(fmaxf(blo[axis] - ahi[axis], alo[axis] - bhi[axis]), 0);
        square += gap * gap;
    }
    return sqrtf(square) * BELOW;
}

float hewn_ray_enters(const hewn_question *ray, const float lo[3], const float hi[3], float more, float *leave)
{
    float enter = ray->begin;
    *leave = ray->end;
    for (int axis = 0; axis < 3; axis++) {
        float a = (lo[axis] - more - ray->from[axis]) / ray->along[axis];
        float b = (hi[axis] + more - ray->from[axis]) / ray->along[axis];
        /* What rounding may do to the difference grows with the coordinates. */
        float error = 0x1p-22F * (fabsf(ray->from[axis]) + fabsf(lo[axis]) + fabsf(hi[axis])) / fabsf(ray->along[axis]);
        enter = fmaxf(enter, fminf(a, b) - error);
        *leave = fminf(*leave, fmaxf(a, b) + error);
    }
    return enter <= *leave ? enter : INFINITY;
}

float hewn_ray_meets_ball(const hewn_question *ray, const float middle[3], float radius)
{
    double along = 0, square = 0;
    for (int axis = 0; axis < 3; axis++) {
        double to = (double)middle[axis] - (double)ray->from[axis];
        along += to * (double)ray->along[axis];
        square += to * to;
    }
    double aside = square - along * along, half = (double)radius * (double)radius - aside;
    if (!(half >= 0))
        return INFINITY;
    double enter = along - sqrt(half), leave = along + sqrt(half);
    if (leave < (double)ray->begin || enter > (double)ray->end)
        return INFINITY;
    return (float)fmax(enter, (double)ray->begin);
}

float hewn_question_lower(const hewn_question *question, const float lo[3], const float hi[3])
{
    float leave, middle[3], half = 0;
    if (question->kind == HEWN_QUERY_NEAREST)
        return hewn_length_to_box(question->from, lo, hi);
    float enter = hewn_ray_enters(question, lo, hi, question->radius, &leave);
    if (question->kind == HEWN_QUERY_RAY || !(enter < INFINITY))
        return enter;
    for (int axis = 0; axis < 3; axis++) {
        middle[axis] = 0.5F * (lo[axis] + hi[axis]);
        half += (hi[axis] - lo[axis]) * (hi[axis] - lo[axis]);
    }
    half = 0.5F * sqrtf(half);
    float size = fabsf(middle[0]) + fabsf(middle[1]) + fabsf(middle[2]) + question->radius;
    return fmaxf(enter,
                 hewn_ray_meets_ball(question, middle, (question->radius + half) * (1 + 0x1p-20F) + 0x1p-20F * size));
}
