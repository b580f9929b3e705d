#include "simplify/samples.h"

#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "geom/nearest.h"

/* For each triangle of the target. */
enum { SAMPLES = 16 };

/* Steps to a nearer triangle. */
enum { MOST_STEPS = 8 };

void hewn_simplify_samples_release(simplify_samples *samples)
{
    hewn_free(samples->items);
    hewn_free(samples->first);
    hewn_free(samples->positions);
    hewn_free(samples->rings);
    hewn_free(samples->faces);
    hewn_bvh_free(&samples->bvh);
    hewn_facing_free(&samples->facing);
    *samples = (simplify_samples){0};
}

/* --- where they are ----------------------------------------------------------------------------------------------- */

typedef struct sampling {
    const simplify_work *work;
    const hewn_polygons *input;
    simplify_samples *out;
    uint32_t step;
    uint32_t *place; /* of each vertex of the input that is left: its number now */
    uint32_t *face;  /* of each sample in the order of the input; HEWN_NONE where there is none */
    float *gap;
    uint32_t *order; /* of each sample in the order of the input: where it goes */
} sampling;

static uint32_t root_of(const sampling *job, uint32_t v)
{
    const uint32_t *into = job->work->into;
    while (into[v] != v)
        v = into[v];
    return job->place[v];
}

static void find_point(const sampling *job, uint32_t v, double out[3])
{
    for (size_t axis = 0; axis < 3; axis++)
        out[axis] = job->out->positions[3 * (size_t)v + axis];
}

/* The nearest of the triangles around what a vertex has become. */
static uint32_t nearest_around(const simplify_work *work, uint32_t v, const double at[3], float *gap)
{
    const uint32_t first = work->half[v];
    uint32_t h = first, best = first / 3;
    double least = INFINITY;
    do {
        const uint32_t in = simplify_prev(h);
        const double found = hewn_triangle_reach(at, simplify_at(work, v), simplify_at(work, simplify_head(work, h)),
                                                 simplify_at(work, work->tail[in]));
        best = found < least ? h / 3 : best;
        least = found < least ? found : least;
        h = work->twin[in];
    } while (h != HEWN_NONE && h != first);
    *gap = (float)least;
    return best;
}

/* From there on to triangles across sides while these are nearer. */
static uint32_t nearest_from(const simplify_work *work, uint32_t v, const double at[3], float *gap)
{
    uint32_t best = nearest_around(work, v, at, gap), last = HEWN_NONE;
    for (int step = 0; step<MOST_STEPS && * gap> 0; step++) {
        const uint32_t now = best;
        for (uint32_t h = 3 * now; h < 3 * now + 3; h++) {
            const uint32_t twin = work->twin[h], next = twin / 3;
            if (twin == HEWN_NONE || next == last || (step == 0 && (work->tail[h] == v || simplify_head(work, h) == v)))
                continue;
            const uint32_t *corner = work->tail + 3 * (size_t)next;
            const float found = (float)hewn_triangle_reach(at, simplify_at(work, corner[0]),
                                                           simplify_at(work, corner[1]), simplify_at(work, corner[2]));
            best = found < *gap ? next : best;
            *gap = found < *gap ? found : *gap;
        }
        last = now;
        if (best == now)
            break;
    }
    return best;
}

static void find_faces(const sampling *job)
{
    const simplify_work *work = job->work;
#pragma omp parallel for schedule(dynamic, 1024) if (work->input_count > SIMPLIFY_FEW)
    for (uint32_t v = 0; v < work->input_count; v += job->step) {
        const uint32_t root = root_of(job, v), s = v / job->step;
        double at[3];
        job->face[s] = HEWN_NONE;
        if (root == HEWN_NONE || work->rank[root] == SIMPLIFY_APART)
            continue;
        find_point(job, v, at);
        job->face[s] = nearest_from(work, root, at, &job->gap[s]);
    }
}

/* In the order of their triangles; those that have none are left out. */
static hewn_result order_samples(const sampling *job, uint32_t count, hewn_error *error)
{
    simplify_samples *out = job->out;
    const uint32_t faces = job->work->face_count;
    out->first = hewn_alloc_zero((size_t)faces + 1, sizeof *out->first);
    if (!out->first)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
    for (uint32_t s = 0; s < count; s++)
        if (job->face[s] != HEWN_NONE)
            out->first[job->face[s] + 1]++;
    for (uint32_t f = 0; f < faces; f++)
        out->first[f + 1] += out->first[f];
    out->count = out->first[faces];
    out->items = hewn_alloc_zero(out->count, sizeof *out->items);
    if (!out->items)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
    for (uint32_t s = 0; s < count; s++)
        job->order[s] = job->face[s] != HEWN_NONE ? out->first[job->face[s]]++ : HEWN_NONE;
    for (uint32_t f = faces; f-- > 0;) { /* ends have become those of the lists: back to their beginnings */
        const uint32_t begin = f > 0 ? out->first[f - 1] : 0, end = out->first[f];
        for (uint32_t s = begin; s < end; s++)
            out->items[s].next = s + 1 < end ? s + 1 : HEWN_NONE;
        out->first[f] = begin < end ? begin : HEWN_NONE;
    }
    return HEWN_OK;
}

/* --- what they are ------------------------------------------------------------------------------------------------ */

static void fill(const sampling *job)
{
#pragma omp parallel for schedule(static) if (job->work->input_count > SIMPLIFY_FEW)
    for (uint32_t v = 0; v < job->work->input_count; v += job->step) {
        const uint32_t s = v / job->step;
        if (job->order[s] == HEWN_NONE)
            continue;
        simplify_sample *sample = &job->out->items[job->order[s]];
        find_point(job, v, sample->at);
        sample->gap = job->gap[s];
    }
}

/* The sample at a corner of the input; HEWN_NONE where there is none. */
static uint32_t sample_of(const sampling *job, uint32_t v)
{
    return v % job->step == 0 ? job->order[v / job->step] : HEWN_NONE;
}

static hewn_result find_rings(const sampling *job, hewn_error *error)
{
    simplify_samples *out = job->out;
    const uint64_t corners = 3 * job->input->face_count;
    out->rings = hewn_alloc_zero((size_t)out->count + 2, sizeof *out->rings);
    if (!out->rings)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
    for (uint64_t c = 0; c < corners; c++) {
        const uint32_t s = sample_of(job, job->input->corners[c]);
        if (s != HEWN_NONE)
            out->rings[s + 2]++;
    }
    for (uint32_t s = 0; s < out->count; s++)
        out->rings[s + 2] += out->rings[s + 1];
    out->faces = hewn_alloc(out->rings[out->count + 1], sizeof *out->faces);
    if (!out->faces)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
    for (uint64_t c = 0; c < corners; c++) { /* ends of the lists before become those of the lists */
        const uint32_t s = sample_of(job, job->input->corners[c]);
        if (s != HEWN_NONE)
            out->faces[out->rings[s + 1]++] = (uint32_t)(c / 3);
    }
    return HEWN_OK;
}

/* Area vectors of the triangles around, and their areas. */
static void find_normals(const sampling *job)
{
    simplify_samples *out = job->out;
#pragma omp parallel for schedule(static) if (out->count > SIMPLIFY_FEW)
    for (uint32_t s = 0; s < out->count; s++) {
        double sum[3] = {0}, area = 0;
        for (uint32_t i = out->rings[s]; i < out->rings[s + 1]; i++) {
            const uint32_t *corner = out->input.corners + 3 * (size_t)out->faces[i];
            double n[3];
            simplify_area_vector(out->positions + 3 * (size_t)corner[0], out->positions + 3 * (size_t)corner[1],
                                 out->positions + 3 * (size_t)corner[2], n);
            for (int axis = 0; axis < 3; axis++)
                sum[axis] += n[axis];
            area += sqrt(simplify_dot(n, n));
        }
        out->items[s].weight = (float)area;
        for (int axis = 0; axis < 3; axis++)
            out->items[s].normal[axis] = (float)sum[axis];
    }
}

static void even_weights(simplify_samples *samples)
{
    double sum = 0;
    for (uint32_t s = 0; s < samples->count; s++)
        sum += (double)samples->items[s].weight;
    const double mean = sum / samples->count;
    for (uint32_t s = 0; s < samples->count; s++)
        samples->items[s].weight = sum > 0 ? (float)((double)samples->items[s].weight / mean) : 1;
}

static hewn_result make(sampling *job, hewn_error *error)
{
    const simplify_work *work = job->work;
    const uint32_t count = (work->input_count + job->step - 1) / job->step;
    job->place = hewn_alloc(work->input_count, sizeof *job->place);
    job->face = hewn_alloc(count, sizeof *job->face);
    job->gap = hewn_alloc(count, sizeof *job->gap);
    job->order = hewn_alloc(count, sizeof *job->order);
    if (!job->place || !job->face || !job->gap || !job->order)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
    memset(job->place, 0xFF, work->input_count * sizeof *job->place);
    for (uint32_t v = 0; v < work->vertex_count; v++)
        job->place[work->origins[v]] = v;
    job->out->positions = hewn_alloc(work->input_count, 3 * sizeof *job->out->positions);
    if (!job->out->positions)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
#pragma omp parallel for schedule(static) if (work->input_count > SIMPLIFY_FEW)
    for (uint32_t v = 0; v < work->input_count; v++)
        for (size_t axis = 0; axis < 3; axis++)
            job->out->positions[3 * (size_t)v + axis] =
                simplify_inward(work, job->input->positions[3 * (size_t)v + axis], axis);
    job->out->input = (hewn_triangle_view){.vertex_count = job->input->vertex_count,
                                           .triangle_count = job->input->face_count,
                                           .doubles = job->out->positions,
                                           .corners = job->input->corners};
    uint32_t *along = hewn_simplify_along(&job->out->input);
    if (!along)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
    HEWN_TRY(hewn_bvh_build_along(&job->out->input, along, &job->out->bvh, error));
    HEWN_TRY(hewn_facing_build(&job->out->bvh, &job->out->input, &job->out->facing, error));
    find_faces(job);
    HEWN_TRY(order_samples(job, count, error));
    fill(job);
    HEWN_TRY(find_rings(job, error));
    find_normals(job);
    even_weights(job->out);
    return HEWN_OK;
}

hewn_result hewn_simplify_samples_make(const simplify_work *work, const hewn_polygons *input, uint32_t target,
                                       simplify_samples *out, hewn_error *error)
{
    const uint64_t most = SAMPLES * (uint64_t)target;
    sampling job = {.work = work, .input = input, .out = out};
    *out = (simplify_samples){0};
    job.step = (uint32_t)((work->input_count + most - 1) / most);
    job.step = job.step > 0 ? job.step : 1;
    hewn_result result = make(&job, error);
    hewn_free(job.place);
    hewn_free(job.face);
    hewn_free(job.gap);
    hewn_free(job.order);
    return result;
}

/* --- copies ------------------------------------------------------------------------------------------------------- */

hewn_result hewn_simplify_samples_copy(const simplify_work *work, simplify_samples *out, hewn_error *error)
{
    const simplify_samples *samples = work->samples;
    *out = *samples;
    out->items = hewn_alloc(samples->count, sizeof *out->items);
    out->first = hewn_alloc(work->face_count, sizeof *out->first);
    if (!out->items || !out->first)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
    memcpy(out->items, samples->items, samples->count * sizeof *out->items);
    memcpy(out->first, samples->first, work->face_count * sizeof *out->first);
    return HEWN_OK;
}

void hewn_simplify_samples_drop(simplify_samples *copy)
{
    hewn_free(copy->items);
    hewn_free(copy->first);
    *copy = (simplify_samples){0};
}
