#include "field/sampling.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"

enum { BRICK = HEWN_SAMPLING_BRICK, SIDE = HEWN_SAMPLING_SIDE, NODE_WORDS = 3 };

static bool is_flat(const uint32_t cells[3])
{
    return cells[2] == 0;
}

static uint32_t brick_words(const uint32_t cells[3])
{
    return (uint32_t)(is_flat(cells) ? SIDE * SIDE : SIDE * SIDE * SIDE);
}

static void count_bricks(const uint32_t cells[3], uint32_t bricks[3])
{
    for (int i = 0; i < 3; i++)
        bricks[i] = cells[i] == 0 ? 1 : (cells[i] + BRICK - 1) / BRICK;
}

static uint64_t corner_count(const uint32_t cells[3], const uint32_t bricks[3])
{
    return (uint64_t)(bricks[0] + 1) * (bricks[1] + 1) * (is_flat(cells) ? 1 : bricks[2] + 1);
}

/* Levels up to the one whose blocks are one. */
static uint32_t count_levels(const uint32_t bricks[3])
{
    uint32_t most = bricks[0] > bricks[1] ? bricks[0] : bricks[1], level = 1;
    most = bricks[2] > most ? bricks[2] : most;
    while ((most + (1u << (level - 1)) - 1) >> (level - 1) > 1)
        level++;
    return level + 1;
}

static uint64_t level_nodes(const uint32_t bricks[3], uint32_t level)
{
    uint64_t nodes = 1;
    uint32_t size = level == 0 ? 0 : level - 1;
    for (int i = 0; i < 3; i++)
        nodes *= (bricks[i] + (1u << size) - 1) >> size;
    return nodes;
}

static uint64_t count_words(const uint32_t cells[3], uint64_t fine_count)
{
    uint32_t bricks[3];
    count_bricks(cells, bricks);
    uint64_t words = HEWN_SAMPLING_HEAD + (uint64_t)bricks[0] * bricks[1] * bricks[2] + corner_count(cells, bricks);
    for (uint32_t level = 0; level < count_levels(bricks); level++)
        words += NODE_WORDS * level_nodes(bricks, level);
    return words + fine_count * brick_words(cells);
}

uint64_t hewn_sampling_bytes(const uint32_t cells[3], uint64_t fine_count)
{
    return sizeof(hewn_sampling) + sizeof(uint32_t) * count_words(cells, fine_count);
}

/* --- life -------------------------------------------------------------------------------------------------------- */

static void lay_out(hewn_sampling *made, const uint8_t *fine)
{
    uint64_t count = (uint64_t)made->bricks[0] * made->bricks[1] * made->bricks[2];
    uint64_t at = HEWN_SAMPLING_HEAD + count + corner_count(made->cells, made->bricks);
    for (uint32_t level = 0; level < made->level_count; level++) {
        made->words[level] = (uint32_t)at;
        at += NODE_WORDS * level_nodes(made->bricks, level);
    }
    for (uint64_t b = 0; b < count; b++) {
        if (fine && !fine[b])
            continue;
        made->words[HEWN_SAMPLING_HEAD + b] = (uint32_t)at;
        at += brick_words(made->cells);
    }
}

hewn_result hewn_sampling_begin(const hewn_sampling_shape *shape, hewn_sampling **out, hewn_error *error)
{
    *out = NULL;
    uint32_t bricks[3];
    for (int i = 0; i < 3; i++)
        if (shape->cells[i] > HEWN_SAMPLING_CELLS_MOST)
            return hewn_fail(error, HEWN_LIMIT, "%u cells along %c are more than %d", shape->cells[i], "xyz"[i],
                             (int)HEWN_SAMPLING_CELLS_MOST);
    count_bricks(shape->cells, bricks);
    uint64_t count = (uint64_t)bricks[0] * bricks[1] * bricks[2], fine = shape->fine ? 0 : count;
    for (uint64_t b = 0; shape->fine && b < count; b++)
        fine += shape->fine[b] != 0;
    uint64_t words = count_words(shape->cells, fine);
    if (words > UINT32_MAX)
        return hewn_fail(error, HEWN_LIMIT, "a sampling holds at most 16 GiB of samples, not %.1f",
                         (double)words * 0x1p-28);
    hewn_sampling *made = hewn_alloc_zero(1, sizeof *made + words * sizeof(uint32_t));
    if (!made)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %.1f MiB of samples", (double)words * 0x1p-18);
    atomic_init(&made->uses, 1);
    memcpy(made->cells, shape->cells, sizeof made->cells);
    memcpy(made->bricks, bricks, sizeof bricks);
    made->endless = shape->endless;
    made->level_count = count_levels(bricks);
    made->fine_count = fine;
    made->word_count = words;
    lay_out(made, shape->fine);
    *out = made;
    return HEWN_OK;
}

hewn_sampling *hewn_sampling_share(const hewn_sampling *sampling)
{
    hewn_sampling *shared = (hewn_sampling *)sampling; /* but for the count of its users it is constant */
    atomic_fetch_add(&shared->uses, 1);
    return shared;
}

void hewn_sampling_destroy(hewn_sampling **sampling)
{
    if (!sampling || !*sampling)
        return;
    if (atomic_fetch_sub(&(*sampling)->uses, 1) == 1)
        hewn_free(*sampling);
    *sampling = NULL;
}

uint64_t hewn_sampling_size(const hewn_sampling *sampling)
{
    return sampling ? sizeof *sampling + sampling->word_count * sizeof(uint32_t) : 0;
}

/* --- samples ----------------------------------------------------------------------------------------------------- */

float *hewn_sampling_brick(const hewn_sampling *sampling, uint64_t brick)
{
    uint32_t at = sampling->words[HEWN_SAMPLING_HEAD + brick];
    return at ? (float *)(void *)((uint32_t *)sampling->words + at) : NULL;
}

float *hewn_sampling_corners(const hewn_sampling *sampling)
{
    uint64_t count = (uint64_t)sampling->bricks[0] * sampling->bricks[1] * sampling->bricks[2];
    return (float *)(void *)((uint32_t *)sampling->words + HEWN_SAMPLING_HEAD + count);
}

/* --- where fine bricks meet coarse ones -------------------------------------------------------------------------- */

static uint64_t brick_number(const hewn_sampling *s, const uint32_t at[3])
{
    return at[0] + (uint64_t)s->bricks[0] * (at[1] + (uint64_t)s->bricks[1] * at[2]);
}

/* The value that a coarse brick would have at a sample of this one's own. */
static float between_corners(const hewn_sampling *s, const uint32_t at[3], const uint32_t k[3])
{
    const float *corners = hewn_sampling_corners(s);
    uint64_t row = s->bricks[0] + 1, layer = row * (s->bricks[1] + 1);
    double value = 0;
    for (uint32_t c = 0; c < 8; c++) {
        double weight = 1;
        uint64_t place = 0;
        for (int i = 0; i < 3; i++) {
            uint32_t far = c >> i & 1;
            weight *= far ? k[i] / 8.0 : 1 - k[i] / 8.0;
            place += (at[i] + far) * (i == 0 ? 1 : i == 1 ? row : layer);
        }
        value += weight == 0 ? 0 : weight * (double)corners[place];
    }
    return (float)value;
}

/* Samples on what this brick shares with a coarse neighbour in direction `way`: a side or an edge. */
static void fit_to(const hewn_sampling *s, const uint32_t at[3], const int way[3], float *samples)
{
    uint32_t from[3], to[3], k[3];
    for (int i = 0; i < 3; i++) {
        from[i] = way[i] > 0 ? BRICK : 0;
        to[i] = way[i] < 0 ? 0 : BRICK;
    }
    for (k[2] = from[2]; k[2] <= to[2]; k[2]++)
        for (k[1] = from[1]; k[1] <= to[1]; k[1]++)
            for (k[0] = from[0]; k[0] <= to[0]; k[0]++)
                samples[k[0] + SIDE * (k[1] + SIDE * k[2])] = between_corners(s, at, k);
}

static void fit_brick(const hewn_sampling *s, const uint32_t at[3])
{
    float *samples = hewn_sampling_brick(s, brick_number(s, at));
    if (!samples)
        return;
    for (int n = 0; n < 27; n++) {
        const int way[3] = {n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
        uint32_t other[3];
        bool there = abs(way[0]) + abs(way[1]) + abs(way[2]) <= 2 && n != 13;
        for (int i = 0; i < 3; i++) {
            other[i] = at[i] + (uint32_t)way[i];
            there = there && other[i] < s->bricks[i];
        }
        if (there && s->words[HEWN_SAMPLING_HEAD + brick_number(s, other)] == 0)
            fit_to(s, at, way, samples);
    }
}

/* --- the pyramid ------------------------------------------------------------------------------------------------- */

typedef struct extent {
    float least, greatest, steepest;
} extent;

static const extent no_extent = {INFINITY, -INFINITY, 0};

static void widen(extent *own, extent other)
{
    own->least = other.least < own->least ? other.least : own->least;
    own->greatest = other.greatest > own->greatest ? other.greatest : own->greatest;
    own->steepest = other.steepest > own->steepest ? other.steepest : own->steepest;
}

/* Each derivative of a trilinear cell is a mean of the differences along its four edges that way. */
static double cell_steepness(const float *at, size_t row, size_t layer)
{
    const float v[8] = {at[0],     at[1],         at[row],         at[row + 1],
                        at[layer], at[layer + 1], at[layer + row], at[layer + row + 1]};
    double sum = 0;
    for (int axis = 0; axis < 3; axis++) {
        double most = 0;
        int step = 1 << axis;
        for (int c = 0; c < 8; c++)
            if (!(c & step))
                most = fmax(most, fabs((double)v[c + step] - (double)v[c]));
        sum += most * most;
    }
    return sqrt(sum);
}

static float up(double value)
{
    float near = (float)value;
    return (double)near < value ? nextafterf(near, INFINITY) : near;
}

/* `cells` along each axis (0: one layer), distances of samples `apart`. */
static extent extent_of(const float *samples, const uint32_t cells[3], size_t row, size_t layer, double apart)
{
    extent out = no_extent;
    double steepest = 0;
    for (uint32_t z = 0; z <= cells[2]; z++)
        for (uint32_t y = 0; y <= cells[1]; y++)
            for (uint32_t x = 0; x <= cells[0]; x++) {
                const float *at = samples + x + row * y + layer * z;
                widen(&out, (extent){*at, *at, 0});
                if (x < cells[0] && y < cells[1] && (z < cells[2] || cells[2] == 0))
                    steepest = fmax(steepest, cell_steepness(at, row, layer));
            }
    out.steepest = up(steepest / apart);
    return out;
}

static extent brick_extent(const hewn_sampling *s, const uint32_t at[3])
{
    bool flat = is_flat(s->cells);
    const float *samples = hewn_sampling_brick(s, brick_number(s, at));
    uint32_t cells[3] = {BRICK, BRICK, flat ? 0 : BRICK};
    if (samples)
        return extent_of(samples, cells, SIDE, flat ? 0 : SIDE * SIDE, 1);
    size_t row = s->bricks[0] + 1, layer = row * (s->bricks[1] + 1);
    uint32_t one[3] = {1, 1, flat ? 0 : 1};
    return extent_of(hewn_sampling_corners(s) + at[0] + row * at[1] + layer * at[2], one, row, flat ? 0 : layer, BRICK);
}

static extent *entry_of(const hewn_sampling *s, uint32_t level, const uint32_t at[3])
{
    uint64_t place =
        at[0] + hewn_sampling_entries(s, 0, level) * (at[1] + (uint64_t)hewn_sampling_entries(s, 1, level) * at[2]);
    return (extent *)(void *)((uint32_t *)s->words + s->words[level] + NODE_WORDS * place);
}

/* Of level 1 from bricks. A block twice as long and the next one are the entries below at its begin and at the next
 * one's. */
static extent block_extent(const hewn_sampling *s, uint32_t level, const uint32_t at[3])
{
    extent out = no_extent;
    for (uint32_t c = 0; c < 8; c++) {
        uint32_t part[3];
        bool there = true;
        for (int i = 0; i < 3; i++) {
            uint32_t far = c >> i & 1;
            part[i] = level == 1 ? at[i] + far : 2 * (at[i] + far);
            there = there && part[i] < hewn_sampling_entries(s, i, level - 1);
        }
        if (there)
            widen(&out, *entry_of(s, level - 1, part));
    }
    return out;
}

static void make_level(const hewn_sampling *s, uint32_t level)
{
    uint32_t entries[3];
    for (int i = 0; i < 3; i++)
        entries[i] = hewn_sampling_entries(s, i, level);
    uint64_t count = (uint64_t)entries[0] * entries[1] * entries[2];
#pragma omp parallel for schedule(dynamic, 64)
    for (uint64_t b = 0; b < count; b++) {
        const uint32_t at[3] = {(uint32_t)(b % entries[0]), (uint32_t)(b / entries[0] % entries[1]),
                                (uint32_t)(b / ((uint64_t)entries[0] * entries[1]))};
        *entry_of(s, level, at) = level == 0 ? brick_extent(s, at) : block_extent(s, level, at);
    }
}

/* The least sample on the two sides of the lattice across an axis. */
static double least_at_sides(const hewn_sampling *s, int axis)
{
    int u = (axis + 1) % 3, v = (axis + 2) % 3;
    double least = INFINITY;
#pragma omp parallel for reduction(min : least)
    for (uint32_t j = 0; j <= s->cells[v]; j++)
        for (uint32_t i = 0; i <= s->cells[u]; i++)
            for (int side = -1; side <= 1; side += 2) {
                double at[3];
                at[axis] = 0.5 * side * s->cells[axis];
                at[u] = i - 0.5 * s->cells[u];
                at[v] = j - 0.5 * s->cells[v];
                least = fmin(least, hewn_sampling_value(s, at, NULL));
            }
    return least;
}

void hewn_sampling_finish(hewn_sampling *s)
{
    uint64_t count = (uint64_t)s->bricks[0] * s->bricks[1] * s->bricks[2];
    if (s->fine_count < count) {
#pragma omp parallel for schedule(dynamic, 64)
        for (uint64_t b = 0; b < count; b++)
            fit_brick(s, (const uint32_t[3]){(uint32_t)(b % s->bricks[0]), (uint32_t)(b / s->bricks[0] % s->bricks[1]),
                                             (uint32_t)(b / ((uint64_t)s->bricks[0] * s->bricks[1]))});
    }
    for (uint32_t level = 0; level < s->level_count; level++)
        make_level(s, level);
    extent all = no_extent;
    uint64_t last = level_nodes(s->bricks, s->level_count - 1);
    for (uint64_t i = 0; i < last; i++)
        widen(&all, ((const extent *)(const void *)(s->words + s->words[s->level_count - 1]))[i]);
    s->least = all.least;
    s->greatest = all.greatest;
    s->steepest = all.steepest;
    s->enclosed = !s->endless;
    for (int axis = 0; axis < 3 && s->enclosed; axis++)
        s->enclosed = least_at_sides(s, axis) > 0;
}
