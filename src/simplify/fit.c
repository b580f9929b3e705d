#include "simplify/fit.h"

#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "geom/nearest.h"
#include "simplify/collapse.h"
#include "simplify/swap.h"

/* What is further away counts more: by this times the square of how many times the mean it is. How much a vertex stays
 * where it is, as a share of what pulls it. From this share of the greatest distance on, a place must not get worse. */
static const double far_weight = 0.2, stay_share = 0.02, far_share = 0.7;

/* What is left of the sum of squares where an edge is swapped. */
static const double swap_gain = 0.98;

/* Vertices of a part, how often all are moved, and the most triangles whose edges are swapped: where there are many,
 * that takes too long for what it brings. */
enum { PART = 512, SWEEPS = 2, MOST_SWAPPED = 2500 };

typedef struct fitting {
    simplify_work *work;
    double mean, most;
    double density;  /* of samples, by twice the area, where distances back to the input count as well; or 0 */
    uint8_t *inside; /* one a vertex: all its neighbours are of the same part */
    uint32_t parts;
    uint32_t *faces; /* the first triangle of each part, by its first vertex; and one more */
} fitting;

/* Samples of one triangle pull its corner `v` along the normal, each by its share of the sample. */
static void pull(const fitting *job, uint32_t h, simplify_quadric *q, double to[3])
{
    const simplify_work *work = job->work;
    const simplify_samples *samples = work->samples;
    const double *a = simplify_at(work, work->tail[h]), *b = simplify_at(work, simplify_head(work, h)),
                 *c = simplify_at(work, work->tail[simplify_prev(h)]);
    double n[3];
    simplify_area_vector(a, b, c, n);
    const double square = simplify_dot(n, n);
    if (!(square > 0))
        return;
    for (uint32_t s = samples->first[h / 3]; s != HEWN_NONE; s = samples->items[s].next) {
        const double *at = samples->items[s].at;
        double part[3], away[3];
        simplify_area_vector(at, b, c, part);
        double share = simplify_dot(part, n) / square;
        share = share < 0 ? 0 : share > 1 ? 1 : share;
        simplify_between(a, at, away);
        const double height = simplify_dot(away, n) / square; /* times n is the way to the sample */
        const double times = (double)samples->items[s].gap / job->mean;
        const double weight = (double)samples->items[s].weight * (1 + far_weight * times * times);
        const double x = weight * share * share / square;
        q->a[0] += x * n[0] * n[0];
        q->a[1] += x * n[0] * n[1];
        q->a[2] += x * n[0] * n[2];
        q->a[3] += x * n[1] * n[1];
        q->a[4] += x * n[1] * n[2];
        q->a[5] += x * n[2] * n[2];
        for (int axis = 0; axis < 3; axis++)
            to[axis] += weight * share * height * n[axis];
    }
}

/* Whether moves and swaps look at all of the input for what triangles face away from. */
static bool is_strict(const fitting *job)
{
    return job->work->samples->strict;
}

/* Whether triangles would face away; only looked for where that is strict. */
static bool turns_any(const fitting *job, const simplify_probe *probe)
{
    return is_strict(job) && hewn_simplify_probe_turns(job->work, probe, 0) > 0;
}

static bool turns_more(const simplify_work *work, const simplify_probe *probe, uint32_t before)
{
    return hewn_simplify_probe_turns(work, probe, before) > before;
}

/* --- back to the input -------------------------------------------------------------------------------------------- */

/* Points of a triangle, by what its corners count there. */
enum { POINTS = 4 };
static const double points[POINTS][3] = {
    {1.0 / 3, 1.0 / 3, 1.0 / 3}, {2.0 / 3, 1.0 / 6, 1.0 / 6}, {1.0 / 6, 2.0 / 3, 1.0 / 6}, {1.0 / 6, 1.0 / 6, 2.0 / 3}};

/* The sum of squared distances from points of one triangle at `to` to the input, as samples are weighed; they pull its
 * first corner to the planes of what is nearest. */
static double pull_back(const fitting *job, const double to[3], const double b[3], const double c[3], uint32_t *near,
                        simplify_quadric *q, double pulled[3])
{
    const simplify_samples *samples = job->work->samples;
    double n[3], sum = 0;
    simplify_area_vector(to, b, c, n);
    const double weight = job->density * sqrt(simplify_dot(n, n)) / POINTS;
    for (int i = 0; i < POINTS; i++) {
        double at[3], m[3], away[3], distance;
        for (int axis = 0; axis < 3; axis++)
            at[axis] = points[i][0] * to[axis] + points[i][1] * b[axis] + points[i][2] * c[axis];
        *near = hewn_bvh_nearest(&samples->bvh, &samples->input, at, *near, &distance);
        sum += weight * distance * distance;
        if (!q)
            continue;
        const double *from = samples->positions + 3 * (size_t)samples->input.corners[3 * (size_t)*near];
        hewn_triangle_normal(&samples->input, *near, m);
        const double square = simplify_dot(m, m), share = points[i][0];
        if (!(square > 0))
            continue;
        simplify_between(at, from, away);
        const double height = simplify_dot(away, m) / square;
        const double x = weight * share * share / square;
        q->a[0] += x * m[0] * m[0];
        q->a[1] += x * m[0] * m[1];
        q->a[2] += x * m[0] * m[2];
        q->a[3] += x * m[1] * m[1];
        q->a[4] += x * m[1] * m[2];
        q->a[5] += x * m[2] * m[2];
        for (int axis = 0; axis < 3; axis++)
            pulled[axis] += weight * share * height * m[axis];
    }
    return sum;
}

static double pull_ring_back(const fitting *job, uint32_t v, const double to[3], simplify_quadric *q, double pulled[3])
{
    const simplify_work *work = job->work;
    const uint32_t first = work->half[v];
    uint32_t h = first, near = work->face_origins[first / 3];
    double sum = 0;
    do {
        const uint32_t in = simplify_prev(h);
        sum += pull_back(job, to, simplify_at(work, simplify_head(work, h)), simplify_at(work, work->tail[in]), &near,
                         q, pulled);
        h = work->twin[in];
    } while (h != HEWN_NONE && h != first);
    return sum;
}

/* What a move or swap must come to: less of the sum of squares, nothing that is far away and was not, none turned. */
static void expect(const fitting *job, double gain, simplify_probe *probe)
{
    probe->enough = probe->plenty = far_share * job->most;
    probe->refuses = probe->sums = true;
    probe->gain = gain;
}

static hewn_result fit_vertex(const fitting *job, uint32_t v, simplify_probe *probe)
{
    simplify_work *work = job->work;
    simplify_quadric q = {0};
    double pulled[3] = {0}, move[3], to[3];
    const uint32_t first = work->half[v];
    uint32_t h = first;
    do {
        pull(job, h, &q, pulled);
        h = simplify_turn(work, h);
    } while (h != HEWN_NONE && h != first);
    const double before = job->density > 0 ? pull_ring_back(job, v, simplify_at(work, v), &q, pulled) : 0;
    const double stay = stay_share * (q.a[0] + q.a[3] + q.a[5]);
    q.a[0] += stay;
    q.a[3] += stay;
    q.a[5] += stay;
    if (!simplify_quadric_solve(&q, pulled, move))
        return HEWN_OK;
    for (int attempt = 0; attempt < 2; attempt++) {
        for (int axis = 0; axis < 3; axis++)
            to[axis] = simplify_at(work, v)[axis] + move[axis] / (attempt + 1);
        if (!hewn_simplify_may_move(work, v, to))
            continue;
        expect(job, job->density > 0 ? 0 : 1, probe);
        HEWN_TRY(hewn_simplify_probe_move(work, v, to, probe));
        const double after = job->density > 0 ? pull_ring_back(job, v, to, NULL, NULL) : 0;
        if (probe->cut || probe->turned || (job->density > 0 && probe->after + after >= probe->before + before))
            continue;
        if (turns_any(job, probe) && turns_more(work, probe, hewn_simplify_count_turned(work, v, HEWN_NONE)))
            continue;
        memcpy(work->positions + 3 * (size_t)v, to, sizeof to);
        hewn_simplify_probe_settle(work, probe);
        break;
    }
    return HEWN_OK;
}

/* The edge runs the other way where that brings samples nearer and takes nothing far away. */
static hewn_result fit_edge(const fitting *job, uint32_t h, simplify_probe *probe)
{
    simplify_work *work = job->work;
    if (!hewn_simplify_may_swap(work, h))
        return HEWN_OK;
    expect(job, swap_gain, probe);
    HEWN_TRY(hewn_simplify_probe_swap(work, h, probe));
    if (probe->cut)
        return HEWN_OK;
    if (turns_any(job, probe) &&
        turns_more(work, probe,
                   (uint32_t)hewn_simplify_is_turned(work, h / 3) + hewn_simplify_is_turned(work, work->twin[h] / 3)))
        return HEWN_OK;
    hewn_simplify_swap(work, h);
    hewn_simplify_probe_settle(work, probe);
    return HEWN_OK;
}

/* Whether all four corners of an edge's triangles lie inside a part. */
static bool is_edge_inside(const fitting *job, uint32_t h)
{
    const simplify_work *work = job->work;
    const uint32_t t = work->twin[h];
    const uint8_t *inside = job->inside;
    return inside[work->tail[h]] && inside[work->tail[t]] && inside[work->tail[simplify_prev(h)]] &&
           inside[work->tail[simplify_prev(t)]];
}

static void find_gaps(fitting *job)
{
    const simplify_samples *samples = job->work->samples;
    double sum = 0;
    job->most = 0;
    for (uint32_t s = 0; s < samples->count; s++) {
        sum += (double)samples->items[s].weight * (double)samples->items[s].gap;
        job->most = fmax(job->most, (double)samples->items[s].gap);
    }
    job->mean = samples->count > 0 ? sum / samples->count : 0;
}

static void find_inside(const fitting *job)
{
    const simplify_work *work = job->work;
#pragma omp parallel for schedule(static) if (work->vertex_count > SIMPLIFY_FEW)
    for (uint32_t v = 0; v < work->vertex_count; v++) {
        const uint32_t first = work->half[v];
        uint32_t h = first;
        job->inside[v] = work->rank[v] != SIMPLIFY_APART;
        while (job->inside[v]) {
            const uint32_t in = simplify_prev(h);
            job->inside[v] = simplify_head(work, h) / PART == v / PART && work->tail[in] / PART == v / PART;
            h = work->twin[in];
            if (h == HEWN_NONE || h == first)
                break;
        }
    }
}

/* Triangles are in the order of their first vertices, so those of a part are together. */
static void split(fitting *job)
{
    const simplify_work *work = job->work;
    uint32_t part = 0;
    for (uint32_t f = 0; f < work->face_count; f++) {
        const uint32_t *corner = work->tail + 3 * (size_t)f;
        uint32_t least = corner[0] < corner[1] ? corner[0] : corner[1];
        least = corner[2] < least ? corner[2] : least;
        while (part <= least / PART)
            job->faces[part++] = f;
    }
    while (part <= job->parts)
        job->faces[part++] = work->face_count;
}

static bool is_edge(const simplify_work *work, uint32_t h)
{
    return work->twin[h] != HEWN_NONE && h < work->twin[h];
}

/* Edges and vertices inside a part, or those inside none. */
static hewn_result fit_edges(const fitting *job, uint32_t begin, uint32_t end, bool inside, simplify_probe *probe)
{
    for (uint32_t h = 3 * begin; h < 3 * end && job->work->face_count <= MOST_SWAPPED; h++)
        if (is_edge(job->work, h) && is_edge_inside(job, h) == inside)
            HEWN_TRY(fit_edge(job, h, probe));
    return HEWN_OK;
}

static hewn_result fit_vertices(const fitting *job, uint32_t begin, uint32_t end, bool inside, simplify_probe *probe)
{
    const simplify_work *work = job->work;
    for (uint32_t v = begin; v < work->vertex_count && v < end; v++)
        if (work->rank[v] == SIMPLIFY_SMOOTH && job->inside[v] == inside)
            HEWN_TRY(fit_vertex(job, v, probe));
    return HEWN_OK;
}

/* Those inside parts first, which touch nothing of other parts; then, one after the other, those between. Edges between
 * parts join them when they are swapped, so they only are where no sweep follows. */
static hewn_result sweep(const fitting *job, bool last)
{
    const uint32_t *faces = job->faces;
    int failed = 0;
#pragma omp parallel reduction(| : failed)
    {
        simplify_probe probe = {0};
#pragma omp for schedule(dynamic)
        for (uint32_t p = 0; p < job->parts; p++) {
            failed |= fit_edges(job, faces[p], faces[p + 1], true, &probe) != HEWN_OK;
            failed |= fit_vertices(job, p * PART, (p + 1) * PART, true, &probe) != HEWN_OK;
        }
        hewn_simplify_probe_release(&probe);
    }
    simplify_probe probe = {0};
    failed |= last && fit_edges(job, 0, job->work->face_count, false, &probe) != HEWN_OK;
    failed |= fit_vertices(job, 0, job->work->vertex_count, false, &probe) != HEWN_OK;
    hewn_simplify_probe_release(&probe);
    return failed ? HEWN_OUT_OF_MEMORY : HEWN_OK;
}

static double find_density(const simplify_work *work)
{
    double area = 0;
    for (uint32_t f = 0; f < work->face_count; f++) {
        const uint32_t *corner = work->tail + 3 * (size_t)f;
        double n[3];
        simplify_area_vector(simplify_at(work, corner[0]), simplify_at(work, corner[1]), simplify_at(work, corner[2]),
                             n);
        area += sqrt(simplify_dot(n, n));
    }
    return area > 0 ? work->samples->count / area : 0;
}

hewn_result hewn_simplify_fit(simplify_work *work, bool back, hewn_error *error)
{
    fitting job = {.work = work, .density = back ? find_density(work) : 0, .inside = hewn_alloc(work->vertex_count, 1)};
    job.parts = (work->vertex_count + PART - 1) / PART;
    job.faces = hewn_alloc((size_t)job.parts + 1, sizeof *job.faces);
    hewn_result result = job.inside && job.faces ? HEWN_OK : HEWN_OUT_OF_MEMORY;
    if (result == HEWN_OK) {
        find_inside(&job);
        split(&job);
    }
    for (int i = 0; i < (back ? 1 : SWEEPS) && result == HEWN_OK; i++) {
        find_gaps(&job);
        if (job.mean > 0)
            result = sweep(&job, back || i + 1 == SWEEPS);
    }
    hewn_free(job.inside);
    hewn_free(job.faces);
    return result == HEWN_OK ? HEWN_OK : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
}
