/* Where the vertices of dual meshes lie, and which quads they belong to. */
#include <math.h>
#include <string.h>

#include "iso/cube.h"
#include "iso/lattice_dual.h"
#include "iso/quadric.h"

/* What nearness to the mean of the crossings weighs beside the planes, at the least: as much as a direction in which
 * normals vary by a fourteenth. */
static const double HOLD = 0.07 * 0.07;

/* Planes of samples are not certain. Where they miss each other by this part of a voxel, they weigh as little as what
 * nearness to the mean does; the weight of that grows with the square. */
static const double CERTAIN = 0.1;

/* A cell that is at hand. */
typedef struct dual_cell {
    hewn_lattice_cell_row *row;
    uint32_t at[3];
    const uint32_t *names; /* of the crossings on its edges */
    uint32_t repeated;     /* edges that are in a rim, where that repeats others; a bit each */
} dual_cell;

static uint32_t edges_of_face(uint32_t face)
{
    uint32_t edges = 0;
    for (uint32_t edge = 0; edge < 12; edge++)
        edges |= (uint32_t)hewn_cube_edge_in_face(edge, face) << edge;
    return edges;
}

static uint32_t find_repeated(const hewn_lattice *lattice, const uint32_t at[3])
{
    uint32_t edges = 0;
    for (uint32_t axis = 0; axis < 3 && lattice->repeats; axis++) {
        if (at[axis] == 0)
            edges |= edges_of_face(2 * axis);
        if (at[axis] + 2 == lattice->dims[axis])
            edges |= edges_of_face(2 * axis + 1);
    }
    return edges;
}

/* --- places ------------------------------------------------------------------------------------------------------- */

static size_t place_of(const dual_cell *cell, uint32_t edge)
{
    return 3 * (size_t)(cell->names[edge] - cell->row->lattice->before.vertices);
}

/* The mean of the crossings in the mesh's space. */
static void find_mean(const dual_cell *cell, uint32_t edges, double out[3])
{
    const float *positions = cell->row->lattice->crossings->positions;
    double count = 0;
    out[0] = out[1] = out[2] = 0;
    for (uint32_t edge = 0; edge < 12; edge++) {
        if (!(edges >> edge & 1))
            continue;
        for (size_t axis = 0; axis < 3; axis++)
            out[axis] += (double)positions[place_of(cell, edge) + axis];
        count++;
    }
    for (int axis = 0; axis < 3; axis++)
        out[axis] /= count;
}

/* The cell between its samples, or what is to be used of it, from its lowest corner on. `length` is that of a step. */
static void find_extent(const dual_cell *cell, int axis, double length, hewn_box *out)
{
    const hewn_lattice *lattice = cell->row->lattice;
    const double rim = lattice->margin, off = lattice->margin / 3;
    const bool first = hewn_lattice_in_rim(lattice, axis, cell->at[axis]);
    const bool last = hewn_lattice_in_rim(lattice, axis, cell->at[axis] + 1);
    const double lo = first ? (lattice->repeats ? 1 : 1 - rim) : last && lattice->repeats ? 0 : off;
    const double hi = last ? (lattice->repeats ? 0 : rim) : first && lattice->repeats ? 1 : 1 - off;
    out->lo[axis] = lo * length;
    out->hi[axis] = hi * length;
}

/* The best point of the box; `voxel` is a length. */
static void solve(const hewn_quadric *planes, const hewn_box *box, double voxel, double out[3])
{
    double mean[3];
    hewn_quadric_centre(planes, mean);
    memcpy(out, mean, sizeof mean);
    hewn_quadric_minimise(planes, HOLD, box, out);
    const double doubt = hewn_quadric_distance(planes, out) / (CERTAIN * voxel);
    memcpy(out, mean, sizeof mean);
    hewn_quadric_minimise(planes, HOLD + doubt * doubt, box, out);
}

/* Where the planes of the crossings meet: in a frame along the lattice's axes with the mesh's lengths. There the
 * product of a step and a plane's normal is the distance that it is in the mesh's space. */
static void find_meeting(const dual_cell *cell, uint32_t edges, double out[3])
{
    const hewn_lattice *lattice = cell->row->lattice;
    const double *place = lattice->place, *back = lattice->back;
    double corner[3], length[3];
    hewn_quadric planes = {0};
    hewn_box box;
    for (int i = 0; i < 3; i++) {
        corner[i] = place[4 * i + 3];
        for (int axis = 0; axis < 3; axis++)
            corner[i] += place[4 * i + axis] * ((double)cell->at[axis] - lattice->rim);
        length[i] = sqrt(place[i] * place[i] + place[4 + i] * place[4 + i] + place[8 + i] * place[8 + i]);
    }
    for (uint32_t edge = 0; edge < 12; edge++) {
        if (!(edges >> edge & 1))
            continue;
        const float *at = lattice->crossings->positions + place_of(cell, edge);
        const float *turn = lattice->crossings->normals + place_of(cell, edge);
        double point[3], normal[3];
        for (int i = 0; i < 3; i++) {
            point[i] = normal[i] = 0;
            for (int axis = 0; axis < 3; axis++) {
                point[i] += length[i] * back[3 * i + axis] * ((double)at[axis] - corner[axis]);
                normal[i] += place[4 * axis + i] / length[i] * (double)turn[axis];
            }
        }
        hewn_quadric_add_plane(&planes, point, normal);
    }
    double found[3];
    for (int axis = 0; axis < 3; axis++)
        find_extent(cell, axis, length[axis], &box);
    solve(&planes, &box, fmin(length[0], fmin(length[1], length[2])), found);
    for (int i = 0; i < 3; i++) {
        out[i] = corner[i];
        for (int axis = 0; axis < 3; axis++)
            out[i] += place[4 * i + axis] * found[axis] / length[axis];
    }
}

static void put_normal(const dual_cell *cell, uint32_t edges)
{
    const float *normals = cell->row->lattice->crossings->normals;
    float *out = cell->row->out->normals + 3 * cell->row->centre_place;
    double sum[3] = {0}, size = 0;
    for (uint32_t edge = 0; edge < 12; edge++)
        for (size_t axis = 0; axis < 3 && edges >> edge & 1; axis++)
            sum[axis] += (double)normals[place_of(cell, edge) + axis];
    for (int axis = 0; axis < 3; axis++)
        size += sum[axis] * sum[axis];
    for (int axis = 0; axis < 3; axis++)
        out[axis] = size > 0 ? (float)(sum[axis] / sqrt(size)) : axis == 2;
}

/* --- quads -------------------------------------------------------------------------------------------------------- */

/* The place of a cell among the four around one of its edges, counter-clockwise seen from where the edge leads out of
 * the surface. */
static uint32_t find_slot(uint32_t edge, bool inside, bool turn)
{
    static const uint32_t around[4] = {2, 3, 1, 0}; /* by which sides of the cell the edge is on */
    const uint32_t slot = around[edge & 3];
    const bool backward = inside == ((edge >> 2) == 1); /* the second axis sees the others in turned order */
    return backward != turn ? (4 - slot) & 3 : slot;
}

static void name_in_quads(const dual_cell *cell, uint32_t edges, uint32_t pattern, bool turn)
{
    const hewn_lattice_cell_row *row = cell->row;
    for (uint32_t edge = 0; edge < 12; edge++) {
        if (!(edges >> edge & 1))
            continue;
        const bool inside = pattern >> hewn_cube_edge_start(edge) & 1;
        const uint64_t quad = cell->names[edge] - row->lattice->before.vertices;
        row->out->indices[6 * quad + find_slot(edge, inside, turn)] = row->centre;
    }
}

/* Loops that share a cell stay at their means, or they would get in each other's way. */
void hewn_lattice_dual_place(hewn_lattice_cell_row *row, uint32_t i, const uint32_t names[16], uint32_t pattern,
                             const uint32_t *record, bool turn)
{
    const hewn_lattice *lattice = row->lattice;
    dual_cell cell = {.row = row, .at = {i, row->j, row->k}, .names = names};
    const uint32_t loops = record[0] >> 8;
    cell.repeated = find_repeated(lattice, cell.at);
    for (uint32_t loop = 0; loop < loops; loop++, row->centre++, row->centre_place++) {
        const uint32_t edges = record[1 + loop] & ~cell.repeated;
        double at[3];
        if (lattice->planes && loops == 1)
            find_meeting(&cell, edges, at);
        else
            find_mean(&cell, edges, at);
        for (size_t axis = 0; axis < 3; axis++)
            row->out->positions[3 * row->centre_place + axis] = (float)at[axis];
        if (row->out->normals)
            put_normal(&cell, edges);
        name_in_quads(&cell, edges, pattern, turn);
    }
}
