#include "atlas/pack.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"

/* A level stretch of the skyline: from x on it is free from y down, up to where the next begins. */
typedef struct level {
    uint32_t x, y;
} level;

typedef struct skyline {
    level *levels;
    size_t count, room;
    uint32_t width, height;
} skyline;

/* The height at which a rectangle that begins at level `at` can stand; UINT32_MAX where it does not fit. */
static uint32_t height_at(const skyline *own, size_t at, uint32_t width, uint32_t height)
{
    uint32_t x = own->levels[at].x, y = 0;
    if (width > own->width - x)
        return UINT32_MAX;
    for (size_t i = at; i < own->count && own->levels[i].x < x + width; i++)
        y = own->levels[i].y > y ? own->levels[i].y : y;
    return y <= own->height && height <= own->height - y ? y : UINT32_MAX;
}

static hewn_result raise(skyline *own, size_t at, uint32_t x, uint32_t width, uint32_t y, hewn_error *error)
{
    size_t end = at;
    uint32_t last = 0;
    for (; end < own->count && own->levels[end].x < x + width; end++)
        last = own->levels[end].y;
    uint32_t stop = end < own->count ? own->levels[end].x : own->width;
    bool rest = x + width < stop;
    void *items = own->levels;
    HEWN_TRY(hewn_reserve(&items, &own->room, own->count + 2, sizeof *own->levels, error));
    own->levels = items;
    memmove(own->levels + at + 1 + rest, own->levels + end, (own->count - end) * sizeof *own->levels);
    own->count += 1 + rest - (end - at);
    own->levels[at] = (level){x, y};
    if (rest)
        own->levels[at + 1] = (level){x + width, last};
    return HEWN_OK;
}

/* With `gap` around: the image counts as that much larger. */
static hewn_result place(skyline *own, hewn_packed *item, uint32_t gap, bool *fit, hewn_error *error)
{
    size_t best = own->count;
    uint32_t least = UINT32_MAX, width = item->width + gap, height = item->height + gap;
    for (size_t i = 0; i < own->count; i++) {
        uint32_t y = height_at(own, i, width, height);
        if (y < least) {
            least = y;
            best = i;
        }
    }
    *fit = best < own->count;
    if (!*fit)
        return HEWN_OK;
    item->x = own->levels[best].x;
    item->y = least;
    return raise(own, best, item->x, width, least + height, error);
}

typedef struct order {
    const hewn_packed *item;
    size_t number;
} order;

static int by_size(const void *left, const void *right)
{
    const order *p = left, *q = right;
    if (p->item->height != q->item->height)
        return p->item->height > q->item->height ? -1 : 1;
    if (p->item->width != q->item->width)
        return p->item->width > q->item->width ? -1 : 1;
    return (p->number > q->number) - (p->number < q->number);
}

hewn_result hewn_pack(hewn_packed *items, size_t count, uint32_t gap, uint32_t width, uint32_t height, bool *fit,
                      hewn_error *error)
{
    skyline own = {.count = 1, .room = 16, .width = width + gap, .height = height + gap};
    order *sorted = hewn_alloc(count, sizeof *sorted);
    own.levels = hewn_alloc(own.room, sizeof *own.levels);
    hewn_result result =
        sorted && own.levels ? HEWN_OK : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for an atlas");
    *fit = result == HEWN_OK;
    if (result == HEWN_OK) {
        own.levels[0] = (level){0, 0};
        for (size_t i = 0; i < count; i++)
            sorted[i] = (order){&items[i], i};
        qsort(sorted, count, sizeof *sorted, by_size);
    }
    for (size_t i = 0; i < count && *fit && result == HEWN_OK; i++)
        result = place(&own, &items[sorted[i].number], gap, fit, error);
    hewn_free(own.levels);
    hewn_free(sorted);
    return result;
}

hewn_result hewn_pack_square(hewn_packed *items, size_t count, uint32_t gap, bool power_of_two, uint32_t most,
                             uint32_t *side, hewn_error *error)
{
    double area = 0, longest = 4;
    for (size_t i = 0; i < count; i++) {
        area += (double)(items[i].width + gap) * (items[i].height + gap);
        longest = fmax(longest, fmax(items[i].width, items[i].height));
    }
    double least = fmax(sqrt(area) - gap, longest);
    bool fit = false;
    for (double next = least; !fit; next = *side * (power_of_two ? 2.0 : 1 + 1.0 / 64)) {
        double rounded = power_of_two ? exp2(ceil(log2(next))) : 4 * ceil(next / 4);
        if (next > least && rounded <= *side)
            rounded = *side + 4.0;
        if (rounded > most)
            return hewn_fail(error, HEWN_LIMIT,
                             "the letters do not fit into an image of %u x %u texels; make them smaller, or fewer",
                             most, most);
        *side = (uint32_t)rounded;
        HEWN_TRY(hewn_pack(items, count, gap, *side, *side, &fit, error));
    }
    return HEWN_OK;
}
