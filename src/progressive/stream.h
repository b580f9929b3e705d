/* A progressive mesh in memory: what comes with the base and with each split, in the order of the stream.
 *
 * A wedge is a vertex with one set of values of its corners' attributes; triangles have wedges at their corners. */
#ifndef HEWN_SRC_PROGRESSIVE_STREAM_H
#define HEWN_SRC_PROGRESSIVE_STREAM_H

#include "base/error.h"
#include "hewn/progressive.h"

/* Corner `corner` (3 × triangle + 0 to 2) goes from a wedge of the parent, `before`, to one of the new vertex. */
typedef struct progressive_change {
    uint32_t corner, before, after;
} progressive_change;

/* What a split adds, as the numbers that there are before it. */
typedef struct progressive_split {
    uint32_t parent; /* vertex */
    uint32_t first_wedge, first_triangle, first_change;
    float error; /* how far the surface here may be from the input's without it: an estimate, a length */
} progressive_split;

struct hewn_progressive {
    hewn_model shape; /* no vertices and no faces: names and kinds of channels, unit and axes */
    bool corner_values;
    uint32_t row[3]; /* bytes that a vertex, corner and face have of channels, by domain */

    uint64_t full_vertices, full_wedges, full_triangles, full_splits, faces, corners; /* of the whole */
    uint32_t base_vertices, base_wedges, base_triangles;

    /* What is there, and the room for it. */
    size_t vertex_count, wedge_count, triangle_count, split_count, change_count;
    size_t vertex_room, wedge_room, triangle_room, split_room, change_room;
    double *positions;
    unsigned char *vertex_rows;
    uint32_t *wedge_vertices;
    unsigned char *wedge_rows;
    uint32_t *triangles; /* 3 wedges each, as they are when it comes */
    unsigned char *triangle_rows;
    progressive_split *splits;
    progressive_change *changes;

    /* The input's own order, once all is there. */
    bool complete;
    uint32_t *vertex_origins;
    uint32_t *triangle_origins; /* NULL where there are polygons */
    bool polygons;
    uint64_t *polygon_first; /* faces + 1 */
    uint32_t *polygon_wedges;
    unsigned char *polygon_rows;

    hewn_progressive_mark *marks;
    uint32_t mark_count;
};

/* Makes room for so many more of each; HEWN_OUT_OF_MEMORY, HEWN_LIMIT past 2^32 - 2. */
hewn_result hewn_progressive_grow(hewn_progressive *to, size_t vertices, size_t wedges, size_t triangles,
                                  hewn_error *error);
hewn_result hewn_progressive_grow_splits(hewn_progressive *to, size_t splits, size_t changes, hewn_error *error);

/* Takes kinds and names of channels, unit and axes of a model, and finds the rows' sizes. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_progressive_take_shape(hewn_progressive *to, const hewn_model *model, hewn_error *error);
void hewn_progressive_find_rows(hewn_progressive *to);

/* Copies element `index` of a model's channels of a domain to a row, and back. */
void hewn_progressive_row_get(const hewn_model *model, hewn_domain domain, uint64_t index, unsigned char *row);
void hewn_progressive_row_put(hewn_model *model, hewn_domain domain, uint64_t index, const unsigned char *row);

/* The model of the triangles that are marked, with these wedges at all triangles' corners, in the order of the stream;
 * vertices that they do not use are left out. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_progressive_gather(const hewn_progressive *from, const uint32_t *wedges, const uint8_t *marked,
                                    hewn_model *out, hewn_error *error);

/* How many there are of each after so many splits. */
static inline uint32_t progressive_triangles_at(const hewn_progressive *from, uint64_t splits)
{
    return splits < from->split_count ? from->splits[splits].first_triangle : (uint32_t)from->triangle_count;
}

static inline uint32_t progressive_wedges_at(const hewn_progressive *from, uint64_t splits)
{
    return splits < from->split_count ? from->splits[splits].first_wedge : (uint32_t)from->wedge_count;
}

static inline uint32_t progressive_changes_at(const hewn_progressive *from, uint64_t splits)
{
    return splits < from->split_count ? from->splits[splits].first_change : (uint32_t)from->change_count;
}

#endif
