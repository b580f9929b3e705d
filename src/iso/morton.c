#include "iso/morton.h"

#include <string.h>

#include "base/alloc.h"
#include "base/error.h"

static uint64_t spread(uint32_t value)
{
    uint64_t bits = 0;
    for (uint32_t i = 0; i < 21 && value >> i; i++)
        bits |= (uint64_t)(value >> i & 1) << 3 * i;
    return bits;
}

uint64_t hewn_morton_code(const uint32_t cell[3])
{
    return spread(cell[0]) | spread(cell[1]) << 1 | spread(cell[2]) << 2;
}

typedef struct item {
    uint64_t code;
    uint32_t value;
} item;

/* Stably by one byte. */
static void sort_byte(const item *from, item *to, size_t count, unsigned shift)
{
    size_t places[257] = {0};
    for (size_t i = 0; i < count; i++)
        places[(from[i].code >> shift & 255) + 1]++;
    for (int i = 0; i < 256; i++)
        places[i + 1] += places[i];
    for (size_t i = 0; i < count; i++)
        to[places[from[i].code >> shift & 255]++] = from[i];
}

hewn_result hewn_morton_sort(uint64_t *codes, uint32_t *values, size_t count, hewn_error *error)
{
    item *items = hewn_alloc(count, 2 * sizeof *items), *from = items, *to = items + count;
    if (!items)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory sorting %zu cells", count);
    uint64_t used = 0;
    for (size_t i = 0; i < count; i++) {
        items[i] = (item){codes[i], values ? values[i] : 0};
        used |= codes[i];
    }
    for (unsigned shift = 0; shift < 64 && used >> shift; shift += 8) {
        if (!(used >> shift & 255))
            continue;
        sort_byte(from, to, count, shift);
        item *sorted = to;
        to = from;
        from = sorted;
    }
    for (size_t i = 0; i < count; i++) {
        codes[i] = from[i].code;
        if (values)
            values[i] = from[i].value;
    }
    hewn_free(items);
    return HEWN_OK;
}
