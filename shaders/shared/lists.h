/* What the kernels that make lists of instructions level by level share with their host. A tested block's choices take
 * (n + 15) / 16 words, n being the length of its parent's list. */
#ifndef HEWN_SHADERS_SHARED_LISTS_H
#define HEWN_SHADERS_SHARED_LISTS_H

#include "shared/iso.h"

/* Culls, and notes what the lists of the blocks that are kept will hold: four blocks an invocation. */
struct hewn_choose_push {
    HEWN_GRID grid;
    HEWN_UINT size;
    HEWN_UINT dense[3]; /* the top level tests all of these blocks; elsewhere 0 */
    HEWN_UINT tested;
    HEWN_UINT beyond;         /* cells around each block for which its list is good too */
    HEWN_UINTS parents;       /* packed coordinates */
    HEWN_UINTS parent_ranges; /* of their lists; none on the top level, where it is the whole field's */
    HEWN_UINTS states;        /* out, a block tested: a stand-in, or 0 where it is kept */
    HEWN_UINTS flags;         /* out, a block tested: 1 where it is kept */
    HEWN_UINTS choices;       /* out */
};

/* Lists the blocks that are kept, and where they stood among those tested. */
struct hewn_gather_push {
    HEWN_UINT dense[3];
    HEWN_UINT tested;
    HEWN_UINTS parents;
    HEWN_UINTS states;  /* out: the block's place in the list where it is kept */
    HEWN_UINTS ranks;   /* the flags, summed */
    HEWN_UINTS kept;    /* out: packed coordinates */
    HEWN_UINTS origins; /* out, a kept block: its number among those tested */
};

/* Counts the instructions of the lists of the blocks that are kept, or writes them. */
struct hewn_keep_push {
    HEWN_UINT dense; /* 1 on the top level */
    HEWN_UINT write;
    HEWN_UINTS kept; /* how many blocks are kept */
    HEWN_UINTS parent_ranges;
    HEWN_UINTS origins;
    HEWN_UINTS places; /* out when counting: the lengths; in when writing: their sums, and the total */
    HEWN_UINTS choices;
    HEWN_UINTS lists;  /* out */
    HEWN_UINTS ranges; /* out, a kept block: first instruction and count */
};

/* Solves vertices, four an invocation, eight invocations a brick. */
struct hewn_listed_vertex_push {
    HEWN_GRID grid;
    HEWN_UINT count; /* bricks */
    HEWN_UINT vertex_count;
    HEWN_UINT dual;       /* as in hewn_vertex_push */
    HEWN_UINT first_turn; /* of a brick's vertices those that are solved in these turns, 32 in each */
    HEWN_UINT turns;
    HEWN_UINT pad;
    HEWN_UINTS bricks;
    HEWN_UINTS vertex_bases;
    HEWN_FLOATS positions; /* in: records; out: positions */
    HEWN_FLOATS normals;   /* out */
    HEWN_UINTS summary;    /* HEWN_SUMMARY_WORDS */
};

#endif
