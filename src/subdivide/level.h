/* One level of refinement: who meets whom, and what is sharp. */
#ifndef HEWN_SRC_SUBDIVIDE_LEVEL_H
#define HEWN_SRC_SUBDIVIDE_LEVEL_H

#include "base/error.h"
#include "hewn/subdivide.h"

/* Sharp for ever. */
static const float SHARP_FOREVER = 10;

/* Corners, and edges from both sides, are numbered by 32 bits, a few of which mean something else. */
#define SUB_MOST_NUMBERS 0xFFFFFFF0u

/* A corner c of a face is at the vertex corner_verts[c], and corner_edges[c] is the edge from there to the next corner.
 *
 * Edge e runs from edge_verts[2e] to edge_verts[2e + 1]. edge_corners[2e] is the corner whose edge it is in that
 * direction, edge_corners[2e + 1] the one in the other, HEWN_NONE at a boundary (never the first).
 *
 * The edges of vertex v are vert_edges[vert_first[v]] and on, counter-clockwise; at a boundary from one end of the fan
 * to the other. The last level may be without edges. */
typedef struct sub_level {
    uint32_t verts, edges, faces, corners;
    uint32_t sides;  /* of every face; 0 where they differ */
    uint32_t *first; /* faces + 1; only where sides is 0, as is the next */
    uint32_t *corner_face;
    uint32_t *corner_verts, *corner_edges;
    uint32_t *edge_verts, *edge_corners;
    uint32_t *vert_first, *vert_edges;
    float *edge_sharp, *vert_sharp; /* NULL where nothing is sharp; boundary edges are SHARP_FOREVER */
} sub_level;

void hewn_sub_level_free(sub_level *level);

/* The control mesh as level 0. The errors of hewn_mesh_from_polygons(). */
hewn_result hewn_sub_level_create(const hewn_polygons *polygons, sub_level *out, hewn_error *error);

/* Makes room for tags, all zero but boundaries. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_sub_level_sharpen(sub_level *level, hewn_error *error);

/* The next level; without edges where it is the last and nobody asks for them. HEWN_LIMIT, HEWN_OUT_OF_MEMORY. */
hewn_result hewn_sub_level_refine(const sub_level *from, bool triangles, bool edges, hewn_creasing creasing,
                                  sub_level *out, hewn_error *error);

static inline uint32_t sub_face_of(const sub_level *level, uint32_t corner)
{
    return level->sides == 4 ? corner / 4 : level->sides == 3 ? corner / 3 : level->corner_face[corner];
}

static inline uint32_t sub_face_begin(const sub_level *level, uint32_t face)
{
    return level->sides ? level->sides * face : level->first[face];
}

static inline uint32_t sub_next(const sub_level *level, uint32_t corner)
{
    if (level->sides == 4)
        return (corner & ~3u) | ((corner + 1) & 3u);
    if (level->sides == 3)
        return corner % 3 == 2 ? corner - 2 : corner + 1;
    uint32_t face = level->corner_face[corner];
    return corner + 1 < level->first[face + 1] ? corner + 1 : level->first[face];
}

static inline uint32_t sub_prev(const sub_level *level, uint32_t corner)
{
    if (level->sides == 4)
        return (corner & ~3u) | ((corner + 3) & 3u);
    if (level->sides == 3)
        return corner % 3 == 0 ? corner + 2 : corner - 1;
    uint32_t face = level->corner_face[corner];
    return corner > level->first[face] ? corner - 1 : level->first[face + 1] - 1;
}

/* The other end of an edge of v. */
static inline uint32_t sub_other(const sub_level *level, uint32_t edge, uint32_t v)
{
    return level->edge_verts[2 * (size_t)edge] == v ? level->edge_verts[2 * (size_t)edge + 1]
                                                    : level->edge_verts[2 * (size_t)edge];
}

static inline bool sub_is_boundary(const sub_level *level, uint32_t edge)
{
    return level->edge_corners[2 * (size_t)edge + 1] == HEWN_NONE;
}

#endif
