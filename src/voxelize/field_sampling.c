/* Fields into samplings, by the host's processors. Bricks whose bounds say that the surface is farther away than the
 * band are coarse; in the others only what matters there is evaluated. */
#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/progress.h"
#include "hewn/voxelize.h"
#include "lanes/tape.h"
#include "voxelize/lattice.h"

enum { BRICK = HEWN_SAMPLING_BRICK, SIDE = HEWN_SAMPLING_SIDE, SAMPLES = SIDE * SIDE * SIDE };

typedef struct sampler {
    const hewn_field_sampling_desc *desc;
    hewn_lane_tape *tape;
    hewn_voxel_lattice lattice;
    uint8_t *fine;
    hewn_sampling *sampling;
    hewn_error error; /* of a thread */
    uint64_t bad;     /* the first sample that is no number: brick and place in it, or UINT64_MAX */
} sampler;

static void values_of(const hewn_lane_tape *tape, hewn_lane_work *work, const hewn_lane_points *points, uint32_t count,
                      float *out)
{
    float values[HEWN_LANES];
    hewn_lanes_value(tape, work, points, (count + HEWN_LANE_BLOCK - 1) / HEWN_LANE_BLOCK * HEWN_LANE_BLOCK, values);
    memcpy(out, values, count * sizeof *out);
}

static void put_point(const sampler *own, const double cells[3], hewn_lane_points *points, uint32_t lane)
{
    double at[3];
    hewn_voxel_point(&own->lattice, cells, at);
    for (int i = 0; i < 3; i++)
        points->at[i][lane] = (float)at[i];
}

/* --- corners -------------------------------------------------------------------------------------------------------
 */

/* Corners `first` to `first` + 63. */
static void fill_corners(sampler *own, hewn_lane_work *work, uint64_t first, uint64_t count, float *out)
{
    uint64_t row = own->lattice.bricks[0] + 1, layer = row * (own->lattice.bricks[1] + 1);
    hewn_lane_points points = {0};
    uint32_t taken = count - first < HEWN_LANES ? (uint32_t)(count - first) : HEWN_LANES;
    for (uint32_t i = 0; i < HEWN_LANES; i++) {
        uint64_t corner = i < taken ? first + i : first;
        const double cells[3] = {(double)(BRICK * (corner % row)), (double)(BRICK * (corner % layer / row)),
                                 (double)(BRICK * (corner / layer))};
        put_point(own, cells, &points, i);
    }
    values_of(own->tape, work, &points, taken, out + first);
    for (uint32_t i = 0; i < taken; i++)
        out[first + i] = (float)((double)out[first + i] / own->lattice.place.cell);
}

/* --- which bricks are fine ------------------------------------------------------------------------------------------
 */

static double grow(const sampler *own)
{
    return own->desc->band > 0 ? own->desc->band : HEWN_VOXEL_BAND;
}

static void put_box(const sampler *own, uint64_t brick, hewn_lane_boxes *boxes, uint32_t lane)
{
    uint32_t from[3];
    double lo[3], hi[3], cells[3], band = grow(own);
    hewn_voxel_brick(&own->lattice, brick, from);
    for (int i = 0; i < 3; i++)
        cells[i] = from[i] - band;
    hewn_voxel_point(&own->lattice, cells, lo);
    for (int i = 0; i < 3; i++)
        cells[i] = from[i] + BRICK + band;
    hewn_voxel_point(&own->lattice, cells, hi);
    for (int i = 0; i < 3; i++) {
        boxes->lo[i][lane] = (float)lo[i];
        boxes->hi[i][lane] = (float)hi[i];
    }
}

static void judge_bricks(sampler *own, hewn_lane_work *work, uint64_t first)
{
    hewn_lane_boxes boxes;
    float lo[HEWN_LANES], hi[HEWN_LANES];
    uint64_t rest = own->lattice.brick_count - first;
    uint32_t taken = rest < HEWN_LANES ? (uint32_t)rest : HEWN_LANES;
    for (uint32_t i = 0; i < HEWN_LANES; i++)
        put_box(own, i < taken ? first + i : first, &boxes, i);
    hewn_lanes_bound(own->tape, work, &boxes, HEWN_LANES, lo, hi);
    for (uint32_t i = 0; i < taken; i++)
        own->fine[first + i] = own->desc->dense || !(lo[i] > 0 || hi[i] < 0);
}

/* --- fine bricks ----------------------------------------------------------------------------------------------------
 */

static void fill_brick(sampler *own, hewn_lane_work *work, const hewn_lane_tape *tape, uint64_t brick)
{
    float *samples = hewn_sampling_brick(own->sampling, brick);
    uint32_t from[3];
    hewn_voxel_brick(&own->lattice, brick, from);
    for (uint32_t first = 0; first < SAMPLES; first += HEWN_LANES) {
        hewn_lane_points points = {0};
        uint32_t taken = SAMPLES - first < HEWN_LANES ? SAMPLES - first : HEWN_LANES;
        for (uint32_t i = 0; i < HEWN_LANES; i++) {
            uint32_t n = i < taken ? first + i : first;
            const double cells[3] = {from[0] + n % SIDE, from[1] + n / SIDE % SIDE, from[2] + n / (SIDE * SIDE)};
            put_point(own, cells, &points, i);
        }
        values_of(tape, work, &points, taken, samples + first);
    }
    for (uint32_t n = 0; n < SAMPLES; n++) {
        samples[n] = (float)((double)samples[n] / own->lattice.place.cell);
        if (isfinite(samples[n]))
            continue;
        uint64_t bad = brick * SAMPLES + n;
#pragma omp critical(hewn_field_sampling)
        own->bad = bad < own->bad ? bad : own->bad;
    }
}

static hewn_result fill_one(sampler *own, hewn_lane_work *work, uint64_t brick, hewn_error *error)
{
    if (!own->fine[brick])
        return HEWN_OK;
    hewn_lane_boxes boxes;
    hewn_lane_tape *cut = NULL;
    float lo[HEWN_LANES], hi[HEWN_LANES];
    for (uint32_t i = 0; i < HEWN_LANE_BLOCK; i++)
        put_box(own, brick, &boxes, i);
    hewn_lanes_bound(own->tape, work, &boxes, HEWN_LANE_BLOCK, lo, hi);
    if (isfinite(lo[0]) && isfinite(hi[0]))
        HEWN_TRY(hewn_lane_tape_cut(own->tape, work, 0, &cut, error));
    fill_brick(own, work, cut ? cut : own->tape, brick);
    hewn_lane_tape_destroy(&cut);
    return HEWN_OK;
}

/* --- all ------------------------------------------------------------------------------------------------------------
 */

enum { CORNERS, JUDGING, FILLING };

/* One pass over all there is, in slices between which the caller is asked. */
static hewn_result pass(sampler *own, int which, float *corners, hewn_error *error)
{
    enum { SLICES = 64 };
    static const double from[] = {0, 0.1, 0.2, 1};
    uint64_t items = own->lattice.brick_count, step = which == FILLING ? 1 : HEWN_LANES;
    if (which == CORNERS)
        items = (uint64_t)(own->lattice.bricks[0] + 1) * (own->lattice.bricks[1] + 1) * (own->lattice.bricks[2] + 1);
    uint64_t count = (items + step - 1) / step;
    hewn_result result = HEWN_OK;
    for (uint64_t slice = 0; slice < SLICES && result == HEWN_OK; slice++) {
        double share = from[which] + (from[which + 1] - from[which]) * (double)slice / SLICES;
        HEWN_TRY(hewn_progress_report(own->desc->progress, "sample", share, error));
        hewn_result worst = HEWN_OK;
#pragma omp parallel
        {
            hewn_lane_work work;
            hewn_error reason = {0};
            hewn_result done = hewn_lane_work_create(own->tape, &work, &reason);
#pragma omp for schedule(dynamic, 4)
            for (uint64_t i = count * slice / SLICES; i < count * (slice + 1) / SLICES; i++) {
                if (done != HEWN_OK)
                    continue;
                if (which == CORNERS)
                    fill_corners(own, &work, step * i, items, corners);
                else if (which == JUDGING)
                    judge_bricks(own, &work, step * i);
                else
                    done = fill_one(own, &work, i, &reason);
            }
            hewn_lane_work_destroy(&work);
            if (done != HEWN_OK) {
#pragma omp critical(hewn_field_sampling)
                {
                    worst = done;
                    own->error = reason;
                }
            }
        }
        result = worst;
    }
    if (result != HEWN_OK && error)
        *error = own->error;
    return result;
}

static hewn_result refuse_sample(const sampler *own, hewn_error *error)
{
    uint32_t from[3], n = (uint32_t)(own->bad % SAMPLES);
    double at[3];
    hewn_voxel_brick(&own->lattice, own->bad / SAMPLES, from);
    const double cells[3] = {from[0] + n % SIDE, from[1] + n / SIDE % SIDE, from[2] + n / (SIDE * SIDE)};
    hewn_voxel_point(&own->lattice, cells, at);
    return hewn_fail(error, HEWN_BAD_INPUT, "the field has no finite value at (%g, %g, %g)", at[0], at[1], at[2]);
}

static hewn_result check_corners(const sampler *own, const float *corners, uint64_t count, hewn_error *error)
{
    for (uint64_t i = 0; i < count; i++) {
        if (isfinite(corners[i]))
            continue;
        uint64_t row = own->lattice.bricks[0] + 1, layer = row * (own->lattice.bricks[1] + 1);
        const double cells[3] = {(double)(BRICK * (i % row)), (double)(BRICK * (i % layer / row)),
                                 (double)(BRICK * (i / layer))};
        double at[3];
        hewn_voxel_point(&own->lattice, cells, at);
        return hewn_fail(error, HEWN_BAD_INPUT, "the field has no finite value at (%g, %g, %g)", at[0], at[1], at[2]);
    }
    return HEWN_OK;
}

static hewn_result sample(sampler *own, float **corners, hewn_error *error)
{
    const hewn_voxel_lattice *lattice = &own->lattice;
    uint64_t fine = 0;
    uint64_t count = (uint64_t)(lattice->bricks[0] + 1) * (lattice->bricks[1] + 1) * (lattice->bricks[2] + 1);
    HEWN_TRY(
        hewn_voxel_check_size(lattice, own->desc->dense ? lattice->brick_count : 0, own->desc->memory_limit, error));
    *corners = hewn_alloc(count, sizeof **corners);
    own->fine = hewn_alloc_zero(lattice->brick_count, 1);
    if (!*corners || !own->fine)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %llu bricks of samples",
                         (unsigned long long)lattice->brick_count);
    HEWN_TRY(pass(own, CORNERS, *corners, error));
    HEWN_TRY(check_corners(own, *corners, count, error));
    HEWN_TRY(pass(own, JUDGING, NULL, error));
    for (uint64_t b = 0; b < lattice->brick_count; b++)
        fine += own->fine[b];
    HEWN_TRY(hewn_voxel_check_size(lattice, fine, own->desc->memory_limit, error));
    hewn_sampling_shape shape = {.fine = own->fine};
    memcpy(shape.cells, lattice->cells, sizeof shape.cells);
    HEWN_TRY(hewn_sampling_begin(&shape, &own->sampling, error));
    memcpy(hewn_sampling_corners(own->sampling), *corners, count * sizeof **corners);
    HEWN_TRY(pass(own, FILLING, NULL, error));
    if (own->bad != UINT64_MAX)
        return refuse_sample(own, error);
    hewn_sampling_finish(own->sampling);
    return HEWN_OK;
}

hewn_result hewn_sampling_from_field(const hewn_field *field, const hewn_field_sampling_desc *desc, hewn_sampling **out,
                                     hewn_sampling_place *place, hewn_error *error)
{
    if (!field || !desc || !out || !place)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "hewn_sampling_from_field: no field, or no place for it");
    *out = NULL;
    if (desc->band < 0 || !(desc->band < 1000))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a band of %g cells makes no sense", desc->band);
    sampler own = {.desc = desc, .bad = UINT64_MAX};
    float *corners = NULL;
    HEWN_TRY(hewn_voxel_lattice_lay(&desc->bounds, desc->cell, ceil(grow(&own)) + 1, &own.lattice, error));
    hewn_result result = hewn_lane_tape_create(field, hewn_field_root(field), &own.tape, error);
    if (result == HEWN_OK)
        result = sample(&own, &corners, error);
    hewn_free(corners);
    hewn_free(own.fine);
    hewn_lane_tape_destroy(&own.tape);
    if (result != HEWN_OK)
        hewn_sampling_destroy(&own.sampling);
    *out = own.sampling;
    *place = own.lattice.place;
    return result;
}
