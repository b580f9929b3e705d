#include "simplify/recall.h"

#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/hash.h"
#include "geom/nearest.h"
#include "hewn/mesh.h"

enum { NUMBERS = 9 };

static void points_of(const hewn_triangle_view *view, uint64_t triangle, double out[NUMBERS])
{
    for (uint64_t k = 0; k < 3; k++)
        hewn_triangle_point(view, view->corners[3 * triangle + k], out + 3 * k);
}

static uint64_t slot_of(const simplify_recall *recall, const double points[NUMBERS])
{
    return hewn_hash_bytes(hewn_hash_begin(), points, NUMBERS * sizeof *points).a & (recall->slot_count - 1);
}

/* The place of a triangle, or HEWN_NONE. */
static uint32_t find(const simplify_recall *recall, const double points[NUMBERS])
{
    if (recall->count == 0)
        return HEWN_NONE;
    for (uint64_t slot = slot_of(recall, points);; slot = (slot + 1) & (recall->slot_count - 1)) {
        const uint32_t at = recall->slots[slot];
        if (at == HEWN_NONE || memcmp(recall->points + NUMBERS * (size_t)at, points, NUMBERS * sizeof *points) == 0)
            return at;
    }
}

hewn_result hewn_simplify_remember(simplify_recall *recall, const hewn_triangle_view *triangles, const uint8_t *far,
                                   hewn_error *error)
{
    const uint64_t count = triangles->triangle_count;
    uint64_t slots = 16;
    while (slots < 2 * count)
        slots *= 2;
    hewn_simplify_forget(recall);
    recall->points = hewn_alloc(count, NUMBERS * sizeof *recall->points);
    recall->good = hewn_alloc(count, 1);
    recall->slots = hewn_alloc(slots, sizeof *recall->slots);
    if (!recall->points || !recall->good || !recall->slots) {
        hewn_simplify_forget(recall);
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
    }
    memset(recall->slots, 0xFF, slots * sizeof *recall->slots);
    recall->slot_count = slots;
    recall->count = count;
    for (uint64_t t = 0; t < count; t++) {
        double *points = recall->points + NUMBERS * t;
        points_of(triangles, t, points);
        recall->good[t] = !far[t];
        uint64_t slot = slot_of(recall, points);
        while (recall->slots[slot] != HEWN_NONE)
            slot = (slot + 1) & (slots - 1);
        recall->slots[slot] = (uint32_t)t;
    }
    return HEWN_OK;
}

void hewn_simplify_forget(simplify_recall *recall)
{
    hewn_free(recall->points);
    hewn_free(recall->good);
    hewn_free(recall->slots);
    *recall = (simplify_recall){0};
}

void hewn_simplify_recall(const simplify_recall *recall, const hewn_triangle_view *triangles, uint8_t *known)
{
#pragma omp parallel for schedule(static)
    for (uint64_t t = 0; t < triangles->triangle_count; t++) {
        double points[NUMBERS];
        points_of(triangles, t, points);
        const uint32_t at = find(recall, points);
        known[t] = at != HEWN_NONE && recall->good[at];
    }
}

/* Corners of what is remembered and not among `now`: places of points in `recall`. */
static uint32_t *list_gone(const simplify_recall *recall, const hewn_triangle_view *now, uint64_t *count)
{
    uint8_t *there = hewn_alloc_zero(recall->count, 1);
    uint32_t *corners = hewn_alloc(recall->count, 3 * sizeof *corners);
    *count = 0;
    for (uint64_t t = 0; there && t < now->triangle_count; t++) {
        double points[NUMBERS];
        points_of(now, t, points);
        const uint32_t at = find(recall, points);
        if (at != HEWN_NONE)
            there[at] = 1;
    }
    for (uint64_t t = 0; there && corners && t < recall->count; t++) {
        for (uint64_t k = 0; k < 3 && !there[t]; k++)
            corners[3 * *count + k] = (uint32_t)(3 * t + k);
        *count += !there[t];
    }
    const bool made = there && corners;
    hewn_free(there);
    if (made)
        return corners;
    hewn_free(corners);
    return NULL;
}

/* A ball around each triangle, and what is nearest to its middle. */
static void take_out(const hewn_triangle_view *gone, const hewn_bvh *bvh, const hewn_triangle_view *from, double reach,
                     uint8_t *known)
{
#pragma omp parallel for schedule(dynamic, 1024)
    for (uint64_t t = 0; t < from->triangle_count; t++) {
        double points[NUMBERS], middle[3], most = 0, distance;
        if (!known[t])
            continue;
        points_of(from, t, points);
        for (int axis = 0; axis < 3; axis++)
            middle[axis] = (points[axis] + points[3 + axis] + points[6 + axis]) / 3;
        for (int k = 0; k < 3; k++) {
            double square = 0;
            for (int axis = 0; axis < 3; axis++)
                square += (points[3 * k + axis] - middle[axis]) * (points[3 * k + axis] - middle[axis]);
            most = fmax(most, square);
        }
        (void)hewn_bvh_nearest(bvh, gone, middle, 0, &distance);
        known[t] = distance > (1 + 1e-6) * (sqrt(most) + reach);
    }
}

hewn_result hewn_simplify_recall_near(const simplify_recall *recall, const hewn_triangle_view *now,
                                      const hewn_triangle_view *from, double reach, uint8_t *known, hewn_error *error)
{
    uint64_t count;
    if (recall->count > UINT32_MAX / 3)
        memset(known, 0, from->triangle_count);
    if (recall->count == 0 || recall->count > UINT32_MAX / 3)
        return HEWN_OK;
    uint32_t *corners = list_gone(recall, now, &count);
    if (!corners)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
    hewn_result result = HEWN_OK;
    if (count > 0) {
        hewn_bvh bvh;
        const hewn_triangle_view gone = {
            .vertex_count = 3 * recall->count, .triangle_count = count, .doubles = recall->points, .corners = corners};
        result = hewn_bvh_build(&gone, &bvh, error);
        if (result == HEWN_OK) {
            take_out(&gone, &bvh, from, reach, known);
            hewn_bvh_free(&bvh);
        }
    }
    hewn_free(corners);
    return result;
}
