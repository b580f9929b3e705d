#include "dual.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "iso/cube.h"
#include "iso/grid.h"
#include "iso/quadric.h"

/* --- cells -------------------------------------------------------------------------------------------------------- */

typedef struct sampled {
    uint32_t cells[3];
    const bool *inside;
    bool flip;
} sampled;

static bool sign_at(const sampled *grid, const uint32_t at[3])
{
    size_t row = grid->cells[0] + 1, slice = row * (grid->cells[1] + 1);
    return grid->inside[at[0] + row * at[1] + slice * at[2]];
}

static uint32_t pattern_of(const sampled *grid, const uint32_t cell[3])
{
    uint32_t pattern = 0;
    for (uint32_t corner = 0; corner < 8; corner++) {
        uint32_t at[3] = {cell[0] + (corner & 1), cell[1] + (corner >> 1 & 1), cell[2] + (corner >> 2 & 1)};
        pattern |= (sign_at(grid, at) ? 1u : 0u) << corner;
    }
    return pattern;
}

/* The cuts on a face: pairs of edges. */
static uint32_t face_cuts(uint32_t pattern, uint32_t face, bool flipped, uint32_t cuts[2][2])
{
    uint32_t corner[4], crossed[4], crossings = 0, count = 0;
    hewn_cube_face_corners(face, corner);
    for (uint32_t i = 0; i < 4; i++)
        if ((pattern >> corner[i] & 1) != (pattern >> corner[(i + 1) % 4] & 1))
            crossed[crossings++] = hewn_cube_edge_between(corner[i], corner[(i + 1) % 4]);
    if (crossings == 2) {
        cuts[0][0] = crossed[0];
        cuts[0][1] = crossed[1];
        return 1;
    }
    if (crossings == 0)
        return 0;
    for (uint32_t i = 0; i < 4; i++) {
        if ((pattern >> corner[i] & 1) == flipped)
            continue; /* corners of the other sign are those cut off */
        cuts[count][0] = hewn_cube_edge_between(corner[(i + 3) % 4], corner[i]);
        cuts[count++][1] = hewn_cube_edge_between(corner[i], corner[(i + 1) % 4]);
    }
    return count;
}

/* loop[e]: the lowest edge of the loop that passes e; 12 where none does. */
static void follow(uint32_t pattern, uint32_t flips, uint32_t loop[12])
{
    bool changed = true;
    for (uint32_t edge = 0; edge < 12; edge++) {
        uint32_t start = hewn_cube_edge_start(edge), end = start | 1u << edge / 4;
        loop[edge] = (pattern >> start & 1) != (pattern >> end & 1) ? edge : 12;
    }
    while (changed) {
        changed = false;
        for (uint32_t face = 0; face < 6; face++) {
            uint32_t cuts[2][2], count = face_cuts(pattern, face, flips >> face & 1, cuts);
            for (uint32_t i = 0; i < count; i++) {
                uint32_t *a = &loop[cuts[i][0]], *b = &loop[cuts[i][1]], least = *a < *b ? *a : *b;
                changed |= *a != *b;
                *a = *b = least;
            }
        }
    }
}

/* Whether both cuts on an ambiguous face belong to one loop when all faces have their outside joined. */
static bool is_problem(uint32_t pattern, uint32_t face)
{
    uint32_t cuts[2][2], loop[12];
    if (face_cuts(pattern, face, false, cuts) < 2)
        return false;
    follow(pattern, 0, loop);
    return loop[cuts[0][0]] == loop[cuts[1][0]];
}

static uint32_t flips_of(const sampled *grid, const uint32_t cell[3], uint32_t pattern)
{
    uint32_t flips = 0;
    for (uint32_t face = 0; face < 6; face++) {
        uint32_t axis = face / 2, beside[3] = {cell[0], cell[1], cell[2]};
        if (!grid->flip || !is_problem(pattern, face) || (face & 1 ? cell[axis] + 1 == grid->cells[axis] : !cell[axis]))
            continue;
        beside[axis] += face & 1 ? 1 : UINT32_MAX;
        if (is_problem(pattern_of(grid, beside), face ^ 1))
            flips |= 1u << face;
    }
    return flips;
}

/* --- the whole grid ------------------------------------------------------------------------------------------------
 */

static void *grown(void *block, uint32_t count, size_t size)
{
    bool full = count == 0 || (count >= 64 && (count & (count - 1)) == 0);
    void *room = full ? realloc(block, (count ? 2 * (size_t)count : 64) * size) : block;
    assert(room);
    return room;
}

static void add_cell(const sampled *grid, const uint32_t cell[3], uint32_t *names, oracle_dual *out)
{
    uint32_t pattern = pattern_of(grid, cell), loop[12];
    uint32_t flips = pattern == 0 || pattern == 255 ? 0 : flips_of(grid, cell, pattern);
    follow(pattern, flips, loop);
    for (uint32_t face = 1; face < 6; face += 2) /* each face from its lower cell */
        out->flips += flips >> face & 1;
    for (uint32_t edge = 0; edge < 12; edge++) {
        if (loop[edge] == edge) {
            out->cells = grown(out->cells, out->vertex_count, 3 * sizeof *out->cells);
            out->loops = grown(out->loops, out->vertex_count, sizeof *out->loops);
            memcpy(&out->cells[3 * (size_t)out->vertex_count], cell, 3 * sizeof *cell);
            out->loops[out->vertex_count] = 0;
            names[edge] = out->vertex_count++;
        }
        if (loop[edge] < 12) {
            names[edge] = names[loop[edge]];
            out->loops[names[edge]] |= 1u << edge;
        }
    }
}

/* The quad around the grid edge that starts at a sample, if it is crossed and has four cells. */
static void add_quad(const sampled *grid, const uint32_t at[3], uint32_t axis, const uint32_t *names, oracle_dual *out)
{
    static const uint32_t around[4][2] = {{1, 1}, {0, 1}, {0, 0}, {1, 0}}; /* where the edge lies in each cell */
    uint32_t u = (axis + 1) % 3, v = (axis + 2) % 3, end[3] = {at[0], at[1], at[2]};
    end[axis]++;
    if (at[u] == 0 || at[v] == 0 || at[u] == grid->cells[u] || at[v] == grid->cells[v] ||
        sign_at(grid, at) == sign_at(grid, end))
        return;
    out->quads = grown(out->quads, out->quad_count, 4 * sizeof *out->quads);
    out->edges = grown(out->edges, out->quad_count, 4 * sizeof *out->edges);
    uint32_t *quad = &out->quads[4 * (size_t)out->quad_count], *edge = &out->edges[4 * (size_t)out->quad_count];
    for (uint32_t i = 0; i < 4; i++) {
        uint32_t cell[3] = {at[0], at[1], at[2]}, start = around[i][0] << u | around[i][1] << v;
        cell[u] -= around[i][0];
        cell[v] -= around[i][1];
        size_t number = cell[0] + (size_t)grid->cells[0] * (cell[1] + (size_t)grid->cells[1] * cell[2]);
        quad[sign_at(grid, at) ? i : 3 - i] = names[12 * number + hewn_cube_edge_between(start, start | 1u << axis)];
    }
    memcpy(edge, at, 3 * sizeof *at);
    edge[3] = axis;
    out->quad_count++;
}

oracle_dual oracle_dual_trace(const uint32_t cells[3], const bool *inside, bool flip)
{
    sampled grid = {.cells = {cells[0], cells[1], cells[2]}, .inside = inside, .flip = flip};
    oracle_dual out = {0};
    uint32_t *names = malloc(12 * (size_t)cells[0] * cells[1] * cells[2] * sizeof *names);
    assert(names);
    size_t number = 0;
    for (uint32_t z = 0; z < cells[2]; z++)
        for (uint32_t y = 0; y < cells[1]; y++)
            for (uint32_t x = 0; x < cells[0]; x++)
                add_cell(&grid, (uint32_t[3]){x, y, z}, &names[12 * number++], &out);
    for (uint32_t z = 0; z <= cells[2]; z++)
        for (uint32_t y = 0; y <= cells[1]; y++)
            for (uint32_t x = 0; x <= cells[0]; x++)
                for (uint32_t axis = 0; axis < 3; axis++)
                    if ((uint32_t[3]){x, y, z}[axis] < cells[axis])
                        add_quad(&grid, (uint32_t[3]){x, y, z}, axis, names, &out);
    free(names);
    return out;
}

void oracle_dual_free(oracle_dual *dual)
{
    free(dual->cells);
    free(dual->loops);
    free(dual->quads);
    free(dual->edges);
    *dual = (oracle_dual){0};
}

/* --- from a field --------------------------------------------------------------------------------------------------
 */

typedef struct made {
    const hewn_field *field;
    hewn_node root;
    struct hewn_grid grid;
    oracle_dual dual;
    float *points, *gradients, *positions, *normals, *residuals;
} made;

static double coordinate(const struct hewn_grid *grid, uint32_t axis, uint32_t sample)
{
    uint32_t thick = grid->cells[axis] - 2 * grid->open;
    uint32_t place = grid->open ? (sample == 0 ? 0 : sample > thick ? thick : sample - 1) : sample;
    return place == thick ? grid->far[axis] : grid->origin[axis] + (double)grid->cell * place;
}

static double value_at(const made *run, const double at[3])
{
    double value;
    hewn_result result = hewn_field_eval(run->field, run->root, at, 1, &value, NULL);
    assert(result == HEWN_OK);
    (void)result;
    return value;
}

/* Value, and the gradient at length one. */
static double gradient_at(const made *run, const double at[3], float out[3])
{
    double all[4];
    hewn_result result = hewn_field_gradient(run->field, run->root, at, 1, all, NULL);
    assert(result == HEWN_OK);
    (void)result;
    double length = sqrt(all[1] * all[1] + all[2] * all[2] + all[3] * all[3]);
    for (int axis = 0; axis < 3; axis++)
        out[axis] = (float)(length > 0 ? all[axis + 1] / length : axis == 2);
    return length > 0 ? all[0] / length : 0;
}

static bool on_bounds(const struct hewn_grid *grid, const uint32_t at[3])
{
    bool bounds = false;
    for (int axis = 0; axis < 3; axis++)
        bounds |= at[axis] == 0 || at[axis] == grid->cells[axis];
    return bounds && !grid->open;
}

static bool *take_signs(const made *run)
{
    const uint32_t *cells = run->grid.cells;
    bool *inside = malloc((size_t)(cells[0] + 1) * (cells[1] + 1) * (cells[2] + 1));
    assert(inside);
    size_t number = 0;
    for (uint32_t z = 0; z <= cells[2]; z++)
        for (uint32_t y = 0; y <= cells[1]; y++)
            for (uint32_t x = 0; x <= cells[0]; x++) {
                uint32_t sample[3] = {x, y, z};
                double at[3];
                for (uint32_t axis = 0; axis < 3; axis++)
                    at[axis] = coordinate(&run->grid, axis, sample[axis]);
                inside[number++] = value_at(run, at) < 0 && !on_bounds(&run->grid, sample);
            }
    return inside;
}

static void cross(made *run, uint32_t quad)
{
    const uint32_t *edge = &run->dual.edges[4 * (size_t)quad];
    uint32_t axis = edge[3], end[3] = {edge[0], edge[1], edge[2]};
    end[axis]++;
    double low[3], high[3], at[3];
    for (uint32_t a = 0; a < 3; a++) {
        low[a] = at[a] = coordinate(&run->grid, a, edge[a]);
        high[a] = coordinate(&run->grid, a, end[a]);
    }
    bool from = value_at(run, low) < 0, to = value_at(run, high) < 0;
    float *normal = &run->gradients[3 * (size_t)quad], *point = &run->points[3 * (size_t)quad];
    if (from == to) { /* the cap: both are inside, one of them on the bounds */
        at[axis] = on_bounds(&run->grid, edge) ? low[axis] : high[axis];
        for (uint32_t a = 0; a < 3; a++)
            normal[a] = a != axis ? 0.0F : on_bounds(&run->grid, edge) ? -1.0F : 1.0F;
    } else {
        double a = low[axis], b = high[axis];
        for (int step = 0; step < 60; step++) {
            at[axis] = (a + b) / 2;
            *(((value_at(run, at) < 0) == from) ? &a : &b) = at[axis];
        }
        gradient_at(run, at, normal);
    }
    for (uint32_t a = 0; a < 3; a++)
        point[a] = (float)at[a];
}

static void place(made *run, uint32_t vertex, const hewn_quadric *quadric, const double sum[4], bool mean)
{
    const uint32_t *cell = &run->dual.cells[3 * (size_t)vertex];
    hewn_box box;
    double at[3];
    for (uint32_t axis = 0; axis < 3; axis++) {
        box.lo[axis] = coordinate(&run->grid, axis, cell[axis]);
        box.hi[axis] = coordinate(&run->grid, axis, cell[axis] + 1);
        at[axis] = sum[axis] / sum[3];
    }
    if (!mean)
        hewn_quadric_minimise(quadric, 1e-8, &box, at);
    for (uint32_t axis = 0; axis < 3; axis++)
        run->positions[3 * (size_t)vertex + axis] = (float)at[axis];
    run->residuals[vertex] = (float)fabs(gradient_at(run, at, &run->normals[3 * (size_t)vertex]));
}

static void place_all(made *run, bool mean)
{
    hewn_quadric *quadrics = calloc(run->dual.vertex_count, sizeof *quadrics);
    double(*sums)[4] = calloc(run->dual.vertex_count, sizeof *sums);
    assert(quadrics && sums);
    for (uint32_t corner = 0; corner < 4 * run->dual.quad_count; corner++) {
        uint32_t vertex = run->dual.quads[corner];
        size_t quad = corner / 4;
        double point[3], normal[3];
        for (size_t axis = 0; axis < 3; axis++) {
            point[axis] = run->points[3 * quad + axis];
            normal[axis] = run->gradients[3 * quad + axis];
            sums[vertex][axis] += point[axis];
        }
        sums[vertex][3] += 1;
        hewn_quadric_add_plane(&quadrics[vertex], point, normal);
    }
    for (uint32_t vertex = 0; vertex < run->dual.vertex_count; vertex++)
        if (sums[vertex][3] > 0)
            place(run, vertex, &quadrics[vertex], sums[vertex], mean);
    free(quadrics);
    free(sums);
}

/* Loops on the bounds of an open grid may have no quad at all: a vertex that nothing names is dropped. */
static void drop_unused(oracle_dual *dual)
{
    uint32_t *name = calloc(dual->vertex_count + 1, sizeof *name), kept = 0;
    assert(name);
    for (uint32_t corner = 0; corner < 4 * dual->quad_count; corner++)
        name[dual->quads[corner]] = 1;
    for (uint32_t vertex = 0; vertex < dual->vertex_count; vertex++) {
        if (!name[vertex])
            continue;
        memmove(&dual->cells[3 * (size_t)kept], &dual->cells[3 * (size_t)vertex], 3 * sizeof *dual->cells);
        name[vertex] = kept++;
    }
    for (uint32_t corner = 0; corner < 4 * dual->quad_count; corner++)
        dual->quads[corner] = name[dual->quads[corner]];
    dual->vertex_count = kept;
    free(name);
}

hewn_dual_surface oracle_dual_surface(const hewn_field *field, hewn_node root, const hewn_extract_desc *desc, bool mean)
{
    made run = {.field = field, .root = root};
    hewn_box grown_box;
    hewn_result result = hewn_grid_lay(desc, &run.grid, &grown_box, NULL);
    assert(result == HEWN_OK);
    (void)result;
    for (int axis = 0; axis < 3; axis++)
        run.grid.cells[axis] =
            (uint32_t)lround((grown_box.hi[axis] - grown_box.lo[axis]) / run.grid.cell) + 2 * run.grid.open;
    run.grid.rim = run.grid.open;
    bool *inside = take_signs(&run);
    run.dual = oracle_dual_trace(run.grid.cells, inside, true);
    free(inside);
    drop_unused(&run.dual);
    uint32_t vertices = run.dual.vertex_count, quads = run.dual.quad_count;
    run.points = calloc(3 * (size_t)quads + 1, sizeof(float));
    run.gradients = calloc(3 * (size_t)quads + 1, sizeof(float));
    run.positions = calloc(3 * (size_t)vertices + 1, sizeof(float));
    run.normals = calloc(3 * (size_t)vertices + 1, sizeof(float));
    run.residuals = calloc((size_t)vertices + 1, sizeof(float));
    for (uint32_t quad = 0; quad < quads; quad++)
        cross(&run, quad);
    place_all(&run, mean);
    hewn_dual_surface out = {.grid = run.grid,
                             .vertex_count = vertices,
                             .cells = run.dual.cells,
                             .positions = run.positions,
                             .normals = run.normals,
                             .residuals = run.residuals,
                             .quad_count = quads,
                             .quads = run.dual.quads,
                             .points = run.points,
                             .gradients = run.gradients};
    free(run.dual.loops);
    free(run.dual.edges);
    return out;
}

void oracle_dual_surface_free(hewn_dual_surface *surface)
{
    const void *blocks[] = {surface->cells, surface->positions, surface->normals,  surface->residuals,
                            surface->quads, surface->points,    surface->gradients};
    for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++)
        free((void *)(uintptr_t)blocks[i]);
    *surface = (hewn_dual_surface){0};
}

hewn_triangles oracle_dual_triangles(const hewn_dual_surface *surface)
{
    hewn_triangles out = {.vertex_count = surface->vertex_count, .triangle_count = 2 * surface->quad_count};
    out.positions = malloc(out.vertex_count * 3 * sizeof(float) + 1);
    out.normals = malloc(out.vertex_count * 3 * sizeof(float) + 1);
    out.indices = malloc(out.triangle_count * 3 * sizeof(uint32_t) + 1);
    assert(out.positions && out.normals && out.indices);
    memcpy(out.positions, surface->positions, out.vertex_count * 3 * sizeof(float));
    memcpy(out.normals, surface->normals, out.vertex_count * 3 * sizeof(float));
    for (uint64_t quad = 0; quad < surface->quad_count; quad++) {
        static const uint32_t cut[6] = {0, 1, 2, 0, 2, 3};
        for (int i = 0; i < 6; i++)
            out.indices[6 * quad + (uint64_t)i] = surface->quads[4 * quad + cut[i]];
    }
    return out;
}
