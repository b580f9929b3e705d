/* Keeping the volume of closed components: all that is free moves by one distance along its normals, and the volume is
 * a cubic in that distance. */
#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "smooth/blocks.h"
#include "smooth/work.h"

/* The volume of a component at distance s: c[0] + c[1] s + c[2] s^2 + c[3] s^3. */
typedef struct component {
    double before, c[4];
    uint64_t balance; /* 0 where each edge is run along as often one way as the other */
} component;

enum { MOST_SUMS = 1 << 16 }; /* of components by blocks */

typedef struct keeper {
    smooth_work *work;
    const double *before;
    uint32_t *root; /* of each vertex in a union-find, then its component */
    double *directions;
    uint32_t count, blocks;
    component *components; /* for each block of triangles */
    double *shifts;        /* of components */
} keeper;

static uint32_t find_root(uint32_t *root, uint32_t v)
{
    while (root[v] != v)
        v = root[v] = root[root[v]];
    return v;
}

static void join_components(keeper *keep)
{
    const hewn_polygons *cut = &keep->work->cut;
    for (uint32_t v = 0; v < keep->work->count; v++)
        keep->root[v] = v;
    for (uint64_t c = 0; c < 3 * cut->face_count; c++) {
        uint32_t a = find_root(keep->root, cut->corners[c]), b = find_root(keep->root, cut->corners[c - c % 3]);
        keep->root[a > b ? a : b] = a < b ? a : b; /* the least vertex stays the root */
    }
    for (uint32_t v = 0; v < keep->work->count; v++)
        keep->root[v] = keep->root[v] == v ? keep->count++ : keep->root[keep->root[v]];
}

static uint64_t mix(uint64_t z)
{
    z += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
}

static uint64_t side_value(uint32_t a, uint32_t b)
{
    uint64_t value = mix(a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a);
    return a < b ? value : 0 - value;
}

static double det(const double *a, const double *b, const double *c)
{
    double n[3];
    smooth_cross(b, c, n);
    return smooth_dot(a, n);
}

static void add_triangle(const keeper *keep, const uint32_t *corner, component *components)
{
    const double *p[3], *d[3], *was[3];
    component *to = &components[keep->root[corner[0]]];
    for (int k = 0; k < 3; k++) {
        p[k] = keep->work->at + 3 * (size_t)corner[k];
        d[k] = keep->directions + 3 * (size_t)corner[k];
        was[k] = keep->before + 3 * (size_t)corner[k];
        if (corner[k] != corner[(k + 1) % 3])
            to->balance += side_value(corner[k], corner[(k + 1) % 3]);
    }
    to->before += det(was[0], was[1], was[2]) / 6;
    to->c[0] += det(p[0], p[1], p[2]) / 6;
    to->c[1] += (det(d[0], p[1], p[2]) + det(p[0], d[1], p[2]) + det(p[0], p[1], d[2])) / 6;
    to->c[2] += (det(d[0], d[1], p[2]) + det(d[0], p[1], d[2]) + det(p[0], d[1], d[2])) / 6;
    to->c[3] += det(d[0], d[1], d[2]) / 6;
}

static void add_triangles(const keeper *keep)
{
    const hewn_polygons *cut = &keep->work->cut;
#pragma omp parallel for schedule(static)
    for (uint32_t block = 0; block < keep->blocks; block++) {
        uint64_t end = smooth_block_begin(cut->face_count, keep->blocks, block + 1);
        for (uint64_t t = smooth_block_begin(cut->face_count, keep->blocks, block); t < end; t++)
            add_triangle(keep, cut->corners + 3 * t, keep->components + (size_t)block * keep->count);
    }
    for (size_t block = 1; block < keep->blocks; block++)
        for (size_t i = 0; i < keep->count; i++) {
            component *to = &keep->components[i];
            const component *part = to + block * keep->count;
            to->before += part->before;
            to->balance += part->balance;
            for (int k = 0; k < 4; k++)
                to->c[k] += part->c[k];
        }
}

/* Unit normals where a vertex is free, scaled by its freedom. */
static void find_directions(keeper *keep)
{
    const smooth_work *work = keep->work;
    memset(keep->directions, 0, 3 * (size_t)work->count * sizeof(double));
    for (uint64_t t = 0; t < work->cut.face_count; t++) {
        const uint32_t *corner = work->cut.corners + 3 * t;
        double u[3], v[3], n[3];
        smooth_between(work->at + 3 * (size_t)corner[0], work->at + 3 * (size_t)corner[1], u);
        smooth_between(work->at + 3 * (size_t)corner[0], work->at + 3 * (size_t)corner[2], v);
        smooth_cross(u, v, n);
        for (int k = 0; k < 3; k++)
            for (size_t axis = 0; axis < 3; axis++)
                keep->directions[3 * (size_t)corner[k] + axis] += n[axis];
    }
    for (uint32_t v = 0; v < work->count; v++) {
        double *d = keep->directions + 3 * (size_t)v, length = sqrt(smooth_dot(d, d)), free = smooth_freedom(work, v);
        for (int axis = 0; axis < 3; axis++)
            d[axis] = length > 0 ? d[axis] / length * free : 0;
    }
}

/* The root of the cubic that Newton's method finds from 0; 0 where it finds none nearby. */
static double find_shift(const component *part)
{
    double s = 0;
    for (int i = 0; i < 50; i++) {
        double value = part->c[0] + s * (part->c[1] + s * (part->c[2] + s * part->c[3])) - part->before;
        double slope = part->c[1] + s * (2 * part->c[2] + s * 3 * part->c[3]);
        if (!(fabs(slope) > 0) || !isfinite(value / slope))
            return 0;
        s -= value / slope;
        if (fabs(value) <= 1e-14 * fabs(part->before))
            break;
    }
    double left = part->c[0] + s * (part->c[1] + s * (part->c[2] + s * part->c[3])) - part->before;
    return fabs(left) <= 1e-9 * fabs(part->before) ? s : 0;
}

static void move(keeper *keep)
{
    smooth_work *work = keep->work;
    for (uint32_t i = 0; i < keep->count; i++) {
        const component *part = &keep->components[i];
        bool closed = part->balance == 0 && part->before != 0;
        keep->shifts[i] = closed ? find_shift(part) : 0;
        work->report->closed_components += closed;
    }
#pragma omp parallel for schedule(static)
    for (uint32_t v = 0; v < work->count; v++)
        for (size_t axis = 0; axis < 3; axis++)
            work->at[3 * (size_t)v + axis] += keep->shifts[keep->root[v]] * keep->directions[3 * (size_t)v + axis];
}

hewn_result hewn_smooth_keep_volume(smooth_work *work, const double *before, hewn_error *error)
{
    keeper keep = {.work = work, .before = before, .root = hewn_alloc(work->count, sizeof *keep.root)};
    keep.directions = hewn_alloc(work->count, 3 * sizeof *keep.directions);
    if (keep.root && keep.directions) {
        join_components(&keep);
        uint32_t most = MOST_SUMS / (keep.count > 0 ? keep.count : 1);
        keep.blocks = most > SMOOTH_BLOCKS ? SMOOTH_BLOCKS : most > 1 ? most : 1;
        keep.components = hewn_alloc_zero((size_t)keep.count * keep.blocks, sizeof *keep.components);
        keep.shifts = hewn_alloc(keep.count, sizeof *keep.shifts);
    }
    bool room = keep.components && keep.shifts;
    if (room) {
        find_directions(&keep);
        add_triangles(&keep);
        move(&keep);
    }
    hewn_free(keep.shifts);
    hewn_free(keep.components);
    hewn_free(keep.directions);
    hewn_free(keep.root);
    return room ? HEWN_OK : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory keeping the volume");
}
