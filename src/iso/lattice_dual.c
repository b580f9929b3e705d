#include "iso/lattice_dual.h"

#include <math.h>

#include "base/alloc.h"
#include "base/error.h"
#include "geom/near_triangle.h"
#include "iso/dual_cells.h"

/* Diagonals that pass a crossing with less of a difference than this part of their length are as near. */
static const double FLAT = 1e-3;

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

hewn_result hewn_lattice_dual_table_make(hewn_mc33_table *out, hewn_error *error)
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

uint32_t hewn_lattice_dual_decide(const hewn_lattice *lattice, uint32_t head, const uint32_t at[3])
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

/* --- quads -------------------------------------------------------------------------------------------------------- */

static void find_point(const float *points, uint64_t n, double out[3])
{
    for (uint64_t axis = 0; axis < 3; axis++)
        out[axis] = (double)points[3 * n + axis];
}

static double distance(const double a[3], const double b[3])
{
    double sum = 0;
    for (int axis = 0; axis < 3; axis++)
        sum += (a[axis] - b[axis]) * (a[axis] - b[axis]);
    return sum;
}

/* How far a crossing is from its quad abcd, cut from a to c. */
static double miss(const double at[3], const double a[3], const double b[3], const double c[3], const double d[3])
{
    return fmin(hewn_triangle_distance_squared(at, a, b, c), hewn_triangle_distance_squared(at, a, c, d));
}

/* Whether a quad is to be cut from its second corner to its fourth. Flat ones have two diagonals that are as near. */
static bool cut_other(const hewn_lattice *lattice, uint64_t quad, const double p[4][3])
{
    const double one = distance(p[0], p[2]), other = distance(p[1], p[3]);
    if (!lattice->planes)
        return other < one;
    double at[3];
    find_point(lattice->crossings->positions, quad, at);
    const double first = miss(at, p[0], p[1], p[2], p[3]), second = miss(at, p[1], p[2], p[3], p[0]);
    const double flat = FLAT * FLAT * fmin(one, other);
    return fabs(second - first) <= flat ? other < one : second < first;
}

void hewn_lattice_dual_cut(const hewn_lattice *lattice, uint64_t first, uint64_t end, hewn_triangles *out)
{
    const uint64_t from = lattice->before.vertices;
#pragma omp parallel for schedule(static) if (end - first > 4096)
    for (uint64_t q = first - from; q < end - from; q++) {
        uint32_t *to = out->indices + 6 * q;
        const uint32_t a = to[0], b = to[1], c = to[2], d = to[3];
        double p[4][3];
        for (int corner = 0; corner < 4; corner++)
            find_point(out->positions, to[corner] - lattice->before.centres, p[corner]);
        const uint32_t cut[2][6] = {{a, b, c, a, c, d}, {a, b, d, b, c, d}};
        const bool other = cut_other(lattice, q, (const double(*)[3])p);
        for (int i = 0; i < 6; i++)
            to[i] = cut[other][i];
    }
}
