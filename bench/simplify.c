/* Simplification of mesh files, or of a noisy torus: Hewn beside meshoptimizer, VTK and CGAL, in turn and in one
 * process. Times are those of the call, without making the library's own mesh (CGAL's, VTK's). Distances are in
 * diagonals of the input's box: the mean is that of points spread evenly over both surfaces, the maximum is proven.
 * Faces are flipped whose normal points away from that of the input's nearest triangle. usage: simplify [--runs N]
 * [--ratio R] [--triangles N | FILE...] [--only NAME] [--quick] */
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#include "hewn/check.h"
#include "hewn/distance.h"
#include "hewn/io.h"
#include "hewn/simplify.h"
#include "samples.h"
#include "simplify_peers.h"
#include "torus.h"

#include "base/alloc.h"
#include "base/clock.h"
#include "geom/nearest.h"

static void give_up(const hewn_error *error)
{
    fprintf(stderr, "bench: %s\n", error->message);
    exit(1);
}

static simplified hewn(const peer_input *input, uint64_t target)
{
    const hewn_polygons polygons = {input->vertex_count, input->positions, input->triangle_count, NULL, input->indices};
    hewn_simplified made;
    hewn_error error;
    const double begin = hewn_clock_now();
    const double processor = bench_processor_now();
    if (hewn_polygons_simplify(&polygons, &(hewn_simplify_desc){.faces = target}, &made, NULL, &error) != HEWN_OK)
        give_up(&error);
    const double seconds = hewn_clock_now() - begin, all = bench_processor_now() - processor;
    hewn_free(made.vertex_origins);
    hewn_free(made.face_origins);
    return (simplified){made.vertex_count, made.face_count, made.positions, made.corners, seconds, all};
}

/* --- quality ------------------------------------------------------------------------------------------------------ */

typedef struct quality {
    double mean, most;
    uint64_t flipped, non_manifold;
} quality;

static hewn_triangle_view view_of(uint64_t verts, uint64_t faces, const double *positions, const uint32_t *indices)
{
    return (hewn_triangle_view){verts, faces, positions, NULL, indices};
}

static void area_vector(const hewn_triangle_view *mesh, uint64_t t, double out[3], double middle[3])
{
    double a[3], b[3], c[3], u[3], v[3];
    hewn_triangle_point(mesh, mesh->corners[3 * t], a);
    hewn_triangle_point(mesh, mesh->corners[3 * t + 1], b);
    hewn_triangle_point(mesh, mesh->corners[3 * t + 2], c);
    for (int axis = 0; axis < 3; axis++) {
        u[axis] = b[axis] - a[axis];
        v[axis] = c[axis] - a[axis];
        middle[axis] = (a[axis] + b[axis] + c[axis]) / 3;
    }
    out[0] = (u[1] * v[2] - u[2] * v[1]) / 2;
    out[1] = (u[2] * v[0] - u[0] * v[2]) / 2;
    out[2] = (u[0] * v[1] - u[1] * v[0]) / 2;
}

/* The mean distance of about 200,000 points, spread by area in a fixed pattern. */
static double mean_of(const hewn_triangle_view *from, const hewn_triangle_view *to, const hewn_bvh *bvh)
{
    double whole = 0, sum = 0, n[3], middle[3], carried = 0;
    uint64_t points = 0;
    uint32_t guess = 0;
    for (uint64_t t = 0; t < from->triangle_count; t++) {
        area_vector(from, t, n, middle);
        whole += sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    }
    for (uint64_t t = 0; t < from->triangle_count; t++) {
        area_vector(from, t, n, middle);
        carried += 200000 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) / whole;
        for (; carried >= 1; carried -= 1, points++) {
            double s = fmod((double)points * 0.7548776662466927, 1), r = fmod((double)points * 0.5698402909980532, 1);
            double at[3], p[3][3], distance;
            if (s + r > 1) {
                s = 1 - s;
                r = 1 - r;
            }
            for (uint64_t k = 0; k < 3; k++)
                hewn_triangle_point(from, from->corners[3 * t + k], p[k]);
            for (int axis = 0; axis < 3; axis++)
                at[axis] = p[0][axis] + s * (p[1][axis] - p[0][axis]) + r * (p[2][axis] - p[0][axis]);
            guess = hewn_bvh_nearest(bvh, to, at, guess, &distance);
            sum += distance;
        }
    }
    return sum / (double)points;
}

static uint64_t count_flipped(const hewn_triangle_view *out, const hewn_triangle_view *in, const hewn_bvh *bvh)
{
    uint64_t flipped = 0;
    for (uint64_t t = 0; t < out->triangle_count; t++) {
        double n[3], m[3], middle[3], other[3], distance;
        area_vector(out, t, n, middle);
        area_vector(in, hewn_bvh_nearest(bvh, in, middle, 0, &distance), m, other);
        flipped += n[0] * m[0] + n[1] * m[1] + n[2] * m[2] < 0;
    }
    return flipped;
}

static quality judge(const peer_input *input, const simplified *made, bool quick)
{
    quality out = {0};
    hewn_error error;
    hewn_bvh before, after;
    hewn_distance distance;
    hewn_check *check;
    const hewn_polygons one = {input->vertex_count, input->positions, input->triangle_count, NULL, input->indices};
    const hewn_polygons two = {made->vertex_count, made->positions, made->triangle_count, NULL, made->indices};
    const hewn_triangle_view in = view_of(one.vertex_count, one.face_count, one.positions, one.corners);
    const hewn_triangle_view of = view_of(two.vertex_count, two.face_count, two.positions, two.corners);
    if (hewn_check_polygons(&two, &(hewn_check_desc){.skip_self_intersections = true}, &check, &error) != HEWN_OK)
        give_up(&error);
    out.non_manifold = check->certificate.non_manifold_edges;
    hewn_check_destroy(&check);
    if (quick)
        return out;
    if (hewn_bvh_build(&in, &before, &error) != HEWN_OK || hewn_bvh_build(&of, &after, &error) != HEWN_OK ||
        hewn_polygons_distance(&one, &two, NULL, &distance, &error) != HEWN_OK)
        give_up(&error);
    float lo[3], hi[3];
    hewn_boxes4_all(&before.level[before.level_count - 1][0], lo, hi);
    double diagonal = sqrt(pow((double)hi[0] - (double)lo[0], 2) + pow((double)hi[1] - (double)lo[1], 2) +
                           pow((double)hi[2] - (double)lo[2], 2));
    out.mean = fmax(mean_of(&in, &of, &after), mean_of(&of, &in, &before)) / diagonal;
    out.most = distance.high / diagonal;
    out.flipped = count_flipped(&of, &in, &before);
    hewn_bvh_free(&before);
    hewn_bvh_free(&after);
    return out;
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

static const struct {
    const char *name;
    simplified (*run)(const peer_input *input, uint64_t target);
} all[] = {{"hewn", hewn},
           {"meshoptimizer", meshoptimizer},
           {"vtk", vtk_quadric},
           {"cgal gh", cgal_garland_heckbert},
           {"cgal lt", cgal_lindstrom_turk}};
enum { ALL = sizeof all / sizeof *all };

typedef struct bench_request {
    int runs;
    double ratio;
    const char *only;
    bool quick;
} bench_request;

static void run(const char *name, const peer_input *input, const bench_request *request)
{
    static double seconds[ALL][MOST_RUNS], processor[ALL][MOST_RUNS];
    quality found[ALL];
    uint64_t left[ALL], target = (uint64_t)(request->ratio * (double)input->triangle_count);
    for (int at = 0; at < request->runs; at++)
        for (int i = 0; i < ALL; i++) {
            if (request->only && strcmp(request->only, all[i].name) != 0)
                continue;
            simplified made = all[i].run(input, target);
            seconds[i][at] = made.seconds;
            processor[i][at] = made.processor_seconds;
            left[i] = made.triangle_count;
            if (at == 0)
                found[i] = judge(input, &made, request->quick);
            free(made.positions);
            free(made.indices);
        }
    printf("%s: %llu triangles to %llu, %d threads, medians of %d\n", name, (unsigned long long)input->triangle_count,
           (unsigned long long)target, omp_get_max_threads(), request->runs);
    for (int i = 0; i < ALL; i++)
        if (!request->only || strcmp(request->only, all[i].name) == 0)
            printf("  %-14s %7.3f s %7.3f of processors %8llu left, mean %.3e most %.3e, %llu flipped, %llu "
                   "non-manifold edges\n",
                   all[i].name, bench_median(seconds[i], request->runs), bench_median(processor[i], request->runs),
                   (unsigned long long)left[i], found[i].mean, found[i].most, (unsigned long long)found[i].flipped,
                   (unsigned long long)found[i].non_manifold);
    fflush(stdout);
}

static void run_file(const char *path, const bench_request *request)
{
    hewn_model model;
    hewn_error error;
    if (hewn_model_read(path, NULL, &model, &error) != HEWN_OK)
        give_up(&error);
    const peer_input input = {model.vertex_count, model.face_count, model.positions, model.corners};
    if (model.first)
        fprintf(stderr, "bench: %s has polygons, which are left out\n", path);
    else
        run(path, &input, request);
    hewn_model_destroy(&model);
}

/* A hundredth of an edge of noise. */
static void run_torus(uint64_t triangles, const bench_request *request)
{
    peer_input input = bench_torus(triangles < 18 ? 18 : triangles);
    double *positions = (double *)input.positions, edge = 2 * M_PI / sqrt((double)input.vertex_count);
    srand48(1);
    for (uint64_t i = 0; i < 3 * input.vertex_count; i++)
        positions[i] += 0.01 * edge * (drand48() - 0.5);
    run("torus", &input, request);
}

int main(int argc, char **argv)
{
    bench_request request = {.runs = 3, .ratio = 0.1};
    uint64_t triangles = 1000000;
    int files = 0;
    for (int at = 1; at < argc; at++) {
        const char *value = at + 1 < argc ? argv[at + 1] : "";
        if (strcmp(argv[at], "--quick") == 0)
            request.quick = true;
        else if (strncmp(argv[at], "--", 2) != 0 && ++files)
            run_file(argv[at], &request);
        else if (strcmp(argv[at], "--runs") == 0 && ++at)
            request.runs = atoi(value) < 1 ? 1 : atoi(value) > MOST_RUNS ? MOST_RUNS : atoi(value);
        else if (strcmp(argv[at], "--ratio") == 0 && ++at)
            request.ratio = atof(value);
        else if (strcmp(argv[at], "--triangles") == 0 && ++at)
            triangles = strtoull(value, NULL, 10);
        else if (strcmp(argv[at], "--only") == 0 && ++at)
            request.only = value;
    }
    if (files == 0)
        run_torus(triangles, &request);
    struct rusage usage;
    if (request.only && getrusage(RUSAGE_SELF, &usage) == 0)
        printf("peak of the process %.1f MiB\n", (double)usage.ru_maxrss / 1024);
    return 0;
}
