#include "iso/marching_cubes.h"

#include <assert.h>

#include "iso/cube.h"

#define NO_EDGE 12u

/* On every face the cuts are directed so that the inside lies to their right seen from outside the cell. Then each cut
 * edge has one cut that arrives and one that leaves, and `next` strings them into loops. */
static void cut_face(uint32_t pattern, uint32_t face, uint32_t next[12])
{
    uint32_t corner[4];
    hewn_cube_face_corners(face, corner);
    for (uint32_t i = 0; i < 4; i++) {
        uint32_t here = corner[i], after = corner[(i + 1) % 4];
        if (!(pattern >> here & 1) || (pattern >> after & 1))
            continue;
        /* A run of inside corners ends at `here`; walk back to where it began. Ambiguous faces have two runs of one. */
        uint32_t begin = i;
        while (pattern >> corner[(begin + 3) % 4] & 1)
            begin = (begin + 3) % 4;
        uint32_t leaving = hewn_cube_edge_between(here, after);
        uint32_t arriving = hewn_cube_edge_between(corner[(begin + 3) % 4], corner[begin]);
        next[arriving] = leaving;
    }
}

/* Cuts loop[first..last] into triangles; each diagonal must not lie in a face. Depth-first, so the first valid way is
 * taken. */
static bool triangulate(const uint32_t *loop, uint32_t first, uint32_t last, uint32_t *triangles, uint32_t *count)
{
    if (last - first < 2)
        return true;
    bool whole = first == 0 && loop[last + 1] == NO_EDGE;
    if (!whole && hewn_cube_edges_share_face(loop[first], loop[last]))
        return false;
    for (uint32_t middle = first + 1; middle < last; middle++) {
        uint32_t before = *count;
        assert(before < HEWN_MC_MAX_TRIANGLES);
        triangles[3 * before] = loop[first];
        triangles[3 * before + 1] = loop[middle];
        triangles[3 * before + 2] = loop[last];
        *count = before + 1;
        if (triangulate(loop, first, middle, triangles, count) && triangulate(loop, middle, last, triangles, count))
            return true;
        *count = before;
    }
    return false;
}

static uint32_t derive_pattern(uint32_t pattern, uint32_t triangles[3 * HEWN_MC_MAX_TRIANGLES])
{
    uint32_t next[12], count = 0;
    for (uint32_t edge = 0; edge < 12; edge++)
        next[edge] = NO_EDGE;
    for (uint32_t face = 0; face < 6; face++)
        cut_face(pattern, face, next);
    for (uint32_t edge = 0; edge < 12; edge++) {
        uint32_t loop[13], length = 0;
        for (uint32_t at = edge; next[at] != NO_EDGE;) {
            uint32_t after = next[at];
            next[at] = NO_EDGE;
            loop[length++] = at;
            at = after;
        }
        if (length == 0)
            continue;
        loop[length] = NO_EDGE;
        bool whole = triangulate(loop, 0, length - 1, triangles, &count);
        assert(whole);
        (void)whole;
    }
    return count;
}

void hewn_mc_table_derive(hewn_mc_table *out)
{
    *out = (hewn_mc_table){0};
    for (uint32_t pattern = 0; pattern < 256; pattern++) {
        uint32_t triangles[3 * HEWN_MC_MAX_TRIANGLES];
        uint32_t count = derive_pattern(pattern, triangles);
        out->words[pattern][0] = count;
        for (uint32_t i = 0; i < 3 * count; i++)
            out->words[pattern][1 + i / 6] |= triangles[i] << (16 * (i / 3 % 2) + 4 * (i % 3));
    }
}
