/* Islands of voxels, as runs along i that are joined where they touch. Voxels of a label are of one island where they
 * share faces: so an island that is left is one piece of the mesh, whichever way that goes around edges. The outside is
 * joined over edges too, as the mesh joins it. */
#include "labels/islands.h"

#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"

#define NONE 0xFFFFFFFFu
#define MANY 0xFFFFu /* labels around a hollow, or the outside of all */

/* Voxels from `begin` to before `end` of a row, in one slot of `parent` each. */
typedef struct run {
    uint32_t begin, end;
} run;

typedef struct island {
    uint64_t voxels;
    uint32_t first; /* run */
    uint16_t id;
    uint16_t around; /* of the outside: the one label around, 0: none met yet, MANY */
    bool dropped;
} island;

typedef struct islands {
    hewn_label_ids *ids;
    uint64_t row_count;
    uint32_t *row_first; /* runs of each row, and one more */
    run *runs;
    uint32_t *parent; /* of runs; at last their islands */
    island *all;
    uint32_t run_count, count;
} islands;

static void release(islands *of)
{
    hewn_free(of->row_first);
    hewn_free(of->runs);
    hewn_free(of->parent);
    hewn_free(of->all);
    of->row_first = of->parent = NULL;
    of->runs = NULL;
    of->all = NULL;
    of->run_count = of->count = 0;
}

static uint16_t *row_at(const islands *of, uint64_t row)
{
    return of->ids->ids + row * of->ids->dims[0];
}

static uint16_t id_of_run(const islands *of, uint64_t row, uint32_t r)
{
    return row_at(of, row)[of->runs[r].begin];
}

static hewn_result fail_memory(hewn_error *error)
{
    return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the islands of labels");
}

/* --- runs --------------------------------------------------------------------------------------------------------- */

/* How many runs a row has; written to `to` unless that is NULL. */
static uint32_t find_runs(const islands *of, uint64_t row, run *to)
{
    const uint16_t *ids = row_at(of, row);
    uint32_t count = 0, length = of->ids->dims[0], begin = 0;
    for (uint32_t i = 1; i <= length; i++) {
        if (i < length && ids[i] == ids[begin])
            continue;
        if (to)
            to[count] = (run){begin, i};
        count++;
        begin = i;
    }
    return count;
}

static hewn_result list_runs(islands *of, hewn_error *error)
{
    uint64_t sum = 0;
    of->row_count = (uint64_t)of->ids->dims[1] * of->ids->dims[2];
    of->row_first = hewn_alloc(of->row_count + 1, sizeof *of->row_first);
    if (!of->row_first)
        return fail_memory(error);
#pragma omp parallel for schedule(static)
    for (uint64_t row = 0; row < of->row_count; row++)
        of->row_first[row + 1] = find_runs(of, row, NULL);
    of->row_first[0] = 0;
    for (uint64_t row = 0; row < of->row_count; row++) {
        sum += of->row_first[row + 1];
        if (sum >= NONE)
            return hewn_fail(error, HEWN_LIMIT, "the labels are in too many pieces");
        of->row_first[row + 1] = (uint32_t)sum;
    }
    of->run_count = (uint32_t)sum;
    of->runs = hewn_alloc(sum, sizeof *of->runs);
    of->parent = hewn_alloc(sum, sizeof *of->parent);
    if (!of->runs || !of->parent)
        return fail_memory(error);
#pragma omp parallel for schedule(static)
    for (uint64_t row = 0; row < of->row_count; row++)
        (void)find_runs(of, row, of->runs + of->row_first[row]);
    for (uint32_t r = 0; r < of->run_count; r++)
        of->parent[r] = r;
    return HEWN_OK;
}

/* --- joining ------------------------------------------------------------------------------------------------------ */

static uint32_t find_root(uint32_t *parent, uint32_t r)
{
    while (parent[r] != r) {
        parent[r] = parent[parent[r]];
        r = parent[r];
    }
    return r;
}

static void join(islands *of, uint32_t a, uint32_t b)
{
    a = find_root(of->parent, a);
    b = find_root(of->parent, b);
    of->parent[a > b ? a : b] = a > b ? b : a;
}

/* Joins the runs of two rows that touch: labels where they share a face of voxels, the outside with a reach of 1 also
 * where one ends above the beginning of the other. Rows that differ in j and k share no faces, and take part for the
 * outside alone, without a reach. */
static void join_rows(islands *of, uint64_t row, uint64_t other, bool labels, uint32_t reach)
{
    uint32_t first = of->row_first[other], last = of->row_first[other + 1];
    for (uint32_t a = of->row_first[row]; a < of->row_first[row + 1]; a++) {
        uint16_t id = id_of_run(of, row, a);
        uint32_t begin = of->runs[a].begin, end = of->runs[a].end, by = id == 0 ? reach : 0;
        while (first < last && of->runs[first].end + reach <= begin)
            first++;
        for (uint32_t b = first; b < last && of->runs[b].begin < end + by && (labels || id == 0); b++)
            if (of->runs[b].end + by > begin && id_of_run(of, other, b) == id)
                join(of, a, b);
    }
}

static void join_all(islands *of)
{
    uint64_t slice = of->ids->dims[1];
    for (uint64_t row = 0; row < of->row_count; row++) {
        uint64_t j = row % slice;
        if (j > 0)
            join_rows(of, row, row - 1, true, 1);
        if (row < slice)
            continue;
        join_rows(of, row, row - slice, true, 1);
        if (j > 0)
            join_rows(of, row, row - slice - 1, false, 0);
        if (j + 1 < slice)
            join_rows(of, row, row - slice + 1, false, 0);
    }
}

/* Roots are the lowest runs of their islands, so islands are numbered in the order of these. */
static hewn_result list_islands(islands *of, hewn_error *error)
{
    for (uint32_t r = 0; r < of->run_count; r++)
        of->count += of->parent[r] == r;
    of->all = hewn_alloc_zero(of->count, sizeof *of->all);
    if (!of->all)
        return fail_memory(error);
    of->count = 0;
    for (uint64_t row = 0; row < of->row_count; row++)
        for (uint32_t r = of->row_first[row]; r < of->row_first[row + 1]; r++) {
            bool is_new = of->parent[r] == r;
            if (is_new)
                of->all[of->count] = (island){.first = r, .id = id_of_run(of, row, r)};
            of->parent[r] = is_new ? of->count++ : of->parent[of->parent[r]];
            of->all[of->parent[r]].voxels += of->runs[r].end - of->runs[r].begin;
        }
    return HEWN_OK;
}

static hewn_result find_islands(islands *of, hewn_error *error)
{
    HEWN_TRY(list_runs(of, error));
    join_all(of);
    return list_islands(of, error);
}

/* --- choosing islands --------------------------------------------------------------------------------------------- */

/* By label, then the largest first. */
static int compare_islands(const void *a, const void *b)
{
    const island *one = *(const island *const *)a, *other = *(const island *const *)b;
    if (one->id != other->id)
        return one->id > other->id ? 1 : -1;
    if (one->voxels != other->voxels)
        return one->voxels < other->voxels ? 1 : -1;
    return (one->first > other->first) - (one->first < other->first);
}

static hewn_result drop_islands(islands *of, const hewn_body_choice *choice, double voxel, hewn_body_counts *counts,
                                hewn_error *error)
{
    island **order = hewn_alloc(of->count, sizeof *order);
    if (!order)
        return fail_memory(error);
    for (uint32_t n = 0; n < of->count; n++)
        order[n] = &of->all[n];
    qsort(order, of->count, sizeof *order, compare_islands);
    uint64_t rank = 0;
    for (uint32_t n = 0; n < of->count; n++) {
        double volume = voxel * (double)order[n]->voxels;
        rank = n > 0 && order[n]->id == order[n - 1]->id ? rank + 1 : 0;
        if (order[n]->id == 0)
            continue;
        counts->bodies++;
        counts->largest_volume = volume > counts->largest_volume ? volume : counts->largest_volume;
        order[n]->dropped = (choice->largest > 0 && rank >= choice->largest) ||
                            (choice->least_volume > 0 && volume < choice->least_volume);
        counts->kept_bodies += !order[n]->dropped;
    }
    hewn_free(order);
    return HEWN_OK;
}

static void set_run(const islands *of, uint64_t row, uint32_t r, uint16_t id)
{
    for (uint32_t i = of->runs[r].begin; i < of->runs[r].end; i++)
        row_at(of, row)[i] = id;
}

/* Writes the islands' new ids into the voxels, and counts these. */
static void write(const islands *of)
{
    for (uint64_t row = 0; row < of->row_count; row++)
        for (uint32_t r = of->row_first[row]; r < of->row_first[row + 1]; r++) {
            const island *whole = &of->all[of->parent[r]];
            if (whole->dropped)
                set_run(of, row, r, 0);
            else if (whole->id == 0 && whole->around != 0 && whole->around != MANY)
                set_run(of, row, r, whole->around);
            else
                continue;
            uint64_t voxels = of->runs[r].end - of->runs[r].begin;
            if (whole->dropped)
                of->ids->voxel_count[whole->id - 1] -= voxels;
            else
                of->ids->voxel_count[whole->around - 1] += voxels;
        }
}

/* --- hollows ------------------------------------------------------------------------------------------------------ */

static void meet(island *hollow, uint16_t id)
{
    if (id != 0)
        hollow->around = hollow->around == 0 || hollow->around == id ? id : MANY;
}

/* What shares faces with the outside's runs: beside them in their row, and in the rows around. */
static void look_around(islands *of, uint64_t row)
{
    uint32_t length = of->ids->dims[0];
    uint64_t slice = of->ids->dims[1], j = row % slice, k = row / slice;
    for (uint32_t r = of->row_first[row]; r < of->row_first[row + 1]; r++) {
        const run *here = &of->runs[r];
        island *hollow = &of->all[of->parent[r]];
        if (hollow->id != 0 || hollow->around == MANY)
            continue;
        bool border =
            here->begin == 0 || here->end == length || j == 0 || j + 1 == slice || k == 0 || k + 1 == of->ids->dims[2];
        if (border) { /* the layer around the volume */
            hollow->around = MANY;
            continue;
        }
        meet(hollow, row_at(of, row)[here->begin - 1]);
        meet(hollow, row_at(of, row)[here->end]);
        const uint64_t others[4] = {row - 1, row + 1, row - slice, row + slice};
        for (int n = 0; n < 4; n++)
            for (uint32_t i = here->begin; i < here->end; i++)
                meet(hollow, row_at(of, others[n])[i]);
    }
}

static void fill_hollows(islands *of, bool fill, hewn_body_counts *counts)
{
    for (uint64_t row = 0; row < of->row_count; row++)
        look_around(of, row);
    uint32_t outside = of->row_count > 0 ? of->parent[0] : NONE;
    for (uint32_t n = 0; n < of->count; n++) {
        island *here = &of->all[n];
        if (here->id != 0 || n == outside)
            continue;
        counts->cavities++;
        counts->kept_cavities += !fill || here->around == MANY;
        here->around = fill ? here->around : MANY;
    }
}

/* --- labels that are left ----------------------------------------------------------------------------------------- */

static hewn_result number_anew(hewn_label_ids *ids, hewn_error *error)
{
    uint16_t *number = hewn_alloc_zero((size_t)ids->label_count + 1, sizeof *number);
    uint32_t count = 0;
    if (!number)
        return fail_memory(error);
    for (uint32_t n = 0; n < ids->label_count; n++) {
        if (ids->voxel_count[n] == 0)
            continue;
        ids->labels[count] = ids->labels[n];
        ids->voxel_count[count] = ids->voxel_count[n];
        number[n + 1] = (uint16_t)++count;
    }
    uint64_t voxels = (uint64_t)ids->dims[0] * ids->dims[1] * ids->dims[2];
    if (count < ids->label_count) {
#pragma omp parallel for schedule(static)
        for (uint64_t v = 0; v < voxels; v++)
            ids->ids[v] = number[ids->ids[v]];
    }
    ids->label_count = count;
    hewn_free(number);
    return HEWN_OK;
}

static hewn_result run_all(islands *of, const hewn_body_choice *choice, double voxel, hewn_body_counts *counts,
                           hewn_error *error)
{
    HEWN_TRY(find_islands(of, error));
    HEWN_TRY(drop_islands(of, choice, voxel, counts, error));
    if (counts->kept_bodies == 0)
        return hewn_fail(error, HEWN_BAD_INPUT, "no island of any label is as large as that: the largest has %.6g",
                         counts->largest_volume);
    write(of);
    release(of);
    HEWN_TRY(find_islands(of, error)); /* where islands were dropped, there is more outside */
    fill_hollows(of, choice->fill_cavities, counts);
    write(of);
    return number_anew(of->ids, error);
}

hewn_result hewn_label_islands_choose(hewn_label_ids *ids, const hewn_body_choice *choice, double voxel,
                                      hewn_body_counts *counts, hewn_error *error)
{
    islands of = {.ids = ids};
    *counts = (hewn_body_counts){0};
    hewn_result result = run_all(&of, choice, voxel, counts, error);
    release(&of);
    return result;
}
