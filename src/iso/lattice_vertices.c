/* Vertices where the surface passes the lattice's edges: where, and which way is out. */
#include <math.h>

#include "iso/lattice_sample.h"

/* The edges of a row that start at its samples, and where what they emit goes. */
typedef struct edge_row {
    const hewn_lattice *lattice;
    uint32_t j, k; /* with the rim */
    uint32_t axis;
    float *position, *normal;
} edge_row;

/* A difference of values along an axis, central where there are samples on both sides. */
HEWN_LATTICE_INLINE double slope_along(const hewn_lattice *lattice, uint64_t number, uint32_t at, uint32_t count,
                                       uint64_t step, hewn_voxel type)
{
    if (count == 1)
        return 0;
    uint64_t lo = at > 0 ? number - step : number, hi = at + 1 < count ? number + step : number;
    double rise = hewn_lattice_value(lattice, hi, type) - hewn_lattice_value(lattice, lo, type);
    return hi - lo == 2 * step ? rise / 2 : rise;
}

HEWN_LATTICE_INLINE void gradient_at(const hewn_lattice *lattice, const uint32_t at[3], hewn_voxel type, double out[3])
{
    const uint32_t *dims = lattice->volume->dims;
    uint64_t step[3] = {1, dims[0], (uint64_t)dims[0] * dims[1]};
    uint64_t number = lattice->first + at[0] + at[1] * step[1] + at[2] * step[2];
    for (int axis = 0; axis < 3; axis++)
        out[axis] = slope_along(lattice, number, at[axis], dims[axis], step[axis], type);
}

static void put_position(const edge_row *row, const double at[3], float *out)
{
    const double *m = row->lattice->place;
    for (int i = 0; i < 3; i++)
        out[i] = (float)(m[4 * i] * at[0] + m[4 * i + 1] * at[1] + m[4 * i + 2] * at[2] + m[4 * i + 3]);
}

/* `fallback` is an outward direction along the edge's axis, for where samples have no slope. */
static void put_normal(const edge_row *row, const double gradient[3], double fallback, float *out)
{
    const double *m = row->lattice->turn;
    double normal[3], most = 0, sum = 0;
    for (int i = 0; i < 3; i++) {
        normal[i] = m[3 * i] * gradient[0] + m[3 * i + 1] * gradient[1] + m[3 * i + 2] * gradient[2];
        most = fmax(most, fabs(normal[i]));
    }
    if (!(most > 0)) {
        most = 0;
        for (int i = 0; i < 3; i++) {
            normal[i] = fallback * m[3 * i + (int)row->axis];
            most = fmax(most, fabs(normal[i]));
        }
    }
    for (int i = 0; i < 3; i++) {
        normal[i] /= most;
        sum += normal[i] * normal[i];
    }
    sum = 1 / sqrt(sum);
    for (int i = 0; i < 3; i++)
        out[i] = (float)(normal[i] * sum);
}

/* An edge between a sample and the rim, a hair beyond the sample; its normal points along the edge. `end` tells that
 * the edge ends in the rim, `at` is the sample. */
static void emit_cap(edge_row *row, const uint32_t at[3], bool end)
{
    const hewn_lattice *lattice = row->lattice;
    double place[3] = {at[0], at[1], at[2]}, none[3] = {0};
    place[row->axis] += end ? lattice->margin : -lattice->margin;
    put_position(row, place, row->position);
    row->position += 3;
    if (!lattice->normals)
        return;
    /* turn makes outward directions of gradients: above, the outside is where values fall. */
    put_normal(row, none, end == lattice->above ? -1 : 1, row->normal);
    row->normal += 3;
}

HEWN_LATTICE_INLINE void emit_edge(edge_row *row, uint32_t i, bool inside, hewn_voxel type)
{
    const hewn_lattice *lattice = row->lattice;
    const uint32_t *dims = lattice->volume->dims, axis = row->axis, rim = lattice->rim;
    uint32_t from[3] = {i, row->j, row->k};
    bool begins = hewn_lattice_in_rim(lattice, (int)axis, from[axis]);
    bool ends = hewn_lattice_in_rim(lattice, (int)axis, from[axis] + 1);
    for (int a = 0; a < 3; a++)
        from[a] -= rim;
    if (begins || ends) {
        from[axis] += begins;
        emit_cap(row, from, ends);
        return;
    }
    uint32_t to[3] = {from[0], from[1], from[2]};
    to[axis]++;
    uint64_t step = axis == 0 ? 1 : axis == 1 ? dims[0] : (uint64_t)dims[0] * dims[1];
    uint64_t number = lattice->first + from[0] + dims[0] * (from[1] + (uint64_t)dims[1] * from[2]);
    double here = hewn_lattice_signed(lattice, number, inside, type);
    double there = hewn_lattice_signed(lattice, number + step, !inside, type);
    double share = here != there ? here / (here - there) : 0.5;
    share = share < lattice->margin ? lattice->margin : share > 1 - lattice->margin ? 1 - lattice->margin : share;
    double place[3] = {from[0], from[1], from[2]};
    place[axis] += share;
    put_position(row, place, row->position);
    row->position += 3;
    if (!lattice->normals)
        return;
    double first[3], last[3];
    gradient_at(lattice, from, type, first);
    gradient_at(lattice, to, type, last);
    for (int a = 0; a < 3; a++)
        first[a] += share * (last[a] - first[a]);
    put_normal(row, first, inside == lattice->above ? -1 : 1, row->normal);
    row->normal += 3;
}

HEWN_LATTICE_INLINE void emit_row(edge_row *row, hewn_voxel type)
{
    const hewn_lattice *lattice = row->lattice;
    const uint64_t *here = hewn_lattice_bits(lattice, row->j, row->k), *other = here;
    if (row->axis > 0)
        other = hewn_lattice_bits(lattice, row->j + (row->axis == 1), row->k + (row->axis == 2));
    uint32_t count = row->axis == 0 ? lattice->dims[0] - 1 : lattice->dims[0];
    for (uint32_t word = 0; word < lattice->words; word++) {
        uint64_t next = row->axis == 0 ? hewn_lattice_next(here, word) : other[word];
        uint64_t rest = (here[word] ^ next) & hewn_lattice_mask(word, count);
        for (; rest; rest &= rest - 1) {
            uint32_t bit = hewn_lattice_lowest(rest);
            emit_edge(row, 64 * word + bit, here[word] >> bit & 1, type);
        }
    }
}

HEWN_LATTICE_INLINE void emit_slice(const hewn_lattice *lattice, uint32_t k, hewn_triangles *out, hewn_voxel type)
{
    for (uint32_t j = 0; j < lattice->dims[1]; j++) {
        const hewn_lattice_row *begin = hewn_lattice_row_at(lattice, j, k);
        edge_row row = {.lattice = lattice, .j = j, .k = k};
        uint64_t place = begin->vertices[0] - lattice->before.vertices;
        row.position = out->positions + 3 * place;
        row.normal = lattice->normals ? out->normals + 3 * place : NULL;
        for (row.axis = 0; row.axis < 3; row.axis++) {
            const uint32_t at[3] = {0, j, k};
            if (row.axis == 0 || at[row.axis] + 1 < lattice->dims[row.axis])
                emit_row(&row, type);
        }
    }
}

#define EMIT(enumerator, type)                                                                                         \
    case enumerator: emit_slice(lattice, k, out, enumerator); break;

void hewn_lattice_emit_vertices(const hewn_lattice *lattice, hewn_triangles *out)
{
#pragma omp parallel for schedule(dynamic, 4) if (lattice->dims[2] > 8)
    for (uint32_t k = lattice->begin; k < hewn_lattice_rows_end(lattice); k++) {
        switch (lattice->volume->type) {
            HEWN_VOXEL_TYPES(EMIT)
            EMIT(HEWN_VOXEL_HALF, uint16_t)
        }
    }
}
