/* The triangles of marching cubes with the topology of the trilinear interpolant, for every configuration of a cell;
 * derived, not listed.
 *
 * A configuration is
 * - the pattern of corner signs, bit c set where corner c is inside;
 * - at each ambiguous face (two inside corners across a diagonal) whether the inside is joined across it: the
 *   asymptotic decider (Nielson and Hamann 1991), inside where the product of the inside values is the greater;
 * - the join within the cell, if there is one: see hewn_mc33_join.
 *
 * Everything 0 counts as just outside: corners, face saddles and body saddles. That is the surface of the level set a
 * hair below 0, which is a manifold whatever the values are.
 *
 * The faces' decisions give directed cuts and these give closed loops, as in marching cubes. The loops part the cell's
 * surface into regions that are wholly inside or outside, and these are a tree with the loops as its edges. Without a
 * join each loop bounds a disc. A join connects two regions of one sign through the cell; the two loops between them
 * then bound an annulus. More cannot happen (see docs/extraction.md).
 *
 * Why the mesh is a closed 2-manifold for any samples and any decisions, provided that both cells of a face see the
 * same decision there: the two cells draw the same cuts on their face, in opposite directions, so each cut has exactly
 * two triangles. All other edges of a patch run through the inside of one cell, where they have two triangles too: no
 * chord lies in a face, and no two chords of a cell join the same vertices. Around a vertex on a grid edge, the patches
 * of the four cells form one ring, since each of them passes the vertex with one fan. */
#ifndef HEWN_SRC_ISO_MC33_H
#define HEWN_SRC_ISO_MC33_H

#include "hewn/base.h"
#include "iso/patch.h"

/* Which two regions are joined within the cell. Level slices change linearly along z in each of their corners, so the
 * slice's decider is a quadratic in z; where two regions are joined only within the cell, it is at its extremum that
 * the slice's corners of one diagonal, which lie on edges of those two regions, are joined across the slice. Diagonal 0
 * joins the upright edges over corners 0 and 3, diagonal 1 those over corners 1 and 2. */
typedef enum hewn_mc33_join {
    HEWN_MC33_NO_JOIN,
    HEWN_MC33_OUTSIDE_0,
    HEWN_MC33_INSIDE_0,
    HEWN_MC33_OUTSIDE_1,
    HEWN_MC33_INSIDE_1,
    HEWN_MC33_JOINS
} hewn_mc33_join;

/* The patch of a configuration. `joined`: bit f set where the inside is joined across face f; only ambiguous faces
 * matter. */
void hewn_mc33_patch(uint32_t pattern, uint32_t joined, hewn_mc33_join join, hewn_patch *out);

/* Faces of a pattern that are ambiguous, as bits. */
uint32_t hewn_mc33_ambiguous(uint32_t pattern);

/* The table as shaders read it. Word p is the head of pattern p: the place of a record in bits 0 to 15, ambiguous faces
 * in bits 16 to 21; where bit 31 is set, values decide, and the place is that of a list with the places of records,
 * HEWN_MC33_JOINS for each combination of decisions at the ambiguous faces (lowest face, lowest bit).
 *
 * A record's first word is its number of triangles, and of vertices in the cell in bits 8 and up. Then follow, two to a
 * word, those vertices as in hewn_patch; then, two to a word, the triangles, four bits a corner. */
typedef struct hewn_mc33_table {
    uint32_t *words;
    uint32_t count;
} hewn_mc33_table;

#define HEWN_MC33_DECIDES 0x80000000u

/* HEWN_OUT_OF_MEMORY. */
hewn_result hewn_mc33_table_derive(hewn_mc33_table *out, hewn_error *error);
void hewn_mc33_table_destroy(hewn_mc33_table *table);

#endif
