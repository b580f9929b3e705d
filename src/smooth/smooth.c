#include "hewn/smooth.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/clones.h"
#include "mesh/cut.h"
#include "smooth/blocks.h"
#include "smooth/cotangent.h"
#include "smooth/desc.h"

/* --- input -------------------------------------------------------------------------------------------------------- */

static hewn_result check_face(const hewn_polygons *polygons, uint64_t f, hewn_error *error)
{
    uint64_t begin = smooth_face_begin(polygons, f), end = smooth_face_begin(polygons, f + 1);
    if (end < begin)
        return hewn_fail(error, HEWN_BAD_INPUT, "face %llu does not follow the one before it", (unsigned long long)f);
    if (end > INT32_MAX)
        return hewn_fail(error, HEWN_LIMIT, "faces of 2^31 corners and more cannot be smoothed");
    for (uint64_t c = begin; c < end; c++)
        if (polygons->corners[c] >= polygons->vertex_count)
            return hewn_fail(error, HEWN_BAD_INPUT, "face %llu names vertex %u, but there are %llu",
                             (unsigned long long)f, polygons->corners[c], (unsigned long long)polygons->vertex_count);
    return HEWN_OK;
}

static hewn_result check_vertex(const hewn_polygons *polygons, const double *freedom, uint64_t v, hewn_error *error)
{
    const double *at = polygons->positions + 3 * v;
    if (!isfinite(at[0]) || !isfinite(at[1]) || !isfinite(at[2]))
        return hewn_fail(error, HEWN_BAD_INPUT, "the position of vertex %llu is not finite", (unsigned long long)v);
    if (freedom && !(freedom[v] >= 0 && freedom[v] <= 1))
        return hewn_fail(error, HEWN_BAD_INPUT, "the freedom of vertex %llu must be from 0 to 1, not %g",
                         (unsigned long long)v, freedom[v]);
    return HEWN_OK;
}

/* Faces of any number of corners: whether each follows the one before it. */
static bool faces_follow(const hewn_polygons *polygons)
{
    int wrong = 0;
#pragma omp parallel for schedule(static) reduction(| : wrong)
    for (uint64_t f = 0; f < polygons->face_count; f++)
        wrong |= polygons->first[f + 1] < polygons->first[f];
    return !wrong;
}

/* Whether everything is as it must be; without a branch, as it nearly always is. */
static bool all_hold(const hewn_polygons *polygons, const double *freedom)
{
    const uint64_t numbers = 3 * polygons->vertex_count, corners = smooth_face_begin(polygons, polygons->face_count);
    int wrong = corners > INT32_MAX || (polygons->first && !faces_follow(polygons));
    if (wrong)
        return false;
#pragma omp parallel reduction(| : wrong)
    {
#pragma omp for schedule(static) nowait
        for (uint64_t i = 0; i < numbers; i++)
            wrong |= !(fabs(polygons->positions[i]) <= DBL_MAX);
#pragma omp for schedule(static) nowait
        for (uint64_t i = 0; i < corners; i++)
            wrong |= polygons->corners[i] >= polygons->vertex_count;
#pragma omp for schedule(static)
        for (uint64_t v = 0; v < (freedom ? polygons->vertex_count : 0); v++)
            wrong |= !(freedom[v] >= 0 && freedom[v] <= 1);
    }
    return !wrong;
}

/* The first vertex, or the first face, that is not as it must be; names it. */
static hewn_result check_each(const hewn_polygons *polygons, const double *freedom, hewn_error *error)
{
    for (uint64_t v = 0; v < polygons->vertex_count; v++)
        HEWN_TRY(check_vertex(polygons, freedom, v, error));
    for (uint64_t f = 0; f < polygons->face_count; f++)
        HEWN_TRY(check_face(polygons, f, error));
    return HEWN_OK;
}

static hewn_result check_polygons(const hewn_polygons *polygons, const double *freedom, hewn_error *error)
{
    if (polygons->vertex_count > 0 && !polygons->positions)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "vertices need positions");
    if (polygons->vertex_count > INT32_MAX)
        return hewn_fail(error, HEWN_LIMIT, "2^31 vertices and more cannot be smoothed");
    if (polygons->face_count > 0 && !polygons->corners)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "faces need corners");
    return all_hold(polygons, freedom) ? HEWN_OK : check_each(polygons, freedom, error);
}

/* --- measures ----------------------------------------------------------------------------------------------------- */

/* Lengths are measured from the middle of the box, so that a mesh far from the origin loses nothing. */
typedef struct frame {
    double origin[3], scale, inverse; /* powers of two */
} frame;

typedef struct extent {
    double lo[3], hi[3];
} extent;

static double place_in(const frame *in, const double *positions, size_t vertex, size_t axis)
{
    return (positions[3 * vertex + axis] - in->origin[axis]) * in->inverse;
}

static extent find_extent(const hewn_polygons *polygons)
{
    extent all[SMOOTH_BLOCKS];
#pragma omp parallel for schedule(static)
    for (uint32_t block = 0; block < SMOOTH_BLOCKS; block++) {
        extent one = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
        uint64_t end = smooth_block_begin(polygons->vertex_count, SMOOTH_BLOCKS, block + 1);
        for (uint64_t v = smooth_block_begin(polygons->vertex_count, SMOOTH_BLOCKS, block); v < end; v++)
            for (uint64_t axis = 0; axis < 3; axis++) {
                double x = polygons->positions[3 * v + axis];
                one.lo[axis] = x < one.lo[axis] ? x : one.lo[axis];
                one.hi[axis] = x > one.hi[axis] ? x : one.hi[axis];
            }
        all[block] = one;
    }
    for (uint32_t block = 1; block < SMOOTH_BLOCKS; block++)
        for (int axis = 0; axis < 3; axis++) {
            all[0].lo[axis] = fmin(all[0].lo[axis], all[block].lo[axis]);
            all[0].hi[axis] = fmax(all[0].hi[axis], all[block].hi[axis]);
        }
    return all[0];
}

/* Coordinates are brought to at most 1 by a power of two, so that no square of them overflows. */
static frame find_frame(const hewn_polygons *polygons)
{
    double most = 0;
    frame out = {{0, 0, 0}, 1, 1};
    extent whole = find_extent(polygons);
    for (int axis = 0; axis < 3 && polygons->vertex_count > 0; axis++) {
        out.origin[axis] = whole.lo[axis] / 2 + whole.hi[axis] / 2;
        most = fmax(most, whole.hi[axis] / 2 - whole.lo[axis] / 2);
    }
    int exponent = 0;
    (void)frexp(most, &exponent);
    exponent = exponent > 1000 ? 1000 : exponent < -1000 ? -1000 : exponent;
    if (most > 0) {
        out.scale = ldexp(1, exponent);
        out.inverse = ldexp(1, -exponent);
    }
    return out;
}

/* What is measured of triangles. */
typedef struct measures {
    double volume, area, sides;
} measures;

/* Triangles that are measured at a time: their first corners and the edges from there; and their sums, lane by lane. */
enum { LANES = 8 };
typedef struct triangle_lanes {
    double a[3][LANES], u[3][LANES], v[3][LANES];
    double volume[LANES], area[LANES], sides[LANES];
} triangle_lanes;

/* Lanes past the count are triangles without area. */
static HEWN_INTO_CLONES void gather(const uint32_t *corners, uint64_t count, const double *positions,
                                    triangle_lanes *out)
{
    for (uint64_t i = 0; i < LANES; i++) {
        const uint32_t *corner = corners + (i < count ? 3 * i : 0);
        const double *a = positions + 3 * (size_t)corner[0], *b = i < count ? positions + 3 * (size_t)corner[1] : a,
                     *c = i < count ? positions + 3 * (size_t)corner[2] : a;
        for (int axis = 0; axis < 3; axis++) {
            out->a[axis][i] = a[axis];
            out->u[axis][i] = b[axis] - a[axis];
            out->v[axis][i] = c[axis] - a[axis];
        }
    }
}

static HEWN_INTO_CLONES void add_lanes(triangle_lanes *lanes)
{
    for (int i = 0; i < LANES; i++) {
        const double a[3] = {lanes->a[0][i], lanes->a[1][i], lanes->a[2][i]};
        const double u[3] = {lanes->u[0][i], lanes->u[1][i], lanes->u[2][i]};
        const double v[3] = {lanes->v[0][i], lanes->v[1][i], lanes->v[2][i]};
        double w[3], n[3];
        smooth_between(u, v, w);
        smooth_cross(u, v, n);
        lanes->volume[i] += smooth_dot(a, n);
        lanes->area[i] += sqrt(smooth_dot(n, n));
        lanes->sides[i] += sqrt(smooth_dot(u, u)) + sqrt(smooth_dot(v, v)) + sqrt(smooth_dot(w, w));
    }
}

HEWN_CLONES static void measure_block(const smooth_work *work, const double *positions, uint64_t begin, uint64_t end,
                                      measures *out)
{
    triangle_lanes lanes = {0};
    for (uint64_t t = begin; t < end; t += LANES) {
        gather(work->cut.corners + 3 * t, end - t, positions, &lanes);
        add_lanes(&lanes);
    }
    *out = (measures){0, 0, 0};
    for (int i = 0; i < LANES; i++) {
        out->volume += lanes.volume[i] / 6;
        out->area += lanes.area[i] / 2;
        out->sides += lanes.sides[i];
    }
}

static measures measure(const smooth_work *work, const double *positions)
{
    measures all[SMOOTH_BLOCKS];
    uint64_t count = work->cut.face_count;
#pragma omp parallel for schedule(static)
    for (uint32_t block = 0; block < SMOOTH_BLOCKS; block++)
        measure_block(work, positions, smooth_block_begin(count, SMOOTH_BLOCKS, block),
                      smooth_block_begin(count, SMOOTH_BLOCKS, block + 1), all + block);
    for (uint32_t block = 1; block < SMOOTH_BLOCKS; block++) {
        all[0].volume += all[block].volume;
        all[0].area += all[block].area;
        all[0].sides += all[block].sides;
    }
    return all[0];
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

static void release(smooth_work *work)
{
    hewn_smooth_rows_free(&work->neighbours);
    hewn_smooth_rows_free(&work->fans);
    hewn_smooth_sides_free(&work->sides);
    hewn_free(work->cut_corners);
    hewn_free(work->flags);
    hewn_free(work->freedom);
    hewn_free(work->at);
    hewn_free(work->next);
}

static hewn_result cut_faces(smooth_work *work, hewn_error *error)
{
    work->cut = *work->polygons;
    if (!work->cut.first)
        return HEWN_OK;
    uint32_t *places;
    HEWN_TRY(hewn_cut_polygons(work->polygons, &places, &work->cut.face_count, work->desc->progress, error));
    for (uint64_t c = 0; c < 3 * work->cut.face_count; c++)
        places[c] = work->polygons->corners[places[c]];
    work->cut.first = NULL;
    work->cut.corners = work->cut_corners = places;
    return HEWN_OK;
}

static hewn_result find_neighbours(smooth_work *work, hewn_error *error)
{
    HEWN_TRY(hewn_smooth_sides_find(work->polygons, &work->sides, error));
    HEWN_TRY(hewn_smooth_neighbours(&work->sides, &work->neighbours, work->flags, error));
    if (!work->weighs || !work->polygons->first)
        return HEWN_OK;
    hewn_smooth_sides_free(&work->sides);
    return hewn_smooth_sides_find(&work->cut, &work->sides, error);
}

static hewn_result prepare(smooth_work *work, const frame *from, hewn_error *error)
{
    size_t count = work->count;
    work->flags = hewn_alloc_zero(count, sizeof *work->flags);
    work->at = hewn_alloc(3 * count + 1, sizeof *work->at);
    if (!work->flags || !work->at)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory smoothing %u vertices", work->count);
    work->at[3 * count] = 0;
#pragma omp parallel for schedule(static)
    for (size_t v = 0; v < count; v++)
        for (size_t axis = 0; axis < 3; axis++)
            work->at[3 * v + axis] = place_in(from, work->polygons->positions, v, axis);
    HEWN_TRY(cut_faces(work, error));
    return find_neighbours(work, error);
}

hewn_result hewn_smooth_take_room(smooth_work *work, hewn_error *error)
{
    const size_t numbers = 3 * (size_t)work->count + 1, words = 2 * (size_t)work->sides.first[work->count];
    if (words * sizeof(uint32_t) >= numbers * sizeof *work->next) {
        work->next = (double *)(void *)work->sides.items;
        work->sides.items = NULL;
    } else {
        work->next = hewn_alloc(numbers, sizeof *work->next);
    }
    hewn_smooth_sides_free(&work->sides);
    if (!work->next)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory smoothing %u vertices", work->count);
    work->next[numbers - 1] = 0;
    return HEWN_OK;
}

static hewn_result run_method(smooth_work *work, hewn_error *error)
{
    switch (work->desc->method) {
    case HEWN_SMOOTH_COTAN: return hewn_smooth_flow(work, error);
    case HEWN_SMOOTH_IMPLICIT: return hewn_smooth_implicit(work, error);
    case HEWN_SMOOTH_BILATERAL: return hewn_smooth_bilateral(work, error);
    case HEWN_SMOOTH_HC: return hewn_smooth_hc(work, error);
    default: return hewn_smooth_umbrella(work, error);
    }
}

/* Where a number of `at` is outside the frame. Vertices that have not moved keep their bits. */
static inline double place_out(const smooth_work *work, const frame *from, size_t v, size_t axis, double *move)
{
    const double before = work->polygons->positions[3 * v + axis], at = work->at[3 * v + axis];
    *move = at - place_in(from, work->polygons->positions, v, axis);
    return *move == 0 ? before : from->origin[axis] + at * from->scale;
}

/* Whether no vertex can leave the range of doubles, by the largest number alone. */
static bool all_stay(const smooth_work *work, const frame *from)
{
    double most = DBL_MAX / 4;
    for (int axis = 0; axis < 3; axis++)
        most = fmin(most, DBL_MAX / 2 - fabs(from->origin[axis]) / 2);
    most *= from->scale > 1 ? from->inverse : 1;
    int wrong = 0;
#pragma omp parallel for schedule(static) reduction(| : wrong)
    for (size_t i = 0; i < 3 * (size_t)work->count; i++)
        wrong |= !(fabs(work->at[i]) <= most);
    return !wrong;
}

/* The first vertex that would not stay finite, or their count. */
static uint32_t find_lost(const smooth_work *work, const frame *from)
{
    for (uint32_t v = 0; v < (all_stay(work, from) ? 0 : work->count); v++) {
        double move, wrong = 0;
        for (size_t axis = 0; axis < 3; axis++)
            wrong += 0 * place_out(work, from, v, axis, &move);
        if (wrong != 0)
            return v;
    }
    return work->count;
}

typedef struct moves {
    double sum, largest;
} moves;

static moves bring_block_back(const smooth_work *work, const frame *from, double *positions, uint32_t begin,
                              uint32_t end)
{
    moves made = {0, 0};
    for (uint32_t v = begin; v < end; v++) {
        double move[3];
        for (size_t axis = 0; axis < 3; axis++)
            positions[3 * (size_t)v + axis] = place_out(work, from, v, axis, move + axis);
        double length = sqrt(smooth_dot(move, move)) * from->scale;
        made.sum += length;
        made.largest = length > made.largest ? length : made.largest;
    }
    return made;
}

/* `positions` may be those of the input, and are left alone where one would not be finite. */
static hewn_result bring_back(const smooth_work *work, const frame *from, double *positions, hewn_error *error)
{
    hewn_smooth_report *report = work->report;
    moves all[SMOOTH_BLOCKS];
    const uint32_t lost = find_lost(work, from);
    if (lost < work->count)
        return hewn_fail(error, HEWN_LIMIT, "vertex %u would not stay finite", lost);
#pragma omp parallel for schedule(static)
    for (uint32_t block = 0; block < SMOOTH_BLOCKS; block++)
        all[block] =
            bring_block_back(work, from, positions, (uint32_t)smooth_block_begin(work->count, SMOOTH_BLOCKS, block),
                             (uint32_t)smooth_block_begin(work->count, SMOOTH_BLOCKS, block + 1));
    double sum = 0;
    for (uint32_t block = 0; block < SMOOTH_BLOCKS; block++) {
        sum += all[block].sum;
        report->largest_move = fmax(report->largest_move, all[block].largest);
    }
    report->mean_move = work->count > 0 ? sum / work->count : 0;
    return HEWN_OK;
}

/* Lengths that the caller gave, in the frame; a step that he did not is the mean edge. */
static void settle_lengths(smooth_work *work, hewn_smooth_desc *desc, const frame *from, const measures *found)
{
    double mean_edge = work->cut.face_count > 0 ? found->sides / (3 * (double)work->cut.face_count) : 0;
    desc->step = desc->step > 0 ? desc->step / from->scale : mean_edge;
    desc->radius /= from->scale;
}

static void report_measures(const measures *found, const frame *from, double *volume, double *area)
{
    *volume = found->volume * from->scale * from->scale * from->scale;
    *area = found->area * from->scale * from->scale;
}

static hewn_result run_keeping_volume(smooth_work *work, hewn_error *error)
{
    double *before = hewn_alloc(work->count, 3 * sizeof *before);
    if (!before)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory smoothing %u vertices", work->count);
    memcpy(before, work->at, 3 * (size_t)work->count * sizeof *before);
    hewn_result result = run_method(work, error);
    if (result == HEWN_OK)
        result = hewn_smooth_keep_volume(work, before, error);
    hewn_free(before);
    return result;
}

static hewn_result run(smooth_work *work, hewn_smooth_desc *desc, bool reported, double *positions, hewn_error *error)
{
    frame from = find_frame(work->polygons);
    hewn_smooth_report *report = work->report;
    bool flows = desc->method == HEWN_SMOOTH_COTAN || desc->method == HEWN_SMOOTH_IMPLICIT;
    bool kept = desc->volume == HEWN_SMOOTH_VOLUME_KEPT;
    measures found = {0};
    HEWN_TRY(prepare(work, &from, error));
    if (reported || flows)
        found = measure(work, work->at);
    report_measures(&found, &from, &report->volume_before, &report->area_before);
    settle_lengths(work, desc, &from, &found);
    if (desc->method == HEWN_SMOOTH_IMPLICIT || desc->method == HEWN_SMOOTH_BILATERAL)
        HEWN_TRY(hewn_smooth_corners(&work->cut, &work->fans, error));
    HEWN_TRY(hewn_smooth_lock(work, error));
    if (!flows || desc->step > 0)
        HEWN_TRY(kept ? run_keeping_volume(work, error) : run_method(work, error));
    if (reported)
        found = measure(work, work->at);
    report_measures(&found, &from, &report->volume_after, &report->area_after);
    report->step = flows ? desc->step * from.scale : 0;
    report->radius *= from.scale;
    return bring_back(work, &from, positions, error);
}

hewn_result hewn_polygons_smooth(const hewn_polygons *polygons, const hewn_smooth_desc *desc, double *positions,
                                 hewn_smooth_report *report, hewn_error *error)
{
    hewn_smooth_desc settled = desc ? *desc : (hewn_smooth_desc){0};
    hewn_smooth_report done = {0};
    if (report)
        *report = done;
    HEWN_TRY(hewn_smooth_settle(&settled, error));
    HEWN_TRY(check_polygons(polygons, settled.freedom, error));
    smooth_work work = {
        .polygons = polygons, .desc = &settled, .report = &done, .count = (uint32_t)polygons->vertex_count};
    work.weighs = settled.method == HEWN_SMOOTH_COTAN;
    bool umbrella = settled.method == HEWN_SMOOTH_TAUBIN || settled.method == HEWN_SMOOTH_LAPLACIAN;
    done.iterations = settled.iterations;
    done.strength = umbrella ? settled.strength : 0;
    done.passband = settled.method == HEWN_SMOOTH_TAUBIN ? settled.passband : 0;
    done.angle = settled.method == HEWN_SMOOTH_BILATERAL ? settled.angle : 0;
    hewn_result result = run(&work, &settled, report != NULL, positions, error);
    release(&work);
    if (result == HEWN_OK && report)
        *report = done;
    return result;
}

/* --- curvature ---------------------------------------------------------------------------------------------------- */

static void find_curvature(const smooth_work *work, const frame *from, double *curvature, double *areas)
{
#pragma omp parallel for schedule(static)
    for (uint32_t v = 0; v < work->count; v++) {
        smooth_star star = smooth_star_of(work->at, &work->sides, v);
        for (size_t axis = 0; curvature && axis < 3; axis++)
            curvature[3 * (size_t)v + axis] = star.area > 0 ? star.pull[axis] / star.area / from->scale : 0;
        if (areas)
            areas[v] = star.area * from->scale * from->scale;
    }
}

hewn_result hewn_mean_curvature(const hewn_polygons *polygons, double *curvature, double *areas, hewn_error *error)
{
    HEWN_TRY(check_polygons(polygons, NULL, error));
    hewn_smooth_desc desc = {0};
    smooth_work work = {.polygons = polygons, .desc = &desc, .count = (uint32_t)polygons->vertex_count, .weighs = true};
    frame from = find_frame(polygons);
    hewn_result result = prepare(&work, &from, error);
    if (result == HEWN_OK)
        find_curvature(&work, &from, curvature, areas);
    release(&work);
    return result;
}
