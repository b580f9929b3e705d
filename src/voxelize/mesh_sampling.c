/* Meshes into samplings: exact distances near the surface and at the corners of bricks, signs by winding numbers. */
#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/progress.h"
#include "geom/nearest.h"
#include "geom/winding.h"
#include "hewn/model.h"
#include "hewn/voxelize.h"
#include "mesh/cut.h"
#include "voxelize/lattice.h"

enum { BRICK = HEWN_SAMPLING_BRICK, SIDE = HEWN_SAMPLING_SIDE };

static const double whole_enough = 0.02; /* winding numbers of closed surfaces err less by their short cuts */
static const double doubtful_from = 0.25;

typedef struct sampler {
    hewn_triangle_view view;
    uint32_t *corners; /* owned, where faces had to be cut */
    hewn_bvh bvh;
    hewn_winding winding;
    hewn_box box; /* of the triangles */
    hewn_voxel_lattice lattice;
    uint8_t *fine;
    hewn_sampling *sampling;
    const hewn_progress *progress;
    double share; /* of the work that the stage under way is, after `done` */
    double done;
} sampler;

/* What samples of a brick say of the mesh. */
typedef struct brick_doubts {
    double sum; /* of 1 - 2 |w - r| over samples in the band */
    uint32_t count, doubtful;
} brick_doubts;

/* --- a sample ------------------------------------------------------------------------------------------------------
 */

typedef struct sample {
    double distance; /* not signed */
    double winding;
    uint32_t nearest;
} sample;

/* Nothing past the box of the mesh is inside: not even what a hole there seems to hold. */
static double winding_at(const sampler *own, const double at[3])
{
    for (int i = 0; i < 3; i++)
        if (at[i] < own->box.lo[i] || at[i] > own->box.hi[i])
            return 0;
    return hewn_winding_number(&own->winding, at);
}

static double off_whole(double winding)
{
    return fabs(winding - round(winding));
}

/* Where the mesh leaves no doubt, the distance with its sign. Across a hole, far from any face, the sign would jump:
 * there the distance fades with the winding number's distance from a half, so that the field passes 0 as smoothly as
 * that passes a half. It is never more than the distance. */
static double signed_distance(const sample *s)
{
    double turns = fabs(s->winding);
    if (off_whole(s->winding) < whole_enough || turns > 1)
        return turns > 0.5 ? -s->distance : s->distance;
    return s->distance * (1 - 2 * turns);
}

/* Next to `before`, which is a step away: what cannot have passed the surface on the way, which is closed as far as one
 * sees, has the same winding number. */
static sample sample_at(const sampler *own, const double at[3], const sample *before, double step)
{
    sample out = {.nearest = before ? before->nearest : 0};
    out.nearest = hewn_bvh_nearest(&own->bvh, &own->view, at, out.nearest, &out.distance);
    bool same = before && fmax(before->distance, out.distance) > step && off_whole(before->winding) < whole_enough;
    out.winding = same ? before->winding : winding_at(own, at);
    return out;
}

/* --- bricks --------------------------------------------------------------------------------------------------------
 */

/* Bricks in parallel, with a word to whoever waits now and then. */
#define SLICES 64

static hewn_result for_each(sampler *own, uint64_t count, void (*work)(sampler *, uint64_t, void *), void *context,
                            hewn_error *error)
{
    for (uint64_t slice = 0; slice < SLICES; slice++) {
        uint64_t from = count * slice / SLICES, to = count * (slice + 1) / SLICES;
        HEWN_TRY(hewn_progress_report(own->progress, "sample", own->done + own->share * (double)slice / SLICES, error));
#pragma omp parallel for schedule(dynamic, 4)
        for (uint64_t i = from; i < to; i++)
            work(own, i, context);
    }
    own->done += own->share;
    return HEWN_OK;
}

/* A brick is fine where the surface may be within the band of it. */
static void judge_brick(sampler *own, uint64_t brick, void *context)
{
    double reach = *(const double *)context, middle[3], at[3], distance;
    uint32_t from[3];
    hewn_voxel_brick(&own->lattice, brick, from);
    for (int i = 0; i < 3; i++)
        middle[i] = from[i] + 0.5 * BRICK;
    hewn_voxel_point(&own->lattice, middle, at);
    hewn_bvh_nearest(&own->bvh, &own->view, at, 0, &distance);
    own->fine[brick] = distance <= reach;
}

/* Winding numbers at all corners of bricks, and distances. */
typedef struct corner_values {
    float *distance; /* signed, in cells */
    float *doubt;    /* how far from a whole number the winding number is, below 0 inside */
} corner_values;

static void sample_corner(sampler *own, uint64_t corner, void *context)
{
    const corner_values *values = context;
    uint64_t row = own->lattice.bricks[0] + 1, layer = row * (own->lattice.bricks[1] + 1);
    const double cells[3] = {(double)(BRICK * (corner % row)), (double)(BRICK * (corner % layer / row)),
                             (double)(BRICK * (corner / layer))};
    double at[3];
    hewn_voxel_point(&own->lattice, cells, at);
    sample s = sample_at(own, at, NULL, 0);
    values->distance[corner] = (float)(signed_distance(&s) / own->lattice.place.cell);
    values->doubt[corner] = (float)off_whole(s.winding);
}

/* A hole's membrane, where signs change without a surface near, needs fine bricks as the surface does. */
static void judge_signs(const sampler *own, const corner_values *values)
{
    uint64_t row = own->lattice.bricks[0] + 1, layer = row * (own->lattice.bricks[1] + 1);
    for (uint64_t brick = 0; brick < own->lattice.brick_count; brick++) {
        uint32_t from[3];
        int below = 0, unsure = 0;
        hewn_voxel_brick(&own->lattice, brick, from);
        for (uint32_t c = 0; c < 8; c++) {
            uint64_t corner = from[0] / BRICK + (c & 1) + row * (from[1] / BRICK + (c >> 1 & 1)) +
                              layer * (from[2] / BRICK + (c >> 2));
            below += values->distance[corner] < 0;
            unsure += (double)values->doubt[corner] > doubtful_from;
        }
        if ((below > 0 && below < 8) || unsure > 0)
            own->fine[brick] = 1;
    }
}

/* Rows there and back, so that each sample is next to the one before. */
static void fill_brick(sampler *own, uint64_t brick, void *context)
{
    brick_doubts *doubts = (brick_doubts *)context + brick;
    float *samples = hewn_sampling_brick(own->sampling, brick);
    uint32_t from[3];
    if (!samples)
        return;
    hewn_voxel_brick(&own->lattice, brick, from);
    double cell = own->lattice.place.cell;
    sample before;
    for (uint32_t n = 0; n < SIDE * SIDE * SIDE; n++) {
        uint32_t z = n / (SIDE * SIDE), y = n / SIDE % SIDE, x = n % SIDE;
        y = z & 1 ? SIDE - 1 - y : y;
        x = n / SIDE & 1 ? SIDE - 1 - x : x;
        const double cells[3] = {from[0] + x, from[1] + y, from[2] + z};
        double at[3];
        hewn_voxel_point(&own->lattice, cells, at);
        sample s = sample_at(own, at, n > 0 ? &before : NULL, cell);
        samples[x + SIDE * (y + SIDE * z)] = (float)(signed_distance(&s) / cell);
        /* A point on the surface itself is on neither side of it, which is no doubt. */
        if (s.distance <= HEWN_VOXEL_BAND * cell && s.distance > 1e-4 * cell) {
            double off = off_whole(s.winding);
            doubts->sum += off < whole_enough ? 1 : 1 - 2 * off;
            doubts->doubtful += off_whole(s.winding) > doubtful_from;
            doubts->count++;
        }
        before = s;
    }
}

/* --- all -----------------------------------------------------------------------------------------------------------
 */

static hewn_result take_mesh(const hewn_polygons *mesh, sampler *own, hewn_error *error)
{
    const hewn_model model = {.vertex_count = mesh->vertex_count,
                              .face_count = mesh->face_count,
                              .positions = (double *)mesh->positions,
                              .first = (uint64_t *)mesh->first,
                              .corners = (uint32_t *)mesh->corners};
    HEWN_TRY(hewn_model_check(&model, error));
    if (mesh->vertex_count > UINT32_MAX || hewn_model_corner_count(&model) > UINT32_MAX)
        return hewn_fail(error, HEWN_LIMIT, "the mesh has too many corners to be sampled");
    own->view = (hewn_triangle_view){.vertex_count = mesh->vertex_count,
                                     .triangle_count = mesh->face_count,
                                     .doubles = mesh->positions,
                                     .corners = mesh->corners};
    if (mesh->first) {
        HEWN_TRY(hewn_cut_polygons(mesh, &own->corners, &own->view.triangle_count, NULL, error));
        for (uint64_t c = 0; c < 3 * own->view.triangle_count; c++)
            own->corners[c] = mesh->corners[own->corners[c]];
        own->view.corners = own->corners;
    }
    if (own->view.triangle_count == 0)
        return hewn_fail(error, HEWN_BAD_INPUT, "the mesh has no faces: there is nothing to sample");
    own->box = (hewn_box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (uint64_t c = 0; c < 3 * own->view.triangle_count; c++)
        for (int i = 0; i < 3; i++) {
            double at = own->view.doubles[3 * (uint64_t)own->view.corners[c] + (uint64_t)i];
            own->box.lo[i] = fmin(own->box.lo[i], at);
            own->box.hi[i] = fmax(own->box.hi[i], at);
        }
    HEWN_TRY(hewn_bvh_build(&own->view, &own->bvh, error));
    return hewn_winding_build(&own->bvh, &own->view, &own->winding, error);
}

static double default_cell(const hewn_box *box)
{
    double longest = 0;
    for (int i = 0; i < 3; i++)
        longest = fmax(longest, box->hi[i] - box->lo[i]);
    return longest / 128;
}

static hewn_result lay(const hewn_mesh_sampling_desc *desc, sampler *own, hewn_error *error)
{
    double band = desc->band > 0 ? desc->band : HEWN_VOXEL_BAND;
    double cell = desc->cell > 0 ? desc->cell : default_cell(&own->box);
    if (desc->cell < 0 || isnan(desc->cell) || desc->band < 0 || !isfinite(band) || band > 1000)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a cell of %g and a band of %g make no sense", desc->cell,
                         desc->band);
    if (!(cell > 0))
        return hewn_fail(error, HEWN_BAD_INPUT, "the mesh is a single point: there is nothing to sample");
    return hewn_voxel_lattice_lay(&own->box, cell, ceil(band) + 1, &own->lattice, error);
}

static hewn_result judge(const hewn_mesh_sampling_desc *desc, sampler *own, corner_values *values, hewn_error *error)
{
    const hewn_voxel_lattice *lattice = &own->lattice;
    double band = desc->band > 0 ? desc->band : HEWN_VOXEL_BAND;
    double reach = (band + 0.5 * BRICK * sqrt(3)) * lattice->place.cell;
    uint64_t corners = (uint64_t)(lattice->bricks[0] + 1) * (lattice->bricks[1] + 1) * (lattice->bricks[2] + 1);
    HEWN_TRY(hewn_voxel_check_size(lattice, desc->dense ? lattice->brick_count : 0, desc->memory_limit, error));
    own->fine = hewn_alloc_zero(lattice->brick_count, 1);
    values->distance = hewn_alloc(corners, sizeof *values->distance);
    values->doubt = hewn_alloc(corners, sizeof *values->doubt);
    if (!own->fine || !values->distance || !values->doubt)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %llu bricks of samples",
                         (unsigned long long)lattice->brick_count);
    own->share = 0.1;
    HEWN_TRY(for_each(own, corners, sample_corner, values, error));
    if (desc->dense)
        memset(own->fine, 1, lattice->brick_count);
    else
        HEWN_TRY(for_each(own, lattice->brick_count, judge_brick, &reach, error));
    judge_signs(own, values);
    uint64_t fine = 0;
    for (uint64_t b = 0; b < lattice->brick_count; b++)
        fine += own->fine[b];
    HEWN_TRY(hewn_voxel_check_size(lattice, fine, desc->memory_limit, error));
    hewn_sampling_shape shape = {.fine = own->fine};
    memcpy(shape.cells, lattice->cells, sizeof shape.cells);
    HEWN_TRY(hewn_sampling_begin(&shape, &own->sampling, error));
    memcpy(hewn_sampling_corners(own->sampling), values->distance, corners * sizeof *values->distance);
    return HEWN_OK;
}

static hewn_result fill(sampler *own, hewn_mesh_sampling_report *report, hewn_error *error)
{
    uint64_t bricks = own->lattice.brick_count;
    brick_doubts *doubts = hewn_alloc_zero(bricks, sizeof *doubts), all = {0};
    if (!doubts)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory sampling a mesh");
    own->share = 1 - own->done;
    hewn_result result = for_each(own, bricks, fill_brick, doubts, error);
    uint64_t count = 0, doubtful = 0;
    for (uint64_t b = 0; b < bricks; b++) {
        all.sum += doubts[b].sum;
        count += doubts[b].count;
        doubtful += doubts[b].doubtful;
    }
    hewn_free(doubts);
    HEWN_TRY(result);
    hewn_sampling_finish(own->sampling);
    if (report) {
        memcpy(report->cells, own->lattice.cells, sizeof report->cells);
        report->samples = own->sampling->fine_count * SIDE * SIDE * SIDE;
        report->confidence = count ? all.sum / (double)count : 1;
        report->doubtful = count ? (double)doubtful / (double)count : 0;
    }
    return HEWN_OK;
}

hewn_result hewn_sampling_from_mesh(const hewn_polygons *mesh, const hewn_mesh_sampling_desc *desc, hewn_sampling **out,
                                    hewn_sampling_place *place, hewn_mesh_sampling_report *report, hewn_error *error)
{
    static const hewn_mesh_sampling_desc defaults;
    if (!mesh || !out || !place)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "hewn_sampling_from_mesh: no mesh, or no place for its samples");
    desc = desc ? desc : &defaults;
    *out = NULL;
    sampler own = {.progress = desc->progress};
    corner_values values = {0};
    hewn_result result = take_mesh(mesh, &own, error);
    if (result == HEWN_OK)
        result = lay(desc, &own, error);
    if (result == HEWN_OK)
        result = judge(desc, &own, &values, error);
    hewn_free(values.distance);
    hewn_free(values.doubt);
    if (result == HEWN_OK)
        result = fill(&own, report, error);
    hewn_free(own.fine);
    hewn_winding_free(&own.winding);
    hewn_bvh_free(&own.bvh);
    hewn_free(own.corners);
    if (result != HEWN_OK)
        hewn_sampling_destroy(&own.sampling);
    *out = own.sampling;
    *place = own.lattice.place;
    return result;
}
