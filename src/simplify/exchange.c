#include "simplify/exchange.h"

#include <stdlib.h>

#include "base/alloc.h"
#include "base/error.h"
#include "simplify/fit.h"
#include "simplify/split.h"

/* What is further away counts more: by this times the square of how many times the mean it is. Past this share of the
 * greatest distance no collapse may bring anything. A split must bring this many times what the collapse takes. */
static const double far_weight = 0.2, far_share = 0.85, least_more = 1.3;

/* What a triangle that faces away counts, as a share of all there is. */
static const double turned_share = 0.02;

/* One of so many triangles is exchanged at a time, and so many times. */
enum { SHARE = 24, ROUNDS = 2 };

/* Of edges that may be, so many times those that are exchanged are looked at. */
enum { SPLITS = 4, COLLAPSES = 8 };

typedef struct exchange_job {
    simplify_work *work;
    double mean, most, all; /* distances, and the sum that is to become less */
    float *loss, *gain;     /* at names of edges: by a collapse, by a split */
    uint32_t *sample;       /* likewise: where the split's vertex would be */
    uint8_t *turned;        /* one a triangle */
    uint8_t *touched;       /* vertices around which something has changed in this round */
    uint32_t vertex, face;  /* the next free ones */
    simplify_probe probe;
} exchange_job;

/* --- what it brings ----------------------------------------------------------------------------------------------- */

static double count_for(const exchange_job *job, uint32_t sample, double square)
{
    const double times = square / (job->mean * job->mean);
    return (double)job->work->samples->items[sample].weight * square * (1 + far_weight * times);
}

static void find_all(exchange_job *job)
{
    const simplify_samples *samples = job->work->samples;
    double sum = 0, weight = 0;
    job->most = job->all = 0;
    for (uint32_t s = 0; s < samples->count; s++) {
        sum += (double)samples->items[s].weight * (double)samples->items[s].gap;
        weight += (double)samples->items[s].weight;
        job->most = fmax(job->most, (double)samples->items[s].gap);
    }
    job->mean = weight > 0 ? sum / weight : 0;
    for (uint32_t s = 0; s < samples->count && job->mean > 0; s++)
        job->all += count_for(job, s, (double)samples->items[s].gap * (double)samples->items[s].gap);
}

/* What the probe has found: how much more the sum is. */
static double change_of(const exchange_job *job)
{
    double change = 0;
    for (size_t i = 0; i < job->probe.point_count; i++) {
        const simplify_fan_point *point = &job->probe.points[i];
        const double was = (double)job->work->samples->items[point->sample].gap;
        change += count_for(job, point->sample, point->square) - count_for(job, point->sample, was * was);
    }
    return change;
}

/* Whether the probe has found what may be. */
static bool is_fair(const exchange_job *job, double most)
{
    return !job->probe.cut && !job->probe.turned && fmax(job->probe.most, job->probe.back) <= most;
}

static hewn_result probe_collapse(exchange_job *job, uint32_t name, simplify_plan *plan, bool *fair)
{
    const simplify_work *work = job->work;
    *fair = false;
    *plan = hewn_simplify_plan(work, name);
    if (isinf(plan->cost) || plan->far || !hewn_simplify_allowed(work, plan) || plan->slim)
        return HEWN_OK;
    job->probe.enough = 0;
    job->probe.plenty = far_share * job->most;
    HEWN_TRY(hewn_simplify_probe_collapse(work, plan, &job->probe));
    *fair = is_fair(job, far_share * job->most);
    return HEWN_OK;
}

/* The sample furthest from two triangles that the mesh has no vertex for. */
static uint32_t furthest(const simplify_work *work, uint32_t h)
{
    const simplify_samples *samples = work->samples;
    uint32_t best = HEWN_NONE;
    float most = 0;
    for (int side = 0; side < 2; side++)
        for (uint32_t s = samples->first[(side ? work->twin[h] : h) / 3]; s != HEWN_NONE; s = samples->items[s].next)
            if (samples->items[s].gap > most && hewn_simplify_free_origin(work, s) != HEWN_NONE) {
                best = s;
                most = samples->items[s].gap;
            }
    return best;
}

static hewn_result probe_split(exchange_job *job, uint32_t name, simplify_split *split, bool *fair)
{
    const simplify_work *work = job->work;
    *fair = false;
    *split = (simplify_split){
        .half = name, .sample = job->sample[name], .vertex = job->vertex, .faces = {job->face, job->face + 1}};
    if (split->sample == HEWN_NONE)
        return HEWN_OK;
    split->origin = hewn_simplify_free_origin(work, split->sample);
    if (split->origin == HEWN_NONE || !hewn_simplify_split_allowed(work, split))
        return HEWN_OK;
    job->probe.enough = job->most;
    job->probe.plenty = INFINITY;
    HEWN_TRY(hewn_simplify_probe_split(work, split, &job->probe));
    *fair = is_fair(job, job->most);
    return HEWN_OK;
}

static hewn_result judge_collapse(exchange_job *job, uint32_t name)
{
    simplify_plan plan;
    bool fair;
    HEWN_TRY(probe_collapse(job, name, &plan, &fair));
    job->loss[name] = fair ? (float)fmax(change_of(job), 0) : INFINITY;
    return HEWN_OK;
}

static hewn_result judge_split(exchange_job *job, uint32_t name)
{
    const simplify_work *work = job->work;
    simplify_split split;
    bool fair;
    job->gain[name] = 0;
    job->sample[name] = furthest(work, name);
    HEWN_TRY(probe_split(job, name, &split, &fair));
    if (!fair)
        return HEWN_OK;
    const uint32_t before = (uint32_t)job->turned[name / 3] + job->turned[work->twin[name] / 3];
    double gain = -change_of(job);
    if (before > 0)
        gain += turned_share * job->all *
                ((double)before - (double)hewn_simplify_probe_turns(work, &job->probe, UINT32_MAX));
    job->gain[name] = (float)fmax(gain, 0);
    return HEWN_OK;
}

/* --- which are looked at ------------------------------------------------------------------------------------------ */

static bool is_edge(const simplify_work *work, uint32_t h)
{
    return work->tail[h - h % 3] != HEWN_NONE && simplify_name(work, h) == h;
}

/* What could be gained at one triangle. */
static double count_face(const exchange_job *job, uint32_t face)
{
    const simplify_samples *samples = job->work->samples;
    double sum = job->turned[face] ? turned_share * job->all : 0;
    for (uint32_t s = samples->first[face]; s != HEWN_NONE; s = samples->items[s].next)
        sum += count_for(job, s, (double)samples->items[s].gap * (double)samples->items[s].gap);
    return sum;
}

static int compare(const void *a, const void *b)
{
    const float p = *(const float *)a, q = *(const float *)b;
    return p < q ? -1 : p > q;
}

/* The value that `wanted` of so many are below or just about. */
static float find_bound(float *values, uint32_t count, uint32_t wanted)
{
    qsort(values, count, sizeof *values, compare);
    return wanted < count ? values[wanted] : INFINITY;
}

/* Probes take long, so only those edges are looked at that cost least by their quadrics and could gain most. Begins
 * with that in `loss` and, negated, in `gain`; `values` has room for one an edge. */
static hewn_result judge_edges(exchange_job *job, uint32_t halves, uint32_t most, float *values)
{
    const simplify_work *work = job->work;
    uint32_t count = 0;
    for (uint32_t h = 0; h < halves; h++) {
        const bool edge = is_edge(work, h);
        job->loss[h] = edge ? (float)hewn_simplify_plan(work, h).cost : INFINITY;
        job->gain[h] = edge && hewn_simplify_may_split(work, h)
                           ? -(float)(count_face(job, h / 3) + count_face(job, work->twin[h] / 3))
                           : 0;
        if (edge)
            values[count++] = job->loss[h];
    }
    const float cheap = find_bound(values, count, COLLAPSES * most);
    count = 0;
    for (uint32_t h = 0; h < halves; h++)
        if (is_edge(work, h))
            values[count++] = job->gain[h];
    const float rich = find_bound(values, count, SPLITS * most);
    for (uint32_t h = 0; h < halves; h++) {
        const bool splits = job->gain[h] < 0 && job->gain[h] <= rich, collapses = job->loss[h] <= cheap;
        job->gain[h] = 0;
        if (splits)
            HEWN_TRY(judge_split(job, h));
        if (collapses && !isinf(job->loss[h]))
            HEWN_TRY(judge_collapse(job, h));
        else
            job->loss[h] = INFINITY;
    }
    return HEWN_OK;
}

/* --- doing it ----------------------------------------------------------------------------------------------------- */

static bool is_ring_touched(const exchange_job *job, uint32_t v)
{
    const simplify_work *work = job->work;
    const uint32_t first = work->half[v];
    uint32_t h = first;
    do {
        const uint32_t in = simplify_prev(h);
        if (job->touched[simplify_head(work, h)] || job->touched[work->tail[in]])
            return true;
        h = work->twin[in];
    } while (h != HEWN_NONE && h != first);
    return false;
}

static void touch_ring(exchange_job *job, uint32_t v)
{
    const simplify_work *work = job->work;
    const uint32_t first = work->half[v];
    uint32_t h = first;
    job->touched[v] = 1;
    do {
        const uint32_t in = simplify_prev(h);
        job->touched[simplify_head(work, h)] = job->touched[work->tail[in]] = 1;
        h = work->twin[in];
    } while (h != HEWN_NONE && h != first);
}

static bool is_split_free(const exchange_job *job, uint32_t h)
{
    const simplify_work *work = job->work;
    const uint32_t t = work->twin[h];
    return t != HEWN_NONE && !job->touched[work->tail[h]] && !job->touched[work->tail[t]] &&
           !job->touched[work->tail[simplify_prev(h)]] && !job->touched[work->tail[simplify_prev(t)]];
}

/* The best edge to split that is free; HEWN_NONE. */
static uint32_t best_split(const exchange_job *job, uint32_t halves)
{
    uint32_t best = HEWN_NONE;
    for (uint32_t h = 0; h < halves; h++)
        if (is_edge(job->work, h) && job->gain[h] > (best == HEWN_NONE ? 0 : job->gain[best]) && is_split_free(job, h))
            best = h;
    return best;
}

static uint32_t best_collapse(const exchange_job *job, uint32_t halves)
{
    const simplify_work *work = job->work;
    uint32_t best = HEWN_NONE;
    for (uint32_t h = 0; h < halves; h++)
        if (is_edge(work, h) && job->loss[h] < (best == HEWN_NONE ? INFINITY : job->loss[best]) &&
            !is_ring_touched(job, work->tail[h]) && !is_ring_touched(job, simplify_head(work, h)))
            best = h;
    return best;
}

/* `*done`, or its gain is none any more. */
static hewn_result split(exchange_job *job, uint32_t name, bool *done)
{
    simplify_work *work = job->work;
    simplify_split what;
    const uint32_t t = work->twin[name], before = (uint32_t)job->turned[name / 3] + job->turned[t / 3];
    HEWN_TRY(probe_split(job, name, &what, done));
    *done = *done && hewn_simplify_probe_turns(work, &job->probe, before) <= before;
    if (!*done) {
        job->gain[name] = 0;
        return HEWN_OK;
    }
    const uint32_t corners[4] = {work->tail[name], work->tail[t], work->tail[simplify_prev(name)],
                                 work->tail[simplify_prev(t)]};
    hewn_simplify_probe_settle(work, &job->probe);
    hewn_simplify_split(work, &what);
    for (int k = 0; k < 4; k++)
        job->touched[corners[k]] = 1;
    job->touched[what.vertex] = 1;
    job->vertex++;
    job->face += 2;
    return HEWN_OK;
}

static hewn_result collapse(exchange_job *job, uint32_t name, bool *done)
{
    simplify_work *work = job->work;
    simplify_plan plan;
    HEWN_TRY(probe_collapse(job, name, &plan, done));
    *done = *done && hewn_simplify_probe_turns(work, &job->probe, 0) == 0;
    if (!*done) {
        job->loss[name] = INFINITY;
        return HEWN_OK;
    }
    touch_ring(job, plan.gone);
    touch_ring(job, plan.kept);
    hewn_simplify_probe_settle(work, &job->probe);
    work->live_faces -= hewn_simplify_collapse(work, &plan);
    work->live_vertices--;
    return HEWN_OK;
}

/* Where there is room for two triangles, an edge is split; else one collapses whose room is worth more elsewhere. */
static hewn_result exchange_one(exchange_job *job, uint32_t halves, uint32_t target, bool *again)
{
    bool done = false;
    const uint32_t fine = best_split(job, halves);
    *again = fine != HEWN_NONE && job->vertex < job->work->vertex_count;
    if (!*again)
        return HEWN_OK;
    if (job->work->live_faces + 2 <= target)
        return split(job, fine, &done);
    const uint32_t coarse = best_collapse(job, halves);
    *again = coarse != HEWN_NONE && job->gain[fine] > least_more * (double)job->loss[coarse];
    return *again ? collapse(job, coarse, &done) : HEWN_OK;
}

static hewn_result exchange_round(exchange_job *job, uint32_t target, uint32_t most, float *values, uint32_t *count)
{
    const uint32_t halves = 3 * job->face;
    bool again = true;
    find_all(job);
    *count = 0;
    if (!(job->mean > 0))
        return HEWN_OK;
    for (uint32_t f = 0; f < halves / 3; f++)
        job->turned[f] = hewn_simplify_is_turned(job->work, f);
    HEWN_TRY(judge_edges(job, halves, most, values));
    while (again) {
        HEWN_TRY(exchange_one(job, halves, target, &again));
        *count += again;
    }
    return HEWN_OK;
}

static hewn_result run_round(simplify_work *work, uint32_t target, bool last, uint32_t *count, hewn_error *error)
{
    const uint32_t faces = work->face_count, most = faces / SHARE + 1;
    exchange_job job = {.work = work, .probe = {.sums = true}, .vertex = work->vertex_count, .face = faces};
    HEWN_TRY(hewn_simplify_grow(work, most, 2 * most, error));
    job.loss = hewn_alloc(faces, 3 * sizeof *job.loss);
    job.gain = hewn_alloc(faces, 3 * sizeof *job.gain);
    job.sample = hewn_alloc(faces, 3 * sizeof *job.sample);
    job.turned = hewn_alloc(faces, 1);
    job.touched = hewn_alloc_zero(work->vertex_count, 1);
    float *values = hewn_alloc(faces, 3 * sizeof *values);
    hewn_result result =
        job.loss && job.gain && job.sample && job.turned && job.touched && values ? HEWN_OK : HEWN_OUT_OF_MEMORY;
    if (result == HEWN_OK)
        result = exchange_round(&job, target, most, values, count);
    hewn_free(job.loss);
    hewn_free(job.gain);
    hewn_free(job.sample);
    hewn_free(job.turned);
    hewn_free(job.touched);
    hewn_free(values);
    hewn_simplify_probe_release(&job.probe);
    if (result != HEWN_OK)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
    HEWN_TRY(hewn_simplify_order(work, 0, error));
    return hewn_simplify_fit(work, last || *count == 0, error);
}

hewn_result hewn_simplify_exchange(simplify_work *work, uint32_t target, hewn_error *error)
{
    const uint32_t most = work->live_faces > target ? work->live_faces : target;
    uint32_t count = 1;
    if (work->groups || work->wedge)
        return HEWN_OK;
    for (int i = 0; i < ROUNDS && count > 0; i++)
        HEWN_TRY(run_round(work, most, i + 1 == ROUNDS, &count, error));
    return HEWN_OK;
}
