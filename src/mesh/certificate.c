#include <math.h>
#include <stdatomic.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/progress.h"
#include "hewn/triangles.h"
#include "mesh/star.h"

/* Floating-point sums run over blocks of fixed size, then over the blocks in order, so they do not depend on how many
 * threads there are. A slice is what is done between two looks at the progress callback. */
enum { BLOCK = 1 << 14, SLICE = 1 << 22 };

static const char stage_name[] = "certify";

static uint64_t least(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

/* --- input ------------------------------------------------------------------------------------------------------- */

static hewn_result check_counts(const hewn_triangles *mesh, hewn_error *error)
{
    if ((mesh->vertex_count > 0 && !mesh->positions) || (mesh->triangle_count > 0 && !mesh->indices))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "triangles without positions or indices");
    if (mesh->vertex_count > UINT32_MAX || mesh->triangle_count > UINT32_MAX / 3)
        return hewn_fail(error, HEWN_LIMIT, "%llu vertices and %llu triangles are more than can be examined",
                         (unsigned long long)mesh->vertex_count, (unsigned long long)mesh->triangle_count);
    return HEWN_OK;
}

static hewn_result check_positions(const hewn_triangles *mesh, hewn_error *error)
{
    uint64_t count = mesh->vertex_count, bad = count;
#pragma omp parallel for schedule(static) reduction(min : bad) if (count >= HEWN_CERTIFY_ALONE)
    for (uint64_t v = 0; v < count; v++) {
        const float *p = mesh->positions + 3 * v;
        if (!(isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2])))
            bad = least(bad, v);
    }
    if (bad < count) {
        const float *p = mesh->positions + 3 * bad;
        return hewn_fail(error, HEWN_BAD_INPUT, "vertex %llu lies at (%g, %g, %g), which is not finite",
                         (unsigned long long)bad, (double)p[0], (double)p[1], (double)p[2]);
    }
    return HEWN_OK;
}

static hewn_result check_indices(const hewn_triangles *mesh, hewn_error *error)
{
    uint64_t count = mesh->triangle_count, bad = count;
#pragma omp parallel for schedule(static) reduction(min : bad) if (count >= HEWN_CERTIFY_ALONE)
    for (uint64_t t = 0; t < count; t++) {
        const uint32_t *corner = mesh->indices + 3 * t;
        if (corner[0] >= mesh->vertex_count || corner[1] >= mesh->vertex_count || corner[2] >= mesh->vertex_count)
            bad = least(bad, t);
    }
    if (bad < count) {
        const uint32_t *corner = mesh->indices + 3 * bad;
        return hewn_fail(error, HEWN_BAD_INPUT, "triangle %llu has the corners %u, %u, %u, but there are %llu vertices",
                         (unsigned long long)bad, corner[0], corner[1], corner[2],
                         (unsigned long long)mesh->vertex_count);
    }
    return HEWN_OK;
}

/* --- box, volume, area ---------------------------------------------------------------------------------------------
 */

typedef struct float_box {
    float lo[3], hi[3];
} float_box;

static float_box empty_box(void)
{
    return (float_box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}

static void grow_box(float_box *box, const float *point)
{
    for (int axis = 0; axis < 3; axis++) {
        box->lo[axis] = point[axis] < box->lo[axis] ? point[axis] : box->lo[axis];
        box->hi[axis] = point[axis] > box->hi[axis] ? point[axis] : box->hi[axis];
    }
}

/* A part without points is empty, its lo above its hi, and must not be taken for points. */
static void merge_box(float_box *box, const float_box *part)
{
    for (int axis = 0; axis < 3; axis++) {
        box->lo[axis] = part->lo[axis] < box->lo[axis] ? part->lo[axis] : box->lo[axis];
        box->hi[axis] = part->hi[axis] > box->hi[axis] ? part->hi[axis] : box->hi[axis];
    }
}

static void find_bounds(const hewn_triangles *mesh, hewn_box *out)
{
    float_box all = empty_box();
#pragma omp parallel if (mesh->triangle_count >= HEWN_CERTIFY_ALONE)
    {
        float_box part = empty_box();
#pragma omp for schedule(static)
        for (uint64_t t = 0; t < mesh->triangle_count; t++)
            for (int k = 0; k < 3; k++)
                grow_box(&part, mesh->positions + 3 * (uint64_t)mesh->indices[3 * t + k]);
#pragma omp critical(hewn_certificate_box)
        merge_box(&all, &part);
    }
    for (int axis = 0; axis < 3 && mesh->triangle_count > 0; axis++) {
        out->lo[axis] = (double)all.lo[axis] + 0.0; /* -0 and 0 are equal, so which one came first must not show */
        out->hi[axis] = (double)all.hi[axis] + 0.0;
    }
}

typedef struct measure {
    double volume; /* × 6 */
    double area;   /* × 2 */
    uint64_t degenerate;
} measure;

/* One triangle: the tetrahedron that it spans with `origin`, and its area. Differences of floats and their products are
 * close to exact in double, so a zero normal means a zero area. */
static void measure_triangle(const hewn_triangles *mesh, uint64_t t, const double origin[3], measure *sum)
{
    const uint32_t *corner = mesh->indices + 3 * t;
    const float *a = mesh->positions + 3 * (uint64_t)corner[0];
    const float *b = mesh->positions + 3 * (uint64_t)corner[1];
    const float *c = mesh->positions + 3 * (uint64_t)corner[2];
    double u[3], v[3], w[3];
    for (int axis = 0; axis < 3; axis++) {
        u[axis] = (double)b[axis] - (double)a[axis];
        v[axis] = (double)c[axis] - (double)a[axis];
        w[axis] = (double)a[axis] - origin[axis];
    }
    double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    double square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
    sum->volume += w[0] * n[0] + w[1] * n[1] + w[2] * n[2];
    sum->area += sqrt(square);
    sum->degenerate += square == 0.0;
}

/* Blocks first to last - 1 into `sums`. */
static void measure_blocks(const hewn_triangles *mesh, const double origin[3], uint64_t first, uint64_t last,
                           measure *sums)
{
#pragma omp parallel for schedule(dynamic, 1) if (last - first > 1)
    for (uint64_t block = first; block < last; block++) {
        measure sum = {0};
        uint64_t end = least((block + 1) * BLOCK, mesh->triangle_count);
        for (uint64_t t = block * BLOCK; t < end; t++)
            measure_triangle(mesh, t, origin, &sum);
        sums[block] = sum;
    }
}

static hewn_result measure_mesh(const hewn_triangles *mesh, const hewn_progress *progress, hewn_certificate *out,
                                hewn_error *error)
{
    double origin[3];
    for (int axis = 0; axis < 3; axis++)
        origin[axis] = 0.5 * (out->bounds.lo[axis] + out->bounds.hi[axis]);
    uint64_t blocks = (mesh->triangle_count + BLOCK - 1) / BLOCK;
    measure *sums = hewn_alloc(blocks, sizeof *sums);
    if (!sums)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %llu sums", (unsigned long long)blocks);
    hewn_result result = HEWN_OK;
    double volume = 0, area = 0;
    for (uint64_t first = 0; first < blocks && result == HEWN_OK; first += SLICE / BLOCK) {
        uint64_t last = least(first + SLICE / BLOCK, blocks);
        measure_blocks(mesh, origin, first, last, sums);
        for (uint64_t block = first; block < last; block++) {
            volume += sums[block].volume;
            area += sums[block].area;
            out->degenerate_faces += sums[block].degenerate;
        }
        result = hewn_progress_report(progress, stage_name, 0.1 + 0.2 * (double)last / (double)blocks, error);
    }
    hewn_free(sums);
    out->volume = volume / 6;
    out->area = area / 2;
    return result;
}

/* --- components ----------------------------------------------------------------------------------------------------
 */

/* The root of a vertex's tree. Roots have the least number of their tree, so trees only ever shrink toward it and
 * threads may shorten paths under each other's feet (Anderson and Woll 1991). */
static uint32_t find_root(_Atomic uint32_t *parent, uint32_t v)
{
    for (;;) {
        uint32_t up = atomic_load_explicit(&parent[v], memory_order_relaxed);
        if (up == v)
            return v;
        uint32_t above = atomic_load_explicit(&parent[up], memory_order_relaxed);
        if (above == up)
            return up;
        atomic_compare_exchange_weak_explicit(&parent[v], &up, above, memory_order_relaxed, memory_order_relaxed);
        v = above;
    }
}

static void join(_Atomic uint32_t *parent, uint32_t a, uint32_t b)
{
    for (;;) {
        a = find_root(parent, a);
        b = find_root(parent, b);
        if (a == b)
            return;
        uint32_t low = a < b ? a : b, high = a < b ? b : a, expected = high;
        if (atomic_compare_exchange_strong_explicit(&parent[high], &expected, low, memory_order_relaxed,
                                                    memory_order_relaxed))
            return;
    }
}

/* Trees of vertices joined by triangles; a used vertex that is its own parent stands for one component. */
static hewn_result count_components(const hewn_triangles *mesh, const hewn_stars *stars, uint64_t *components,
                                    hewn_error *error)
{
    uint64_t vertices = mesh->vertex_count, roots = 0;
    _Atomic uint32_t *parent = hewn_alloc(vertices, sizeof *parent);
    if (!parent)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the components of %llu vertices",
                         (unsigned long long)vertices);
#pragma omp parallel if (mesh->triangle_count >= HEWN_CERTIFY_ALONE)
    {
#pragma omp for schedule(static)
        for (uint64_t v = 0; v < vertices; v++)
            atomic_init(&parent[v], (uint32_t)v);
#pragma omp for schedule(static)
        for (uint64_t t = 0; t < mesh->triangle_count; t++) {
            const uint32_t *corner = mesh->indices + 3 * t;
            if (hewn_triangle_collapsed(corner))
                continue;
            join(parent, corner[0], corner[1]);
            join(parent, corner[0], corner[2]);
        }
#pragma omp for schedule(static) reduction(+ : roots)
        for (uint64_t v = 0; v < vertices; v++)
            roots +=
                stars->first[v] < stars->first[v + 1] && atomic_load_explicit(&parent[v], memory_order_relaxed) == v;
    }
    hewn_free((void *)parent);
    *components = roots;
    return HEWN_OK;
}

/* --- the whole ------------------------------------------------------------------------------------------------------
 */

static uint64_t count_collapsed(const hewn_triangles *mesh)
{
    uint64_t collapsed = 0;
#pragma omp parallel for schedule(static) reduction(+ : collapsed) if (mesh->triangle_count >= HEWN_CERTIFY_ALONE)
    for (uint64_t t = 0; t < mesh->triangle_count; t++)
        collapsed += hewn_triangle_collapsed(mesh->indices + 3 * t);
    return collapsed;
}

static hewn_result examine_topology(const hewn_triangles *mesh, const hewn_stars *stars, const hewn_progress *progress,
                                    hewn_certificate *out, hewn_error *error)
{
    HEWN_TRY(count_components(mesh, stars, &out->components, error));
    HEWN_TRY(hewn_progress_report(progress, stage_name, 0.6, error));
    hewn_star_counts counts = {0};
    for (uint64_t begin = 0; begin < mesh->vertex_count; begin += SLICE) {
        uint64_t end = least(begin + SLICE, mesh->vertex_count);
        HEWN_TRY(hewn_stars_examine(mesh, stars, begin, end, &counts, error));
        double fraction = 0.6 + 0.4 * (double)end / (double)mesh->vertex_count;
        HEWN_TRY(hewn_progress_report(progress, stage_name, fraction, error));
    }
    out->boundary_edges = counts.boundary_edges;
    out->non_manifold_edges = counts.non_manifold_edges;
    out->non_manifold_vertices = counts.non_manifold_vertices;
    out->closed = counts.boundary_edges == 0;
    out->manifold = counts.non_manifold_edges == 0 && counts.non_manifold_vertices == 0;
    out->oriented = counts.unoriented_edges == 0;
    out->genus = -1;
    if (out->closed && out->manifold && out->oriented) {
        uint64_t faces = mesh->triangle_count - count_collapsed(mesh);
        int64_t euler = (int64_t)counts.used_vertices - (int64_t)counts.edges + (int64_t)faces;
        out->genus = (int64_t)out->components - euler / 2;
    }
    return HEWN_OK;
}

static hewn_result certify(const hewn_triangles *mesh, const hewn_progress *progress, hewn_certificate *out,
                           hewn_error *error)
{
    HEWN_TRY(check_counts(mesh, error));
    HEWN_TRY(check_positions(mesh, error));
    HEWN_TRY(check_indices(mesh, error));
    find_bounds(mesh, &out->bounds);
    HEWN_TRY(hewn_progress_report(progress, stage_name, 0.1, error));
    HEWN_TRY(measure_mesh(mesh, progress, out, error));
    hewn_stars stars;
    HEWN_TRY(hewn_stars_build(mesh, &stars, error));
    hewn_result result = hewn_progress_report(progress, stage_name, 0.5, error);
    if (result == HEWN_OK)
        result = examine_topology(mesh, &stars, progress, out, error);
    hewn_stars_free(&stars);
    return result;
}

hewn_result hewn_certify(const hewn_triangles *triangles, const hewn_progress *progress, hewn_certificate *out,
                         hewn_error *error)
{
    hewn_certificate certificate = {.max_residual = NAN};
    hewn_result result = certify(triangles, progress, &certificate, error);
    *out = result == HEWN_OK ? certificate : (hewn_certificate){0};
    return result;
}
