#include <float.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "simplify/samples.h"

/* --- coordinates -------------------------------------------------------------------------------------------------- */

/* The middle of the box becomes the origin, and a power of two brings coordinates to at most 1. Both are exact for
 * coordinates on a grid, so that a mesh far from the origin gives the same numbers as one near it. */
static void find_frame(simplify_work *work, const hewn_polygons *triangles)
{
    double lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY}, most = 0;
    for (uint64_t i = 0; i < 3 * triangles->vertex_count; i++) {
        double value = triangles->positions[i];
        lo[i % 3] = value < lo[i % 3] ? value : lo[i % 3];
        hi[i % 3] = value > hi[i % 3] ? value : hi[i % 3];
    }
    for (int axis = 0; axis < 3 && triangles->vertex_count > 0; axis++) {
        work->origin[axis] = lo[axis] / 2 + hi[axis] / 2;
        most = fmax(most, hi[axis] / 2 - lo[axis] / 2);
    }
    int exponent = 0;
    (void)frexp(most, &exponent);
    work->scale = most > 0 ? ldexp(1, exponent < DBL_MIN_EXP ? DBL_MIN_EXP : exponent) : 1;
}

/* --- faces -------------------------------------------------------------------------------------------------------- */

/* Faces that name a vertex twice have no sides and are left out. */
static void take_faces(simplify_work *work, const hewn_polygons *triangles)
{
    uint32_t count = 0;
    for (uint64_t f = 0; f < triangles->face_count; f++) {
        const uint32_t *corner = triangles->corners + 3 * f;
        if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0])
            continue;
        memcpy(work->tail + 3 * (size_t)count, corner, 3 * sizeof *corner);
        work->face_origins[count++] = (uint32_t)f;
    }
    work->face_count = work->live_faces = count;
    for (uint32_t h = 0; work->wedge && h < 3 * count; h++) {
        const size_t corner = 3 * (size_t)work->face_origins[h / 3] + h % 3;
        work->wedge[h] = work->wedges->corners ? work->wedges->corners[corner] : triangles->corners[corner];
    }
}

static void set_apart(simplify_work *work, uint32_t v)
{
#pragma omp atomic write
    work->rank[v] = SIMPLIFY_APART;
}

static int compare(const void *a, const void *b)
{
    uint64_t p = *(const uint64_t *)a, q = *(const uint64_t *)b;
    return p < q ? -1 : p > q;
}

static void sort_sides(uint64_t *sides, size_t count)
{
    if (count > 24) {
        qsort(sides, count, sizeof *sides, compare);
        return;
    }
    for (size_t i = 1; i < count; i++) {
        uint64_t held = sides[i];
        size_t k = i;
        for (; k > 0 && sides[k - 1] > held; k--)
            sides[k] = sides[k - 1];
        sides[k] = held;
    }
}

/* The half-edges between one vertex and greater ones, as (greater end, half-edge). */
static void match(simplify_work *work, uint32_t v, const uint64_t *sides, size_t count)
{
    for (size_t i = 0, end; i < count; i = end) {
        uint32_t other = (uint32_t)(sides[i] >> 32);
        for (end = i + 1; end < count && sides[end] >> 32 == other; end++)
            ;
        uint32_t h = (uint32_t)sides[i], g = (uint32_t)sides[end - 1];
        if (end - i == 1)
            continue;
        if (end - i == 2 && work->tail[h] != work->tail[g]) {
            work->twin[h] = g;
            work->twin[g] = h;
        } else {
            set_apart(work, v);
            set_apart(work, other);
        }
    }
}

/* Sides are gathered by their lesser end in whatever order threads come, and sorted there. `first` has an entry a
 * vertex and one more, zero. */
static void gather_sides(const simplify_work *work, uint32_t *first, uint64_t *sides)
{
    uint32_t halves = 3 * work->face_count;
#pragma omp parallel for schedule(static) if (work->vertex_count > SIMPLIFY_FEW)
    for (uint32_t h = 0; h < halves; h++) {
        uint32_t from = work->tail[h], to = simplify_head(work, h), least = from < to ? from : to;
#pragma omp atomic
        first[least]++;
    }
    uint32_t sum = 0;
    for (uint32_t v = 0; v <= work->vertex_count; v++) { /* ends of the lists, which filling makes beginnings */
        sum += first[v];
        first[v] = sum;
    }
#pragma omp parallel for schedule(static) if (work->vertex_count > SIMPLIFY_FEW)
    for (uint32_t h = 0; h < halves; h++) {
        uint32_t from = work->tail[h], to = simplify_head(work, h), least = from < to ? from : to, place;
#pragma omp atomic capture
        place = --first[least];
        sides[place] = (uint64_t)(from < to ? to : from) << 32 | h;
    }
}

static hewn_result pair_sides(simplify_work *work, hewn_error *error)
{
    uint32_t *first = hewn_alloc_zero((size_t)work->vertex_count + 1, sizeof *first);
    uint64_t *sides = hewn_alloc(work->face_count, 3 * sizeof *sides);
    if (first && sides) {
        gather_sides(work, first, sides);
#pragma omp parallel for schedule(dynamic, 4096) if (work->vertex_count > SIMPLIFY_FEW)
        for (uint32_t v = 0; v < work->vertex_count; v++) {
            sort_sides(sides + first[v], first[v + 1] - first[v]);
            match(work, v, sides + first[v], first[v + 1] - first[v]);
        }
    }
    hewn_result result = first && sides ? HEWN_OK : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
    hewn_free(first);
    hewn_free(sides);
    return result;
}

/* --- vertices ----------------------------------------------------------------------------------------------------- */

/* The lowest half-edge that leaves each vertex, before all others one without twin. */
static void start_fans(simplify_work *work, uint32_t *corners)
{
    for (uint32_t v = 0; v < work->vertex_count; v++)
        work->half[v] = SIMPLIFY_GONE;
    for (uint32_t h = 0; h < 3 * work->face_count; h++) {
        uint32_t v = work->tail[h], now = work->half[v];
        corners[v]++;
        if (now == SIMPLIFY_GONE || (work->twin[h] == HEWN_NONE && work->twin[now] != HEWN_NONE))
            work->half[v] = h;
    }
}

/* A vertex whose fan does not have all its corners has several fans. */
static void walk_fans(simplify_work *work, const uint32_t *corners)
{
#pragma omp parallel for schedule(static) if (work->vertex_count > SIMPLIFY_FEW)
    for (uint32_t v = 0; v < work->vertex_count; v++) {
        uint32_t first = work->half[v], h = first, count = 0;
        if (first == SIMPLIFY_GONE)
            continue;
        do {
            count++;
            h = simplify_turn(work, h);
        } while (h != HEWN_NONE && h != first && count <= corners[v]);
        if (count != corners[v])
            set_apart(work, v);
    }
}

static hewn_result allocate(simplify_work *work, const hewn_polygons *triangles, hewn_error *error)
{
    size_t verts = triangles->vertex_count, halves = 3 * triangles->face_count;
    work->vertex_count = work->input_count = (uint32_t)verts;
    work->positions = hewn_alloc(verts, 3 * sizeof *work->positions);
    work->half = hewn_alloc(verts, sizeof *work->half);
    work->rank = hewn_alloc_zero(verts, sizeof *work->rank);
    work->origins = hewn_alloc(verts, sizeof *work->origins);
    work->into = hewn_alloc(verts, sizeof *work->into);
    work->tail = hewn_alloc(halves, sizeof *work->tail);
    work->twin = hewn_alloc(halves, sizeof *work->twin);
    work->face_origins = hewn_alloc(triangles->face_count, sizeof *work->face_origins);
    work->wedge = work->wedges ? hewn_alloc(halves, sizeof *work->wedge) : NULL;
    work->tie = work->groups ? hewn_alloc(verts, sizeof *work->tie) : NULL;
    work->limit = work->limits ? hewn_alloc(verts, sizeof *work->limit) : NULL;
    if ((work->limit || !work->limits) && (work->tie || !work->groups) && (work->wedge || !work->wedges) &&
        work->positions && work->half && work->rank && work->origins && work->into && work->tail && work->twin &&
        work->face_origins)
        return HEWN_OK;
    return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying %llu triangles",
                     (unsigned long long)triangles->face_count);
}

/* Rings of the vertices of each group. */
static hewn_result tie_groups(simplify_work *work, hewn_error *error)
{
    uint32_t most = 0;
    for (uint32_t v = 0; v < work->vertex_count; v++)
        most = work->groups[v] > most ? work->groups[v] : most;
    uint32_t *last = hewn_alloc((size_t)most + 1, sizeof *last);
    if (!last)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
    memset(last, 0xFF, ((size_t)most + 1) * sizeof *last);
    for (uint32_t v = 0; v < work->vertex_count; v++) {
        uint32_t *of_group = &last[work->groups[v]];
        work->tie[v] = v;
        if (*of_group != HEWN_NONE) {
            work->tie[v] = work->tie[*of_group];
            work->tie[*of_group] = v;
        }
        *of_group = v;
    }
    hewn_free(last);
    return HEWN_OK;
}

hewn_result hewn_simplify_build(simplify_work *work, const hewn_polygons *triangles, hewn_error *error)
{
    HEWN_TRY(allocate(work, triangles, error));
    find_frame(work, triangles);
#pragma omp parallel for schedule(static) if (work->vertex_count > SIMPLIFY_FEW)
    for (uint32_t v = 0; v < work->vertex_count; v++) {
        for (size_t axis = 0, at = 3 * (size_t)v; axis < 3; axis++)
            work->positions[at + axis] = simplify_inward(work, triangles->positions[at + axis], axis);
        work->origins[v] = work->into[v] = v;
        if (work->limit)
            work->limit[v] = (float)((double)work->limits[v] / work->scale);
    }
    take_faces(work, triangles);
    memset(work->twin, 0xFF, 3 * (size_t)work->face_count * sizeof *work->twin);
    HEWN_TRY(pair_sides(work, error));
    uint32_t *corners = hewn_alloc_zero(work->vertex_count, sizeof *corners);
    if (!corners)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
    start_fans(work, corners);
    walk_fans(work, corners);
    for (uint32_t v = 0; v < work->vertex_count; v++)
        work->live_vertices += work->half[v] != SIMPLIFY_GONE;
    hewn_free(corners);
    return work->groups ? tie_groups(work, error) : HEWN_OK;
}

void hewn_simplify_release(simplify_work *work)
{
    hewn_free(work->positions);
    hewn_free(work->quadrics);
    hewn_free(work->facing);
    hewn_free(work->half);
    hewn_free(work->rank);
    hewn_free(work->origins);
    hewn_free(work->into);
    hewn_free(work->tail);
    hewn_free(work->twin);
    hewn_free(work->key);
    hewn_free(work->flags);
    hewn_free(work->face_origins);
    hewn_free(work->wedge);
    hewn_free(work->limit);
    hewn_free(work->tie);
    *work = (simplify_work){0};
}

/* A copy of an array; NULL of NULL, and where memory is out. */
static void *copy_of(const void *array, size_t count, size_t size, bool *failed)
{
    void *out = array ? hewn_alloc(count, size) : NULL;
    if (out)
        memcpy(out, array, count * size);
    *failed |= array && !out;
    return out;
}

hewn_result hewn_simplify_copy(const simplify_work *work, simplify_work *out, hewn_error *error)
{
    const size_t verts = work->vertex_count, faces = work->face_count, halves = 3 * faces;
    bool failed = false;
    *out = *work;
    out->positions = copy_of(work->positions, 3 * verts, sizeof *work->positions, &failed);
    out->quadrics = copy_of(work->quadrics, verts, sizeof *work->quadrics, &failed);
    out->facing = copy_of(work->facing, 3 * verts, sizeof *work->facing, &failed);
    out->half = copy_of(work->half, verts, sizeof *work->half, &failed);
    out->rank = copy_of(work->rank, verts, sizeof *work->rank, &failed);
    out->origins = copy_of(work->origins, verts, sizeof *work->origins, &failed);
    out->tie = copy_of(work->tie, verts, sizeof *work->tie, &failed);
    out->limit = copy_of(work->limit, verts, sizeof *work->limit, &failed);
    out->tail = copy_of(work->tail, halves, sizeof *work->tail, &failed);
    out->twin = copy_of(work->twin, halves, sizeof *work->twin, &failed);
    out->key = copy_of(work->key, halves, sizeof *work->key, &failed);
    out->flags = copy_of(work->flags, halves, sizeof *work->flags, &failed);
    out->face_origins = copy_of(work->face_origins, faces, sizeof *work->face_origins, &failed);
    out->wedge = copy_of(work->wedge, halves, sizeof *work->wedge, &failed);
    out->into = copy_of(work->into, work->input_count, sizeof *work->into, &failed);
    return failed ? hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying") : HEWN_OK;
}

/* An array with room for more; `*failed` where memory is out. */
static void grow(void **array, size_t count, size_t size, bool *failed)
{
    void *more = *array && !*failed ? hewn_realloc(*array, count, size) : NULL;
    *failed |= *array && !more;
    *array = more ? more : *array;
}

hewn_result hewn_simplify_grow(simplify_work *work, uint32_t vertices, uint32_t faces, hewn_error *error)
{
    const size_t verts = (size_t)work->vertex_count + vertices, all = (size_t)work->face_count + faces;
    bool failed = false;
    grow((void **)&work->positions, 3 * verts, sizeof *work->positions, &failed);
    grow((void **)&work->quadrics, verts, sizeof *work->quadrics, &failed);
    grow((void **)&work->facing, 3 * verts, sizeof *work->facing, &failed);
    grow((void **)&work->half, verts, sizeof *work->half, &failed);
    grow((void **)&work->rank, verts, sizeof *work->rank, &failed);
    grow((void **)&work->origins, verts, sizeof *work->origins, &failed);
    grow((void **)&work->limit, verts, sizeof *work->limit, &failed);
    grow((void **)&work->tail, 3 * all, sizeof *work->tail, &failed);
    grow((void **)&work->twin, 3 * all, sizeof *work->twin, &failed);
    grow((void **)&work->key, 3 * all, sizeof *work->key, &failed);
    grow((void **)&work->flags, 3 * all, sizeof *work->flags, &failed);
    grow((void **)&work->face_origins, all, sizeof *work->face_origins, &failed);
    if (work->samples)
        grow((void **)&work->samples->first, all, sizeof *work->samples->first, &failed);
    if (failed || !work->half || !work->tail || !work->twin)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
    for (size_t v = work->vertex_count; v < verts; v++)
        work->half[v] = SIMPLIFY_GONE;
    for (size_t f = work->face_count; f < all; f++) {
        for (size_t k = 0; k < 3; k++)
            work->tail[3 * f + k] = work->twin[3 * f + k] = HEWN_NONE;
        if (work->samples)
            work->samples->first[f] = HEWN_NONE;
    }
    work->vertex_count = (uint32_t)verts;
    work->face_count = (uint32_t)all;
    return HEWN_OK;
}
