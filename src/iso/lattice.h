/* A frame of samples as extraction on the host sees it: which are inside, a bit each, and what each row will emit.
 *
 * A closed lattice has a rim: one more layer of samples on every side, none of them inside, that stands where the
 * outermost samples do. So its places are those of the samples plus `rim`, and every crossed edge has its four cells.
 * An open one has none, but for the dual methods, whose vertices lie in cells: there the rim repeats the samples beside
 * it. Its cells then have no thickness, and their vertices lie on the bounds. Edges in such a rim are those beside it
 * once more, and count as not there.
 *
 * Edges belong to the row of samples (along i) that they start in. Vertices are numbered row by row, in a row those on
 * edges along i first, then j, then k; after all of these come the vertices in cells, in the order of their cells.
 *
 * A lattice may be looked at in slabs of slices (along k), of which one is here at a time. Its signs reach two slices
 * further and its rows one, since its cells name vertices of the next slice, and those are numbered by the signs of the
 * one after that. Numbers are always the whole's. */
#ifndef HEWN_SRC_ISO_LATTICE_H
#define HEWN_SRC_ISO_LATTICE_H

#include "hewn/volume_extract.h"
#include "iso/threshold.h"

/* Vertices keep this part of an edge away from its ends, at least. */
#define HEWN_LATTICE_MARGIN 0x1p-14

/* How many there are, or before which there are so many. */
typedef struct hewn_lattice_sums {
    uint64_t vertices, centres, triangles; /* vertices on edges, in cells */
} hewn_lattice_sums;

/* What a row of samples has, and after the sums where its share begins. */
typedef struct hewn_lattice_row {
    uint32_t vertices[3]; /* on edges along i, j and k */
    uint32_t centres;     /* in the cells of the row, which start at its samples */
    uint64_t triangles;
} hewn_lattice_row;

typedef struct hewn_lattice {
    const hewn_volume *volume;
    struct hewn_lattice_blocks
        *blocks;      /* where samples are in blocks: signs and rows are there (iso/lattice_blocks.h) */
    uint64_t first;   /* sample (0, 0, 0) of the frame */
    uint32_t rim;     /* 1 where there is one, else 0 */
    bool repeats;     /* the rim repeats the samples beside it */
    uint32_t dims[3]; /* with the rim */
    uint32_t begin;   /* the slab's slices are these, */
    uint32_t end;     /* up to before this one */
    hewn_threshold threshold;
    /* The trilinear field that is meshed: rise × (sample - level), below 0 outside where `above`, inside otherwise. 0
     * counts as just not below. */
    double level, rise;
    bool above;
    double margin;
    double place[12]; /* to the mesh's space, row by row */
    double turn[9];   /* takes the gradient of samples to an outward direction there */
    double back[9];   /* from a step there to one between samples */
    bool mirrors;
    uint32_t words;         /* a row has so many words of 64 bits, and one of 0 follows the last row */
    uint64_t *inside;       /* bit i % 64 of word i / 64, of the slab's rows and those of two more slices */
    hewn_lattice_row *rows; /* of the slab and one more slice */
    const uint32_t *table;  /* of patches, as in iso/mc33.h */
    bool flipped;           /* the table's inside is what is not inside here */
    bool normals;
    bool dual;                       /* the table is that of dual methods (iso/lattice_dual.h), */
    bool planes;                     /* vertices lie where the planes of crossings meet, */
    const hewn_triangles *crossings; /* and these are what vertices on edges are otherwise */
    hewn_lattice_sums
        *slices; /* or NULL: where counting puts what is before each slice of the slab, and after the last */
    hewn_lattice_sums before; /* the slab */
    hewn_lattice_sums after;  /* and after it, with what is in it */
    uint64_t reached;         /* vertices on edges with those of the slice after it */
    uint64_t vertex_count;    /* of the whole, on edges */
    uint64_t active_cells, decided_cells, cap_vertices;
} hewn_lattice;

/* The slice before which the slab's rows, and its signs, end. */
static inline uint32_t hewn_lattice_rows_end(const hewn_lattice *lattice)
{
    return lattice->end < lattice->dims[2] ? lattice->end + 1 : lattice->end;
}

static inline uint32_t hewn_lattice_signs_end(const hewn_lattice *lattice)
{
    return lattice->dims[2] - lattice->end > 2 ? lattice->end + 2 : lattice->dims[2];
}

static inline const uint64_t *hewn_lattice_bits(const hewn_lattice *lattice, uint32_t j, uint32_t k)
{
    return lattice->inside + ((uint64_t)(k - lattice->begin) * lattice->dims[1] + j) * lattice->words;
}

static inline hewn_lattice_row *hewn_lattice_row_at(const hewn_lattice *lattice, uint32_t j, uint32_t k)
{
    return &lattice->rows[(uint64_t)(k - lattice->begin) * lattice->dims[1] + j];
}

/* Whether a place along an axis is in the rim. */
static inline bool hewn_lattice_in_rim(const hewn_lattice *lattice, int axis, uint32_t at)
{
    return lattice->rim && (at == 0 || at == lattice->dims[axis] - 1);
}

/* 64 samples of a row from `word` on, a place further along i. */
static inline uint64_t hewn_lattice_next(const uint64_t *bits, uint32_t word)
{
    return bits[word] >> 1 | bits[word + 1] << 63;
}

/* Bits of `word` that are below `count` of the row. */
static inline uint64_t hewn_lattice_mask(uint32_t word, uint32_t count)
{
    return count >= 64 * (word + 1) ? ~(uint64_t)0 : count <= 64 * word ? 0 : ~(uint64_t)0 >> (64 - count % 64);
}

/* Samples of a word of row (j, k) whose edges along an axis may be crossed. */
static inline uint64_t hewn_lattice_edges(const hewn_lattice *lattice, uint32_t axis, uint32_t j, uint32_t k,
                                          uint32_t word)
{
    const uint32_t count = axis == 0 ? lattice->dims[0] - 1 : lattice->dims[0];
    uint64_t bits = hewn_lattice_mask(word, count);
    if (!lattice->repeats)
        return bits;
    if ((axis != 1 && hewn_lattice_in_rim(lattice, 1, j)) || (axis != 2 && hewn_lattice_in_rim(lattice, 2, k)))
        return 0;
    if (axis != 0) {
        bits &= word == 0 ? ~(uint64_t)1 : ~(uint64_t)0;
        bits &= word == (count - 1) / 64 ? ~((uint64_t)1 << (count - 1) % 64) : ~(uint64_t)0;
    }
    return bits;
}

static inline uint32_t hewn_lattice_lowest(uint64_t bits)
{
    return (uint32_t)__builtin_ctzll(bits);
}

/* How many bits are set: quick where few are. */
static inline uint32_t hewn_lattice_ones(uint64_t bits)
{
    uint32_t count = 0;
    for (; bits; bits &= bits - 1)
        count++;
    return count;
}

/* The four rows of samples around a row of cells. Word number `words` of a row is the first of the next one, so what it
 * adds at the row's end must be masked. */
typedef struct hewn_lattice_cells {
    const uint64_t *bits[4]; /* at (j, k), (j + 1, k), (j, k + 1), (j + 1, k + 1) */
    uint32_t word;
    uint64_t here[4], next[4];
    uint64_t active; /* cells of this word that hold surface */
} hewn_lattice_cells;

static inline hewn_lattice_cells hewn_lattice_cells_at(const hewn_lattice *lattice, uint32_t j, uint32_t k)
{
    hewn_lattice_cells cells = {.word = 0};
    for (uint32_t i = 0; i < 4; i++)
        cells.bits[i] = hewn_lattice_bits(lattice, j + (i & 1), k + (i >> 1));
    return cells;
}

static inline void hewn_lattice_load(const hewn_lattice *lattice, hewn_lattice_cells *cells, uint32_t word)
{
    uint64_t any = 0, all = ~(uint64_t)0;
    cells->word = word;
    for (int i = 0; i < 4; i++) {
        cells->here[i] = cells->bits[i][word];
        cells->next[i] = hewn_lattice_next(cells->bits[i], word);
        any |= cells->here[i] | cells->next[i];
        all &= cells->here[i] & cells->next[i];
    }
    cells->active = any & ~all & hewn_lattice_mask(word, lattice->dims[0] - 1);
}

/* Bit c is set where corner c of a cell of the word is inside. */
static inline uint32_t hewn_lattice_pattern(const hewn_lattice_cells *cells, uint32_t bit)
{
    uint32_t pattern = 0;
    for (int i = 0; i < 4; i++)
        pattern |= (uint32_t)(cells->here[i] >> bit & 1) << 2 * i | (uint32_t)(cells->next[i] >> bit & 1)
                                                                        << (2 * i + 1);
    return pattern;
}

/* The value of the field at a sample, or 0 where its sign is not that of its bit; (i, j, k) may be in the rim, where it
 * is 0. For the odd sample. */
double hewn_lattice_value_at(const hewn_lattice *lattice, const uint32_t at[3], bool inside);

/* Whether a sample is inside; it may be in the rim. For the odd sample. */
bool hewn_lattice_inside_at(const hewn_lattice *lattice, const uint32_t at[3]);

/* The place in the table of the patch for the cell at (i, j, k) with this pattern. */
uint32_t hewn_lattice_patch(const hewn_lattice *lattice, uint32_t pattern, uint32_t i, uint32_t j, uint32_t k);

/* The stages in order. Signs of all samples; counts, and from them the places of all that rows emit (HEWN_LIMIT);
 * vertices on edges; vertices in cells and triangles. */
void hewn_lattice_find_signs(hewn_lattice *lattice);
hewn_result hewn_lattice_count(hewn_lattice *lattice, hewn_error *error);
void hewn_lattice_emit_vertices(const hewn_lattice *lattice, hewn_triangles *out);
void hewn_lattice_emit_triangles(const hewn_lattice *lattice, hewn_triangles *out);

#endif
