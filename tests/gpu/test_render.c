/* Pictures: depths against dense marching by the oracle, device against host, planes against the unpruned shader. */
#include <math.h>

#include "../unit/test_data.h"
#include "eval/code.h"
#include "gpu_test_device.h"
#include "hewn/render.h"
#include "hewn/scene.h"
#include "random_fields.h"

enum { SIDE = 48, STEPS = 3000 };

static const hewn_box box = {{-1, -1, -1}, {1, 1, 1}};

/* Twisted bars: steep far from the axis, and without a bound on the slope that the renderer knows. */
static hewn_node make_twist(hewn_field *field, uint32_t seed)
{
    hewn_node x = hewn_x(field), y = hewn_y(field), z = hewn_z(field);
    hewn_node turn = scaled(field, z, 6 + seed), c = hewn_cos(field, turn), s = hewn_sin(field, turn);
    hewn_node u = hewn_add(field, hewn_mul(field, x, c), hewn_mul(field, y, s));
    hewn_node v = hewn_sub(field, hewn_mul(field, y, c), hewn_mul(field, x, s));
    return hewn_remap(field, hewn_box_shape(field, 1.3, 0.12, 1.4), u, v, z);
}

/* Jumps: no slope at all where it jumps. */
static hewn_node make_steps(hewn_field *field, uint32_t seed)
{
    hewn_node height = hewn_floor(field, scaled(field, hewn_x(field), 3 + seed));
    hewn_node top = hewn_sub(field, hewn_z(field), scaled(field, height, 0.1));
    return hewn_intersection(field, top, hewn_sphere(field, 0.9));
}

static hewn_node make_shell(hewn_field *field, uint32_t seed)
{
    hewn_node wave = make_waves(field, seed);
    hewn_node ripple = scaled(field, hewn_sin(field, scaled(field, hewn_x(field), 9)), 0.1);
    (void)wave;
    hewn_node thin =
        hewn_sub(field, hewn_abs(field, hewn_add(field, hewn_sphere(field, 0.7), ripple)), hewn_constant(field, 0.004));
    return thin;
}

/* Level to the left, and ever steeper to the right: rays go on by spheres in some parts of the box, by bounds in
 * others.
 */
static hewn_node make_cliff(hewn_field *field, uint32_t seed)
{
    hewn_node rise = hewn_exp(field, scaled(field, hewn_x(field), 11 + seed));
    return hewn_add(field, hewn_sphere(field, 0.8), scaled(field, rise, 0.001));
}

static hewn_node make_rippled_tree(hewn_field *field, uint32_t seed)
{
    hewn_node ripple = scaled(field, hewn_cos(field, scaled(field, hewn_y(field), 9)), 0.05);
    return hewn_add(field, make_tree(field, seed), ripple);
}

static hewn_render_desc depth_desc(hewn_view view)
{
    hewn_render_desc desc = {.width = SIDE, .height = SIDE, .method = HEWN_RENDER_DEPTH, .up = HEWN_AXIS_PLUS_Z};
    desc.camera = hewn_camera_of_view(view, &box, desc.up, SIDE, SIDE);
    return desc;
}

/* Where a pixel's ray is first inside, in steps from the box's near side; NaN: nowhere. A front view, so that rays run
 * along y. */
static double march(const hewn_field *field, double x, double z)
{
    static double points[STEPS][3], values[STEPS];
    for (int i = 0; i < STEPS; i++) {
        points[i][0] = x;
        points[i][1] = box.lo[1] + (box.hi[1] - box.lo[1]) * i / (STEPS - 1);
        points[i][2] = z;
    }
    assert_int_equal(hewn_field_eval(field, hewn_field_root(field), points[0], STEPS, values, NULL), HEWN_OK);
    for (int i = 0; i < STEPS; i++)
        if (values[i] < 0)
            return points[i][1];
    return (double)NAN;
}

/* No pixel may show more than what is there, nor miss what dense marching finds, but at silhouettes. */
static void check_depths(const hewn_field *field, const hewn_picture *picture, const hewn_camera *camera)
{
    unsigned hits = 0;
    double pixel = camera->height / SIDE;
    for (int v = 0; v < SIDE; v++)
        for (int u = 0; u < SIDE; u++) {
            double x = (u + 0.5 - SIDE / 2) * pixel, z = (SIDE / 2 - v - 0.5) * pixel;
            double found = (double)picture->values[v * SIDE + u] + camera->eye[1];
            double expected = fabs(x) < 1 && fabs(z) < 1 ? march(field, x, z) : (double)NAN;
            hits += !isnan(expected);
            if ((isnan(found) && isnan(expected)) || fabs(found - expected) < 0.3 * pixel + 2.0 / STEPS)
                continue;
            /* Where the surface is grazed depths change fast: then it is one that is seen a hair beside. */
            double least = expected, most = expected;
            bool nothing = false;
            for (int k = 0; k < 8; k++) {
                double there = march(field, x + 0.15 * pixel * cos(k * M_PI / 4), z + 0.15 * pixel * sin(k * M_PI / 4));
                least = fmin(least, there);
                most = fmax(most, there);
                nothing = nothing || isnan(there);
            }
            bool between = found > least - 0.1 * pixel && found < most + 0.1 * pixel;
            if (!(isnan(found) ? nothing : between))
                fail_msg("pixel %d, %d: %g instead of %g", u, v, found, expected);
        }
    assert_true(hits > SIDE * SIDE / 20);
}

/* `plain`: so that a CPU device leaves it to the host. */
static void check_field(maker *make, uint32_t seed, bool plain)
{
    hewn_field *field;
    assert_int_equal(hewn_field_create(&field, NULL), HEWN_OK);
    GPU_TEST_TRY(hewn_field_set_root(field, make(field, seed), &error));
    hewn_render_desc desc = depth_desc(HEWN_VIEW_FRONT);
    for (int host = 0; host < 2; host++) {
        hewn_renderer *renderer;
        hewn_picture picture;
        hewn_render_stats stats;
        GPU_TEST_TRY(
            hewn_renderer_of_field(host ? NULL : device, field, hewn_field_root(field), &box, &renderer, &error));
        GPU_TEST_TRY(hewn_render(renderer, &desc, &picture, &stats, &error));
        assert_int_equal(stats.on_host, host || (plain && hewn_device_get_info(device)->kind == HEWN_DEVICE_CPU));
        assert_int_equal(stats.ran_out, 0);
        print_message("# field %u, %s\n", seed, host ? "host" : "device");
        check_depths(field, &picture, &desc.camera);
        hewn_picture_destroy(&picture);
        hewn_renderer_destroy(&renderer);
    }
    hewn_field_destroy(&field);
}

static void test_depths(void **state)
{
    (void)state;
    check_field(make_tree, 1, true);
    check_field(make_rippled_tree, 2, false);
    check_field(make_twist, 0, false);
    check_field(make_steps, 1, false);
    check_field(make_shell, 1, false);
    check_field(make_cliff, 1, false);
}

/* Every pixel of a plane is what the unpruned shader says. */
static void test_plane(void **state)
{
    (void)state;
    enum { WIDTH = 256 };
    char path[8192];
    if (!data_file(path, "implicit/prospero.vm")) {
        print_message("# skipped: no %s\n", path);
        skip();
    }
    hewn_scene *scene;
    GPU_TEST_TRY(hewn_scene_load(&(hewn_scene_desc){.path = path}, &scene, &error));
    const hewn_field *field = hewn_scene_field(scene);
    const hewn_plane_desc desc = {.lo = {-1, -1}, .hi = {1, 1}, .width = WIDTH, .height = WIDTH};
    hewn_picture picture;
    hewn_plane_stats stats;
    GPU_TEST_TRY(hewn_render_plane(field, hewn_field_root(field), &desc, &picture, &stats, &error));
    assert_true(stats.operations_a_pixel + stats.bounds_a_pixel < 0.05 * (double)stats.operations);
    hewn_code *code;
    GPU_TEST_TRY(hewn_code_create(device, field, hewn_field_root(field), &code, &error));
    static float points[WIDTH * WIDTH][3], values[WIDTH * WIDTH];
    for (int i = 0; i < WIDTH * WIDTH; i++) {
        points[i][0] = (float)(-1 + 2 * ((i % WIDTH + 0.5) / WIDTH));
        points[i][1] = (float)(1 + -2 * ((i / WIDTH + 0.5) / WIDTH));
    }
    GPU_TEST_TRY(hewn_code_eval_points(device, code, points[0], (size_t)WIDTH * WIDTH, values, &error));
    for (int i = 0; i < WIDTH * WIDTH; i++)
        assert_int_equal(picture.values[3 * i] > 0.5F, values[i] < 0);
    hewn_code_destroy(device, &code);
    hewn_picture_destroy(&picture);
    hewn_scene_destroy(&scene);
}

/* Lit pictures are the same on every run, and dark where the ball shades the ground. */
static void test_trace(void **state)
{
    (void)state;
    hewn_field *field;
    assert_int_equal(hewn_field_create(&field, NULL), HEWN_OK);
    GPU_TEST_TRY(hewn_field_set_root(field, hewn_sphere(field, 0.7), &error));
    hewn_render_desc desc = {.width = 96, .height = 64, .up = HEWN_AXIS_PLUS_Z};
    desc.camera = hewn_camera_of_view(HEWN_VIEW_ISO, &box, desc.up, desc.width, desc.height);
    hewn_renderer *renderer;
    hewn_picture first, second;
    GPU_TEST_TRY(hewn_renderer_of_field(device, field, hewn_field_root(field), &box, &renderer, &error));
    GPU_TEST_TRY(hewn_render(renderer, &desc, &first, NULL, &error));
    GPU_TEST_TRY(hewn_render(renderer, &desc, &second, NULL, &error));
    assert_memory_equal(first.values, second.values, (size_t)96 * 64 * 3 * sizeof(float));
    float corner = first.values[1], darkest = 1;
    for (size_t i = 0; i < (size_t)96 * 64; i++)
        darkest = fminf(darkest, first.values[3 * i + 1]);
    assert_true(corner > 0.8F && darkest < 0.5F);
    hewn_picture_destroy(&first);
    hewn_picture_destroy(&second);
    desc.camera.fov = 200;
    hewn_error error = {0};
    assert_int_equal(hewn_render(renderer, &desc, &first, NULL, &error), HEWN_INVALID_ARGUMENT);
    assert_null(first.values);
    hewn_renderer_destroy(&renderer);
    hewn_field_destroy(&field);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_depths), cmocka_unit_test(test_plane),
                                       cmocka_unit_test(test_trace)};
    return cmocka_run_group_tests_name("render", tests, open_device, close_device);
}
