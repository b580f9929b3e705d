#include "simplify/promise.h"

#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/progress.h"
#include "geom/hausdorff.h"
#include "hewn/check.h"
#include "simplify/recall.h"

/* The largest error by quadrics, a mean distance, is at first this share of what is allowed. Where a run came out too
 * far away, it becomes half of what it was; below the least share vertices stay as they are. Each run takes other ways
 * everywhere, so after some runs what nearly offends counts, too: a distance of this share of what is allowed. */
static const double first = 0.5, least = 0.01, nearly = 0.95;
enum { SOME_RUNS = 2 };

/* Rows of points within the result's triangles that are looked at before anything is proven. */
enum { INNER = 7 };

/* Intersections that are listed in one go. */
enum { MOST_PAIRS = 1 << 16 };

typedef struct simplify_promise {
    simplify_input *in;
    simplify_result *out;
    hewn_simplify_report *report;
    double allowed;
    hewn_bvh bvh;       /* of the input */
    uint8_t *far[2];    /* triangles of the input and of the result */
    uint8_t *offending; /* the input's vertices that stand for vertices of the result which must not be */

    uint32_t (*pairs)[2];

    /* What earlier runs have shown. `known`: triangles of the input and of the result that are near enough; of the
     * input's, by the result that `proven` remembers. */
    simplify_recall seen, proven;
    double seen_near; /* as `seen` was looked at */
    uint8_t *known[2];
    uint32_t *rest; /* corners of others */
} simplify_promise;

/* --- measuring ---------------------------------------------------------------------------------------------------- */

static hewn_triangle_view view_of(const hewn_polygons *triangles)
{
    return (hewn_triangle_view){.vertex_count = triangles->vertex_count,
                                .triangle_count = triangles->face_count,
                                .doubles = triangles->positions,
                                .corners = triangles->corners};
}

static hewn_polygons polygons_of(const simplify_result *result)
{
    return (hewn_polygons){.vertex_count = result->mesh.vertex_count,
                           .positions = result->mesh.positions,
                           .face_count = result->mesh.face_count,
                           .corners = result->mesh.corners};
}

static double diagonal(const hewn_bvh *bvh)
{
    float lo[3], hi[3];
    double square = 0;
    hewn_boxes4_all(&bvh->level[bvh->level_count - 1][0], lo, hi);
    for (int axis = 0; axis < 3; axis++) {
        double side = (double)hi[axis] - (double)lo[axis];
        square += side * side;
    }
    return sqrt(square);
}

/* The triangles of a surface that are not known to be near enough, put into `rest`. */
static hewn_triangle_view rest_of(simplify_promise *job, const hewn_triangle_view *view, const uint8_t *known)
{
    hewn_triangle_view rest = *view;
    rest.triangle_count = 0;
    rest.corners = job->rest;
    for (uint64_t t = 0; t < view->triangle_count; t++)
        if (!known[t])
            memcpy(job->rest + 3 * rest.triangle_count++, view->corners + 3 * t, 3 * sizeof *job->rest);
    return rest;
}

/* Marks of the rest become marks of all. */
static void spread(const uint8_t *known, uint64_t count, uint64_t rest, uint8_t *far)
{
    for (uint64_t t = count; t-- > 0;)
        far[t] = known[t] ? 0 : far[--rest];
}

/* One way, `side` as in `far`: whether all is within what is allowed. */
static hewn_result prove(simplify_promise *job, int side, const hewn_triangle_view *from, const hewn_triangle_view *to,
                         const hewn_bvh *bvh, hewn_reach_desc *desc, hewn_reach *out, hewn_error *error)
{
    uint8_t *known = job->known[side], *far = job->far[side];
    if (side == 0)
        HEWN_TRY(hewn_simplify_recall_near(&job->proven, to, from, job->allowed, known, error));
    else
        hewn_simplify_recall(&job->proven, from, known);
    const hewn_triangle_view rest = rest_of(job, from, known);
    desc->far = far;
    HEWN_TRY(hewn_surface_reach(&rest, to, bvh, desc, out, error));
    spread(known, from->triangle_count, rest.triangle_count, far);
    if (side == 1)
        return hewn_simplify_remember(&job->proven, from, far, error);
    for (uint64_t t = 0; t < from->triangle_count; t++)
        known[t] = !far[t];
    return HEWN_OK;
}

/* Both ways. `marks`: only whether it is within what is allowed, and where not; else to a hundredth. */
static hewn_result measure(simplify_promise *job, bool marks, hewn_error *error)
{
    const hewn_polygons result = polygons_of(job->out);
    const hewn_triangle_view before = view_of(&job->in->triangles), after = view_of(&result);
    hewn_reach_desc desc = {.tolerance = 0.01, .floor = 1e-6 * diagonal(&job->bvh), .limit = job->allowed};
    hewn_reach there, back;
    hewn_bvh bvh;
    if (marks)
        desc.floor = job->allowed;
    HEWN_TRY(hewn_progress_report(job->in->desc.progress, "measure", 0, error));
    HEWN_TRY(hewn_bvh_build(&after, &bvh, error));
    hewn_result done = marks ? prove(job, 0, &before, &after, &bvh, &desc, &there, error)
                             : hewn_surface_reach(&before, &after, &bvh, &desc, &there, error);
    hewn_bvh_free(&bvh);
    HEWN_TRY(done);
    HEWN_TRY(hewn_progress_report(job->in->desc.progress, "measure", 0.5, error));
    HEWN_TRY(marks ? prove(job, 1, &after, &before, &job->bvh, &desc, &back, error)
                   : hewn_surface_reach(&after, &before, &job->bvh, &desc, &back, error));
    job->report->measured = true;
    job->report->distance = fmax(there.high, back.high);
    job->report->distance_low = fmax(there.low, back.low);
    return hewn_progress_report(job->in->desc.progress, "measure", 1, error);
}

/* Soon tells whether triangles of the two surfaces are certainly too far away, `*count` of them, and marks these with
 * those that nearly are. */
static hewn_result glance(simplify_promise *job, uint64_t *count, hewn_error *error)
{
    const hewn_polygons result = polygons_of(job->out);
    const hewn_triangle_view before = view_of(&job->in->triangles), after = view_of(&result);
    const double near = job->report->runs > SOME_RUNS ? nearly : 1;
    uint64_t there, back;
    hewn_bvh bvh;
    HEWN_TRY(hewn_bvh_build(&after, &bvh, error));
    hewn_result done = hewn_surface_glance(&before, &after, &bvh, 0, job->allowed, near, job->far[0], &there, error);
    hewn_bvh_free(&bvh);
    HEWN_TRY(done);
    if (near < job->seen_near)
        hewn_simplify_forget(&job->seen);
    job->seen_near = near;
    hewn_simplify_recall(&job->seen, &after, job->known[1]);
    const hewn_triangle_view rest = rest_of(job, &after, job->known[1]);
    HEWN_TRY(hewn_surface_glance(&rest, &before, &job->bvh, INNER, job->allowed, near, job->far[1], &back, error));
    spread(job->known[1], after.triangle_count, rest.triangle_count, job->far[1]);
    *count = there + back;
    return hewn_simplify_remember(&job->seen, &after, job->far[1], error);
}

/* --- what offends ------------------------------------------------------------------------------------------------- */

static uint32_t root_of(uint32_t *into, uint32_t v)
{
    while (into[v] != v)
        v = into[v] = into[into[v]];
    return v;
}

/* Triangles that are too far from the other surface, by the vertices that became their corners. */
static void mark_far(simplify_promise *job)
{
    const hewn_polygons *before = &job->in->triangles;
    const hewn_simplified *after = &job->out->mesh;

    for (uint64_t t = 0; t < before->face_count; t++)
        for (uint64_t k = 0; k < 3 && job->far[0][t]; k++)
            job->offending[root_of(job->out->into, before->corners[3 * t + k])] = 1;
    for (uint64_t t = 0; t < after->face_count; t++)
        for (uint64_t k = 0; k < 3 && job->far[1][t]; k++)
            job->offending[after->vertex_origins[after->corners[3 * t + k]]] = 1;
}

/* Corners of triangles that run through each other, and with them what joined them. Where these are as they were
 * already, that changes nothing any more: it is the input's own affair. */
static hewn_result mark_crossings(simplify_promise *job, hewn_error *error)
{
    const hewn_simplified *after = &job->out->mesh;
    uint64_t count;
    HEWN_TRY(hewn_count_self_intersections(after->positions, after->vertex_count, after->corners, after->face_count,
                                           MOST_PAIRS, job->pairs, job->in->desc.progress, &count, error));
    for (uint64_t p = 0; p < count && p < MOST_PAIRS; p++)
        for (int side = 0; side < 2; side++)
            for (uint64_t k = 0; k < 3; k++)
                job->offending[after->vertex_origins[after->corners[3 * (uint64_t)job->pairs[p][side] + k]]] = 1;
    return HEWN_OK;
}

/* What became offending vertices must come out better in the next run: with smaller errors, or as it is. Returns how
 * many vertices that changes something for. */
static uint64_t tighten(simplify_promise *job, bool crossings)
{
    simplify_input *in = job->in;
    uint64_t count = 0;
    for (uint64_t v = 0; v < in->triangles.vertex_count; v++) {
        if (!job->offending[root_of(job->out->into, (uint32_t)v)])
            continue;
        if (crossings) {
            count += !in->frozen[v];
            in->frozen[v] = 1;
        } else if (in->limits[v] > 0) {
            const double now = (double)in->limits[v] / 2;
            in->limits[v] = now < least * job->allowed ? 0 : (float)now;
            count++;
        }
    }
    memset(job->offending, 0, in->triangles.vertex_count);
    return count;
}

/* --- the loop ----------------------------------------------------------------------------------------------------- */

static hewn_result prepare(simplify_promise *job, hewn_error *error)
{
    simplify_input *in = job->in;
    const hewn_triangle_view view = view_of(&in->triangles);
    const hewn_simplify_desc *desc = &in->desc;
    const bool bounded = desc->error > 0 || desc->relative_error > 0;
    if (bounded || desc->measure)
        HEWN_TRY(hewn_bvh_build(&view, &job->bvh, error));
    if (!bounded && !desc->no_self_intersections)
        return HEWN_OK;
    in->frozen = hewn_alloc_zero(view.vertex_count, 1);
    in->limits = bounded ? hewn_alloc(view.vertex_count, sizeof *in->limits) : NULL;
    job->offending = hewn_alloc_zero(view.vertex_count, 1);
    job->far[0] = bounded ? hewn_alloc(view.triangle_count, 1) : NULL;
    job->far[1] = bounded ? hewn_alloc(view.triangle_count, 1) : NULL;
    job->known[0] = bounded ? hewn_alloc_zero(view.triangle_count, 1) : NULL;
    job->known[1] = bounded ? hewn_alloc_zero(view.triangle_count, 1) : NULL;
    job->rest = bounded ? hewn_alloc(view.triangle_count, 3 * sizeof *job->rest) : NULL;
    job->pairs = desc->no_self_intersections ? hewn_alloc(MOST_PAIRS, sizeof *job->pairs) : NULL;
    if (!in->frozen || !job->offending ||
        (bounded && (!in->limits || !job->far[0] || !job->far[1] || !job->known[0] || !job->known[1] || !job->rest)) ||
        (desc->no_self_intersections && !job->pairs))
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
    if (bounded) {
        const double relative = desc->relative_error * diagonal(&job->bvh);
        job->allowed = desc->error > 0 && (relative <= 0 || desc->error < relative) ? desc->error : relative;
        job->report->error_allowed = job->allowed;
        for (uint64_t v = 0; v < view.vertex_count; v++)
            in->limits[v] = (float)(first * job->allowed);
    }
    return HEWN_OK;
}

/* One run and its proof; `*again`: it did not hold. */
static hewn_result attempt(simplify_promise *job, bool *again, hewn_error *error)
{
    *again = false;
    HEWN_TRY(hewn_simplify_once(job->in, job->out, job->report, error));
    job->report->runs++;
    if (!job->offending || !job->in->frozen)
        return HEWN_OK;
    if (job->far[0] && job->far[1] && job->in->limits) {
        uint64_t count;
        HEWN_TRY(glance(job, &count, error));
        if (count == 0)
            HEWN_TRY(measure(job, true, error));
        mark_far(job);
        *again = tighten(job, false) > 0;
        if (count > 0 && !*again) /* nothing could change: what there is must be told */
            HEWN_TRY(measure(job, true, error));
    }
    if (job->pairs && !*again) {
        HEWN_TRY(mark_crossings(job, error));
        *again = tighten(job, true) > 0;
    }
    return HEWN_OK;
}

static hewn_result run(simplify_promise *job, hewn_error *error)
{
    bool again = true;
    HEWN_TRY(prepare(job, error));
    while (again) {
        hewn_simplify_result_release(job->out);
        HEWN_TRY(attempt(job, &again, error));
    }
    const double proven = job->report->distance;
    if (job->in->desc.measure)
        HEWN_TRY(measure(job, false, error));
    if (job->allowed > 0) /* both are bounds */
        job->report->distance = fmin(job->report->distance, proven);
    if (job->allowed > 0 && job->report->distance > job->allowed)
        return hewn_fail(error, HEWN_LIMIT, "an error of %g is too small for the rounding of these coordinates",
                         job->allowed);
    return HEWN_OK;
}

hewn_result hewn_simplify_promised(simplify_input *in, simplify_result *out, hewn_simplify_report *report,
                                   hewn_error *error)
{
    simplify_promise job = {.in = in, .out = out, .report = report};
    hewn_result result = in->triangles.face_count > 0
                             ? run(&job, error)
                             : hewn_fail(error, HEWN_BAD_INPUT, "there are no faces to simplify");
    hewn_bvh_free(&job.bvh);
    hewn_free(job.far[0]);
    hewn_free(job.far[1]);
    hewn_free(job.known[0]);
    hewn_free(job.known[1]);
    hewn_free(job.rest);
    hewn_simplify_forget(&job.seen);
    hewn_simplify_forget(&job.proven);
    hewn_free(job.offending);
    hewn_free(job.pairs);
    if (result != HEWN_OK)
        hewn_simplify_result_release(out);
    return result;
}
