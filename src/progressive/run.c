/* Folding vertices in the order of their costs. */
#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/progress.h"
#include "progressive/fold.h"

/* --- one fold ----------------------------------------------------------------------------------------------------- */

static hewn_result make_room(fold *of, uint32_t list, uint32_t count, hewn_error *error)
{
    HEWN_TRY(hewn_reserve((void **)&of->pool, &of->pool_room, of->pool_count + list, sizeof *of->pool, error));
    HEWN_TRY(hewn_reserve((void **)&of->records, &of->record_room, of->record_count + 1, sizeof *of->records, error));
    HEWN_TRY(
        hewn_reserve((void **)&of->changes, &of->change_room, of->change_count + count, sizeof *of->changes, error));
    return hewn_reserve((void **)&of->gone, &of->gone_room, of->gone_count + 2, sizeof *of->gone, error);
}

/* The list of `into` gets the triangles that change hands, at the pool's end where they do not fit in its place. */
static void join_lists(fold *of, uint32_t vertex, uint32_t into)
{
    uint32_t *const list = of->pool + of->list_first[into], *const end = of->pool + of->pool_count;
    uint32_t count = 0;
    for (uint32_t i = 0; i < of->list_count[into]; i++)
        if (!of->removed[list[i]])
            end[count++] = list[i];
    for (uint32_t i = 0; i < of->list_count[vertex]; i++)
        if (!of->removed[of->pool[of->list_first[vertex] + i]])
            end[count++] = of->pool[of->list_first[vertex] + i];
    if (count <= of->list_count[into]) {
        memcpy(list, end, count * sizeof *list);
    } else {
        of->list_first[into] = (uint32_t)of->pool_count;
        of->pool_count += count;
    }
    of->list_count[into] = count;
    of->list_count[vertex] = 0;
}

static uint32_t wedge_after(const fold *of, const fold_star *star, uint32_t i, uint32_t own)
{
    const uint32_t a = i > 0 ? i - 1 : star->count - 1;
    (void)of;
    if (i < star->count && star->own[i] == own)
        return star->next[i];
    return star->previous[a];
}

static void add_quadric(fold_quadric *to, const fold_quadric *from)
{
    for (int k = 0; k < 6; k++)
        to->a[k] += from->a[k];
    for (int k = 0; k < 3; k++)
        to->b[k] += from->b[k];
    to->c += from->c;
}

/* The triangles of the star: two go, the others change a corner. */
static void change_triangles(fold *of, uint32_t into, const fold_star *star, uint32_t i, float deviation)
{
    for (uint32_t t = 0; t < star->count; t++) {
        const uint32_t triangle = star->triangle[t];
        if (of->wedge_vertices[star->next[t]] == into || of->wedge_vertices[star->previous[t]] == into) {
            of->removed[triangle] = 1;
            of->gone[of->gone_count++] = triangle;
            of->live_triangles--;
            continue;
        }
        uint32_t corner = 3 * triangle;
        while (of->triangles[corner] != star->own[t])
            corner++;
        const uint32_t wedge = wedge_after(of, star, i, star->own[t]);
        of->changes[of->change_count++] = (progressive_change){corner, wedge, star->own[t]};
        of->triangles[corner] = wedge;
        of->deviations[triangle] = deviation;
    }
}

hewn_result hewn_fold_do(fold *of, uint32_t vertex, const fold_star *star, uint32_t i, hewn_error *error)
{
    const uint32_t into = hewn_fold_neighbour(of, star, i);
    double deviation = 0;
    HEWN_TRY(make_room(of, of->list_count[vertex] + of->list_count[into], star->count, error));
    if (of->pool_count + of->list_count[vertex] + of->list_count[into] >= UINT32_MAX)
        return hewn_fail(error, HEWN_LIMIT, "too many triangles for a progressive mesh");
    for (uint32_t t = 0; t < star->count; t++)
        deviation = fmax(deviation, (double)of->deviations[star->triangle[t]]);
    deviation += hewn_fold_distance(of, vertex, star, i);
    of->records[of->record_count++] = (fold_record){.vertex = vertex,
                                                    .into = into,
                                                    .first_change = (uint32_t)of->change_count,
                                                    .first_removed = (uint32_t)of->gone_count,
                                                    .error = (float)(deviation * of->scale)};
    change_triangles(of, into, star, i, (float)deviation);
    join_lists(of, vertex, into);
    add_quadric(&of->quadrics[into], &of->quadrics[vertex]);
    of->states[vertex] = FOLD_GONE;
    return HEWN_OK;
}

/* --- the queue ---------------------------------------------------------------------------------------------------- */

/* The least first: costs, which are not negative, as the bits of a float over the number of a vertex. Costs may be out
 * of date, which is seen when their turn comes. */
typedef struct queue {
    uint64_t *items;
    size_t count, room;
    uint32_t *keys; /* bits of the cost of each vertex' item that counts; HEWN_NONE: none does */
} queue;

static void sink(queue *in, size_t at)
{
    const uint64_t item = in->items[at];
    for (size_t child; (child = 2 * at + 1) < in->count; at = child) {
        if (child + 1 < in->count && in->items[child + 1] < in->items[child])
            child++;
        if (in->items[child] >= item)
            break;
        in->items[at] = in->items[child];
    }
    in->items[at] = item;
}

static hewn_result push(queue *in, uint32_t vertex, double cost, hewn_error *error)
{
    const float rounded = (float)fmin(cost, 3e38);
    uint32_t bits;
    memcpy(&bits, &rounded, sizeof bits);
    HEWN_TRY(hewn_reserve((void **)&in->items, &in->room, in->count + 1, sizeof *in->items, error));
    const uint64_t item = (uint64_t)bits << 32 | vertex;
    size_t at = in->count++;
    for (; at > 0 && in->items[(at - 1) / 2] > item; at = (at - 1) / 2)
        in->items[at] = in->items[(at - 1) / 2];
    in->items[at] = item;
    in->keys[vertex] = bits;
    return HEWN_OK;
}

static uint64_t pop(queue *in)
{
    const uint64_t item = in->items[0];
    in->items[0] = in->items[--in->count];
    if (in->count > 0)
        sink(in, 0);
    return item;
}

static hewn_result push_if_possible(fold *of, queue *in, uint32_t vertex, hewn_error *error)
{
    fold_star star;
    double cost = 0;
    in->keys[vertex] = HEWN_NONE;
    if (hewn_fold_choose(of, vertex, &star, &cost) == HEWN_NONE)
        return HEWN_OK;
    return push(in, vertex, cost, error);
}

/* Around a fold: what was impossible may be possible now. */
static hewn_result retry_around(fold *of, queue *in, uint32_t vertex, hewn_error *error)
{
    for (uint32_t i = 0; i < of->list_count[vertex]; i++) {
        const uint32_t triangle = of->pool[of->list_first[vertex] + i];
        for (size_t k = 0; k < 3; k++) {
            const uint32_t v = of->wedge_vertices[of->triangles[3 * (size_t)triangle + k]];
            if (in->keys[v] == HEWN_NONE && of->states[v] == FOLD_FREE)
                HEWN_TRY(push_if_possible(of, in, v, error));
        }
    }
    return HEWN_OK;
}

/* The head of the queue: folded where it still costs what it says, else put back. */
static hewn_result step(fold *of, queue *in, hewn_error *error)
{
    const uint64_t item = pop(in);
    const uint32_t vertex = (uint32_t)item, bits = (uint32_t)(item >> 32);
    fold_star star;
    double cost = 0;
    if (of->states[vertex] != FOLD_FREE || in->keys[vertex] != bits)
        return HEWN_OK;
    in->keys[vertex] = HEWN_NONE;
    const uint32_t i = hewn_fold_choose(of, vertex, &star, &cost);
    if (i == HEWN_NONE)
        return HEWN_OK;
    float was;
    memcpy(&was, &bits, sizeof was);
    if ((float)fmin(cost, 3e38) > was)
        return push(in, vertex, cost, error);
    const uint32_t into = hewn_fold_neighbour(of, &star, i);
    HEWN_TRY(hewn_fold_do(of, vertex, &star, i, error));
    in->keys[into] = HEWN_NONE;
    return retry_around(of, in, into, error);
}

static hewn_result run_queue(fold *of, queue *in, uint64_t least, const hewn_progress *progress, hewn_error *error)
{
    const uint64_t all = of->live_triangles - least;
    for (uint32_t v = 0; v < of->vertex_count; v++)
        if (of->states[v] == FOLD_FREE)
            HEWN_TRY(push_if_possible(of, in, v, error));
    for (uint32_t steps = 0; in->count > 0 && of->live_triangles > least; steps++) {
        HEWN_TRY(step(of, in, error));
        if (steps % 4096 == 0)
            HEWN_TRY(hewn_progress_report(progress, "simplify", 1 - (double)(of->live_triangles - least) / (double)all,
                                          error));
    }
    return HEWN_OK;
}

/* A fold may make another possible two edges away, so the queue is filled anew until nothing comes of it. */
hewn_result hewn_fold_run(fold *of, uint64_t triangles, const hewn_progress *progress, hewn_error *error)
{
    queue in = {.keys = hewn_alloc(of->vertex_count, sizeof *in.keys)};
    if (!in.keys)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a progressive mesh");
    hewn_result result = HEWN_OK;
    for (size_t before = HEWN_NONE;
         result == HEWN_OK && of->live_triangles > triangles && before != of->record_count;) {
        before = of->record_count;
        in.count = 0;
        result = run_queue(of, &in, triangles, progress, error);
    }
    hewn_free(in.items);
    hewn_free(in.keys);
    return result;
}
