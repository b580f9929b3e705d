/* The discrete Gaussian of a frame. Slices are smoothed along i and j one by one, then columns of all slices along k,
 * in place, so there is no second volume. */
#include <math.h>
#include <omp.h>

#include "base/alloc.h"
#include "base/error.h"
#include "volume/smooth.h"
#include "volume/voxel.h"

enum { PARTS = 32, COLUMNS = 64 };

/* Half a kernel, from its middle on, and for each place along the axis what makes its weights sum up to 1. */
typedef struct kernel {
    uint32_t radius;
    double *weights; /* radius + 1 */
    double *norms;   /* dims[axis] */
} kernel;

typedef struct filter {
    const hewn_volume *volume;
    const hewn_volume *out;
    float *shares; /* how much of each voxel's weights is on finite ones; NULL: all are finite */
    kernel kernels[3];
    uint64_t first;  /* sample of the frame */
    double *scratch; /* for each thread `room` */
    size_t room;
} filter;

/* --- kernels ------------------------------------------------------------------------------------------------------ */

/* exp(-t) I_n(t) for n up to `count` - 1, by Miller's way: down from where it is as good as 0, then scaled so that all
 * of it sums up to 1. */
static void find_bessel(double t, uint32_t count, double *out)
{
    double before = 0, here = 1e-280, sum = 0;
    for (uint32_t n = count - 1; n > 0; n--) {
        out[n] = here;
        sum += 2 * here;
        double next = before + 2.0 * n / t * here;
        before = here;
        here = next;
        if (here > 1e200) {
            for (uint32_t m = n; m < count; m++)
                out[m] *= 1e-220;
            before *= 1e-220;
            here *= 1e-220;
            sum *= 1e-220;
        }
    }
    out[0] = here;
    sum += here;
    for (uint32_t n = 0; n < count; n++)
        out[n] /= sum;
}

/* The part of the kernel that matters: beyond it is less than a millionth. */
static uint32_t find_radius(const double *weights, uint32_t count)
{
    double beyond = 1 - weights[0];
    uint32_t radius = 0;
    while (radius + 1 < count && beyond > 1e-6)
        beyond -= 2 * weights[++radius];
    return radius;
}

static void find_norms(kernel *to, uint32_t length)
{
    for (uint32_t i = 0; i < length; i++) {
        double sum = to->weights[0];
        for (uint32_t n = 1; n <= to->radius; n++)
            sum += to->weights[n] * ((i >= n) + (n < length - i));
        to->norms[i] = 1 / sum;
    }
}

/* Such small deviations are none: the neighbours would weigh less than a millionth. */
static bool is_too_small(double t)
{
    return t < 1e-6;
}

static hewn_result make_kernel(double deviation, uint32_t length, kernel *to, hewn_error *error)
{
    double t = deviation * deviation;
    uint32_t count = is_too_small(t) ? 1 : (uint32_t)(10 * deviation) + 32;
    to->weights = hewn_alloc(count, sizeof *to->weights);
    to->norms = hewn_alloc(length, sizeof *to->norms);
    if (!to->weights || !to->norms)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a Gaussian");
    if (count == 1)
        to->weights[0] = 1;
    else
        find_bessel(t, count, to->weights);
    to->radius = find_radius(to->weights, count);
    if (to->radius > length - 1)
        to->radius = length - 1;
    find_norms(to, length);
    return HEWN_OK;
}

/* --- along an axis ------------------------------------------------------------------------------------------------ */

/* One of `count` rows of `width` numbers becomes the weighted sum of those around it. */
static void blend(const kernel *by, const double *rows, size_t width, uint32_t count, uint32_t at, double scale,
                  double *restrict out)
{
    const double *middle = rows + width * at;
    for (size_t i = 0; i < width; i++)
        out[i] = by->weights[0] * middle[i];
    for (uint32_t n = 1; n <= by->radius; n++) {
        const double weight = by->weights[n], *before = at >= n ? middle - width * n : NULL;
        const double *after = n < count - at ? middle + width * n : NULL;
        if (before && after)
            for (size_t i = 0; i < width; i++)
                out[i] += weight * (before[i] + after[i]);
        else if (before || after)
            for (size_t i = 0; i < width; i++)
                out[i] += weight * (before ? before[i] : after[i]);
    }
    for (size_t i = 0; i < width; i++)
        out[i] *= scale;
}

/* The same along the row: `padded` has a radius of zeros on both sides. */
static void blend_row(const kernel *by, const double *padded, uint32_t count, bool norm, double *restrict out)
{
    const double *middle = padded + by->radius;
    for (uint32_t i = 0; i < count; i++)
        out[i] = by->weights[0] * middle[i];
    for (uint32_t n = 1; n <= by->radius; n++) {
        const double weight = by->weights[n], *before = middle - n, *after = middle + n;
        for (uint32_t i = 0; i < count; i++)
            out[i] += weight * (before[i] + after[i]);
    }
    for (uint32_t i = 0; norm && i < count; i++)
        out[i] *= by->norms[i];
}

static bool is_finite(double value)
{
    return value - value == 0;
}

static void put(const filter *of, uint64_t at, const double *values, size_t count)
{
    if (of->out->type == HEWN_VOXEL_DOUBLE)
        memcpy((double *)of->out->memory + at, values, count * sizeof *values);
    else
        for (size_t i = 0; i < count; i++)
            ((float *)of->out->memory)[at + i] = (float)values[i];
}

static void put_shares(const filter *of, uint64_t at, const double *values, size_t count)
{
    for (size_t i = 0; i < count; i++)
        of->shares[at + i] = (float)values[i];
}

/* Slice k along i, then j. With `shares` it is the voxels' finiteness that is smoothed. */
static void smooth_slice(const filter *of, uint32_t k, double *scratch, bool shares)
{
    const uint32_t *dims = of->volume->dims;
    const kernel *along = &of->kernels[0], *across = &of->kernels[1];
    double *padded = scratch, *rows = padded + dims[0] + 2 * (size_t)along->radius,
           *row = rows + (size_t)dims[0] * dims[1];
    uint64_t at = (uint64_t)k * dims[0] * dims[1];
    for (uint32_t i = 0; i < along->radius; i++)
        padded[i] = padded[dims[0] + along->radius + i] = 0;
    for (uint32_t j = 0; j < dims[1]; j++) {
        double *values = padded + along->radius;
        hewn_voxels_to_double(of->volume, of->first + at + (uint64_t)j * dims[0], dims[0], values);
        for (uint32_t i = 0; of->shares && i < dims[0]; i++)
            values[i] = !is_finite(values[i]) ? 0 : shares ? 1 : values[i];
        blend_row(along, padded, dims[0], !of->shares, rows + (size_t)j * dims[0]);
    }
    for (uint32_t j = 0; j < dims[1]; j++) {
        blend(across, rows, dims[0], dims[1], j, of->shares ? 1 : across->norms[j], row);
        if (shares)
            put_shares(of, at + (uint64_t)j * dims[0], row, dims[0]);
        else
            put(of, at + (uint64_t)j * dims[0], row, dims[0]);
    }
}

/* What was not finite stays; all others have the weights that were on finite ones. */
static void finish(const filter *of, uint64_t at, size_t count, const double *shares, double *values)
{
    double before[COLUMNS];
    hewn_voxels_to_double(of->volume, of->first + at, count, before);
    for (size_t i = 0; i < count; i++)
        values[i] = is_finite(before[i]) ? values[i] / shares[i] : before[i];
}

/* Columns from (i, j) on, `count` of them, along k. */
static void smooth_columns(const filter *of, uint32_t i, uint32_t j, uint32_t count, double *scratch)
{
    const uint32_t *dims = of->volume->dims;
    const kernel *by = &of->kernels[2];
    uint64_t first = i + (uint64_t)j * dims[0], slice = (uint64_t)dims[0] * dims[1];
    double *values = scratch, *shares = values + (size_t)count * dims[2], row[COLUMNS], share[COLUMNS];
    for (uint32_t k = 0; k < dims[2]; k++)
        for (uint32_t c = 0; c < count; c++) {
            uint64_t at = first + slice * k + c;
            values[(size_t)k * count + c] = of->out->type == HEWN_VOXEL_DOUBLE
                                                ? ((const double *)of->out->memory)[at]
                                                : (double)((const float *)of->out->memory)[at];
            if (of->shares)
                shares[(size_t)k * count + c] = (double)of->shares[at];
        }
    for (uint32_t k = 0; k < dims[2]; k++) {
        blend(by, values, count, dims[2], k, of->shares ? 1 : by->norms[k], row);
        if (of->shares) {
            blend(by, shares, count, dims[2], k, 1, share);
            finish(of, first + slice * k, count, share, row);
        }
        put(of, first + slice * k, row, count);
    }
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

static hewn_result smooth_slices(const filter *of, const hewn_volume_smooth_desc *desc, hewn_error *error)
{
    uint64_t count = of->volume->dims[2];
    for (uint64_t part = 0; part < PARTS; part++) {
#pragma omp parallel for schedule(dynamic, 1)
        for (uint64_t k = part * count / PARTS; k < (part + 1) * count / PARTS; k++) {
            double *scratch = of->scratch + (size_t)omp_get_thread_num() * of->room;
            smooth_slice(of, (uint32_t)k, scratch, false);
            if (of->shares)
                smooth_slice(of, (uint32_t)k, scratch, true);
        }
        HEWN_TRY(hewn_volume_filter_told(desc, 0.5 * (double)(part + 1) / PARTS, error));
    }
    return HEWN_OK;
}

static hewn_result smooth_all_columns(const filter *of, const hewn_volume_smooth_desc *desc, hewn_error *error)
{
    uint64_t a_row = (of->volume->dims[0] + COLUMNS - 1) / COLUMNS, count = a_row * of->volume->dims[1];
    for (uint64_t part = 0; part < PARTS; part++) {
#pragma omp parallel for schedule(dynamic, 4)
        for (uint64_t n = part * count / PARTS; n < (part + 1) * count / PARTS; n++) {
            uint32_t i = (uint32_t)(n % a_row) * COLUMNS, rest = of->volume->dims[0] - i;
            smooth_columns(of, i, (uint32_t)(n / a_row), rest < COLUMNS ? rest : COLUMNS,
                           of->scratch + (size_t)omp_get_thread_num() * of->room);
        }
        HEWN_TRY(hewn_volume_filter_told(desc, 0.5 + 0.5 * (double)(part + 1) / PARTS, error));
    }
    return HEWN_OK;
}

static bool is_real(hewn_voxel type)
{
    return !hewn_voxel_is_integer(type);
}

static hewn_result prepare(filter *of, const hewn_volume_smooth_desc *desc, hewn_error *error)
{
    const hewn_volume *volume = of->volume;
    double spacing[3];
    hewn_volume_spacing(volume, spacing);
    for (int axis = 0; axis < 3; axis++)
        HEWN_TRY(make_kernel(desc->length / spacing[axis], volume->dims[axis], &of->kernels[axis], error));
    size_t slice = (size_t)volume->dims[0] * (volume->dims[1] + 2) + 2 * (size_t)of->kernels[0].radius;
    size_t columns = 2 * (size_t)COLUMNS * volume->dims[2];
    of->room = slice > columns ? slice : columns;
    of->scratch = hewn_alloc((size_t)omp_get_max_threads(), of->room * sizeof *of->scratch);
    bool odd = false;
    if (is_real(volume->type)) {
        hewn_volume_range range = hewn_volume_find_range(volume, desc->frame);
        odd = range.nan_count + range.infinite_count > 0;
    }
    if (odd)
        of->shares = hewn_alloc(hewn_volume_frame_size(volume), sizeof *of->shares);
    if (of->scratch && (of->shares || !odd))
        return HEWN_OK;
    return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory smoothing %u x %u x %u voxels", volume->dims[0],
                     volume->dims[1], volume->dims[2]);
}

hewn_result hewn_volume_gaussian(const hewn_volume *volume, const hewn_volume_smooth_desc *desc, hewn_volume *out,
                                 hewn_error *error)
{
    filter of = {.volume = volume, .out = out, .first = hewn_volume_frame_size(volume) * desc->frame};
    hewn_result result = prepare(&of, desc, error);
    if (result == HEWN_OK)
        result = smooth_slices(&of, desc, error);
    if (result == HEWN_OK)
        result = smooth_all_columns(&of, desc, error);
    for (int axis = 0; axis < 3; axis++) {
        hewn_free(of.kernels[axis].weights);
        hewn_free(of.kernels[axis].norms);
    }
    hewn_free(of.scratch);
    hewn_free(of.shares);
    return result;
}
