#include "mesh/build.h"

#include <stdlib.h>

#include "base/alloc.h"

/* Faces of more corners than this are looked at by marking vertices instead of comparing all pairs. */
enum { SMALL_FACE = 32 };

static bool triangle_is_bad(const uint32_t *corner, uint32_t vert_count)
{
    return corner[0] >= vert_count || corner[1] >= vert_count || corner[2] >= vert_count || corner[0] == corner[1] ||
           corner[1] == corner[2] || corner[2] == corner[0];
}

/* Repetition in large faces is left to has_repetition(). */
static bool polygon_is_bad(const mesh_source *source, uint32_t face)
{
    uint64_t begin = source->first[face], end = source->first[face + 1];
    for (uint64_t i = begin; i < end; i++) {
        if (source->corners[i] >= source->vert_count)
            return true;
        if (end - begin <= SMALL_FACE)
            for (uint64_t j = begin; j < i; j++)
                if (source->corners[i] == source->corners[j])
                    return true;
    }
    return false;
}

static bool has_repetition(const mesh_source *source, uint32_t face, uint8_t *marks)
{
    uint32_t begin = mesh_source_begin(source, face), end = mesh_source_begin(source, face + 1);
    bool found = false;
    for (uint32_t i = begin; i < end && !found; i++) {
        uint32_t v = source->corners[i];
        found = marks[v / 8] >> v % 8 & 1;
        marks[v / 8] |= (uint8_t)(1u << v % 8);
    }
    for (uint32_t i = begin; i < end; i++)
        marks[source->corners[i] / 8] = 0;
    return found;
}

/* The first large face below `limit` that visits a vertex twice, or `limit`. */
static hewn_result check_large_faces(const mesh_source *source, uint32_t limit, uint32_t *out, hewn_error *error)
{
    uint8_t *marks = NULL;
    *out = limit;
    for (uint32_t f = 0; f < limit && *out == limit; f++) {
        if (source->first[f + 1] - source->first[f] <= SMALL_FACE)
            continue;
        if (!marks && !(marks = hewn_alloc_zero(source->vert_count / 8 + 1, 1)))
            return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory checking faces");
        if (has_repetition(source, f, marks))
            *out = f;
    }
    hewn_free(marks);
    return HEWN_OK;
}

static int by_value(const void *a, const void *b)
{
    uint32_t left = *(const uint32_t *)a, right = *(const uint32_t *)b;
    return (left > right) - (left < right);
}

static hewn_result explain_face(const mesh_source *source, uint32_t face, hewn_error *error)
{
    uint32_t begin = mesh_source_begin(source, face), count = mesh_source_begin(source, face + 1) - begin;
    uint32_t *sorted = hewn_alloc(count, sizeof *sorted);
    if (!sorted)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory checking faces");
    for (uint32_t i = 0; i < count; i++) {
        sorted[i] = source->corners[begin + i];
        if (sorted[i] < source->vert_count)
            continue;
        uint32_t index = sorted[i];
        hewn_free(sorted);
        return hewn_fail(error, HEWN_BAD_INPUT, "face %u names the vertex %u, but there are only %u", face, index,
                         source->vert_count);
    }
    qsort(sorted, count, sizeof *sorted, by_value);
    uint32_t twice = 0;
    for (uint32_t i = 1; i < count && twice == 0; i++)
        twice = sorted[i] == sorted[i - 1] ? i : 0;
    uint32_t vert = sorted[twice];
    hewn_free(sorted);
    return hewn_fail(error, HEWN_BAD_INPUT, "face %u has the vertex %u twice", face, vert);
}

static hewn_result check_lengths(const mesh_source *source, hewn_error *error)
{
    if (!source->first)
        return HEWN_OK;
    for (uint32_t f = 0; f < source->face_count; f++)
        if (source->first[f + 1] < source->first[f] || source->first[f + 1] - source->first[f] < 3)
            return hewn_fail(error, HEWN_BAD_INPUT, "face %u has fewer than three corners", f);
    return HEWN_OK;
}

hewn_result hewn_mesh_check_faces(const mesh_source *source, hewn_error *error)
{
    HEWN_TRY(check_lengths(source, error));
    uint32_t bad = source->face_count;
    if (source->first) {
#pragma omp parallel for schedule(static) reduction(min : bad) if (source->face_count >= HEWN_MESH_ALONE)
        for (uint32_t f = 0; f < source->face_count; f++)
            if (polygon_is_bad(source, f))
                bad = f < bad ? f : bad;
        HEWN_TRY(check_large_faces(source, bad, &bad, error));
    } else {
#pragma omp parallel for schedule(static) reduction(min : bad) if (source->face_count >= HEWN_MESH_ALONE)
        for (uint32_t f = 0; f < source->face_count; f++)
            if (triangle_is_bad(source->corners + 3 * (size_t)f, source->vert_count))
                bad = f < bad ? f : bad;
    }
    return bad < source->face_count ? explain_face(source, bad, error) : HEWN_OK;
}
