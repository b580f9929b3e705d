/* Vertices and triangles of blocks. */
#include "iso/lattice_blocks.h"
#include "iso/lattice_cells.h"
#include "iso/lattice_pen.h"
#include "iso/lattice_sample.h"

/* --- samples ------------------------------------------------------------------------------------------------------ */

/* The field around a block, from two samples before it to three past its last: what edges that start in it and their
 * gradients look at, or fewer. What is not in the volume is whatever is there. */
enum { BEFORE = HEWN_LATTICE_REACH, SIDE = HEWN_BLOCK + 2 * HEWN_LATTICE_REACH + 1, NEAR = 3 };

typedef struct block_field {
    double values[SIDE][SIDE][SIDE]; /* k, j, i */
} block_field;

/* Blocks around a block: where the samples of each are, and how far it is from one to the next along each axis: 0 where
 * all are one constant. */
typedef struct near_block {
    const void *samples;
    uint64_t first;
    bool constant;
} near_block;

static near_block find_near(const hewn_blocks *blocks, uint32_t x, uint32_t y, uint32_t z)
{
    const uint32_t entry = hewn_blocks_find(blocks, x, y, z);
    if (!hewn_entry_leads_on(entry))
        return (near_block){HEWN_BLOCKS_ARRAY(blocks, char, constants), entry >> 1, true};
    return (near_block){HEWN_BLOCKS_ARRAY(blocks, char, samples), (uint64_t)(entry >> 1) * HEWN_BLOCK_SAMPLES, false};
}

/* Samples `begin` to `end` - 1 of a row of a block. */
HEWN_LATTICE_INLINE void load_run(const hewn_lattice *lattice, const near_block *from, uint32_t row, uint32_t begin,
                                  uint32_t end, double *out, hewn_voxel type)
{
    const uint64_t first = from->constant ? from->first : from->first + (uint64_t)HEWN_BLOCK * row;
    const double all =
        from->constant ? hewn_lattice_field(lattice, hewn_lattice_raw(from->samples, first, type), type) : 0;
    for (uint32_t i = begin; i < end; i++)
        out[i - begin] =
            from->constant ? all : hewn_lattice_field(lattice, hewn_lattice_raw(from->samples, first + i, type), type);
}

/* Rows that nobody looks at are left out: those of slices from `lo` on up to before `hi`. */
HEWN_LATTICE_INLINE void load_field(const hewn_lattice *lattice, const uint32_t place[3], uint32_t lo, uint32_t hi,
                                    block_field *out, hewn_voxel type)
{
    const uint32_t reach = lattice->planes ? HEWN_LATTICE_REACH : 1, first = BEFORE - reach;
    near_block near[NEAR][NEAR][NEAR];
    for (uint32_t n = 0; n < NEAR * NEAR * NEAR; n++)
        near[n / 9][n / 3 % 3][n % 3] =
            find_near(lattice->volume->blocks, place[0] + n % 3 - 1, place[1] + n / 3 % 3 - 1, place[2] + n / 9 - 1);
    for (uint32_t k = lo + first; k < hi - first; k++)
        for (uint32_t j = first; j < SIDE - first; j++) {
            const uint32_t y = j + HEWN_BLOCK - BEFORE, z = k + HEWN_BLOCK - BEFORE;
            const near_block *row = near[z / HEWN_BLOCK][y / HEWN_BLOCK];
            const uint32_t number = y % HEWN_BLOCK + HEWN_BLOCK * (z % HEWN_BLOCK);
            double *to = out->values[k][j];
            load_run(lattice, &row[0], number, HEWN_BLOCK - reach, HEWN_BLOCK, to + first, type);
            load_run(lattice, &row[1], number, 0, HEWN_BLOCK, to + BEFORE, type);
            load_run(lattice, &row[2], number, 0, reach + 1, to + BEFORE + HEWN_BLOCK, type);
        }
}

/* --- vertices ----------------------------------------------------------------------------------------------------- */

typedef struct block_edges {
    const hewn_lattice *lattice;
    block_field field;
    uint32_t start[3]; /* of the block in the frame */
    hewn_lattice_pen pen;
} block_edges;

static const ptrdiff_t steps[3] = {1, SIDE, SIDE *SIDE};

/* What hewn_lattice_slope() finds along each axis, from no more samples than it takes. `here` is the sample in the
 * block, `from` the same in the volume. */
static void find_slopes(const uint32_t dims[3], const double *here, const uint32_t from[3], double out[3])
{
    for (int axis = 0; axis < 3; axis++) {
        const ptrdiff_t down = from[axis] > 0 ? steps[axis] : 0, up = from[axis] + 1 < dims[axis] ? steps[axis] : 0;
        const double rise = here[up] - here[-down];
        out[axis] = down > 0 && up > 0 ? rise / 2 : rise;
    }
}

/* `at` is the sample in the block, `from` the same in the volume. */
static void gradient_at(const block_edges *edges, const uint32_t at[3], const uint32_t from[3], double out[3])
{
    const uint32_t *dims = edges->lattice->volume->dims, reach = HEWN_LATTICE_REACH;
    const double *here = &edges->field.values[at[2] + BEFORE][at[1] + BEFORE][at[0] + BEFORE];
    hewn_lattice_line lines[3];
    if (!edges->lattice->planes) {
        find_slopes(dims, here, from, out);
        return;
    }
    for (int axis = 0; axis < 3; axis++) {
        const uint32_t rest = dims[axis] - 1 - from[axis];
        hewn_lattice_line *line = &lines[axis];
        line->before = from[axis] < reach ? from[axis] : reach;
        line->after = rest < reach ? rest : reach;
        for (int n = -(int)line->before; n <= (int)line->after; n++)
            line->value[HEWN_LATTICE_REACH + n] = here[n * steps[axis]];
    }
    hewn_lattice_gradient(edges->lattice, lines, out);
}

static void emit_edge(block_edges *edges, uint32_t x, uint32_t y, uint32_t z, bool inside)
{
    const hewn_lattice *lattice = edges->lattice;
    const uint32_t axis = edges->pen.axis, here[3] = {x, y, z};
    uint32_t from[3] = {edges->start[0] + x, edges->start[1] + y, edges->start[2] + z};
    const bool begins = hewn_lattice_in_rim(lattice, (int)axis, from[axis]);
    const bool ends = hewn_lattice_in_rim(lattice, (int)axis, from[axis] + 1);
    for (int a = 0; a < 3; a++)
        from[a] -= lattice->rim;
    if (begins || ends) {
        from[axis] += begins;
        hewn_lattice_put_cap(&edges->pen, from, ends);
        return;
    }
    uint32_t to[3] = {from[0], from[1], from[2]}, there[3] = {x, y, z};
    to[axis]++;
    there[axis]++;
    const double *value = &edges->field.values[z + BEFORE][y + BEFORE][x + BEFORE];
    const double *next = &edges->field.values[there[2] + BEFORE][there[1] + BEFORE][there[0] + BEFORE];
    const double at_begin = hewn_lattice_agree(lattice, *value, inside);
    const double at_end = hewn_lattice_agree(lattice, *next, !inside);
    double share = hewn_lattice_share(lattice, at_begin, at_end);
    double first[3] = {0}, last[3] = {0};
    if (lattice->normals) {
        gradient_at(edges, here, from, first);
        gradient_at(edges, there, to, last);
    }
    if (lattice->planes)
        hewn_lattice_follow_bend(lattice, axis, at_begin, at_end, &share, first, last);
    hewn_lattice_put_edge(&edges->pen, from, share, inside, first, last);
}

static void emit_row(block_edges *edges, const hewn_block_signs *signs, const hewn_lattice_row *row, uint32_t y,
                     uint32_t z, hewn_triangles *out)
{
    const hewn_lattice *lattice = edges->lattice;
    for (uint32_t axis = 0; axis < 3; axis++) {
        const uint64_t place = row->vertices[axis] - lattice->before.vertices;
        uint32_t rest = hewn_block_crossed(signs, axis, z) >> HEWN_BLOCK * y & 0xFF;
        if (!rest)
            continue;
        edges->pen = (hewn_lattice_pen){.lattice = lattice, .axis = axis, .position = out->positions + 3 * place};
        edges->pen.normal = lattice->normals ? out->normals + 3 * place : NULL;
        for (; rest; rest &= rest - 1) {
            const uint32_t x = hewn_lattice_lowest(rest);
            emit_edge(edges, x, y, z, signs->here[z] >> (x + HEWN_BLOCK * y) & 1);
        }
    }
}

static void load(const hewn_lattice *lattice, const uint32_t place[3], uint32_t lo, uint32_t hi, block_field *out)
{
#define LOAD(enumerator, type)                                                                                         \
    case enumerator: load_field(lattice, place, lo, hi, out, enumerator); break;
    switch (lattice->volume->type) {
        HEWN_VOXEL_TYPES(LOAD)
        LOAD(HEWN_VOXEL_HALF, uint16_t)
    }
#undef LOAD
}

static void emit_block(const hewn_lattice *lattice, uint64_t number, hewn_triangles *out)
{
    const hewn_lattice_block *block = &lattice->blocks->surface[number];
    hewn_block_signs signs;
    block_edges edges;
    uint32_t rows[2];
    edges.lattice = lattice;
    hewn_block_signs_load(lattice, block->place, &signs);
    hewn_block_start(lattice, block->place, edges.start);
    hewn_block_slices(lattice, block, lattice->begin, hewn_lattice_rows_end(lattice), rows);
    load(lattice, block->place, rows[0], rows[1] + SIDE - HEWN_BLOCK, &edges.field);
    for (uint32_t z = rows[0]; z < rows[1]; z++)
        for (uint32_t y = 0; y < HEWN_BLOCK; y++)
            emit_row(&edges, &signs, hewn_block_row(lattice->blocks, number, y, z), y, z, out);
}

void hewn_lattice_blocks_emit_vertices(const hewn_lattice *lattice, hewn_triangles *out)
{
    const hewn_lattice_blocks *own = lattice->blocks;
#pragma omp parallel for schedule(dynamic, 16) if (own->end - own->first > 8)
    for (uint64_t block = own->first; block < own->end; block++)
        emit_block(lattice, block, out);
}

/* --- triangles ---------------------------------------------------------------------------------------------------- */

/* The four rows of samples around a row of cells. Where a row goes on in another bar, its numbers are those of the
 * first block there that lies no less far along i. */
static void find_rows(const hewn_lattice *lattice, uint64_t number, uint32_t y, uint32_t z,
                      const hewn_lattice_row *out[4])
{
    static const hewn_lattice_row none;
    const hewn_lattice_blocks *own = lattice->blocks;
    for (uint32_t n = 0; n < 4; n++) {
        const uint32_t j = y + (n & 1), k = z + (n >> 1);
        const uint32_t bar = j / HEWN_BLOCK + 2 * (k / HEWN_BLOCK); /* 0 is the block's own */
        const uint64_t block = bar == 0 ? number : own->surface[number].ahead[bar - 1];
        out[n] = block < own->end ? hewn_block_row(own, block, j % HEWN_BLOCK, k % HEWN_BLOCK) : &none;
    }
}

static void cut_block(const hewn_lattice *lattice, uint64_t number, hewn_triangles *out)
{
    const hewn_lattice_block *block = &lattice->blocks->surface[number];
    const bool turn = lattice->flipped != lattice->mirrors;
    hewn_block_signs signs;
    uint32_t start[3], slices[2];
    hewn_block_signs_load(lattice, block->place, &signs);
    hewn_block_start(lattice, block->place, start);
    hewn_block_slices(lattice, block, lattice->begin, lattice->end, slices);
    for (uint32_t z = slices[0]; z < slices[1]; z++) {
        const uint64_t active = hewn_block_active(&signs, z);
        for (uint32_t y = 0; y < HEWN_BLOCK; y++) {
            uint32_t rest = active >> HEWN_BLOCK * y & 0xFF;
            if (!rest)
                continue;
            const hewn_lattice_row *begins[4];
            find_rows(lattice, number, y, z, begins);
            hewn_lattice_cell_row row = hewn_lattice_begin_cells(lattice, out, begins, start[1] + y, start[2] + z);
            for (; rest; rest &= rest - 1) {
                const uint32_t x = hewn_lattice_lowest(rest);
                const uint32_t pattern = hewn_block_pattern(&signs, z, x + HEWN_BLOCK * y);
                const uint32_t place = hewn_lattice_patch(lattice, pattern, start[0] + x, start[1] + y, start[2] + z);
                hewn_lattice_cut_cell(&row, start[0] + x, pattern, lattice->table + place, turn);
            }
        }
    }
}

void hewn_lattice_blocks_emit_triangles(const hewn_lattice *lattice, hewn_triangles *out)
{
    const hewn_lattice_blocks *own = lattice->blocks;
#pragma omp parallel for schedule(dynamic, 16) if (own->end - own->first > 8)
    for (uint64_t block = own->first; block < own->end; block++)
        cut_block(lattice, block, out);
}
