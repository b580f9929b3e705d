/* Polygon soups under repair: plain arrays in which nothing is promised but that indices are in range and positions
 * finite. The steps of hewn/repair.h, usable one by one; each adds to `report`. Not thread-safe for one soup. */
#ifndef HEWN_SRC_MESH_SOUP_H
#define HEWN_SRC_MESH_SOUP_H

#include "hewn/repair.h"

/* Face f has the corners corners[first[f]] to corners[first[f + 1] - 1]. Every element knows its number in the input,
 * HEWN_NONE where it is new. The capacities are in elements. */
typedef struct hewn_soup {
    uint32_t vertex_count;
    uint32_t face_count;
    double *positions; /* × 3 */
    uint32_t *vertex_origins;
    uint64_t *first; /* face_count + 1 */
    uint32_t *face_origins;
    uint8_t *turned; /* whether a face runs against its origin */
    uint32_t *corners;
    uint32_t *corner_origins;
    size_t position_capacity, vertex_capacity, first_capacity, face_capacity, turned_capacity, corner_capacity,
        corner_origin_capacity;
} hewn_soup;

/* --- soup.c ------------------------------------------------------------------------------------------------------ */

/* Copies and checks. HEWN_BAD_INPUT, HEWN_LIMIT, HEWN_OUT_OF_MEMORY as hewn_mesh_from_soup() says. */
hewn_result hewn_soup_create(const hewn_polygons *polygons, hewn_soup *out, hewn_error *error);
void hewn_soup_destroy(hewn_soup *soup);

static inline uint32_t hewn_soup_corner_count(const hewn_soup *soup)
{
    return (uint32_t)soup->first[soup->face_count];
}

/* The corner after `corner` in face f. */
static inline uint32_t hewn_soup_next(const hewn_soup *soup, uint32_t face, uint32_t corner)
{
    return corner + 1 < soup->first[face + 1] ? corner + 1 : (uint32_t)soup->first[face];
}

/* Room for that many elements more. HEWN_LIMIT past 32 bits, HEWN_OUT_OF_MEMORY. */
hewn_result hewn_soup_reserve(hewn_soup *soup, uint64_t vertices, uint64_t faces, uint64_t corners, hewn_error *error);

/* Appends into reserved room. */
uint32_t hewn_soup_add_vertex(hewn_soup *soup, const double position[3], uint32_t origin);
void hewn_soup_add_triangle(hewn_soup *soup, uint32_t a, uint32_t b, uint32_t c);

/* Keeps the faces whose mark is not 0, in order. */
void hewn_soup_keep_faces(hewn_soup *soup, const uint8_t *keep);

/* Reverses a face, and its mark; its first corner stays first. */
void hewn_soup_turn_face(hewn_soup *soup, uint32_t face);

/* Drops vertices without faces, the others keep their order. */
hewn_result hewn_soup_drop_isolated(hewn_soup *soup, hewn_repair_report *report, hewn_error *error);

/* The face's area vector times 2: normal to it, its length the area (Newell's sum about the first corner). */
void hewn_soup_face_normal(const hewn_soup *soup, uint32_t face, double out[3]);

/* The face of each corner, from the heap; NULL when out of memory. */
uint32_t *hewn_soup_corner_faces(const hewn_soup *soup);

/* Disjoint sets over small integers; the root of a set is its lowest member. */
uint32_t hewn_sets_find(uint32_t *parent, uint32_t item);
bool hewn_sets_join(uint32_t *parent, uint32_t a, uint32_t b); /* false where they were one already */
uint32_t *hewn_sets_create(uint32_t count);                    /* each alone; NULL when out of memory */

/* Joins the vertices of each face. */
void hewn_soup_join_faces(const hewn_soup *soup, uint32_t *parent);

/* --- weld.c, near.c ---------------------------------------------------------------------------------------------- */

hewn_result hewn_soup_weld(hewn_soup *soup, double distance, hewn_repair_report *report, hewn_error *error);

/* Joins the points (3 doubles each) of the lists a and b that lie within `distance` of each other, and those within a
 * list where b is NULL. Reorders the lists. Close to linear for any input. */
void hewn_near_join(const double *positions, double distance, uint32_t *a, size_t a_count, uint32_t *b, size_t b_count,
                    uint32_t *parent);

/* --- clean.c, duplicates.c --------------------------------------------------------------------------------------- */

/* In strict mode these and the next refuse with HEWN_BAD_INPUT instead of changing anything. */
hewn_result hewn_soup_clean(hewn_soup *soup, bool drop_flat, bool strict, hewn_repair_report *report,
                            hewn_error *error);
hewn_result hewn_soup_drop_duplicates(hewn_soup *soup, hewn_opposite opposite, bool strict, hewn_repair_report *report,
                                      hewn_error *error);

/* --- sides.c: half-edges of the soup, corner c being the one that leaves c for the next corner of its face ------- */

/* The half-edges grouped by edge: group g holds sides[group[g]] to sides[group[g + 1] - 1], ascending; groups are
 * ordered by the lower vertex, then by the higher. */
typedef struct hewn_sides {
    uint32_t count; /* groups: undirected edges */
    uint32_t *group;
    uint32_t *sides;
    uint32_t *faces; /* of each corner */
} hewn_sides;
hewn_result hewn_sides_build(const hewn_soup *soup, hewn_sides *out, hewn_error *error);
void hewn_sides_free(hewn_sides *sides);

/* The vertices of half-edge `side`. */
static inline uint32_t hewn_side_tail(const hewn_soup *soup, uint32_t side)
{
    return soup->corners[side];
}
static inline uint32_t hewn_side_head(const hewn_soup *soup, const hewn_sides *sides, uint32_t side)
{
    return soup->corners[hewn_soup_next(soup, sides->faces[side], side)];
}

/* --- orient.c ---------------------------------------------------------------------------------------------------- */

/* Turns faces so that as many as can be agree across edges of two faces. */
hewn_result hewn_soup_orient(hewn_soup *soup, bool strict, hewn_error *error);

/* Turns closed components outward. Needs a manifold soup. */
hewn_result hewn_soup_turn_outward(hewn_soup *soup, hewn_outward outward, hewn_repair_report *report,
                                   hewn_error *error);

/* --- pair.c, stitch.c -------------------------------------------------------------------------------------------- */

/* Pairs the half-edges of one edge, three or more, by angle; writes each one's partner or HEWN_NONE to mates. `items`
 * and `stack` have room for all of them. */
typedef struct hewn_pair_item {
    double angle;
    uint32_t side;
    bool forward; /* from the lower vertex to the higher */
} hewn_pair_item;
void hewn_soup_pair(const hewn_soup *soup, const hewn_sides *sides, uint32_t group, hewn_pair_item *items,
                    uint32_t *stack, uint32_t *mates);

/* Decides which half-edges are mates, and gives each vertex a copy for each further fan, so that afterwards no edge has
 * more than two faces and no vertex more than one fan. */
hewn_result hewn_soup_stitch(hewn_soup *soup, bool strict, hewn_repair_report *report, hewn_error *error);

/* --- islands.c, fill.c ------------------------------------------------------------------------------------------- */

/* Needs a manifold soup, as the next does. */
hewn_result hewn_soup_drop_islands(hewn_soup *soup, uint64_t least_faces, double least_share, bool strict,
                                   hewn_repair_report *report, hewn_error *error);
hewn_result hewn_soup_fill(hewn_soup *soup, uint32_t most_edges, bool flat, bool strict, const hewn_progress *progress,
                           hewn_repair_report *report, hewn_error *error);

/* --- soup_repair.c ----------------------------------------------------------------------------------------------- */

/* All of it, in the order that hewn/repair.h gives. `report` must not be NULL. */
hewn_result hewn_soup_repair(hewn_soup *soup, const hewn_repair_desc *desc, hewn_repair_report *report,
                             hewn_error *error);

#endif
