#include "mesh/build.h"

#include <omp.h>
#include <stdlib.h>

#include "base/alloc.h"

/* Below so many corners threads are not worth their start. Buckets of more half-edges than SMALL_BUCKET either way are
 * sorted. */
enum { CORNERS_A_PART = 1 << 14, SMALL_BUCKET = 16 };

/* --- counting sort ------------------------------------------------------------------------------------------------ */

static inline void count_half(uint32_t *ends, uint32_t *any_corner, uint32_t lo, uint32_t span, uint32_t tail,
                              uint32_t head, uint32_t corner)
{
    uint32_t least = tail < head ? tail : head;
    if (least - lo < span)
        ends[2 * (size_t)least + (tail > head)]++;
    if (tail - lo < span)
        any_corner[tail] = corner;
}

static inline void place_half(mesh_matching *matching, uint32_t lo, uint32_t span, uint32_t tail, uint32_t head,
                              uint32_t corner)
{
    uint32_t least = tail < head ? tail : head;
    if (least - lo >= span)
        return;
    uint32_t at = matching->ends[2 * (size_t)least + (tail > head)]++;
    matching->entries[at] = (mesh_entry){tail < head ? head : tail, corner};
}

static void count_range(const mesh_source *source, uint32_t *any_corner, const mesh_matching *matching, uint32_t part)
{
    uint32_t lo = matching->range[part], span = matching->range[part + 1] - lo;
    for (uint32_t v = lo; v < lo + span; v++) {
        matching->ends[2 * (size_t)v] = matching->ends[2 * (size_t)v + 1] = 0;
        any_corner[v] = HEWN_NONE;
    }
    for (uint32_t f = 0; f < source->face_count; f++) {
        uint32_t begin = mesh_source_begin(source, f), last = mesh_source_begin(source, f + 1) - 1;
        const uint32_t *corners = source->corners;
        for (uint32_t i = begin; i < last; i++)
            count_half(matching->ends, any_corner, lo, span, corners[i], corners[i + 1], i);
        count_half(matching->ends, any_corner, lo, span, corners[last], corners[begin], last);
    }
}

static uint32_t sum_range(const mesh_matching *matching, uint32_t part)
{
    uint32_t sum = 0;
    for (size_t i = 2 * (size_t)matching->range[part]; i < 2 * (size_t)matching->range[part + 1]; i++)
        sum += matching->ends[i];
    return sum;
}

static void place_range(const mesh_source *source, mesh_matching *matching, uint32_t part, uint32_t base)
{
    uint32_t lo = matching->range[part], span = matching->range[part + 1] - lo;
    for (size_t i = 2 * (size_t)lo; i < 2 * ((size_t)lo + span); i++) {
        uint32_t count = matching->ends[i];
        matching->ends[i] = base;
        base += count;
    }
    for (uint32_t f = 0; f < source->face_count; f++) {
        uint32_t begin = mesh_source_begin(source, f), last = mesh_source_begin(source, f + 1) - 1;
        const uint32_t *corners = source->corners;
        for (uint32_t i = begin; i < last; i++)
            place_half(matching, lo, span, corners[i], corners[i + 1], i);
        place_half(matching, lo, span, corners[last], corners[begin], last);
    }
}

/* --- matching ----------------------------------------------------------------------------------------------------- */

typedef struct edge_tally {
    uint32_t edges, open_edges;
    uint32_t fault;
} edge_tally;

/* Numbers the edges of a small bucket by comparing all pairs. False where an edge has a third face, or two faces run
 * along it the same way. */
static bool match_small(const mesh_entry *up, uint32_t up_count, const mesh_entry *down, uint32_t down_count,
                        uint32_t *halves, edge_tally *tally)
{
    uint32_t used = 0, used_count = 0;
    bool twice = false;
    for (uint32_t i = 0; i < up_count; i++) {
        uint32_t edge = tally->edges++, partners = 0;
        halves[up[i].corner] = 2 * edge;
        for (uint32_t j = 0; j < down_count; j++)
            if (down[j].other == up[i].other) {
                halves[down[j].corner] = 2 * edge + 1;
                used |= 1u << j;
                partners++;
            }
        for (uint32_t k = 0; k < i; k++)
            twice |= up[k].other == up[i].other;
        twice |= partners > 1;
        used_count += partners;
    }
    tally->open_edges += up_count - used_count;
    if (used_count == down_count)
        return !twice;
    for (uint32_t j = 0; j < down_count; j++) {
        if (used >> j & 1)
            continue;
        halves[down[j].corner] = 2 * tally->edges++ + 1;
        tally->open_edges++;
        for (uint32_t k = 0; k < j; k++)
            twice |= down[k].other == down[j].other;
    }
    return !twice;
}

static int by_other(const void *a, const void *b)
{
    const mesh_entry *left = a, *right = b;
    if (left->other != right->other)
        return left->other < right->other ? -1 : 1;
    return (left->corner > right->corner) - (left->corner < right->corner);
}

/* The same by sorting both sides and running along them. */
static bool match_large(mesh_entry *up, uint32_t up_count, mesh_entry *down, uint32_t down_count, uint32_t *halves,
                        edge_tally *tally)
{
    bool twice = false;
    qsort(up, up_count, sizeof *up, by_other);
    qsort(down, down_count, sizeof *down, by_other);
    uint32_t i = 0, j = 0;
    while (i < up_count || j < down_count) {
        uint32_t edge = tally->edges++;
        bool takes_up = i < up_count && (j == down_count || up[i].other <= down[j].other);
        bool takes_down = j < down_count && (i == up_count || down[j].other <= up[i].other);
        if (takes_up) {
            twice |= i > 0 && up[i - 1].other == up[i].other;
            halves[up[i++].corner] = 2 * edge;
        }
        if (takes_down) {
            twice |= j > 0 && down[j - 1].other == down[j].other;
            halves[down[j++].corner] = 2 * edge + 1;
        }
        tally->open_edges += takes_up != takes_down;
    }
    return !twice;
}

static edge_tally match_range(const mesh_matching *matching, uint32_t part, uint32_t base)
{
    edge_tally tally = {.fault = HEWN_NONE};
    uint32_t begin = base;
    for (uint32_t v = matching->range[part]; v < matching->range[part + 1] && tally.fault == HEWN_NONE; v++) {
        uint32_t middle = matching->ends[2 * (size_t)v], end = matching->ends[2 * (size_t)v + 1];
        mesh_entry *up = matching->entries + begin, *down = matching->entries + middle;
        bool large = middle - begin > SMALL_BUCKET || end - middle > SMALL_BUCKET;
        bool fine = large ? match_large(up, middle - begin, down, end - middle, matching->halves, &tally)
                          : match_small(up, middle - begin, down, end - middle, matching->halves, &tally);
        if (!fine)
            tally.fault = v;
        begin = end;
    }
    return tally;
}

/* --- together ----------------------------------------------------------------------------------------------------- */

static uint32_t choose_parts(const mesh_source *source)
{
    uint32_t parts = (uint32_t)omp_get_max_threads(), useful = source->corner_count / CORNERS_A_PART + 1;
    parts = parts < useful ? parts : useful;
    return parts < MESH_MOST_PARTS ? parts : MESH_MOST_PARTS;
}

static void deal_ranges(const mesh_source *source, uint32_t parts, mesh_matching *matching)
{
    matching->parts = parts;
    for (uint32_t p = 0; p <= parts; p++)
        matching->range[p] = (uint32_t)((uint64_t)source->vert_count * p / parts);
}

static void run_part(const mesh_source *source, uint32_t *any_corner, mesh_matching *matching, uint32_t part,
                     uint32_t *sums, edge_tally *tallies)
{
    count_range(source, any_corner, matching, part);
    sums[part] = sum_range(matching, part);
#pragma omp barrier
    uint32_t base = 0;
    for (uint32_t p = 0; p < part; p++)
        base += sums[p];
    place_range(source, matching, part, base);
    tallies[part] = match_range(matching, part, base);
}

hewn_result hewn_mesh_match(const mesh_source *source, uint32_t *any_corner, mesh_matching *out, hewn_error *error)
{
    *out = (mesh_matching){.fault = HEWN_NONE};
    out->ends = hewn_alloc(source->vert_count, 2 * sizeof *out->ends);
    out->entries = hewn_alloc(source->corner_count, sizeof *out->entries);
    out->halves = hewn_alloc(source->corner_count, sizeof *out->halves);
    if (!out->ends || !out->entries || !out->halves) {
        hewn_mesh_matching_free(out);
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory matching the edges of %u faces", source->face_count);
    }
    uint32_t sums[MESH_MOST_PARTS];
    edge_tally tallies[MESH_MOST_PARTS] = {{0}};
#pragma omp parallel num_threads((int)choose_parts(source))
    {
#pragma omp single
        deal_ranges(source, (uint32_t)omp_get_num_threads(), out);
        run_part(source, any_corner, out, (uint32_t)omp_get_thread_num(), sums, tallies);
    }
    for (uint32_t p = 0; p < out->parts; p++) {
        out->edges[p + 1] = out->edges[p] + tallies[p].edges;
        out->open_edges += tallies[p].open_edges;
        out->fault = tallies[p].fault < out->fault ? tallies[p].fault : out->fault;
    }
    return HEWN_OK;
}

void hewn_mesh_matching_free(mesh_matching *matching)
{
    hewn_free(matching->ends);
    hewn_free(matching->entries);
    hewn_free(matching->halves);
    matching->ends = NULL;
    matching->entries = NULL;
    matching->halves = NULL;
}
