/* The next level of connections. All numbers follow from those of the parent, so every element is written by itself:
 * vertex v stays v, edge e becomes vertex verts + e and the edges 2e (at its first vertex) and 2e + 1, corner c gives
 * the inner edge 2 edges + c. Quadrilaterals: face f becomes vertex verts + edges + f, corner c the child face c.
 * Triangles: corner i of face f becomes the child face 4f + i, and 4f + 3 lies between them. */
#include <string.h>

#include "base/alloc.h"
#include "subdivide/sharp.h"

typedef struct refiner {
    const sub_level *from;
    sub_level *to;
    bool triangles;
} refiner;

/* --- room --------------------------------------------------------------------------------------------------------- */

static hewn_result allocate(const refiner *refine, bool edges, hewn_error *error)
{
    const sub_level *from = refine->from;
    sub_level *to = refine->to;
    uint64_t faces = refine->triangles ? 4 * (uint64_t)from->faces : from->corners;
    uint64_t corners = faces * (refine->triangles ? 3 : 4), edge_count = 2 * (uint64_t)from->edges + from->corners;
    uint64_t verts = (uint64_t)from->verts + from->edges + (refine->triangles ? 0 : from->faces);
    *to = (sub_level){.verts = (uint32_t)verts, .faces = (uint32_t)faces, .corners = (uint32_t)corners};
    to->sides = refine->triangles ? 3 : 4;
    to->edges = (uint32_t)edge_count;
    to->corner_verts = hewn_alloc(corners, sizeof(uint32_t));
    bool room = to->corner_verts != NULL;
    if (edges) {
        to->corner_edges = hewn_alloc(corners, sizeof(uint32_t));
        to->edge_verts = hewn_alloc(edge_count, 2 * sizeof(uint32_t));
        to->edge_corners = hewn_alloc(edge_count, 2 * sizeof(uint32_t));
        to->vert_first = hewn_alloc(verts + 1, sizeof(uint32_t));
        to->vert_edges = hewn_alloc(edge_count, 2 * sizeof(uint32_t));
        room = room && to->corner_edges && to->edge_verts && to->edge_corners && to->vert_first && to->vert_edges;
    }
    return room ? HEWN_OK
                : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a level of %llu faces",
                            (unsigned long long)faces);
}

/* --- faces -------------------------------------------------------------------------------------------------------- */

/* The child edge of `edge` that stays at vertex v. */
static inline uint32_t child_at(const sub_level *from, uint32_t edge, uint32_t v)
{
    return 2 * edge + (from->edge_verts[2 * (size_t)edge] != v);
}

static void fill_quads(const refiner *refine)
{
    const sub_level *from = refine->from;
    uint32_t edge_point = from->verts, face_point = from->verts + from->edges, inner = 2 * from->edges;
#pragma omp parallel for schedule(static)
    for (uint32_t c = 0; c < from->corners; c++) {
        uint32_t before = sub_prev(from, c), v = from->corner_verts[c];
        uint32_t leaving = from->corner_edges[c], arriving = from->corner_edges[before];
        uint32_t *verts = refine->to->corner_verts + 4 * (size_t)c;
        verts[0] = v;
        verts[1] = edge_point + leaving;
        verts[2] = face_point + sub_face_of(from, c);
        verts[3] = edge_point + arriving;
        if (!refine->to->corner_edges)
            continue;
        uint32_t *edges = refine->to->corner_edges + 4 * (size_t)c;
        edges[0] = child_at(from, leaving, v);
        edges[1] = inner + c;
        edges[2] = inner + before;
        edges[3] = child_at(from, arriving, v);
    }
}

static void fill_triangles(const refiner *refine)
{
    const sub_level *from = refine->from;
    uint32_t inner = 2 * from->edges;
#pragma omp parallel for schedule(static)
    for (uint32_t f = 0; f < from->faces; f++) {
        const uint32_t *v = from->corner_verts + 3 * (size_t)f, *e = from->corner_edges + 3 * (size_t)f;
        uint32_t *verts = refine->to->corner_verts + 12 * (size_t)f;
        for (uint32_t i = 0; i < 3; i++) {
            verts[3 * i] = v[i];
            verts[3 * i + 1] = from->verts + e[i];
            verts[3 * i + 2] = from->verts + e[(i + 2) % 3];
            verts[9 + i] = from->verts + e[i];
        }
        if (!refine->to->corner_edges)
            continue;
        uint32_t *edges = refine->to->corner_edges + 12 * (size_t)f;
        for (uint32_t i = 0; i < 3; i++) {
            edges[3 * i] = child_at(from, e[i], v[i]);
            edges[3 * i + 1] = inner + 3 * f + i;
            edges[3 * i + 2] = child_at(from, e[(i + 2) % 3], v[i]);
            edges[9 + i] = inner + 3 * f + (i + 1) % 3;
        }
    }
}

/* --- edges -------------------------------------------------------------------------------------------------------- */

static inline void set_edge(sub_level *to, uint32_t edge, uint32_t a, uint32_t b, uint32_t forth, uint32_t back)
{
    to->edge_verts[2 * (size_t)edge] = a;
    to->edge_verts[2 * (size_t)edge + 1] = b;
    to->edge_corners[2 * (size_t)edge] = forth;
    to->edge_corners[2 * (size_t)edge + 1] = back;
}

/* The k-th corner of the child face at a corner. */
static inline uint32_t child_corner(const refiner *refine, uint32_t corner, uint32_t k)
{
    return refine->triangles ? corner / 3 * 12 + corner % 3 * 3 + k : 4 * corner + k;
}

static void fill_edges(const refiner *refine)
{
    const sub_level *from = refine->from;
    uint32_t inner = 2 * from->edges, last = refine->triangles ? 2 : 3;
#pragma omp parallel for schedule(static)
    for (uint32_t e = 0; e < from->edges; e++) {
        const uint32_t *corner = from->edge_corners + 2 * (size_t)e, *vert = from->edge_verts + 2 * (size_t)e;
        bool open = corner[1] == HEWN_NONE;
        uint32_t at_back = open ? HEWN_NONE : child_corner(refine, sub_next(from, corner[1]), last);
        uint32_t at_ahead = open ? HEWN_NONE : child_corner(refine, corner[1], 0);
        set_edge(refine->to, 2 * e, vert[0], from->verts + e, child_corner(refine, corner[0], 0), at_back);
        set_edge(refine->to, 2 * e + 1, from->verts + e, vert[1], child_corner(refine, sub_next(from, corner[0]), last),
                 at_ahead);
    }
#pragma omp parallel for schedule(static)
    for (uint32_t c = 0; c < from->corners; c++) {
        uint32_t edge_point = from->verts + from->corner_edges[c];
        if (refine->triangles)
            set_edge(refine->to, inner + c, edge_point, from->verts + from->corner_edges[sub_prev(from, c)],
                     child_corner(refine, c, 1), c / 3 * 12 + 9 + (c + 2) % 3);
        else
            set_edge(refine->to, inner + c, edge_point, from->verts + from->edges + sub_face_of(from, c), 4 * c + 1,
                     4 * sub_next(from, c) + 2);
    }
}

/* --- rings -------------------------------------------------------------------------------------------------------- */

/* Counter-clockwise around the point of an edge, starting towards its second vertex: face of its first corner first. */
static uint32_t fill_edge_ring(const refiner *refine, uint32_t e, uint32_t *ring)
{
    const sub_level *from = refine->from;
    const uint32_t *corner = from->edge_corners + 2 * (size_t)e;
    uint32_t inner = 2 * from->edges, count = 0;
    ring[count++] = 2 * e + 1;
    for (int side = 0; side < 2 && corner[side] != HEWN_NONE; side++) {
        if (refine->triangles)
            ring[count++] = inner + sub_next(from, corner[side]);
        ring[count++] = inner + corner[side];
        if (side == 0)
            ring[count++] = 2 * e;
    }
    return count;
}

static void fill_rings(const refiner *refine)
{
    const sub_level *from = refine->from;
    sub_level *to = refine->to;
    uint32_t at = from->vert_first[from->verts], whole = refine->triangles ? 6 : 4, half = refine->triangles ? 4 : 3;
    memcpy(to->vert_first, from->vert_first, from->verts * sizeof(uint32_t));
    for (uint32_t e = 0; e < from->edges; e++) {
        to->vert_first[from->verts + e] = at;
        at += sub_is_boundary(from, e) ? half : whole;
    }
    for (uint32_t f = 0; f < from->faces && !refine->triangles; f++) {
        to->vert_first[from->verts + from->edges + f] = at;
        at += sub_face_begin(from, f + 1) - sub_face_begin(from, f);
    }
    to->vert_first[to->verts] = at;
#pragma omp parallel for schedule(static)
    for (uint32_t v = 0; v < from->verts; v++)
        for (uint32_t i = from->vert_first[v]; i < from->vert_first[v + 1]; i++)
            to->vert_edges[i] = child_at(from, from->vert_edges[i], v);
#pragma omp parallel for schedule(static)
    for (uint32_t e = 0; e < from->edges; e++)
        fill_edge_ring(refine, e, to->vert_edges + to->vert_first[from->verts + e]);
    if (refine->triangles)
        return;
#pragma omp parallel for schedule(static)
    for (uint32_t f = 0; f < from->faces; f++)
        for (uint32_t c = sub_face_begin(from, f), i = to->vert_first[from->verts + from->edges + f];
             c < sub_face_begin(from, f + 1); c++)
            to->vert_edges[i++] = 2 * from->edges + c;
}

/* --- sharpness ---------------------------------------------------------------------------------------------------- */

static hewn_result fill_sharpness(const refiner *refine, hewn_creasing creasing, hewn_error *error)
{
    const sub_level *from = refine->from;
    sub_level *to = refine->to;
    to->edge_sharp = hewn_alloc_zero(to->edges, sizeof(float));
    to->vert_sharp = hewn_alloc_zero(to->verts, sizeof(float));
    if (!to->edge_sharp || !to->vert_sharp)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a level of %u faces", to->faces);
#pragma omp parallel for schedule(static)
    for (uint32_t e = 0; e < from->edges; e++)
        for (uint32_t k = 0; k < 2 && from->edge_sharp[e] > 0; k++)
            to->edge_sharp[2 * (size_t)e + k] =
                hewn_sub_child_sharpness(from, e, from->edge_verts[2 * (size_t)e + k], creasing);
    for (uint32_t v = 0; v < from->verts; v++)
        to->vert_sharp[v] = sub_decrease(from->vert_sharp[v]);
    return HEWN_OK;
}

hewn_result hewn_sub_level_refine(const sub_level *from, bool triangles, bool edges, hewn_creasing creasing,
                                  sub_level *out, hewn_error *error)
{
    refiner refine = {from, out, triangles};
    *out = (sub_level){0};
    hewn_result result = allocate(&refine, edges, error);
    if (result == HEWN_OK && triangles)
        fill_triangles(&refine);
    else if (result == HEWN_OK)
        fill_quads(&refine);
    if (result == HEWN_OK && edges) {
        fill_edges(&refine);
        fill_rings(&refine);
        if (from->edge_sharp)
            result = fill_sharpness(&refine, creasing, error);
    }
    if (result != HEWN_OK)
        hewn_sub_level_free(out);
    return result;
}
