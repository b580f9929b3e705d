#include "mesh/soup.h"

#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"

/* --- life ------------------------------------------------------------------------------------------------------- */

static hewn_result check_faces(const hewn_polygons *in, hewn_error *error)
{
    if ((in->vertex_count > 0 && !in->positions) || (in->face_count > 0 && !in->corners))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "polygons without positions or corners");
    if (in->vertex_count >= HEWN_NONE - 1 || in->face_count >= (in->first ? HEWN_NONE - 1 : (HEWN_NONE - 1) / 3))
        return hewn_fail(error, HEWN_LIMIT, "%llu vertices and %llu faces are more than a mesh can hold",
                         (unsigned long long)in->vertex_count, (unsigned long long)in->face_count);
    if (!in->first)
        return HEWN_OK;
    if (in->first[0] != 0)
        return hewn_fail(error, HEWN_BAD_INPUT, "face 0 begins at corner %llu, not at 0",
                         (unsigned long long)in->first[0]);
    for (uint64_t f = 0; f < in->face_count; f++) {
        if (in->first[f + 1] < in->first[f])
            return hewn_fail(error, HEWN_BAD_INPUT, "face %llu ends before it begins", (unsigned long long)f);
        if (in->first[f + 1] >= HEWN_NONE - 1)
            return hewn_fail(error, HEWN_LIMIT, "%llu corners are more than a mesh can hold",
                             (unsigned long long)in->first[f + 1]);
    }
    return HEWN_OK;
}

static hewn_result check_values(const hewn_soup *soup, hewn_error *error)
{
    for (uint64_t i = 0; i < 3 * (uint64_t)soup->vertex_count; i++)
        if (!isfinite(soup->positions[i])) {
            const double *p = soup->positions + i / 3 * 3;
            return hewn_fail(error, HEWN_BAD_INPUT, "vertex %llu lies at (%g, %g, %g), which is not finite",
                             (unsigned long long)(i / 3), p[0], p[1], p[2]);
        }
    for (uint32_t f = 0; f < soup->face_count; f++)
        for (uint64_t c = soup->first[f]; c < soup->first[f + 1]; c++)
            if (soup->corners[c] >= soup->vertex_count)
                return hewn_fail(error, HEWN_BAD_INPUT, "face %u has the corner %u, but there are %u vertices", f,
                                 soup->corners[c], soup->vertex_count);
    return HEWN_OK;
}

static void copy(void *to, const void *from, size_t count, size_t size)
{
    if (count > 0)
        memcpy(to, from, count * size);
}

static void number(uint32_t *items, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        items[i] = i;
}

hewn_result hewn_soup_create(const hewn_polygons *polygons, hewn_soup *out, hewn_error *error)
{
    *out = (hewn_soup){0};
    HEWN_TRY(check_faces(polygons, error));
    uint64_t faces = polygons->face_count, corners = polygons->first ? polygons->first[faces] : 3 * faces;
    hewn_soup soup = {0};
    hewn_result result = hewn_soup_reserve(&soup, polygons->vertex_count, faces, corners, error);
    if (result == HEWN_OK) {
        soup.vertex_count = (uint32_t)polygons->vertex_count;
        soup.face_count = (uint32_t)faces;
        copy(soup.positions, polygons->positions, soup.vertex_count, 3 * sizeof(double));
        copy(soup.corners, polygons->corners, corners, sizeof(uint32_t));
        for (uint64_t f = 0; f <= faces; f++)
            soup.first[f] = polygons->first ? polygons->first[f] : 3 * f;
        number(soup.vertex_origins, soup.vertex_count);
        number(soup.face_origins, soup.face_count);
        for (uint64_t f = 0; f < faces; f++)
            soup.turned[f] = 0;
        number(soup.corner_origins, (uint32_t)corners);
        result = check_values(&soup, error);
    }
    if (result == HEWN_OK)
        *out = soup;
    else
        hewn_soup_destroy(&soup);
    return result;
}

void hewn_soup_destroy(hewn_soup *soup)
{
    hewn_free(soup->positions);
    hewn_free(soup->vertex_origins);
    hewn_free(soup->first);
    hewn_free(soup->face_origins);
    hewn_free(soup->turned);
    hewn_free(soup->corners);
    hewn_free(soup->corner_origins);
    *soup = (hewn_soup){0};
}

/* --- growing and shrinking ---------------------------------------------------------------------------------------- */

static hewn_result grow(uint32_t **items, size_t *capacity, uint64_t needed, hewn_error *error)
{
    void *block = *items;
    hewn_result result = hewn_reserve(&block, capacity, needed, sizeof **items, error);
    *items = block;
    return result;
}

hewn_result hewn_soup_reserve(hewn_soup *soup, uint64_t vertices, uint64_t faces, uint64_t corners, hewn_error *error)
{
    uint64_t old = soup->first ? hewn_soup_corner_count(soup) : 0;
    vertices += soup->vertex_count;
    faces += soup->face_count;
    corners += old;
    if (vertices >= HEWN_NONE - 1 || faces >= HEWN_NONE - 1 || corners >= HEWN_NONE - 1)
        return hewn_fail(error, HEWN_LIMIT, "the repaired mesh is larger than a mesh can be");
    void *positions = soup->positions, *first = soup->first;
    bool fresh = !first;
    hewn_result result = hewn_reserve(&positions, &soup->position_capacity, vertices, 3 * sizeof(double), error);
    soup->positions = positions;
    HEWN_TRY(result);
    result = hewn_reserve(&first, &soup->first_capacity, faces + 1, sizeof *soup->first, error);
    soup->first = first;
    HEWN_TRY(result);
    if (fresh)
        soup->first[0] = 0;
    void *turned = soup->turned;
    result = hewn_reserve(&turned, &soup->turned_capacity, faces, 1, error);
    soup->turned = turned;
    HEWN_TRY(result);
    HEWN_TRY(grow(&soup->vertex_origins, &soup->vertex_capacity, vertices, error));
    HEWN_TRY(grow(&soup->face_origins, &soup->face_capacity, faces, error));
    HEWN_TRY(grow(&soup->corners, &soup->corner_capacity, corners, error));
    return grow(&soup->corner_origins, &soup->corner_origin_capacity, corners, error);
}

uint32_t hewn_soup_add_vertex(hewn_soup *soup, const double position[3], uint32_t origin)
{
    uint32_t vertex = soup->vertex_count++;
    memcpy(soup->positions + 3 * (size_t)vertex, position, 3 * sizeof *position);
    soup->vertex_origins[vertex] = origin;
    return vertex;
}

void hewn_soup_add_triangle(hewn_soup *soup, uint32_t a, uint32_t b, uint32_t c)
{
    uint64_t at = soup->first[soup->face_count];
    const uint32_t corners[3] = {a, b, c};
    for (int k = 0; k < 3; k++) {
        soup->corners[at + k] = corners[k];
        soup->corner_origins[at + k] = HEWN_NONE;
    }
    soup->turned[soup->face_count] = 0;
    soup->face_origins[soup->face_count++] = HEWN_NONE;
    soup->first[soup->face_count] = at + 3;
}

void hewn_soup_keep_faces(hewn_soup *soup, const uint8_t *keep)
{
    uint32_t faces = 0;
    uint64_t corners = 0;
    for (uint32_t f = 0; f < soup->face_count; f++) {
        uint64_t begin = soup->first[f], length = soup->first[f + 1] - begin;
        if (!keep[f])
            continue;
        memmove(soup->corners + corners, soup->corners + begin, length * sizeof *soup->corners);
        memmove(soup->corner_origins + corners, soup->corner_origins + begin, length * sizeof *soup->corner_origins);
        soup->face_origins[faces] = soup->face_origins[f];
        soup->turned[faces] = soup->turned[f];
        soup->first[faces++] = corners;
        corners += length;
    }
    soup->face_count = faces;
    soup->first[faces] = corners;
}

static void reverse(uint32_t *items, uint64_t begin, uint64_t end)
{
    while (begin + 1 < end) {
        uint32_t kept = items[begin];
        items[begin++] = items[--end];
        items[end] = kept;
    }
}

void hewn_soup_turn_face(hewn_soup *soup, uint32_t face)
{
    soup->turned[face] ^= 1;
    reverse(soup->corners, soup->first[face] + 1, soup->first[face + 1]);
    reverse(soup->corner_origins, soup->first[face] + 1, soup->first[face + 1]);
}

hewn_result hewn_soup_drop_isolated(hewn_soup *soup, hewn_repair_report *report, hewn_error *error)
{
    uint32_t *moved = hewn_alloc_zero(soup->vertex_count, sizeof *moved), count = 0;
    if (!moved)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory dropping isolated vertices");
    uint32_t corners = hewn_soup_corner_count(soup);
    for (uint32_t c = 0; c < corners; c++)
        moved[soup->corners[c]] = 1;
    for (uint32_t v = 0; v < soup->vertex_count; v++) {
        if (!moved[v])
            continue;
        memmove(soup->positions + 3 * (size_t)count, soup->positions + 3 * (size_t)v, 3 * sizeof(double));
        soup->vertex_origins[count] = soup->vertex_origins[v];
        moved[v] = count++;
    }
    for (uint32_t c = 0; c < corners; c++)
        soup->corners[c] = moved[soup->corners[c]];
    report->isolated_vertices += soup->vertex_count - count;
    soup->vertex_count = count;
    hewn_free(moved);
    return HEWN_OK;
}

/* --- looking ------------------------------------------------------------------------------------------------------ */

void hewn_soup_face_normal(const hewn_soup *soup, uint32_t face, double out[3])
{
    uint64_t begin = soup->first[face], end = soup->first[face + 1];
    const double *o = soup->positions + 3 * (size_t)soup->corners[begin];
    out[0] = out[1] = out[2] = 0;
    for (uint64_t c = begin + 1; c + 1 < end; c++) {
        const double *p = soup->positions + 3 * (size_t)soup->corners[c];
        const double *q = soup->positions + 3 * (size_t)soup->corners[c + 1];
        double u[3] = {p[0] - o[0], p[1] - o[1], p[2] - o[2]}, v[3] = {q[0] - o[0], q[1] - o[1], q[2] - o[2]};
        out[0] += u[1] * v[2] - u[2] * v[1];
        out[1] += u[2] * v[0] - u[0] * v[2];
        out[2] += u[0] * v[1] - u[1] * v[0];
    }
}

uint32_t *hewn_soup_corner_faces(const hewn_soup *soup)
{
    uint32_t *faces = hewn_alloc(hewn_soup_corner_count(soup), sizeof *faces);
    for (uint32_t f = 0; faces && f < soup->face_count; f++)
        for (uint64_t c = soup->first[f]; c < soup->first[f + 1]; c++)
            faces[c] = f;
    return faces;
}

/* --- disjoint sets ------------------------------------------------------------------------------------------------ */

uint32_t *hewn_sets_create(uint32_t count)
{
    uint32_t *parent = hewn_alloc(count, sizeof *parent);
    if (parent)
        number(parent, count);
    return parent;
}

/* Halves the path on the way: with the lowest member as root there is no choice by size, and the cost is still
 * logarithmic on average over any sequence (Tarjan and van Leeuwen 1984). */
uint32_t hewn_sets_find(uint32_t *parent, uint32_t item)
{
    while (parent[item] != item) {
        parent[item] = parent[parent[item]];
        item = parent[item];
    }
    return item;
}

bool hewn_sets_join(uint32_t *parent, uint32_t a, uint32_t b)
{
    a = hewn_sets_find(parent, a);
    b = hewn_sets_find(parent, b);
    if (a == b)
        return false;
    if (a < b)
        parent[b] = a;
    else
        parent[a] = b;
    return true;
}

void hewn_soup_join_faces(const hewn_soup *soup, uint32_t *parent)
{
    for (uint32_t f = 0; f < soup->face_count; f++)
        for (uint64_t c = soup->first[f] + 1; c < soup->first[f + 1]; c++)
            hewn_sets_join(parent, soup->corners[c - 1], soup->corners[c]);
}
