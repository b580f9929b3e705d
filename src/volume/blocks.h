/* Samples in blocks: what an OpenVDB grid holds, for volumes that are mostly constant. Where there is a block of
 * 8 x 8 x 8 it has all its samples, i fastest; everything else is constant over cubes of 8, 128 or 4096 samples.
 *
 * Sample (i, j, k) stands at the place (i, j, k) + lead of the lattice that blocks are cut from, so blocks begin where
 * they do in the file. Three levels of tables lead from a place to what is there: one entry for each cube of 4096, for
 * each 128 in one of those, for each 8 in one of those. An entry is the number of a constant, or that of a table of the
 * next level, or of a block.
 *
 * All of it is one piece of memory that may be moved, and be read by another process: it holds no pointers. */
#ifndef HEWN_SRC_VOLUME_BLOCKS_H
#define HEWN_SRC_VOLUME_BLOCKS_H

#include "hewn/volume.h"

enum {
    HEWN_BLOCK = 8,
    HEWN_BLOCK_SAMPLES = HEWN_BLOCK * HEWN_BLOCK * HEWN_BLOCK,
    HEWN_LOWER = 16, /* entries along a side of the lowest table, and of that above it */
    HEWN_UPPER = 32,
    HEWN_LOWER_SPAN = HEWN_BLOCK * HEWN_LOWER, /* samples along a side of what they speak for */
    HEWN_UPPER_SPAN = HEWN_LOWER_SPAN * HEWN_UPPER,
    HEWN_LOWER_ENTRIES = HEWN_LOWER * HEWN_LOWER * HEWN_LOWER,
    HEWN_UPPER_ENTRIES = HEWN_UPPER * HEWN_UPPER * HEWN_UPPER
};

struct hewn_blocks {
    uint64_t bytes;    /* of all, with this head */
    uint32_t lead[3];  /* the place of sample (0, 0, 0), 1 to 4096 */
    uint32_t roots[3]; /* cubes of 4096 along each axis; the last sample is not at their end */
    uint64_t block_count, constant_count, upper_count, lower_count;
    /* Where arrays begin, in bytes from here: constants, samples of the volume's type; how many samples of the volume
     * each of these stands for, uint64_t; blocks' places divided by 8, three uint32_t each; entries of the three
     * levels, i fastest; samples. */
    uint64_t constants, weights, places, root, uppers, lowers, samples;
};

#define HEWN_BLOCKS_ARRAY(blocks, type, array) ((const type *)(const void *)((const char *)(blocks) + (blocks)->array))

/* An entry is a number times two, and one more where it is not that of a constant. */
static inline bool hewn_entry_leads_on(uint32_t entry)
{
    return entry & 1;
}

static inline uint32_t hewn_entry_of(const uint32_t *entries, uint32_t side, uint32_t x, uint32_t y, uint32_t z)
{
    return entries[x + side * (y + side * z)];
}

/* The entry of a cube of 4096, by its place in cubes; one beyond the last is background. */
static inline uint32_t hewn_blocks_root(const hewn_blocks *blocks, uint32_t x, uint32_t y, uint32_t z)
{
    if (x >= blocks->roots[0] || y >= blocks->roots[1] || z >= blocks->roots[2])
        return 0;
    return HEWN_BLOCKS_ARRAY(blocks, uint32_t,
                             root)[x + (uint64_t)blocks->roots[0] * (y + (uint64_t)blocks->roots[1] * z)];
}

/* The entry of a cube of 128, by its place in such cubes: of a constant, or of a table of blocks. */
static inline uint32_t hewn_blocks_upper(const hewn_blocks *blocks, uint32_t x, uint32_t y, uint32_t z)
{
    uint32_t entry = hewn_blocks_root(blocks, x / HEWN_UPPER, y / HEWN_UPPER, z / HEWN_UPPER);
    if (!hewn_entry_leads_on(entry))
        return entry;
    const uint32_t *table = HEWN_BLOCKS_ARRAY(blocks, uint32_t, uppers) + (uint64_t)(entry >> 1) * HEWN_UPPER_ENTRIES;
    return hewn_entry_of(table, HEWN_UPPER, x % HEWN_UPPER, y % HEWN_UPPER, z % HEWN_UPPER);
}

/* The entry of a cube of 8, by its place in such cubes: of a constant, or of a block. Numbers that wrapped around are
 * beyond the last. */
static inline uint32_t hewn_blocks_find(const hewn_blocks *blocks, uint32_t x, uint32_t y, uint32_t z)
{
    uint32_t entry = hewn_blocks_upper(blocks, x / HEWN_LOWER, y / HEWN_LOWER, z / HEWN_LOWER);
    if (!hewn_entry_leads_on(entry))
        return entry;
    const uint32_t *table = HEWN_BLOCKS_ARRAY(blocks, uint32_t, lowers) + (uint64_t)(entry >> 1) * HEWN_LOWER_ENTRIES;
    return hewn_entry_of(table, HEWN_LOWER, x % HEWN_LOWER, y % HEWN_LOWER, z % HEWN_LOWER);
}

/* Where sample (i, j, k) of a volume in blocks is: in an array of samples of its type, and at which number there. */
static inline const void *hewn_blocks_sample(const hewn_blocks *blocks, const uint32_t at[3], uint64_t *number)
{
    const uint32_t x = at[0] + blocks->lead[0], y = at[1] + blocks->lead[1], z = at[2] + blocks->lead[2];
    const uint32_t entry = hewn_blocks_find(blocks, x / HEWN_BLOCK, y / HEWN_BLOCK, z / HEWN_BLOCK);
    *number = entry >> 1;
    if (!hewn_entry_leads_on(entry))
        return HEWN_BLOCKS_ARRAY(blocks, char, constants);
    *number =
        *number * HEWN_BLOCK_SAMPLES + x % HEWN_BLOCK + HEWN_BLOCK * (y % HEWN_BLOCK + HEWN_BLOCK * (z % HEWN_BLOCK));
    return HEWN_BLOCKS_ARRAY(blocks, char, samples);
}

/* --- making them -------------------------------------------------------------------------------------------------- */

/* Blocks to be: tables on the heap that grow. */
typedef struct hewn_blocks_plan {
    uint32_t dims[3];
    int64_t first[3]; /* in the file's lattice: the place (0, 0, 0), a multiple of 4096 */
    hewn_voxel type;
    hewn_blocks head; /* offsets are set by hewn_blocks_finish() */
    uint32_t *root, *uppers, *lowers, *places;
    char *constants;
    size_t upper_room, lower_room, place_room, constant_room;
} hewn_blocks_plan;

/* For the samples of `volume` (dims and type), of which (0, 0, 0) is at `origin` in the file's lattice, all of them
 * `background`, a sample. Clear it in any case. HEWN_LIMIT, HEWN_OUT_OF_MEMORY. */
hewn_result hewn_blocks_begin(const hewn_volume *volume, const int32_t origin[3], const void *background,
                              hewn_blocks_plan *out, hewn_error *error);

/* A cube of 8, 128 or 4096 samples at a multiple of that is constant. Larger cubes come before what is within them.
 * What is not in the volume is passed over. HEWN_BAD_INPUT where it does not begin at such a multiple, or something is
 * within it already; HEWN_OUT_OF_MEMORY. */
hewn_result hewn_blocks_add_constant(hewn_blocks_plan *plan, const int32_t origin[3], uint32_t side, const void *sample,
                                     hewn_error *error);

/* There is a block at a multiple of 8; its number is how many came before it. `*added`: it is in the volume.
 * HEWN_BAD_INPUT where it does not begin at such a multiple, or there is one already; HEWN_OUT_OF_MEMORY. */
hewn_result hewn_blocks_add_block(hewn_blocks_plan *plan, const int32_t origin[3], bool *added, hewn_error *error);

/* Whether a block at a multiple of 8 has samples of the volume. */
bool hewn_blocks_hold(const hewn_blocks_plan *plan, const int32_t origin[3]);

/* What all will take. */
uint64_t hewn_blocks_bytes(const hewn_blocks_plan *plan);

/* Writes all but the samples of blocks into so many bytes, aligned to 64; returns where samples go. */
void *hewn_blocks_finish(const hewn_blocks_plan *plan, void *memory);

void hewn_blocks_clear(hewn_blocks_plan *plan);

/* --- reading them ------------------------------------------------------------------------------------------------- */

/* Samples of a block that are in the volume, from `lo` up to before `hi` along each axis. */
void hewn_block_within(const hewn_volume *volume, uint64_t block, uint32_t lo[3], uint32_t hi[3]);

#endif
