/* `hewn render`: what pictures show, that they are the same on every run, and what is refused. Pictures are read back
 * with a PNG reader of the tests' own. */
#include <math.h>

#include "png_read.h"

static char *folder;

static int open_folder(void **state)
{
    (void)state;
    folder = run_folder_create();
    run_write_file(run_path(folder, "ball.lua"), "bounds(-1.5, -1.5, -1.5, 1.5, 1.5, 1.5)\nreturn sphere(1)\n");
    run_write_file(run_path(folder, "disc.lua"), "bounds(-2, -2, -2, 2, 2, 2)\nreturn circle(1.25)\n");
    run_write_file(run_path(folder, "half.lua"), "return half_space(0, 0, 1, 0)\n");
    run_write_file(run_path(folder, "nothing.lua"), "bounds(-1, -1, -1, 1, 1, 1)\nreturn x * x + 1\n");
    return 0;
}

static int close_folder(void **state)
{
    (void)state;
    run_folder_destroy(folder);
    return 0;
}

static void render(int code, const char *input, const char *output, const char *const *more)
{
    run_desc desc = {.folder = folder, .arguments = {"render", input, "-o", output, "--quiet"}};
    for (int i = 0; more && more[i]; i++)
        desc.arguments[5 + i] = more[i];
    run_result result = run_expecting(code, &desc);
    if (code != 0 && output[0])
        assert_false(run_file_exists(run_path(folder, output)));
    run_result_destroy(&result);
}

#define RENDER(input, output, ...) render(0, input, output, (const char *const[]){__VA_ARGS__, NULL})

/* A parallel view from the front, 4 units high: a pixel is 4/200. The silhouette is the ball's disc, depths are its
 * front, normals too; device and host alike. */
static void test_a_ball(void **state)
{
    (void)state;
    static const char *const devices[] = {"host", "0"};
    for (int k = 0; k < 2; k++) {
        RENDER("ball.lua", "depth.png", "--size", "200x200", "--view", "front", "--method", "depth", "--device",
               devices[k]);
        RENDER("ball.lua", "normals.png", "--size", "200x200", "--view", "front", "--method", "normals", "--device",
               devices[k]);
        png depth = read_png(run_path(folder, "depth.png")), normals = read_png(run_path(folder, "normals.png"));
        assert_int_equal(depth.depth, 16);
        assert_int_equal(normals.channels, 3);
        double pixel = 3 / 0.9 / 200, seen = 0; /* the bounds fill nine tenths */
        for (uint32_t y = 0; y < 200; y++)
            for (uint32_t x = 0; x < 200; x++) {
                double u = (x + 0.5 - 100) * pixel, v = (99.5 - y) * pixel, rest = 1 - u * u - v * v;
                unsigned grey = value_of(&depth, x, y, 0);
                seen += grey != 65535;
                if (fabs(rest) < 0.02)
                    continue;
                if ((grey == 65535) != (rest < 0))
                    fail_msg("device %s, pixel %u, %u: %u, %g", devices[k], x, y, grey, rest);
                if (rest < 0)
                    continue;
                double front = depth.lo + (depth.hi - depth.lo) * grey / 65534;
                assert_true(fabs(front - depth.lo - (1 - sqrt(rest))) < 1e-3);
                const double expected[3] = {u, v, sqrt(rest)};
                for (uint32_t axis = 0; axis < 3; axis++) {
                    double normal = value_of(&normals, x, y, axis) / 127.5 - 1;
                    assert_true(fabs(normal - expected[axis]) < 0.02);
                }
            }
        assert_true(fabs(seen * pixel * pixel / 3.14159265 - 1) < 0.005);
        free(depth.rows);
        free(normals.rows);
    }
}

/* The share of a plane that is white is the disc's. */
static void test_a_disc(void **state)
{
    (void)state;
    RENDER("disc.lua", "disc.png", "--2d", "--size", "400x300");
    png picture = read_png(run_path(folder, "disc.png"));
    double white = 0, pixel = 4.0 / 300;
    for (uint32_t y = 0; y < 300; y++)
        for (uint32_t x = 0; x < 400; x++) {
            unsigned value = value_of(&picture, x, y, 0);
            assert_true(value == 0 || value == 255);
            white += value == 255;
        }
    assert_true(fabs(white * pixel * pixel / (3.14159265 * 1.5625) - 1) < 0.005);
    free(picture.rows);
}

/* A lit picture: the side towards the light is brighter, the ground under the ball is in shadow, the corners are not.
 */
static void test_light(void **state)
{
    (void)state;
    RENDER("ball.lua", "lit.png", "--size", "160x120");
    png picture = read_png(run_path(folder, "lit.png"));
    assert_true(value_of(&picture, 70, 45, 1) > value_of(&picture, 95, 80, 1) + 40);
    unsigned least = 255;
    for (uint32_t y = 80; y < 110; y++)
        for (uint32_t x = 90; x < 150; x++) {
            unsigned value = value_of(&picture, x, y, 1);
            least = value < least ? value : least;
        }
    assert_true(least + 40 < value_of(&picture, 2, 2, 1));
    assert_true(value_of(&picture, 2, 117, 1) + 6 > value_of(&picture, 2, 2, 1));
    free(picture.rows);
}

static void test_the_same_bytes(void **state)
{
    (void)state;
    static const char *const devices[] = {"host", "0"};
    for (int k = 0; k < 2; k++) {
        RENDER("ball.lua", "one.png", "--size", "120x90", "--device", devices[k]);
        run_desc desc = {
            .folder = folder,
            .arguments = {"render", "ball.lua", "-o", "two.png", "-q", "--size", "120x90", "--device", devices[k]},
            .changes = {"OMP_NUM_THREADS=1"}};
        run_result result = run_expecting(0, &desc);
        run_result_destroy(&result);
        run_assert_same_file(run_path(folder, "one.png"), run_path(folder, "two.png"));
    }
}

/* A mesh of the same ball shows the same. */
static void test_a_mesh(void **state)
{
    (void)state;
    run_desc mesh = {.folder = folder, .arguments = {"mesh", "ball.lua", "-o", "ball.ply", "--res", "48", "-q"}};
    run_result result = run_expecting(0, &mesh);
    run_result_destroy(&result);
    static const char *const look[] = {"--size", "100x100", "--camera", "6,0,0:0,0,0/25", "--method", "depth", NULL};
    render(0, "ball.ply", "mesh.png", look);
    render(0, "ball.lua", "field.png", look);
    png a = read_png(run_path(folder, "mesh.png")), b = read_png(run_path(folder, "field.png"));
    int apart = 0;
    for (uint32_t y = 0; y < 100; y++)
        for (uint32_t x = 0; x < 100; x++) {
            unsigned p = value_of(&a, x, y, 0), q = value_of(&b, x, y, 0);
            apart += (p == 65535) != (q == 65535);
            if (p == 65535 || q == 65535)
                continue;
            double one = a.lo + (a.hi - a.lo) * p / 65534, other = b.lo + (b.hi - b.lo) * q / 65534;
            assert_true(fabs(one - other) < 0.01 || one > 5.6);
        }
    assert_true(apart < 60);
    free(a.rows);
    free(b.rows);
}

/* --- colours -------------------------------------------------------------------------------------------------------
 */

/* A mesh of a painted scene looks like the scene, whatever the format and the space its colours are in. */
static void test_colours_of_meshes(void **state)
{
    (void)state;
    static const char *const names[] = {"paint.glb", "paint.ply", "paint.obj", "paint.off"};
    static const char *const look[] = {"--size",      "80x60", "--camera", "2,-6,3:0,0,0:0,0,1/25",
                                       "--no-ground", "--up",  "+Z",       NULL};
    run_write_file(run_path(folder, "paint.lua"),
                   "bounds(-1.6, -1.6, -1.6, 1.6, 1.6, 1.6)\n"
                   "return sphere(1):move(-0.5, 0, 0):color(0.9, 0.2, 0.1):smooth_union(\n"
                   "  sphere(0.8):move(0.7, 0, 0):color(0.1, 0.3, 0.9), 0.3)\n");
    render(0, "paint.lua", "scene.png", look);
    png scene = read_png(run_path(folder, "scene.png"));
    for (int i = 0; i < 4; i++) {
        run_desc desc = {.folder = folder, .arguments = {"mesh", "paint.lua", "-o", names[i], "--res", "64", "-q"}};
        run_result result = run_expecting(0, &desc);
        run_result_destroy(&result);
        render(0, names[i], "mesh.png", look);
        png mesh = read_png(run_path(folder, "mesh.png"));
        double sum = 0, red = 0, blue = 0;
        for (uint32_t y = 0; y < 60; y++)
            for (uint32_t x = 0; x < 80; x++) {
                for (uint32_t k = 0; k < 3; k++)
                    sum += fabs((double)value_of(&scene, x, y, k) - value_of(&mesh, x, y, k)) / (3 * 80 * 60);
                int warm = (int)value_of(&mesh, x, y, 0) - (int)value_of(&mesh, x, y, 2);
                red += warm > 80;
                blue += warm < -80;
            }
        if (sum > 2 || red < 300 || blue < 100)
            fail_msg("%s: off by %.2f on average; %g red pixels, %g blue ones", names[i], sum, red, blue);
        free(mesh.rows);
    }
    free(scene.rows);
}

/* Two squares side by side, red on the left and green on the right. */
static void check_squares(const char *file)
{
    RENDER(file, "squares.png", "--size", "60x40", "--view", "front", "--no-ground");
    png picture = read_png(run_path(folder, "squares.png"));
    for (uint32_t x = 20; x < 40; x += 13) {
        unsigned red = value_of(&picture, x, 20, 0), green = value_of(&picture, x, 20, 1);
        unsigned blue = value_of(&picture, x, 20, 2);
        if (x < 30 ? red < 100 || green > 40 || blue > 40 : green < 60 || red > 40 || blue > 40)
            fail_msg("%s: %u %u %u at %u", file, red, green, blue, x);
    }
    free(picture.rows);
}

static void test_colours_of_faces(void **state)
{
    (void)state;
    run_write_file(run_path(folder, "two.off"), "OFF\n6 2 0\n-1 0 -1\n0 0 -1\n0 0 1\n-1 0 1\n1 0 -1\n1 0 1\n"
                                                "4 0 1 2 3 200 0 0\n4 1 4 5 2 0 150 0\n");
    check_squares("two.off");
    static const char data[] =
        "AACAvwAAgL8AAAAAAAAAAAAAgL8AAAAAAAAAAAAAgD8AAAAAAACAvwAAgL8AAAAAAAAAAAAAgD8AAAAAAACAvwAA"
        "gD8AAAAAAAAAAAAAgL8AAAAAAACAPwAAgL8AAAAAAACAPwAAgD8AAAAAAAAAAAAAgL8AAAAAAACAPwAAgD8AAAAA"
        "AAAAAAAAgD8AAAAA";
    char text[3000];
    snprintf(
        text, sizeof text,
        "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":144,\"uri\":\"data:application/octet-stream;"
        "base64,%s\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":144}],\"accessors\":["
        "{\"bufferView\":0,\"componentType\":5126,\"count\":6,\"type\":\"VEC3\",\"min\":[-1,-1,0],\"max\":[0,1,0]},"
        "{\"bufferView\":0,\"byteOffset\":72,\"componentType\":5126,\"count\":6,\"type\":\"VEC3\",\"min\":[0,-1,0],"
        "\"max\":[1,1,0]}],\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorFactor\":[0,0.3,0,1]}},"
        "{\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.6,0,0,1]}}],\"meshes\":[{\"primitives\":["
        "{\"attributes\":{\"POSITION\":0},\"material\":1},{\"attributes\":{\"POSITION\":1},\"material\":0}]}],"
        "\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}],\"scene\":0}",
        data);
    run_write_file(run_path(folder, "two.gltf"), text);
    check_squares("two.gltf");
}

static void test_refusals(void **state)
{
    (void)state;
    static const char *const misuse[][5] = {{"--size", "0x0"},
                                            {"--size", "1000000000x1000000000"},
                                            {"--size", "16385x2"},
                                            {"--size", "100"},
                                            {"--size", "-4x4"},
                                            {"--view", "above"},
                                            {"--method", "toon"},
                                            {"--samples", "0"},
                                            {"--samples", "65"},
                                            {"--camera", "1,2,3"},
                                            {"--camera", "1,2,3:1,2,3"},
                                            {"--camera", "1,2,3:0,0,0/180"},
                                            {"--camera", "1,2,3:0,0,nan"},
                                            {"--view", "iso", "--camera", "1,2,3:0,0,0"},
                                            {"--2d", "--view", "iso"},
                                            {"--2d", "--method", "normals"},
                                            {"--bounds", "0,0,0,1,1,0"},
                                            {"--up", "-Z"}};
    for (size_t i = 0; i < sizeof misuse / sizeof *misuse; i++)
        render(2, "ball.lua", "no.png", misuse[i]);
    render(3, "half.lua", "no.png", NULL);
    render(2, "ball.lua", "", NULL);
    render(1, "ball.lua", "missing/no.png", NULL);
    render(2, "missing.ply", "no.png", (const char *const[]){"--2d", NULL});
    render(3, "missing.ply", "no.png", NULL);
}

/* Nothing to see is a picture of the background. */
static void test_nothing(void **state)
{
    (void)state;
    RENDER("nothing.lua", "nothing.png", "--size", "40x30");
    png picture = read_png(run_path(folder, "nothing.png"));
    for (uint32_t y = 0; y < 30; y++)
        for (uint32_t x = 0; x < 40; x++)
            assert_int_equal(value_of(&picture, x, y, 0), value_of(&picture, 0, 0, 0));
    free(picture.rows);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_ball),
        cmocka_unit_test(test_a_disc),
        cmocka_unit_test(test_light),
        cmocka_unit_test(test_the_same_bytes),
        cmocka_unit_test(test_a_mesh),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_nothing),
        cmocka_unit_test(test_colours_of_meshes),
        cmocka_unit_test(test_colours_of_faces),
    };
    return cmocka_run_group_tests(tests, open_folder, close_folder);
}
