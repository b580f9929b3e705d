#include "iso/lattice_nets.h"

#include <math.h>

#include "base/alloc.h"
#include "base/error.h"
#include "iso/cube.h"
#include "iso/dual_cells.h"

enum { RECORD = 1 + HEWN_DUAL_MOST_LOOPS, WORDS = 256 + 512 * RECORD + 512 };

/* --- cells -------------------------------------------------------------------------------------------------------- */

static uint32_t add_record(hewn_mc33_table *table, uint32_t pattern, uint32_t turned)
{
    hewn_dual_cell cell;
    const uint32_t place = table->count;
    hewn_dual_cell_derive(pattern, turned, &cell);
    table->words[table->count++] = cell.loop_count << 8;
    for (uint32_t loop = 0; loop < cell.loop_count; loop++)
        table->words[table->count++] = cell.edges[loop];
    return place;
}

hewn_result hewn_nets_table_make(hewn_mc33_table *out, hewn_error *error)
{
    *out = (hewn_mc33_table){.words = hewn_alloc(WORDS, sizeof *out->words), .count = 256};
    if (!out->words)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a table of configurations");
    for (uint32_t pattern = 0; pattern < 256; pattern++) {
        const uint32_t face = hewn_dual_doubtful_face(pattern), own = add_record(out, pattern, 0);
        out->words[pattern] = own;
        if (face == HEWN_DUAL_NO_FACE)
            continue;
        const uint32_t turned = add_record(out, pattern, 1u << face);
        out->words[pattern] = HEWN_MC33_DECIDES | face << 16 | out->count;
        out->words[out->count++] = own;
        out->words[out->count++] = turned;
    }
    return HEWN_OK;
}

uint32_t hewn_nets_decide(const hewn_lattice *lattice, uint32_t head, const uint32_t at[3])
{
    const uint32_t *records = lattice->table + (head & 0xFFFF), face = head >> 16 & 7, axis = face >> 1;
    uint32_t next[3] = {at[0], at[1], at[2]}, pattern = 0;
    next[axis] += (face & 1) ? 1u : -1u;
    if (next[axis] >= lattice->dims[axis] - 1)
        return records[0]; /* the frame ends there */
    for (uint32_t c = 0; c < 8; c++) {
        const uint32_t corner[3] = {next[0] + (c & 1), next[1] + (c >> 1 & 1), next[2] + (c >> 2)};
        pattern |= (uint32_t)hewn_lattice_inside_at(lattice, corner) << c;
    }
    const uint32_t other = lattice->table[pattern];
    return records[(other & HEWN_MC33_DECIDES) && (other >> 16 & 7) == (face ^ 1)];
}

/* --- vertices ----------------------------------------------------------------------------------------------------- */

static void put_mean(const hewn_lattice_cell_row *row, const uint32_t names[16], uint32_t edges)
{
    const hewn_lattice *lattice = row->lattice;
    const hewn_triangles *crossings = lattice->crossings;
    double sum[3] = {0}, normal[3] = {0}, count = 0, size = 0;
    for (uint32_t edge = 0; edge < 12; edge++) {
        if (!(edges >> edge & 1))
            continue;
        const size_t at = 3 * (size_t)(names[edge] - lattice->before.vertices);
        for (size_t axis = 0; axis < 3; axis++) {
            sum[axis] += (double)crossings->positions[at + axis];
            normal[axis] += lattice->normals ? (double)crossings->normals[at + axis] : 0;
        }
        count++;
    }
    for (int axis = 0; axis < 3; axis++)
        size += normal[axis] * normal[axis];
    for (size_t axis = 0; axis < 3; axis++) {
        row->out->positions[3 * row->centre_place + axis] = (float)(sum[axis] / count);
        if (lattice->normals)
            row->out->normals[3 * row->centre_place + axis] = size > 0 ? (float)(normal[axis] / sqrt(size)) : axis == 2;
    }
}

/* The place of a cell among the four around one of its edges, counter-clockwise seen from where the edge leads out of
 * the surface. */
static uint32_t find_slot(uint32_t edge, bool inside, bool turn)
{
    static const uint32_t around[4] = {2, 3, 1, 0}; /* by which sides of the cell the edge is on */
    const uint32_t slot = around[edge & 3];
    const bool backward = inside == ((edge >> 2) == 1); /* the second axis sees the others in turned order */
    return backward != turn ? (4 - slot) & 3 : slot;
}

void hewn_nets_place(hewn_lattice_cell_row *row, const uint32_t names[16], uint32_t pattern, const uint32_t *record,
                     bool turn)
{
    const hewn_lattice *lattice = row->lattice;
    for (uint32_t loop = 0; loop < record[0] >> 8; loop++, row->centre++, row->centre_place++) {
        const uint32_t edges = record[1 + loop];
        put_mean(row, names, edges);
        for (uint32_t edge = 0; edge < 12; edge++) {
            if (!(edges >> edge & 1))
                continue;
            const bool inside = pattern >> hewn_cube_edge_start(edge) & 1;
            const uint64_t quad = names[edge] - lattice->before.vertices;
            row->out->indices[6 * quad + find_slot(edge, inside, turn)] = row->centre;
        }
    }
}

/* --- quads -------------------------------------------------------------------------------------------------------- */

static double distance(const float *positions, uint32_t a, uint32_t b)
{
    double sum = 0;
    for (size_t axis = 0; axis < 3; axis++) {
        const double off = (double)positions[3 * (size_t)a + axis] - (double)positions[3 * (size_t)b + axis];
        sum += off * off;
    }
    return sum;
}

void hewn_nets_cut_quads(const hewn_lattice *lattice, hewn_triangles *out)
{
    const uint64_t quads = lattice->vertex_count;
#pragma omp parallel for schedule(static) if (quads > 4096)
    for (uint64_t q = 0; q < quads; q++) {
        uint32_t *to = out->indices + 6 * q;
        const uint32_t a = to[0], b = to[1], c = to[2], d = to[3];
        const bool other = distance(out->positions, b, d) < distance(out->positions, a, c);
        const uint32_t cut[2][6] = {{a, b, c, a, c, d}, {a, b, d, b, c, d}};
        for (int i = 0; i < 6; i++)
            to[i] = cut[other][i];
    }
}
