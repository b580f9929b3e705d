/* Vertices where the surface passes the lattice's edges: where, and which way is out. */
#include "iso/lattice_blocks.h"
#include "iso/lattice_pen.h"
#include "iso/lattice_sample.h"

/* The edges of a row that start at its samples, and where what they emit goes. */
typedef struct edge_row {
    uint32_t j, k; /* with the rim */
    hewn_lattice_pen pen;
} edge_row;

/* Samples along an axis around one that is at `at` of `count`. */
HEWN_LATTICE_INLINE hewn_lattice_line line_along(const hewn_lattice *lattice, uint64_t number, uint32_t at,
                                                 uint32_t count, uint64_t step, hewn_voxel type)
{
    const uint32_t reach = HEWN_LATTICE_REACH, rest = count - 1 - at;
    hewn_lattice_line line = {.before = at < reach ? at : reach, .after = rest < reach ? rest : reach};
    for (uint32_t n = HEWN_LATTICE_REACH - line.before; n <= HEWN_LATTICE_REACH + line.after; n++)
        line.value[n] = hewn_lattice_value(lattice, number + step * n - step * HEWN_LATTICE_REACH, type);
    return line;
}

/* The slope that hewn_lattice_slope() finds, from no more samples than it takes: most meshes need nothing else. */
HEWN_LATTICE_INLINE double slope_along(const hewn_lattice *lattice, uint64_t number, uint32_t at, uint32_t count,
                                       uint64_t step, hewn_voxel type)
{
    if (count == 1)
        return 0;
    const uint64_t lo = at > 0 ? number - step : number, hi = at + 1 < count ? number + step : number;
    const double rise = hewn_lattice_value(lattice, hi, type) - hewn_lattice_value(lattice, lo, type);
    return hi - lo == 2 * step ? rise / 2 : rise;
}

HEWN_LATTICE_INLINE void gradient_at(const hewn_lattice *lattice, const uint32_t at[3], hewn_voxel type, double out[3])
{
    const uint32_t *dims = lattice->volume->dims;
    uint64_t step[3] = {1, dims[0], (uint64_t)dims[0] * dims[1]};
    uint64_t number = lattice->first + at[0] + at[1] * step[1] + at[2] * step[2];
    hewn_lattice_line lines[3];
    for (int axis = 0; axis < 3 && !lattice->planes; axis++)
        out[axis] = slope_along(lattice, number, at[axis], dims[axis], step[axis], type);
    if (!lattice->planes)
        return;
    for (int axis = 0; axis < 3; axis++)
        lines[axis] = line_along(lattice, number, at[axis], dims[axis], step[axis], type);
    hewn_lattice_gradient(lattice, lines, out);
}

HEWN_LATTICE_INLINE void emit_edge(edge_row *row, uint32_t i, bool inside, hewn_voxel type)
{
    const hewn_lattice *lattice = row->pen.lattice;
    const uint32_t *dims = lattice->volume->dims, axis = row->pen.axis, rim = lattice->rim;
    uint32_t from[3] = {i, row->j, row->k};
    bool begins = hewn_lattice_in_rim(lattice, (int)axis, from[axis]);
    bool ends = hewn_lattice_in_rim(lattice, (int)axis, from[axis] + 1);
    for (int a = 0; a < 3; a++)
        from[a] -= rim;
    if (begins || ends) {
        from[axis] += begins;
        hewn_lattice_put_cap(&row->pen, from, ends);
        return;
    }
    uint32_t to[3] = {from[0], from[1], from[2]};
    to[axis]++;
    uint64_t step = axis == 0 ? 1 : axis == 1 ? dims[0] : (uint64_t)dims[0] * dims[1];
    uint64_t number = lattice->first + from[0] + dims[0] * (from[1] + (uint64_t)dims[1] * from[2]);
    const double here = hewn_lattice_signed(lattice, number, inside, type);
    const double there = hewn_lattice_signed(lattice, number + step, !inside, type);
    double share = hewn_lattice_share(lattice, here, there);
    double first[3] = {0}, last[3] = {0};
    if (lattice->normals) {
        gradient_at(lattice, from, type, first);
        gradient_at(lattice, to, type, last);
    }
    if (lattice->planes)
        hewn_lattice_follow_bend(lattice, axis, here, there, &share, first, last);
    hewn_lattice_put_edge(&row->pen, from, share, inside, first, last);
}

HEWN_LATTICE_INLINE void emit_row(edge_row *row, hewn_voxel type)
{
    const hewn_lattice *lattice = row->pen.lattice;
    const uint32_t axis = row->pen.axis;
    const uint64_t *here = hewn_lattice_bits(lattice, row->j, row->k), *other = here;
    if (axis > 0)
        other = hewn_lattice_bits(lattice, row->j + (axis == 1), row->k + (axis == 2));
    for (uint32_t word = 0; word < lattice->words; word++) {
        uint64_t next = axis == 0 ? hewn_lattice_next(here, word) : other[word];
        uint64_t rest = (here[word] ^ next) & hewn_lattice_edges(lattice, axis, row->j, row->k, word);
        for (; rest; rest &= rest - 1) {
            uint32_t bit = hewn_lattice_lowest(rest);
            emit_edge(row, 64 * word + bit, here[word] >> bit & 1, type);
        }
    }
}

/* Asks for what edges of a row towards the next slice will be the first to read: samples a slice farther, two with
 * gradients. Rows follow each other at distances that processors do not foresee, so each read would be waited for. */
HEWN_LATTICE_INLINE void fetch_row(const hewn_lattice *lattice, uint32_t j, uint32_t k, hewn_voxel type)
{
    enum { LINE = 64 };
    const hewn_volume *volume = lattice->volume;
    const uint32_t rim = lattice->rim, slice = k + 1 + lattice->normals - rim;
    if (j < rim || j - rim >= volume->dims[1] || k + 1 >= lattice->dims[2] || slice >= volume->dims[2])
        return;
    const uint64_t *here = hewn_lattice_bits(lattice, j, k), *above = hewn_lattice_bits(lattice, j, k + 1);
    const size_t size = hewn_voxel_size(type), length = size * volume->dims[0], part = 64 * size;
    const char *row = (const char *)volume->samples +
                      size * (lattice->first + volume->dims[0] * (j - rim + (uint64_t)volume->dims[1] * slice));
    for (uint32_t word = 0; word < lattice->words; word++)
        if (here[word] ^ above[word])
            for (size_t at = word * part; at < word * part + part && at < length; at += LINE)
                __builtin_prefetch(row + at);
}

HEWN_LATTICE_INLINE void emit_slice(const hewn_lattice *lattice, uint32_t k, hewn_triangles *out, hewn_voxel type)
{
    for (uint32_t j = 0; j < lattice->dims[1]; j++) {
        const hewn_lattice_row *begin = hewn_lattice_row_at(lattice, j, k);
        uint64_t place = begin->vertices[0] - lattice->before.vertices;
        edge_row row = {.j = j, .k = k, .pen = {.lattice = lattice, .position = out->positions + 3 * place}};
        row.pen.normal = lattice->normals ? out->normals + 3 * place : NULL;
        for (uint32_t axis = 0; axis < 3; axis++) {
            const uint32_t at[3] = {0, j, k};
            row.pen.axis = axis;
            if (axis == 0 || at[axis] + 1 < lattice->dims[axis])
                emit_row(&row, type);
        }
        if (j + 1 < lattice->dims[1])
            fetch_row(lattice, j + 1, k, type);
    }
}

#define EMIT(enumerator, type)                                                                                         \
    case enumerator: emit_slice(lattice, k, out, enumerator); break;

void hewn_lattice_emit_vertices(const hewn_lattice *lattice, hewn_triangles *out)
{
    if (lattice->blocks) {
        hewn_lattice_blocks_emit_vertices(lattice, out);
        return;
    }
#pragma omp parallel for schedule(dynamic, 4) if (lattice->dims[2] > 8)
    for (uint32_t k = lattice->begin; k < hewn_lattice_rows_end(lattice); k++) {
        switch (lattice->volume->type) {
            HEWN_VOXEL_TYPES(EMIT)
            EMIT(HEWN_VOXEL_HALF, uint16_t)
        }
    }
}
