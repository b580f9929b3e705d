#include <stdlib.h>

#include "base/alloc.h"
#include "base/error.h"
#include "font/font.h"

static int by_start(const void *left, const void *right)
{
    const hewn_grid_side *p = left, *q = right;
    if (p->a.x != q->a.x)
        return p->a.x < q->a.x ? -1 : 1;
    return (p->a.y > q->a.y) - (p->a.y < q->a.y);
}

/* The first side of those sorted that starts at `from` and is not taken yet; `count` where there is none. Sides from
 * one point stand beside each other, and taken ones are marked by a winding of 0. */
static size_t side_from(const hewn_grid_side *sides, size_t count, hewn_grid_point from)
{
    size_t low = 0, high = count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (by_start(&sides[middle], &(hewn_grid_side){.a = from}) < 0)
            low = middle + 1;
        else
            high = middle;
    }
    while (low < count && hewn_grid_same(sides[low].a, from) && sides[low].winding == 0)
        low++;
    return low < count && hewn_grid_same(sides[low].a, from) ? low : count;
}

static void follow(hewn_grid_side *sides, size_t count, hewn_grid_loops *out)
{
    for (size_t i = 0; i < count; i++) {
        size_t length = 0;
        for (size_t at = i; at < count && sides[at].winding != 0; at = side_from(sides, count, sides[at].b)) {
            out->points[out->point_count + length++] = sides[at].a;
            sides[at].winding = 0;
        }
        if (length == 0)
            continue;
        out->point_count += length;
        out->counts[out->count++] = length;
    }
}

hewn_result hewn_grid_loops_create(const hewn_grid_sides *borders, hewn_grid_loops *out, hewn_error *error)
{
    size_t count = borders->count;
    hewn_grid_side *sorted = hewn_alloc(count, sizeof *sorted);
    *out = (hewn_grid_loops){hewn_alloc(count, sizeof *out->points), hewn_alloc(count, sizeof *out->counts), 0, 0};
    bool there = sorted && out->points && out->counts;
    if (there) {
        for (size_t i = 0; i < count; i++)
            sorted[i] = borders->items[i];
        if (count > 1)
            qsort(sorted, count, sizeof *sorted, by_start);
        follow(sorted, count, out);
    } else {
        hewn_grid_loops_destroy(out);
    }
    hewn_free(sorted);
    return there ? HEWN_OK : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for an outline");
}

void hewn_grid_loops_destroy(hewn_grid_loops *loops)
{
    hewn_free(loops->points);
    hewn_free(loops->counts);
    *loops = (hewn_grid_loops){0};
}
