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

/* Sample i along axis a is at origin[a] + cell * i, but the last one is at far[a] exactly. With a rim, which the dual
 * methods lay around an open grid, the first and the last layer of cells have no thickness: samples 0 and 1 are both at
 * the origin, and so on, and a mesh of vertices in cells ends on the bounds. */
struct hewn_grid {
    float origin[3];
    float far[3];
    float cell;
    HEWN_UINT cells[3];
    HEWN_UINT open; /* 1: samples on the bounds are what the field says; 0: they are outside */
    HEWN_UINT rim;  /* 1: the first and the last layer have no thickness */
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

/* Takes blocks back that a part of the grid does not need. Bricks are numbered in their order: by blocks of the top
 * level, x fastest, and within a block by its children. */
struct hewn_clip_push {
    HEWN_UINT dense[3]; /* as above */
    HEWN_UINT tested;
    HEWN_UINT top[3]; /* blocks of the top level */
    HEWN_UINT level;  /* the blocks', 0 is the top */
    HEWN_UINT below;  /* levels below that */
    HEWN_UINT begin;  /* the part's own bricks are those from `begin` */
    HEWN_UINT end;    /* up to before `end` */
    HEWN_UINTS parents;
    HEWN_UINTS states; /* blocks taken back become stand-ins, */
    HEWN_UINTS flags;  /* and 0 */
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
    HEWN_UINT pad;
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
    HEWN_UINTS vertices; /* out: brick (packed) and sample + 512 * axis + 2048 * brick, that in seven bits an axis, in
                            the first two words of each position */
    HEWN_UINTS indices;  /* out: slot, sample + 512 * pattern + 131072 * triangle in each triangle's first two words */
};

/* Where no side has more samples in its bricks (hewn_grid_bricks()), their coordinates fit seven bits each. */
#define HEWN_SHORT_SAMPLES 1024u

/* Vertices that an invocation solves one after the other. */
#define HEWN_VERTICES_EACH 16u

struct hewn_vertex_push {
    HEWN_GRID grid;
    HEWN_UINT count;
    HEWN_UINT dual;        /* 1: crossings are not the mesh's vertices, and need not keep away from grid points */
    HEWN_FLOATS positions; /* in: records; out: positions */
    HEWN_FLOATS normals;   /* out */
    HEWN_UINTS summary;    /* HEWN_SUMMARY_WORDS */
};

#define HEWN_SUMMARY_RESIDUAL 0u /* bits of the largest |f| / |grad f| in cells */
#define HEWN_SUMMARY_CAPS 1u     /* vertices on the bounds because the surface was cut there */
#define HEWN_SUMMARY_EDGES 2u    /* dual contouring: vertices on sharp edges, */
#define HEWN_SUMMARY_CORNERS 3u  /* at corners, */
#define HEWN_SUMMARY_PLANES 4u   /* planes found that no crossing had seen, */
#define HEWN_SUMMARY_LOST 5u     /* vertices still off the surface */
#define HEWN_SUMMARY_CUT 6u      /* not 0: loops ended before they were done, see shaders/iso/whole_loops.h */
#define HEWN_SUMMARY_WORDS 7u

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
    HEWN_UINT pad;
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
    HEWN_UINTS bricks;
    HEWN_UINTS links;
    HEWN_UINTS edges;
    HEWN_FLOATS positions; /* in: records; out: positions */
    HEWN_FLOATS normals;   /* out */
    HEWN_UINTS summary;
};

/* --- dual methods: vertices in cells ------------------------------------------------------------------------------ */

/* What is known of a word of 32 cells, as words at these places; so a cell's loop l is vertex
 * first + bits of `cells`, `low` and twice `high` below the cell's + l. */
#define HEWN_DUAL_CELLS 0u /* cells with surface */
#define HEWN_DUAL_LOW 1u   /* low binary digit of how many loops each has beyond one */
#define HEWN_DUAL_HIGH 2u
#define HEWN_DUAL_TURNED 3u /* cells whose doubtful face joins the inside: see hewn_dual_table */
#define HEWN_DUAL_FIRST 4u  /* number of the first vertex */
#define HEWN_DUAL_WORDS 5u
#define HEWN_BRICK_DUAL_WORDS 80u

/* Whose upper neighbour a brick is: link.comp's work turned around. */
struct hewn_dual_link_push {
    HEWN_UINT count;
    HEWN_UINT pad;
    HEWN_UINTS links;
    HEWN_UINTS lower; /* in: HEWN_ALL_OUTSIDE; out, three a brick: slot of the lower neighbour along each axis */
};

struct hewn_dual_classify_push {
    HEWN_UINT cells[3];
    HEWN_UINT count;
    HEWN_UINTS bricks;
    HEWN_UINTS links;
    HEWN_UINTS lower;
    HEWN_UINTS signs;
    HEWN_UINTS edges;           /* out: the masks, as in hewn_classify_push */
    HEWN_UINTS loops;           /* out: HEWN_BRICK_DUAL_WORDS a brick, but for HEWN_DUAL_FIRST */
    HEWN_UINTS crossing_counts; /* out, a brick */
    HEWN_UINTS vertex_counts;   /* out, a brick */
    HEWN_UINTS quad_counts;     /* out, a brick */
};

/* One record a crossing, a vertex and a quad, parked where the results will go. */
struct hewn_dual_spread_push {
    HEWN_UINT cells[3];
    HEWN_UINT count;
    HEWN_UINTS bricks;
    HEWN_UINTS links;
    HEWN_UINTS signs;
    HEWN_UINTS edges; /* in: the masks; out: the numbers of crossings */
    HEWN_UINTS loops; /* out: HEWN_DUAL_FIRST */
    HEWN_UINTS crossing_bases;
    HEWN_UINTS vertex_bases;
    HEWN_UINTS quad_bases;
    HEWN_UINTS points;    /* out: as `vertices` of hewn_spread_push */
    HEWN_UINTS positions; /* out: slot, sample + 512 * mask of the loop's edges, how many loops the cell has */
    HEWN_UINTS passed;    /* out, a vertex: that mask again, which stays */
    HEWN_UINTS indices;   /* out: slot, sample + 512 * axis + 2048 * whether the edge starts inside in the first two of
                             each quad's six words */
};

struct hewn_dual_vertex_push {
    HEWN_GRID grid;
    HEWN_UINT count;
    HEWN_UINT beyond; /* as in hewn_choose_push, of the blocks above bricks */
    HEWN_UINTS bricks;
    HEWN_UINTS links;
    HEWN_UINTS edges;
    HEWN_FLOATS points;        /* the crossings on grid edges, */
    HEWN_FLOATS point_normals; /* and the unit normals there */
    HEWN_FLOATS positions;     /* in: records; out: positions */
    HEWN_FLOATS normals;       /* out */
    HEWN_UINTS summary;
};

/* Questions of the host to the field, which places vertices on devices that share its memory. */
struct hewn_dual_asked_push {
    HEWN_GRID grid;
    HEWN_UINT count;
    HEWN_UINT beyond; /* as above */
    HEWN_UINTS bricks;
    HEWN_FLOATS questions; /* a place, and the slot of a brick near it as a word */
    HEWN_FLOATS answers;   /* out: the surface from there, as unit normal and how far off it is in cells */
    HEWN_UINTS summary;
};

struct hewn_dual_quad_push {
    HEWN_GRID grid;
    HEWN_UINT count;
    HEWN_UINT keep; /* HEWN_KEEP_ */
    HEWN_UINTS bricks;
    HEWN_UINTS links;
    HEWN_UINTS edges;
    HEWN_UINTS loops;
    HEWN_UINTS passed;
    HEWN_FLOATS points;
    HEWN_FLOATS positions;
    HEWN_UINTS indices;   /* in: records; out: two triangles a quad */
    HEWN_UINTS crossings; /* out, a quad: number of the crossing on its edge */
};

#define HEWN_KEEP_NONE 0u
#define HEWN_KEEP_ALL 1u
#define HEWN_KEEP_FANS 2u /* only where the quad is to be a fan, and the point is moved to the fan's middle */
#define HEWN_NO_FAN 0xFFFFFFFFu

/* Fans in the place of quads, see dual_fans.comp. */
struct hewn_dual_fan_push {
    HEWN_UINT count;    /* quads */
    HEWN_UINT makes;    /* 0: ranks become marks; 1: they are sums, and fans are made */
    HEWN_UINT vertices; /* before those of fans */
    HEWN_UINT pad;
    HEWN_UINTS crossings;
    HEWN_UINTS ranks;
    HEWN_FLOATS points;
    HEWN_FLOATS point_normals;
    HEWN_FLOATS positions;
    HEWN_FLOATS normals;
    HEWN_UINTS indices;
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
    HEWN_UINT pad;
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
