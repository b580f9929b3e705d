#include "simplify/balance.h"

#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "geom/nearest.h"
#include "simplify/collapse.h"
#include "simplify/state.h"

/* The last collapses are done again from where there are so many times more triangles, each time with a greater weight
 * of places that came out far away: as far as this share of the furthest, and more. Costs go with the squares of
 * distances times areas, and areas with distances, hence the power. A face that is flipped counts as one that is so
 * many times too far away. */
#include <stdio.h>
#include <stdlib.h>
static double knob(const char *name, double value)
{
    const char *t = getenv(name);
    return t ? atof(t) : value;
}
#define more knob("MORE", 4)
#define near_share knob("AIM", 0.7)
#define power knob("POWER", 3)
#define flip_factor knob("FLIP", 4)

/* So many times, and where faces are flipped up to so many; meshes of more triangles are measured by a part of their
 * vertices, so many for each triangle of the result. */
#define ROUNDS (int)knob("ROUNDS", 2)
#define MOST_ROUNDS (int)knob("MOSTR", 8)
enum { SAMPLES = 16 };

typedef struct balance {
    simplify_work *work;
    const hewn_polygons *input;
    simplify_state start, best;
    hewn_bvh bvh;   /* of the input */
    uint32_t *near; /* of each of the input's vertices: the triangle of the result near it; HEWN_NONE: not looked for */
    float *gap;     /* and how far that is */
    double *pulls;  /* 9 a vertex of the result: a matrix and a vector */
    uint32_t *place; /* of each of the input's vertices that is left: its number now; else HEWN_NONE */
    float *away;     /* one a vertex of the result: how far what it stands for is, in the work's unit */
    double *before;
    float *away_before;
    uint8_t *turned_before;
    uint8_t *turned; /* one a vertex of the result: of a flipped face */
    double *weight;  /* one a vertex of the start */
    double most, best_most;
    uint32_t flips, best_flips;
    int round;
    uint32_t step;
    double sum;
} balance;

/* --- measuring ---------------------------------------------------------------------------------------------------- */

static hewn_triangle_view view_of(const simplify_work *work)
{
    return (hewn_triangle_view){.vertex_count = work->vertex_count,
                                .triangle_count = work->face_count,
                                .doubles = work->positions,
                                .corners = work->tail};
}

static hewn_triangle_view input_of(const balance *job)
{
    return (hewn_triangle_view){.vertex_count = job->input->vertex_count,
                                .triangle_count = job->input->face_count,
                                .doubles = job->input->positions,
                                .corners = job->input->corners};
}

/* The vertex of the result that one of the input has become; HEWN_NONE where there is none. */
static uint32_t place_of(const balance *job, uint32_t v)
{
    const uint32_t *into = job->work->into;
    while (into[v] != v)
        v = into[v];
    return job->place[v];
}

static void note(float *away, double distance)
{
    const float found = (float)distance;
    float now;
#pragma omp atomic read
    now = *away;
    while (found > now) {
        /* Positive floats are in the order of their bits, so this is the greatest whoever comes first. */
        float held = now;
        if (__atomic_compare_exchange((uint32_t *)(void *)away, (uint32_t *)(void *)&held,
                                      (uint32_t *)(void *)&(float){found}, false, __ATOMIC_RELAXED, __ATOMIC_RELAXED))
            break;
        now = held;
    }
}

/* From the input's vertices to the result. */
static hewn_result measure_there(balance *job, hewn_error *error)
{
    const simplify_work *work = job->work;
    const hewn_triangle_view now = view_of(work);
    const uint32_t count = work->input_count, samples = SAMPLES * work->face_count;
    const uint32_t step = job->step = count / (samples > 0 ? samples : 1) + 1;
    double sum = 0;
    hewn_bvh bvh;
    HEWN_TRY(hewn_bvh_build(&now, &bvh, error));
#pragma omp parallel for schedule(dynamic, 256) reduction(+ : sum) if (work->vertex_count > SIMPLIFY_FEW / 16)
    for (uint32_t v = 0; v < count; v += step) {
        const uint32_t root = place_of(job, v);
        double at[3], distance;
        job->near[v] = HEWN_NONE;
        if (root == HEWN_NONE || work->rank[root] == SIMPLIFY_APART)
            continue;
        for (size_t axis = 0; axis < 3; axis++)
            at[axis] = simplify_inward(work, job->input->positions[3 * (size_t)v + axis], axis);
        const uint32_t face = hewn_bvh_nearest(&bvh, &now, at, work->half[root] / 3, &distance);
        job->near[v] = face;
        job->gap[v] = (float)distance;
        sum += distance;
        note(&job->away[root], distance);
        for (size_t k = 0; k < 3; k++)
            note(&job->away[work->tail[3 * (size_t)face + k]], distance);
    }
    job->sum = sum;
    hewn_bvh_free(&bvh);
    return HEWN_OK;
}

/* The distance from a point to the input, and the triangle there. */
static double reach(const balance *job, const double at[3], uint32_t *face)
{
    const hewn_triangle_view input = input_of(job);
    double there[3], distance;
    for (int axis = 0; axis < 3; axis++)
        there[axis] = job->work->origin[axis] + job->work->scale * at[axis];
    *face = hewn_bvh_nearest(&job->bvh, &input, there, *face, &distance);
    return distance / job->work->scale;
}

static void input_normal(const balance *job, uint32_t face, double out[3])
{
    const hewn_triangle_view input = input_of(job);
    double at[3][3];
    for (uint64_t k = 0; k < 3; k++)
        hewn_triangle_point(&input, input.corners[3 * (uint64_t)face + k], at[k]);
    simplify_area_vector(at[0], at[1], at[2], out);
}

/* From a triangle of the result to the input: its middle, its corners and the middles of its edges. Returns whether it
 * is flipped: faces away from the input's triangle nearest to its middle. */
static bool measure_face(const balance *job, uint32_t face)
{
    const simplify_work *work = job->work;
    const uint32_t *corner = work->tail + 3 * (size_t)face;
    const double *at[3] = {simplify_at(work, corner[0]), simplify_at(work, corner[1]), simplify_at(work, corner[2])};
    double middle[3], own[3], other[3], distance;
    uint32_t near = work->face_origins[face];
    for (int axis = 0; axis < 3; axis++)
        middle[axis] = (at[0][axis] + at[1][axis] + at[2][axis]) / 3;
    distance = reach(job, middle, &near);
    input_normal(job, near, other);
    simplify_area_vector(at[0], at[1], at[2], own);
    for (int k = 0; k < 3; k++) {
        const double *a = at[k], *b = at[(k + 1) % 3];
        const uint32_t h = 3 * face + (uint32_t)k;
        for (int axis = 0; axis < 3; axis++)
            middle[axis] = (a[axis] + b[axis]) / 2;
        if (simplify_name(work, h) == h)
            distance = fmax(distance, reach(job, middle, &near));
        if (work->half[corner[k]] == h)
            distance = fmax(distance, reach(job, a, &near));
    }
    for (int k = 0; k < 3; k++)
        note(&job->away[corner[k]], distance);
    return simplify_dot(own, other) < 0;
}

static hewn_result measure(balance *job, hewn_error *error)
{
    const simplify_work *work = job->work;
    uint32_t flips = 0;
    memset(job->away, 0, job->start.work.vertex_count * sizeof *job->away);
    memset(job->turned, 0, job->start.work.vertex_count);
    memset(job->place, 0xFF, work->input_count * sizeof *job->place);
    for (uint32_t v = 0; v < work->vertex_count; v++)
        job->place[work->origins[v]] = v;
    HEWN_TRY(measure_there(job, error));
#pragma omp parallel for schedule(dynamic, 64) reduction(+ : flips) if (work->vertex_count > SIMPLIFY_FEW / 16)
    for (uint32_t f = 0; f < work->face_count; f++)
        if (measure_face(job, f)) {
            flips++;
            for (uint32_t k = 0; k < 3; k++) {
#pragma omp atomic write
                job->turned[work->tail[3 * f + k]] = 1;
            }
        }
    job->flips = flips;
    job->most = 0;
    for (uint32_t v = 0; v < work->vertex_count; v++)
        job->most = fmax(job->most, (double)job->away[v]);
    return HEWN_OK;
}

/* --- fitting ------------------------------------------------------------------------------------------------------ */

/* A sample pulls the corners of its triangle along the normal, each by its share of the point. Shares sum to one, so
 * that the sum of shares times squared moves is never less than the square of what they come to: solving for each
 * vertex by itself makes squared distances less, not more (a majorizer). */
static void pull(balance *job, const double at[3], uint32_t face, double weight)
{
    const simplify_work *work = job->work;
    const uint32_t *corner = work->tail + 3 * (size_t)face;
    const double *a = simplify_at(work, corner[0]), *b = simplify_at(work, corner[1]),
                 *c = simplify_at(work, corner[2]);
    double n[3], away[3], share[3], part[3], sum = 0;
    simplify_area_vector(a, b, c, n);
    const double square = simplify_dot(n, n);
    if (!(square > 0))
        return;
    const double *from[3] = {b, c, a}, *to[3] = {c, a, b};
    for (int k = 0; k < 3; k++) {
        simplify_area_vector(at, from[k], to[k], part);
        share[k] = fmax(simplify_dot(part, n), 0);
        sum += share[k];
    }
    simplify_between(a, at, away);
    const double height = simplify_dot(away, n) / square; /* times n is the way to the point */
    for (int k = 0; k < 3 && sum > 0; k++) {
        double *to_sum = job->pulls + 9 * (size_t)corner[k];
        const double w = weight * share[k] / sum;
        to_sum[0] += w * n[0] * n[0] / square;
        to_sum[1] += w * n[0] * n[1] / square;
        to_sum[2] += w * n[0] * n[2] / square;
        to_sum[3] += w * n[1] * n[1] / square;
        to_sum[4] += w * n[1] * n[2] / square;
        to_sum[5] += w * n[2] * n[2] / square;
        for (int axis = 0; axis < 3; axis++)
            to_sum[6 + axis] += w * height * n[axis];
    }
}

/* Moves vertices so that the input's vertices are nearer, where no triangle turns over. */
static void fit(balance *job)
{
    simplify_work *work = job->work;
    memset(job->pulls, 0, work->vertex_count * 9 * sizeof *job->pulls);
    double all = 0, count = 0;
    for (uint32_t v = 0; v < work->input_count; v += job->step)
        if (job->near[v] != HEWN_NONE) {
            all += (double)job->gap[v];
            count++;
        }
    const double inverse = all > 0 ? count / all : 0;
    for (uint32_t v = 0; v < work->input_count; v += job->step) {
        double at[3];
        if (job->near[v] == HEWN_NONE)
            continue;
        for (size_t axis = 0; axis < 3; axis++)
            at[axis] = simplify_inward(work, job->input->positions[3 * (size_t)v + axis], axis);
        const double relative = (double)job->gap[v] * inverse;
        pull(job, at, job->near[v], 1 + knob("QUAD", 0.1) * relative * relative);
    }
    for (uint32_t v = 0; v < work->vertex_count; v++) {
        simplify_quadric q = {0};
        double move[3], to[3];
        if (work->rank[v] != SIMPLIFY_SMOOTH)
            continue;
        memcpy(q.a, job->pulls + 9 * (size_t)v, sizeof q.a);
        const double stay = knob("STAY", 0.02) * (q.a[0] + q.a[3] + q.a[5]);
        q.a[0] += stay;
        q.a[3] += stay;
        q.a[5] += stay;
        if (!simplify_quadric_solve(&q, job->pulls + 9 * (size_t)v + 6, move))
            continue;
        const double length = sqrt(simplify_dot(move, move)), most = (double)job->away[v];
        for (int axis = 0; axis < 3; axis++)
            to[axis] = simplify_at(work, v)[axis] + move[axis] * (length > most ? most / length : 1);
        if (hewn_simplify_may_move(work, v, to))
            memcpy(work->positions + 3 * (size_t)v, to, sizeof to);
    }
}

/* A vertex and those around it. */
static void put_back(const balance *job, uint32_t v)
{
    simplify_work *work = job->work;
    const uint32_t first = work->half[v];
    uint32_t h = first;
    if (work->rank[v] == SIMPLIFY_APART)
        return;
    memcpy(work->positions + 3 * (size_t)v, job->before + 3 * (size_t)v, 3 * sizeof *job->before);
    do {
        const uint32_t in = simplify_prev(h), ends[2] = {simplify_head(work, h), work->tail[in]};
        for (int k = 0; k < 2; k++)
            memcpy(work->positions + 3 * (size_t)ends[k], job->before + 3 * (size_t)ends[k], 3 * sizeof *job->before);
        h = work->twin[in];
    } while (h != HEWN_NONE && h != first);
}

/* Fits, measures, and takes back what came out further away than before and far. */
static hewn_result fit_guarded(balance *job, hewn_error *error)
{
    simplify_work *work = job->work;
    const double far = knob("GUARD", 0.7) * job->most, was = job->most;
    const uint32_t verts = work->vertex_count, flips = job->flips;
    uint32_t back = 0;
    memcpy(job->before, work->positions, verts * 3 * sizeof *job->before);
    memcpy(job->away_before, job->away, verts * sizeof *job->away);
    memcpy(job->turned_before, job->turned, verts);
    fit(job);
    HEWN_TRY(measure(job, error));
    if (getenv("TALK"))
        fprintf(stderr, "   fit most %g flips %u\n", job->most, job->flips);
    for (int again = 0; again < (int)knob("BACKS", 2); again++) {
        back = 0;
        for (uint32_t v = 0; v < verts; v++)
            if (((double)job->away[v] > far && job->away[v] > job->away_before[v]) ||
                (job->turned[v] && !job->turned_before[v])) {
                put_back(job, v);
                back++;
            }
        HEWN_TRY(measure(job, error));
        if (getenv("TALK"))
            fprintf(stderr, "   %u back most %g flips %u\n", back, job->most, job->flips);
        if (back == 0 || (job->most <= was && job->flips <= flips))
            break;
    }
    if (job->most > was || job->flips > flips) {
        memcpy(work->positions, job->before, verts * 3 * sizeof *job->before);
        HEWN_TRY(measure(job, error));
    }
    return HEWN_OK;
}

/* --- the next round ----------------------------------------------------------------------------------------------- */

static void reweigh(balance *job)
{
    const simplify_work *start = &job->start.work;
    const double aim = near_share * job->most;
#pragma omp parallel for schedule(static) if (start->vertex_count > SIMPLIFY_FEW)
    for (uint32_t v = 0; v < start->vertex_count; v++) {
        const uint32_t root = place_of(job, start->origins[v]);
        if (root == HEWN_NONE)
            continue;
        const double far = job->round > ROUNDS ? 0 : aim > 0 ? (double)job->away[root] / aim : 0;
        const double factor = job->turned[root] ? fmax(far, flip_factor) : far;
        if (factor > 1)
            job->weight[v] *= pow(factor, power);
    }
}

/* The start again, with quadrics as heavy as they have become. */
static hewn_result begin_again(balance *job, hewn_error *error)
{
    simplify_work *work = job->work;
    HEWN_TRY(hewn_simplify_restore(&job->start, work, error));
    for (uint32_t v = 0; v < work->vertex_count; v++)
        if (job->weight[v] > 1)
            simplify_quadric_scale(&work->quadrics[v], job->weight[v]);
    hewn_simplify_key(work);
    return HEWN_OK;
}

static hewn_result prepare(balance *job, hewn_error *error)
{
    const simplify_work *work = job->work;
    const hewn_triangle_view input = input_of(job);
    HEWN_TRY(hewn_simplify_save(work, &job->start, error));
    HEWN_TRY(hewn_bvh_build(&input, &job->bvh, error));
    job->place = hewn_alloc(work->input_count, sizeof *job->place);
    job->away = hewn_alloc(work->vertex_count, sizeof *job->away);
    job->turned = hewn_alloc(work->vertex_count, 1);
    job->weight = hewn_alloc(work->vertex_count, sizeof *job->weight);
    job->near = hewn_alloc(work->input_count, sizeof *job->near);
    job->gap = hewn_alloc(work->input_count, sizeof *job->gap);
    job->before = hewn_alloc(work->vertex_count, 3 * sizeof *job->before);
    job->away_before = hewn_alloc(work->vertex_count, sizeof *job->away_before);
    job->turned_before = hewn_alloc(work->vertex_count, 1);
    job->pulls = hewn_alloc(work->vertex_count, 9 * sizeof *job->pulls);
    if (!job->gap || !job->near || !job->pulls || !job->place || !job->away || !job->turned || !job->weight)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
    for (uint32_t v = 0; v < work->vertex_count; v++)
        job->weight[v] = 1;
    return HEWN_OK;
}

/* Fewer flips count for a little more distance. */
static bool is_better(const balance *job)
{
    if (job->flips != job->best_flips)
        return job->flips < job->best_flips ? job->most < 1.1 * job->best_most : false;
    return job->most < job->best_most;
}

static hewn_result go_round(balance *job, uint32_t target, hewn_error *error)
{
    HEWN_TRY(prepare(job, error));
    for (int round = 0; round <= (job->best_flips > 0 ? MOST_ROUNDS : ROUNDS); round++) {
        if (round > 0) {
            job->round = round;
            reweigh(job);
            HEWN_TRY(begin_again(job, error));
        }
        HEWN_TRY(hewn_simplify_run(job->work, target, error));
        HEWN_TRY(measure(job, error));
        if (getenv("TALK"))
            fprintf(stderr, "round %d most %g sum %g flips %u\n", round, job->most, job->sum, job->flips);
        if (round > 0 && !is_better(job))
            continue;
        job->best_most = job->most;
        job->best_flips = job->flips;
        HEWN_TRY(hewn_simplify_save(job->work, &job->best, error));
    }
    HEWN_TRY(hewn_simplify_restore(&job->best, job->work, error));
    HEWN_TRY(measure(job, error));
    for (int k = 0; k < (int)knob("FITS", 2); k++)
        HEWN_TRY(fit_guarded(job, error));
    return HEWN_OK;
}

hewn_result hewn_simplify_balanced(simplify_work *work, const hewn_polygons *input, uint32_t target, hewn_error *error)
{
    balance job = {.work = work, .input = input};
    const uint32_t begin = target < work->live_faces / more ? (uint32_t)(more * target) : work->live_faces;
    if (target >= work->live_faces)
        return hewn_simplify_run(work, target, error);
    HEWN_TRY(hewn_simplify_run(work, begin, error));
    hewn_result result = go_round(&job, target, error);
    hewn_simplify_forget(&job.start);
    hewn_simplify_forget(&job.best);
    hewn_bvh_free(&job.bvh);
    hewn_free(job.place);
    hewn_free(job.before);
    hewn_free(job.away_before);
    hewn_free(job.turned_before);
    hewn_free(job.near);
    hewn_free(job.gap);
    hewn_free(job.pulls);
    hewn_free(job.away);
    hewn_free(job.turned);
    hewn_free(job.weight);
    return result;
}
