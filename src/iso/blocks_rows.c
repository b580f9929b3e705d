/* What the rows of blocks will emit, and where. */
#include "base/alloc.h"
#include "base/error.h"
#include "iso/lattice_blocks.h"

/* --- slabs -------------------------------------------------------------------------------------------------------- */

/* The first block that is not before layer `z`. */
static uint64_t first_of_layer(const hewn_lattice_blocks *blocks, uint32_t z)
{
    uint64_t low = 0, high = blocks->count;
    while (low < high) {
        const uint64_t middle = low + (high - low) / 2;
        if (blocks->surface[middle].place[2] < z)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* Blocks that have rows in slices [begin, end) and the one after. */
static void find_range(const hewn_lattice *lattice, uint32_t begin, uint32_t end, uint64_t range[2])
{
    const uint32_t lead = lattice->volume->blocks->lead[2] - lattice->rim;
    const uint32_t rows_end = end < lattice->dims[2] ? end + 1 : end;
    range[0] = first_of_layer(lattice->blocks, (lead + begin) / HEWN_BLOCK);
    range[1] = first_of_layer(lattice->blocks, (lead + rows_end - 1) / HEWN_BLOCK + 1);
}

uint64_t hewn_lattice_blocks_row_bytes(const hewn_lattice *lattice, uint32_t begin, uint32_t end)
{
    uint64_t range[2];
    find_range(lattice, begin, end, range);
    return (range[1] - range[0]) * sizeof *lattice->blocks->rows;
}

hewn_result hewn_lattice_blocks_lay(hewn_lattice *lattice, hewn_error *error)
{
    hewn_lattice_blocks *own = lattice->blocks;
    uint64_t range[2];
    find_range(lattice, lattice->begin, lattice->end, range);
    own->first = range[0];
    own->end = range[1];
    own->rows = hewn_alloc(own->end - own->first, sizeof *own->rows);
    return own->rows ? HEWN_OK
                     : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the rows of %llu blocks",
                                 (unsigned long long)(own->end - own->first));
}

/* --- counting ----------------------------------------------------------------------------------------------------- */

typedef struct block_counts {
    uint64_t active, decided, caps;
} block_counts;

/* Adds up the bits of each row of a slice. */
static void count_bits(uint64_t bits, uint32_t axis, hewn_lattice_row *rows)
{
    for (; bits; bits &= bits - 1)
        rows[hewn_lattice_lowest(bits) / HEWN_BLOCK].vertices[axis]++;
}

uint64_t hewn_block_rim_edges(const hewn_lattice *lattice, uint64_t block, uint32_t axis, uint32_t z)
{
    uint64_t bits = 0;
    uint32_t start[3];
    hewn_block_start(lattice, lattice->blocks->surface[block].place, start);
    if (axis == 2)
        return start[2] + z == 0 || start[2] + z + 2 == lattice->dims[2] ? ~(uint64_t)0 : 0;
    for (uint32_t n = 0; n < HEWN_BLOCK; n++) {
        const uint32_t at = start[axis] + n;
        if (at == 0 || at + 2 == lattice->dims[axis])
            bits |= axis == 0 ? HEWN_BLOCK_COLUMN << n : (uint64_t)0xFF << HEWN_BLOCK * n;
    }
    return bits;
}

static void count_cells(const hewn_lattice *lattice, const hewn_block_signs *signs, const uint32_t start[3], uint32_t z,
                        hewn_lattice_row *rows, block_counts *counts)
{
    for (uint64_t rest = hewn_block_active(signs, z); rest; rest &= rest - 1) {
        const uint32_t bit = hewn_lattice_lowest(rest), x = bit % HEWN_BLOCK, y = bit / HEWN_BLOCK;
        const uint32_t pattern = hewn_block_pattern(signs, z, bit);
        const uint32_t place = hewn_lattice_patch(lattice, pattern, start[0] + x, start[1] + y, start[2] + z);
        const uint32_t head = lattice->table[place];
        rows[y].triangles += head & 255;
        rows[y].centres += head >> 8;
        counts->active++;
        counts->decided += lattice->table[lattice->flipped ? pattern ^ 255u : pattern] >> 31;
    }
}

static block_counts count_block(const hewn_lattice *lattice, uint64_t number)
{
    const hewn_lattice_block *block = &lattice->blocks->surface[number];
    block_counts counts = {0};
    hewn_block_signs signs;
    uint32_t start[3], own[2], rows[2];
    hewn_block_signs_load(lattice, block->place, &signs);
    hewn_block_start(lattice, block->place, start);
    hewn_block_slices(lattice, block, lattice->begin, lattice->end, own);
    hewn_block_slices(lattice, block, lattice->begin, hewn_lattice_rows_end(lattice), rows);
    for (uint32_t y = 0; y < HEWN_BLOCK_ROWS; y++)
        *hewn_block_row(lattice->blocks, number, y, 0) = (hewn_lattice_row){0};
    for (uint32_t z = rows[0]; z < rows[1]; z++) {
        hewn_lattice_row *row = hewn_block_row(lattice->blocks, number, 0, z);
        for (uint32_t axis = 0; axis < 3; axis++) {
            const uint64_t crossed = hewn_block_crossed(&signs, axis, z);
            count_bits(crossed, axis, row);
            if (lattice->rim && !lattice->repeats && crossed && z < own[1])
                counts.caps += hewn_lattice_ones(crossed & hewn_block_rim_edges(lattice, number, axis, z));
        }
        if (z < own[1])
            count_cells(lattice, &signs, start, z, row, &counts);
    }
    return counts;
}

/* --- sums --------------------------------------------------------------------------------------------------------- */

/* The rows with a place along j in a bar of blocks [first, end), each after the other. */
static void sum_row(hewn_lattice_blocks *own, uint64_t first, uint64_t end, uint32_t y, uint32_t z,
                    hewn_lattice_sums *sums)
{
    for (int axis = 0; axis < 3; axis++)
        for (uint64_t block = first; block < end; block++) {
            hewn_lattice_row *row = hewn_block_row(own, block, y, z);
            const uint32_t count = row->vertices[axis];
            row->vertices[axis] = (uint32_t)sums->vertices;
            sums->vertices += count;
        }
    for (uint64_t block = first; block < end; block++) {
        hewn_lattice_row *row = hewn_block_row(own, block, y, z);
        const hewn_lattice_row count = *row;
        row->centres = (uint32_t)sums->centres;
        row->triangles = sums->triangles;
        sums->centres += count.centres;
        sums->triangles += count.triangles;
    }
}

/* Where the sums of a slab are noted, slice by slice. */
typedef struct slice_notes {
    hewn_lattice *lattice;
    uint32_t next; /* slice that has not been noted */
} slice_notes;

/* `sums` are what is before slice `slice`, and before all since the last. */
static void note_slices(slice_notes *notes, uint32_t slice, const hewn_lattice_sums *sums)
{
    hewn_lattice *lattice = notes->lattice;
    if (slice >= lattice->end && notes->next <= lattice->end)
        lattice->after = *sums;
    for (; lattice->slices && notes->next <= slice && notes->next <= lattice->end; notes->next++)
        lattice->slices[notes->next - lattice->begin] = *sums;
    notes->next = slice + 1 > notes->next ? slice + 1 : notes->next;
}

static void sum_layer(slice_notes *notes, uint64_t first, uint64_t end, hewn_lattice_sums *sums)
{
    hewn_lattice *lattice = notes->lattice;
    hewn_lattice_blocks *own = lattice->blocks;
    uint32_t rows[2], start[3];
    hewn_block_start(lattice, own->surface[first].place, start);
    hewn_block_slices(lattice, &own->surface[first], lattice->begin, hewn_lattice_rows_end(lattice), rows);
    for (uint32_t z = rows[0]; z < rows[1]; z++) {
        note_slices(notes, start[2] + z, sums);
        for (uint64_t bar = first, next; bar < end; bar = next) {
            next = hewn_block_bar_end(own, bar, end);
            for (uint32_t y = 0; y < HEWN_BLOCK; y++)
                sum_row(own, bar, next, y, z, sums);
        }
    }
}

static void sum_up(hewn_lattice *lattice)
{
    const hewn_lattice_blocks *own = lattice->blocks;
    hewn_lattice_sums sums = lattice->before;
    slice_notes notes = {.lattice = lattice, .next = lattice->begin};
    for (uint64_t first = own->first, end; first < own->end; first = end) {
        end = hewn_block_layer_end(own, first, own->end);
        sum_layer(&notes, first, end, &sums);
    }
    note_slices(&notes, lattice->end, &sums);
    lattice->reached = sums.vertices;
}

void hewn_lattice_blocks_count(hewn_lattice *lattice)
{
    const hewn_lattice_blocks *own = lattice->blocks;
    uint64_t active = 0, decided = 0, caps = 0;
#pragma omp parallel for schedule(dynamic, 16) reduction(+ : active, decided, caps) if (own->end - own->first > 8)
    for (uint64_t block = own->first; block < own->end; block++) {
        const block_counts counts = count_block(lattice, block);
        active += counts.active;
        decided += counts.decided;
        caps += counts.caps;
    }
    sum_up(lattice);
    lattice->active_cells = active;
    lattice->decided_cells = decided;
    lattice->cap_vertices = caps;
}
