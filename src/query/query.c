#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/clock.h"
#include "base/error.h"
#include "base/progress.h"
#include "query/internal.h"
#include "render/tracer.h"

/* Coordinates have 24 bits; what is a few of their last ones apart is not told apart. */
#define FINE 1e-6
/* How much room around a box slopes are bounded in, in diagonals. */
#define ROOM 64.0

enum { LEAST = 64, BLOCK = 4096 };

static hewn_result check_box(const hewn_box *box, hewn_error *error)
{
    for (int i = 0; i < 3; i++)
        if (!(box->lo[i] < box->hi[i]) || !isfinite(box->lo[i]) || !isfinite(box->hi[i]))
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the box has no inside along %c (%g to %g)", "xyz"[i],
                             box -> lo[i], box -> hi[i]);
    return HEWN_OK;
}

/* Boxes contain what they are in single precision: slopes are bounded wherever a rounded point may be. */
static void measure(hewn_query *query)
{
    double square = 0, far = 0;
    for (int axis = 0; axis < 3; axis++) {
        query->box.lo[axis] = fmin(query->box.lo[axis], (double)(float)query->box.lo[axis]);
        query->box.hi[axis] = fmax(query->box.hi[axis], (double)(float)query->box.hi[axis]);
    }
    for (int axis = 0; axis < 3; axis++) {
        double side = query->box.hi[axis] - query->box.lo[axis];
        square += side * side;
        far = fmax(far, fmax(fabs(query->box.lo[axis]), fabs(query->box.hi[axis])));
    }
    query->diagonal = sqrt(square);
    query->fine = (float)(FINE * fmax(query->diagonal, far));
    for (int axis = 0; axis < 3; axis++) {
        query->wide.lo[axis] = (double)(float)(query->box.lo[axis] - ROOM * query->diagonal);
        query->wide.hi[axis] = (double)(float)(query->box.hi[axis] + ROOM * query->diagonal);
    }
}

static hewn_result prepare(hewn_query *query, hewn_device *device, const hewn_field *field, hewn_node root,
                           hewn_error *error)
{
    measure(query);
    HEWN_TRY(hewn_steepness_bound(field, root, &query->box, &query->steepness, error));
    HEWN_TRY(hewn_steepness_bound(field, root, &query->wide, &query->wide_steepness, error));
    HEWN_TRY(hewn_octree_create(field, root, &query->box, true, &query->octree, error));
    return device ? hewn_query_open_device(query, device, field, root, error) : HEWN_OK;
}

hewn_result hewn_query_create(hewn_device *device, const hewn_field *field, hewn_node root, const hewn_box *box,
                              hewn_query **out, hewn_error *error)
{
    *out = NULL;
    HEWN_TRY(check_box(box, error));
    hewn_query *query = hewn_alloc_zero(1, sizeof *query);
    if (!query)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for questions");
    query->box = *box;
    *out = query;
    hewn_result result = prepare(query, device, field, root, error);
    if (result != HEWN_OK)
        hewn_query_destroy(out);
    return result;
}

void hewn_query_destroy(hewn_query **query)
{
    if (*query) {
        hewn_query_close_device(*query);
        hewn_octree_destroy(&(*query)->octree);
    }
    hewn_free(*query);
    *query = NULL;
}

bool hewn_query_is_on_host(const hewn_query *query)
{
    return query->on.device == NULL;
}

double hewn_query_slope(const hewn_query *query, const hewn_box *box)
{
    bool in = true, near = true;
    for (int axis = 0; axis < 3; axis++) {
        in = in && box->lo[axis] >= query->box.lo[axis] && box->hi[axis] <= query->box.hi[axis];
        near = near && box->lo[axis] >= query->wide.lo[axis] && box->hi[axis] <= query->wide.hi[axis];
    }
    double slope = in ? query->steepness : near ? query->wide_steepness : INFINITY;
    return slope > 0 ? slope : INFINITY;
}

/* --- asking ---------------------------------------------------------------------------------------------------------
 */

hewn_result hewn_query_find_limits(const hewn_query_desc *desc, double otherwise, float fine, double most,
                                   hewn_query_limits *out, hewn_error *error)
{
    enum { MOST_BOXES = 65536 };
    double given = desc ? desc->tolerance : 0;
    if (!(given >= 0) || !isfinite(given))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a tolerance of %g makes no sense", given);
    out->tolerance = (float)fmin(fmax(given > 0 ? given : otherwise, 4 * (double)fine), most);
    out->most_boxes = desc && desc->most_boxes ? desc->most_boxes : MOST_BOXES;
    return HEWN_OK;
}

/* Questions are made and answered in blocks, so that any number needs little memory. */
typedef hewn_result make_question(const void *items, size_t index, hewn_question *out, hewn_error *error);

static hewn_result answer(hewn_query *query, const hewn_question *questions, size_t count,
                          const hewn_query_limits *limits, const hewn_query_part *part, hewn_answer *answers,
                          hewn_error *error)
{
    if (!query->on.device)
        return hewn_query_ask_host(query, questions, NULL, count, limits, answers, error);
    HEWN_TRY(hewn_query_ask_device(query, questions, count, limits, answers, error));
    return hewn_query_finish(query, questions, count, limits, part, answers, error);
}

static hewn_result ask(hewn_query *query, make_question *make, const void *items, size_t count,
                       const hewn_query_desc *desc, hewn_answer *answers, hewn_error *error)
{
    hewn_query_limits limits;
    const hewn_progress *progress = desc ? desc->progress : NULL;
    HEWN_TRY(hewn_query_find_limits(desc, 1e-4 * query->diagonal, query->fine, query->diagonal, &limits, error));
    size_t block = query->on.device ? 16 * BLOCK : BLOCK;
    hewn_question *questions = hewn_alloc(count < block ? count : block, sizeof *questions);
    if (!questions)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for questions");
    hewn_result result = HEWN_OK;
    for (size_t first = 0, size = LEAST, taken; first < count && result == HEWN_OK; first += taken) {
        double began = hewn_clock_now();
        taken = count - first < size ? count - first : size;
        const hewn_query_part part = {progress, (double)first / (double)count, (double)taken / (double)count};
        result = hewn_progress_report(progress, "query", part.begin, error);
        for (size_t i = 0; i < taken && result == HEWN_OK; i++)
            result = make(items, first + i, &questions[i], error);
        if (result == HEWN_OK)
            result = answer(query, questions, taken, &limits, &part, answers + first, error);
        size = hewn_query_next_block(size, LEAST, block, hewn_clock_now() - began);
    }
    hewn_free(questions);
    if (result != HEWN_OK)
        memset(answers, 0, count * sizeof *answers);
    return result;
}

static bool is_place(const double p[3])
{
    return fabs(p[0]) <= HEWN_QUERY_FAR && fabs(p[1]) <= HEWN_QUERY_FAR && fabs(p[2]) <= HEWN_QUERY_FAR;
}

static hewn_result make_nearest(const void *items, size_t index, hewn_question *out, hewn_error *error)
{
    const double *p = (const double *)items + 3 * index;
    if (!is_place(p))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "point %zu is not a place: %g, %g, %g", index, p[0], p[1], p[2]);
    *out = (hewn_question){.kind = HEWN_QUERY_NEAREST, .along = {1, 1, 1}, .end = INFINITY};
    for (int axis = 0; axis < 3; axis++)
        out->from[axis] = (float)p[axis];
    return HEWN_OK;
}

static hewn_result check_ray(const hewn_ray_desc *ray, size_t index, double largest, hewn_error *error)
{
    if (!is_place(ray->from))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "ray %zu does not begin at a place: %g, %g, %g", index,
                         ray->from[0], ray->from[1], ray->from[2]);
    if (!(largest > 0) || !isfinite(largest))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "ray %zu has no direction: %g, %g, %g", index, ray->along[0],
                         ray->along[1], ray->along[2]);
    if (!(ray->radius >= 0) || !(ray->radius <= HEWN_QUERY_FAR))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the radius of ray %zu makes no sense: %g", index, ray->radius);
    if (!(ray->begin >= 0) || !(ray->begin <= HEWN_QUERY_FAR) || !isfinite(ray->end) ||
        (ray->end != 0 && !(ray->end >= ray->begin)))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "ray %zu makes no sense from %g to %g", index, ray->begin,
                         ray->end);
    return HEWN_OK;
}

/* The largest component; NaN where one is. */
static double largest_of(const double v[3])
{
    double largest = 0;
    for (int axis = 0; axis < 3; axis++)
        largest = fabs(v[axis]) > largest || isnan(v[axis]) ? fabs(v[axis]) : largest;
    return largest;
}

static hewn_result make_ray(const void *items, size_t index, hewn_question *out, hewn_error *error)
{
    const hewn_ray_desc *ray = (const hewn_ray_desc *)items + index;
    double v[3], length = 0, largest = largest_of(ray->along);
    HEWN_TRY(check_ray(ray, index, largest, error));
    for (int axis = 0; axis < 3; axis++) {
        v[axis] = ray->along[axis] / largest; /* its squares neither overflow nor vanish */
        length += v[axis] * v[axis];
    }
    length = sqrt(length);
    *out = (hewn_question){.kind = ray->radius > 0 ? HEWN_QUERY_BALL : HEWN_QUERY_RAY,
                           .begin = (float)ray->begin,
                           .end = ray->end > 0 ? (float)ray->end : INFINITY,
                           .radius = (float)ray->radius};
    for (int axis = 0; axis < 3; axis++) {
        double part = v[axis] / length;
        out->from[axis] = (float)ray->from[axis];
        out->along[axis] = fabs(part) < 1e-12 ? 1e-12F : (float)part;
    }
    return HEWN_OK;
}

hewn_result hewn_query_nearest(hewn_query *query, const double *points, size_t count, const hewn_query_desc *desc,
                               hewn_answer *answers, hewn_error *error)
{
    return ask(query, make_nearest, points, count, desc, answers, error);
}

hewn_result hewn_query_rays(hewn_query *query, const hewn_ray_desc *rays, size_t count, const hewn_query_desc *desc,
                            hewn_answer *answers, hewn_error *error)
{
    return ask(query, make_ray, rays, count, desc, answers, error);
}
