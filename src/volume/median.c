/* The median of the voxels around each, in a ball of the world, which is an ellipsoid of the lattice. */
#include <math.h>
#include <omp.h>

#include "base/alloc.h"
#include "base/error.h"
#include "volume/smooth.h"
#include "volume/voxel.h"

enum { PARTS = 64, MOST_VOXELS = 32768 };

/* A row of the ball: (j, k) from its middle, and which voxels of the row. */
typedef struct chord {
    int32_t j, k, from, to;
} chord;

typedef struct filter {
    const hewn_volume *volume;
    const hewn_volume *out;
    chord *chords;
    uint32_t chord_count, voxel_count;
    uint64_t first; /* sample of the frame */
    double *scratch;
    size_t room; /* of each thread, in doubles */
} filter;

/* --- the ball ----------------------------------------------------------------------------------------------------- */

static bool in_ball(const double m[16], int32_t i, int32_t j, int32_t k, double radius)
{
    double sum = 0;
    for (int row = 0; row < 3; row++) {
        double x = m[4 * row] * i + m[4 * row + 1] * j + m[4 * row + 2] * k;
        sum += x * x;
    }
    return sum <= radius * radius * (1 + 1e-9); /* a radius of 3 reaches a voxel at 3 x 1.0 */
}

/* How far the ball reaches along each axis of the lattice: rows of the inverse say how steep these are. */
static void find_reach(const hewn_volume *volume, double radius, int32_t reach[3])
{
    double inverse[12];
    hewn_volume_from_world(volume, inverse);
    for (int axis = 0; axis < 3; axis++) {
        const double *row = inverse + (ptrdiff_t)4 * axis;
        double far = radius * sqrt(row[0] * row[0] + row[1] * row[1] + row[2] * row[2]) * (1 + 1e-9);
        reach[axis] = (int32_t)fmin(far, volume->dims[axis] - 1);
    }
}

static void add_chord(filter *of, int32_t j, int32_t k, int32_t reach, double radius)
{
    int32_t from = INT32_MAX, to = INT32_MIN;
    for (int32_t i = -reach; i <= reach; i++)
        if (in_ball(of->volume->to_world, i, j, k, radius)) {
            from = i < from ? i : from;
            to = i;
        }
    if (from > to)
        return;
    of->chords[of->chord_count++] = (chord){j, k, from, to};
    of->voxel_count += (uint32_t)(to - from + 1);
}

static hewn_result find_ball(filter *of, double radius, hewn_error *error)
{
    int32_t reach[3];
    find_reach(of->volume, radius, reach);
    double rows = (2.0 * reach[1] + 1) * (2.0 * reach[2] + 1);
    if (rows * (2.0 * reach[0] + 1) > 4.0 * MOST_VOXELS)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a median over a radius of %g is one of too many voxels",
                         radius);
    of->chords = hewn_alloc((size_t)rows, sizeof *of->chords);
    if (!of->chords)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a median");
    for (int32_t k = -reach[2]; k <= reach[2]; k++)
        for (int32_t j = -reach[1]; j <= reach[1]; j++)
            add_chord(of, j, k, reach[0], radius);
    if (of->voxel_count > MOST_VOXELS)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a median over a radius of %g is one of %u voxels, more than %d",
                         radius, of->voxel_count, MOST_VOXELS);
    if (of->voxel_count > 1)
        return HEWN_OK;
    double spacing[3];
    hewn_volume_spacing(of->volume, spacing);
    return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                     "a median over a radius of %g reaches no neighbour: voxels are %g, %g and %g apart", radius,
                     spacing[0], spacing[1], spacing[2]);
}

/* --- medians ------------------------------------------------------------------------------------------------------ */

/* Number `wanted` in rising order, from 0 (Hoare 1961, 'Find'). */
static double select_value(double *values, ptrdiff_t count, ptrdiff_t wanted)
{
    ptrdiff_t lo = 0, hi = count - 1;
    while (lo < hi) {
        double pivot = values[wanted];
        ptrdiff_t i = lo, j = hi;
        while (i <= j) {
            while (values[i] < pivot)
                i++;
            while (pivot < values[j])
                j--;
            if (i <= j) {
                double kept = values[i];
                values[i++] = values[j];
                values[j--] = kept;
            }
        }
        if (j < wanted)
            lo = i;
        if (wanted < i)
            hi = j;
    }
    return values[wanted];
}

static void put(const hewn_volume *out, uint64_t at, const double *values, uint32_t count)
{
    switch (out->type) {
#define CASE(enumerator, type)                                                                                         \
    case enumerator:                                                                                                   \
        for (uint32_t i = 0; i < count; i++)                                                                           \
            ((type *)out->memory)[at + i] = (type)values[i];                                                           \
        return;
        HEWN_VOXEL_TYPES(CASE)
#undef CASE
    case HEWN_VOXEL_HALF: return; /* the result has no such type */
    }
}

/* The median at place i of a row; rows[c] are the samples of chord c's row, NULL where that is not in the volume. */
static double median_at(const filter *of, const double *const *rows, uint32_t i, double *values)
{
    uint32_t width = of->volume->dims[0];
    ptrdiff_t count = 0;
    for (uint32_t c = 0; c < of->chord_count; c++) {
        if (!rows[c])
            continue;
        int64_t from = (int64_t)i + of->chords[c].from, to = (int64_t)i + of->chords[c].to;
        to = to < (int64_t)width - 1 ? to : (int64_t)width - 1;
        for (int64_t at = from > 0 ? from : 0; at <= to; at++) {
            values[count] = rows[c][at];
            count += rows[c][at] == rows[c][at]; /* NaN is left out */
        }
    }
    return select_value(values, count, (count - 1) / 2);
}

static void filter_row(const filter *of, uint32_t j, uint32_t k, double *scratch)
{
    const uint32_t *dims = of->volume->dims;
    const double **rows = (const double **)(void *)scratch;
    double *samples = scratch + of->chord_count, *values = samples + (size_t)of->chord_count * dims[0];
    double *own = values + of->voxel_count;
    uint64_t at = ((uint64_t)k * dims[1] + j) * dims[0];
    for (uint32_t c = 0; c < of->chord_count; c++) {
        int64_t row = (int64_t)j + of->chords[c].j, slice = (int64_t)k + of->chords[c].k;
        bool there = row >= 0 && row < dims[1] && slice >= 0 && slice < dims[2];
        double *to = samples + (size_t)c * dims[0];
        rows[c] = there ? to : NULL;
        if (there)
            hewn_voxels_to_double(of->volume, of->first + ((uint64_t)slice * dims[1] + (uint64_t)row) * dims[0],
                                  dims[0], to);
    }
    hewn_voxels_to_double(of->volume, of->first + at, dims[0], own);
    for (uint32_t i = 0; i < dims[0]; i++)
        own[i] = own[i] == own[i] ? median_at(of, rows, i, values) : own[i];
    put(of->out, at, own, dims[0]);
}

static hewn_result filter_rows(const filter *of, const hewn_volume_smooth_desc *desc, hewn_error *error)
{
    uint64_t count = (uint64_t)of->volume->dims[1] * of->volume->dims[2];
    for (uint64_t part = 0; part < PARTS; part++) {
#pragma omp parallel for schedule(dynamic, 4)
        for (uint64_t n = part * count / PARTS; n < (part + 1) * count / PARTS; n++)
            filter_row(of, (uint32_t)(n % of->volume->dims[1]), (uint32_t)(n / of->volume->dims[1]),
                       of->scratch + (size_t)omp_get_thread_num() * of->room);
        HEWN_TRY(hewn_volume_filter_told(desc, (double)(part + 1) / PARTS, error));
    }
    return HEWN_OK;
}

hewn_result hewn_volume_median(const hewn_volume *volume, const hewn_volume_smooth_desc *desc, hewn_volume *out,
                               hewn_error *error)
{
    filter of = {.volume = volume, .out = out, .first = hewn_volume_frame_size(volume) * desc->frame};
    hewn_result result = find_ball(&of, desc->length, error);
    if (result == HEWN_OK) {
        of.room = of.chord_count + (size_t)of.chord_count * volume->dims[0] + of.voxel_count + volume->dims[0];
        of.scratch = hewn_alloc((size_t)omp_get_max_threads(), of.room * sizeof *of.scratch);
        result = of.scratch ? filter_rows(&of, desc, error)
                            : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a median");
    }
    hewn_free(of.chords);
    hewn_free(of.scratch);
    return result;
}
