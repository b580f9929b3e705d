#include "iso/host_dual.h"

#include "iso/grid.h"
#include "iso/host_quad.h"
#include "iso/host_walk.h"

static uint32_t bits(uint32_t mask)
{
    return (uint32_t)__builtin_popcount(mask);
}

static const uint32_t *entry_of(const hewn_host_dual *dual, uint32_t pattern, bool turned)
{
    return dual->table->words[2 * pattern + turned];
}

static uint32_t loop_count(const uint32_t *entry)
{
    return entry[0] & 7;
}

static uint32_t doubtful_face(const uint32_t *entry)
{
    return entry[0] >> 4;
}

static uint32_t loop_edges(const uint32_t *entry, uint32_t loop)
{
    return entry[1 + loop / 2] >> 16 * (loop & 1) & 0xFFF;
}

static uint32_t *loop_words(const hewn_host_dual *dual, uint32_t slot, uint32_t word)
{
    return dual->loops + (uint64_t)slot * HEWN_BRICK_DUAL_WORDS + (uint64_t)word * HEWN_DUAL_WORDS;
}

/* --- single cells ------------------------------------------------------------------------------------------------- */

/* The brick that owns sample `at` of a brick, which may lie one brick further along each axis. */
static uint32_t owner_slot(const hewn_host_surface *bricks, uint32_t slot, const uint32_t at[3])
{
    uint32_t link = at[0] >> 3 | at[1] >> 3 << 1 | at[2] >> 3 << 2;
    return link ? bricks->links[(uint64_t)slot * HEWN_BRICK_LINKS + link] : slot;
}

static uint32_t sample_number(const uint32_t at[3])
{
    return (at[0] & 7) | (at[1] & 7) << 3 | (at[2] & 7) << 6;
}

static uint32_t load_pattern(const hewn_host_surface *bricks, uint32_t slot, const uint32_t at[3])
{
    uint32_t pattern = 0;
    for (uint32_t corner = 0; corner < 8; corner++) {
        const uint32_t there[3] = {at[0] + (corner & 1), at[1] + (corner >> 1 & 1), at[2] + (corner >> 2)};
        uint32_t number = sample_number(there), owner = owner_slot(bricks, slot, there);
        uint32_t word = owner == HEWN_ALL_INSIDE    ? ~0u
                        : owner >= HEWN_ALL_OUTSIDE ? 0
                                                    : bricks->signs[(uint64_t)owner * HEWN_BRICK_WORDS + number / 32];
        pattern |= (word >> number % 32 & 1) << corner;
    }
    return pattern;
}

uint32_t hewn_host_dual_crossing(const hewn_host_surface *bricks, uint32_t slot, const uint32_t at[3], uint32_t edge)
{
    uint32_t axis = edge / 4, low = edge & 1, high = edge >> 1 & 1;
    const uint32_t there[3] = {at[0] + (axis == 0 ? 0 : low),
                               at[1] + (axis == 0   ? low
                                        : axis == 1 ? 0
                                                    : high),
                               at[2] + (axis == 2 ? 0 : high)};
    uint32_t owner = owner_slot(bricks, slot, there), number = sample_number(there);
    owner = owner < HEWN_ALL_OUTSIDE ? owner : slot;
    const uint32_t *pair =
        bricks->edges + 2 * ((uint64_t)owner * HEWN_BRICK_EDGE_WORDS + (uint64_t)axis * HEWN_BRICK_WORDS + number / 32);
    return pair[1] + bits(pair[0] & ((1u << number % 32) - 1));
}

/* --- quads of a layer --------------------------------------------------------------------------------------------- */

/* Cells that another one follows: along x, along y, along z. */
typedef struct followed {
    uint64_t below[2];
    uint32_t layers;
} followed;

static followed find_followed(const hewn_host_surface *bricks, uint32_t slot)
{
    hewn_host_surface inner = *bricks;
    for (int axis = 0; axis < 3; axis++)
        inner.cells[axis]--;
    walk own = walk_begin(&inner, slot);
    return (followed){{own.below[0], own.below[1]}, own.layers};
}

/* Bit i of mask `axis`: cell i of the layer owns a quad around its edge along that axis that is far along both others:
 * it is crossed and has four cells. */
static void own_quads(const walk *own, const followed *inner, uint64_t masks[3])
{
    uint64_t corner = own->upper.at[3];
    uint64_t exist = own->z < own->layers ? ~(uint64_t)0 : 0, more = own->z < inner->layers ? ~(uint64_t)0 : 0;
    masks[0] = (corner ^ own->upper.at[2]) & own->below[0] & inner->below[1] & more;
    masks[1] = (corner ^ own->upper.at[1]) & own->below[1] & inner->below[0] & more;
    masks[2] = (corner ^ own->lower.at[3]) & exist & inner->below[0] & inner->below[1];
}

/* --- counting ----------------------------------------------------------------------------------------------------- */

/* Writes what is known of a layer's cells but for those in doubt; returns the number of their loops. */
static uint32_t write_loops(const hewn_host_dual *dual, const walk *own, uint32_t slot, uint64_t *doubtful)
{
    uint64_t cells = surface_cells(own), low = 0, high = 0;
    *doubtful = 0;
    for (uint64_t rest = cells; rest != 0; rest &= rest - 1) {
        uint32_t bit = first_bit(rest);
        const uint32_t *entry = entry_of(dual, cell_pattern(own, bit), false);
        uint64_t further = loop_count(entry) - 1;
        low |= (further & 1) << bit;
        high |= further >> 1 << bit;
        *doubtful |= (uint64_t)(doubtful_face(entry) != HEWN_DUAL_NO_FACE) << bit;
    }
    for (uint32_t half = 0; half < 2; half++) {
        uint32_t *words = loop_words(dual, slot, 2 * own->z + half);
        words[HEWN_DUAL_CELLS] = (uint32_t)(cells >> 32 * half);
        words[HEWN_DUAL_LOW] = (uint32_t)(low >> 32 * half);
        words[HEWN_DUAL_HIGH] = (uint32_t)(high >> 32 * half);
        words[HEWN_DUAL_TURNED] = 0;
    }
    return (uint32_t)(__builtin_popcountll(cells) + __builtin_popcountll(low) + 2 * __builtin_popcountll(high));
}

/* Whether a cell's doubtful face is doubtful in the cell beyond it too. That cell has surface, so that its brick is
 * active, or it is not in the grid. */
static bool is_turned(const hewn_host_dual *dual, uint32_t slot, const uint32_t at[3], uint32_t face)
{
    const hewn_host_surface *bricks = &dual->bricks;
    uint32_t axis = face >> 1, beyond[3] = {at[0], at[1], at[2]};
    bool up = face & 1;
    uint32_t first = 8 * (bricks->bricks[slot] >> 10 * axis & 1023u);
    if (first + at[axis] == (up ? bricks->cells[axis] - 1 : 0))
        return false;
    if (!up && at[axis] == 0) {
        slot = dual->lower[(uint64_t)3 * slot + axis];
        beyond[axis] = 8;
    }
    if (slot >= HEWN_ALL_OUTSIDE)
        return false;
    beyond[axis] += up ? 1 : ~0u;
    return doubtful_face(entry_of(dual, load_pattern(bricks, slot, beyond), false)) == (face ^ 1);
}

/* Settles a layer's cells in doubt: a turned face makes two loops of their one. Returns how many were turned. */
static uint32_t settle_doubts(const hewn_host_dual *dual, const walk *own, uint32_t slot, uint64_t doubtful)
{
    uint32_t count = 0;
    for (; doubtful != 0; doubtful &= doubtful - 1) {
        uint32_t bit = first_bit(doubtful);
        const uint32_t at[3] = {bit & 7, bit >> 3, own->z};
        if (!is_turned(dual, slot, at, doubtful_face(entry_of(dual, cell_pattern(own, bit), false))))
            continue;
        uint32_t *words = loop_words(dual, slot, 2 * own->z + bit / 32);
        words[HEWN_DUAL_LOW] |= 1u << bit % 32;
        words[HEWN_DUAL_TURNED] |= 1u << bit % 32;
        count++;
    }
    return count;
}

static void count_brick(const hewn_host_dual *dual, uint32_t slot)
{
    const hewn_host_surface *bricks = &dual->bricks;
    const followed inner = find_followed(bricks, slot);
    walk own = walk_begin(bricks, slot);
    uint32_t crossings = 0, vertices = 0, quads = 0;
    for (uint32_t z = 0; z < 8; z++) {
        uint64_t masks[3], doubtful;
        walk_to(&own, z);
        crossings += write_crossed(&own, bricks->edges + (uint64_t)2 * slot * HEWN_BRICK_EDGE_WORDS);
        vertices += write_loops(dual, &own, slot, &doubtful);
        vertices += settle_doubts(dual, &own, slot, doubtful);
        own_quads(&own, &inner, masks);
        for (int axis = 0; axis < 3; axis++)
            quads += (uint32_t)__builtin_popcountll(masks[axis]);
    }
    bricks->vertex_bases[slot] = crossings;
    dual->vertex_bases[slot] = vertices;
    bricks->triangle_bases[slot] = quads;
}

/* Tells each brick's upper neighbours that it is their lower one. */
static void link_lower(const hewn_host_dual *dual)
{
    const hewn_host_surface *bricks = &dual->bricks;
    for (uint64_t i = 0; i < (uint64_t)3 * bricks->count; i++)
        dual->lower[i] = HEWN_ALL_OUTSIDE;
    for (uint32_t slot = 0; slot < bricks->count; slot++)
        for (uint32_t axis = 0; axis < 3; axis++) {
            uint32_t upper = bricks->links[(uint64_t)slot * HEWN_BRICK_LINKS + (1u << axis)];
            if (upper < HEWN_ALL_OUTSIDE)
                dual->lower[(uint64_t)3 * upper + axis] = slot;
        }
}

void hewn_host_dual_count(const hewn_host_dual *dual, uint32_t totals[6])
{
    uint32_t count = dual->bricks.count;
    link_lower(dual);
#pragma omp parallel for schedule(dynamic, SHARE) if (count >= ALONE)
    for (uint32_t slot = 0; slot < count; slot++)
        count_brick(dual, slot);
    sum_before_each(dual->bricks.vertex_bases, count, totals);
    sum_before_each(dual->vertex_bases, count, totals + 2);
    sum_before_each(dual->bricks.triangle_bases, count, totals + 4);
}

/* --- spreading ---------------------------------------------------------------------------------------------------- */

static void spread_brick(const hewn_host_dual *dual, uint32_t slot)
{
    walk own = walk_begin(&dual->bricks, slot);
    uint32_t vertex = dual->vertex_bases[slot];
    for (uint32_t word = 0; word < HEWN_BRICK_WORDS; word++) {
        uint32_t *words = loop_words(dual, slot, word), turned = words[HEWN_DUAL_TURNED];
        words[HEWN_DUAL_FIRST] = vertex;
        if (word % 2 == 0)
            walk_to(&own, word / 2);
        for (uint32_t cells = words[HEWN_DUAL_CELLS]; cells != 0; cells &= cells - 1) {
            uint32_t bit = first_bit(cells);
            const uint32_t *entry = entry_of(dual, cell_pattern(&own, 32 * (word % 2) + bit), (turned >> bit & 1) != 0);
            for (uint32_t loop = 0; loop < loop_count(entry); loop++, vertex++) {
                uint32_t *record = (uint32_t *)dual->positions + (uint64_t)3 * vertex;
                record[0] = slot;
                record[1] = (32 * word + bit) + 512 * loop_edges(entry, loop);
                record[2] = loop_count(entry);
                dual->passed[vertex] = loop_edges(entry, loop);
            }
        }
    }
}

void hewn_host_dual_spread(const hewn_host_dual *dual)
{
    hewn_host_surface_spread(&dual->bricks);
#pragma omp parallel for schedule(dynamic, SHARE) if (dual->bricks.count >= ALONE)
    for (uint32_t slot = 0; slot < dual->bricks.count; slot++)
        spread_brick(dual, slot);
}

/* --- quads -------------------------------------------------------------------------------------------------------- */

/* The vertex of the loop that passes an edge of a cell. */
static uint32_t loop_vertex(const hewn_host_dual *dual, uint32_t slot, const uint32_t at[3], uint32_t edge)
{
    uint32_t number = sample_number(at), bit = number % 32, before = (1u << bit) - 1;
    const uint32_t *words = loop_words(dual, owner_slot(&dual->bricks, slot, at), number / 32);
    uint32_t low = words[HEWN_DUAL_LOW], high = words[HEWN_DUAL_HIGH];
    uint32_t vertex =
        words[HEWN_DUAL_FIRST] + bits(words[HEWN_DUAL_CELLS] & before) + bits(low & before) + 2 * bits(high & before);
    uint32_t last = vertex + (low >> bit & 1) + 2 * (high >> bit & 1);
    while (vertex < last && (dual->passed[vertex] >> edge & 1) == 0)
        vertex++;
    return vertex;
}

/* The edge along `axis` of the cell at `at` that is far along both other axes is the quad's; its vertices in order. */
static void load_corners(const hewn_host_dual *dual, uint32_t slot, const uint32_t at[3], uint32_t axis, bool inside,
                         uint32_t corners[4])
{
    uint32_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (uint32_t i = 0; i < 4; i++) {
        /* (axis, u, v) is right-handed: from u to v is counter-clockwise seen from the edge's end, which is outside
         * where the edge starts inside. */
        bool one = i == 1 || i == 2, other = i >= 2;
        uint32_t at_u = inside ? one : other, at_v = inside ? other : one, cell[3] = {at[0], at[1], at[2]};
        cell[u] += at_u;
        cell[v] += at_v;
        uint32_t bit_u = !at_u, bit_v = !at_v; /* where the edge is in that cell */
        corners[i] = loop_vertex(dual, slot, cell, 4 * axis + (u < v ? bit_u | bit_v << 1 : bit_v | bit_u << 1));
    }
}

/* Its two triangles, and what a fan in their place would need. */
static void write_quad(const hewn_host_dual *dual, uint32_t slot, const uint32_t at[3], uint32_t axis, bool inside,
                       uint64_t quad)
{
    static const uint32_t order[6] = {0, 1, 2, 0, 2, 3};
    uint32_t corners[4], crossing = hewn_host_dual_crossing(&dual->bricks, slot, at, 4 * axis + 3);
    float places[4][3], low[3];
    load_corners(dual, slot, at, axis, inside, corners);
    uint32_t start[3];
    for (uint32_t i = 0; i < 3; i++) {
        start[i] = 8 * (dual->bricks.bricks[slot] >> 10 * i & 1023u) + at[i] + (i != axis);
        low[i] = hewn_grid_sample(&dual->grid, i, start[i]);
        for (uint32_t k = 0; k < 4; k++)
            places[k][i] = dual->positions[(uint64_t)3 * corners[k] + i];
    }
    float high = hewn_grid_sample(&dual->grid, axis, start[axis] + 1);
    float *point = dual->points + (uint64_t)3 * crossing, surface = point[axis];
    hewn_quad_cut cut = hewn_quad_cut_find((const float(*)[3])places, low, high, surface, axis);
    bool fan = dual->keep == HEWN_KEEP_FANS && cut.fan;
    if (dual->keep != HEWN_KEEP_NONE)
        dual->crossings[quad] = fan || dual->keep == HEWN_KEEP_ALL ? crossing : HEWN_NO_FAN;
    if (fan) {
        low[axis] = hewn_quad_fan_height(low[axis], high, surface);
        for (uint32_t i = 0; i < 3; i++)
            point[i] = low[i];
    }
    for (uint32_t i = 0; i < 6; i++)
        dual->indices[6 * quad + i] = corners[(order[i] + cut.turn) & 3];
}

/* Word by word and axis by axis: the order in which the kernel numbers quads. */
static void write_quads(const hewn_host_dual *dual, uint32_t slot)
{
    const followed inner = find_followed(&dual->bricks, slot);
    walk own = walk_begin(&dual->bricks, slot);
    uint64_t quad = dual->bricks.triangle_bases[slot];
    for (uint32_t z = 0; z < 8; z++) {
        uint64_t masks[3];
        walk_to(&own, z);
        own_quads(&own, &inner, masks);
        const uint64_t inside[3] = {own.upper.at[2], own.upper.at[1], own.lower.at[3]};
        for (uint32_t half = 0; half < 2; half++)
            for (uint32_t axis = 0; axis < 3; axis++)
                for (uint64_t mask = masks[axis] & 0xFFFFFFFFull << 32 * half; mask != 0; mask &= mask - 1) {
                    uint32_t bit = first_bit(mask);
                    const uint32_t at[3] = {bit & 7, bit >> 3, z};
                    write_quad(dual, slot, at, axis, inside[axis] >> bit & 1, quad++);
                }
    }
}

void hewn_host_dual_quads(const hewn_host_dual *dual, uint32_t first, uint32_t end)
{
#pragma omp parallel for schedule(dynamic, SHARE) if (end - first >= ALONE)
    for (uint32_t slot = first; slot < end; slot++)
        write_quads(dual, slot);
}
