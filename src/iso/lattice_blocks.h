/* The lattice of a volume in blocks (volume/blocks.h): the signs of its blocks, which of them the surface passes, and
 * the rows of those. What is constant and far from the surface costs nothing, and no box is made dense; vertices and
 * triangles are the same at the same places as if it were.
 *
 * A block of the surface is one that has a crossed edge that starts in it, or an active cell. These are in the order of
 * their places: i fastest, then j, then k. Between two of them in a bar (the blocks of the same j and k) no row has
 * anything, so a row's numbers go on from one to the next. */
#ifndef HEWN_SRC_ISO_LATTICE_BLOCKS_H
#define HEWN_SRC_ISO_LATTICE_BLOCKS_H

#include "iso/lattice.h"
#include "volume/blocks.h"

/* Rows of samples (or cells) of a block: number j + 8 k. */
enum { HEWN_BLOCK_ROWS = HEWN_BLOCK * HEWN_BLOCK };

/* The first place of each row of a slice. */
#define HEWN_BLOCK_COLUMN ((uint64_t)0x0101010101010101u)

/* A block of the surface. `ahead`: the first one that lies no less far along i in the bars at (j + 1, k), (j, k + 1)
 * and (j + 1, k + 1). If it is not in that bar at all, there is nothing to be named in it. */
typedef struct hewn_lattice_block {
    uint32_t place[3];
    uint32_t ahead[3];
} hewn_lattice_block;

typedef uint64_t hewn_block_bits[HEWN_BLOCK]; /* of slices: bit i + 8 j */

typedef struct hewn_lattice_blocks {
    hewn_block_bits *inside; /* of the volume's blocks; not inside what is not in the volume */
    uint8_t *constants;      /* whether each constant is inside */
    hewn_lattice_block *surface;
    uint64_t count;
    uint64_t peak; /* bytes that were in use while the surface's blocks were found, with the volume's own */
    /* The slab's are these. */
    uint64_t first, end;
    hewn_lattice_row (*rows)[HEWN_BLOCK_ROWS];
} hewn_lattice_blocks;

/* The signs of the samples that cells of a block look at: slices of them, and of their neighbours along i, j and both.
 * And what of a block may have edges along each axis, and cells: all within the frame. */
typedef struct hewn_block_signs {
    uint64_t here[HEWN_BLOCK + 1], next_i[HEWN_BLOCK + 1], next_j[HEWN_BLOCK + 1], next_ij[HEWN_BLOCK + 1];
    uint64_t may_i, may_j; /* bits that have a neighbour */
    uint32_t may_k;        /* slices that do, a bit each */
    uint64_t in_i, in_j;   /* bits whose edges along other axes count: all but those in a rim that repeats */
    uint32_t in_k;
} hewn_block_signs;

void hewn_block_signs_load(const hewn_lattice *lattice, const uint32_t place[3], hewn_block_signs *out);

/* Edges of a slice that the surface crosses, by the axis that they run along. */
static inline uint64_t hewn_block_crossed(const hewn_block_signs *signs, uint32_t axis, uint32_t z)
{
    const uint64_t slice = signs->in_k >> z & 1 ? ~(uint64_t)0 : 0;
    if (axis == 0)
        return (signs->here[z] ^ signs->next_i[z]) & signs->may_i & signs->in_j & slice;
    if (axis == 1)
        return (signs->here[z] ^ signs->next_j[z]) & signs->may_j & signs->in_i & slice;
    return signs->may_k >> z & 1 ? (signs->here[z] ^ signs->here[z + 1]) & signs->in_i & signs->in_j : 0;
}

/* Active cells that start in a slice. */
static inline uint64_t hewn_block_active(const hewn_block_signs *signs, uint32_t z)
{
    const uint64_t any = signs->here[z] | signs->next_i[z] | signs->next_j[z] | signs->next_ij[z] | signs->here[z + 1] |
                         signs->next_i[z + 1] | signs->next_j[z + 1] | signs->next_ij[z + 1];
    const uint64_t all = signs->here[z] & signs->next_i[z] & signs->next_j[z] & signs->next_ij[z] & signs->here[z + 1] &
                         signs->next_i[z + 1] & signs->next_j[z + 1] & signs->next_ij[z + 1];
    return signs->may_k >> z & 1 ? any & ~all & signs->may_i & signs->may_j : 0;
}

/* As hewn_lattice_pattern(). */
static inline uint32_t hewn_block_pattern(const hewn_block_signs *signs, uint32_t z, uint32_t bit)
{
    uint32_t pattern = 0;
    for (uint32_t up = 0; up < 2; up++)
        pattern |= (uint32_t)((signs->here[z + up] >> bit & 1) | (signs->next_i[z + up] >> bit & 1) << 1 |
                              (signs->next_j[z + up] >> bit & 1) << 2 | (signs->next_ij[z + up] >> bit & 1) << 3)
                   << 4 * up;
    return pattern;
}

/* Where a block's first sample is in the frame, with the rim. May have wrapped around: what is before the frame is not
 * looked at. */
static inline void hewn_block_start(const hewn_lattice *lattice, const uint32_t place[3], uint32_t out[3])
{
    for (int axis = 0; axis < 3; axis++)
        out[axis] = HEWN_BLOCK * place[axis] - lattice->volume->blocks->lead[axis] + lattice->rim;
}

/* The slices of a block, counted in it, that are in [begin, end) of the frame. */
static inline void hewn_block_slices(const hewn_lattice *lattice, const hewn_lattice_block *block, uint32_t begin,
                                     uint32_t end, uint32_t out[2])
{
    const int64_t start = (int64_t)HEWN_BLOCK * block->place[2] - lattice->volume->blocks->lead[2] + lattice->rim;
    const int64_t lo = begin - start, hi = end - start;
    out[0] = lo > 0 ? (uint32_t)(lo < HEWN_BLOCK ? lo : HEWN_BLOCK) : 0;
    out[1] = hi < HEWN_BLOCK ? (uint32_t)(hi > 0 ? hi : 0) : HEWN_BLOCK;
}

/* Where the layer of blocks (of one k) that begins with block `first` ends, or the bar; at `end` in any case. */
static inline uint64_t hewn_block_layer_end(const hewn_lattice_blocks *blocks, uint64_t first, uint64_t end)
{
    uint64_t at = first + 1;
    while (at < end && blocks->surface[at].place[2] == blocks->surface[first].place[2])
        at++;
    return at;
}

static inline uint64_t hewn_block_bar_end(const hewn_lattice_blocks *blocks, uint64_t first, uint64_t layer_end)
{
    uint64_t at = first + 1;
    while (at < layer_end && blocks->surface[at].place[1] == blocks->surface[first].place[1])
        at++;
    return at;
}

static inline hewn_lattice_row *hewn_block_row(const hewn_lattice_blocks *blocks, uint64_t block, uint32_t y,
                                               uint32_t z)
{
    return &blocks->rows[block - blocks->first][y + HEWN_BLOCK * z];
}

/* The edges along an axis that begin or end in the rim, in a slice of a block of the surface, as bits. */
uint64_t hewn_block_rim_edges(const hewn_lattice *lattice, uint64_t block, uint32_t axis, uint32_t z);

/* Finds signs, and the blocks of the surface, for a lattice whose frame and threshold are known. HEWN_LIMIT where there
 * are so many that the mesh could not be numbered; HEWN_OUT_OF_MEMORY, also where they need more than desc->max_memory
 * (0: no limit); HEWN_CANCELLED. */
hewn_result hewn_lattice_blocks_create(hewn_lattice *lattice, const hewn_volume_extract_desc *desc, hewn_error *error);
void hewn_lattice_blocks_destroy(hewn_lattice *lattice);

/* Bytes that it takes without rows, and rows of the slices [begin, end) and the one after. */
uint64_t hewn_lattice_blocks_bytes(const hewn_lattice *lattice);
uint64_t hewn_lattice_blocks_row_bytes(const hewn_lattice *lattice, uint32_t begin, uint32_t end);

/* Makes room for the rows of lattice->begin to lattice->end. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_lattice_blocks_lay(hewn_lattice *lattice, hewn_error *error);

/* The stages, as those of iso/lattice.h. */
void hewn_lattice_blocks_count(hewn_lattice *lattice);
void hewn_lattice_blocks_emit_vertices(const hewn_lattice *lattice, hewn_triangles *out);
void hewn_lattice_blocks_emit_triangles(const hewn_lattice *lattice, hewn_triangles *out);

#endif
