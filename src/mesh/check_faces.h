/* A view of the faces that are examined, whatever they came as, and the first things to know of them. */
#ifndef HEWN_SRC_MESH_CHECK_FACES_H
#define HEWN_SRC_MESH_CHECK_FACES_H

#include "geom/triangle_view.h"
#include "hewn/mesh.h"

/* Below this many vertices or faces, waking other threads costs more than it saves. */
enum { HEWN_CHECK_ALONE = 1 << 14 };

/* Faces over shared vertices, positions where they are. A face that names a vertex twice, or has fewer than three
 * corners, is collapsed: it has no sides and takes no part in edges, vertices and components. The arrays from `first`
 * to `collapsed` are NULL where all faces are triangles. */
typedef struct hewn_face_view {
    uint64_t vertex_count, face_count, corner_count;
    const double *doubles; /* vertex_count × 3 */
    const float *floats;   /* the same, where doubles is NULL */
    const uint32_t *corners;
    const uint64_t *first;    /* face_count + 1 */
    const uint32_t *faces;    /* of each corner */
    const uint8_t *collapsed; /* one a face */
} hewn_face_view;

static inline bool hewn_triangle_collapsed(const uint32_t *corner)
{
    return corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0];
}

static inline bool hewn_face_collapsed(const hewn_face_view *view, uint64_t face)
{
    return view->first ? view->collapsed[face] : hewn_triangle_collapsed(view->corners + 3 * face);
}

static inline uint64_t hewn_face_begin(const hewn_face_view *view, uint64_t face)
{
    return view->first ? view->first[face] : 3 * face;
}

static inline uint32_t hewn_corner_face(const hewn_face_view *view, uint32_t corner)
{
    return view->first ? view->faces[corner] : corner / 3;
}

static inline uint32_t hewn_corner_after(const hewn_face_view *view, uint32_t corner)
{
    if (!view->first)
        return corner % 3 == 2 ? corner - 2 : corner + 1;
    uint32_t face = view->faces[corner];
    return corner + 1ull < view->first[face + 1ull] ? corner + 1 : (uint32_t)view->first[face];
}

static inline uint32_t hewn_corner_before(const hewn_face_view *view, uint32_t corner)
{
    if (!view->first)
        return corner % 3 == 0 ? corner + 2 : corner - 1;
    uint32_t face = view->faces[corner];
    return corner > view->first[face] ? corner - 1 : (uint32_t)view->first[face + 1ull] - 1;
}

static inline void hewn_face_view_point(const hewn_face_view *view, uint32_t vertex, double out[3])
{
    hewn_triangle_view mesh = {.doubles = view->doubles, .floats = view->floats};
    hewn_triangle_point(&mesh, vertex, out);
}

/* --- input: HEWN_BAD_INPUT, naming the first offender ------------------------------------------------------------- */

hewn_result hewn_check_positions(const double *doubles, const float *floats, uint64_t vertex_count, hewn_error *error);
hewn_result hewn_check_triangle_indices(const uint32_t *corners, uint64_t triangle_count, uint64_t vertex_count,
                                        hewn_error *error);

/* A view of triangles. HEWN_INVALID_ARGUMENT for a missing array, HEWN_LIMIT for 2^32 or more corners or vertices;
 * positions and indices are checked. */
hewn_result hewn_face_view_of_triangles(const hewn_triangles *triangles, hewn_face_view *out, hewn_error *error);

/* The same of polygons; `owned` are the arrays that it had to make. Polygons that are all triangles are seen as such.
 * HEWN_OUT_OF_MEMORY. */
typedef struct hewn_face_room {
    uint32_t *faces;
    uint8_t *collapsed;
} hewn_face_room;
hewn_result hewn_face_view_of_polygons(const hewn_polygons *polygons, hewn_face_view *out, hewn_face_room *owned,
                                       hewn_error *error);
void hewn_face_room_free(hewn_face_room *owned);

/* --- single faces ------------------------------------------------------------------------------------------------- */

/* Whether all points of a triangle lie on one line, exactly. */
bool hewn_points_collinear(const double a[3], const double b[3], const double c[3]);

/* Whether a face is degenerate: collapsed, or all its corners on one line. Exact. */
bool hewn_face_degenerate(const hewn_face_view *view, uint64_t face);

uint64_t hewn_count_collapsed_faces(const hewn_face_view *view);

#endif
