#include "simplify/fit.h"

#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "simplify/collapse.h"

/* What is further away counts more: by this times the square of how many times the mean it is. How much a vertex stays
 * where it is, as a share of what pulls it. From this share of the greatest distance on, a place must not get worse. */
static const double far_weight = 0.2, stay_share = 0.02, far_share = 0.7;

typedef struct fitting {
    simplify_work *work;
    simplify_gauge *gauge;
    simplify_gaps *gaps;
    double *pulls; /* 9 a vertex: a matrix as in quadrics, and a vector */
    double *before;
    float *away;
    uint8_t *turned;
} fitting;

/* A point of the input pulls the corners of its triangle along the normal, each by its share of the point. Shares sum
 * to one, so the sum of shares times squared moves is never less than the square of what they come to together: if each
 * vertex is solved for by itself, squared distances still become less (a majorizer). */
static void pull(const fitting *job, const double at[3], uint32_t face, double weight)
{
    const simplify_work *work = job->work;
    const uint32_t *corner = work->tail + 3 * (size_t)face;
    const double *a = simplify_at(work, corner[0]), *b = simplify_at(work, corner[1]),
                 *c = simplify_at(work, corner[2]);
    const double *from[3] = {b, c, a}, *to[3] = {c, a, b};
    double n[3], away[3], share[3], part[3], sum = 0;
    simplify_area_vector(a, b, c, n);
    const double square = simplify_dot(n, n);
    if (!(square > 0))
        return;
    for (int k = 0; k < 3; k++) {
        simplify_area_vector(at, from[k], to[k], part);
        share[k] = fmax(simplify_dot(part, n), 0);
        sum += share[k];
    }
    simplify_between(a, at, away);
    const double height = simplify_dot(away, n) / square; /* times n is the way to the point */
    for (int k = 0; k < 3 && sum > 0; k++) {
        double *to_sum = job->pulls + 9 * (size_t)corner[k];
        const double w = weight * share[k] / sum, x = w / square;
        to_sum[0] += x * n[0] * n[0];
        to_sum[1] += x * n[0] * n[1];
        to_sum[2] += x * n[0] * n[2];
        to_sum[3] += x * n[1] * n[1];
        to_sum[4] += x * n[1] * n[2];
        to_sum[5] += x * n[2] * n[2];
        for (int axis = 0; axis < 3; axis++)
            to_sum[6 + axis] += w * height * n[axis];
    }
}

static double mean_gap(const simplify_gauge *gauge)
{
    double sum = 0;
    uint64_t count = 0;
    for (uint32_t v = 0; v < gauge->work->input_count; v += gauge->step)
        if (gauge->near[v] != HEWN_NONE) {
            sum += (double)gauge->gap[v];
            count++;
        }
    return count > 0 ? sum / (double)count : 0;
}

static void pull_all(const fitting *job)
{
    const simplify_gauge *gauge = job->gauge;
    const double mean = mean_gap(gauge);
    memset(job->pulls, 0, job->work->vertex_count * 9 * sizeof *job->pulls);
    for (uint32_t v = 0; v < job->work->input_count && mean > 0; v += gauge->step) {
        if (gauge->near[v] == HEWN_NONE)
            continue;
        const double times = (double)gauge->gap[v] / mean;
        pull(job, gauge->positions + 3 * (size_t)v, gauge->near[v], 1 + far_weight * times * times);
    }
}

/* One after the other, so that no two together turn a triangle over. */
static void move_all(const fitting *job)
{
    simplify_work *work = job->work;
    for (uint32_t v = 0; v < work->vertex_count; v++) {
        simplify_quadric q = {0};
        const double *pulls = job->pulls + 9 * (size_t)v;
        double move[3], to[3];
        if (work->rank[v] != SIMPLIFY_SMOOTH)
            continue;
        memcpy(q.a, pulls, sizeof q.a);
        const double stay = stay_share * (q.a[0] + q.a[3] + q.a[5]);
        q.a[0] += stay;
        q.a[3] += stay;
        q.a[5] += stay;
        if (!simplify_quadric_solve(&q, pulls + 6, move))
            continue;
        const double length = sqrt(simplify_dot(move, move)), most = (double)job->gaps->away[v];
        for (int axis = 0; axis < 3; axis++)
            to[axis] = simplify_at(work, v)[axis] + move[axis] * (length > most ? most / length : 1);
        if (hewn_simplify_may_move(work, v, to))
            memcpy(work->positions + 3 * (size_t)v, to, sizeof to);
    }
}

/* A vertex and those around it. */
static void put_back(const fitting *job, uint32_t v)
{
    simplify_work *work = job->work;
    const uint32_t first = work->half[v];
    uint32_t h = first;
    if (work->rank[v] == SIMPLIFY_APART)
        return;
    memcpy(work->positions + 3 * (size_t)v, job->before + 3 * (size_t)v, 3 * sizeof *job->before);
    do {
        const uint32_t in = simplify_prev(h), ends[2] = {simplify_head(work, h), work->tail[in]};
        for (int k = 0; k < 2; k++)
            memcpy(work->positions + 3 * (size_t)ends[k], job->before + 3 * (size_t)ends[k], 3 * sizeof *job->before);
        h = work->twin[in];
    } while (h != HEWN_NONE && h != first);
}

static bool allocate(fitting *job)
{
    const size_t verts = job->work->vertex_count;
    job->pulls = hewn_alloc(verts, 9 * sizeof *job->pulls);
    job->before = hewn_alloc(verts, 3 * sizeof *job->before);
    job->away = hewn_alloc(verts, sizeof *job->away);
    job->turned = hewn_alloc(verts, 1);
    return job->pulls && job->before && job->away && job->turned;
}

static hewn_result fit(fitting *job, hewn_error *error)
{
    const size_t verts = job->work->vertex_count;
    simplify_gaps *gaps = job->gaps;
    const simplify_gaps was = *gaps;
    const double far = far_share * was.most;
    memcpy(job->before, job->work->positions, verts * 3 * sizeof *job->before);
    memcpy(job->away, gaps->away, verts * sizeof *job->away);
    memcpy(job->turned, gaps->turned, verts);
    pull_all(job);
    move_all(job);
    HEWN_TRY(hewn_simplify_measure(job->gauge, gaps, error));
    for (uint32_t v = 0; v < verts; v++)
        if (((double)gaps->away[v] > far && gaps->away[v] > job->away[v]) || (gaps->turned[v] && !job->turned[v]))
            put_back(job, v);
    HEWN_TRY(hewn_simplify_measure(job->gauge, gaps, error));
    if (gaps->most <= was.most && gaps->flips <= was.flips)
        return HEWN_OK;
    memcpy(job->work->positions, job->before, verts * 3 * sizeof *job->before);
    return hewn_simplify_measure(job->gauge, gaps, error);
}

hewn_result hewn_simplify_fit(simplify_work *work, simplify_gauge *gauge, simplify_gaps *gaps, hewn_error *error)
{
    fitting job = {.work = work, .gauge = gauge, .gaps = gaps};
    hewn_result result =
        allocate(&job) ? fit(&job, error) : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
    hewn_free(job.pulls);
    hewn_free(job.before);
    hewn_free(job.away);
    hewn_free(job.turned);
    return result;
}
