/* Rays on the host, many at once: those in cells of the same tape go on together, by steps that interval bounds prove
 * free of surface. What a ray does is what shaders/render/trace.glsl does by intervals. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "render/octree.h"
#include "render/slopes.h"
#include "render/tracer.h"

enum { PACK = 1024, TAPS = 5 };
#define FAR_AWAY 3.0e38F

typedef struct host_tracer {
    hewn_octree octree;
    hewn_box box;
    float slope;
    float steepness;    /* no slope is more: rays go on by values over that; 0: by `slopes` */
    hewn_slopes slopes; /* where these tell none, by interval bounds */
    float slack;        /* rounding errors of values are below this */
} host_tracer;

/* A ray under way. */
typedef struct walker {
    const hewn_ray *ray;
    const hewn_cell *cell;
    float t, begin, end, stride, after;
    float free, sure, lean, steepness; /* of the step that led to t, see trace_together() */
    uint32_t steps;
    bool met, ran_out, asks, by_boxes;
} walker;

/* A point, or a ray, and whose tape it needs. */
typedef struct wanting {
    uint32_t owner;
    uint32_t number;
} wanting;

/* What a thread has. */
typedef struct crew {
    const host_tracer *tracer;
    const hewn_stage *stage;
    hewn_lane_work work;
    uint32_t *waiting; /* one for each cell, 0 but while items are put in order */
    wanting items[PACK * TAPS], sorted[PACK * TAPS];
} crew;

static void place(const hewn_ray *ray, float t, float out[3])
{
    for (int axis = 0; axis < 3; axis++)
        out[axis] = ray->from[axis] + t * ray->along[axis];
}

/* The part of a ray in a box. */
static void clip(const float lo[3], const float hi[3], const hewn_ray *ray, float *begin, float *end)
{
    for (int axis = 0; axis < 3; axis++) {
        float a = (lo[axis] - ray->from[axis]) / ray->along[axis], b = (hi[axis] - ray->from[axis]) / ray->along[axis];
        float first = a < b ? a : b, last = a < b ? b : a;
        *begin = first > *begin ? first : *begin;
        *end = last < *end ? last : *end;
    }
}

static float enough(const hewn_stage *stage, float t)
{
    return stage->nearness + stage->spread * t;
}

/* --- values at points -----------------------------------------------------------------------------------------------
 */

/* Points by the tape that is enough for them; `each` is called with up to HEWN_LANES of them, by number. */
typedef void visit(crew *c, const hewn_lane_tape *tape, const hewn_lane_points *points, const uint32_t *which,
                   uint32_t count, void *out);

static void fill_up(hewn_lane_points *points, uint32_t *count)
{
    uint32_t last = *count - 1;
    for (; *count % HEWN_LANE_BLOCK != 0; ++*count)
        for (int axis = 0; axis < 3; axis++)
            points->at[axis][*count] = points->at[axis][last];
}

/* Items of one owner after another, owners as they come first. */
static void put_together(crew *c, uint32_t count)
{
    const wanting *items = c->items;
    uint32_t owners[PACK * TAPS], owner_count = 0, place = 0, *waiting = c->waiting;
    for (uint32_t i = 0; i < count; i++)
        if (waiting[items[i].owner]++ == 0)
            owners[owner_count++] = items[i].owner;
    for (uint32_t i = 0; i < owner_count; i++) {
        uint32_t length = waiting[owners[i]];
        waiting[owners[i]] = place;
        place += length;
    }
    for (uint32_t i = 0; i < count; i++)
        c->sorted[waiting[items[i].owner]++] = items[i];
    for (uint32_t i = 0; i < owner_count; i++)
        waiting[owners[i]] = 0;
}

/* How many after `first` want the same tape, at most as many as there are lanes. */
static uint32_t run_of(const wanting *sorted, uint32_t first, uint32_t count)
{
    uint32_t end = first + 1;
    while (end < count && end - first < HEWN_LANES && sorted[end].owner == sorted[first].owner)
        end++;
    return end - first;
}

static const hewn_lane_tape *tape_of(const crew *c, uint32_t owner)
{
    return c->tracer->octree.cells[owner].tape;
}

/* Those of the points that `wanted` says, all where it is NULL. */
static void visit_points(crew *c, const float (*p)[3], const uint8_t *wanted, uint32_t count, visit *each, void *out)
{
    const wanting *sorted = c->sorted;
    uint32_t which[HEWN_LANES], left = 0;
    for (uint32_t i = 0; i < count; i++)
        if (!wanted || wanted[i])
            c->items[left++] = (wanting){hewn_octree_reach(&c->tracer->octree, &c->work, p[i])->owner, i};
    put_together(c, left);
    for (uint32_t first = 0, taken; first < left; first += taken) {
        hewn_lane_points points;
        taken = run_of(sorted, first, left);
        for (uint32_t i = 0; i < taken; i++) {
            which[i] = sorted[first + i].number;
            for (int axis = 0; axis < 3; axis++)
                points.at[axis][i] = p[which[i]][axis];
        }
        each(c, tape_of(c, sorted[first].owner), &points, which, taken, out);
    }
}

static void take_values(crew *c, const hewn_lane_tape *tape, const hewn_lane_points *points, const uint32_t *which,
                        uint32_t count, void *out)
{
    hewn_lane_points all = *points;
    float values[HEWN_LANES];
    uint32_t lanes = count;
    fill_up(&all, &lanes);
    hewn_lanes_value(tape, &c->work, &all, lanes, values);
    for (uint32_t i = 0; i < count; i++)
        ((float *)out)[which[i]] = values[i];
}

static void take_gradients(crew *c, const hewn_lane_tape *tape, const hewn_lane_points *points, const uint32_t *which,
                           uint32_t count, void *out)
{
    float values[HEWN_LANES], gradients[3][HEWN_LANES];
    hewn_lanes_gradient(tape, &c->work, points, count, values, gradients);
    for (uint32_t i = 0; i < count; i++) {
        float *to = (float *)out + 4 * (size_t)which[i];
        to[0] = values[i];
        for (int axis = 0; axis < 3; axis++)
            to[axis + 1] = gradients[axis][i];
    }
}

/* --- marching -------------------------------------------------------------------------------------------------------
 */

/* Passes empty cells; false where the ray is at its end. */
static bool find_cell(crew *c, walker *w)
{
    const hewn_octree *octree = &c->tracer->octree;
    for (uint32_t i = 0; i < 4 * HEWN_SKIP_STEPS && w->t < w->end; i++) {
        float p[3], begin = 0, end = FAR_AWAY;
        place(w->ray, w->t, p);
        w->cell = hewn_octree_reach(octree, &c->work, p);
        clip(w->cell->lo, w->cell->hi, w->ray, &begin, &end);
        w->after = (end > w->t ? end : w->t) + 0.5F * octree->margin;
        w->after = w->after < w->end ? w->after : w->end;
        if (w->cell->state != HEWN_CELL_EMPTY) {
            w->after = fminf(w->after, w->t + w->stride);
            return true;
        }
        w->t = w->after;
        w->begin = w->t; /* what is before is free */
    }
    return false;
}

static void box_step(const walker *w, hewn_lane_boxes *boxes, uint32_t lane)
{
    float a[3], b[3];
    place(w->ray, w->t, a);
    place(w->ray, w->after, b);
    for (int axis = 0; axis < 3; axis++) {
        float error = 5e-7F * fmaxf(fabsf(a[axis]), fabsf(b[axis]));
        boxes->lo[axis][lane] = fminf(a[axis], b[axis]) - error;
        boxes->hi[axis][lane] = fmaxf(a[axis], b[axis]) + error;
    }
}

static void take_step(const crew *c, walker *w, float lo)
{
    float stride = w->after - w->t, near_enough = enough(c->stage, w->t);
    w->steps++;
    w->asks = false;
    if (lo > 0) {
        w->t = w->after;
        w->stride = 2 * fmaxf(stride, near_enough);
    } else if (stride > near_enough) {
        w->stride = fmaxf(0.4F * stride, 0.9F * near_enough);
    } else {
        w->asks = true;
    }
}

/* Of so short a way no more is proven than that its end is outside. */
static void ask_values(crew *c, const hewn_lane_tape *tape, walker *const *group, uint32_t count)
{
    hewn_lane_points points;
    float values[HEWN_LANES];
    walker *asking[HEWN_LANES];
    uint32_t left = 0;
    for (uint32_t i = 0; i < count; i++) {
        float p[3];
        if (!group[i]->asks)
            continue;
        place(group[i]->ray, group[i]->after, p);
        for (int axis = 0; axis < 3; axis++)
            points.at[axis][left] = p[axis];
        asking[left++] = group[i];
    }
    if (left == 0)
        return;
    uint32_t lanes = left;
    fill_up(&points, &lanes);
    hewn_lanes_value(tape, &c->work, &points, lanes, values);
    for (uint32_t i = 0; i < left; i++) {
        asking[i]->met = values[i] <= 0;
        asking[i]->t = asking[i]->met ? asking[i]->t : asking[i]->after;
    }
}

/* One step of walkers that share a tape. */
static void step_together(crew *c, const hewn_lane_tape *tape, walker *const *group, uint32_t count)
{
    hewn_lane_boxes boxes;
    float lo[HEWN_LANES], hi[HEWN_LANES];
    uint32_t lanes = (count + HEWN_LANE_BLOCK - 1) / HEWN_LANE_BLOCK * HEWN_LANE_BLOCK;
    for (uint32_t i = 0; i < lanes; i++)
        box_step(group[i < count ? i : count - 1], &boxes, i);
    hewn_lanes_bound(tape, &c->work, &boxes, lanes, lo, hi);
    for (uint32_t i = 0; i < count; i++)
        take_step(c, group[i], lo[i]);
    ask_values(c, tape, group, count);
}

/* Back to where the last sphere ends, or what is on the surface: so far the way is free whatever is farther on. */
static void step_back(walker *w)
{
    w->t += w->sure - w->stride;
    w->stride = w->sure;
    w->lean = -1;
}

/* Whether nothing can be between the last place and this one, where the surface is not within `radius`. */
static bool is_proven(const walker *w, float radius)
{
    return w->stride <= w->sure || w->stride <= w->free + radius;
}

/* Passes empty cells by spheres; false where the ray is at its end. */
static bool find_cell_of_sphere(crew *c, walker *w)
{
    const hewn_octree *octree = &c->tracer->octree;
    for (uint32_t i = 0; i < 4 * HEWN_SKIP_STEPS; i++) {
        float p[3], begin = 0, end = FAR_AWAY;
        if (w->t >= w->end && w->stride <= w->sure)
            return false;
        if (w->t >= w->end) {
            step_back(w);
            continue;
        }
        place(w->ray, w->t, p);
        w->cell = hewn_octree_reach(octree, &c->work, p);
        bool empty = w->cell->state == HEWN_CELL_EMPTY, full = w->cell->state == HEWN_CELL_FULL;
        if (!empty && !full)
            return true;
        if (!is_proven(w, empty ? w->cell->least / w->steepness : -FAR_AWAY)) {
            step_back(w);
            continue;
        }
        if (full)
            return true;
        clip(w->cell->lo, w->cell->hi, w->ray, &begin, &end);
        w->t = (end > w->t ? end : w->t) + 0.5F * octree->margin;
        w->begin = w->t; /* what is before is free */
        w->stride = w->sure = w->free = 0;
        w->lean = -1;
    }
    return false;
}

/* How far beyond w->t the slope that a step counts on is known, and from there on by which kind of steps. */
static float know_slope(const host_tracer *tracer, walker *w)
{
    float way = FAR_AWAY, p[3];
    w->steepness = tracer->steepness;
    if (w->steepness == 0 && tracer->slopes.bounds) {
        place(w->ray, w->t, p);
        w->steepness = hewn_slopes_at(&tracer->slopes, p, w->ray->along, &way);
    }
    w->by_boxes = w->steepness == 0;
    return way;
}

/* Steps of the other kind begin: what is before is free. */
static void begin_steps(const host_tracer *tracer, walker *w)
{
    const hewn_cell *root = tracer->octree.cells;
    w->begin = w->t;
    w->free = w->sure = 0;
    w->lean = -1;
    w->stride = w->by_boxes ? 0.05F * (root->hi[0] - root->lo[0]) : 0;
}

static void take_sphere(const crew *c, walker *w, float value)
{
    const host_tracer *tracer = c->tracer;
    float near_enough = enough(c->stage, w->t);
    w->steps++;
    if (!is_proven(w, value > 0 ? (value - tracer->slack) / w->steepness : -FAR_AWAY)) {
        step_back(w);
        return;
    }
    w->met = value <= 0;
    if (w->met) { /* a step by the value itself ends on the surface, or by rounding a little behind */
        w->t = fmaxf(w->t - fminf(w->stride, near_enough), w->begin);
        return;
    }
    float way = know_slope(tracer, w), radius = (value - tracer->slack) / w->steepness;
    if (w->by_boxes) {
        begin_steps(tracer, w);
        return;
    }
    if (w->stride > 0)
        w->lean = 0.7F * w->lean + 0.3F * ((radius - w->free) / w->stride);
    w->free = radius > 0 && radius < FAR_AWAY ? radius : 0;
    w->sure = fmaxf(w->free, near_enough);
    w->stride = fmaxf(2 * w->free / (1 - fminf(w->lean, 0.8F)), w->sure);
    w->stride = fminf(w->stride, fmaxf(way, near_enough));
    w->t += w->stride;
}

/* Where slopes are bounded (Hart 1996): a value over the slope is how far the surface is at least. Steps are as long as
 * to where the next sphere would touch this one if values went on as they did (automatic relaxation, Ban and Valasek
 * 2023); where it does not reach back so far, or ends behind the surface, the step is taken back. Spheres smaller than
 * what is on the surface count as that, and the end of the way is asked next. */
static void trace_together(crew *c, const hewn_lane_tape *tape, walker *const *group, uint32_t count)
{
    hewn_lane_points points;
    float values[HEWN_LANES];
    uint32_t lanes = count;
    for (uint32_t i = 0; i < count; i++) {
        float p[3];
        place(group[i]->ray, group[i]->t, p);
        for (int axis = 0; axis < 3; axis++)
            points.at[axis][i] = p[axis];
    }
    fill_up(&points, &lanes);
    hewn_lanes_value(tape, &c->work, &points, lanes, values);
    for (uint32_t i = 0; i < count; i++)
        take_sphere(c, group[i], values[i]);
}

/* Those of a group that go by boxes and the others. */
static void go_on(crew *c, const hewn_lane_tape *tape, const wanting *sorted, walker *const *active, uint32_t count)
{
    walker *by_boxes[HEWN_LANES], *by_spheres[HEWN_LANES];
    uint32_t boxes = 0, spheres = 0;
    for (uint32_t i = 0; i < count; i++) {
        walker *w = active[sorted[i].number];
        if (w->by_boxes)
            by_boxes[boxes++] = w;
        else
            by_spheres[spheres++] = w;
    }
    if (boxes > 0)
        step_together(c, tape, by_boxes, boxes);
    if (spheres > 0)
        trace_together(c, tape, by_spheres, spheres);
}

static bool find_next(crew *c, walker *w)
{
    if (w->by_boxes && c->tracer->slopes.bounds) {
        know_slope(c->tracer, w);
        if (!w->by_boxes)
            begin_steps(c->tracer, w);
    }
    return w->by_boxes ? find_cell(c, w) : find_cell_of_sphere(c, w);
}

/* Until all have met something, or ended, or taken `most` steps. */
static void march(crew *c, walker *walkers, uint32_t count, uint32_t most)
{
    walker *active[PACK];
    const wanting *sorted = c->sorted;
    uint32_t left = 0;
    for (uint32_t i = 0; i < count; i++)
        active[left++] = &walkers[i];
    while (left > 0) {
        uint32_t kept = 0;
        for (uint32_t i = 0; i < left; i++) {
            walker *w = active[i];
            if (w->met || !find_next(c, w))
                continue;
            w->ran_out = w->steps >= most;
            w->met = w->ran_out || w->cell->state == HEWN_CELL_FULL;
            if (!w->met)
                active[kept++] = w;
        }
        left = kept;
        for (uint32_t i = 0; i < left; i++)
            c->items[i] = (wanting){active[i]->cell->owner, i};
        put_together(c, left);
        for (uint32_t first = 0, taken; first < left; first += taken) {
            taken = run_of(sorted, first, left);
            go_on(c, tape_of(c, sorted[first].owner), sorted + first, active, taken);
        }
    }
}

static walker start(const crew *c, const hewn_ray *ray)
{
    const hewn_cell *root = c->tracer->octree.cells;
    walker w = {.ray = ray, .t = ray->begin, .end = ray->end};
    clip(root->lo, root->hi, ray, &w.t, &w.end);
    know_slope(c->tracer, &w);
    begin_steps(c->tracer, &w);
    return w;
}

/* --- what was met ---------------------------------------------------------------------------------------------------
 */

static void face_normal(const hewn_cell *root, const float p[3], const float along[3], float out[3])
{
    float most = 0;
    for (int axis = 0; axis < 3; axis++)
        out[axis] = -along[axis];
    for (int axis = 0; axis < 3; axis++) {
        float middle = 0.5F * (root->lo[axis] + root->hi[axis]);
        float from = (p[axis] - middle) / (0.5F * (root->hi[axis] - root->lo[axis]));
        if (fabsf(from) < 0.999F || fabsf(from) <= most)
            continue;
        most = fabsf(from);
        out[0] = out[1] = out[2] = 0;
        out[axis] = from > 0 ? 1 : -1;
    }
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

static void settle_normals(crew *c, const hewn_ray *rays, hewn_met *met, const uint8_t *capped, uint32_t count)
{
    float points[PACK][3], slopes[PACK][4];
    uint8_t wanted[PACK];
    for (uint32_t i = 0; i < count; i++) {
        place(&rays[i], met[i].t, points[i]);
        wanted[i] = met[i].what == HEWN_MET_SURFACE && !capped[i];
    }
    visit_points(c, (const float(*)[3])points, wanted, count, take_gradients, slopes);
    for (uint32_t i = 0; i < count; i++) {
        if (met[i].what != HEWN_MET_SURFACE)
            continue;
        const float *g = &slopes[i][1], *along = rays[i].along;
        if (capped[i]) {
            face_normal(c->tracer->octree.cells, points[i], along, met[i].normal);
            continue;
        }
        float steep = sqrtf(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]), facing = 0;
        for (int axis = 0; axis < 3; axis++) {
            met[i].normal[axis] = steep > 0 && steep < FAR_AWAY ? g[axis] / steep : -along[axis];
            facing -= met[i].normal[axis] * along[axis];
        }
        float rest = slopes[i][0] / (steep * fmaxf(facing, 0.1F));
        if (fabsf(rest) < 2 * enough(c->stage, met[i].t))
            met[i].t += rest;
    }
}

/* Passes cells in which the field is too far above 0 to dim the light; false where the way to it ends. */
static bool pass_bright(crew *c, walker *w, float end)
{
    const hewn_octree *octree = &c->tracer->octree;
    float dimming = c->stage->softness * c->tracer->slope;
    for (uint32_t i = 0; i < 4 * HEWN_SKIP_STEPS && w->t < end; i++) {
        float p[3], begin = 0, out = FAR_AWAY;
        place(w->ray, w->t, p);
        const hewn_cell *cell = hewn_octree_reach(octree, &c->work, p);
        clip(cell->lo, cell->hi, w->ray, &begin, &out);
        out = (out > w->t ? out : w->t) + 0.5F * octree->margin;
        if (!(cell->least >= dimming * out))
            return true;
        w->t = out;
    }
    return false;
}

/* As edge_light() of the shader, all walkers together. */
static void find_edges(crew *c, walker *walkers, const float *ends, hewn_met *const *lit, uint32_t count)
{
    const hewn_cell *root = c->tracer->octree.cells;
    float shortest = 0.004F * (root->hi[0] - root->lo[0]), points[PACK][3], values[PACK];
    for (uint32_t i = 0; i < count; i++)
        walkers[i].t += shortest;
    for (uint32_t round = 0; round < HEWN_LIGHT_STEPS; round++) {
        uint32_t which[PACK], left = 0;
        for (uint32_t i = 0; i < count; i++)
            if (!walkers[i].met && lit[i]->light > 0 && pass_bright(c, &walkers[i], ends[i])) {
                place(walkers[i].ray, walkers[i].t, points[left]);
                which[left++] = i;
            }
        visit_points(c, (const float(*)[3])points, NULL, left, take_values, values);
        for (uint32_t i = 0; i < left; i++) {
            walker *w = &walkers[which[i]];
            float free = values[i] / c->tracer->slope;
            lit[which[i]]->light = fminf(lit[which[i]]->light, free / (w->t * c->stage->softness));
            w->t += fmaxf(0.5F * free, shortest + 0.03F * w->t);
        }
    }
    for (uint32_t i = 0; i < count; i++) {
        float share = fminf(fmaxf(lit[i]->light, 0), 1);
        lit[i]->light = walkers[i].met ? 0 : share * share * (3 - 2 * share);
    }
}

static void find_light(crew *c, const float (*p)[3], hewn_met *const *lit, uint32_t count)
{
    hewn_ray rays[PACK];
    walker walkers[PACK];
    hewn_met *open[PACK];
    float begins[PACK], ends[PACK];
    uint32_t left = 0;
    for (uint32_t i = 0; i < count; i++) {
        float facing = 0;
        for (int axis = 0; axis < 3; axis++)
            facing += lit[i]->normal[axis] * c->stage->light[axis];
        hewn_ray *ray = &rays[left];
        *ray = (hewn_ray){.end = FAR_AWAY};
        memcpy(ray->from, p[i], sizeof ray->from);
        memcpy(ray->along, c->stage->light, sizeof ray->along);
        walkers[left] = start(c, ray);
        lit[i]->light = facing > 0 ? 1 : 0;
        begins[left] = walkers[left].t;
        ends[left] = walkers[left].end;
        if (facing > 0 && walkers[left].t < walkers[left].end)
            open[left++] = lit[i];
    }
    march(c, walkers, left, HEWN_SHADOW_STEPS);
    for (uint32_t i = 0; i < left; i++)
        walkers[i].t = begins[i];
    find_edges(c, walkers, ends, open, left);
}

static void find_openness(crew *c, const float (*p)[3], hewn_met *const *lit, uint32_t count)
{
    const hewn_cell *root = c->tracer->octree.cells;
    float points[PACK * TAPS][3], values[PACK * TAPS], outside[PACK * TAPS];
    uint8_t wanted[PACK * TAPS];
    for (uint32_t i = 0; i < count * TAPS; i++) {
        const uint32_t tap = i % TAPS + 1;
        float height = c->stage->reach * (float)(tap * tap) / (TAPS * TAPS), square = 0;
        for (int axis = 0; axis < 3; axis++) {
            float at = p[i / TAPS][axis] + height * lit[i / TAPS]->normal[axis];
            points[i][axis] = fminf(fmaxf(at, root->lo[axis]), root->hi[axis]);
            square += (at - points[i][axis]) * (at - points[i][axis]);
        }
        outside[i] = sqrtf(square);
        const hewn_cell *cell = hewn_octree_reach(&c->tracer->octree, &c->work, points[i]);
        wanted[i] = !(cell->least >= height * c->tracer->slope) && !(outside[i] >= height);
        values[i] = height * c->tracer->slope; /* where nothing is that near, whatever the value */
    }
    visit_points(c, (const float(*)[3])points, wanted, count * TAPS, take_values, values);
    for (uint32_t i = 0; i < count; i++) {
        float taken = 0, all = 0, weight = 1;
        for (uint32_t tap = 1; tap <= TAPS; tap++, weight *= 0.7F) {
            uint32_t k = i * TAPS + tap - 1;
            float height = c->stage->reach * (float)(tap * tap) / (TAPS * TAPS);
            float there = fmaxf(values[k] / c->tracer->slope, 0);
            float free = sqrtf(outside[k] * outside[k] + there * there); /* what is in the box is no nearer */
            free = isnan(free) ? height : fminf(fmaxf(free, 0), height);
            taken += weight * (height - free);
            all += weight * height;
        }
        lit[i]->openness = 1 - taken / all;
    }
}

static void shade(crew *c, const hewn_ray *rays, hewn_met *met, uint32_t count)
{
    float points[PACK][3];
    hewn_met *lit[PACK];
    uint32_t left = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (met[i].what == HEWN_MET_NOTHING)
            continue;
        place(&rays[i], met[i].t, points[left]);
        for (int axis = 0; axis < 3; axis++)
            points[left][axis] += 3 * enough(c->stage, met[i].t) * met[i].normal[axis];
        lit[left++] = &met[i];
    }
    find_light(c, (const float(*)[3])points, lit, left);
    find_openness(c, (const float(*)[3])points, lit, left);
}

static void trace_pack(crew *c, const hewn_ray *rays, uint32_t count, hewn_met *met)
{
    walker walkers[PACK];
    uint8_t capped[PACK], wanted[PACK];
    float points[PACK][3], values[PACK];
    for (uint32_t i = 0; i < count; i++) {
        walkers[i] = start(c, &rays[i]);
        place(&rays[i], walkers[i].t, points[i]);
        wanted[i] = walkers[i].t < walkers[i].end &&
                    hewn_octree_reach(&c->tracer->octree, &c->work, points[i])->state != HEWN_CELL_EMPTY;
    }
    visit_points(c, (const float(*)[3])points, wanted, count, take_values, values);
    for (uint32_t i = 0; i < count; i++) {
        capped[i] = wanted[i] && values[i] < 0;
        walkers[i].met = capped[i];
    }
    march(c, walkers, count, HEWN_RAY_STEPS);
    for (uint32_t i = 0; i < count; i++) {
        met[i] = (hewn_met){.t = walkers[i].met ? walkers[i].t : FAR_AWAY, .light = 1, .openness = 1};
        met[i].what = walkers[i].met ? HEWN_MET_SURFACE : HEWN_MET_NOTHING;
        met[i].ran_out = walkers[i].ran_out;
        meet_ground(c->stage, &rays[i], &met[i]);
    }
    settle_normals(c, rays, met, capped, count);
    if (c->stage->flags & HEWN_TRACE_SHADE)
        shade(c, rays, met, count);
}

static hewn_result trace(void *self, const hewn_stage *stage, const hewn_ray *rays, size_t count, hewn_met *met,
                         hewn_error *error)
{
    host_tracer *tracer = self;
    hewn_result all = HEWN_OK;
#pragma omp parallel
    {
        crew c;
        c.tracer = tracer;
        c.stage = stage;
        hewn_result result = hewn_lane_work_create(tracer->octree.whole, &c.work, NULL);
        c.waiting = hewn_alloc_zero(tracer->octree.count, sizeof *c.waiting);
        result = c.waiting ? result : HEWN_OUT_OF_MEMORY;
#pragma omp for schedule(dynamic)
        for (size_t first = 0; first < count; first += PACK) {
            uint32_t taken = (uint32_t)(count - first < PACK ? count - first : PACK);
            if (result == HEWN_OK)
                trace_pack(&c, rays + first, taken, met + first);
        }
#pragma omp critical(hewn_host_tracer)
        all = all == HEWN_OK ? result : all;
        hewn_lane_work_destroy(&c.work);
        hewn_free(c.waiting);
    }
    return all == HEWN_OK ? HEWN_OK : hewn_fail(error, all, "out of memory following rays");
}

static void destroy(void *self)
{
    host_tracer *tracer = self;
    hewn_octree_destroy(&tracer->octree);
    hewn_slopes_destroy(&tracer->slopes);
    hewn_free(tracer);
}

hewn_result hewn_tracer_on_host(const hewn_field *field, hewn_node root, const hewn_box *box, hewn_tracer *out,
                                hewn_error *error)
{
    *out = (hewn_tracer){0};
    host_tracer *tracer = hewn_alloc_zero(1, sizeof *tracer);
    if (!tracer)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a renderer");
    double slope = 1, steepness = INFINITY, far = 0;
    tracer->box = *box;
    hewn_result result = hewn_common_slope(field, root, box, &slope, error);
    if (result == HEWN_OK)
        result = hewn_steepness_bound(field, root, box, &steepness, error);
    if (result == HEWN_OK)
        result = hewn_octree_create(field, root, box, false, &tracer->octree, error);
    tracer->slope = (float)slope;
    for (int axis = 0; axis < 3; axis++)
        far = fmax(far, fmax(fabs(box->lo[axis]), fabs(box->hi[axis])));
    if (steepness > 0 && steepness <= HEWN_STEEPEST * slope)
        tracer->steepness = nextafterf((float)steepness, INFINITY);
    else if (result == HEWN_OK && tracer->octree.count > 0)
        result = hewn_slopes_create(field, root, box, (double)tracer->octree.margin, HEWN_STEEPEST * slope,
                                    &tracer->slopes, error);
    tracer->slack = fmaxf(tracer->steepness, tracer->slopes.greatest) * (float)far * 0x1p-18F;
    if (result != HEWN_OK)
        destroy(tracer);
    else
        *out = (hewn_tracer){.self = tracer, .on_host = true, .trace = trace, .destroy = destroy};
    return result;
}
