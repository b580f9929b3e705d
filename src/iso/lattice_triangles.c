/* Triangles of cells, and the vertices that lie in cells. */
#include <math.h>

#include "iso/lattice_blocks.h"
#include "iso/lattice_dual.h"
#include "iso/patch.h"

/* Which of four rows around a row of cells has the edges of one of them: another one where that is in a rim that
 * repeats. */
static uint32_t edges_of(const hewn_lattice *lattice, uint32_t n, uint32_t j, uint32_t k)
{
    const uint32_t at[2] = {j, k};
    for (uint32_t i = 0; i < 2 && lattice->repeats; i++) {
        if (at[i] == 0)
            n |= 1u << i;
        else if (at[i] + 2 == lattice->dims[1 + i])
            n &= ~(1u << i);
    }
    return n;
}

hewn_lattice_cell_row hewn_lattice_begin_cells(const hewn_lattice *lattice, hewn_triangles *out,
                                               const hewn_lattice_row *const begins[4], uint32_t j, uint32_t k)
{
    hewn_lattice_cell_row row = {.lattice = lattice, .out = out, .j = j, .k = k};
    for (uint32_t i = 0; i < 4; i++) {
        const hewn_lattice_row *from = begins[edges_of(lattice, i, j, k)];
        row.along[i] = from->vertices[0];
        if ((i & 1) == 0)
            row.beside[i >> 1] = from->vertices[1];
        if (i < 2)
            row.upright[i] = from->vertices[2];
    }
    const hewn_lattice_row *own = begins[0];
    row.centre = own->centres;
    row.centre_place = own->centres - lattice->before.centres;
    if (!lattice->dual) { /* vertices on edges come first */
        row.centre += (uint32_t)lattice->vertex_count;
        row.centre_place += lattice->reached - lattice->before.vertices;
    }
    row.triangle = own->triangles - lattice->before.triangles;
    return row;
}

/* The vertices on the edges of a cell, as iso/cube.h numbers them; what is not crossed has some other number. Cells of
 * a rim that repeats have the same edges on both sides. */
static void name_edges(hewn_lattice_cell_row *row, uint32_t i_of_cell, uint32_t pattern, uint32_t names[16])
{
    const hewn_lattice *lattice = row->lattice;
    const bool thin = lattice->repeats && (i_of_cell == 0 || i_of_cell + 2 == lattice->dims[0]);
    uint32_t ahead = pattern ^ pattern >> 2, over = pattern ^ pattern >> 4, along = pattern ^ pattern >> 1;
    for (uint32_t i = 0; i < 4; i++) {
        names[i] = row->along[i];
        row->along[i] += along >> 2 * i & 1;
    }
    for (uint32_t i = 0; i < 2; i++) {
        names[4 + 2 * i] = row->beside[i];
        row->beside[i] += !thin && (ahead >> 4 * i & 1);
        names[5 + 2 * i] = row->beside[i];
        names[8 + 2 * i] = row->upright[i];
        row->upright[i] += !thin && (over >> 2 * i & 1);
        names[9 + 2 * i] = row->upright[i];
    }
}

/* --- vertices in cells -------------------------------------------------------------------------------------------- */

static bool in_face(uint32_t edge, uint32_t face)
{
    uint32_t axis = face >> 1, along = edge >> 2;
    uint32_t place = axis == (along == 0 ? 1u : 0u) ? edge & 1 : edge >> 1 & 1;
    return axis != along && place == (face & 1);
}

/* The mean of crossings, halfway from those in a face where `centre` names one (iso/patch.h). */
static void place_centre(const hewn_lattice_cell_row *row, const uint32_t names[16], uint32_t centre)
{
    const hewn_triangles *out = row->out;
    uint64_t vertex = row->centre_place;
    uint32_t face = centre >> 12;
    double sum[3] = {0}, near[3] = {0}, normal[3] = {0}, count = 0, near_count = 0, size = 0;
    for (uint32_t edge = 0; edge < 12; edge++) {
        if (!(centre >> edge & 1))
            continue;
        const uint64_t at = 3 * (names[edge] - row->lattice->before.vertices);
        bool is_near = face != 0 && in_face(edge, face - 1);
        for (int axis = 0; axis < 3; axis++) {
            double position = (double)out->positions[at + (uint64_t)axis];
            sum[axis] += position;
            near[axis] += is_near ? position : 0;
            normal[axis] += row->lattice->normals ? (double)out->normals[at + (uint64_t)axis] : 0;
        }
        count++;
        near_count += is_near;
    }
    for (int axis = 0; axis < 3; axis++)
        size += normal[axis] * normal[axis];
    for (uint32_t axis = 0; axis < 3; axis++) {
        double mean = sum[axis] / count;
        out->positions[3 * vertex + axis] = (float)(near_count > 0 ? (mean + near[axis] / near_count) / 2 : mean);
        if (row->lattice->normals)
            out->normals[3 * vertex + axis] = size > 0 ? (float)(normal[axis] / sqrt(size)) : axis == 2;
    }
}

/* --- cells -------------------------------------------------------------------------------------------------------- */

void hewn_lattice_cut_cell(hewn_lattice_cell_row *row, uint32_t i, uint32_t pattern, const uint32_t *record, bool turn)
{
    uint32_t names[16] = {0};
    name_edges(row, i, pattern, names);
    if (row->lattice->dual) {
        hewn_lattice_dual_place(row, i, names, pattern, record, turn);
        return;
    }
    uint32_t triangles = record[0] & 255, centres = record[0] >> 8;
    for (uint32_t c = 0; c < centres; c++) {
        place_centre(row, names, record[1 + c / 2] >> 16 * (c % 2) & 0xFFFF);
        names[HEWN_PATCH_FIRST_CENTRE + c] = row->centre++;
        row->centre_place++;
    }
    const uint32_t *words = record + 1 + (centres + 1) / 2;
    uint32_t *to = row->out->indices + 3 * row->triangle;
    for (uint32_t t = 0; t < triangles; t++, to += 3) {
        uint32_t word = words[t / 2] >> 16 * (t % 2);
        to[0] = names[word & 15];
        to[turn ? 2 : 1] = names[word >> 4 & 15];
        to[turn ? 1 : 2] = names[word >> 8 & 15];
    }
    row->triangle += triangles;
}

void hewn_lattice_emit_triangles(const hewn_lattice *lattice, hewn_triangles *out)
{
    if (lattice->blocks) {
        hewn_lattice_blocks_emit_triangles(lattice, out);
        return;
    }
    bool turn = lattice->flipped != lattice->mirrors;
#pragma omp parallel for schedule(dynamic, 4) if (lattice->dims[2] > 8)
    for (uint32_t k = lattice->begin; k < lattice->end; k++) {
        if (k + 1 == lattice->dims[2])
            continue;
        for (uint32_t j = 0; j + 1 < lattice->dims[1]; j++) {
            const hewn_lattice_row *begins[4];
            for (uint32_t i = 0; i < 4; i++)
                begins[i] = hewn_lattice_row_at(lattice, j + (i & 1), k + (i >> 1));
            hewn_lattice_cell_row row = hewn_lattice_begin_cells(lattice, out, begins, j, k);
            hewn_lattice_cells cells = hewn_lattice_cells_at(lattice, j, k);
            for (uint32_t word = 0; word < lattice->words; word++) {
                hewn_lattice_load(lattice, &cells, word);
                for (uint64_t rest = cells.active; rest; rest &= rest - 1) {
                    uint32_t bit = hewn_lattice_lowest(rest), pattern = hewn_lattice_pattern(&cells, bit);
                    uint32_t place = hewn_lattice_patch(lattice, pattern, 64 * word + bit, j, k);
                    hewn_lattice_cut_cell(&row, 64 * word + bit, pattern, lattice->table + place, turn);
                }
            }
        }
    }
}
