#include <math.h>

#include "mesh/soup.h"

/* Lists shorter than this are compared pair by pair. */
enum { FEW_PAIRS = 128 };

typedef struct near_search {
    const double *positions;
    double distance;
    uint32_t *parent;
} near_search;

typedef struct near_box {
    double lo[3], hi[3];
} near_box;

static const double *point_at(const near_search *search, uint32_t point)
{
    return search->positions + 3 * (size_t)point;
}

/* Each difference is divided before it is squared, so that no finite distance overflows or vanishes. Every step of
 * this and of the next two is monotone also when rounded, so boxes never contradict the points inside. */
static bool within(const near_search *search, const double difference[3])
{
    double sum = 0;
    for (int axis = 0; axis < 3; axis++) {
        double share = difference[axis] / search->distance;
        sum += share * share;
    }
    return sum <= 1;
}

static bool boxes_near(const near_search *search, const near_box *a, const near_box *b)
{
    double gap[3];
    for (int axis = 0; axis < 3; axis++)
        gap[axis] = fmax(0, fmax(b->lo[axis] - a->hi[axis], a->lo[axis] - b->hi[axis]));
    return within(search, gap);
}

static bool boxes_all_near(const near_search *search, const near_box *a, const near_box *b)
{
    double span[3];
    for (int axis = 0; axis < 3; axis++)
        span[axis] = fmax(a->hi[axis], b->hi[axis]) - fmin(a->lo[axis], b->lo[axis]);
    return within(search, span);
}

static near_box box_of(const near_search *search, const uint32_t *list, size_t count)
{
    near_box box = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (size_t i = 0; i < count; i++) {
        const double *p = point_at(search, list[i]);
        for (int axis = 0; axis < 3; axis++) {
            box.lo[axis] = p[axis] < box.lo[axis] ? p[axis] : box.lo[axis];
            box.hi[axis] = p[axis] > box.hi[axis] ? p[axis] : box.hi[axis];
        }
    }
    return box;
}

static double longest(const near_box *box, int *out)
{
    *out = 0;
    for (int axis = 1; axis < 3; axis++)
        if (box->hi[axis] - box->lo[axis] > box->hi[*out] - box->lo[*out])
            *out = axis;
    return box->hi[*out] - box->lo[*out];
}

/* Sorts a list to both sides of the middle of its box; neither side is empty unless all points are equal. */
static size_t halve(const near_search *search, const near_box *box, uint32_t *list, size_t count)
{
    int axis;
    longest(box, &axis);
    double middle = box->lo[axis] / 2 + box->hi[axis] / 2;
    if (middle < box->lo[axis] || middle >= box->hi[axis])
        middle = box->lo[axis];
    size_t low = 0;
    for (size_t i = 0; i < count; i++) {
        uint32_t point = list[i];
        if (point_at(search, point)[axis] <= middle) {
            list[i] = list[low];
            list[low++] = point;
        }
    }
    return low;
}

static bool pair_near(const near_search *search, uint32_t a, uint32_t b)
{
    const double *p = point_at(search, a), *q = point_at(search, b);
    double difference[3] = {p[0] - q[0], p[1] - q[1], p[2] - q[2]};
    return within(search, difference);
}

/* `whole`: each list is one set, so one pair joins all. */
static void join_pairs(const near_search *search, const uint32_t *a, size_t a_count, const uint32_t *b, size_t b_count,
                       bool whole)
{
    for (size_t i = 0; i < a_count; i++)
        for (size_t k = 0; k < b_count; k++)
            if (pair_near(search, a[i], b[k])) {
                hewn_sets_join(search->parent, a[i], b[k]);
                if (whole)
                    return;
            }
}

/* Both lists have been joined within themselves, so a list in a box that is near as a whole is one set. */
static void join_between(const near_search *search, uint32_t *a, size_t a_count, uint32_t *b, size_t b_count)
{
    near_box a_box = box_of(search, a, a_count), b_box = box_of(search, b, b_count);
    if (!boxes_near(search, &a_box, &b_box))
        return;
    bool whole = boxes_all_near(search, &a_box, &a_box) && boxes_all_near(search, &b_box, &b_box);
    if (whole && hewn_sets_find(search->parent, a[0]) == hewn_sets_find(search->parent, b[0]))
        return;
    if (boxes_all_near(search, &a_box, &b_box) || a_count * b_count <= FEW_PAIRS) {
        join_pairs(search, a, a_count, b, b_count, whole);
        return;
    }
    int axis;
    if (b_count == 1 || (a_count > 1 && longest(&a_box, &axis) >= longest(&b_box, &axis))) {
        size_t low = halve(search, &a_box, a, a_count);
        join_between(search, a, low, b, b_count);
        join_between(search, a + low, a_count - low, b, b_count);
    } else {
        size_t low = halve(search, &b_box, b, b_count);
        join_between(search, a, a_count, b, low);
        join_between(search, a, a_count, b + low, b_count - low);
    }
}

static void join_within(const near_search *search, uint32_t *list, size_t count)
{
    if (count < 2)
        return;
    near_box box = box_of(search, list, count);
    if (boxes_all_near(search, &box, &box)) {
        for (size_t i = 1; i < count; i++)
            hewn_sets_join(search->parent, list[0], list[i]);
        return;
    }
    if (count * count <= FEW_PAIRS) {
        for (size_t i = 1; i < count; i++)
            join_pairs(search, list + i, 1, list, i, false);
        return;
    }
    size_t low = halve(search, &box, list, count);
    join_within(search, list, low);
    join_within(search, list + low, count - low);
    join_between(search, list, low, list + low, count - low);
}

void hewn_near_join(const double *positions, double distance, uint32_t *a, size_t a_count, uint32_t *b, size_t b_count,
                    uint32_t *parent)
{
    near_search search = {positions, distance, parent};
    if (b)
        join_between(&search, a, a_count, b, b_count);
    else
        join_within(&search, a, a_count);
}
