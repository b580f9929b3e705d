#include "labels/nets.h"

#include <stdatomic.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/progress.h"
#include "labels/cell.h"

/* A cell with more than one label. Layer z of cells lies between voxel layers z and z + 1, all counted with the layers
 * around the volume. */
typedef struct mixed_cell {
    uint32_t x, y;
    uint32_t key;
    uint32_t first; /* its first vertex */
} mixed_cell;

/* What a layer has, or, after the sums, what the layers before it have. */
typedef struct layer {
    uint64_t polygons, corners, links;
} layer;

typedef struct maker {
    const hewn_label_ids *ids;
    hewn_label_nets *nets;
    const hewn_progress *progress;
    mixed_cell *cells;
    uint64_t *starts;   /* of each layer's cells, and their end */
    uint64_t *vertices; /* how many each layer has */
    layer *layers;
    uint32_t cell_dims[3];
    atomic_bool no_memory;
} maker;

/* A thread's own things. */
typedef struct worker {
    maker *of;
    hewn_cell_memo memo;
    uint16_t *mixed;   /* whether each cell of a row is */
    uint32_t *maps[2]; /* which mixed cell is at each place of this layer, and of the one below */
    uint32_t z;
    layer at;  /* the next place for each */
    bool emit; /* else count only */
} worker;

enum { BLOCK = 8 /* layers that a thread takes at a time */ };

static hewn_result fail_memory(hewn_error *error)
{
    return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the mesh of labels");
}

/* --- mixed cells ---------------------------------------------------------------------------------------------------
 */

/* Marks the cells of row y, layer z that hold more than one label. */
static void mark_row(const maker *of, uint32_t y, uint32_t z, uint16_t *restrict mixed)
{
    size_t row = of->ids->dims[0], slice = row * of->ids->dims[1];
    const uint16_t *restrict a = of->ids->ids + slice * z + row * y;
    const uint16_t *restrict b = a + row, *restrict c = a + slice, *restrict d = c + row;
    for (size_t x = 0; x < row; x++)
        mixed[x] = (uint16_t)((a[x] ^ b[x]) | (a[x] ^ c[x]) | (a[x] ^ d[x]));
    for (size_t x = 0; x + 1 < row; x++)
        mixed[x] = (uint16_t)(mixed[x] | mixed[x + 1] | (a[x] ^ a[x + 1]));
}

static uint64_t eight_at(const uint16_t *mixed, uint32_t x)
{
    uint64_t words[2];
    memcpy(words, mixed + x, sizeof words);
    return words[0] | words[1];
}

/* The next mixed cell of a row from x on; the row's length where there is none. */
static uint32_t next_mixed(const uint16_t *mixed, uint32_t x, uint32_t length)
{
    while (x < length && !mixed[x]) {
        if (x + 8 <= length && eight_at(mixed, x) == 0)
            x += 8;
        else
            x++;
    }
    return x;
}

static void count_cells(worker *by, uint32_t z)
{
    const maker *of = by->of;
    uint64_t count = 0;
    for (uint32_t y = 0; y < of->cell_dims[1]; y++) {
        mark_row(of, y, z, by->mixed);
        for (uint32_t x = 0; x < of->cell_dims[0]; x++)
            count += by->mixed[x] != 0;
    }
    by->of->starts[z] = count;
}

/* Fills in a layer's cells, with first vertices counted from the layer's own. */
static void find_cells(worker *by, uint32_t z)
{
    maker *of = by->of;
    size_t row = of->ids->dims[0], slice = row * of->ids->dims[1];
    mixed_cell *to = of->cells + of->starts[z];
    uint64_t vertices = 0;
    for (uint32_t y = 0; y < of->cell_dims[1]; y++) {
        mark_row(of, y, z, by->mixed);
        for (uint32_t x = 0; (x = next_mixed(by->mixed, x, of->cell_dims[0])) < of->cell_dims[0]; x++) {
            const uint16_t *a = of->ids->ids + slice * z + row * y + x;
            const uint16_t labels[8] = {a[0],     a[1],         a[row],         a[row + 1],
                                        a[slice], a[slice + 1], a[slice + row], a[slice + row + 1]};
            uint32_t key = hewn_cell_key(labels);
            const hewn_label_cell *cell = hewn_cell_find(&by->memo, key);
            if (!cell) {
                of->no_memory = true;
                return;
            }
            *to++ = (mixed_cell){x, y, key, (uint32_t)vertices};
            vertices += cell->owned_count;
        }
    }
    of->vertices[z] = vertices;
}

/* --- walking over cells --------------------------------------------------------------------------------------------
 */

/* A mixed cell with what it holds. */
typedef struct known_cell {
    const mixed_cell *mixed;
    const hewn_label_cell *cell;
} known_cell;

static known_cell know(worker *by, const mixed_cell *mixed)
{
    return (known_cell){mixed, hewn_cell_find(&by->memo, mixed->key)};
}

/* The cell that is off from another by -1 along the axes whose bits are set; it must be a mixed one. */
static known_cell know_near(worker *by, known_cell from, unsigned off)
{
    uint32_t x = from.mixed->x - (off & 1), y = from.mixed->y - (off >> 1 & 1);
    const uint32_t *map = by->maps[off >> 2 & 1];
    return know(by, by->of->cells + map[(size_t)by->of->cell_dims[0] * y + x]);
}

static uint32_t vertex_of_node(known_cell of, unsigned face, unsigned node)
{
    return of.mixed->first + of.cell->node[face][node];
}

/* The vertex on a split face, of which the cell is the upper one. */
static uint32_t vertex_of_face(known_cell upper, unsigned face, unsigned node)
{
    return upper.mixed->first + upper.cell->places[face & ~1u] + node;
}

static uint64_t first_id_place(const worker *by, const mixed_cell *mixed)
{
    const uint32_t *dims = by->of->ids->dims;
    return mixed->x + (uint64_t)dims[0] * (mixed->y + (uint64_t)dims[1] * by->z);
}

static uint16_t id_of_corner(const worker *by, const mixed_cell *mixed, unsigned corner)
{
    const uint32_t *dims = by->of->ids->dims;
    uint64_t place = first_id_place(by, mixed) + (corner & 1) + (uint64_t)dims[0] * (corner >> 1 & 1) +
                     (uint64_t)dims[0] * dims[1] * (corner >> 2);
    return by->of->ids->ids[place];
}

static void add_corner(worker *by, uint32_t vertex)
{
    if (by->emit)
        by->of->nets->corners[by->at.corners] = vertex;
    by->at.corners++;
}

static void begin_polygon(worker *by, const mixed_cell *mixed, unsigned behind, unsigned front, unsigned axis)
{
    hewn_label_nets *nets = by->of->nets;
    uint64_t n = by->at.polygons++;
    if (!by->emit)
        return;
    nets->first[n] = (uint32_t)by->at.corners;
    nets->sides[2 * n] = id_of_corner(by, mixed, behind);
    nets->sides[2 * n + 1] = id_of_corner(by, mixed, front);
    nets->axis[n] = (uint8_t)axis;
}

/* The polygon around the grid edge at the cell's lowest corner: through the four cells around. */
static void add_polygon(worker *by, known_cell from, unsigned axis)
{
    unsigned u = (axis + 1) % 3, v = (axis + 2) % 3;
    const unsigned off[4] = {0, 1u << u, 1u << u | 1u << v, 1u << v};
    known_cell around[4];
    for (int i = 0; i < 4; i++)
        around[i] = know_near(by, from, off[i]);
    begin_polygon(by, from.mixed, 0, 1u << axis, axis);
    for (unsigned i = 0; i < 4; i++) {
        /* Arcs are numbered by where they are in the cell, which is as far off as the cell is. */
        const hewn_cell_arc *arc = &hewn_cell_arcs[4 * axis + (i == 3 ? 2 : i == 2 ? 3 : i)];
        const hewn_label_cell *cell = around[i].cell;
        uint32_t in = vertex_of_node(around[i], arc->in, hewn_cell_node(cell, arc->in, arc->low, axis));
        unsigned node = hewn_cell_node(cell, arc->out, arc->low, axis);
        uint32_t out = vertex_of_node(around[i], arc->out, node);
        add_corner(by, in);
        if (out != in)
            add_corner(by, out);
        if (cell->split[arc->out])
            add_corner(by, vertex_of_face(arc->out & 1 ? around[(i + 1) & 3] : around[i], arc->out, node));
    }
}

static void add_caps(worker *by, known_cell of)
{
    for (unsigned n = 0; n < of.cell->cap_count; n++) {
        const hewn_cell_cap *cap = &of.cell->caps[n];
        begin_polygon(by, of.mixed, cap->corner, cap->front, 3);
        for (unsigned i = 0; i < cap->count; i++)
            add_corner(by, of.mixed->first + cap->vertices[i]);
    }
}

static void add_link(worker *by, uint32_t a, uint32_t b, bool junction)
{
    uint64_t n = by->at.links++;
    if (!by->emit)
        return;
    by->of->nets->links[2 * n] = a;
    by->of->nets->links[2 * n + 1] = b;
    by->of->nets->junction[n] = junction;
}

/* Edges of polygons within the cell and through its low faces. */
static void add_links(worker *by, known_cell of)
{
    for (unsigned i = 0; i < of.cell->link_count; i++) {
        const hewn_cell_link *link = &of.cell->links[i];
        add_link(by, of.mixed->first + link->a, of.mixed->first + link->b, link->junction);
    }
    for (unsigned axis = 0; axis < 3; axis++) {
        unsigned face = 2 * axis;
        if (of.cell->arcs[face] == 0)
            continue;
        known_cell below = know_near(by, of, 1u << axis);
        for (unsigned node = 0; node < 2 && of.cell->node[face][node] != HEWN_CELL_NONE; node++) {
            uint32_t here = vertex_of_node(of, face, node), there = vertex_of_node(below, face + 1, node);
            if (of.cell->split[face]) {
                add_link(by, here, vertex_of_face(of, face, node), false);
                add_link(by, vertex_of_face(of, face, node), there, false);
            } else {
                add_link(by, here, there, of.cell->arcs[face] > 2);
            }
        }
    }
}

static void place_vertices(worker *by, known_cell of)
{
    hewn_label_nets *nets = by->of->nets;
    const hewn_label_cell *cell = of.cell;
    const double low[3] = {(double)of.mixed->x - 1, (double)of.mixed->y - 1, (double)by->z - 1};
    for (unsigned n = 0; n < cell->vertex_count; n++) {
        double *to = nets->positions + 3 * ((size_t)of.mixed->first + n);
        for (int axis = 0; axis < 3; axis++)
            to[axis] = low[axis] + cell->offset[n][axis];
        nets->room[of.mixed->first + n] = cell->vertex_count == 1 ? HEWN_NET_CELL : HEWN_NET_NEAR;
    }
    for (unsigned face = 0; face < 6; face += 2)
        for (unsigned node = 0; cell->split[face] && node < 2; node++) {
            unsigned order = 2 * node + cell->split[face] - 1, axis = face / 2; /* the corner that is apart there */
            uint32_t vertex = vertex_of_face(of, face, node);
            double *to = nets->positions + 3 * (size_t)vertex;
            to[axis] = low[axis];
            to[(axis + 1) % 3] = low[(axis + 1) % 3] + (order == 1 || order == 2 ? 0.75 : 0.25);
            to[(axis + 2) % 3] = low[(axis + 2) % 3] + (order >= 2 ? 0.75 : 0.25);
            nets->room[vertex] = (uint8_t)(HEWN_NET_FACE + axis);
        }
}

/* --- layers --------------------------------------------------------------------------------------------------------
 */

static void map_layer(const maker *of, uint32_t z, uint32_t *map)
{
    for (uint64_t n = of->starts[z]; n < of->starts[z + 1]; n++)
        map[(size_t)of->cell_dims[0] * of->cells[n].y + of->cells[n].x] = (uint32_t)n;
}

/* Walks over layer z, the one below it being mapped; both are mapped then. */
static void walk_layer(worker *by, uint32_t z)
{
    maker *of = by->of;
    by->z = z;
    by->at = by->emit ? of->layers[z] : (layer){0};
    map_layer(of, z, by->maps[0]);
    for (uint64_t n = of->starts[z]; n < of->starts[z + 1]; n++) {
        known_cell cell = know(by, &of->cells[n]);
        if (!cell.cell) {
            of->no_memory = true;
            return;
        }
        for (unsigned axis = 0; axis < 3; axis++)
            if (hewn_cell_class(cell.mixed->key, 1u << axis) != 0)
                add_polygon(by, cell, axis);
        add_caps(by, cell);
        add_links(by, cell);
        if (by->emit)
            place_vertices(by, cell);
    }
    if (!by->emit)
        of->layers[z] = by->at;
}

static void walk_block(worker *by, uint32_t begin, uint32_t end)
{
    if (begin > 0)
        map_layer(by->of, begin - 1, by->maps[1]);
    for (uint32_t z = begin; z < end && !by->of->no_memory; z++) {
        walk_layer(by, z);
        uint32_t *map = by->maps[0];
        by->maps[0] = by->maps[1];
        by->maps[1] = map;
    }
}

typedef enum net_pass { COUNT_CELLS, FIND_CELLS, COUNT_POLYGONS, EMIT } net_pass;

static bool worker_begin(worker *by)
{
    const maker *of = by->of;
    size_t slice = (size_t)of->cell_dims[0] * of->cell_dims[1];
    by->mixed = hewn_alloc((size_t)of->ids->dims[0] + 8, sizeof *by->mixed);
    /* Maps are only looked up where there is a cell, so they need not be cleared; but to be the same on every run even
     * if there were a mistake. */
    for (int i = 0; i < 2; i++)
        by->maps[i] = hewn_alloc_zero(slice, sizeof *by->maps[i]);
    return by->mixed && by->maps[0] && by->maps[1] && hewn_cell_find(&by->memo, 0);
}

static void run_pass(maker *of, net_pass pass)
{
    uint32_t count = of->cell_dims[2];
#pragma omp parallel
    {
        worker by = {.of = of, .emit = pass == EMIT};
        if (!worker_begin(&by))
            of->no_memory = true;
#pragma omp for schedule(dynamic)
        for (uint32_t begin = 0; begin < count; begin += BLOCK) {
            uint32_t end = count - begin < BLOCK ? count : begin + BLOCK;
            if (of->no_memory)
                continue;
            for (uint32_t z = begin; z < end && pass <= FIND_CELLS; z++) {
                if (pass == COUNT_CELLS)
                    count_cells(&by, z);
                else
                    find_cells(&by, z);
            }
            if (pass > FIND_CELLS)
                walk_block(&by, begin, end);
        }
        hewn_free(by.mixed);
        hewn_free(by.maps[0]);
        hewn_free(by.maps[1]);
        hewn_cell_memo_free(&by.memo);
    }
}

/* Counts of layers become places; `*all` is the count of all. */
static void sum_layers(maker *of, layer *all)
{
    *all = (layer){0};
    for (uint32_t z = 0; z < of->cell_dims[2]; z++) {
        layer here = of->layers[z];
        of->layers[z] = *all;
        all->polygons += here.polygons;
        all->corners += here.corners;
        all->links += here.links;
    }
}

/* The same of cells. */
static void sum_cells(maker *of)
{
    uint64_t cells = 0;
    for (uint32_t z = 0; z <= of->cell_dims[2]; z++) {
        uint64_t here = of->starts[z];
        of->starts[z] = cells;
        cells += here;
    }
}

/* First vertices, which were counted from the layer's own. */
static void place_cells(maker *of)
{
    uint64_t vertices = 0;
    for (uint32_t z = 0; z < of->cell_dims[2]; z++) {
        for (uint64_t n = of->starts[z]; n < of->starts[z + 1]; n++)
            of->cells[n].first += (uint32_t)vertices;
        vertices += of->vertices[z];
    }
    of->nets->vertex_count = vertices;
}

static hewn_result allocate(maker *of, hewn_error *error)
{
    hewn_label_nets *nets = of->nets;
    layer all;
    sum_layers(of, &all);
    nets->polygon_count = all.polygons;
    nets->corner_count = all.corners;
    nets->link_count = all.links;
    if (nets->corner_count >= UINT32_MAX || nets->vertex_count >= UINT32_MAX)
        return hewn_fail(error, HEWN_LIMIT, "the labels have more corners than indices can name");
    nets->positions = hewn_alloc(nets->vertex_count, 3 * sizeof *nets->positions);
    nets->room = hewn_alloc(nets->vertex_count, sizeof *nets->room);
    nets->first = hewn_alloc(nets->polygon_count + 1, sizeof *nets->first);
    nets->corners = hewn_alloc(nets->corner_count, sizeof *nets->corners);
    nets->sides = hewn_alloc(nets->polygon_count, 2 * sizeof *nets->sides);
    nets->axis = hewn_alloc(nets->polygon_count, sizeof *nets->axis);
    nets->links = hewn_alloc(nets->link_count, 2 * sizeof *nets->links);
    nets->junction = hewn_alloc(nets->link_count, sizeof *nets->junction);
    bool all_there = nets->positions && nets->room && nets->first && nets->corners && nets->sides && nets->axis &&
                     nets->links && nets->junction;
    if (!all_there)
        return fail_memory(error);
    nets->first[nets->polygon_count] = (uint32_t)nets->corner_count;
    return HEWN_OK;
}

static hewn_result check(const maker *of, double share, hewn_error *error)
{
    return of->no_memory ? fail_memory(error) : hewn_progress_report(of->progress, "label", share, error);
}

static hewn_result make(maker *of, hewn_error *error)
{
    of->starts = hewn_alloc_zero((size_t)of->cell_dims[2] + 1, sizeof *of->starts);
    of->vertices = hewn_alloc_zero(of->cell_dims[2], sizeof *of->vertices);
    of->layers = hewn_alloc_zero(of->cell_dims[2], sizeof *of->layers);
    if (!of->starts || !of->vertices || !of->layers)
        return fail_memory(error);
    run_pass(of, COUNT_CELLS);
    HEWN_TRY(check(of, 0.3, error));
    sum_cells(of);
    uint64_t cells = of->starts[of->cell_dims[2]];
    if (cells >= UINT32_MAX / 24) /* no more than 12 vertices and 6 on faces in each */
        return hewn_fail(error, HEWN_LIMIT, "the labels have more corners than indices can name");
    of->cells = hewn_alloc(cells, sizeof *of->cells);
    if (!of->cells)
        return fail_memory(error);
    run_pass(of, FIND_CELLS);
    HEWN_TRY(check(of, 0.5, error));
    place_cells(of);
    run_pass(of, COUNT_POLYGONS);
    HEWN_TRY(check(of, 0.7, error));
    HEWN_TRY(allocate(of, error));
    run_pass(of, EMIT);
    return check(of, 1, error);
}

hewn_result hewn_label_nets_make(const hewn_label_ids *ids, const hewn_progress *progress, hewn_label_nets *out,
                                 hewn_error *error)
{
    *out = (hewn_label_nets){0};
    maker of = {.ids = ids, .nets = out, .progress = progress};
    for (int axis = 0; axis < 3; axis++)
        of.cell_dims[axis] = ids->dims[axis] - 1;
    hewn_result result = make(&of, error);
    hewn_free(of.cells);
    hewn_free(of.starts);
    hewn_free(of.vertices);
    hewn_free(of.layers);
    return result;
}

void hewn_label_nets_free(hewn_label_nets *nets)
{
    hewn_free(nets->positions);
    hewn_free(nets->room);
    hewn_free(nets->first);
    hewn_free(nets->corners);
    hewn_free(nets->sides);
    hewn_free(nets->axis);
    hewn_free(nets->links);
    hewn_free(nets->junction);
    *nets = (hewn_label_nets){0};
}
