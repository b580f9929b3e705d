/* What may not move: rims, features and borders of labels, and what the caller's own freedom says. */
#include <math.h>
#include <stdlib.h>

#include "base/alloc.h"
#include "smooth/work.h"

/* A side of a face, kept at its lesser vertex. */
typedef struct side {
    uint32_t other, face;
} side;

static int by_other(const void *a, const void *b)
{
    const side *left = a, *right = b;
    if (left->other != right->other)
        return left->other < right->other ? -1 : 1;
    return (left->face > right->face) - (left->face < right->face);
}

/* Newell's normal, unit length; zero for a face without area. */
static void face_normal(const smooth_work *work, uint64_t face, double out[3])
{
    const hewn_polygons *polygons = work->polygons;
    uint64_t begin = smooth_face_begin(polygons, face), end = smooth_face_begin(polygons, face + 1);
    out[0] = out[1] = out[2] = 0;
    const double *origin = end > begin ? work->at + 3 * (size_t)polygons->corners[begin] : NULL;
    for (uint64_t c = begin + 1; c + 1 < end; c++) {
        double u[3], v[3], n[3];
        smooth_between(origin, work->at + 3 * (size_t)polygons->corners[c], u);
        smooth_between(origin, work->at + 3 * (size_t)polygons->corners[c + 1], v);
        smooth_cross(u, v, n);
        for (int axis = 0; axis < 3; axis++)
            out[axis] += n[axis];
    }
    double length = sqrt(smooth_dot(out, out));
    for (int axis = 0; axis < 3; axis++)
        out[axis] = length > 0 ? out[axis] / length : 0;
}

static bool bends(const smooth_work *work, const side *sides, double least)
{
    double a[3], b[3], across[3];
    face_normal(work, sides[0].face, a);
    face_normal(work, sides[1].face, b);
    smooth_cross(a, b, across);
    return atan2(sqrt(smooth_dot(across, across)), smooth_dot(a, b)) > least;
}

/* Whether an edge of `count` faces locks its ends. */
static bool edge_locks(const smooth_work *work, const side *sides, uint32_t count)
{
    const int32_t *labels = work->desc->labels;
    for (uint32_t i = 1; labels && i < count; i++)
        if (labels[sides[i].face] != labels[sides[0].face])
            return true;
    return work->desc->lock_angle > 0 && count == 2 && bends(work, sides, work->desc->lock_angle * (M_PI / 180));
}

static void lock_sides(smooth_work *work, uint32_t v, side *sides, uint32_t count)
{
    qsort(sides, count, sizeof *sides, by_other);
    for (uint32_t i = 0; i < count;) {
        uint32_t end = i + 1;
        while (end < count && sides[end].other == sides[i].other)
            end++;
        if (edge_locks(work, sides + i, end - i))
            work->freedom[v] = work->freedom[sides[i].other] = 0;
        i = end;
    }
}

static hewn_result lock_edges(smooth_work *work, hewn_error *error)
{
    const hewn_polygons *polygons = work->polygons;
    uint64_t corners = smooth_face_begin(polygons, polygons->face_count);
    uint32_t *first = hewn_alloc_zero((size_t)work->count + 2, sizeof *first);
    side *sides = hewn_alloc(corners, sizeof *sides);
    if (!first || !sides) {
        hewn_free(first);
        hewn_free(sides);
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory locking vertices");
    }
    for (int pass = 0; pass < 2; pass++) {
        for (uint64_t f = 0; f < polygons->face_count; f++) {
            uint64_t begin = smooth_face_begin(polygons, f), end = smooth_face_begin(polygons, f + 1);
            for (uint64_t c = begin; c < end; c++) {
                uint32_t a = polygons->corners[c], b = polygons->corners[c + 1 < end ? c + 1 : begin];
                uint32_t least = a < b ? a : b, most = a < b ? b : a;
                if (a == b)
                    continue;
                if (pass == 1)
                    sides[first[least + 1]] = (side){most, (uint32_t)f};
                first[least + (pass == 0 ? 2 : 1)]++;
            }
        }
        for (uint32_t v = 0; pass == 0 && v < work->count; v++)
            first[v + 2] += first[v + 1];
    }
    for (uint32_t v = 0; v < work->count; v++)
        lock_sides(work, v, sides + first[v], first[v + 1] - first[v]);
    hewn_free(first);
    hewn_free(sides);
    return HEWN_OK;
}

hewn_result hewn_smooth_lock(smooth_work *work, hewn_error *error)
{
    const hewn_smooth_desc *desc = work->desc;
    bool edges = desc->lock_angle > 0 || desc->labels;
    if (edges || desc->lock_boundary || desc->freedom) {
        work->freedom = hewn_alloc(work->count, sizeof *work->freedom);
        if (!work->freedom)
            return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory locking vertices");
        for (uint32_t v = 0; v < work->count; v++)
            work->freedom[v] = desc->lock_boundary && work->flags[v] & SMOOTH_RIM ? 0
                               : desc->freedom                                    ? desc->freedom[v]
                                                                                  : 1;
    }
    if (edges)
        HEWN_TRY(lock_edges(work, error));
    bool rims_stay = desc->method == HEWN_SMOOTH_COTAN || desc->method == HEWN_SMOOTH_IMPLICIT;
    bool rims_slide = !rims_stay && desc->method != HEWN_SMOOTH_BILATERAL;
    uint64_t locked = 0;
#pragma omp parallel for schedule(static) reduction(+ : locked)
    for (uint32_t v = 0; v < work->count; v++) {
        bool rim = work->flags[v] & SMOOTH_RIM;
        bool corner = rim && rims_slide && work->neighbours.first[v] == work->neighbours.first[v + 1];
        locked += work->flags[v] & SMOOTH_USED && (smooth_freedom(work, v) <= 0 || (rim && rims_stay) || corner);
    }
    work->report->locked_vertices = locked;
    return HEWN_OK;
}
