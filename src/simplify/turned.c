#include "simplify/turned.h"

#include "base/alloc.h"
#include "base/error.h"
#include "simplify/swap.h"

enum { PASSES = 3, PLACES = 8 };

static double find_most(const simplify_samples *samples)
{
    double most = samples->aim;
    for (uint32_t s = 0; s < samples->count; s++)
        most = fmax(most, (double)samples->items[s].gap);
    return most;
}

/* One way to change the mesh around a triangle. */
typedef struct mending {
    enum { MEND_NOT, MEND_COLLAPSE, MEND_SWAP, MEND_MOVE } kind;
    simplify_plan plan; /* of a collapse; `at` also of a move */
    uint32_t at;        /* the half-edge that is swapped, the vertex that moves */
    uint32_t fewer;     /* triangles that face away no more */
    double far;         /* how far away something comes to be, at most */
} mending;

typedef struct mend_job {
    simplify_work *work;
    double most;     /* nothing comes further away */
    uint8_t *turned; /* one a triangle: it may face away */
    uint32_t clock;  /* how often something was done */
    uint32_t *tried; /* one a triangle: the clock when nothing helped, and 1; 0: it was not tried or something did */
    uint32_t *done;  /* one a vertex: the clock when something was last done to triangles there */
    simplify_probe probe;
    uint32_t face; /* the triangle that is to face away no more */
    uint32_t near; /* the input's triangle nearest to its middle */
    mending best;
} mend_job;

/* --- ways --------------------------------------------------------------------------------------------------------- */

/* How many triangles must face away no more for something to be better than what there is. */
static uint32_t least_fewer(const mend_job *job)
{
    return job->best.fewer > 0 ? job->best.fewer : 1;
}

/* Keeps what the probe has looked at, of `before` triangles that face away now, if it is better. */
static void keep_better(mend_job *job, const mending *way, uint32_t before)
{
    const simplify_probe *probe = &job->probe;
    const double far = fmax(probe->most, probe->back);
    if (before == 0 || probe->cut || !(far <= job->most) || (before == job->best.fewer && far >= job->best.far))
        return;
    const uint32_t least = least_fewer(job);
    if (before < least)
        return;
    const uint32_t after = hewn_simplify_probe_turns(job->work, probe, before - least);
    if (after > before - least)
        return;
    const uint32_t fewer = before - after;
    if (fewer == job->best.fewer && far >= job->best.far)
        return;
    job->best = *way;
    job->best.fewer = fewer;
    job->best.far = far;
}

static hewn_result try_collapse(mend_job *job, uint32_t name)
{
    const simplify_work *work = job->work;
    mending way = {.kind = MEND_COLLAPSE, .plan = hewn_simplify_plan(work, name)};
    simplify_plan *plan = &way.plan;
    if (isinf(plan->cost) || plan->far || simplify_is_tied(work, plan->gone) || !hewn_simplify_allowed(work, plan))
        return HEWN_OK;
    HEWN_TRY(hewn_simplify_probe_collapse(work, plan, &job->probe));
    keep_better(job, &way,
                hewn_simplify_count_turned(work, plan->gone, HEWN_NONE) +
                    hewn_simplify_count_turned(work, plan->kept, plan->gone));
    return HEWN_OK;
}

static hewn_result try_swap(mend_job *job, uint32_t h)
{
    const simplify_work *work = job->work;
    const mending way = {.kind = MEND_SWAP, .at = h};
    if (!hewn_simplify_may_swap(work, h))
        return HEWN_OK;
    HEWN_TRY(hewn_simplify_probe_swap(work, h, &job->probe));
    keep_better(job, &way,
                (uint32_t)hewn_simplify_is_turned(work, h / 3) + hewn_simplify_is_turned(work, work->twin[h] / 3));
    return HEWN_OK;
}

/* Whether the triangle surely faces away still with its corner `v` elsewhere. */
static bool stays_turned(const mend_job *job, uint32_t v, const double to[3])
{
    const simplify_work *work = job->work;
    const uint32_t *corner = work->tail + 3 * (size_t)job->face;
    const double *at[3];
    for (int k = 0; k < 3; k++)
        at[k] = corner[k] == v ? to : simplify_at(work, corner[k]);
    return hewn_simplify_side(work, at[0], at[1], at[2], job->near) == HEWN_SIDE_AWAY;
}

/* By so many times `step`. */
static hewn_result try_move(mend_job *job, uint32_t v, const double step[3], double times, uint32_t before)
{
    const simplify_work *work = job->work;
    mending way = {.kind = MEND_MOVE, .at = v};
    for (int axis = 0; axis < 3; axis++)
        way.plan.at[axis] = simplify_at(work, v)[axis] + times * step[axis];
    if (!hewn_simplify_may_move(work, v, way.plan.at))
        return HEWN_OK;
    if (before <= least_fewer(job) && stays_turned(job, v, way.plan.at))
        return HEWN_OK;
    HEWN_TRY(hewn_simplify_probe_move(work, v, way.plan.at, &job->probe));
    keep_better(job, &way, before);
    return HEWN_OK;
}

/* To samples of the triangles around, where the surface is: so many of each, spread. */
static hewn_result try_places(mend_job *job, uint32_t v, uint32_t before)
{
    const simplify_work *work = job->work;
    const simplify_samples *samples = work->samples;
    const uint32_t first = work->half[v];
    uint32_t h = first;
    do {
        uint32_t count = 0, at = 0;
        for (uint32_t s = samples->first[h / 3]; s != HEWN_NONE; s = samples->items[s].next)
            count++;
        for (uint32_t s = samples->first[h / 3]; s != HEWN_NONE; s = samples->items[s].next, at++) {
            double step[3];
            if (at % (count / PLACES + 1) != 0)
                continue;
            simplify_between(simplify_at(work, v), samples->items[s].at, step);
            HEWN_TRY(try_move(job, v, step, 1, before));
        }
        h = simplify_turn(work, h);
    } while (h != HEWN_NONE && h != first);
    return HEWN_OK;
}

/* A corner moves out of and into the surface, to where it was in the input, and to where samples are. */
static hewn_result try_moves(mend_job *job, uint32_t face, uint32_t v)
{
    static const double times[] = {0.25, -0.25, 0.5, -0.5, 1, -1, 2, -2};
    const simplify_work *work = job->work;
    const uint32_t *corner = work->tail + 3 * (size_t)face;
    double normal[3], step[3];
    if (work->rank[v] != SIMPLIFY_SMOOTH)
        return HEWN_OK;
    const uint32_t before = hewn_simplify_count_turned(work, v, HEWN_NONE);
    simplify_area_vector(simplify_at(work, corner[0]), simplify_at(work, corner[1]), simplify_at(work, corner[2]),
                         normal);
    const double length = sqrt(simplify_dot(normal, normal));
    for (int axis = 0; axis < 3; axis++)
        step[axis] = length > 0 ? job->most * normal[axis] / length : 0;
    for (size_t i = 0; i < sizeof times / sizeof *times; i++)
        for (int axis = 0; axis < 4; axis++) {
            const double along[3] = {axis == 0 ? job->most : 0, axis == 1 ? job->most : 0, axis == 2 ? job->most : 0};
            HEWN_TRY(try_move(job, v, axis < 3 ? along : step, times[i], before));
        }
    simplify_between(simplify_at(work, v), work->samples->positions + 3 * (size_t)work->origins[v], step);
    HEWN_TRY(try_move(job, v, step, 0.5, before));
    HEWN_TRY(try_move(job, v, step, 1, before));
    return try_places(job, v, before);
}

/* --- doing it ----------------------------------------------------------------------------------------------------- */

static hewn_result carry_out(mend_job *job)
{
    simplify_work *work = job->work;
    const mending *way = &job->best;
    job->probe.plenty = INFINITY;
    job->probe.refuses = false;
    if (way->kind == MEND_SWAP) {
        HEWN_TRY(hewn_simplify_probe_swap(work, way->at, &job->probe));
        hewn_simplify_swap(work, way->at);
    } else if (way->kind == MEND_MOVE) {
        HEWN_TRY(hewn_simplify_probe_move(work, way->at, way->plan.at, &job->probe));
        for (size_t axis = 0; axis < 3; axis++)
            work->positions[3 * (size_t)way->at + axis] = way->plan.at[axis];
    } else {
        HEWN_TRY(hewn_simplify_probe_collapse(work, &way->plan, &job->probe));
        work->live_faces -= hewn_simplify_collapse(work, &way->plan);
        work->live_vertices--;
    }
    hewn_simplify_probe_settle(work, &job->probe);
    job->clock++;
    for (uint32_t f = 0; f < job->probe.fan.count; f++) {
        const uint32_t face = job->probe.fan.blocks[f / SIMPLIFY_FOUR].face[f % SIMPLIFY_FOUR];
        job->turned[face] = 1;
        for (size_t k = 0; k < 3; k++)
            job->done[work->tail[3 * (size_t)face + k]] = job->clock;
    }
    return HEWN_OK;
}

/* Whether nothing has been done at any neighbour of a triangle's corners since nothing helped there: then nothing will,
 * for no more than the triangles around these is looked at. */
static bool is_hopeless(const mend_job *job, uint32_t face)
{
    const simplify_work *work = job->work;
    for (uint32_t k = 0; k < 3 && job->tried[face] > 0; k++) {
        const uint32_t first = work->half[work->tail[3 * face + k]];
        uint32_t h = first;
        do {
            const uint32_t in = simplify_prev(h);
            if (job->done[simplify_head(work, h)] >= job->tried[face] || job->done[work->tail[in]] >= job->tried[face])
                return false;
            h = work->twin[in];
        } while (h != HEWN_NONE && h != first);
    }
    return job->tried[face] > 0;
}

/* Edges at a corner. */
static hewn_result try_edges(mend_job *job, uint32_t v)
{
    const simplify_work *work = job->work;
    const uint32_t first = work->half[v];
    uint32_t h = first;
    do {
        const uint32_t in = simplify_prev(h);
        HEWN_TRY(try_collapse(job, simplify_name(work, h)));
        if (work->twin[h] != HEWN_NONE)
            HEWN_TRY(try_swap(job, h));
        h = work->twin[in];
    } while (h != HEWN_NONE && h != first);
    return HEWN_OK;
}

/* The best of what can be done with a triangle's edges, else at its corners, else with all edges there. */
static hewn_result mend(mend_job *job, uint32_t face)
{
    const simplify_work *work = job->work;
    const uint32_t *corner = work->tail + 3 * (size_t)face;
    for (uint32_t k = 0; k < 3; k++)
        if (work->rank[corner[k]] == SIMPLIFY_APART)
            return HEWN_OK;
    if (is_hopeless(job, face))
        return HEWN_OK;
    job->best = (mending){.kind = MEND_NOT};
    job->face = face;
    job->near = hewn_simplify_nearest(work, face);
    job->probe.enough = 0;
    job->probe.plenty = job->most;
    job->probe.refuses = true;
    for (uint32_t k = 0; k < 3; k++) {
        HEWN_TRY(try_collapse(job, simplify_name(work, 3 * face + k)));
        if (work->twin[3 * face + k] != HEWN_NONE)
            HEWN_TRY(try_swap(job, 3 * face + k));
    }
    for (uint32_t k = 0; k < 3 && job->best.kind == MEND_NOT; k++)
        HEWN_TRY(try_moves(job, face, corner[k]));
    for (uint32_t k = 0; k < 3 && job->best.kind == MEND_NOT; k++)
        HEWN_TRY(try_edges(job, corner[k]));
    job->tried[face] = job->best.kind == MEND_NOT ? job->clock + 1 : 0;
    return job->best.kind == MEND_NOT ? HEWN_OK : carry_out(job);
}

/* Those that are left. */
static uint32_t count_left(const simplify_work *work, const uint8_t *turned)
{
    uint32_t left = 0;
    for (uint32_t f = 0; f < work->face_count; f++)
        left += turned[f] && work->tail[3 * (size_t)f] != HEWN_NONE && hewn_simplify_is_turned(work, f);
    return left;
}

hewn_result hewn_simplify_right(simplify_work *work, uint32_t *left, hewn_error *error)
{
    mend_job job = {.work = work, .most = find_most(work->samples)};
    uint8_t *turned = job.turned = hewn_alloc(work->face_count, 1);
    job.tried = hewn_alloc_zero(work->face_count, sizeof *job.tried);
    job.done = hewn_alloc_zero(work->vertex_count, sizeof *job.done);
    hewn_result result = turned && job.tried && job.done ? HEWN_OK : HEWN_OUT_OF_MEMORY;
#pragma omp parallel for schedule(dynamic, 64) if (work->vertex_count > SIMPLIFY_FEW / 8)
    for (uint32_t f = 0; f < (turned ? work->face_count : 0); f++)
        turned[f] = hewn_simplify_is_turned(work, f);
    for (int pass = 0; pass < PASSES; pass++)
        for (uint32_t f = 0; f < work->face_count && result == HEWN_OK; f++)
            if (turned[f] && work->tail[3 * (size_t)f] != HEWN_NONE && hewn_simplify_is_turned(work, f))
                result = mend(&job, f);
    *left = result == HEWN_OK ? count_left(work, turned) : 0;
    hewn_free(turned);
    hewn_free(job.tried);
    hewn_free(job.done);
    hewn_simplify_probe_release(&job.probe);
    return result == HEWN_OK ? hewn_simplify_order(work, 0, error)
                             : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
}
