#include "mesh/check_faces.h"

#include <math.h>

#include "base/alloc.h"
#include "base/error.h"
#include "geom/predicates.h"

/* Faces of more corners than this are looked at by marking vertices instead of comparing all pairs. */
enum { SMALL_FACE = 32 };

static uint64_t least(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

/* --- input -------------------------------------------------------------------------------------------------------- */

hewn_result hewn_check_positions(const double *doubles, const float *floats, uint64_t vertex_count, hewn_error *error)
{
    const hewn_face_view view = {.doubles = doubles, .floats = floats};
    uint64_t bad = vertex_count;
    if (!doubles && !floats) /* callers have refused vertices without positions */
        return HEWN_OK;
#pragma omp parallel for schedule(static) reduction(min : bad) if (vertex_count >= HEWN_CHECK_ALONE)
    for (uint64_t v = 0; v < vertex_count; v++) {
        double p[3];
        hewn_face_view_point(&view, (uint32_t)v, p);
        if (!(isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2])))
            bad = least(bad, v);
    }
    if (bad < vertex_count) {
        double p[3];
        hewn_face_view_point(&view, (uint32_t)bad, p);
        return hewn_fail(error, HEWN_BAD_INPUT, "vertex %llu lies at (%g, %g, %g), which is not finite",
                         (unsigned long long)bad, p[0], p[1], p[2]);
    }
    return HEWN_OK;
}

hewn_result hewn_check_triangle_indices(const uint32_t *corners, uint64_t triangle_count, uint64_t vertex_count,
                                        hewn_error *error)
{
    uint64_t bad = triangle_count;
#pragma omp parallel for schedule(static) reduction(min : bad) if (triangle_count >= HEWN_CHECK_ALONE)
    for (uint64_t t = 0; t < triangle_count; t++) {
        const uint32_t *corner = corners + 3 * t;
        if (corner[0] >= vertex_count || corner[1] >= vertex_count || corner[2] >= vertex_count)
            bad = least(bad, t);
    }
    if (bad < triangle_count) {
        const uint32_t *corner = corners + 3 * bad;
        return hewn_fail(error, HEWN_BAD_INPUT, "triangle %llu has the corners %u, %u, %u, but there are %llu vertices",
                         (unsigned long long)bad, corner[0], corner[1], corner[2], (unsigned long long)vertex_count);
    }
    return HEWN_OK;
}

hewn_result hewn_face_view_of_triangles(const hewn_triangles *triangles, hewn_face_view *out, hewn_error *error)
{
    if ((triangles->vertex_count > 0 && !triangles->positions) ||
        (triangles->triangle_count > 0 && !triangles->indices))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "triangles without positions or indices");
    if (triangles->vertex_count > UINT32_MAX || triangles->triangle_count > UINT32_MAX / 3)
        return hewn_fail(error, HEWN_LIMIT, "%llu vertices and %llu triangles are more than can be examined",
                         (unsigned long long)triangles->vertex_count, (unsigned long long)triangles->triangle_count);
    *out = (hewn_face_view){.vertex_count = triangles->vertex_count,
                            .face_count = triangles->triangle_count,
                            .corner_count = 3 * triangles->triangle_count,
                            .floats = triangles->positions,
                            .corners = triangles->indices};
    HEWN_TRY(hewn_check_positions(NULL, out->floats, out->vertex_count, error));
    return hewn_check_triangle_indices(out->corners, out->face_count, out->vertex_count, error);
}

static hewn_result check_polygon_corners(const hewn_face_view *view, hewn_error *error)
{
    uint64_t count = view->corner_count, bad = count;
#pragma omp parallel for schedule(static) reduction(min : bad) if (count >= HEWN_CHECK_ALONE)
    for (uint64_t c = 0; c < count; c++)
        if (view->corners[c] >= view->vertex_count)
            bad = least(bad, c);
    if (bad == count)
        return HEWN_OK;
    uint64_t face = 0;
    while (view->first[face + 1] <= bad)
        face++;
    return hewn_fail(error, HEWN_BAD_INPUT, "face %llu names vertex %u, but there are %llu vertices",
                     (unsigned long long)face, view->corners[bad], (unsigned long long)view->vertex_count);
}

/* Whether the list of faces hangs together; `*triangles` where each has three corners. */
static hewn_result check_polygon_list(const hewn_polygons *polygons, bool *triangles, hewn_error *error)
{
    uint64_t faces = polygons->face_count;
    *triangles = true;
    if (polygons->vertex_count > UINT32_MAX || faces > UINT32_MAX)
        return hewn_fail(error, HEWN_LIMIT, "%llu vertices and %llu faces are more than can be examined",
                         (unsigned long long)polygons->vertex_count, (unsigned long long)faces);
    for (uint64_t f = 0; f < faces && polygons->first; f++) {
        if (polygons->first[f] > polygons->first[f + 1] || polygons->first[0] != 0)
            return hewn_fail(error, HEWN_BAD_INPUT, "face %llu does not begin where the one before it ends",
                             (unsigned long long)f);
        *triangles = *triangles && polygons->first[f + 1] - polygons->first[f] == 3;
    }
    uint64_t corners = polygons->first && faces > 0 ? polygons->first[faces] : 3 * faces;
    if (corners > UINT32_MAX)
        return hewn_fail(error, HEWN_LIMIT, "%llu faces with %llu corners are more than can be examined",
                         (unsigned long long)faces, (unsigned long long)corners);
    if ((polygons->vertex_count > 0 && !polygons->positions) || (corners > 0 && !polygons->corners))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "polygons without positions or corners");
    return HEWN_OK;
}

static bool is_collapsed(const hewn_face_view *view, uint64_t face, uint8_t *marks)
{
    const uint32_t *corners = view->corners + view->first[face];
    uint64_t length = view->first[face + 1] - view->first[face];
    bool found = length < 3;
    for (uint64_t i = 1; i < length && length <= SMALL_FACE; i++)
        for (uint64_t j = 0; j < i; j++)
            found = found || corners[i] == corners[j];
    if (length <= SMALL_FACE)
        return found;
    for (uint64_t i = 0; i < length && !found; i++) {
        found = marks[corners[i] / 8] >> corners[i] % 8 & 1;
        marks[corners[i] / 8] |= (uint8_t)(1u << corners[i] % 8);
    }
    for (uint64_t i = 0; i < length; i++)
        marks[corners[i] / 8] = 0;
    return found;
}

static hewn_result describe_polygons(const hewn_face_view *view, hewn_face_room *room, hewn_error *error)
{
    uint8_t *marks = hewn_alloc_zero(view->vertex_count / 8 + 1, 1);
    room->faces = hewn_alloc(view->corner_count, sizeof *room->faces);
    room->collapsed = hewn_alloc(view->face_count, sizeof *room->collapsed);
    if (!marks || !room->faces || !room->collapsed) {
        hewn_free(marks);
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %llu faces",
                         (unsigned long long)view->face_count);
    }
    for (uint64_t f = 0; f < view->face_count; f++) {
        room->collapsed[f] = is_collapsed(view, f, marks);
        for (uint64_t c = view->first[f]; c < view->first[f + 1]; c++)
            room->faces[c] = (uint32_t)f;
    }
    hewn_free(marks);
    return HEWN_OK;
}

hewn_result hewn_face_view_of_polygons(const hewn_polygons *polygons, hewn_face_view *out, hewn_face_room *owned,
                                       hewn_error *error)
{
    bool triangles = true;
    *owned = (hewn_face_room){0};
    HEWN_TRY(check_polygon_list(polygons, &triangles, error));
    *out =
        (hewn_face_view){.vertex_count = polygons->vertex_count,
                         .face_count = polygons->face_count,
                         .corner_count = triangles ? 3 * polygons->face_count : polygons->first[polygons->face_count],
                         .doubles = polygons->positions,
                         .corners = polygons->corners,
                         .first = triangles ? NULL : polygons->first};
    HEWN_TRY(hewn_check_positions(out->doubles, NULL, out->vertex_count, error));
    if (triangles)
        return hewn_check_triangle_indices(out->corners, out->face_count, out->vertex_count, error);
    HEWN_TRY(check_polygon_corners(out, error));
    hewn_result result = describe_polygons(out, owned, error);
    if (result != HEWN_OK)
        hewn_face_room_free(owned);
    out->faces = owned->faces;
    out->collapsed = owned->collapsed;
    return result;
}

void hewn_face_room_free(hewn_face_room *owned)
{
    hewn_free(owned->faces);
    hewn_free(owned->collapsed);
    *owned = (hewn_face_room){0};
}

/* --- single faces ------------------------------------------------------------------------------------------------- */

/* On one line in space is on one line (or point) in each coordinate plane. */
bool hewn_points_collinear(const double a[3], const double b[3], const double c[3])
{
    for (int axis = 0; axis < 3; axis++) {
        int u = (axis + 1) % 3, v = (axis + 2) % 3;
        if (hewn_orient2d((double[2]){a[u], a[v]}, (double[2]){b[u], b[v]}, (double[2]){c[u], c[v]}) != 0)
            return false;
    }
    return true;
}

bool hewn_face_degenerate(const hewn_face_view *view, uint64_t face)
{
    if (hewn_face_collapsed(view, face))
        return true;
    uint64_t begin = hewn_face_begin(view, face), end = hewn_face_begin(view, face + 1), other = begin + 1;
    double a[3], b[3], c[3];
    hewn_face_view_point(view, view->corners[begin], a);
    for (;; other++) { /* two places that span the line */
        if (other == end)
            return true;
        hewn_face_view_point(view, view->corners[other], b);
        if (a[0] != b[0] || a[1] != b[1] || a[2] != b[2])
            break;
    }
    for (uint64_t i = other + 1; i < end; i++) {
        hewn_face_view_point(view, view->corners[i], c);
        if (!hewn_points_collinear(a, b, c))
            return false;
    }
    return true;
}

uint64_t hewn_count_collapsed_faces(const hewn_face_view *view)
{
    uint64_t collapsed = 0;
#pragma omp parallel for schedule(static) reduction(+ : collapsed) if (view->face_count >= HEWN_CHECK_ALONE)
    for (uint64_t f = 0; f < view->face_count; f++)
        collapsed += hewn_face_collapsed(view, f);
    return collapsed;
}
