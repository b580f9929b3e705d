/* The dual methods by the host beside the device's kernels: the same counts, vertices and quads; places and normals but
 * for how either rounds; and the same bytes for any number of threads. */
#include "gpu_test_device.h"

#include <omp.h>

#include "host_subject.h"

/* Corners of quad i in their order, the least number first: two triangles (a, b, c), (a, c, d). */
static void corners_of(const hewn_triangles *mesh, uint64_t i, uint32_t out[4])
{
    const uint32_t *six = mesh->indices + 6 * i, around[4] = {six[0], six[1], six[2], six[5]};
    uint32_t least = 0;
    for (uint32_t k = 1; k < 4; k++)
        least = around[k] < around[least] ? k : least;
    for (uint32_t k = 0; k < 4; k++)
        out[k] = around[(least + k) % 4];
}

/* How a vertex of one mesh is away from that of the other, in cells. */
static double apart(const float *a, const float *b, double cell)
{
    double sum = 0;
    for (int k = 0; k < 3; k++)
        sum += ((double)a[k] - (double)b[k]) * ((double)a[k] - (double)b[k]);
    return sqrt(sum) / cell;
}

typedef struct tally {
    uint64_t vertices, moved, turned, bent; /* of how many, what is not the same but for rounding */
    uint64_t features[2], found[2];         /* vertices on edges and at corners, planes: by host, by device */
} tally;

/* With quads kept, all but the diagonals are the same. */
static void compare(const subject *made, hewn_extract_desc desc, tally *sums)
{
    hewn_extract_stats with_host, without;
    desc.quads = true;
    hewn_triangles host = extract_with(made, true, &desc, &with_host),
                   other = extract_with(made, false, &desc, &without);
    assert_int_equal(host.vertex_count, other.vertex_count);
    assert_int_equal(host.triangle_count, other.triangle_count);
    assert_true(host.triangle_count > 0);
    assert_int_equal(with_host.cap_vertices, without.cap_vertices);
    assert_int_equal(with_host.left_bounds, without.left_bounds);
    assert_int_equal(with_host.suspect_cells, without.suspect_cells);
    for (uint64_t i = 0; i < host.triangle_count / 2; i++) {
        uint32_t mine[4], theirs[4];
        corners_of(&host, i, mine);
        corners_of(&other, i, theirs);
        assert_memory_equal(mine, theirs, sizeof mine);
        sums->turned += memcmp(host.indices + 6 * i, other.indices + 6 * i, 24) != 0;
    }
    for (uint64_t i = 0; i < host.vertex_count; i++) {
        double off = apart(host.positions + 3 * i, other.positions + 3 * i, with_host.cell);
        bool same = off < 1e-4;
        assert_true(off < 3); /* neither leaves its cell and the one beside it */
        sums->moved += !same;
        sums->bent += same && apart(host.normals + 3 * i, other.normals + 3 * i, 1) > 1e-3;
    }
    sums->vertices += host.vertex_count;
    sums->features[0] += with_host.edge_vertices + with_host.corner_vertices;
    sums->features[1] += without.edge_vertices + without.corner_vertices;
    sums->found[0] += with_host.planes_found;
    sums->found[1] += without.planes_found;
    hewn_triangles_destroy(&host);
    hewn_triangles_destroy(&other);
}

static void check(const tally *sums)
{
    print_message("# %llu vertices: %llu elsewhere, %llu with another normal, %llu quads cut the other way\n",
                  (unsigned long long)sums->vertices, (unsigned long long)sums->moved, (unsigned long long)sums->bent,
                  (unsigned long long)sums->turned);
    print_message("# features %llu and %llu, planes found %llu and %llu\n", (unsigned long long)sums->features[0],
                  (unsigned long long)sums->features[1], (unsigned long long)sums->found[0],
                  (unsigned long long)sums->found[1]);
    for (int i = 0; i < 2; i++) {
        const uint64_t *pair = i ? sums->found : sums->features;
        uint64_t less = pair[0] < pair[1] ? pair[0] : pair[1], more = pair[0] + pair[1] - less;
        assert_true(more - less <= (i ? 2 + more / 10 : 2 + more / 500));
    }
    assert_true(2000 * (sums->moved + sums->bent) <= sums->vertices);
    assert_true(50 * sums->turned <= sums->vertices); /* where a quad is flat both diagonals are as good */
}

/* Boxes of the given numbers of unit cells. */
static hewn_extract_desc grid_of(const double cells[3], bool open, hewn_method method)
{
    return (hewn_extract_desc){
        .bounds = {{0, 0, 0}, {cells[0], cells[1], cells[2]}}, .cell = 1, .open = open, .method = method};
}

/* Most cells are cut in odd ways, and grids end anywhere in a brick. */
static void test_same_as_device(void **state)
{
    (void)state;
    static const double grids[][3] = {{8, 8, 8}, {5, 4, 3}, {17, 15, 8}, {33, 31, 30}};
    maker *const makers[] = {make_waves, make_integers};
    for (uint32_t seed = 0; seed < 2; seed++) {
        tally sums = {0};
        subject made = make_subject(device, makers[seed], seed, HEWN_EVALUATION_AUTO);
        for (size_t i = 0; i < sizeof grids / sizeof *grids; i++)
            for (int variant = 0; variant < 4; variant++)
                compare(&made, grid_of(grids[i], variant & 1, variant & 2 ? HEWN_METHOD_DC : HEWN_METHOD_NETS), &sums);
        check(&sums);
        free_subject(&made);
    }
}

/* Sharp edges and corners, straight and by lists, in bricks of which most neighbours are culled. */
static void test_features(void **state)
{
    (void)state;
    tally sums = {0};
    for (uint32_t seed = 0; seed < 3; seed++) {
        hewn_evaluation evaluation = seed & 1 ? HEWN_EVALUATION_LISTED : HEWN_EVALUATION_STRAIGHT;
        subject made = make_subject(device, make_tree, seed, evaluation);
        for (int open = 0; open < 2; open++)
            compare(&made,
                    (hewn_extract_desc){.bounds = {{-0.9, -0.8, -1}, {1, 1, 0.7}},
                                        .resolution = 61,
                                        .open = open,
                                        .method = HEWN_METHOD_DC},
                    &sums);
        free_subject(&made);
    }
    assert_true(sums.features[0] > 1000 && sums.found[0] > 10);
    check(&sums);
}

static void assert_same(const hewn_triangles *a, const hewn_triangles *b)
{
    assert_true(a->triangle_count > 0);
    assert_int_equal(a->vertex_count, b->vertex_count);
    assert_int_equal(a->triangle_count, b->triangle_count);
    assert_memory_equal(a->positions, b->positions, 12 * a->vertex_count);
    assert_memory_equal(a->normals, b->normals, 12 * a->vertex_count);
    assert_memory_equal(a->indices, b->indices, 12 * a->triangle_count);
}

/* Enough bricks and vertices that threads share them, in several blocks, with fans. */
static void test_any_number_of_threads(void **state)
{
    (void)state;
    static const double cells[3] = {72, 66, 70};
    subject made = make_subject(device, make_waves, 7, HEWN_EVALUATION_AUTO);
    int before = omp_get_max_threads();
    for (hewn_method method = HEWN_METHOD_NETS; method <= HEWN_METHOD_DC; method++) {
        hewn_extract_stats stats[2];
        hewn_triangles meshes[2];
        hewn_extract_desc desc = grid_of(cells, false, method);
        for (int i = 0; i < 2; i++) {
            omp_set_num_threads(i ? 5 : 1);
            meshes[i] = extract_with(&made, true, &desc, &stats[i]);
        }
        omp_set_num_threads(before);
        assert_same(&meshes[0], &meshes[1]);
        assert_true(stats[0].fans > 0 && meshes[0].vertex_count > 40000);
        assert_int_equal(stats[0].edge_vertices, stats[1].edge_vertices);
        assert_int_equal(stats[0].planes_found, stats[1].planes_found);
        assert_int_equal(stats[0].features_lost, stats[1].features_lost);
        assert_true(stats[0].max_residual == stats[1].max_residual);
        hewn_triangles_destroy(&meshes[0]);
        hewn_triangles_destroy(&meshes[1]);
    }
    free_subject(&made);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_as_device),
        cmocka_unit_test(test_features),
        cmocka_unit_test(test_any_number_of_threads),
    };
    return cmocka_run_group_tests_name("host_dual", tests, open_device, close_device);
}
