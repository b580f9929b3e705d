#include "lanes/image.h"

#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/progress.h"

enum { LEAF = 8, RATIO = 4, MOST_PARTS = 16, MOST_TOP_TILES = 64 };

/* What all tiles share. */
typedef struct painting {
    const hewn_lane_image_desc *desc;
    uint8_t *inside; /* one of these is NULL */
    float *values;
} painting;

/* What a thread has of its own. */
typedef struct painter {
    const painting *on;
    hewn_lane_work work;
    hewn_lane_image_stats stats;
} painter;

typedef struct tile {
    uint32_t x, y, size;
} tile;

static uint32_t end_of(uint32_t first, uint32_t size, uint32_t limit)
{
    return first + size < limit ? first + size : limit;
}

static void set_side(hewn_lane_boxes *boxes, int axis, uint32_t lane, float a, float b)
{
    boxes->lo[axis][lane] = a < b ? a : b;
    boxes->hi[axis][lane] = a < b ? b : a;
}

/* The boxes of tiles; lanes to fill up the block repeat the last one. */
static uint32_t box_tiles(const hewn_lane_image_desc *desc, const tile *tiles, uint32_t count, hewn_lane_boxes *boxes)
{
    uint32_t lanes = (count + HEWN_LANE_BLOCK - 1) / HEWN_LANE_BLOCK * HEWN_LANE_BLOCK;
    for (uint32_t i = 0; i < lanes; i++) {
        const tile *at = &tiles[i < count ? i : count - 1];
        set_side(boxes, 0, i, desc->x[at->x], desc->x[end_of(at->x, at->size, desc->width) - 1]);
        set_side(boxes, 1, i, desc->y[at->y], desc->y[end_of(at->y, at->size, desc->height) - 1]);
        set_side(boxes, 2, i, desc->z, desc->z);
    }
    return lanes;
}

static void fill_tile(painter *p, const tile *at, bool inside)
{
    const hewn_lane_image_desc *desc = p->on->desc;
    uint32_t x1 = end_of(at->x, at->size, desc->width), y1 = end_of(at->y, at->size, desc->height);
    for (uint32_t y = at->y; y < y1; y++)
        memset(p->on->inside + (size_t)y * desc->width + at->x, inside, x1 - at->x);
    p->stats.filled += (uint64_t)(x1 - at->x) * (y1 - at->y);
}

static void paint_leaf(painter *p, const hewn_lane_tape *tape, const tile *at)
{
    const hewn_lane_image_desc *desc = p->on->desc;
    uint32_t x1 = end_of(at->x, LEAF, desc->width), y1 = end_of(at->y, LEAF, desc->height);
    hewn_lane_points points;
    for (uint32_t i = 0; i < HEWN_LANES; i++) {
        uint32_t x = at->x + i % LEAF, y = at->y + i / LEAF;
        points.at[0][i] = desc->x[x < x1 ? x : x1 - 1];
        points.at[1][i] = desc->y[y < y1 ? y : y1 - 1];
        points.at[2][i] = desc->z;
    }
    float values[HEWN_LANES];
    hewn_lanes_value(tape, &p->work, &points, HEWN_LANES, values);
    for (uint32_t y = at->y; y < y1; y++)
        for (uint32_t x = at->x; x < x1; x++) {
            float value = values[(y - at->y) * LEAF + x - at->x];
            size_t place = (size_t)y * desc->width + x;
            if (p->on->inside)
                p->on->inside[place] = value < 0;
            else
                p->on->values[place] = value;
        }
    p->stats.value_steps += (uint64_t)hewn_lane_tape_length(tape) * (x1 - at->x) * (y1 - at->y);
}

static uint32_t divide(const hewn_lane_image_desc *desc, const tile *at, tile out[MOST_PARTS])
{
    uint32_t size = at->size == 2 * LEAF ? LEAF : at->size / RATIO, count = 0;
    for (uint32_t y = at->y; y < end_of(at->y, at->size, desc->height); y += size)
        for (uint32_t x = at->x; x < end_of(at->x, at->size, desc->width); x += size)
            out[count++] = (tile){x, y, size};
    return count;
}

static hewn_result paint_parts(painter *p, const hewn_lane_tape *tape, tile *parts, uint32_t count, hewn_error *error);

static hewn_result paint(painter *p, const hewn_lane_tape *tape, const tile *at, /* NOLINT(misc-no-recursion) */
                         hewn_error *error)
{
    if (at->size <= LEAF) {
        paint_leaf(p, tape, at);
        return HEWN_OK;
    }
    tile parts[MOST_PARTS];
    uint32_t count = divide(p->on->desc, at, parts);
    return paint_parts(p, tape, parts, count, error);
}

/* Tiles are bounded together, and the tapes of all that are not decided are cut before their own parts take the place
 * of these bounds. */
static hewn_result paint_parts(painter *p, const hewn_lane_tape *tape, tile *parts, /* NOLINT(misc-no-recursion) */
                               uint32_t count, hewn_error *error)
{
    hewn_lane_tape *cuts[MOST_PARTS] = {NULL};
    float lo[HEWN_LANES], hi[HEWN_LANES];
    hewn_lane_boxes boxes;
    if (count == 0)
        return HEWN_OK;
    uint32_t left = 0, lanes = box_tiles(p->on->desc, parts, count, &boxes);
    hewn_lanes_bound(tape, &p->work, &boxes, lanes, lo, hi);
    p->stats.bound_steps += (uint64_t)hewn_lane_tape_length(tape) * count;
    hewn_result result = HEWN_OK;
    for (uint32_t i = 0; i < count && result == HEWN_OK; i++) {
        if (p->on->inside && (lo[i] >= 0 || hi[i] < 0)) {
            fill_tile(p, &parts[i], hi[i] < 0);
            continue;
        }
        parts[left] = parts[i];
        if (lo[i] > -INFINITY)
            result = hewn_lane_tape_cut(tape, &p->work, i, &cuts[left], error);
        left++;
    }
    for (uint32_t i = 0; i < left; i++) {
        if (result == HEWN_OK)
            result = paint(p, cuts[i] ? cuts[i] : tape, &parts[i], error);
        hewn_lane_tape_destroy(&cuts[i]);
    }
    return result;
}

/* The largest tiles: few enough that the whole field is asked about few. */
static uint32_t top_size(const hewn_lane_image_desc *desc)
{
    uint32_t size = LEAF;
    while ((uint64_t)((desc->width + size - 1) / size) * ((desc->height + size - 1) / size) > MOST_TOP_TILES)
        size *= 2;
    return size;
}

/* The largest tiles number `first` and after, as many as there are boxes in a block. */
static hewn_result paint_block(painter *p, const hewn_lane_tape *whole, uint64_t first, uint32_t size,
                               hewn_error *error)
{
    const hewn_lane_image_desc *desc = p->on->desc;
    uint32_t across = (desc->width + size - 1) / size, down = (desc->height + size - 1) / size, count = 0;
    tile parts[HEWN_LANE_BLOCK];
    for (uint64_t i = first; i < first + HEWN_LANE_BLOCK && i < (uint64_t)across * down; i++)
        parts[count++] = (tile){(uint32_t)(i % across) * size, (uint32_t)(i / across) * size, size};
    return paint_parts(p, whole, parts, count, error);
}

/* A progress callback is called by one thread at a time, from whichever is at work. */
static hewn_result report(const painting *on, uint64_t done, uint64_t all, hewn_error *error)
{
    return hewn_progress_report(on->desc->progress, "evaluate", (double)done / (double)all, error);
}

static void add_stats(hewn_lane_image_stats *to, const hewn_lane_image_stats *from)
{
    to->value_steps += from->value_steps;
    to->bound_steps += from->bound_steps;
    to->filled += from->filled;
}

static hewn_result paint_all(const painting *on, const hewn_lane_tape *whole, hewn_lane_image_stats *stats,
                             hewn_error *error)
{
    uint32_t size = top_size(on->desc);
    uint64_t tiles = (uint64_t)((on->desc->width + size - 1) / size) * ((on->desc->height + size - 1) / size);
    uint64_t blocks = (tiles + HEWN_LANE_BLOCK - 1) / HEWN_LANE_BLOCK, done = 0;
    hewn_result all = HEWN_OK;
    hewn_error reason = {0};
#pragma omp parallel
    {
        painter p = {.on = on};
        hewn_error own = {0};
        hewn_result result = hewn_lane_work_create(whole, &p.work, &own);
#pragma omp for schedule(dynamic)
        for (uint64_t i = 0; i < blocks; i++) {
            bool stopped;
#pragma omp critical(hewn_lanes_image)
            {
                if (result == HEWN_OK && all == HEWN_OK)
                    result = report(on, done++, blocks, &own);
                if (result != HEWN_OK && all == HEWN_OK) {
                    all = result;
                    reason = own;
                }
                stopped = all != HEWN_OK;
            }
            if (!stopped)
                result = paint_block(&p, whole, HEWN_LANE_BLOCK * i, size, &own);
        }
#pragma omp critical(hewn_lanes_image)
        {
            if (result != HEWN_OK && all == HEWN_OK) {
                all = result;
                reason = own;
            }
            add_stats(stats, &p.stats);
        }
        hewn_lane_work_destroy(&p.work);
    }
    if (all != HEWN_OK && error)
        *error = reason;
    return all;
}

hewn_result hewn_lanes_inside(const hewn_lane_tape *whole, const hewn_lane_image_desc *desc, uint8_t *inside,
                              hewn_lane_image_stats *stats, hewn_error *error)
{
    *stats = (hewn_lane_image_stats){.whole_steps = hewn_lane_tape_length(whole)};
    return paint_all(&(painting){.desc = desc, .inside = inside}, whole, stats, error);
}

hewn_result hewn_lanes_values(const hewn_lane_tape *whole, const hewn_lane_image_desc *desc, float *values,
                              hewn_lane_image_stats *stats, hewn_error *error)
{
    *stats = (hewn_lane_image_stats){.whole_steps = hewn_lane_tape_length(whole)};
    return paint_all(&(painting){.desc = desc, .values = values}, whole, stats, error);
}
