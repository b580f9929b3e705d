/* The layout that the extraction's kernels and their host share.
 *
 * A grid has cells[a] cells and cells[a] + 1 samples along axis a. A brick owns 8 x 8 x 8 samples, the cells above them
 * and the edges that leave them upward. A sample in a brick is numbered x + 8 y + 64 z; word w of a brick's 16 sign
 * words holds samples 32 w to 32 w + 31. A brick's coordinates are packed ten bits an axis. A slot is a brick's place
 * in the list of active bricks. */
#ifndef HEWN_SHADERS_SHARED_ISO_H
#define HEWN_SHADERS_SHARED_ISO_H

#include "shared/types.h"

#define HEWN_BRICK_WORDS 16u
#define HEWN_BRICK_EDGE_WORDS 48u
#define HEWN_BRICK_LINKS 8u
#define HEWN_LEVEL_RATIO 4u
#define HEWN_MAX_LEVELS 5u

/* Stand-ins for a slot where a brick holds no surface. */
#define HEWN_ALL_OUTSIDE 0xFFFFFFFEu
#define HEWN_ALL_INSIDE 0xFFFFFFFFu

/* Sample i along axis a is at origin[a] + cell * i, but the last one is at far[a] exactly. */
struct hewn_grid {
    float origin[3];
    float far[3];
    float cell;
    HEWN_UINT cells[3];
    HEWN_UINT open; /* 1: samples on the bounds are what the field says; 0: they are outside */
};

#ifdef GL_core_profile
#define HEWN_GRID hewn_grid
#else
#define HEWN_GRID struct hewn_grid
#endif

/* One level of culling: blocks of `size` cells, the children of the blocks that the level above kept. */
struct hewn_cull_push {
    HEWN_GRID grid;
    HEWN_UINT size;
    HEWN_UINT dense[3]; /* the top level tests all of these blocks; elsewhere 0 */
    HEWN_UINTS parents; /* packed coordinates */
    HEWN_UINTS tested;  /* how many blocks there are to test */
    HEWN_UINTS states;  /* out, a block tested: a stand-in, or 0 where it is kept */
    HEWN_UINTS flags;   /* out, a block tested: 1 where it is kept */
};

/* Turns kept blocks into the list for the next level. */
struct hewn_compact_push {
    HEWN_UINT dense[3];
    HEWN_UINT pad;
    HEWN_UINTS parents;
    HEWN_UINTS states;  /* in: as above; out: the block's place in the list where it is kept */
    HEWN_UINTS ranks;   /* the flags, summed */
    HEWN_UINTS control; /* see below */
    HEWN_UINTS kept;    /* out: packed coordinates */
};

/* What the device knows of a level: 32-bit words at these places. The levels' words follow each other, so a level also
 * writes the next one's. */
#define HEWN_CONTROL_TESTED 0u   /* blocks tested at this level */
#define HEWN_CONTROL_KEPT 2u     /* two words: blocks kept */
#define HEWN_CONTROL_DISPATCH 4u /* three words: workgroups that test this level */
#define HEWN_CONTROL_WORDS 8u

struct hewn_link_push {
    HEWN_UINT top[3]; /* blocks of the top level */
    HEWN_UINT levels;
    HEWN_UINT count; /* active bricks */
    HEWN_UINT pad;
    HEWN_UINTS bricks; /* packed coordinates of the active bricks */
    HEWN_UINTS links;  /* out, eight a brick: slot of the neighbour at (k & 1, k >> 1 & 1, k >> 2 & 1), or a stand-in */
    HEWN_UINTS states[HEWN_MAX_LEVELS]; /* coarsest first */
};

struct hewn_sign_push {
    HEWN_GRID grid;
    HEWN_UINT count;
    HEWN_UINTS bricks;
    HEWN_UINTS signs; /* out: 16 words a brick */
};

struct hewn_classify_push {
    HEWN_UINT cells[3];
    HEWN_UINT count;
    HEWN_UINTS bricks;
    HEWN_UINTS links;
    HEWN_UINTS signs;
    HEWN_UINTS edges; /* out, pair 16 * axis + word of 48 a brick: which edges cross, number of the first's vertex */
    HEWN_UINTS vertex_counts;   /* out, a brick */
    HEWN_UINTS triangle_counts; /* out, a brick */
};

/* Spreads the work out: one record a vertex and one a triangle, parked where the results will go. */
struct hewn_spread_push {
    HEWN_UINT cells[3];
    HEWN_UINT count;
    HEWN_UINTS bricks;
    HEWN_UINTS links;
    HEWN_UINTS signs;
    HEWN_UINTS edges; /* in: the masks; out: the numbers of vertices */
    HEWN_UINTS vertex_bases;
    HEWN_UINTS triangle_bases;
    HEWN_UINTS vertices; /* out: slot and 512 * axis + sample in the first two words of each position */
    HEWN_UINTS indices;  /* out: slot, sample + 512 * pattern + 131072 * triangle in each triangle's first two words */
};

struct hewn_vertex_push {
    HEWN_GRID grid;
    HEWN_UINT count;
    HEWN_UINTS bricks;
    HEWN_FLOATS positions; /* in: records; out: positions */
    HEWN_FLOATS normals;   /* out */
    HEWN_UINTS summary;    /* HEWN_SUMMARY_WORDS */
};

#define HEWN_SUMMARY_RESIDUAL 0u /* bits of the largest |f| / |grad f| in cells */
#define HEWN_SUMMARY_CAPS 1u     /* vertices on the bounds because the surface was cut there */
#define HEWN_SUMMARY_WORDS 2u

struct hewn_triangle_push {
    HEWN_UINT count;
    HEWN_UINT pad;
    HEWN_UINTS links;
    HEWN_UINTS edges;
    HEWN_UINTS indices; /* in: records; out: indices */
};

/* --- the trilinear interpolant's topology ------------------------------------------------------------------------- */

/* Finds the cells whose values decide how they are cut: counts them, and once the counts are summed lists them. */
struct hewn_mc33_ask_push {
    HEWN_UINT cells[3];
    HEWN_UINT count;
    HEWN_UINT lists; /* 0: counts, 1: lists */
    HEWN_UINT pad;
    HEWN_UINTS bricks;
    HEWN_UINTS links;
    HEWN_UINTS signs;
    HEWN_UINTS table; /* hewn_mc33_table */
    HEWN_UINTS ranks; /* a brick: how many; in the second run: how many in those before it */
    HEWN_UINTS asked; /* out: slot and sample + 512 * pattern of each */
};

struct hewn_mc33_decide_push {
    HEWN_GRID grid;
    HEWN_UINT count; /* cells that are asked */
    HEWN_UINTS bricks;
    HEWN_UINTS table;
    HEWN_UINTS asked; /* in: as above; out: the first word is the place of the record in the table */
};

struct hewn_mc33_count_push {
    HEWN_UINT cells[3];
    HEWN_UINT count;
    HEWN_UINTS bricks;
    HEWN_UINTS links;
    HEWN_UINTS signs;
    HEWN_UINTS table;
    HEWN_UINTS ranks;
    HEWN_UINTS asked;
    HEWN_UINTS triangle_counts; /* out, a brick */
    HEWN_UINTS centre_counts;   /* out, a brick: vertices in cells */
};

struct hewn_mc33_spread_push {
    HEWN_UINT cells[3];
    HEWN_UINT count;
    HEWN_UINTS bricks;
    HEWN_UINTS links;
    HEWN_UINTS signs;
    HEWN_UINTS edges;
    HEWN_UINTS table;
    HEWN_UINTS ranks;
    HEWN_UINTS asked;
    HEWN_UINTS vertex_bases;
    HEWN_UINTS triangle_bases;
    HEWN_UINTS centre_bases;
    HEWN_UINTS vertices; /* out: as in hewn_spread_push; in a cell slot and sample + 512 * description (hewn_patch) */
    HEWN_UINTS indices;  /* out: slot, sample + 512 * corners of four bits, the cell's first vertex */
    HEWN_UINT first;     /* number of the first vertex in a cell: they follow those on edges */
    HEWN_UINT pad;
};

struct hewn_mc33_centre_push {
    HEWN_GRID grid;
    HEWN_UINT count;
    HEWN_UINT first;
    HEWN_UINT pad;
    HEWN_UINTS bricks;
    HEWN_UINTS links;
    HEWN_UINTS edges;
    HEWN_FLOATS positions; /* in: records; out: positions */
    HEWN_FLOATS normals;   /* out */
    HEWN_UINTS summary;
};

/* --- features thinner than a cell --------------------------------------------------------------------------------- */

/* A brick's blocks of 2 x 2 x 2 cells in two words, bit x + 4 y + 16 z of the two. */
struct hewn_cut_push {
    HEWN_UINT cells[3];
    HEWN_UINT count;
    HEWN_UINTS bricks;
    HEWN_UINTS links;
    HEWN_UINTS signs;
    HEWN_UINTS cuts; /* out: the blocks with surface */
};

struct hewn_remote_push {
    HEWN_UINT top[3]; /* as in hewn_link_push */
    HEWN_UINT levels;
    HEWN_UINT count;
    HEWN_UINT pad;
    HEWN_UINTS bricks;
    HEWN_UINTS cuts;
    HEWN_UINTS remote; /* out: the blocks beyond the neighbourhood of the surface, and of the grid */
    HEWN_UINTS states[HEWN_MAX_LEVELS];
};

struct hewn_suspect_push {
    HEWN_GRID grid;
    HEWN_UINT count;
    HEWN_UINTS bricks;
    HEWN_UINTS signs;
    HEWN_UINTS remote;
    HEWN_UINTS marks;  /* out: suspects, 16 words a brick, two for each of its blocks of 4 x 4 x 4 cells at (k & 1,
                          k >> 1 & 1, k >> 2 & 1); in Morton's order, x y z from the lowest bit of each digit up */
    HEWN_UINTS counts; /* HEWN_SUSPECT_WORDS */
};

/* Each two words, the lower one first. */
#define HEWN_SUSPECT_CELLS 0u
#define HEWN_SUSPECT_UNDEFINED 2u
#define HEWN_SUSPECT_WORDS 4u

#endif
