#include <math.h>
#include <string.h>

#include "query/internal.h"

enum { NEWTON_STEPS = 12, APPROACH_STEPS = 24, HALVINGS = 40 };

hewn_result hewn_asker_create(const hewn_query *query, hewn_asker *out, hewn_error *error)
{
    *out = (hewn_asker){.query = query};
    return hewn_lane_work_create(query->octree.whole, &out->work, error);
}

void hewn_asker_destroy(hewn_asker *asker)
{
    hewn_lane_work_destroy(&asker->work);
}

bool hewn_query_holds(const hewn_query *query, const float p[3])
{
    const hewn_cell *root = query->octree.cells;
    bool in = true;
    for (int axis = 0; axis < 3; axis++)
        in = in && p[axis] >= root->lo[axis] && p[axis] <= root->hi[axis];
    return in;
}

const hewn_lane_tape *hewn_query_tape_at(const hewn_query *query, const float p[3])
{
    return hewn_query_holds(query, p) ? hewn_octree_find(&query->octree, p)->tape : query->octree.whole;
}

/* --- values ---------------------------------------------------------------------------------------------------------
 */

float hewn_ask_value(hewn_asker *asker, const float p[3])
{
    hewn_lane_points points;
    float values[HEWN_LANES];
    for (int axis = 0; axis < 3; axis++)
        for (int i = 0; i < HEWN_LANE_BLOCK; i++)
            points.at[axis][i] = p[axis];
    hewn_lanes_value(hewn_query_tape_at(asker->query, p), &asker->work, &points, HEWN_LANE_BLOCK, values);
    return values[0];
}

float hewn_ask_gradient(hewn_asker *asker, const float p[3], float gradient[3])
{
    hewn_lane_points points;
    float values[HEWN_LANES], gradients[3][HEWN_LANES];
    for (int axis = 0; axis < 3; axis++)
        points.at[axis][0] = p[axis];
    hewn_lanes_gradient(hewn_query_tape_at(asker->query, p), &asker->work, &points, 1, values, gradients);
    for (int axis = 0; axis < 3; axis++)
        gradient[axis] = gradients[axis][0];
    return values[0];
}

static void between(const float a[3], const float b[3], float share, float out[3])
{
    for (int axis = 0; axis < 3; axis++)
        out[axis] = a[axis] + share * (b[axis] - a[axis]);
}

/* One of the halves in turn, until the part is shorter than anything that is told apart. */
static void halve(hewn_asker *asker, const float a[3], const float b[3], float *outside, float *inside)
{
    float length = hewn_apart(a, b);
    for (int i = 0; i < HALVINGS && (*inside - *outside) * length > 0.25F * asker->query->fine; i++) {
        float p[3], middle = 0.5F * (*outside + *inside);
        between(a, b, middle, p);
        *(hewn_ask_value(asker, p) <= 0 ? inside : outside) = middle;
    }
}

/* Values at the points of hewn_ask_entry(), all at once where one tape serves them. */
static void row_of_values(hewn_asker *asker, const float a[3], const float b[3], float values[HEWN_LANES])
{
    const hewn_query *query = asker->query;
    hewn_lane_points points;
    bool in = hewn_query_holds(query, a) && hewn_query_holds(query, b);
    bool alike = in && hewn_octree_find(&query->octree, a) == hewn_octree_find(&query->octree, b);
    for (int i = 0; i < HEWN_LANE_BLOCK; i++) {
        float p[3];
        between(a, b, (float)i / (HEWN_LANE_BLOCK - 1), p);
        for (int axis = 0; axis < 3; axis++)
            points.at[axis][i] = p[axis];
        if (!alike)
            values[i] = hewn_ask_value(asker, p);
    }
    if (alike)
        hewn_lanes_value(hewn_query_tape_at(query, a), &asker->work, &points, HEWN_LANE_BLOCK, values);
}

bool hewn_ask_entry(hewn_asker *asker, const float a[3], const float b[3], float *outside, float *inside)
{
    float values[HEWN_LANES];
    row_of_values(asker, a, b, values);
    for (int i = 0; i < HEWN_LANE_BLOCK; i++) {
        float share = (float)i / (HEWN_LANE_BLOCK - 1);
        if (!(values[i] <= 0))
            continue;
        *inside = share;
        *outside = (float)(i - 1) / (HEWN_LANE_BLOCK - 1);
        if (i > 0)
            halve(asker, a, b, outside, inside);
        return true;
    }
    return false;
}

/* --- the surface ----------------------------------------------------------------------------------------------------
 */

static bool unit(float v[3])
{
    float size = fmaxf(fabsf(v[0]), fmaxf(fabsf(v[1]), fabsf(v[2])));
    if (!(size > 0) || !(size < INFINITY))
        return false;
    for (int axis = 0; axis < 3; axis++)
        v[axis] /= size;
    float length = sqrtf(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int axis = 0; axis < 3; axis++)
        v[axis] /= length;
    return true;
}

/* Whether the field is above 0 a little outwards and not a little inwards. */
static bool changes(hewn_asker *asker, const float p[3], const float normal[3])
{
    float out[3], in[3], little = 0.5F * asker->query->fine;
    for (int axis = 0; axis < 3; axis++) {
        out[axis] = p[axis] + little * normal[axis];
        in[axis] = p[axis] - little * normal[axis];
    }
    return hewn_query_holds(asker->query, out) && hewn_query_holds(asker->query, in) &&
           hewn_ask_value(asker, out) > 0 && hewn_ask_value(asker, in) <= 0;
}

bool hewn_ask_project(hewn_asker *asker, float p[3], float most, float normal[3])
{
    float left = most;
    for (int i = 0; i < NEWTON_STEPS; i++) {
        float g[3], value = hewn_ask_gradient(asker, p, g);
        float square = g[0] * g[0] + g[1] * g[1] + g[2] * g[2], step = fabsf(value) / sqrtf(square);
        if (!(square > 0) || !isfinite(step) || step > left)
            return false;
        left -= step;
        for (int axis = 0; axis < 3; axis++) {
            p[axis] -= value / square * g[axis];
            normal[axis] = g[axis];
        }
        if (step < 0.1F * asker->query->fine)
            break;
    }
    return unit(normal) && changes(asker, p, normal);
}

void hewn_ask_approach(hewn_asker *asker, const float to[3], float p[3], float normal[3])
{
    float share = 1, nearest = hewn_apart(to, p);
    for (int i = 0; i < APPROACH_STEPS && share > 0.05F; i++) {
        float next[3], turned[3], out = 0, length = 0;
        for (int axis = 0; axis < 3; axis++)
            out += (to[axis] - p[axis]) * normal[axis];
        for (int axis = 0; axis < 3; axis++) {
            float along = to[axis] - p[axis] - out * normal[axis];
            length += along * along;
            next[axis] = p[axis] + share * along;
        }
        length = sqrtf(length);
        if (length < 0.5F * asker->query->fine)
            return;
        bool reached = hewn_ask_project(asker, next, 2 * share * length, turned);
        if (!reached || !(hewn_apart(to, next) < nearest)) {
            share *= 0.4F;
            continue;
        }
        nearest = hewn_apart(to, next);
        memcpy(p, next, sizeof next);
        memcpy(normal, turned, sizeof turned);
    }
}
