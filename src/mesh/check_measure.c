#include "mesh/check_measure.h"

#include <math.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/progress.h"

/* A slice is what is done between two looks at the progress callback. */
enum { SLICE = 1 << 22 };

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
    double doubt; /* as hewn_measure_corners() takes it */
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

static inline void measure_point(const hewn_triangle_view *mesh, uint32_t vertex, const ruler *by, bool floats,
                                 double out[3])
{
    for (int axis = 0; axis < 3; axis++)
        out[axis] = floats ? (double)mesh->floats[3 * (uint64_t)vertex + (uint64_t)axis]
                           : mesh->doubles[3 * (uint64_t)vertex + (uint64_t)axis] * by->scale;
}

/* Whether the corners of a triangle lie on one line. */
static bool is_flat(const hewn_triangle_view *mesh, const uint32_t *corner)
{
    double a[3], b[3], c[3];
    hewn_triangle_point(mesh, corner[0], a);
    hewn_triangle_point(mesh, corner[1], b);
    hewn_triangle_point(mesh, corner[2], c);
    return hewn_points_collinear(a, b, c);
}

/* One triangle. `floats` is known where this is inlined, and scales nothing. */
static inline hewn_measured measure_triangle(const hewn_triangle_view *mesh, uint64_t t, const ruler *by, bool floats)
{
    const uint32_t *corner = mesh->corners + 3 * t;
    double a[3], b[3], c[3];
    measure_point(mesh, corner[0], by, floats, a);
    measure_point(mesh, corner[1], by, floats, b);
    measure_point(mesh, corner[2], by, floats, c);
    hewn_measured one = hewn_measure_corners(a, b, c, by->origin, by->doubt);
    one.flat = one.flat && is_flat(mesh, corner);
    return one;
}

static void measure_slice(const hewn_triangle_view *mesh, const ruler *by, uint64_t begin, uint64_t end,
                          hewn_measure_sums *all)
{
#pragma omp parallel if (end - begin >= HEWN_CHECK_ALONE)
    {
        hewn_measure_sums part = {0};
#pragma omp for schedule(static)
        for (uint64_t t = begin; t < end; t++)
            hewn_measure_sums_add(&part, mesh->doubles ? measure_triangle(mesh, t, by, false)
                                                       : measure_triangle(mesh, t, by, true));
#pragma omp critical(hewn_measure_sum)
        hewn_measure_sums_join(all, &part);
    }
}

void hewn_measure_sums_join(hewn_measure_sums *sums, hewn_measure_sums *part)
{
    hewn_exact_sum_join(&sums->volume, &part->volume);
    hewn_exact_sum_join(&sums->area, &part->area);
    sums->flat += part->flat;
}

/* Volumes are taken about the vertex of the least number that a face names: known early where a mesh comes in parts. */
static void choose_origin(const hewn_triangle_view *mesh, ruler *by)
{
    uint64_t count = 3 * mesh->triangle_count;
    uint32_t least_vertex = UINT32_MAX;
#pragma omp parallel for schedule(static) reduction(min : least_vertex) if (count >= HEWN_CHECK_ALONE)
    for (uint64_t i = 0; i < count; i++)
        least_vertex = mesh->corners[i] < least_vertex ? mesh->corners[i] : least_vertex;
    if (count > 0)
        measure_point(mesh, least_vertex, by, !mesh->doubles, by->origin);
}

hewn_result hewn_measure_triangles(const hewn_triangle_view *mesh, const char *stage, const hewn_progress *progress,
                                   hewn_measure *out, hewn_error *error)
{
    ruler by = choose_ruler(mesh, &out->bounds);
    hewn_measure_sums all = {0};
    uint64_t count = mesh->triangle_count;
    hewn_result result = HEWN_OK;
    choose_origin(mesh, &by);
    for (uint64_t begin = 0; begin < count && result == HEWN_OK; begin += SLICE) {
        uint64_t end = least(begin + SLICE, count);
        measure_slice(mesh, &by, begin, end, &all);
        result = hewn_progress_report(progress, stage, 0.1 + 0.2 * (double)end / (double)count, error);
    }
    out->volume = ldexp(hewn_exact_sum_value(&all.volume) / 6, -3 * by.exponent);
    out->area = ldexp(hewn_exact_sum_value(&all.area) / 2, -2 * by.exponent);
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
        hewn_measured one = measure_triangle(mesh, t, &rulers[slot], !mesh->doubles);
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
