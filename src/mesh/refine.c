#include <math.h>

#include "base/alloc.h"
#include "base/error.h"
#include "mesh/hole.h"

/* A round splits each triangle at most once; flipping sweeps stop when nothing changes. */
enum { SPLIT_ROUNDS = 24, FLIP_SWEEPS = 16 };

static const double *position(const hewn_hole *hole, uint32_t vertex)
{
    return hole->positions + 3 * (size_t)vertex;
}

static uint32_t place_of(const hewn_patch_face *face, uint32_t vertex)
{
    return face->vertices[0] == vertex ? 0 : face->vertices[1] == vertex ? 1 : 2;
}

static uint32_t edge_towards(const hewn_patch_face *face, uint32_t other)
{
    return face->near[0] == other ? 0 : face->near[1] == other ? 1 : 2;
}

/* Across the edges that leave a, then across those that come in. */
bool hewn_hole_has_edge(const hewn_hole *hole, uint32_t face, uint32_t a, uint32_t b)
{
    if (a < hole->rim_count && b < hole->rim_count && hole->joined[(size_t)a * hole->rim_count + b])
        return true;
    for (uint32_t way = 0; way < 2; way++) {
        uint32_t at = face;
        do {
            const hewn_patch_face *f = hole->faces + at;
            uint32_t k = place_of(f, a);
            if (f->vertices[(k + 1) % 3] == b || f->vertices[(k + 2) % 3] == b)
                return true;
            at = f->near[way == 0 ? k : (k + 2) % 3];
        } while (at != HEWN_NONE && at != face);
    }
    return false;
}

/* --- splitting ---------------------------------------------------------------------------------------------------- */

static bool too_large(const hewn_hole *hole, uint32_t face, double centroid[3], double *spacing)
{
    const uint32_t *v = hole->faces[face].vertices;
    *spacing = (hole->spacing[v[0]] + hole->spacing[v[1]] + hole->spacing[v[2]]) / 3;
    for (int axis = 0; axis < 3; axis++)
        centroid[axis] = (position(hole, v[0])[axis] + position(hole, v[1])[axis] + position(hole, v[2])[axis]) / 3;
    for (int k = 0; k < 3; k++) {
        const double *p = position(hole, v[k]);
        double d[3] = {p[0] - centroid[0], p[1] - centroid[1], p[2] - centroid[2]};
        double reach = sqrt(2 * (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]));
        if (!(reach > *spacing && reach > hole->spacing[v[k]]))
            return false;
    }
    return true;
}

static hewn_result make_room(hewn_hole *hole, hewn_error *error)
{
    void *positions = hole->positions, *spacing = hole->spacing, *faces = hole->faces;
    size_t vertices = (size_t)hole->vertex_count + 1, triangles = (size_t)hole->face_count + 2;
    hewn_result result = hewn_reserve(&positions, &hole->position_capacity, vertices, 3 * sizeof(double), error);
    hole->positions = positions;
    if (result == HEWN_OK)
        result = hewn_reserve(&spacing, &hole->spacing_capacity, vertices, sizeof(double), error);
    hole->spacing = spacing;
    if (result == HEWN_OK)
        result = hewn_reserve(&faces, &hole->face_capacity, triangles, sizeof *hole->faces, error);
    hole->faces = faces;
    return result;
}

/* Puts a vertex into a face: three faces, the first in its place, face k keeping the old edge k. */
static hewn_result split_face(hewn_hole *hole, uint32_t face, const double centroid[3], double spacing,
                              hewn_error *error)
{
    HEWN_TRY(make_room(hole, error));
    uint32_t vertex = hole->vertex_count++;
    for (int axis = 0; axis < 3; axis++)
        hole->positions[3 * (size_t)vertex + axis] = centroid[axis];
    hole->spacing[vertex] = spacing;
    hewn_patch_face old = hole->faces[face];
    const uint32_t parts[3] = {face, hole->face_count, hole->face_count + 1};
    hole->face_count += 2;
    for (int k = 0; k < 3; k++) {
        hole->faces[parts[k]] = (hewn_patch_face){{old.vertices[k], old.vertices[(k + 1) % 3], vertex},
                                                  {old.near[k], parts[(k + 1) % 3], parts[(k + 2) % 3]}};
        if (k > 0 && old.near[k] != HEWN_NONE) {
            hewn_patch_face *other = hole->faces + old.near[k];
            other->near[edge_towards(other, face)] = parts[k];
        }
    }
    return HEWN_OK;
}

/* --- flipping ----------------------------------------------------------------------------------------------------- */

/* The cosine and sine (times a common length) of the angle at vertex c over the edge a, b. */
static void angle_at(const hewn_hole *hole, uint32_t c, uint32_t a, uint32_t b, double *cosine, double *sine)
{
    const double *o = position(hole, c), *p = position(hole, a), *q = position(hole, b);
    double normal[3];
    *cosine = (p[0] - o[0]) * (q[0] - o[0]) + (p[1] - o[1]) * (q[1] - o[1]) + (p[2] - o[2]) * (q[2] - o[2]);
    *sine = hewn_hole_normal(hole, c, a, b, normal);
}

/* Whether the angles opposite to an edge sum to more than half a turn, and the faces after the flip look the same way
 * as those before. */
static bool flip_helps(const hewn_hole *hole, uint32_t a, uint32_t b, uint32_t c, uint32_t d)
{
    double cos_c, sin_c, cos_d, sin_d;
    angle_at(hole, c, a, b, &cos_c, &sin_c);
    angle_at(hole, d, a, b, &cos_d, &sin_d);
    double sum = cos_c * sin_d + sin_c * cos_d;
    if (!(sum < -1e-9 * (fabs(cos_c * sin_d) + fabs(sin_c * cos_d))))
        return false;
    double before[2][3], after[2][3];
    hewn_hole_normal(hole, a, b, c, before[0]);
    hewn_hole_normal(hole, b, a, d, before[1]);
    hewn_hole_normal(hole, a, d, c, after[0]);
    hewn_hole_normal(hole, d, b, c, after[1]);
    double dots[2] = {0, 0};
    for (int axis = 0; axis < 3; axis++)
        for (int k = 0; k < 2; k++)
            dots[k] += (before[0][axis] + before[1][axis]) * after[k][axis];
    return dots[0] > 0 && dots[1] > 0;
}

static void point_back(hewn_hole *hole, uint32_t face, uint32_t from, uint32_t to)
{
    if (face != HEWN_NONE)
        hole->faces[face].near[edge_towards(hole->faces + face, from)] = to;
}

/* Turns edge k of a face, if that is allowed and helps. */
static bool try_flip(hewn_hole *hole, uint32_t face, uint32_t k)
{
    uint32_t other = hole->faces[face].near[k];
    if (other == HEWN_NONE || other < face)
        return false;
    hewn_patch_face *f = hole->faces + face, *g = hole->faces + other;
    uint32_t j = edge_towards(g, face);
    uint32_t a = f->vertices[k], b = f->vertices[(k + 1) % 3], c = f->vertices[(k + 2) % 3],
             d = g->vertices[(j + 2) % 3];
    if (c == d || !flip_helps(hole, a, b, c, d) || hewn_hole_has_edge(hole, face, c, d))
        return false;
    uint32_t bc = f->near[(k + 1) % 3], ca = f->near[(k + 2) % 3], ad = g->near[(j + 1) % 3], db = g->near[(j + 2) % 3];
    *f = (hewn_patch_face){{a, d, c}, {ad, other, ca}};
    *g = (hewn_patch_face){{d, b, c}, {db, bc, face}};
    point_back(hole, ad, other, face);
    point_back(hole, bc, face, other);
    return true;
}

static void flip_edges(hewn_hole *hole)
{
    bool changed = true;
    for (int sweep = 0; changed && sweep < FLIP_SWEEPS; sweep++) {
        changed = false;
        for (uint32_t f = 0; f < hole->face_count; f++)
            for (uint32_t k = 0; k < 3; k++)
                changed |= try_flip(hole, f, k);
    }
}

hewn_result hewn_hole_refine(hewn_hole *hole, hewn_error *error)
{
    uint32_t most = hole->rim_count + hole->rim_count * hole->rim_count / 4 + 16;
    flip_edges(hole);
    for (int round = 0; round < SPLIT_ROUNDS; round++) {
        uint32_t faces = hole->face_count;
        for (uint32_t f = 0; f < faces && hole->vertex_count < most; f++) {
            double centroid[3], spacing;
            if (too_large(hole, f, centroid, &spacing))
                HEWN_TRY(split_face(hole, f, centroid, spacing, error));
        }
        if (hole->face_count == faces)
            break;
        flip_edges(hole);
    }
    return HEWN_OK;
}
