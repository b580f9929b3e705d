#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "mesh/soup.h"

/* Equal triples of doubles get equal numbers, in order of first appearance. */
typedef struct triple_table {
    const double *triples;
    uint32_t *slots; /* a number, or HEWN_NONE */
    uint32_t mask;
} triple_table;

static hewn_result create_table(triple_table *table, const double *triples, uint32_t count, hewn_error *error)
{
    uint64_t size = 16;
    while (size < 2 * (uint64_t)count)
        size *= 2;
    *table = (triple_table){triples, hewn_alloc(size, sizeof *table->slots), (uint32_t)(size - 1)};
    if (!table->slots)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory welding %u vertices", count);
    memset(table->slots, 0xFF, size * sizeof *table->slots);
    return HEWN_OK;
}

/* The slot where a triple is, or where it belongs. -0 + 0 is 0, so both zeros hash alike. */
static uint32_t *find_slot(const triple_table *table, const double key[3])
{
    uint64_t hash = 0;
    for (int axis = 0; axis < 3; axis++) {
        double value = key[axis] + 0.0;
        uint64_t bits;
        memcpy(&bits, &value, sizeof bits);
        hash = (hash ^ bits) * 0x9e3779b97f4a7c15u;
        hash ^= hash >> 29;
    }
    hash *= 0xbf58476d1ce4e5b9u;
    for (uint32_t at = (uint32_t)(hash >> 32) & table->mask;; at = (at + 1) & table->mask) {
        if (table->slots[at] == HEWN_NONE)
            return table->slots + at;
        const double *other = table->triples + 3 * (size_t)table->slots[at];
        if (other[0] == key[0] && other[1] == key[1] && other[2] == key[2])
            return table->slots + at;
    }
}

static hewn_result join_equal(const hewn_soup *soup, uint32_t *parent, hewn_error *error)
{
    triple_table table;
    HEWN_TRY(create_table(&table, soup->positions, soup->vertex_count, error));
    for (uint32_t v = 0; v < soup->vertex_count; v++) {
        uint32_t *slot = find_slot(&table, soup->positions + 3 * (size_t)v);
        if (*slot == HEWN_NONE)
            *slot = v;
        else
            parent[v] = *slot;
    }
    hewn_free(table.slots);
    return HEWN_OK;
}

/* --- vertices that are only near ---------------------------------------------------------------------------------- */

/* Cubes of 8 distances: wide enough that few points look into a neighbour, and so narrow that halving one a dozen times
 * gives lists that are near as a whole. Cube coordinates are whole numbers in doubles: past 2^53 cubes are narrower
 * than the spacing of doubles, and past the largest double one cube holds all the rest, which is slower but right. */
enum { CELL_DISTANCES = 8 };

typedef struct weld_grid {
    double distance, side;
    uint32_t cell_count;
    double *cells;   /* × 3 */
    uint32_t *first; /* cell_count + 1 */
    uint32_t *points;
    triple_table table;
} weld_grid;

static void free_grid(weld_grid *grid)
{
    hewn_free(grid->cells);
    hewn_free(grid->first);
    hewn_free(grid->points);
    hewn_free(grid->table.slots);
}

/* `cell_of` has room for every vertex. */
static hewn_result fill_grid(const hewn_soup *soup, const uint32_t *parent, weld_grid *grid, uint32_t *cell_of,
                             hewn_error *error)
{
    uint32_t count = soup->vertex_count;
    grid->cells = hewn_alloc(count, 3 * sizeof *grid->cells);
    grid->first = hewn_alloc_zero((size_t)count + 2, sizeof *grid->first);
    grid->points = hewn_alloc(count, sizeof *grid->points);
    if (!grid->cells || !grid->first || !grid->points)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory welding %u vertices", count);
    HEWN_TRY(create_table(&grid->table, grid->cells, count, error));
    for (uint32_t v = 0; v < count; v++) {
        if (parent[v] != v)
            continue;
        double *cell = grid->cells + 3 * (size_t)grid->cell_count;
        for (int axis = 0; axis < 3; axis++)
            cell[axis] = floor(soup->positions[3 * (size_t)v + axis] / grid->side);
        uint32_t *slot = find_slot(&grid->table, cell);
        if (*slot == HEWN_NONE)
            *slot = grid->cell_count++;
        cell_of[v] = *slot;
        grid->first[cell_of[v] + 2]++;
    }
    for (uint32_t c = 0; c < grid->cell_count; c++)
        grid->first[c + 2] += grid->first[c + 1];
    for (uint32_t v = 0; v < count; v++)
        if (parent[v] == v)
            grid->points[grid->first[cell_of[v] + 1]++] = v;
    return HEWN_OK;
}

/* Which neighbours a cell's points reach into: bit 0 the lower one, bit 1 its own, bit 2 the upper one, for each axis.
 */
static void find_reach(const hewn_soup *soup, const weld_grid *grid, uint32_t cell, unsigned reach[3])
{
    reach[0] = reach[1] = reach[2] = 2;
    for (uint32_t i = grid->first[cell]; i < grid->first[cell + 1]; i++)
        for (int axis = 0; axis < 3; axis++) {
            double x = soup->positions[3 * (size_t)grid->points[i] + axis];
            double at = grid->cells[3 * (size_t)cell + axis];
            reach[axis] |= (floor((x - grid->distance) / grid->side) < at ? 1u : 0u) |
                           (floor((x + grid->distance) / grid->side) > at ? 4u : 0u);
        }
}

/* Only to neighbours that come later in order of coordinates: the earlier ones look here. */
static void join_neighbours(const hewn_soup *soup, const weld_grid *grid, uint32_t cell, uint32_t *parent)
{
    unsigned reach[3];
    find_reach(soup, grid, cell, reach);
    if (reach[0] == 2 && reach[1] == 2 && reach[2] == 2)
        return;
    for (int i = 14; i < 27; i++) {
        const int step[3] = {i / 9 - 1, i / 3 % 3 - 1, i % 3 - 1};
        double key[3];
        bool reached = true;
        for (int axis = 0; axis < 3; axis++) {
            key[axis] = grid->cells[3 * (size_t)cell + axis] + step[axis];
            reached = reached && (reach[axis] >> (step[axis] + 1) & 1);
        }
        uint32_t other = reached ? *find_slot(&grid->table, key) : HEWN_NONE;
        if (other == HEWN_NONE || other == cell)
            continue;
        hewn_near_join(soup->positions, grid->distance, grid->points + grid->first[cell],
                       grid->first[cell + 1] - grid->first[cell], grid->points + grid->first[other],
                       grid->first[other + 1] - grid->first[other], parent);
    }
}

static hewn_result join_near(const hewn_soup *soup, double distance, uint32_t *parent, hewn_error *error)
{
    weld_grid grid = {.distance = distance, .side = distance * CELL_DISTANCES};
    uint32_t *cell_of = hewn_alloc(soup->vertex_count, sizeof *cell_of);
    hewn_result result = cell_of ? fill_grid(soup, parent, &grid, cell_of, error)
                                 : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory welding vertices");
    hewn_free(cell_of);
    if (result == HEWN_OK) {
        for (uint32_t c = 0; c < grid.cell_count; c++)
            hewn_near_join(soup->positions, distance, grid.points + grid.first[c], grid.first[c + 1] - grid.first[c],
                           NULL, 0, parent);
        for (uint32_t c = 0; c < grid.cell_count; c++)
            join_neighbours(soup, &grid, c, parent);
    }
    free_grid(&grid);
    return result;
}

/* Renumbers to the roots alone, in order. In ascending order a root is met before its members, and its entry becomes
 * its new number; a member then finds its root's. */
static void keep_roots(hewn_soup *soup, uint32_t *parent, hewn_repair_report *report)
{
    uint32_t count = 0, corners = hewn_soup_corner_count(soup);
    for (uint32_t v = 0; v < soup->vertex_count; v++)
        parent[v] = hewn_sets_find(parent, v);
    for (uint32_t v = 0; v < soup->vertex_count; v++) {
        if (parent[v] < v) {
            parent[v] = parent[parent[v]];
            continue;
        }
        memmove(soup->positions + 3 * (size_t)count, soup->positions + 3 * (size_t)v, 3 * sizeof(double));
        soup->vertex_origins[count] = soup->vertex_origins[v];
        parent[v] = count++;
    }
    for (uint32_t c = 0; c < corners; c++)
        soup->corners[c] = parent[soup->corners[c]];
    report->welded_vertices += soup->vertex_count - count;
    soup->vertex_count = count;
}

hewn_result hewn_soup_weld(hewn_soup *soup, double distance, hewn_repair_report *report, hewn_error *error)
{
    uint32_t *parent = hewn_sets_create(soup->vertex_count);
    if (!parent)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory welding %u vertices", soup->vertex_count);
    hewn_result result = join_equal(soup, parent, error);
    if (result == HEWN_OK && distance > 0)
        result = join_near(soup, distance, parent, error);
    if (result == HEWN_OK)
        keep_roots(soup, parent, report);
    hewn_free(parent);
    return result;
}
