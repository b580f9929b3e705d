/* What each row will emit, and where. */
#include "base/error.h"
#include "iso/decide.h"
#include "iso/lattice_blocks.h"
#include "iso/lattice_dual.h"
#include "iso/lattice_sample.h"

/* --- decisions ---------------------------------------------------------------------------------------------------- */

/* A cell beside the rim is cut as its inner face is: all of it that is in the rim is as good as 0. */
static bool touches_rim(const hewn_lattice *lattice, uint32_t i, uint32_t j, uint32_t k)
{
    const uint32_t at[3] = {i, j, k};
    for (int axis = 0; axis < 3; axis++)
        if (hewn_lattice_in_rim(lattice, axis, at[axis]) || hewn_lattice_in_rim(lattice, axis, at[axis] + 1))
            return true;
    return false;
}

/* Where a sample is: NULL in the rim, but where that repeats samples. */
static const void *find_sample(const hewn_lattice *lattice, const uint32_t at[3], uint64_t *number)
{
    const hewn_volume *volume = lattice->volume;
    uint32_t ijk[3];
    for (int axis = 0; axis < 3; axis++) {
        const bool in_rim = hewn_lattice_in_rim(lattice, axis, at[axis]);
        if (in_rim && !lattice->repeats)
            return NULL;
        ijk[axis] = in_rim && at[axis] == 0 ? 0 : at[axis] - lattice->rim - in_rim;
    }
    if (volume->blocks)
        return hewn_blocks_sample(volume->blocks, ijk, number);
    *number = lattice->first + ijk[0] + volume->dims[0] * (ijk[1] + (uint64_t)volume->dims[1] * ijk[2]);
    return volume->samples;
}

bool hewn_lattice_inside_at(const hewn_lattice *lattice, const uint32_t at[3])
{
    uint64_t number;
    uint8_t inside = 0;
    hewn_volume view = *lattice->volume;
    view.samples = find_sample(lattice, at, &number);
    if (view.samples)
        hewn_threshold_apply(&lattice->threshold, &view, number, 1, &inside);
    return inside;
}

double hewn_lattice_value_at(const hewn_lattice *lattice, const uint32_t at[3], bool inside)
{
    const hewn_volume *volume = lattice->volume;
    uint64_t number;
    const void *samples = find_sample(lattice, at, &number);
    if (!samples)
        return 0;
    const double raw = hewn_lattice_raw(samples, number, volume->type);
    return hewn_lattice_agree(lattice, hewn_lattice_field(lattice, raw, volume->type), inside);
}

uint32_t hewn_lattice_patch(const hewn_lattice *lattice, uint32_t pattern, uint32_t i, uint32_t j, uint32_t k)
{
    uint32_t head = lattice->table[lattice->flipped ? pattern ^ 255u : pattern];
    if (!(head & HEWN_MC33_DECIDES))
        return head & 0xFFFF;
    if (lattice->dual)
        return hewn_lattice_dual_decide(lattice, head, (const uint32_t[3]){i, j, k});
    double values[8];
    for (uint32_t c = 0; c < 8; c++) {
        const uint32_t at[3] = {i + (c & 1), j + (c >> 1 & 1), k + (c >> 2)};
        values[c] = hewn_lattice_value_at(lattice, at, pattern >> c & 1);
    }
    /* What the table calls inside is what is below 0: the values' own sign says so, but for those that became 0. */
    uint32_t faces = hewn_decide_faces(values, head >> 16 & 63);
    hewn_mc33_join join = touches_rim(lattice, i, j, k) ? HEWN_MC33_NO_JOIN : hewn_decide_join(values);
    return lattice->table[(head & 0xFFFF) + HEWN_MC33_JOINS * faces + join];
}

/* --- counts ------------------------------------------------------------------------------------------------------- */

static void count_edges(const hewn_lattice *lattice, uint32_t j, uint32_t k, hewn_lattice_row *row)
{
    const uint64_t *here = hewn_lattice_bits(lattice, j, k);
    const uint64_t *beside = j + 1 < lattice->dims[1] ? hewn_lattice_bits(lattice, j + 1, k) : here;
    const uint64_t *above = k + 1 < lattice->dims[2] ? hewn_lattice_bits(lattice, j, k + 1) : here;
    for (uint32_t word = 0; word < lattice->words; word++) {
        const uint64_t others[3] = {hewn_lattice_next(here, word), beside[word], above[word]};
        for (uint32_t axis = 0; axis < 3; axis++)
            row->vertices[axis] +=
                hewn_lattice_ones((here[word] ^ others[axis]) & hewn_lattice_edges(lattice, axis, j, k, word));
    }
}

typedef struct cell_counts {
    uint64_t active, decided;
} cell_counts;

static cell_counts count_cells(const hewn_lattice *lattice, uint32_t j, uint32_t k, hewn_lattice_row *row)
{
    cell_counts counts = {0};
    hewn_lattice_cells cells = hewn_lattice_cells_at(lattice, j, k);
    for (uint32_t word = 0; word < lattice->words; word++) {
        hewn_lattice_load(lattice, &cells, word);
        for (uint64_t rest = cells.active; rest; rest &= rest - 1) {
            uint32_t bit = hewn_lattice_lowest(rest), pattern = hewn_lattice_pattern(&cells, bit);
            uint32_t head = lattice->table[hewn_lattice_patch(lattice, pattern, 64 * word + bit, j, k)];
            row->triangles += head & 255;
            row->centres += head >> 8;
            counts.active++;
            counts.decided += lattice->table[lattice->flipped ? pattern ^ 255u : pattern] >> 31;
        }
    }
    return counts;
}

/* Vertices of the rim lie on edges between it and the outermost samples, so on all that start or end in it. */
static uint64_t cap_vertices(const hewn_lattice *lattice, uint32_t j, uint32_t k, const hewn_lattice_row *row)
{
    const uint64_t *here = hewn_lattice_bits(lattice, j, k);
    uint32_t last = lattice->dims[0] - 2;
    uint64_t count = (here[0] >> 1 & 1) + (here[last / 64] >> last % 64 & 1); /* the ends of the row */
    bool beside = hewn_lattice_in_rim(lattice, 1, j) || hewn_lattice_in_rim(lattice, 1, j + 1);
    bool above = hewn_lattice_in_rim(lattice, 2, k) || hewn_lattice_in_rim(lattice, 2, k + 1);
    return count + (beside ? row->vertices[1] : 0) + (above ? row->vertices[2] : 0);
}

/* Turns counts into where each row's share begins. */
static void sum_up(hewn_lattice *lattice)
{
    hewn_lattice_sums sums = lattice->before;
    uint64_t own = (uint64_t)lattice->dims[1] * (lattice->end - lattice->begin);
    uint64_t rows = (uint64_t)lattice->dims[1] * (hewn_lattice_rows_end(lattice) - lattice->begin);
    for (uint64_t i = 0; i < rows; i++) {
        hewn_lattice_row *row = &lattice->rows[i], count = *row;
        if (i == own)
            lattice->after = sums;
        if (lattice->slices && i % lattice->dims[1] == 0 && i < own)
            lattice->slices[i / lattice->dims[1]] = sums;
        for (int axis = 0; axis < 3; axis++) {
            row->vertices[axis] = (uint32_t)sums.vertices;
            sums.vertices += count.vertices[axis];
        }
        row->centres = (uint32_t)sums.centres;
        row->triangles = sums.triangles;
        sums.centres += count.centres;
        sums.triangles += count.triangles;
    }
    if (rows == own)
        lattice->after = sums;
    if (lattice->slices)
        lattice->slices[lattice->end - lattice->begin] = lattice->after;
    lattice->reached = sums.vertices;
}

static void count_rows(hewn_lattice *lattice)
{
    uint64_t active = 0, decided = 0, caps = 0;
#pragma omp parallel for schedule(dynamic, 4) reduction(+ : active, decided, caps) if (lattice->dims[2] > 8)
    for (uint32_t k = lattice->begin; k < hewn_lattice_rows_end(lattice); k++) {
        for (uint32_t j = 0; j < lattice->dims[1]; j++) {
            hewn_lattice_row *row = hewn_lattice_row_at(lattice, j, k);
            *row = (hewn_lattice_row){0};
            count_edges(lattice, j, k, row);
            if (k >= lattice->end)
                continue;
            if (lattice->rim && !lattice->repeats)
                caps += cap_vertices(lattice, j, k, row);
            if (j + 1 == lattice->dims[1] || k + 1 == lattice->dims[2])
                continue;
            cell_counts counts = count_cells(lattice, j, k, row);
            active += counts.active;
            decided += counts.decided;
        }
    }
    sum_up(lattice);
    lattice->active_cells = active;
    lattice->decided_cells = decided;
    lattice->cap_vertices = caps;
}

hewn_result hewn_lattice_count(hewn_lattice *lattice, hewn_error *error)
{
    if (lattice->blocks)
        hewn_lattice_blocks_count(lattice);
    else
        count_rows(lattice);
    uint64_t vertices = lattice->reached + lattice->after.centres;
    if (vertices >= UINT32_MAX || lattice->after.triangles > UINT64_MAX / 64)
        return hewn_fail(error, HEWN_LIMIT, "the surface needs %llu vertices%s, more than indices can name",
                         (unsigned long long)vertices, lattice->end < lattice->dims[2] ? " or more" : "");
    return HEWN_OK;
}
