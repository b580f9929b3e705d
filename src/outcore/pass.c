#include "outcore/pass.h"

#include <malloc.h>
#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/progress.h"

/* Regions are made for this share of what fits, since they come out uneven. */
static const double fullness = 0.6;

/* How often regions are made anew, more of them each time, where one is too large. */
enum { MOST_TRIES = 6, NAMES = 3 * sizeof(uint32_t) };

typedef struct pass_work {
    const hewn_pass *pass;
    hewn_sample sample;
    uint64_t seen; /* triangles */
    hewn_regions regions;
    hewn_chain *own, *around; /* one a region */
    hewn_chain next;          /* what will be the triangles of the store */
} pass_work;

/* --- looks at all triangles --------------------------------------------------------------------------------------- */

typedef struct bounds_work {
    hewn_store *store;
    double *low, *high;
} bounds_work;

static hewn_result take_bounds(void *user, const void *record, hewn_error *error)
{
    const bounds_work *work = user;
    uint32_t names[3];
    memcpy(names, record, NAMES);
    for (int k = 0; k < 3; k++) {
        double at[3];
        if (names[k] >= work->store->vertex_count)
            return hewn_fail(error, HEWN_BAD_INPUT, "a face names vertex %u, but there are %llu vertices", names[k],
                             (unsigned long long)work->store->vertex_count);
        HEWN_TRY(hewn_store_vertex(work->store, names[k], at, error));
        for (int axis = 0; axis < 3; axis++) {
            work->low[axis] = fmin(work->low[axis], at[axis]);
            work->high[axis] = fmax(work->high[axis], at[axis]);
        }
    }
    return HEWN_OK;
}

hewn_result hewn_store_bounds(hewn_store *store, double low[3], double high[3], hewn_error *error)
{
    bounds_work work = {store, low, high};
    for (int axis = 0; axis < 3; axis++) {
        low[axis] = INFINITY;
        high[axis] = -INFINITY;
    }
    return hewn_chain_read(&store->chains, &store->triangles, false, take_bounds, &work, error);
}

static hewn_result take_sample(void *user, const void *record, hewn_error *error)
{
    pass_work *work = user;
    uint32_t name;
    double at[3];
    memcpy(&name, record, sizeof name);
    if (!hewn_sample_takes(&work->sample, work->seen++))
        return HEWN_OK;
    HEWN_TRY(hewn_store_vertex(work->pass->store, name, at, error));
    return hewn_sample_add(&work->sample, work->seen - 1, at, error);
}

/* --- to regions --------------------------------------------------------------------------------------------------- */

static hewn_result take_triangle(void *user, const void *record, hewn_error *error)
{
    pass_work *work = user;
    hewn_chains *chains = &work->pass->store->chains;
    uint32_t names[3], region[3];
    memcpy(names, record, NAMES);
    for (int k = 0; k < 3; k++) {
        double at[3];
        HEWN_TRY(hewn_store_vertex(work->pass->store, names[k], at, error));
        region[k] = hewn_region_of(&work->regions, at);
    }
    if (region[0] == region[1] && region[1] == region[2])
        return hewn_chain_add(chains, &work->own[region[0]], record, error);
    HEWN_TRY(hewn_chain_add(chains, &work->next, record, error));
    HEWN_TRY(hewn_chain_add(chains, &work->around[region[0]], record, error));
    if (region[1] != region[0])
        HEWN_TRY(hewn_chain_add(chains, &work->around[region[1]], record, error));
    if (region[2] != region[0] && region[2] != region[1])
        HEWN_TRY(hewn_chain_add(chains, &work->around[region[2]], record, error));
    return HEWN_OK;
}

static hewn_result distribute(pass_work *work, hewn_error *error)
{
    hewn_store *store = work->pass->store;
    work->own = hewn_alloc_zero(work->regions.count, sizeof *work->own);
    work->around = hewn_alloc_zero(work->regions.count, sizeof *work->around);
    if (!work->own || !work->around)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the parts of a mesh");
    HEWN_TRY(hewn_chain_read(&store->chains, &store->triangles, true, take_triangle, work, error));
    for (uint32_t r = 0; r < work->regions.count; r++) {
        HEWN_TRY(hewn_chain_settle(&store->chains, &work->own[r], error));
        HEWN_TRY(hewn_chain_settle(&store->chains, &work->around[r], error));
    }
    return HEWN_OK;
}

static void forget_regions(pass_work *work)
{
    for (uint32_t r = 0; r < work->regions.count; r++) {
        if (work->own)
            hewn_chain_free(&work->own[r]);
        if (work->around)
            hewn_chain_free(&work->around[r]);
    }
    hewn_free(work->own);
    hewn_free(work->around);
    work->own = work->around = NULL;
    hewn_regions_free(&work->regions);
}

typedef struct gather_work {
    hewn_store *store;
    hewn_chain *to; /* NULL: nowhere */
} gather_work;

static hewn_result take_back(void *user, const void *record, hewn_error *error)
{
    const gather_work *work = user;
    return work->to ? hewn_chain_add(&work->store->chains, work->to, record, error) : HEWN_OK;
}

/* Makes one list of all again. */
static hewn_result gather(pass_work *work, hewn_error *error)
{
    hewn_store *store = work->pass->store;
    gather_work back = {store, &work->next}, away = {store, NULL};
    for (uint32_t r = 0; r < work->regions.count; r++) {
        HEWN_TRY(hewn_chain_read(&store->chains, &work->own[r], true, take_back, &back, error));
        HEWN_TRY(hewn_chain_read(&store->chains, &work->around[r], true, take_back, &away, error));
    }
    HEWN_TRY(hewn_chain_settle(&store->chains, &work->next, error));
    store->triangles = work->next;
    work->next = (hewn_chain){0};
    forget_regions(work);
    return HEWN_OK;
}

static uint64_t find_largest(const pass_work *work)
{
    uint64_t largest = 0;
    for (uint32_t r = 0; r < work->regions.count; r++) {
        const uint64_t count = work->own[r].count + work->around[r].count;
        largest = count > largest ? count : largest;
    }
    return largest;
}

/* Regions that fit, with their triangles. */
static hewn_result make_regions(pass_work *work, hewn_error *error)
{
    const hewn_pass *pass = work->pass;
    hewn_store *store = pass->store;
    const uint64_t most = pass->list_memory / (2 * hewn_chains_block_bytes(&store->chains));
    double count = ceil((double)store->triangles.count / (fullness * (double)pass->capacity));
    HEWN_TRY(hewn_chain_read(&store->chains, &store->triangles, false, take_sample, work, error));
    for (int tries = 0; tries < MOST_TRIES; tries++, count = ceil(1.5 * count)) {
        count = count < 2 ? 2 : count;
        if (count > (double)most)
            return hewn_fail(error, HEWN_OUT_OF_MEMORY,
                             "a mesh of %llu triangles would have to be cut into %.0f parts, which do not fit in the "
                             "memory allowed themselves",
                             (unsigned long long)store->triangles.count, count);
        HEWN_TRY(hewn_regions_make(&work->sample, (uint32_t)count, pass->shift, &work->regions, error));
        HEWN_TRY(distribute(work, error));
        if (find_largest(work) <= pass->capacity)
            return HEWN_OK;
        HEWN_TRY(gather(work, error));
    }
    return hewn_fail(error, HEWN_OUT_OF_MEMORY,
                     "too many triangles meet in one place for parts that fit in the memory allowed");
}

/* --- one region after the other ----------------------------------------------------------------------------------- */

/* The progress of one region as one of the whole. */
typedef struct part_progress {
    const hewn_progress *caller;
    double began, span;
} part_progress;

static bool report_part(void *user, const char *stage, double fraction)
{
    const part_progress *part = user;
    const bool whole = strcmp(stage, "simplify") == 0;
    return part->caller->report(part->caller->user, "simplify", part->began + (whole ? part->span * fraction : 0));
}

/* How much of what is the regions' own shall be left: of each the same, or strictly so much of all, and what one region
 * cannot do the others do. */
typedef struct pass_budget {
    uint64_t all, left; /* own triangles, and of regions that are not done */
    uint64_t aim;       /* what these shall become */
    double share;
} pass_budget;

static pass_budget plan(const pass_work *work)
{
    const hewn_pass *pass = work->pass;
    pass_budget out = {.aim = pass->aim > work->next.count ? pass->aim - work->next.count : 0};
    for (uint32_t r = 0; r < work->regions.count; r++)
        out.all += work->own[r].count;
    out.left = out.all;
    return out;
}

static void choose_share(const hewn_pass *pass, pass_budget *budget)
{
    const double least = pass->strictly ? 0.25 : 0.1;
    const double share = budget->left > 0 ? (double)budget->aim / (double)budget->left : 1;
    budget->share = share < least ? least : share > 1 ? 1 : share;
}

static hewn_result simplify_region(pass_work *work, uint32_t region, pass_budget *budget, hewn_pass_report *report,
                                   hewn_error *error)
{
    const hewn_pass *pass = work->pass;
    const uint64_t own = work->own[region].count;
    const double scale = pass->span / (double)(budget->all > 0 ? budget->all : 1);
    part_progress part = {pass->progress, pass->began + scale * (double)(budget->all - budget->left),
                          scale * (double)own};
    const hewn_progress inner = {report_part, &part};
    const bool heard = pass->progress && pass->progress->report;
    hewn_cell_report come = {0};
    if (pass->strictly || budget->share <= 0)
        choose_share(pass, budget);
    const hewn_cell cell = {.store = pass->store,
                            .regions = &work->regions,
                            .region = region,
                            .own = &work->own[region],
                            .around = &work->around[region],
                            .out = &work->next,
                            .desc = pass->desc,
                            .find_locks = pass->first,
                            .share = budget->share,
                            .error = pass->error,
                            .strictly = pass->strictly,
                            .progress = heard ? &inner : NULL};
    HEWN_TRY(hewn_cell_simplify(&cell, &come, error));
    malloc_trim(0); /* the next region needs the memory elsewhere */
    report->vertices += come.vertices;
    report->distance = fmax(report->distance, come.distance);
    report->distance_low = fmax(report->distance_low, come.distance_low);
    budget->left -= own;
    budget->aim -= budget->aim < come.triangles ? budget->aim : come.triangles;
    return HEWN_OK;
}

static hewn_result simplify_regions(pass_work *work, hewn_pass_report *report, hewn_error *error)
{
    pass_budget budget = plan(work);
    report->regions = work->regions.count;
    for (uint32_t r = 0; r < work->regions.count; r++)
        HEWN_TRY(simplify_region(work, r, &budget, report, error));
    return HEWN_OK;
}

hewn_result hewn_pass_run(const hewn_pass *pass, hewn_pass_report *report, hewn_error *error)
{
    pass_work work = {.pass = pass};
    *report = (hewn_pass_report){0};
    hewn_result result = hewn_progress_report(pass->progress, "simplify", pass->began, error);
    if (result == HEWN_OK)
        result = make_regions(&work, error);
    if (result == HEWN_OK)
        result = simplify_regions(&work, report, error);
    if (result == HEWN_OK)
        result = hewn_chain_settle(&pass->store->chains, &work.next, error);
    if (result == HEWN_OK) {
        pass->store->triangles = work.next;
        work.next = (hewn_chain){0};
    }
    forget_regions(&work);
    hewn_chain_free(&work.next);
    hewn_sample_free(&work.sample);
    return result;
}
