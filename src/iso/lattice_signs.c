/* Which samples are inside, a bit each. All samples are read once, in order, and compared as they are: this is as fast
 * as memory gives them, which finding the least and greatest of bricks first would not be. What follows looks at 64
 * cells at once, and at those only that hold surface. */
#include <string.h>

#include "base/alloc.h"
#include "iso/lattice.h"

enum { CHUNK = 4096 }; /* samples that are compared at once: a multiple of 64 */

/* A row of samples in chunks; each begins at a word, so the first has a sample less where there is a rim before it. */
static void find_row(const hewn_lattice *lattice, uint64_t from, uint64_t *to)
{
    uint8_t bytes[CHUNK];
    uint32_t count = lattice->volume->dims[0], at = 0, lead = lattice->rim, word = 0;
    while (word < lattice->words) {
        uint32_t room = CHUNK - lead, take = count - at < room ? count - at : room;
        uint32_t used = lead + take, words = lattice->words - word < CHUNK / 64 ? lattice->words - word : CHUNK / 64;
        bytes[0] = 0;
        hewn_threshold_apply(&lattice->threshold, lattice->volume, from + at, take, bytes + lead);
        memset(bytes + used, 0, 64 * words - used);
        for (uint32_t i = 0; i < words; i++)
            to[word + i] = hewn_threshold_pack(bytes + 64 * i);
        word += words;
        at += take;
        lead = 0;
    }
}

/* The rim of a row that was found says what the samples beside it do. */
static void repeat_ends(const hewn_lattice *lattice, uint64_t *row)
{
    const uint32_t last = lattice->dims[0] - 1, before = last - 1;
    row[0] |= row[0] >> 1 & 1;
    row[last / 64] |= (row[before / 64] >> before % 64 & 1) << last % 64;
}

static uint32_t beside_rim(const hewn_lattice *lattice, int axis, uint32_t at)
{
    return at == 0 ? 1 : at == lattice->dims[axis] - 1 ? at - 1 : at;
}

void hewn_lattice_find_signs(hewn_lattice *lattice)
{
    if (lattice->blocks) /* they were found before slabs were laid */
        return;
    uint64_t rows = (uint64_t)lattice->dims[1] * (hewn_lattice_signs_end(lattice) - lattice->begin);
#pragma omp parallel for schedule(static) if (rows > 64)
    for (uint64_t row = 0; row < rows; row++) {
        uint32_t j = (uint32_t)(row % lattice->dims[1]), k = lattice->begin + (uint32_t)(row / lattice->dims[1]);
        uint64_t *to = lattice->inside + row * lattice->words;
        if (lattice->repeats) {
            j = beside_rim(lattice, 1, j);
            k = beside_rim(lattice, 2, k);
        }
        uint64_t source = (uint64_t)(k - lattice->rim) * lattice->volume->dims[1] + (j - lattice->rim);
        if (hewn_lattice_in_rim(lattice, 1, j) || hewn_lattice_in_rim(lattice, 2, k))
            memset(to, 0, lattice->words * sizeof *to);
        else
            find_row(lattice, lattice->first + source * lattice->volume->dims[0], to);
        if (lattice->repeats)
            repeat_ends(lattice, to);
    }
    lattice->inside[rows * lattice->words] = 0;
}
