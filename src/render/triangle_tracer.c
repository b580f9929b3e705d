/* Rays against triangles, over the hierarchy of boxes. Light is asked for by rays to a disc, openness by how near
 * triangles are to points along the normal, so that meshes look like the fields they came from. */
#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "geom/bvh.h"
#include "render/tracer.h"

enum { TAPS = 5, RIM = 6, DISC = 18, STACK = 3 * HEWN_BVH_LEVELS + 1 };
#define FAR_AWAY 3.0e38F

typedef struct triangle_tracer {
    const hewn_triangles *triangles;
    hewn_triangle_view view;
    hewn_bvh bvh;
} triangle_tracer;

typedef struct place_in_tree {
    uint64_t block;
    uint32_t level;
    float near;
} place_in_tree;

/* --- rays -----------------------------------------------------------------------------------------------------------
 */

static const float *corner(const triangle_tracer *tracer, uint32_t triangle, uint32_t k)
{
    return tracer->triangles->positions + 3 * (size_t)tracer->triangles->indices[3 * (size_t)triangle + k];
}

/* Where a ray meets a triangle, by volumes in double, so that no ray slips through an edge that two triangles share
 * (Woop, Benthin and Wald 2013, there by shears); FAR_AWAY: not before `most`. */
static float meet_triangle(const triangle_tracer *tracer, uint32_t triangle, const hewn_ray *ray, float most,
                           double weights[3])
{
    double p[3][3], sum = 0, distance = 0;
    for (uint32_t k = 0; k < 3; k++)
        for (int axis = 0; axis < 3; axis++)
            p[k][axis] = (double)corner(tracer, triangle, k)[axis] - (double)ray->from[axis];
    for (int k = 0; k < 3; k++) {
        const double *a = p[(k + 1) % 3], *b = p[(k + 2) % 3];
        double volume = 0;
        for (int axis = 0; axis < 3; axis++) {
            int u = (axis + 1) % 3, v = (axis + 2) % 3;
            volume += (double)ray->along[axis] * (a[u] * b[v] - a[v] * b[u]);
        }
        weights[k] = volume;
        sum += volume;
    }
    bool front = weights[0] >= 0 && weights[1] >= 0 && weights[2] >= 0;
    bool back = weights[0] <= 0 && weights[1] <= 0 && weights[2] <= 0;
    if ((!front && !back) || sum == 0)
        return FAR_AWAY;
    for (int k = 0; k < 3; k++) {
        weights[k] /= sum;
        for (int axis = 0; axis < 3; axis++)
            distance += weights[k] * p[k][axis] * (double)ray->along[axis];
    }
    return distance > (double)ray->begin && distance < (double)most ? (float)distance : FAR_AWAY;
}

/* Where a ray enters each of four boxes; FAR_AWAY where it does not before `most`. NaN boxes are never entered. */
static void enter_boxes(const hewn_boxes4 *boxes, const hewn_ray *ray, const float turned[3], float most, float near[4])
{
    float end[4] = {most, most, most, most};
    for (int k = 0; k < 4; k++)
        near[k] = ray->begin;
    for (int axis = 0; axis < 3; axis++) {
        const float *from = turned[axis] < 0 ? boxes->hi[axis] : boxes->lo[axis];
        const float *to = turned[axis] < 0 ? boxes->lo[axis] : boxes->hi[axis];
        for (int k = 0; k < 4; k++) {
            float first = (from[k] - ray->from[axis]) * turned[axis], last = (to[k] - ray->from[axis]) * turned[axis];
            near[k] = first > near[k] ? first : near[k];
            end[k] = last < end[k] ? last : end[k];
        }
    }
    for (int k = 0; k < 4; k++) { /* rounding may take a ray off a box that it grazes */
        bool there = boxes->lo[0][k] <= boxes->hi[0][k];
        near[k] = there && near[k] <= end[k] + 4e-7F * (fabsf(end[k]) + fabsf(near[k])) ? near[k] : FAR_AWAY;
    }
}

/* The nearest triangle that a ray meets; with `any`, one that it meets. */
static float cast(const triangle_tracer *tracer, const hewn_ray *ray, bool any, uint32_t *triangle, double weights[3])
{
    const hewn_bvh *bvh = &tracer->bvh;
    float turned[3], nearest = ray->end;
    for (int axis = 0; axis < 3; axis++)
        turned[axis] = 1 / ray->along[axis];
    place_in_tree stack[STACK];
    uint32_t depth = 1;
    bool met = false;
    stack[0] = (place_in_tree){0, bvh->level_count - 1, 0};
    while (depth > 0) {
        place_in_tree at = stack[--depth];
        if (at.near > nearest)
            continue;
        float near[4];
        enter_boxes(&bvh->level[at.level][at.block], ray, turned, nearest, near);
        if (at.level == 0) {
            for (uint32_t k = 0; k < 4; k++) {
                double own[3];
                uint32_t which = bvh->order[4 * at.block + k];
                float t = near[k] < FAR_AWAY ? meet_triangle(tracer, which, ray, nearest, own) : FAR_AWAY;
                if (t >= FAR_AWAY)
                    continue;
                nearest = t;
                met = true;
                *triangle = which;
                memcpy(weights, own, sizeof own);
                if (any)
                    return t;
            }
            continue;
        }
        for (int turn = 0; turn < 4; turn++) { /* the farthest first, so that the nearest is looked at next */
            int farthest = 0;
            for (int k = 1; k < 4; k++)
                if (near[farthest] >= FAR_AWAY || (near[k] < FAR_AWAY && near[k] > near[farthest]))
                    farthest = k;
            if (near[farthest] >= FAR_AWAY)
                break;
            stack[depth++] = (place_in_tree){4 * at.block + (uint64_t)farthest, at.level - 1, near[farthest]};
            near[farthest] = FAR_AWAY;
        }
    }
    return met ? nearest : FAR_AWAY;
}

/* --- distances ------------------------------------------------------------------------------------------------------
 */

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The squared distance of a point to a triangle, by the part of its plane that the point is over (Ericson 2005, 5.1.5).
 */
static double triangle_distance(const triangle_tracer *tracer, uint32_t triangle, const float point[3])
{
    double a[3], ab[3], ac[3], ap[3];
    for (int axis = 0; axis < 3; axis++) {
        a[axis] = (double)corner(tracer, triangle, 0)[axis];
        ab[axis] = (double)corner(tracer, triangle, 1)[axis] - a[axis];
        ac[axis] = (double)corner(tracer, triangle, 2)[axis] - a[axis];
        ap[axis] = (double)point[axis] - a[axis];
    }
    double bb = dot(ab, ab), bc = dot(ab, ac), cc = dot(ac, ac), pb = dot(ap, ab), pc = dot(ap, ac);
    double determinant = bb * cc - bc * bc, u = cc * pb - bc * pc, v = bb * pc - bc * pb;
    if (!(determinant > 0 && u >= 0 && v >= 0 && u + v <= determinant)) { /* not over it: the nearest of its edges */
        double along = bb > 0 ? fmin(fmax(pb / bb, 0), 1) : 0, up = cc > 0 ? fmin(fmax(pc / cc, 0), 1) : 0;
        double side = bb - 2 * bc + cc, across = side > 0 ? fmin(fmax((bb - bc - pb + pc) / side, 0), 1) : 0;
        double places[3][2] = {{along, 0}, {0, up}, {1 - across, across}}, least = INFINITY;
        for (int k = 0; k < 3; k++) {
            double square = 0;
            for (int axis = 0; axis < 3; axis++) {
                double off = ap[axis] - places[k][0] * ab[axis] - places[k][1] * ac[axis];
                square += off * off;
            }
            least = fmin(least, square);
        }
        return least;
    }
    double square = 0;
    for (int axis = 0; axis < 3; axis++) {
        double off = ap[axis] - (u * ab[axis] + v * ac[axis]) / determinant;
        square += off * off;
    }
    return square;
}

/* The squared distances of a point to four boxes; infinite to those that are not there. */
static void box_distances(const hewn_boxes4 *boxes, const float point[3], float out[4])
{
    for (int k = 0; k < 4; k++)
        out[k] = boxes->lo[0][k] <= boxes->hi[0][k] ? 0 : FAR_AWAY;
    for (int axis = 0; axis < 3; axis++)
        for (int k = 0; k < 4; k++) {
            float under = boxes->lo[axis][k] - point[axis], over = point[axis] - boxes->hi[axis][k];
            float off = under > over ? under : over;
            out[k] += off > 0 ? off * off : 0;
        }
}

/* How far a point is from the nearest triangle, at most `most`: the nearest boxes first. */
static float distance_to(const triangle_tracer *tracer, const float point[3], float most)
{
    const hewn_bvh *bvh = &tracer->bvh;
    double least = (double)most * (double)most;
    place_in_tree stack[STACK];
    uint32_t depth = 1;
    stack[0] = (place_in_tree){0, bvh->level_count - 1, 0};
    while (depth > 0) {
        place_in_tree at = stack[--depth];
        float near[4];
        if ((double)at.near * (1 - 1e-5) >= least)
            continue;
        box_distances(&bvh->level[at.level][at.block], point, near);
        for (int turn = 0; turn < 4; turn++) { /* the farthest first, so that the nearest is looked at next */
            int farthest = 0;
            for (int k = 1; k < 4; k++)
                if (near[farthest] < 0 || near[k] > near[farthest])
                    farthest = k;
            float off = near[farthest];
            near[farthest] = -1;
            if ((double)off * (1 - 1e-5) >= least)
                continue;
            if (at.level > 0)
                stack[depth++] = (place_in_tree){4 * at.block + (uint64_t)farthest, at.level - 1, off};
            else
                least = fmin(least, triangle_distance(tracer, bvh->order[4 * at.block + (uint64_t)farthest], point));
        }
    }
    return (float)sqrt(least);
}

/* --- shading --------------------------------------------------------------------------------------------------------
 */

/* Numbers from 0 to 1 that are spread evenly over neighbours (Jimenez 2014, interleaved gradient noise). */
static float dither(size_t number)
{
    double x = (double)(number % 8), y = (double)(number / 8 % 8), v = 52.9829189 * (0.06711056 * x + 0.00583715 * y);
    v -= floor(v);
    return (float)v;
}

/* Rays to the rim of the light tell whether it is seen in whole or not at all; only else all of its disc is asked. */
static float light_at(const triangle_tracer *tracer, const hewn_stage *stage, const float p[3], float turn)
{
    const float *light = stage->light;
    float aside[3] = {0, 0, 0}, across[3], length = 0;
    int least = fabsf(light[0]) < fabsf(light[1]) ? 0 : 1;
    least = fabsf(light[2]) < fabsf(light[least]) ? 2 : least;
    aside[least] = 1;
    for (int axis = 0; axis < 3; axis++)
        aside[axis] -= light[least] * light[axis];
    for (int axis = 0; axis < 3; axis++)
        length += aside[axis] * aside[axis];
    for (int axis = 0; axis < 3; axis++)
        aside[axis] /= sqrtf(length);
    for (int axis = 0; axis < 3; axis++)
        across[axis] = light[(axis + 1) % 3] * aside[(axis + 2) % 3] - light[(axis + 2) % 3] * aside[(axis + 1) % 3];
    int seen = 0, asked = 0;
    for (int i = 0; i < RIM + DISC; i++) {
        if (i == RIM && (seen == 0 || seen == RIM))
            break;
        bool rim = i < RIM;
        float angle = rim ? (float)i / RIM * 6.2831853F : (float)(i - RIM) * 2.3999632F + 6.2831853F * turn;
        float radius = stage->softness * 0.6F * (rim ? 1 : sqrtf(((float)(i - RIM) + 0.5F) / DISC));
        hewn_ray ray = {.end = FAR_AWAY};
        uint32_t triangle;
        double weights[3];
        for (int axis = 0; axis < 3; axis++) {
            float along = light[axis] + radius * (cosf(angle) * aside[axis] + sinf(angle) * across[axis]);
            ray.from[axis] = p[axis];
            ray.along[axis] = fabsf(along) < 1e-12F ? 1e-12F : along;
        }
        if (i == RIM)
            seen = 0;
        seen += cast(tracer, &ray, true, &triangle, weights) >= FAR_AWAY;
        asked = rim ? RIM : DISC;
    }
    return (float)seen / (float)asked;
}

/* From the highest point down: balls that touch the surface here lie in one another, so below an empty one all are. */
static float openness_at(const triangle_tracer *tracer, const hewn_stage *stage, const float p[3],
                         const float normal[3])
{
    static const float weights[TAPS] = {1, 0.7F, 0.49F, 0.343F, 0.2401F};
    float taken = 0, all = 0;
    bool empty = false;
    for (int tap = TAPS; tap >= 1; tap--) {
        float height = stage->reach * (float)(tap * tap) / (TAPS * TAPS), q[3];
        for (int axis = 0; axis < 3; axis++)
            q[axis] = p[axis] + height * normal[axis];
        float free = empty ? height : distance_to(tracer, q, 0.97F * height) / 0.97F;
        empty = free >= height * 0.9999F;
        taken += weights[tap - 1] * fmaxf(height - free, 0);
        all += weights[tap - 1] * height;
    }
    return 1 - taken / all;
}

static void meet_ground(const hewn_stage *stage, const hewn_ray *ray, hewn_met *met)
{
    uint32_t up = stage->up;
    float t = (stage->ground - ray->from[up]) / ray->along[up];
    if (!(stage->flags & HEWN_TRACE_GROUND) || !(t > ray->begin) || !(t < met->t) || !(t < ray->end))
        return;
    *met = (hewn_met){.t = t, .light = 1, .openness = 1, .what = HEWN_MET_GROUND};
    met->normal[up] = ray->from[up] > stage->ground ? 1 : -1;
}

/* The mean of the corners' normals where there are any, else the triangle's, turned to the viewer; `flat` is the
 * triangle's own. */
static void find_normal(const triangle_tracer *tracer, uint32_t triangle, const double weights[3], const hewn_ray *ray,
                        float out[3], float flat[3])
{
    const float *p[3] = {corner(tracer, triangle, 0), corner(tracer, triangle, 1), corner(tracer, triangle, 2)};
    double n[3], m[3] = {0, 0, 0}, length = 0, smooth = 0, facing = 0;
    for (int axis = 0; axis < 3; axis++) {
        int u = (axis + 1) % 3, v = (axis + 2) % 3;
        n[axis] = ((double)p[1][u] - (double)p[0][u]) * ((double)p[2][v] - (double)p[0][v]) -
                  ((double)p[1][v] - (double)p[0][v]) * ((double)p[2][u] - (double)p[0][u]);
        length += n[axis] * n[axis];
        facing += n[axis] * (double)ray->along[axis];
        for (uint32_t k = 0; k < 3 && tracer->triangles->normals; k++)
            m[axis] += weights[k] *
                       (double)tracer->triangles
                           ->normals[3 * (size_t)tracer->triangles->indices[3 * (size_t)triangle + k] + (size_t)axis];
        smooth += m[axis] * m[axis];
    }
    double sign = facing > 0 ? -1 : 1, agree = dot(n, m) < 0 ? -1 : 1;
    for (int axis = 0; axis < 3; axis++) {
        flat[axis] = length > 0 ? (float)(sign * n[axis] / sqrt(length)) : -ray->along[axis];
        out[axis] = smooth > 1e-6 ? (float)(sign * agree * m[axis] / sqrt(smooth)) : flat[axis];
    }
}

/* Between the corners of the triangle. */
static void take_color(const hewn_stage *stage, uint32_t triangle, const double weights[3], size_t number)
{
    const float *corners = stage->corner_colors + 9 * (size_t)triangle;
    for (int i = 0; i < 3; i++) {
        double sum = 0;
        for (int k = 0; k < 3; k++)
            sum += weights[k] * (double)corners[3 * k + i];
        stage->colors[3 * number + (size_t)i] = (float)sum;
    }
}

static void trace_one(const triangle_tracer *tracer, const hewn_stage *stage, const hewn_ray *ray, size_t number,
                      hewn_met *met)
{
    uint32_t triangle = 0;
    double weights[3] = {0};
    float t = cast(tracer, ray, false, &triangle, weights), flat[3] = {0};
    *met = (hewn_met){.t = t, .light = 1, .openness = 1};
    met->what = t < FAR_AWAY ? HEWN_MET_SURFACE : HEWN_MET_NOTHING;
    if (met->what == HEWN_MET_SURFACE)
        find_normal(tracer, triangle, weights, ray, met->normal, flat);
    if (met->what == HEWN_MET_SURFACE && stage->corner_colors)
        take_color(stage, triangle, weights, number);
    meet_ground(stage, ray, met);
    if (met->what == HEWN_MET_GROUND)
        memcpy(flat, met->normal, sizeof flat);
    if (met->what == HEWN_MET_NOTHING || !(stage->flags & HEWN_TRACE_SHADE))
        return;
    float p[3], facing = 0;
    for (int axis = 0; axis < 3; axis++) {
        float off = 3 * (stage->nearness + stage->spread * met->t);
        p[axis] = ray->from[axis] + met->t * ray->along[axis] + off * flat[axis];
        facing += flat[axis] * stage->light[axis];
    }
    met->light = facing > 0 ? light_at(tracer, stage, p, dither(number)) : 0;
    met->openness = openness_at(tracer, stage, p, met->normal);
}

static hewn_result trace(void *self, const hewn_stage *stage, const hewn_ray *rays, size_t count, hewn_met *met,
                         hewn_error *error)
{
    const triangle_tracer *tracer = self;
    (void)error;
#pragma omp parallel for schedule(dynamic, 256)
    for (size_t i = 0; i < count; i++)
        trace_one(tracer, stage, &rays[i], i, &met[i]);
    return HEWN_OK;
}

static void destroy(void *self)
{
    triangle_tracer *tracer = self;
    hewn_bvh_free(&tracer->bvh);
    hewn_free(tracer);
}

static hewn_result check(const hewn_triangles *triangles, hewn_box *box, hewn_error *error)
{
    if (triangles->triangle_count == 0)
        return hewn_fail(error, HEWN_BAD_INPUT, "there are no faces to see");
    *box = (hewn_box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (uint64_t i = 0; i < 3 * triangles->triangle_count; i++) {
        uint32_t vertex = triangles->indices[i];
        if (vertex >= triangles->vertex_count)
            return hewn_fail(error, HEWN_BAD_INPUT, "face %llu has vertex %u of %llu", (unsigned long long)(i / 3),
                             vertex, (unsigned long long)triangles->vertex_count);
        for (int axis = 0; axis < 3; axis++) {
            double at = (double)triangles->positions[3 * (size_t)vertex + (size_t)axis];
            if (!isfinite(at))
                return hewn_fail(error, HEWN_BAD_INPUT, "the position of vertex %u is not finite", vertex);
            box->lo[axis] = fmin(box->lo[axis], at);
            box->hi[axis] = fmax(box->hi[axis], at);
        }
    }
    return HEWN_OK;
}

hewn_result hewn_tracer_of_triangles(const hewn_triangles *triangles, hewn_tracer *out, hewn_box *box,
                                     hewn_error *error)
{
    *out = (hewn_tracer){0};
    HEWN_TRY(check(triangles, box, error));
    triangle_tracer *tracer = hewn_alloc_zero(1, sizeof *tracer);
    if (!tracer)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a renderer");
    tracer->triangles = triangles;
    tracer->view = (hewn_triangle_view){.vertex_count = triangles->vertex_count,
                                        .triangle_count = triangles->triangle_count,
                                        .floats = triangles->positions,
                                        .corners = triangles->indices};
    hewn_result result = hewn_bvh_build(&tracer->view, &tracer->bvh, error);
    if (result != HEWN_OK)
        hewn_free(tracer);
    else
        *out = (hewn_tracer){.self = tracer, .on_host = true, .trace = trace, .destroy = destroy};
    return result;
}
