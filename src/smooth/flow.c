/* Mean curvature flow in explicit steps, by weights that are measured at the start and kept, as those of backward Euler
 * are; or measured anew now and then. */
#include "base/alloc.h"
#include "base/clones.h"
#include "smooth/blocks.h"
#include "smooth/cotangent.h"

/* The share of the way to each neighbour that a vertex goes in a step; floats, whose rounding moves no vertex by more
 * than some 1e-7 of an edge. */
typedef struct flow_weights {
    const smooth_rows *rows; /* of neighbours in triangles */
    smooth_rows owned;       /* those, where faces have been cut */
    float *items;            /* as `rows` has */
} flow_weights;

static hewn_result find_rows(const smooth_work *work, flow_weights *out, hewn_error *error)
{
    out->rows = &work->neighbours;
    if (work->polygons->first) {
        uint8_t *flags = hewn_alloc_zero(work->count, sizeof *flags);
        if (!flags)
            return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory smoothing %u vertices", work->count);
        hewn_result result = hewn_smooth_neighbours(&work->sides, &out->owned, flags, error);
        hewn_free(flags);
        HEWN_TRY(result);
        out->rows = &out->owned;
    }
    out->items = hewn_alloc(out->rows->first[work->count], sizeof *out->items);
    return out->items ? HEWN_OK
                      : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory smoothing %u vertices", work->count);
}

/* Corners at a vertex that are weighed at a time: their triangles' vertices after and before it, and what comes of it. */
enum { LANES = 8 };
typedef struct corner_lanes {
    uint32_t next[LANES], before[LANES];
    double u[3][LANES], v[3][LANES], area[LANES];
    float to_next[LANES], to_before[LANES]; /* weights of the edges */
} corner_lanes;

/* Lanes past the count are triangles without area. */
static HEWN_INTO_CLONES void gather(const smooth_work *work, uint32_t v, const smooth_side *sides, uint32_t count,
                          corner_lanes *out)
{
    const double *x = work->at + 3 * (size_t)v;
    for (uint32_t i = 0; i < LANES; i++) {
        const smooth_side side = i < count ? sides[i] : (smooth_side){v, v};
        out->next[i] = side.next;
        out->before[i] = side.before;
        for (size_t axis = 0; axis < 3; axis++) {
            out->u[axis][i] = work->at[3 * (size_t)side.next + axis] - x[axis];
            out->v[axis][i] = work->at[3 * (size_t)side.before + axis] - x[axis];
        }
    }
}

static HEWN_INTO_CLONES void measure_lanes(corner_lanes *lanes)
{
    for (int i = 0; i < LANES; i++) {
        const double u[3] = {lanes->u[0][i], lanes->u[1][i], lanes->u[2][i]};
        const double v[3] = {lanes->v[0][i], lanes->v[1][i], lanes->v[2][i]};
        const smooth_triangle triangle = smooth_triangle_between(u, v);
        const smooth_corner corner = smooth_corner_of(&triangle, 0, u, v);
        lanes->to_next[i] = (float)corner.ab;
        lanes->to_before[i] = (float)corner.ac;
        lanes->area[i] = corner.area;
    }
}

/* The sum of lanes by halves, which leaves little to wait for. */
static HEWN_INTO_CLONES double sum_lanes(const double *items)
{
    double half[LANES / 2];
    for (int i = 0; i < LANES / 2; i++)
        half[i] = items[i] + items[i + LANES / 2];
    return (half[0] + half[2]) + (half[1] + half[3]);
}

static HEWN_INTO_CLONES double sum_sizes(const corner_lanes *lanes)
{
    double sizes[LANES];
    for (int i = 0; i < LANES; i++)
        sizes[i] = (double)(fabsf(lanes->to_next[i]) + fabsf(lanes->to_before[i]));
    return sum_lanes(sizes);
}

/* Adds what corners give to the edges of a row. */
static HEWN_INTO_CLONES void add_lanes(const corner_lanes *lanes, const uint32_t *row, uint32_t length, float *weights)
{
    for (uint32_t begin = 0; begin < length; begin += LANES) {
        const uint32_t count = length - begin < LANES ? length - begin : LANES;
        uint32_t names[LANES];
        float sum[LANES] = {0};
        for (uint32_t k = 0; k < LANES; k++)
            names[k] = k < count ? row[begin + k] : HEWN_NONE;
        for (int i = 0; i < LANES; i++)
            for (int k = 0; k < LANES; k++)
                sum[k] += (names[k] == lanes->next[i] ? lanes->to_next[i] : 0) +
                          (names[k] == lanes->before[i] ? lanes->to_before[i] : 0);
        for (uint32_t k = 0; k < count; k++)
            weights[begin + k] += sum[k];
    }
}

/* A vertex of area A and weights w moves by t / A of its pull. Gershgorin's circles keep the eigenvalues of the step
 * within 2 where t / A is at most 1 / sum |w|, so no vertex goes further; whether it would have. */
static HEWN_INTO_CLONES bool weigh_vertex(const smooth_work *work, const flow_weights *weights, double time, uint32_t v)
{
    const uint32_t begin = weights->rows->first[v], length = weights->rows->first[v + 1] - begin;
    const uint32_t *row = weights->rows->items + begin;
    const double free = work->flags[v] & SMOOTH_RIM ? 0 : smooth_freedom(work, v);
    float *out = weights->items + begin;
    double sum = 0, area = 0;
    for (uint32_t k = 0; k < length; k++)
        out[k] = 0;
    const uint32_t end = free > 0 ? work->sides.first[v + 1] : 0;
    for (uint32_t i = work->sides.first[v]; i < end; i += LANES) {
        corner_lanes lanes;
        gather(work, v, work->sides.items + i, end - i, &lanes);
        measure_lanes(&lanes);
        add_lanes(&lanes, row, length, out);
        sum += sum_sizes(&lanes);
        area += sum_lanes(lanes.area);
    }
    const bool far = time * sum > area;
    const double factor = !(sum > 0) ? 0 : free * (far ? 1 / sum : time / area);
    for (uint32_t k = 0; k < length; k++)
        out[k] = (float)((double)out[k] * factor);
    return far;
}

HEWN_CLONES static uint64_t weigh_block(const smooth_work *work, const flow_weights *weights, double time,
                                        uint32_t begin, uint32_t end)
{
    uint64_t clamped = 0;
    for (uint32_t v = begin; v < end; v++)
        clamped += weigh_vertex(work, weights, time, v);
    return clamped;
}

static void weigh(const smooth_work *work, const flow_weights *weights)
{
    const double time = work->desc->step * work->desc->step / 2;
    uint64_t clamped = 0;
#pragma omp parallel for schedule(static) reduction(+ : clamped)
    for (uint32_t block = 0; block < SMOOTH_BLOCKS; block++)
        clamped +=
            weigh_block(work, weights, time, (uint32_t)smooth_block_begin(work->count, SMOOTH_BLOCKS, block),
                        (uint32_t)smooth_block_begin(work->count, SMOOTH_BLOCKS, block + 1));
    work->report->clamped_vertices = clamped;
}

HEWN_CLONES static void sweep_block(const flow_weights *weights, const double *restrict from, double *restrict to,
                                    uint32_t begin, uint32_t end)
{
    const smooth_rows *rows = weights->rows;
    for (uint32_t v = begin; v < end; v++) {
        const double *x = from + 3 * (size_t)v;
        double sum[4] = {0, 0, 0, 0};
        for (uint32_t i = rows->first[v]; i < rows->first[v + 1]; i++) {
            const double *item = from + 3 * (size_t)rows->items[i];
            const double weight = (double)weights->items[i];
            for (int lane = 0; lane < 4; lane++)
                sum[lane] += weight * (item[lane] - x[lane]);
        }
        for (size_t axis = 0; axis < 3; axis++)
            to[3 * (size_t)v + axis] = x[axis] + sum[axis];
    }
}

static void sweep(smooth_work *work, const flow_weights *weights)
{
#pragma omp parallel for schedule(static)
    for (uint32_t block = 0; block < SMOOTH_BLOCKS; block++)
        sweep_block(weights, work->at, work->next, (uint32_t)smooth_block_begin(work->count, SMOOTH_BLOCKS, block),
                    (uint32_t)smooth_block_begin(work->count, SMOOTH_BLOCKS, block + 1));
    smooth_swap(work);
}

/* Where weights are kept, their sides make room. */
static hewn_result prepare(smooth_work *work, flow_weights *weights, hewn_error *error)
{
    HEWN_TRY(find_rows(work, weights, error));
    if (work->desc->remeasure == 0) {
        weigh(work, weights);
        return hewn_smooth_take_room(work, error);
    }
    work->next = hewn_alloc(3 * (size_t)work->count + 1, sizeof *work->next);
    if (!work->next)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory smoothing %u vertices", work->count);
    work->next[3 * (size_t)work->count] = 0;
    return HEWN_OK;
}

hewn_result hewn_smooth_flow(smooth_work *work, hewn_error *error)
{
    const hewn_smooth_desc *desc = work->desc;
    flow_weights weights = {0};
    hewn_result result = prepare(work, &weights, error);
    for (uint32_t i = 0; i < desc->iterations && result == HEWN_OK; i++) {
        result = hewn_progress_report(desc->progress, "smooth", (double)i / desc->iterations, error);
        if (result != HEWN_OK)
            break;
        if (desc->remeasure > 0 && i % desc->remeasure == 0)
            weigh(work, &weights);
        sweep(work, &weights);
    }
    hewn_smooth_rows_free(&weights.owned);
    hewn_free(weights.items);
    return result;
}
