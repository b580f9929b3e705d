/* Bilateral normal filtering. Each step replaces the normal of a triangle by the mean over the triangles that share a
 * vertex with it, weighted by area, by nearness of centroids and by likeness of normals (Zheng, Fu, Au and Tai 2011,
 * local scheme). Then vertices move towards positions whose triangles have those normals (Sun, Rosin, Martin and
 * Langbein 2007): x += mean over its triangles of n (n . (centroid - x)). */
#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "smooth/work.h"

enum { MOST_NEAR = 256, VERTEX_STEPS = 10 };

/* Three numbers a triangle, but for `areas`. */
typedef struct bilateral {
    smooth_work *work;
    uint32_t triangles;
    double *normals, *next, *centroids, *areas;
    double by_distance, by_normal; /* 1 / (2 sigma^2) */
} bilateral;

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

/* The triangles that share a vertex with t, itself among them, each once; at most MOST_NEAR. */
static uint32_t find_near(const smooth_work *work, uint32_t t, uint32_t *near)
{
    uint32_t count = 0;
    for (uint32_t k = 0; k < 3; k++) {
        uint32_t v = work->cut.corners[3 * (size_t)t + k];
        for (uint32_t i = work->fans.first[v]; i < work->fans.first[v + 1] && count < MOST_NEAR; i++) {
            uint32_t other = work->fans.items[i] / 3, at = 0;
            while (at < count && near[at] != other)
                at++;
            if (at == count)
                near[count++] = other;
        }
    }
    return count;
}

/* The mean distance between centroids of near triangles. */
static double mean_distance(const bilateral *filter)
{
    double sum = 0;
    uint64_t pairs = 0;
    uint32_t near[MOST_NEAR];
    for (uint32_t t = 0; t < filter->triangles; t++) {
        uint32_t count = find_near(filter->work, t, near);
        for (uint32_t i = 0; i < count; i++) {
            double apart[3];
            smooth_between(filter->centroids + 3 * (size_t)t, filter->centroids + 3 * (size_t)near[i], apart);
            sum += sqrt(smooth_dot(apart, apart));
        }
        pairs += count > 1 ? count - 1 : 0;
    }
    return pairs > 0 ? sum / (double)pairs : 0;
}

static void filter_normal(const bilateral *filter, uint32_t t, double out[3])
{
    uint32_t near[MOST_NEAR], count = find_near(filter->work, t, near);
    const double *normal = filter->normals + 3 * (size_t)t, *centroid = filter->centroids + 3 * (size_t)t;
    double sum[3] = {0, 0, 0};
    for (uint32_t i = 0; i < count; i++) {
        const double *other = filter->normals + 3 * (size_t)near[i];
        double apart[3], unlike[3];
        smooth_between(centroid, filter->centroids + 3 * (size_t)near[i], apart);
        smooth_between(normal, other, unlike);
        double weight = filter->areas[near[i]] * exp(-smooth_dot(apart, apart) * filter->by_distance -
                                                     smooth_dot(unlike, unlike) * filter->by_normal);
        for (int axis = 0; axis < 3; axis++)
            sum[axis] += weight * other[axis];
    }
    double length = sqrt(smooth_dot(sum, sum));
    for (int axis = 0; axis < 3; axis++)
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

static hewn_result run(bilateral *filter, hewn_error *error)
{
    smooth_work *work = filter->work;
    const hewn_smooth_desc *desc = work->desc;
    measure(filter);
    double radius = desc->radius > 0 ? desc->radius : mean_distance(filter);
    double unlike = 2 * sin(desc->angle * (M_PI / 360)); /* between unit vectors at that angle */
    work->report->radius = radius;
    filter->by_distance = radius > 0 ? 0.5 / (radius * radius) : 0;
    filter->by_normal = 0.5 / (unlike * unlike);
    for (uint32_t i = 0; i < desc->iterations; i++) {
        HEWN_TRY(hewn_progress_report(desc->progress, "smooth", 0.7 * i / desc->iterations, error));
        filter_normals(filter);
    }
    for (int i = 0; i < VERTEX_STEPS; i++) {
        HEWN_TRY(hewn_progress_report(desc->progress, "smooth", 0.7 + 0.3 * i / VERTEX_STEPS, error));
        follow_normals(filter);
    }
    return HEWN_OK;
}

hewn_result hewn_smooth_bilateral(smooth_work *work, hewn_error *error)
{
    bilateral filter = {.work = work, .triangles = (uint32_t)work->cut.face_count};
    size_t count = filter.triangles;
    double *room = hewn_alloc(count, 10 * sizeof *room);
    if (!room)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory smoothing %zu triangles", count);
    filter.normals = room;
    filter.next = room + 3 * count;
    filter.centroids = room + 6 * count;
    filter.areas = room + 9 * count;
    hewn_result result = run(&filter, error);
    hewn_free(room);
    return result;
}
