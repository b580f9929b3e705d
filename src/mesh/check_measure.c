#include "mesh/check_measure.h"

#include <math.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/progress.h"

/* Floating-point sums run over blocks of fixed size, then over the blocks in order, so they do not depend on how many
 * threads there are. A slice is what is done between two looks at the progress callback. */
enum { BLOCK = 1 << 14, SLICE = 1 << 22 };

static uint64_t least(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

/* --- bounds ------------------------------------------------------------------------------------------------------- */

static hewn_box empty_box(void)
{
    return (hewn_box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}

static inline void grow_box(hewn_box *box, const double lo[3], const double hi[3])
{
    for (int axis = 0; axis < 3; axis++) {
        box->lo[axis] = lo[axis] < box->lo[axis] ? lo[axis] : box->lo[axis];
        box->hi[axis] = hi[axis] > box->hi[axis] ? hi[axis] : box->hi[axis];
    }
}

/* An empty box becomes zero. -0 and 0 are equal, so which one came first must not show. */
static void finish_box(hewn_box *box)
{
    bool empty = box->lo[0] > box->hi[0];
    for (int axis = 0; axis < 3; axis++) {
        box->lo[axis] = empty ? 0 : box->lo[axis] + 0.0;
        box->hi[axis] = empty ? 0 : box->hi[axis] + 0.0;
    }
}

void hewn_measure_bounds(const hewn_face_view *view, hewn_box *out)
{
    hewn_box all = empty_box();
#pragma omp parallel if (view->face_count >= HEWN_CHECK_ALONE)
    {
        hewn_box part = empty_box();
#pragma omp for schedule(static)
        for (uint64_t c = 0; c < view->corner_count; c++) {
            double point[3];
            hewn_face_view_point(view, view->corners[c], point);
            grow_box(&part, point, point);
        }
#pragma omp critical(hewn_measure_box)
        grow_box(&all, part.lo, part.hi);
    }
    finish_box(&all);
    *out = all;
}

/* --- volume and area ---------------------------------------------------------------------------------------------- */

/* Positions are taken times `scale`, a power of two: 1 unless products of doubles could overflow or vanish. */
typedef struct ruler {
    double origin[3]; /* scaled */
    double scale;
    int exponent; /* scale is 2^exponent */
    double doubt; /* a squared normal above this is no rounding error, whatever the triangle */
} ruler;

static ruler choose_ruler(const hewn_triangle_view *mesh, const hewn_box *bounds)
{
    double most = 0;
    ruler out = {.scale = 1};
    for (int axis = 0; axis < 3; axis++)
        most = fmax(most, fmax(fabs(bounds->lo[axis]), fabs(bounds->hi[axis])));
    frexp(most, &out.exponent);
    bool usual = !mesh->doubles || most == 0 || (out.exponent > -100 && out.exponent < 100);
    out.exponent = usual ? 0 : out.exponent < -1020 ? 1020 : -out.exponent;
    out.scale = ldexp(1, out.exponent);
    double square = 0;
    for (int axis = 0; axis < 3; axis++) {
        double lo = bounds->lo[axis] * out.scale, hi = bounds->hi[axis] * out.scale;
        out.origin[axis] = 0.5 * (lo + hi);
        square += (hi - lo) * (hi - lo);
    }
    out.doubt = fmax(1e-24 * square * square, 1e-200);
    return out;
}

typedef struct sums {
    double volume; /* × 6 */
    double area;   /* × 2 */
    uint64_t flat;
} sums;

static double length_squared(const double *a)
{
    return a[0] * a[0] + a[1] * a[1] + a[2] * a[2];
}

/* Whether the corners of a triangle lie on one line. Only a normal that is tiny beside its sides leaves doubt. */
static bool is_flat(const hewn_triangle_view *mesh, const uint32_t *corner, double square, double factors)
{
    if (square > 1e-24 * factors && square > 1e-200)
        return false;
    double a[3], b[3], c[3];
    hewn_triangle_point(mesh, corner[0], a);
    hewn_triangle_point(mesh, corner[1], b);
    hewn_triangle_point(mesh, corner[2], c);
    return hewn_points_collinear(a, b, c);
}

static inline void measure_point(const hewn_triangle_view *mesh, uint32_t vertex, const ruler *by, bool floats,
                                 double out[3])
{
    for (int axis = 0; axis < 3; axis++)
        out[axis] = floats ? (double)mesh->floats[3 * (uint64_t)vertex + (uint64_t)axis]
                           : mesh->doubles[3 * (uint64_t)vertex + (uint64_t)axis] * by->scale;
}

/* One triangle: the tetrahedron that it spans with the origin, and its area. `floats` is known where this is inlined,
 * and scales nothing. */
static inline void measure_triangle(const hewn_triangle_view *mesh, uint64_t t, const ruler *by, bool floats, sums *sum)
{
    const uint32_t *corner = mesh->corners + 3 * t;
    double a[3], b[3], c[3], u[3], v[3], w[3];
    measure_point(mesh, corner[0], by, floats, a);
    measure_point(mesh, corner[1], by, floats, b);
    measure_point(mesh, corner[2], by, floats, c);
    for (int axis = 0; axis < 3; axis++) {
        u[axis] = b[axis] - a[axis];
        v[axis] = c[axis] - a[axis];
        w[axis] = a[axis] - by->origin[axis];
    }
    double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    double square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
    sum->volume += w[0] * n[0] + w[1] * n[1] + w[2] * n[2];
    sum->area += sqrt(square);
    if (!(square > by->doubt))
        sum->flat += is_flat(mesh, corner, square, length_squared(u) * length_squared(v));
}

static sums measure_block(const hewn_triangle_view *mesh, const ruler *by, uint64_t begin, uint64_t end)
{
    sums sum = {0};
    if (mesh->doubles)
        for (uint64_t t = begin; t < end; t++)
            measure_triangle(mesh, t, by, false, &sum);
    else
        for (uint64_t t = begin; t < end; t++)
            measure_triangle(mesh, t, by, true, &sum);
    return sum;
}

/* Blocks first to last - 1 into `parts`. */
static void measure_blocks(const hewn_triangle_view *mesh, const ruler *by, uint64_t first, uint64_t last, sums *parts)
{
#pragma omp parallel for schedule(dynamic, 1) if (last - first > 1)
    for (uint64_t block = first; block < last; block++)
        parts[block] = measure_block(mesh, by, block * BLOCK, least((block + 1) * BLOCK, mesh->triangle_count));
}

hewn_result hewn_measure_triangles(const hewn_triangle_view *mesh, const char *stage, const hewn_progress *progress,
                                   hewn_measure *out, hewn_error *error)
{
    ruler by = choose_ruler(mesh, &out->bounds);
    uint64_t blocks = (mesh->triangle_count + BLOCK - 1) / BLOCK;
    sums *parts = hewn_alloc(blocks, sizeof *parts), all = {0};
    if (!parts)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %llu sums", (unsigned long long)blocks);
    hewn_result result = HEWN_OK;
    for (uint64_t first = 0; first < blocks && result == HEWN_OK; first += SLICE / BLOCK) {
        uint64_t last = least(first + SLICE / BLOCK, blocks);
        measure_blocks(mesh, &by, first, last, parts);
        for (uint64_t block = first; block < last; block++) {
            all.volume += parts[block].volume;
            all.area += parts[block].area;
            all.flat += parts[block].flat;
        }
        result = hewn_progress_report(progress, stage, 0.1 + 0.2 * (double)last / (double)blocks, error);
    }
    hewn_free(parts);
    out->volume = ldexp(all.volume / 6, -3 * by.exponent);
    out->area = ldexp(all.area / 2, -2 * by.exponent);
    out->flat_triangles = all.flat;
    return result;
}

/* --- components --------------------------------------------------------------------------------------------------- */

static void bound_components(const hewn_face_view *view, const hewn_components *components, hewn_measure *out)
{
    for (uint32_t slot = 0; slot < components->listed; slot++)
        out[slot].bounds = empty_box();
    for (uint64_t v = 0; v < view->vertex_count; v++) {
        double point[3];
        hewn_face_view_point(view, (uint32_t)v, point);
        if (components->slots[v] < components->listed)
            grow_box(&out[components->slots[v]].bounds, point, point);
    }
    for (uint32_t slot = 0; slot < components->listed; slot++)
        finish_box(&out[slot].bounds);
}

/* In the order of triangles. A component is measured about its own middle, where its volume rounds least. */
hewn_result hewn_measure_components(const hewn_face_view *view, const hewn_triangle_view *mesh,
                                    const hewn_components *components, hewn_measure *out, hewn_error *error)
{
    ruler *rulers = hewn_alloc(components->listed, sizeof *rulers);
    if (!rulers)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %u components", components->listed);
    for (uint32_t slot = 0; slot < components->listed; slot++)
        out[slot] = (hewn_measure){0};
    bound_components(view, components, out);
    for (uint32_t slot = 0; slot < components->listed; slot++)
        rulers[slot] = choose_ruler(mesh, &out[slot].bounds);
    for (uint64_t t = 0; t < mesh->triangle_count; t++) {
        uint32_t slot = components->slots[mesh->corners[3 * t]];
        if (slot == components->listed)
            continue;
        sums one = measure_block(mesh, &rulers[slot], t, t + 1);
        out[slot].volume += one.volume;
        out[slot].area += one.area;
    }
    for (uint32_t slot = 0; slot < components->listed; slot++) {
        out[slot].volume = ldexp(out[slot].volume / 6, -3 * rulers[slot].exponent);
        out[slot].area = ldexp(out[slot].area / 2, -2 * rulers[slot].exponent);
    }
    hewn_free(rulers);
    return HEWN_OK;
}
