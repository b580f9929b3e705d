/* Bilateral normal filtering. A step replaces the normal of each triangle by the mean over the triangles that share a
 * vertex with it, weighted by area, by nearness of centroids, by likeness of guide normals (Zheng, Fu, Au and Tai 2011;
 * the guides: Zhang and others 2015) and by likeness of the normals themselves, as measured by the noise that is left:
 * what bends by much more than most edges do is shape. Then vertices move towards positions whose triangles have those
 * normals (Sun, Rosin, Martin and Langbein 2007): x += mean over its triangles of n (n . (centroid - x)). */
#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "smooth/blocks.h"
#include "smooth/guide.h"
#include "smooth/work.h"

enum { VERTEX_STEPS = 10, BENDS = 1 << 16 };

/* Normals count as unlike where they differ by many times what those beside an edge differ by. */
static const double NOISE_WIDTH = 3.5;

/* Three numbers a triangle, but for `areas`. */
typedef struct bilateral {
    smooth_work *work;
    uint32_t triangles;
    double *normals, *next, *guides, *centroids, *areas;
    smooth_guide guide;
    double by_distance, by_guide, by_normal; /* 1 / (2 sigma^2) */
    uint32_t *bends;                         /* BENDS; how many edges bend by so much */
} bilateral;

static double squared_distance(const double *a, const double *b)
{
    double apart[3];
    smooth_between(a, b, apart);
    return smooth_dot(apart, apart);
}

static void measure(const bilateral *filter)
{
    const smooth_work *work = filter->work;
#pragma omp parallel for schedule(static)
    for (uint32_t t = 0; t < filter->triangles; t++) {
        const uint32_t *corner = work->cut.corners + 3 * (size_t)t;
        const double *a = work->at + 3 * (size_t)corner[0], *b = work->at + 3 * (size_t)corner[1],
                     *c = work->at + 3 * (size_t)corner[2];
        double u[3], v[3], *normal = filter->normals + 3 * (size_t)t;
        smooth_between(a, b, u);
        smooth_between(a, c, v);
        smooth_cross(u, v, normal);
        double twice = sqrt(smooth_dot(normal, normal));
        filter->areas[t] = twice / 2;
        for (size_t axis = 0; axis < 3; axis++) {
            normal[axis] = twice > 0 ? normal[axis] / twice : 0;
            filter->centroids[3 * (size_t)t + axis] = (a[axis] + b[axis] + c[axis]) / 3;
        }
    }
}

/* The mean distance between centroids of near triangles. */
static double mean_distance(const bilateral *filter)
{
    const smooth_rows *near = &filter->guide.near;
    const uint32_t count = filter->triangles, pairs = near->first[count] - count; /* each is near itself */
    double all[SMOOTH_BLOCKS], sum = 0;
#pragma omp parallel for schedule(static)
    for (uint32_t block = 0; block < SMOOTH_BLOCKS; block++) {
        const uint32_t end = (uint32_t)smooth_block_begin(count, SMOOTH_BLOCKS, block + 1);
        all[block] = 0;
        for (uint32_t t = (uint32_t)smooth_block_begin(count, SMOOTH_BLOCKS, block); t < end; t++)
            for (uint32_t i = near->first[t]; i < near->first[t + 1]; i++)
                all[block] += sqrt(squared_distance(filter->centroids + 3 * (size_t)t,
                                                    filter->centroids + 3 * (size_t)near->items[i]));
    }
    for (uint32_t block = 0; block < SMOOTH_BLOCKS; block++)
        sum += all[block];
    return pairs > 0 ? sum / pairs : 0;
}

static void filter_normal(const bilateral *filter, uint32_t t, double out[3])
{
    const smooth_rows *near = &filter->guide.near;
    const double *guide = filter->guides + 3 * (size_t)t, *centroid = filter->centroids + 3 * (size_t)t;
    const double *normal = filter->normals + 3 * (size_t)t;
    double sum[3] = {0, 0, 0};
    for (uint32_t i = near->first[t]; i < near->first[t + 1]; i++) {
        size_t other = near->items[i];
        double unlikeness = squared_distance(centroid, filter->centroids + 3 * other) * filter->by_distance +
                            squared_distance(guide, filter->guides + 3 * other) * filter->by_guide +
                            squared_distance(normal, filter->normals + 3 * other) * filter->by_normal;
        double weight = filter->areas[other] * exp(-unlikeness);
        for (size_t axis = 0; axis < 3; axis++)
            sum[axis] += weight * filter->normals[3 * other + axis];
    }
    double length = sqrt(smooth_dot(sum, sum));
    for (size_t axis = 0; axis < 3; axis++)
        out[axis] = length > 0 ? sum[axis] / length : normal[axis];
}

static void filter_normals(bilateral *filter)
{
#pragma omp parallel for schedule(dynamic, 1024)
    for (uint32_t t = 0; t < filter->triangles; t++)
        filter_normal(filter, t, filter->next + 3 * (size_t)t);
    double *now = filter->normals;
    filter->normals = filter->next;
    filter->next = now;
}

static void follow_normals(bilateral *filter)
{
    smooth_work *work = filter->work;
#pragma omp parallel for schedule(static)
    for (uint32_t v = 0; v < work->count; v++) {
        const double *x = work->at + 3 * (size_t)v;
        uint32_t begin = work->fans.first[v], end = work->fans.first[v + 1];
        double sum[3] = {0, 0, 0}, free = end > begin ? smooth_freedom(work, v) / (end - begin) : 0;
        for (uint32_t i = begin; i < end; i++) {
            const uint32_t *corner = work->cut.corners + 3 * (size_t)(work->fans.items[i] / 3);
            const double *normal = filter->normals + 3 * (size_t)(work->fans.items[i] / 3);
            double apart[3];
            for (size_t axis = 0; axis < 3; axis++)
                apart[axis] = (work->at[3 * (size_t)corner[0] + axis] + work->at[3 * (size_t)corner[1] + axis] +
                               work->at[3 * (size_t)corner[2] + axis]) /
                                  3 -
                              x[axis];
            double along = smooth_dot(normal, apart);
            for (int axis = 0; axis < 3; axis++)
                sum[axis] += along * normal[axis];
        }
        for (size_t axis = 0; axis < 3; axis++)
            work->next[3 * (size_t)v + axis] = x[axis] + free * sum[axis];
    }
    smooth_swap(work);
}

/* How much the normals beside an edge differ, in the median of edges: mostly noise, since sharp edges are few. At least
 * 1 / BENDS. */
static double find_noise(const bilateral *filter)
{
    uint64_t edges = 0, seen = 0;
    uint32_t *bends = filter->bends;
    memset(bends, 0, BENDS * sizeof *bends);
#pragma omp parallel for schedule(static) reduction(+ : edges, bends[:BENDS])
    for (uint32_t t = 0; t < filter->triangles; t++) {
        for (size_t side = 0; side < 3; side++) {
            uint32_t other = filter->guide.beside[3 * (size_t)t + side];
            if (other <= t)
                continue;
            double bend = squared_distance(filter->normals + 3 * (size_t)t, filter->normals + 3 * (size_t)other);
            bends[(uint32_t)fmin(sqrt(bend) / 2 * BENDS, BENDS - 1)]++;
            edges++;
        }
    }
    uint32_t bin = 0;
    while (bin < BENDS - 1 && (seen += bends[bin]) < (edges + 1) / 2)
        bin++;
    return 2.0 * (bin + 0.5) / BENDS;
}

static double between_unit_vectors(double degrees)
{
    return 2 * sin(degrees * (M_PI / 360));
}

static void step(bilateral *filter)
{
    double width = NOISE_WIDTH * find_noise(filter);
    filter->by_normal = 0.5 / (width * width);
    hewn_smooth_guide_find(&filter->guide, filter->normals, filter->areas, filter->guides);
    filter_normals(filter);
    for (int i = 0; i < VERTEX_STEPS; i++)
        follow_normals(filter);
}

static hewn_result run(bilateral *filter, hewn_error *error)
{
    const hewn_smooth_desc *desc = filter->work->desc;
    measure(filter);
    double radius = desc->radius > 0 ? desc->radius : mean_distance(filter);
    double unlike = between_unit_vectors(desc->angle);
    filter->work->report->radius = radius;
    filter->by_distance = radius > 0 ? 0.5 / (radius * radius) : 0;
    filter->by_guide = 0.5 / (unlike * unlike);
    for (uint32_t i = 0; i < desc->iterations; i++) {
        HEWN_TRY(hewn_progress_report(desc->progress, "smooth", 1.0 * i / desc->iterations, error));
        if (i > 0)
            measure(filter);
        step(filter);
    }
    return HEWN_OK;
}

hewn_result hewn_smooth_bilateral(smooth_work *work, hewn_error *error)
{
    bilateral filter = {.work = work, .triangles = (uint32_t)work->cut.face_count};
    size_t count = filter.triangles;
    HEWN_TRY(hewn_smooth_take_room(work, error));
    double *room = hewn_alloc(count, 13 * sizeof *room);
    filter.bends = hewn_alloc(BENDS, sizeof *filter.bends);
    if (!room || !filter.bends) {
        hewn_free(room);
        hewn_free(filter.bends);
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory smoothing %zu triangles", count);
    }
    filter.normals = room;
    filter.next = room + 3 * count;
    filter.centroids = room + 6 * count;
    filter.guides = room + 9 * count;
    filter.areas = room + 12 * count;
    hewn_result result = hewn_smooth_guide_init(&filter.guide, &work->cut, &work->fans, error);
    if (result == HEWN_OK)
        result = run(&filter, error);
    hewn_smooth_guide_free(&filter.guide);
    hewn_free(filter.bends);
    hewn_free(room);
    return result;
}
