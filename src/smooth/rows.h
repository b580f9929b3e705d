/* Neighbourhoods as compressed rows: which vertices, and which triangles, lie around each vertex. */
#ifndef HEWN_SRC_SMOOTH_ROWS_H
#define HEWN_SRC_SMOOTH_ROWS_H

#include "base/error.h"
#include "hewn/mesh.h"

/* Row v is items[first[v]] to items[first[v + 1] - 1]. Owned. */
typedef struct smooth_rows {
    uint32_t count;
    uint32_t *first; /* count + 1 */
    uint32_t *items;
} smooth_rows;

void hewn_smooth_rows_free(smooth_rows *rows);

/* The vertices after and before a corner in its face. */
typedef struct smooth_side {
    uint32_t next, before;
} smooth_side;

/* The sides of the corners at each vertex, in rows of the same kind: items[first[v]] to items[first[v + 1] - 1]. Owned.
 */
typedef struct smooth_sides {
    uint32_t count;
    uint32_t *first; /* count + 1 */
    smooth_side *items;
} smooth_sides;

void hewn_smooth_sides_free(smooth_sides *sides);

/* What a vertex is. */
enum { SMOOTH_USED = 1 /* has a face */, SMOOTH_RIM = 2 /* an edge of it has not two faces */ };

/* The sides of corners, in the order of corners. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_smooth_sides_find(const hewn_polygons *polygons, smooth_sides *out, hewn_error *error);

/* The neighbours of each vertex along edges, without repetition, in an order that faces alone decide; `flags`, one a
 * vertex, are filled in. A vertex on a rim has only its neighbours along the rim, and none where these are not two.
 * HEWN_OUT_OF_MEMORY. */
hewn_result hewn_smooth_neighbours(const smooth_sides *sides, smooth_rows *out, uint8_t *flags, hewn_error *error);

/* The corners (positions in the list of corners) at each vertex, ascending. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_smooth_corners(const hewn_polygons *polygons, smooth_rows *out, hewn_error *error);

static inline uint64_t smooth_face_begin(const hewn_polygons *polygons, uint64_t face)
{
    return polygons->first ? polygons->first[face] : 3 * face;
}

#endif
