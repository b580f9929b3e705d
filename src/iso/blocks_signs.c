/* Which samples of blocks are inside, and which blocks the surface passes. */
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/order.h"
#include "base/progress.h"
#include "iso/lattice_blocks.h"

/* More blocks than this have more vertices than indices can name, or rows than memory can hold. */
enum { MOST_BLOCKS = 1 << 26 };

/* Cubes that are searched between two looks at progress, and at what was found. */
enum { MANY_CUBES = 1024, MANY_ROOTS = 1 << 16 };

/* Bytes that a block of the surface takes while these are being found: its key in a list that doubles, once more where
 * it is sorted, and its place. */
enum { BLOCK_BYTES = 3 * sizeof(uint64_t) + sizeof(hewn_lattice_block) };

static const uint64_t COLUMN = HEWN_BLOCK_COLUMN;

/* --- signs -------------------------------------------------------------------------------------------------------- */

/* A bit for each of the eight places from 8 * `block` on that is at least `begin` and before `end`. */
static uint32_t within(uint32_t block, uint32_t begin, uint32_t end)
{
    const uint32_t first = HEWN_BLOCK * block;
    uint32_t bits = 0;
    for (uint32_t i = 0; i < HEWN_BLOCK; i++)
        bits |= (uint32_t)(first + i >= begin && first + i < end) << i;
    return bits;
}

/* A row of bits for each bit. */
static uint64_t spread_rows(uint32_t bits)
{
    uint64_t rows = 0;
    for (uint32_t j = 0; j < HEWN_BLOCK; j++)
        rows |= (bits >> j & 1 ? (uint64_t)0xFF : 0) << HEWN_BLOCK * j;
    return rows;
}

/* Takes out what is not in the volume. */
static void clip(const hewn_volume *volume, const uint32_t place[3], hewn_block_bits bits)
{
    uint32_t in[3];
    for (int axis = 0; axis < 3; axis++) {
        const uint32_t lead = volume->blocks->lead[axis];
        in[axis] = within(place[axis], lead, lead + volume->dims[axis]);
    }
    if ((in[0] & in[1] & in[2]) == 0xFF)
        return;
    for (uint32_t z = 0; z < HEWN_BLOCK; z++)
        bits[z] &= in[2] >> z & 1 ? in[0] * COLUMN & spread_rows(in[1]) : 0;
}

static void find_signs(const hewn_lattice *lattice, hewn_lattice_blocks *out)
{
    const hewn_volume *volume = lattice->volume;
    const hewn_blocks *blocks = volume->blocks;
    const uint32_t *places = HEWN_BLOCKS_ARRAY(blocks, uint32_t, places);
    hewn_volume constants = *volume, samples = *volume;
    constants.samples = HEWN_BLOCKS_ARRAY(blocks, char, constants);
    samples.samples = HEWN_BLOCKS_ARRAY(blocks, char, samples);
    hewn_threshold_apply(&lattice->threshold, &constants, 0, blocks->constant_count, out->constants);
#pragma omp parallel for schedule(static) if (blocks->block_count > 64)
    for (uint64_t block = 0; block < blocks->block_count; block++) {
        uint8_t bytes[HEWN_BLOCK_SAMPLES];
        hewn_threshold_apply(&lattice->threshold, &samples, HEWN_BLOCK_SAMPLES * block, HEWN_BLOCK_SAMPLES, bytes);
        for (uint32_t z = 0; z < HEWN_BLOCK; z++)
            out->inside[block][z] = hewn_threshold_pack(bytes + (size_t)64 * z);
        clip(volume, places + 3 * block, out->inside[block]);
    }
}

/* The signs of the block at a place. */
static void find_bits(const hewn_lattice *lattice, uint32_t x, uint32_t y, uint32_t z, uint32_t slices, uint64_t *out)
{
    const hewn_lattice_blocks *own = lattice->blocks;
    const uint32_t entry = hewn_blocks_find(lattice->volume->blocks, x, y, z);
    const uint32_t place[3] = {x, y, z};
    if (hewn_entry_leads_on(entry)) {
        memcpy(out, own->inside[entry >> 1], slices * sizeof *out);
        return;
    }
    hewn_block_bits all;
    memset(all, own->constants[entry >> 1] ? 0xFF : 0, sizeof all);
    if (own->constants[entry >> 1])
        clip(lattice->volume, place, all);
    memcpy(out, all, slices * sizeof *out);
}

enum { SLICES = HEWN_BLOCK + 1 };

/* Slices of blocks at i, i + 1, and these at j + 1: of the latter only what is next to the first block matters. */
typedef uint64_t block_square[4][SLICES];

static bool bit_at(block_square of, int x, int y, int z)
{
    return of[x / HEWN_BLOCK + 2 * (y / HEWN_BLOCK)][z] >> (x % HEWN_BLOCK + HEWN_BLOCK * (y % HEWN_BLOCK)) & 1;
}

static void copy_bit(block_square of, const int from[3], const int to[3])
{
    uint64_t *slice = &of[to[0] / HEWN_BLOCK + 2 * (to[1] / HEWN_BLOCK)][to[2]];
    const uint64_t bit = (uint64_t)1 << (to[0] % HEWN_BLOCK + HEWN_BLOCK * (to[1] % HEWN_BLOCK));
    *slice = bit_at(of, from[0], from[1], from[2]) ? *slice | bit : *slice & ~bit;
}

/* Samples across an axis, at place `to` along it, become those at `from`. */
static void copy_layer(block_square of, int axis, int from, int to)
{
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    int source[3], target[3];
    source[axis] = from;
    target[axis] = to;
    for (int n = 0; n < SLICES * SLICES; n++) {
        source[u] = target[u] = n % SLICES;
        source[v] = target[v] = n / SLICES;
        copy_bit(of, source, target);
    }
}

/* The rim repeats what is beside it. Where only the rim is here, and that is not, there is no cell and no edge. */
static void repeat_rim(const hewn_lattice *lattice, const uint32_t place[3], block_square of)
{
    for (int axis = 0; axis < 3; axis++) {
        const int64_t low = (int64_t)lattice->volume->blocks->lead[axis] - 1 - (int64_t)HEWN_BLOCK * place[axis];
        const int64_t high = low + lattice->dims[axis] - 1;
        if (low >= 0 && low < HEWN_BLOCK)
            copy_layer(of, axis, (int)low + 1, (int)low);
        if (high > 0 && high <= HEWN_BLOCK)
            copy_layer(of, axis, (int)high - 1, (int)high);
    }
}

static void find_limits(const hewn_lattice *lattice, const uint32_t place[3], hewn_block_signs *out)
{
    uint32_t may[3], in[3];
    for (int axis = 0; axis < 3; axis++) {
        const uint32_t lead = lattice->volume->blocks->lead[axis], begin = lead - lattice->rim;
        may[axis] = within(place[axis], begin, begin + lattice->dims[axis] - 1);
        in[axis] = lattice->repeats ? within(place[axis], lead, lead + lattice->volume->dims[axis]) : 0xFF;
    }
    out->may_i = may[0] * COLUMN;
    out->may_j = spread_rows(may[1]);
    out->may_k = may[2];
    out->in_i = in[0] * COLUMN;
    out->in_j = spread_rows(in[1]);
    out->in_k = in[2];
}

void hewn_block_signs_load(const hewn_lattice *lattice, const uint32_t place[3], hewn_block_signs *out)
{
    block_square of;
    const uint32_t x = place[0], y = place[1], z = place[2];
    for (uint32_t n = 0; n < 4; n++) {
        find_bits(lattice, x + (n & 1), y + (n >> 1), z, HEWN_BLOCK, of[n]);
        find_bits(lattice, x + (n & 1), y + (n >> 1), z + 1, 1, of[n] + HEWN_BLOCK);
    }
    if (lattice->repeats)
        repeat_rim(lattice, place, of);
    for (uint32_t k = 0; k < SLICES; k++) {
        const uint64_t low = COLUMN * 0x7F;
        out->here[k] = of[0][k];
        out->next_i[k] = (of[0][k] >> 1 & low) | (of[1][k] & COLUMN) << 7;
        out->next_j[k] = of[0][k] >> HEWN_BLOCK | of[2][k] << 7 * HEWN_BLOCK;
        const uint64_t ahead = (of[2][k] >> 1 & low) | (of[3][k] & COLUMN) << 7;
        out->next_ij[k] = out->next_i[k] >> HEWN_BLOCK | ahead << 7 * HEWN_BLOCK;
    }
    find_limits(lattice, place, out);
}

/* --- the surface -------------------------------------------------------------------------------------------------- */

/* What is known of a cube of samples: all outside, all inside, or not known to be one of these. */
enum { OUT, IN, MIXED };

typedef struct block_list {
    uint64_t *keys;
    uint64_t count;
    size_t room;
    hewn_result result;
} block_list;

typedef struct block_search {
    const hewn_lattice *lattice;
    const hewn_volume_extract_desc *desc;
    uint64_t along, across; /* keys of neighbours along j and k differ by these */
    uint32_t (*cubes)[3];   /* of 128, that may have surface and have not been searched */
    size_t cube_count, cube_room;
    uint64_t bytes; /* in use beside cubes and blocks */
    uint64_t most;  /* blocks that may be found */
    uint64_t found; /* so many were, by all threads */
    block_list all;
} block_search;

static uint32_t state_of_block(const hewn_block_bits bits)
{
    uint64_t any = 0, all = ~(uint64_t)0;
    for (uint32_t z = 0; z < HEWN_BLOCK; z++) {
        any |= bits[z];
        all &= bits[z];
    }
    return any == 0 ? OUT : all == ~(uint64_t)0 ? IN : MIXED;
}

/* What is outside of the volume is outside. */
static uint32_t state_of(const hewn_lattice *lattice, uint32_t side, const uint32_t at[3])
{
    const hewn_blocks *blocks = lattice->volume->blocks;
    bool whole = true;
    for (int axis = 0; axis < 3; axis++) {
        const uint64_t begin = (uint64_t)at[axis] * side, end = begin + side, lead = blocks->lead[axis];
        if (end <= lead || begin >= lead + lattice->volume->dims[axis])
            return OUT;
        whole = whole && begin >= lead && end <= lead + lattice->volume->dims[axis];
    }
    const uint32_t entry = side == HEWN_UPPER_SPAN   ? hewn_blocks_root(blocks, at[0], at[1], at[2])
                           : side == HEWN_LOWER_SPAN ? hewn_blocks_upper(blocks, at[0], at[1], at[2])
                                                     : hewn_blocks_find(blocks, at[0], at[1], at[2]);
    if (hewn_entry_leads_on(entry))
        return side == HEWN_BLOCK ? state_of_block(lattice->blocks->inside[entry >> 1]) : MIXED;
    if (!lattice->blocks->constants[entry >> 1])
        return OUT;
    return whole ? IN : MIXED;
}

/* Whether a cube holds samples of the volume, or one after it along some axis does: where neither is so, all is out. */
static bool is_near(const hewn_lattice *lattice, uint32_t side, const uint32_t at[3])
{
    bool near = true;
    for (int axis = 0; axis < 3; axis++) {
        const uint64_t lead = lattice->volume->blocks->lead[axis], begin = (uint64_t)at[axis] * side;
        near = near && begin < lead + lattice->volume->dims[axis] && begin + 2 * (uint64_t)side > lead;
    }
    return near;
}

/* Whether cells that begin in a cube may hold surface, and in which of its parts: `*state` is its own. */
static bool may_have_surface(const hewn_lattice *lattice, uint32_t side, const uint32_t at[3], uint32_t *state)
{
    *state = state_of(lattice, side, at);
    bool may = *state == MIXED;
    for (uint32_t n = 1; n < 8 && !may; n++) {
        const uint32_t next[3] = {at[0] + (n & 1), at[1] + (n >> 1 & 1), at[2] + (n >> 2)};
        may = state_of(lattice, side, next) != *state;
    }
    return may;
}

static void add_block(const block_search *search, const uint32_t place[3], block_list *out)
{
    hewn_block_signs signs;
    uint64_t any = 0;
    hewn_block_signs_load(search->lattice, place, &signs);
    for (uint32_t z = 0; z < HEWN_BLOCK; z++)
        any |= hewn_block_crossed(&signs, 0, z) | hewn_block_crossed(&signs, 1, z) | hewn_block_crossed(&signs, 2, z) |
               hewn_block_active(&signs, z);
    if (!any || out->result != HEWN_OK)
        return;
    out->result = hewn_reserve((void **)&out->keys, &out->room, out->count + 1, sizeof *out->keys, NULL);
    if (out->result == HEWN_OK)
        out->keys[out->count++] = place[0] + search->along * place[1] + search->across * place[2];
}

/* The parts of a cube that may have surface. One that is all in or out itself has it only at its far sides. */
static void next_part(uint32_t state, uint32_t parts, uint32_t *part)
{
    const uint32_t x = *part % parts, y = *part / parts % parts, z = *part / parts / parts;
    const bool inner = state != MIXED && x < parts - 1 && y < parts - 1 && z < parts - 1;
    if (inner)
        *part += parts - 1 - x;
}

/* Once too many are found, by whichever thread, nobody goes on. */
static void search_cube(block_search *search, const uint32_t cube[3], block_list *out)
{
    const uint32_t state = state_of(search->lattice, HEWN_LOWER_SPAN, cube);
    const uint64_t before = out->count;
    uint64_t found;
    uint32_t own;
#pragma omp atomic read
    found = search->found;
    for (uint32_t part = 0; part < HEWN_LOWER_ENTRIES && found <= search->most && out->result == HEWN_OK; part++) {
        next_part(state, HEWN_LOWER, &part);
        const uint32_t at[3] = {HEWN_LOWER * cube[0] + part % HEWN_LOWER,
                                HEWN_LOWER * cube[1] + part / HEWN_LOWER % HEWN_LOWER,
                                HEWN_LOWER * cube[2] + part / HEWN_LOWER / HEWN_LOWER};
        if (is_near(search->lattice, HEWN_BLOCK, at) && may_have_surface(search->lattice, HEWN_BLOCK, at, &own))
            add_block(search, at, out);
    }
#pragma omp atomic
    search->found += out->count - before;
}

/* Adds those in a cube of 4096 to the cubes of 128 to be searched. */
static hewn_result list_cubes(block_search *search, uint64_t root, hewn_error *error)
{
    const uint32_t *roots = search->lattice->volume->blocks->roots;
    const uint32_t whole[3] = {(uint32_t)(root % roots[0]), (uint32_t)(root / roots[0] % roots[1]),
                               (uint32_t)(root / roots[0] / roots[1])};
    uint32_t state, own;
    if (!may_have_surface(search->lattice, HEWN_UPPER_SPAN, whole, &state))
        return HEWN_OK;
    for (uint32_t part = 0; part < HEWN_UPPER_ENTRIES; part++) {
        next_part(state, HEWN_UPPER, &part);
        const uint32_t at[3] = {HEWN_UPPER * whole[0] + part % HEWN_UPPER,
                                HEWN_UPPER * whole[1] + part / HEWN_UPPER % HEWN_UPPER,
                                HEWN_UPPER * whole[2] + part / HEWN_UPPER / HEWN_UPPER};
        if (!is_near(search->lattice, HEWN_LOWER_SPAN, at) ||
            !may_have_surface(search->lattice, HEWN_LOWER_SPAN, at, &own))
            continue;
        HEWN_TRY(hewn_reserve((void **)&search->cubes, &search->cube_room, search->cube_count + 1,
                              sizeof *search->cubes, error));
        memcpy(search->cubes[search->cube_count++], at, sizeof at);
    }
    return HEWN_OK;
}

/* --- limits ------------------------------------------------------------------------------------------------------- */

/* Bytes in use with so many blocks found. */
static uint64_t bytes_with(const block_search *search, uint64_t blocks)
{
    return search->bytes + search->cube_room * sizeof *search->cubes + BLOCK_BYTES * blocks;
}

static void set_limit(block_search *search)
{
    const uint64_t allowed = search->desc->max_memory, without = bytes_with(search, 0);
    search->most = MOST_BLOCKS;
    if (allowed > 0 && (allowed < without || (allowed - without) / BLOCK_BYTES < MOST_BLOCKS))
        search->most = allowed < without ? 0 : (allowed - without) / BLOCK_BYTES;
}

static hewn_result check_limit(const block_search *search, hewn_error *error)
{
    const uint64_t allowed = search->desc->max_memory, bytes = bytes_with(search, search->found);
    if (allowed > 0 && bytes > allowed)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY,
                         "the blocks that the surface passes need %llu bytes or more, of the %llu that are allowed",
                         (unsigned long long)bytes, (unsigned long long)allowed);
    if (search->found > MOST_BLOCKS)
        return hewn_fail(error, HEWN_LIMIT, "the surface passes more than %d blocks of 8 x 8 x 8 samples", MOST_BLOCKS);
    return HEWN_OK;
}

/* --- their order -------------------------------------------------------------------------------------------------- */

static hewn_result join(block_list *all, const block_list *own)
{
    if (own->result != HEWN_OK || own->count == 0)
        return own->result;
    const hewn_result result =
        hewn_reserve((void **)&all->keys, &all->room, all->count + own->count, sizeof *all->keys, NULL);
    if (result != HEWN_OK)
        return result;
    memcpy(all->keys + all->count, own->keys, own->count * sizeof *own->keys);
    all->count += own->count;
    return HEWN_OK;
}

/* Cubes [begin, end) of those that are listed. */
static hewn_result search_cubes(block_search *search, size_t begin, size_t end, hewn_error *error)
{
    block_list *all = &search->all;
    set_limit(search);
#pragma omp parallel if (end - begin > 1)
    {
        block_list own = {0};
#pragma omp for schedule(dynamic)
        for (size_t n = begin; n < end; n++)
            search_cube(search, search->cubes[n], &own);
#pragma omp critical(hewn_lattice_blocks)
        if (all->result == HEWN_OK)
            all->result = join(all, &own);
        hewn_free(own.keys);
    }
    HEWN_TRY(check_limit(search, error));
    if (all->result != HEWN_OK)
        return hewn_fail(error, all->result, "out of memory for the blocks of a surface");
    return hewn_progress_report(search->desc->progress, "extract", 0, error);
}

/* Cubes are searched when there are many, so they take little memory however large the volume is. */
static hewn_result search_all(block_search *search, hewn_error *error)
{
    const uint32_t *roots = search->lattice->volume->blocks->roots;
    const uint64_t count = (uint64_t)roots[0] * roots[1] * roots[2];
    for (uint64_t root = 0; root < count; root++) {
        HEWN_TRY(list_cubes(search, root, error));
        if (root % MANY_ROOTS == MANY_ROOTS - 1)
            HEWN_TRY(hewn_progress_report(search->desc->progress, "extract", 0, error));
        if (search->cube_count < MANY_CUBES && root + 1 < count)
            continue;
        for (size_t begin = 0, end; begin < search->cube_count; begin = end) {
            end = search->cube_count - begin > MANY_CUBES ? begin + MANY_CUBES : search->cube_count;
            HEWN_TRY(search_cubes(search, begin, end, error));
        }
        search->cube_count = 0;
    }
    if (search->all.count > 1)
        qsort(search->all.keys, search->all.count, sizeof *search->all.keys, hewn_order_uint64);
    return HEWN_OK;
}

/* Keys that are looked for rise as those of the blocks do. */
static hewn_result set_surface(const block_search *search, const block_list *found, hewn_lattice_blocks *out,
                               hewn_error *error)
{
    const uint64_t steps[3] = {search->along, search->across, search->along + search->across};
    uint32_t ahead[3] = {0};
    out->count = found->count;
    out->surface = hewn_alloc(found->count, sizeof *out->surface);
    if (!out->surface)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the blocks of a surface");
    for (uint64_t n = 0; n < found->count; n++) {
        const uint64_t key = found->keys[n];
        hewn_lattice_block *block = &out->surface[n];
        block->place[0] = (uint32_t)(key % search->across % search->along);
        block->place[1] = (uint32_t)(key % search->across / search->along);
        block->place[2] = (uint32_t)(key / search->across);
        for (int i = 0; i < 3; i++) {
            while (ahead[i] < found->count && found->keys[ahead[i]] < key + steps[i])
                ahead[i]++;
            block->ahead[i] = ahead[i];
        }
    }
    return HEWN_OK;
}

static hewn_result find_surface(const hewn_lattice *lattice, const hewn_volume_extract_desc *desc,
                                hewn_lattice_blocks *out, hewn_error *error)
{
    const uint32_t *roots = lattice->volume->blocks->roots;
    const uint64_t side = HEWN_UPPER_SPAN / HEWN_BLOCK;
    block_search search = {.lattice = lattice, .desc = desc, .along = side * roots[0] + 1};
    search.across = search.along * (side * roots[1] + 1);
    search.bytes = lattice->volume->memory_length + hewn_lattice_blocks_bytes(lattice);
    hewn_result result = search_all(&search, error);
    out->peak = bytes_with(&search, search.found);
    if (result == HEWN_OK)
        result = set_surface(&search, &search.all, out, error);
    hewn_free(search.cubes);
    hewn_free(search.all.keys);
    return result;
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

hewn_result hewn_lattice_blocks_create(hewn_lattice *lattice, const hewn_volume_extract_desc *desc, hewn_error *error)
{
    const hewn_blocks *blocks = lattice->volume->blocks;
    hewn_lattice_blocks *own = hewn_alloc_zero(1, sizeof *own);
    lattice->blocks = own;
    if (own) {
        own->inside = hewn_alloc(blocks->block_count, sizeof *own->inside);
        own->constants = hewn_alloc(blocks->constant_count, 1);
    }
    if (!own || !own->inside || !own->constants)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the signs of %llu blocks",
                         (unsigned long long)blocks->block_count);
    find_signs(lattice, own);
    return find_surface(lattice, desc, own, error);
}

void hewn_lattice_blocks_destroy(hewn_lattice *lattice)
{
    hewn_lattice_blocks *own = lattice->blocks;
    if (!own)
        return;
    hewn_free(own->inside);
    hewn_free(own->constants);
    hewn_free(own->surface);
    hewn_free(own->rows);
    hewn_free(own);
    lattice->blocks = NULL;
}

uint64_t hewn_lattice_blocks_bytes(const hewn_lattice *lattice)
{
    const hewn_lattice_blocks *own = lattice->blocks;
    return own->count * sizeof *own->surface + lattice->volume->blocks->block_count * sizeof *own->inside +
           lattice->volume->blocks->constant_count;
}
