/* The host's twin of the stages between signs and vertices: the same mesh as the device's kernels make, byte for byte,
 * for fields of which most cells are cut in odd ways, grids that end anywhere in a brick, and any number of threads. */
#include <omp.h>

#include "host_subject.h"

static hewn_triangles extract(const subject *made, bool on_host, const hewn_extract_desc *desc)
{
    return extract_with(made, on_host, desc, NULL);
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

static void compare(const subject *made, const hewn_extract_desc *desc)
{
    hewn_extract_stats with_host, without;
    hewn_triangles host = extract_with(made, true, desc, &with_host);
    hewn_triangles device = extract_with(made, false, desc, &without);
    assert_same(&host, &device);
    assert_int_equal(with_host.suspect_cells, without.suspect_cells);
    assert_int_equal(with_host.undefined_cells, without.undefined_cells);
    assert_memory_equal(&with_host.first_suspect, &without.first_suspect, sizeof without.first_suspect);
    hewn_triangles_destroy(&host);
    hewn_triangles_destroy(&device);
}

/* Boxes of the given numbers of unit cells. */
static hewn_extract_desc grid_of(double x, double y, double z, bool open, hewn_method method)
{
    return (hewn_extract_desc){.bounds = {{0, 0, 0}, {x, y, z}}, .cell = 1, .open = open, .method = method};
}

static void test_same_as_device(void **state)
{
    (void)state;
    unsigned messages;
    hewn_device *device = gpu_test_open(&messages);
    static const double grids[][3] = {{8, 8, 8}, {5, 4, 3}, {7, 9, 16}, {17, 15, 8}, {25, 4, 40}, {33, 31, 30}};
    maker *const makers[] = {make_waves, make_integers};
    for (uint32_t seed = 0; seed < 4; seed++) {
        subject made = make_subject(device, makers[seed % 2], seed, HEWN_EVALUATION_AUTO);
        for (size_t i = 0; i < sizeof grids / sizeof *grids; i++)
            for (int variant = 0; variant < 4; variant++) {
                hewn_method method = variant & 2 ? HEWN_METHOD_MC33 : HEWN_METHOD_MARCHING_CUBES;
                hewn_extract_desc desc = grid_of(grids[i][0], grids[i][1], grids[i][2], variant & 1, method);
                compare(&made, &desc);
            }
        free_subject(&made);
    }
    gpu_test_close(&device, &messages);
}

/* Bricks that are culled stand beside those that are not, and lists take records of vertices their own way. */
static void test_sparse_bricks(void **state)
{
    (void)state;
    unsigned messages;
    hewn_device *device = gpu_test_open(&messages);
    for (uint32_t seed = 0; seed < 4; seed++) {
        hewn_evaluation evaluation = seed & 1 ? HEWN_EVALUATION_LISTED : HEWN_EVALUATION_STRAIGHT;
        subject made = make_subject(device, make_tree, seed, evaluation);
        for (int open = 0; open < 2; open++) {
            hewn_extract_desc desc = {.bounds = {{-0.9, -0.8, -1}, {1, 1, 0.7}},
                                      .resolution = 61,
                                      .open = open,
                                      .method = HEWN_METHOD_MARCHING_CUBES};
            compare(&made, &desc);
        }
        free_subject(&made);
    }
    gpu_test_close(&device, &messages);
}

/* Enough bricks that threads share them. */
static void test_any_number_of_threads(void **state)
{
    (void)state;
    unsigned messages;
    hewn_device *device = gpu_test_open(&messages);
    subject made = make_subject(device, make_waves, 7, HEWN_EVALUATION_AUTO);
    for (int i = 0; i < 2; i++) {
        hewn_extract_desc desc = grid_of(72, 66, 70, false, i ? HEWN_METHOD_MC33 : HEWN_METHOD_MARCHING_CUBES);
        int before = omp_get_max_threads();
        omp_set_num_threads(1);
        hewn_triangles one = extract(&made, true, &desc);
        omp_set_num_threads(5);
        hewn_triangles five = extract(&made, true, &desc);
        omp_set_num_threads(before);
        assert_same(&one, &five);
        hewn_triangles_destroy(&one);
        hewn_triangles_destroy(&five);
    }
    free_subject(&made);
    gpu_test_close(&device, &messages);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_as_device),
        cmocka_unit_test(test_sparse_bricks),
        cmocka_unit_test(test_any_number_of_threads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
