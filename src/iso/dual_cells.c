#include "iso/dual_cells.h"

#include <assert.h>

#include "iso/cube.h"

#define NO_EDGE 12u

typedef struct cut {
    uint32_t from, to;
} cut;

/* The cuts on a face around its inside corners, which are its runs: from where the way around the face enters one to
 * where it leaves it. Two cuts are there only where the face is ambiguous. */
static uint32_t cut_face(uint32_t pattern, uint32_t face, cut cuts[2])
{
    uint32_t corner[4], count = 0;
    hewn_cube_face_corners(face, corner);
    for (uint32_t last = 0; last < 4; last++) {
        uint32_t after = corner[(last + 1) % 4], first = last;
        if (!(pattern >> corner[last] & 1) || (pattern >> after & 1))
            continue;
        while (pattern >> corner[(first + 3) % 4] & 1)
            first = (first + 3) % 4;
        cuts[count++] = (cut){hewn_cube_edge_between(corner[(first + 3) % 4], corner[first]),
                              hewn_cube_edge_between(corner[last], after)};
    }
    return count;
}

void hewn_dual_cell_derive(uint32_t pattern, uint32_t turned, hewn_dual_cell *out)
{
    *out = (hewn_dual_cell){0};
    for (uint32_t edge = 0; edge < 12; edge++)
        out->next[edge] = NO_EDGE;
    for (uint32_t face = 0; face < 6; face++) {
        cut cuts[2];
        uint32_t count = cut_face(pattern, face, cuts);
        /* Joined inside: each cut goes around an outside corner, from one inside corner's beginning to the other's end.
         */
        uint32_t other = count == 2 && (turned >> face & 1) ? 1 : 0;
        for (uint32_t i = 0; i < count; i++)
            out->next[cuts[i].from] = cuts[i ^ other].to;
    }
    uint32_t seen = 0;
    for (uint32_t edge = 0; edge < 12; edge++) {
        if (out->next[edge] == NO_EDGE || (seen >> edge & 1))
            continue;
        assert(out->loop_count < HEWN_DUAL_MOST_LOOPS);
        uint32_t loop = 0;
        for (uint32_t at = edge; !(loop >> at & 1); at = out->next[at])
            loop |= 1u << at;
        seen |= loop;
        out->edges[out->loop_count++] = loop;
    }
}

uint32_t hewn_dual_doubtful_face(uint32_t pattern)
{
    hewn_dual_cell cell;
    hewn_dual_cell_derive(pattern, 0, &cell);
    for (uint32_t face = 0; face < 6; face++) {
        cut cuts[2];
        if (cut_face(pattern, face, cuts) < 2)
            continue;
        for (uint32_t i = 0; i < cell.loop_count; i++)
            if ((cell.edges[i] >> cuts[0].from & 1) && (cell.edges[i] >> cuts[1].from & 1))
                return face;
    }
    return HEWN_DUAL_NO_FACE;
}

void hewn_dual_table_derive(hewn_dual_table *out)
{
    *out = (hewn_dual_table){0};
    for (uint32_t entry = 0; entry < 512; entry++) {
        uint32_t pattern = entry / 2, face = hewn_dual_doubtful_face(pattern), *words = out->words[entry];
        hewn_dual_cell cell;
        hewn_dual_cell_derive(pattern, entry % 2 && face != HEWN_DUAL_NO_FACE ? 1u << face : 0, &cell);
        words[0] = cell.loop_count | face << 4;
        for (uint32_t loop = 0; loop < cell.loop_count; loop++)
            words[1 + loop / 2] |= cell.edges[loop] << 16 * (loop % 2);
    }
}
