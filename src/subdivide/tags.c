#include "subdivide/tags.h"

#include <math.h>

static uint32_t find_edge(const sub_level *level, uint32_t a, uint32_t b)
{
    if (a >= level->verts || b >= level->verts)
        return HEWN_NONE;
    for (uint32_t i = level->vert_first[a]; i < level->vert_first[a + 1]; i++)
        if (sub_other(level, level->vert_edges[i], a) == b)
            return level->vert_edges[i];
    return HEWN_NONE;
}

static float clamp_sharpness(double sharpness)
{
    return sharpness >= (double)SHARP_FOREVER ? SHARP_FOREVER : (float)sharpness;
}

static hewn_result tag_creases(sub_level *level, const hewn_subdivide_desc *desc, hewn_error *error)
{
    for (uint64_t i = 0; i < desc->crease_count; i++) {
        const hewn_crease *crease = &desc->creases[i];
        uint32_t edge = find_edge(level, crease->verts[0], crease->verts[1]);
        if (!(crease->sharpness >= 0))
            return hewn_fail(error, HEWN_BAD_INPUT, "the sharpness of the crease from vertex %u to %u is %g",
                             crease->verts[0], crease->verts[1], crease->sharpness);
        if (edge == HEWN_NONE)
            return hewn_fail(error, HEWN_BAD_INPUT, "there is no edge from vertex %u to %u to be a crease",
                             crease->verts[0], crease->verts[1]);
        if (!sub_is_boundary(level, edge))
            level->edge_sharp[edge] = clamp_sharpness(crease->sharpness);
    }
    for (uint64_t i = 0; i < desc->corner_count; i++) {
        const hewn_corner_tag *corner = &desc->corners[i];
        if (corner->vert >= level->verts || !(corner->sharpness >= 0))
            return hewn_fail(error, HEWN_BAD_INPUT, "vertex %u cannot have a sharpness of %g, or is not there",
                             corner->vert, corner->sharpness);
        level->vert_sharp[corner->vert] = clamp_sharpness(corner->sharpness);
    }
    return HEWN_OK;
}

/* Newell's normal. */
static void face_normal(const sub_level *level, const double *positions, uint32_t corner, double n[3])
{
    uint32_t face = sub_face_of(level, corner), begin = sub_face_begin(level, face);
    const double *o = positions + 3 * (size_t)level->corner_verts[begin];
    n[0] = n[1] = n[2] = 0;
    for (uint32_t c = begin + 1; c + 1 < sub_face_begin(level, face + 1); c++) {
        const double *a = positions + 3 * (size_t)level->corner_verts[c];
        const double *b = positions + 3 * (size_t)level->corner_verts[c + 1];
        for (int i = 0; i < 3; i++) {
            int x = (i + 1) % 3, y = (i + 2) % 3;
            n[i] += (a[x] - o[x]) * (b[y] - o[y]) - (a[y] - o[y]) * (b[x] - o[x]);
        }
    }
}

static void tag_angles(sub_level *level, const double *positions, double degrees)
{
    for (uint32_t e = 0; e < level->edges; e++) {
        double a[3], b[3], dot = 0, across = 0;
        if (sub_is_boundary(level, e))
            continue;
        face_normal(level, positions, level->edge_corners[2 * (size_t)e], a);
        face_normal(level, positions, level->edge_corners[2 * (size_t)e + 1], b);
        for (int i = 0; i < 3; i++) {
            int x = (i + 1) % 3, y = (i + 2) % 3;
            double n = a[x] * b[y] - a[y] * b[x];
            dot += a[i] * b[i];
            across += n * n;
        }
        if (atan2(sqrt(across), dot) > degrees * (M_PI / 180))
            level->edge_sharp[e] = SHARP_FOREVER;
    }
}

hewn_result hewn_sub_tag(sub_level *level, const double *positions, const hewn_subdivide_desc *desc,
                         sub_tag_counts *counts, hewn_error *error)
{
    bool angles = desc->crease_angle > 0 && positions;
    if (angles || desc->crease_count > 0 || desc->corner_count > 0)
        HEWN_TRY(hewn_sub_level_sharpen(level, error));
    if (!level->edge_sharp)
        return HEWN_OK;
    if (angles)
        tag_angles(level, positions, desc->crease_angle);
    HEWN_TRY(tag_creases(level, desc, error));
    for (uint32_t e = 0; e < level->edges; e++)
        counts->creases += level->edge_sharp[e] > 0 && !sub_is_boundary(level, e);
    for (uint32_t v = 0; v < level->verts; v++) {
        counts->corners += level->vert_sharp[v] > 0;
        uint32_t begin = level->vert_first[v], valence = level->vert_first[v + 1] - begin;
        bool lone = valence == 2 && sub_is_boundary(level, level->vert_edges[begin]);
        if (lone && desc->boundary == HEWN_BOUNDARY_EDGE_AND_CORNER)
            level->vert_sharp[v] = SHARP_FOREVER;
    }
    return HEWN_OK;
}
