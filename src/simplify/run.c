#include <float.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/progress.h"
#include "simplify/collapse.h"
#include "simplify/queue.h"
#include "simplify/samples.h"

/* Vertices of a part: what its collapses touch fits in a core's second cache. With samples there is more to do for
 * each, and fewer of them. */
enum { PART = 4096, PROBED_PART = 1024, MOST_ROUNDS = 40, BINS = 1 << 16 };

static uint32_t part_of(const simplify_work *work)
{
    return work->samples ? PROBED_PART : PART;
}

/* How much more a collapse that makes a sliver costs. In what is flat that is little still: there, only slivers may be
 * left to make. */
static const float slim_factor = 100;

/* Costs grow while edges go: the last ones to go cost about the square of how many times the triangles are to be less,
 * times what as many edges cost less than now. Limits of rounds are somewhat less than that; where more rounds with
 * samples follow, which edges go before others matters less than how many rounds there are. */
static const double growth = 1.5, early_growth = 2.5;

/* --- one queue ---------------------------------------------------------------------------------------------------- */

/* Edges that are collapsed in the order of their costs: all, or those inside one part. */
typedef struct edge_front {
    simplify_work *work;
    simplify_queue queue;
    const uint8_t *inside; /* one a vertex: all neighbours are of the same part. NULL: one part */
    float limit;           /* the greatest cost */
    uint32_t budget;       /* the most triangles to remove */
    uint32_t removed;
    simplify_probe probe;
} edge_front;

static bool may_queue(const edge_front *front, uint32_t name)
{
    const simplify_work *work = front->work;
    return work->key[name] <= front->limit && !isinf(work->key[name]) &&
           (!front->inside || (front->inside[work->tail[name]] && front->inside[simplify_head(work, name)]));
}

static hewn_result enqueue(edge_front *front, uint32_t name)
{
    front->work->flags[name] |= SIMPLIFY_QUEUED;
    return simplify_queue_push(&front->queue, simplify_item(front->work->key[name], name));
}

/* An item whose edge has gone, has got another name or cost, or was here twice means nothing. */
static bool is_current(const simplify_work *work, uint64_t item)
{
    const uint32_t name = (uint32_t)item;
    return work->tail[name - name % 3] != HEWN_NONE && simplify_name(work, name) == name &&
           simplify_item(work->key[name], name) == item && work->flags[name] & SIMPLIFY_QUEUED;
}

/* Edges around a vertex that wait nowhere: made of two, or refused before. */
static hewn_result requeue_around(edge_front *front, uint32_t v)
{
    const simplify_work *work = front->work;
    const uint32_t first = work->half[v];
    uint32_t h = first;
    do {
        const uint32_t in = simplify_prev(h), name = simplify_name(work, h), last = simplify_name(work, in);
        if (!(work->flags[name] & SIMPLIFY_QUEUED) && may_queue(front, name))
            HEWN_TRY(enqueue(front, name));
        if (last == in && !(work->flags[in] & SIMPLIFY_QUEUED) && may_queue(front, in))
            HEWN_TRY(enqueue(front, in));
        h = work->twin[in];
    } while (h != HEWN_NONE && h != first);
    return HEWN_OK;
}

/* A collapse costs at least what its distance does, by the fourth power of that: so what is far away waits, and what is
 * near waits for nothing. */
static float price_of(const simplify_work *work, uint32_t name, const simplify_probe *probe)
{
    const double far = fmax(probe->most, probe->back) / work->samples->aim;
    const double cost = fmax((double)work->key[name], work->samples->price * (far * far) * (far * far));
    return (float)fmin(probe->turned ? work->samples->turned_factor * cost : cost, FLT_MAX);
}

/* The distance that has a price. */
static double reach_of(const simplify_work *work, float cost)
{
    return work->samples->aim * sqrt(sqrt((double)cost / work->samples->price));
}

/* Prices an edge by what becomes of samples; whether others are cheaper now. */
static bool grows_dear(edge_front *front, uint32_t name)
{
    simplify_work *work = front->work;
    const float cost = price_of(work, name, &front->probe), before = work->key[name];
    work->flags[name] |= front->probe.cut ? 0 : SIMPLIFY_PROBED;
    work->key[name] = fmaxf(before, cost);
    return cost > before && (cost > front->limit || (!simplify_queue_is_empty(&front->queue) &&
                                                     simplify_item(cost, name) > simplify_queue_head(&front->queue)));
}

/* An edge that is about to collapse: whether that turns a triangle away from what is nearest in all of the input, which
 * costs as much as if it did from what is near among samples. */
static bool turns_away(edge_front *front, uint32_t name)
{
    simplify_work *work = front->work;
    if (!work->samples->strict || work->flags[name] & SIMPLIFY_STRICT)
        return false;
    work->flags[name] |= SIMPLIFY_STRICT;
    if (front->probe.turned > 0 || hewn_simplify_probe_turns(work, &front->probe, 0) == 0)
        return false;
    work->key[name] =
        (float)fmin(work->samples->turned_factor * fmax((double)work->key[name], work->samples->price), FLT_MAX);
    return true;
}

/* Looks what becomes of samples. `*dear`: others are cheaper, the edge's key has grown. Else samples go where they will
 * be. Edges of a complex take theirs along, whatever becomes of them. */
static hewn_result probe_plan(edge_front *front, const simplify_plan *plan, bool *dear)
{
    simplify_work *work = front->work;
    const uint32_t name = plan->half;
    simplify_side sides[SIMPLIFY_MOST_TIED];
    const bool tied = simplify_is_tied(work, plan->gone);
    if (!work->samples)
        return HEWN_OK;
    const bool priced = tied || work->flags[name] & SIMPLIFY_PROBED;
    const float next =
        simplify_queue_is_empty(&front->queue) ? FLT_MAX : simplify_item_cost(simplify_queue_head(&front->queue));
    front->probe.enough = reach_of(work, work->key[name]);
    front->probe.plenty = priced ? INFINITY : 1.01 * reach_of(work, fminf(next, front->limit));
    const uint32_t count = hewn_simplify_sides(work, plan, sides);
    for (uint32_t i = 0; i < count; i++) {
        simplify_plan side = *plan;
        side.gone = sides[i].gone;
        side.kept = sides[i].kept;
        HEWN_TRY(hewn_simplify_probe_collapse(work, &side, &front->probe));
        if (!priced) {
            *dear = grows_dear(front, name);
            if (!*dear &&
                front->probe.cut) { /* where costs are nearly 0 a price tells nothing: all samples are placed */
                front->probe.plenty = INFINITY;
                HEWN_TRY(hewn_simplify_probe_collapse(work, &side, &front->probe));
                *dear = grows_dear(front, name);
            }
            if (*dear)
                return HEWN_OK;
        }
        *dear = !tied && turns_away(front, name);
        if (*dear)
            return HEWN_OK;
        hewn_simplify_probe_settle(work, &front->probe);
    }
    return HEWN_OK;
}

/* Collapses the edge of the least item, or finds that there is nothing to do. */
static hewn_result step(edge_front *front)
{
    simplify_work *work = front->work;
    const uint64_t item = simplify_queue_take(&front->queue);
    const uint32_t name = (uint32_t)item;
    if (!is_current(work, item))
        return HEWN_OK;
    simplify_plan plan = hewn_simplify_plan(work, name);
    work->flags[name] &= (uint8_t)~SIMPLIFY_QUEUED;
    if (!(work->flags[name] & SIMPLIFY_FRESH)) {
        const float cost = (float)plan.cost;
        work->key[name] = cost;
        work->flags[name] = (uint8_t)((work->flags[name] & ~SIMPLIFY_RAISED) | SIMPLIFY_FRESH);
        if (cost > front->limit || isinf(cost))
            return HEWN_OK;
        if (!simplify_queue_is_empty(&front->queue) && simplify_item(cost, name) > simplify_queue_head(&front->queue))
            return enqueue(front, name);
    }
    if (plan.far || !hewn_simplify_allowed(work, &plan))
        return HEWN_OK;
    if (plan.slim && work->wedges && work->wedges->counted > 0) /* attributes would be stretched along it */
        return HEWN_OK;
    if (plan.slim && !(work->flags[name] & SIMPLIFY_SLIM)) {
        work->key[name] *= slim_factor;
        work->flags[name] |= SIMPLIFY_SLIM;
        return may_queue(front, name) ? enqueue(front, name) : HEWN_OK;
    }
    bool dear = false;
    HEWN_TRY(probe_plan(front, &plan, &dear));
    if (dear)
        return may_queue(front, name) ? enqueue(front, name) : HEWN_OK;
    front->removed += hewn_simplify_collapse(work, &plan);
    for (uint32_t v = plan.kept;;) {
        if (work->rank[v] != SIMPLIFY_APART)
            HEWN_TRY(requeue_around(front, v));
        v = work->tie ? work->tie[v] : v;
        if (v == plan.kept)
            return HEWN_OK;
    }
}

static hewn_result drain(edge_front *front)
{
    simplify_queue_settle(&front->queue);
    while (!simplify_queue_is_empty(&front->queue) && front->removed < front->budget)
        HEWN_TRY(step(front));
    return HEWN_OK;
}

/* --- parts -------------------------------------------------------------------------------------------------------- */

/* Marks vertices none of whose neighbours are of another part. */
static void find_inside(const simplify_work *work, uint8_t *inside)
{
    const uint32_t part = part_of(work);
#pragma omp parallel for schedule(static)
    for (uint32_t v = 0; v < work->vertex_count; v++) {
        uint32_t first = work->half[v], h = first;
        inside[v] = work->rank[v] != SIMPLIFY_APART && !simplify_is_tied(work, v);
        if (!inside[v])
            continue;
        do {
            uint32_t in = simplify_prev(h);
            inside[v] &= simplify_head(work, h) / part == v / part && work->tail[in] / part == v / part;
            h = work->twin[in];
        } while (h != HEWN_NONE && h != first);
    }
}

/* The cost that `wanted` edges are below or just about. */
static float find_limit(const simplify_work *work, uint32_t wanted, uint32_t *bins)
{
    const uint32_t halves = 3 * work->face_count;
    for (uint32_t b = 0; b < BINS; b++)
        bins[b] = 0;
    for (uint32_t h = 0; h < halves; h++)
        if (simplify_name(work, h) == h)
            bins[simplify_item(work->key[h], 0) >> 48]++;
    uint32_t sum = 0, b = 0;
    for (; b < BINS - 1 && sum + bins[b] < wanted; b++)
        sum += bins[b];
    const float limit = simplify_item_cost((uint64_t)b << 48 | 0xFFFF00000000u);
    return isfinite(limit) ? limit : FLT_MAX;
}

typedef struct part_list {
    simplify_work *work;
    uint8_t *inside;
    uint32_t *faces; /* the first triangle of each part, by its first vertex; and one more */
    uint32_t *edges; /* that wait in each part */
    uint32_t count;
    float limit;
} part_list;

/* Triangles are in the order of their first vertices, so those of a part are together; edges inside it are theirs. */
static void split(part_list *parts)
{
    const simplify_work *work = parts->work;
    const uint32_t size = part_of(work);
    parts->count = (work->vertex_count + size - 1) / size;
    uint32_t part = 0;
    for (uint32_t f = 0; f < work->face_count; f++) {
        const uint32_t *corner = work->tail + 3 * (size_t)f;
        uint32_t least = corner[0] < corner[1] ? corner[0] : corner[1];
        least = corner[2] < least ? corner[2] : least;
        while (part <= least / size)
            parts->faces[part++] = f;
    }
    while (part <= parts->count)
        parts->faces[part++] = work->face_count;
}

static void count_edges(part_list *parts)
{
    const simplify_work *work = parts->work;
    edge_front all = {.work = parts->work, .inside = parts->inside, .limit = parts->limit};
#pragma omp parallel for schedule(dynamic)
    for (uint32_t p = 0; p < parts->count; p++) {
        parts->edges[p] = 0;
        for (uint32_t h = 3 * parts->faces[p]; h < 3 * parts->faces[p + 1]; h++)
            if (simplify_name(work, h) == h) {
                parts->work->flags[h] &= (uint8_t)~SIMPLIFY_QUEUED;
                parts->edges[p] += may_queue(&all, h);
            }
    }
}

static hewn_result run_part(const part_list *parts, uint32_t p, edge_front *front)
{
    const simplify_work *work = parts->work;
    hewn_result result = hewn_reserve((void **)&front->queue.items, &front->queue.capacity, parts->edges[p] + 1,
                                      sizeof *front->queue.items, NULL);
    front->queue.count = 0;
    front->queue.hollow = false;
    front->removed = 0;
    if (result != HEWN_OK)
        return result;
    for (uint32_t h = 3 * parts->faces[p]; h < 3 * parts->faces[p + 1]; h++)
        if (simplify_name(work, h) == h && may_queue(front, h)) {
            work->flags[h] |= SIMPLIFY_QUEUED;
            front->queue.items[front->queue.count++] = simplify_item(work->key[h], h);
        }
    return drain(front);
}

/* Each part gets its share of what is to be removed, so that together they never remove too much. */
static hewn_result run_parts(const part_list *parts, uint32_t wanted, uint32_t *removed)
{
    simplify_work *work = parts->work;
    uint64_t all = 0;
    uint32_t sum = 0;
    int failed = 0;
    for (uint32_t p = 0; p < parts->count; p++)
        all += parts->edges[p];
#pragma omp parallel reduction(+ : sum) reduction(| : failed)
    {
        edge_front front = {.work = work, .inside = parts->inside, .limit = parts->limit};
#pragma omp for schedule(dynamic)
        for (uint32_t p = 0; p < parts->count; p++) {
            const uint64_t share = all > 0 ? (uint64_t)wanted * parts->edges[p] / all : 0;
            front.budget = share > 0 ? (uint32_t)share - 1 : 0; /* the last collapse may take one more */
            failed |= run_part(parts, p, &front) != HEWN_OK;
            sum += front.removed;
        }
        hewn_free(front.queue.items);
        hewn_simplify_probe_release(&front.probe);
    }
    *removed = sum;
    return failed ? HEWN_OUT_OF_MEMORY : HEWN_OK;
}

static void recount(simplify_work *work)
{
    uint32_t verts = 0;
    for (uint32_t v = 0; v < work->vertex_count; v++)
        verts += work->half[v] != SIMPLIFY_GONE;
    work->live_vertices = verts;
}

/* `*limit` is that of the rounds before, and never becomes less: what is left between parts costs little. */
static hewn_result run_round(simplify_work *work, uint32_t target, bool early, float *limit, uint32_t *removed)
{
    part_list parts = {.work = work};
    const uint32_t most_parts = work->vertex_count / part_of(work) + 2, wanted = work->live_faces - target;
    uint32_t *bins = hewn_alloc(BINS, sizeof *bins);
    parts.inside = hewn_alloc(work->vertex_count, 1);
    parts.faces = hewn_alloc(most_parts, sizeof *parts.faces);
    parts.edges = hewn_alloc(most_parts, sizeof *parts.edges);
    hewn_result result = bins && parts.inside && parts.faces && parts.edges ? HEWN_OK : HEWN_OUT_OF_MEMORY;
    if (result == HEWN_OK) {
        find_inside(work, parts.inside);
        split(&parts);
        const double more = pow((double)work->live_faces / target, early ? early_growth : growth);
        parts.limit = fmaxf(*limit, (float)fmin((double)find_limit(work, wanted, bins) * more, FLT_MAX));
        *limit = parts.limit;
        count_edges(&parts);
        result = run_parts(&parts, wanted, removed);
        work->live_faces -= *removed;
        recount(work);
    }
    hewn_free(bins);
    hewn_free(parts.inside);
    hewn_free(parts.faces);
    hewn_free(parts.edges);
    return result;
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

/* One queue of all edges, for what parts leave. */
static hewn_result finish(simplify_work *work, uint32_t target)
{
    edge_front front = {.work = work, .limit = FLT_MAX, .budget = work->live_faces - target};
    hewn_result result = HEWN_OK;
    for (uint32_t h = 0; h < 3 * work->face_count && result == HEWN_OK; h++) {
        if (simplify_name(work, h) != h)
            continue;
        work->flags[h] &= (uint8_t)~SIMPLIFY_QUEUED;
        if (may_queue(&front, h)) {
            result = hewn_reserve((void **)&front.queue.items, &front.queue.capacity, front.queue.count + 1,
                                  sizeof *front.queue.items, NULL);
            if (result == HEWN_OK)
                front.queue.items[front.queue.count++] = simplify_item(work->key[h], h);
            work->flags[h] |= SIMPLIFY_QUEUED;
        }
    }
    if (result == HEWN_OK)
        result = drain(&front);
    hewn_free(front.queue.items);
    hewn_simplify_probe_release(&front.probe);
    work->live_faces -= front.removed;
    recount(work);
    return result;
}

/* What the last collapses will cost, from what they cost now, and how far away things would be if they cost that. */
static bool set_aim(simplify_work *work, uint32_t target)
{
    uint32_t *bins = hewn_alloc(BINS, sizeof *bins);
    double weight = 0;
    if (!bins)
        return false;
    for (uint32_t v = 0; v < work->vertex_count; v++)
        weight += work->quadrics[v].weight;
    const double share = (double)work->live_faces / target;
    const double last = fmax((double)find_limit(work, work->live_faces - target, bins) * share * share, DBL_MIN);
    work->samples->price = last;
    work->samples->aim = weight > 0 ? work->samples->aim_factor * sqrt(last * target / (2 * weight)) : 1;
    hewn_free(bins);
    return true;
}

hewn_result hewn_simplify_run(simplify_work *work, uint32_t target, bool early, hewn_error *error)
{
    const uint32_t began = work->live_faces;
    bool ordered = true; /* as by round 0, which sorting again does not change */
    float limit = 0;
    if (work->samples && target < began && !set_aim(work, target))
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
    for (uint32_t round = 0; round < MOST_ROUNDS && work->live_faces > target; round++) {
        const double done = (double)(began - work->live_faces) / (double)(began - target + 1);
        HEWN_TRY(hewn_progress_report(work->desc->progress, "simplify",
                                      work->progress_begin + (work->progress_end - work->progress_begin) * done,
                                      error));
        if (round > 0)
            HEWN_TRY(hewn_simplify_order(work, round, error));
        if (work->vertex_count <= 2 * part_of(work) || (work->live_faces - target) < began / 50)
            break;
        uint32_t removed = 0, wanted = work->live_faces - target;
        ordered = false;
        if (run_round(work, target, early, &limit, &removed) != HEWN_OK)
            return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
        if (removed < wanted / 10)
            break;
    }
    if (work->live_faces > target) {
        if (!ordered)
            HEWN_TRY(hewn_simplify_order(work, 0, error));
        if (finish(work, target) != HEWN_OK)
            return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
    }
    return work->live_faces < began ? hewn_simplify_order(work, 0, error) : HEWN_OK;
}
