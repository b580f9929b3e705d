/* Vertex stars: the faces around each vertex, and what they say of its edges and of itself. Internal to the certificate
 * and the check. */
#ifndef HEWN_SRC_MESH_STAR_H
#define HEWN_SRC_MESH_STAR_H

#include "mesh/check_faces.h"

/* The corners at each vertex in compressed rows: those of vertex v are corners[first[v]] to corners[first[v + 1] - 1],
 * ascending. Corners of collapsed faces are in no row. */
typedef struct hewn_stars {
    uint32_t *first; /* vertex_count + 1 */
    uint32_t *corners;
    uint32_t longest; /* row */
} hewn_stars;

/* What a set of stars adds up to. Sums of integers, so any order gives the same. */
typedef struct hewn_star_counts {
    uint64_t used_vertices; /* with at least one face that has sides */
    uint64_t edges;         /* each counted at its lesser end, as the next four are */
    uint64_t boundary_edges;
    uint64_t non_manifold_edges;
    uint64_t unoriented_edges; /* two faces or more, and not as many of them one way as the other */
    uint64_t bent_edges;       /* those of them with two faces */
    uint64_t non_manifold_vertices;
} hewn_star_counts;

void hewn_star_counts_add(hewn_star_counts *sum, const hewn_star_counts *part);

/* Sorts corners into rows. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_stars_build(const hewn_face_view *view, hewn_stars *out, hewn_error *error);
void hewn_stars_free(hewn_stars *stars);

/* Adds what the star of each vertex v from begin to end - 1 says to counts[slots[v]]; without `slots` all to counts[0].
 * HEWN_OUT_OF_MEMORY. */
hewn_result hewn_stars_examine(const hewn_face_view *view, const hewn_stars *stars, uint64_t begin, uint64_t end,
                               const uint32_t *slots, hewn_star_counts *counts, hewn_error *error);

/* The same of all vertices of a mesh of triangles, without rows of all of them at once: they are made for a few
 * thousand vertices at a time, from the runs of triangles that name any of these. False in `*done`, with nothing
 * counted, where a run of triangles names vertices all over the mesh, so that the triangles would be read too often.
 * HEWN_OUT_OF_MEMORY, HEWN_CANCELLED. */
hewn_result hewn_stars_examine_ranges(const hewn_face_view *view, const char *stage, const hewn_progress *progress,
                                      hewn_star_counts *counts, bool *done, hewn_error *error);

/* --- one star, read closely --------------------------------------------------------------------------------------- */

/* A corner of a face at v is an arc of v's link, from the next vertex of the face (`tail`) to the one before (`head`).
 * It uses the edge v-tail outward and the edge v-head inward. */
typedef struct hewn_link_arc {
    uint32_t tail, head;
} hewn_link_arc;

/* Room for the arcs of one star, as long as its row. */
typedef struct hewn_star_room {
    hewn_link_arc *arcs;
    uint64_t *ends;   /* two an arc: neighbour << 32 | arc << 1 | is it the head */
    uint32_t *parent; /* of a union-find over arcs: those of one fan have one root */
} hewn_star_room;

/* HEWN_OUT_OF_MEMORY; to be freed in either case. */
hewn_result hewn_star_room_create(uint32_t length, hewn_star_room *out, hewn_error *error);
void hewn_star_room_free(hewn_star_room *room);

/* Reads the row of v. True where its arcs form one directed ring that meets each neighbour once (always false of long
 * rows): nothing is wrong there. Otherwise `ends` are sorted and `parent` made. */
bool hewn_star_read(const hewn_face_view *view, const hewn_stars *stars, uint32_t v, const hewn_star_room *room);
uint32_t hewn_star_fan(const hewn_star_room *room, uint32_t arc);

/* Adds what one star says, of its row, which is not empty. */
void hewn_star_examine(const hewn_face_view *view, const uint32_t *row, uint32_t length, uint32_t v,
                       const hewn_star_room *room, hewn_star_counts *counts);

/* Rows that have room in memory of the thread's own. */
enum { HEWN_STAR_SHORT = 256 };

static inline uint32_t hewn_star_length(const hewn_stars *stars, uint32_t v)
{
    return stars->first[v + 1ull] - stars->first[v];
}

#endif
