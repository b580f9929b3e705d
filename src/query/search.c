/* The answer to one question: the most promising box first, until the best place that was found is as good as any box
 * can hold (branch and bound, Land and Doig 1960, with interval bounds). */
#include <math.h>
#include <string.h>

#include "base/error.h"
#include "query/heap.h"
#include "query/internal.h"

/* A question under way. */
typedef struct search {
    hewn_asker *asker;
    const hewn_question *question;
    hewn_heap heap; /* of boxes */
    float high, point[3], normal[3];
    float unseen; /* the least of boxes too small to divide */
} search;

/* --- places on the surface ------------------------------------------------------------------------------------------
 */

static void take(search *s, float length, const float p[3], const float normal[3])
{
    if (!(length < s->high))
        return;
    s->high = length;
    memcpy(s->point, p, sizeof s->point);
    memcpy(s->normal, normal, sizeof s->normal);
}

static void on_ray(const hewn_question *q, float t, float out[3])
{
    for (int axis = 0; axis < 3; axis++)
        out[axis] = q->from[axis] + t * q->along[axis];
}

/* Where the ray enters the solid within a box. */
static void try_ray(search *s, const hewn_search_box *box)
{
    float leave, enter = hewn_ray_enters(s->question, box->lo, box->hi, 0, &leave), a[3], b[3], outside, inside;
    if (!(enter < s->high))
        return;
    on_ray(s->question, enter, a);
    on_ray(s->question, leave, b);
    if (!hewn_ask_entry(s->asker, a, b, &outside, &inside))
        return;
    float t = enter + inside * (leave - enter), p[3], normal[3];
    on_ray(s->question, t, p);
    hewn_ask_gradient(s->asker, p, normal);
    take(s, t, p, normal);
}

/* From the middle of a box to the surface, and along that to where it is best. */
static void try_surface(search *s, const hewn_search_box *box)
{
    const hewn_question *q = s->question;
    float p[3], normal[3], size = hewn_apart(box->lo, box->hi);
    for (int axis = 0; axis < 3; axis++)
        p[axis] = 0.5F * (box->lo[axis] + box->hi[axis]);
    if (!hewn_ask_project(s->asker, p, size, normal))
        return;
    if (q->kind == HEWN_QUERY_NEAREST) {
        if (hewn_apart(q->from, p) < s->high) {
            hewn_ask_approach(s->asker, q->from, p, normal);
            take(s, hewn_apart(q->from, p) + 0.5F * s->asker->query->fine, p, normal);
        }
        return;
    }
    enum { ROUNDS = 12 };
    /* The surface is within half of what is told apart. */
    float radius = fmaxf(q->radius - 0.5F * s->asker->query->fine, 0), t = hewn_ray_meets_ball(q, p, radius);
    for (int i = 0; i < ROUNDS && t < s->high; i++) {
        float middle[3];
        take(s, t, p, normal);
        on_ray(q, t, middle);
        hewn_ask_approach(s->asker, middle, p, normal);
        t = hewn_ray_meets_ball(q, p, radius);
    }
}

static void try_box(search *s, const hewn_search_box *box)
{
    if (s->question->kind == HEWN_QUERY_RAY)
        try_ray(s, box);
    else
        try_surface(s, box);
}

/* --- searching ------------------------------------------------------------------------------------------------------
 */

/* Divides a box; what is left of it goes onto the heap, or, too small for that, counts as unseen: a place that was
 * found in it need not be its nearest. */
static hewn_result expand(search *s, const hewn_search_box *box, float smallest, hewn_error *error)
{
    hewn_search_box parts[8];
    if (hewn_apart(box->lo, box->hi) <= smallest) {
        try_box(s, box);
        s->unseen = fminf(s->unseen, box->lower);
        return HEWN_OK;
    }
    uint32_t count = hewn_search_divide(s->asker, box, s->question->kind == HEWN_QUERY_RAY, parts), best = 0, left = 0;
    for (uint32_t i = 0; i < count; i++) {
        parts[left] = parts[i];
        parts[left].lower = fmaxf(box->lower, hewn_question_lower(s->question, parts[i].lo, parts[i].hi));
        if (!(parts[left].lower < s->high))
            continue;
        best = parts[left].lower < parts[best].lower ? left : best;
        left++;
    }
    for (uint32_t i = 0; i < left; i++)
        HEWN_TRY(hewn_heap_push(&s->heap, &parts[i], error));
    /* Only where the box leaves room for a better place than the best so far. */
    if (left > 0 && (s->question->kind == HEWN_QUERY_RAY ||
                     parts[best].lower + 0.5F * hewn_apart(parts[best].lo, parts[best].hi) < s->high))
        try_box(s, &parts[best]);
    return HEWN_OK;
}

/* The field's value where the question begins says how near the surface is at least, where slopes are bounded. */
static double known_lower(search *s, const float p[3], float value)
{
    const hewn_query *query = s->asker->query;
    hewn_box way = query->box;
    double far = 0;
    for (int axis = 0; axis < 3; axis++) {
        way.lo[axis] = fmin(way.lo[axis], (double)p[axis]);
        way.hi[axis] = fmax(way.hi[axis], (double)p[axis]);
        far = fmax(far, fmax(fabs(way.lo[axis]), fabs(way.hi[axis])));
    }
    double slope = hewn_query_slope(query, &way);
    if (!isfinite(slope) || !isfinite(value))
        return 0;
    double free = ((double)fabsf(value) - 0x1p-18 * far) / slope - (double)s->question->radius;
    return fmax(0, free * (1 - 0x1p-20));
}

static hewn_result run(search *s, const hewn_query_limits *limits, float lower, bool *ran_out, hewn_error *error)
{
    const hewn_query *query = s->asker->query;
    hewn_search_box root = hewn_search_root(query);
    float smallest = fmaxf(0.25F * limits->tolerance, query->fine);
    root.lower = fmaxf(lower, hewn_question_lower(s->question, root.lo, root.hi));
    if (root.lower < INFINITY)
        HEWN_TRY(hewn_heap_push(&s->heap, &root, error));
    for (uint32_t divided = 0; s->heap.count > 0; divided++) {
        if (hewn_heap_least(&s->heap) >= s->high - limits->tolerance)
            return HEWN_OK;
        *ran_out = divided >= limits->most_boxes;
        if (*ran_out)
            return HEWN_OK;
        hewn_search_box box;
        hewn_heap_pop(&s->heap, &box);
        HEWN_TRY(expand(s, &box, smallest, error));
    }
    return HEWN_OK;
}

/* Where the question begins inside, a ray or ball need not move. */
static bool begins_inside(search *s, hewn_answer *out)
{
    const hewn_question *q = s->question;
    float p[3], normal[3] = {0, 0, 0}, value;
    on_ray(q, q->kind == HEWN_QUERY_NEAREST ? 0 : q->begin, p);
    value = hewn_ask_value(s->asker, p);
    out->inside = hewn_query_holds(s->asker->query, p) && value <= 0;
    out->low = known_lower(s, p, value);
    if (q->kind == HEWN_QUERY_NEAREST || !out->inside)
        return false;
    hewn_ask_gradient(s->asker, p, normal);
    take(s, q->begin, p, normal);
    return true;
}

static void finish(const search *s, const hewn_query_limits *limits, bool ran_out, hewn_answer *out)
{
    float low = fminf(fminf(s->unseen, s->high), hewn_heap_least(&s->heap));
    double fine = (double)s->asker->query->fine, length = 0;
    out->found = s->high < INFINITY;
    out->high = (double)s->high;
    out->low = fmax(0, (double)low - (low < INFINITY ? fine : 0));
    out->complete = !ran_out && !(out->high - out->low > (double)limits->tolerance + 2 * fine);
    out->complete = out->complete || (!out->found && !(low < INFINITY));
    for (int axis = 0; axis < 3; axis++) {
        out->point[axis] = out->found ? (double)s->point[axis] : 0;
        out->normal[axis] = out->found && isfinite(s->normal[axis]) ? (double)s->normal[axis] : 0;
        length += out->normal[axis] * out->normal[axis];
    }
    for (int axis = 0; axis < 3; axis++)
        out->normal[axis] = length > 0 && isfinite(length) ? out->normal[axis] / sqrt(length) : 0;
}

hewn_result hewn_query_search(hewn_asker *asker, const hewn_question *question, const hewn_query_limits *limits,
                              hewn_answer *out, hewn_error *error)
{
    search s = {.heap.size = sizeof(hewn_search_box),
                .asker = asker,
                .question = question,
                .high = INFINITY,
                .unseen = INFINITY};
    bool ran_out = false;
    *out = (hewn_answer){0};
    hewn_result result = HEWN_OK;
    if (!begins_inside(&s, out)) {
        float lower = (float)out->low;
        lower += question->kind == HEWN_QUERY_NEAREST ? 0 : question->begin;
        result = run(&s, limits, lower, &ran_out, error);
    }
    finish(&s, limits, ran_out, out);
    hewn_heap_free(&s.heap);
    return result;
}
