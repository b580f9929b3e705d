/* The stars of a large mesh, range by range of its vertices. Programs that make meshes number vertices in the order in
 * which triangles name them, more or less: so a run of triangles names vertices of few ranges. Rows of one range stay
 * in a processor's cache, and the memory of all rows, as much as the triangles take, is never needed. */
#include <omp.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/progress.h"
#include "mesh/star.h"

enum {
    RUN = 1 << 12,       /* triangles */
    LEAST_RANGE = 15,    /* vertices, as a power of two */
    MOST_RANGES = 1024,  /* more vertices have larger ranges */
    MOST_VISITS = 4,     /* of a run, on average */
    RANGES_AT_ONCE = 64, /* between two looks at the progress callback */
};

typedef struct range_examination {
    const hewn_face_view *view;
    uint32_t shift; /* range of a vertex */
    uint32_t range_count, words;
    uint64_t run_count;
    uint64_t *names; /* words a run: a bit for each range that it names */
    hewn_star_counts counts;
    hewn_result result;
} range_examination;

/* What a thread has for one range after the other. */
typedef struct range_room {
    uint32_t *first, *corners;
    size_t corner_room;
    hewn_link_arc arcs[HEWN_STAR_SHORT];
    uint64_t ends[2 * HEWN_STAR_SHORT];
    uint32_t parent[HEWN_STAR_SHORT];
    hewn_star_counts counts;
} range_room;

static void name_ranges(const range_examination *of, uint64_t run)
{
    uint64_t *names = of->names + run * of->words;
    const uint64_t end = (run + 1) * RUN < of->view->face_count ? (run + 1) * RUN : of->view->face_count;
    memset(names, 0, of->words * sizeof *names);
    for (uint64_t c = 3 * run * RUN; c < 3 * end; c++) {
        const uint32_t range = of->view->corners[c] >> of->shift;
        names[range / 64] |= (uint64_t)1 << range % 64;
    }
}

/* Whether runs name few ranges. */
static bool find_names(const range_examination *of)
{
    uint64_t visits = 0;
#pragma omp parallel for schedule(static) reduction(+ : visits)
    for (uint64_t run = 0; run < of->run_count; run++) {
        name_ranges(of, run);
        for (uint32_t i = 0; i < of->words; i++)
            visits += (uint64_t)__builtin_popcountll(of->names[run * of->words + i]);
    }
    return visits <= MOST_VISITS * of->run_count;
}

/* Counts the corners at each vertex of a range, or puts them into its rows, whose ends `first` then has. */
static void read_runs(const range_examination *of, uint32_t range, uint32_t *first, uint32_t *corners)
{
    const uint32_t begin = range << of->shift, length = 1u << of->shift;
    for (uint64_t run = 0; run < of->run_count; run++) {
        if (!(of->names[run * of->words + range / 64] >> range % 64 & 1))
            continue;
        const uint64_t end = (run + 1) * RUN < of->view->face_count ? (run + 1) * RUN : of->view->face_count;
        for (uint64_t t = run * RUN; t < end; t++) {
            const uint32_t *corner = of->view->corners + 3 * t;
            if (hewn_triangle_collapsed(corner))
                continue;
            for (uint32_t k = 0; k < 3; k++) {
                const uint32_t place = corner[k] - begin;
                if (place >= length)
                    continue;
                if (corners)
                    corners[first[place]] = (uint32_t)(3 * t) + k;
                first[place]++;
            }
        }
    }
}

static hewn_result examine_long(const range_examination *of, const uint32_t *row, uint32_t length, uint32_t v,
                                hewn_star_counts *counts)
{
    hewn_star_room room;
    hewn_result result = hewn_star_room_create(length, &room, NULL);
    if (result == HEWN_OK)
        hewn_star_examine(of->view, row, length, v, &room, counts);
    hewn_star_room_free(&room);
    return result;
}

static hewn_result make_rows(const range_examination *of, uint32_t range, range_room *room)
{
    const uint32_t length = 1u << of->shift;
    uint32_t sum = 0;
    memset(room->first, 0, length * sizeof *room->first);
    read_runs(of, range, room->first, NULL);
    for (uint32_t i = 0; i < length; i++) {
        const uint32_t count = room->first[i];
        room->first[i] = sum;
        sum += count;
    }
    void *items = room->corners;
    HEWN_TRY(hewn_reserve(&items, &room->corner_room, sum, sizeof *room->corners, NULL));
    room->corners = items;
    read_runs(of, range, room->first, room->corners);
    return HEWN_OK;
}

static hewn_result examine_range(const range_examination *of, uint32_t range, range_room *room)
{
    const hewn_star_room own = {room->arcs, room->ends, room->parent};
    HEWN_TRY(make_rows(of, range, room));
    uint32_t begin = 0;
    for (uint32_t i = 0; i < 1u << of->shift; i++) { /* rows have moved to their ends */
        const uint32_t *row = room->corners + begin, length = room->first[i] - begin, v = (range << of->shift) + i;
        begin = room->first[i];
        if (length > HEWN_STAR_SHORT)
            HEWN_TRY(examine_long(of, row, length, v, &room->counts));
        else if (length > 0)
            hewn_star_examine(of->view, row, length, v, &own, &room->counts);
    }
    return HEWN_OK;
}

/* Sums of integers: any order gives the same. */
static void examine_some(range_examination *of, uint32_t begin, uint32_t end)
{
#pragma omp parallel
    {
        range_room room = {.first = hewn_alloc((size_t)1 << of->shift, sizeof *room.first)};
        hewn_result result = room.first ? HEWN_OK : HEWN_OUT_OF_MEMORY;
#pragma omp for schedule(dynamic, 1)
        for (uint32_t range = begin; range < end; range++)
            if (result == HEWN_OK)
                result = examine_range(of, range, &room);
        hewn_free(room.first);
        hewn_free(room.corners);
#pragma omp critical(hewn_star_ranges)
        {
            hewn_star_counts_add(&of->counts, &room.counts);
            of->result = of->result == HEWN_OK ? result : of->result;
        }
    }
}

static hewn_result examine_all(range_examination *of, const char *stage, const hewn_progress *progress,
                               hewn_error *error)
{
    for (uint32_t begin = 0; begin < of->range_count; begin += RANGES_AT_ONCE) {
        const uint32_t end = of->range_count - begin < RANGES_AT_ONCE ? of->range_count : begin + RANGES_AT_ONCE;
        examine_some(of, begin, end);
        if (of->result != HEWN_OK)
            return hewn_fail(error, of->result, "out of memory for the stars of %llu faces",
                             (unsigned long long)of->view->face_count);
        HEWN_TRY(hewn_progress_report(progress, stage, 0.6 + 0.4 * (double)end / of->range_count, error));
    }
    return HEWN_OK;
}

hewn_result hewn_stars_examine_ranges(const hewn_face_view *view, const char *stage, const hewn_progress *progress,
                                      hewn_star_counts *counts, bool *done, hewn_error *error)
{
    range_examination of = {.view = view, .shift = LEAST_RANGE, .run_count = (view->face_count + RUN - 1) / RUN};
    *done = false;
    while (view->vertex_count >> of.shift >= MOST_RANGES)
        of.shift++;
    of.range_count = (uint32_t)(view->vertex_count >> of.shift) + 1;
    of.words = (of.range_count + 63) / 64;
    of.names = hewn_alloc(of.run_count * of.words, sizeof *of.names);
    if (!of.names)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the stars of %llu faces",
                         (unsigned long long)view->face_count);
    hewn_result result = HEWN_OK;
    if (!view->first && find_names(&of)) {
        *done = true;
        result = examine_all(&of, stage, progress, error);
        hewn_star_counts_add(counts, &of.counts);
    }
    hewn_free(of.names);
    return result;
}
