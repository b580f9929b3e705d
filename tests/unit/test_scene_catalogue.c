/* The functions of the catalogue from Lua: the same field as from C, and messages that name the argument. */
#include "test_scene.h"

#include "field/catalogue.h"

#define DEGREE (3.14159265358979323846 / 180)

static const double corners[8] = {0, 0, 1, 0.1, 0.8, 1, -0.2, 0.7};
static const double path[12] = {-1, 0, 0, 0, 0.5, 0.2, 1, 0, 0.3, 1, 1, 1};
static const hewn_curve curves[3] = {{1, {{1, 0}}}, {2, {{1.2, 0.8}, {0.5, 1}}}, {3, {{0, 1.2}, {-0.5, 0.5}, {0, 0}}}};

/* Every function that the catalogue reads, each once. */
static void the_same_as_from_c(void **state)
{
    (void)state;
    hewn_field *f = NULL;
    size_t called = 0, read = 0;
    assert_int_equal(hewn_field_create(&f, NULL), HEWN_OK);
    hewn_node a = hewn_sphere(f, 1), b = hewn_translate(f, hewn_box_shape(f, 1, 1, 1), 0.7, 0, 0);
    hewn_node flat = hewn_translate(f, hewn_circle(f, 0.5), 0.8, 0, 0), other = hewn_rectangle(f, 1, 2);
    const hewn_octaves octaves = {HEWN_NOISE_GRADIENT, 0.7, 3, 0.5, 2, 0};
    const hewn_octaves all = {HEWN_NOISE_SIMPLEX, 0.7, 3, 0.6, 1.9, 5};
#define SAME(text, node)                                                                                               \
    called++;                                                                                                          \
    test_same("local a, b = sphere(1), box(1):move(0.7, 0, 0)\n"                                                       \
              "local flat, other = circle(0.5):move(0.8, 0, 0), rectangle(1, 2)\n"                                     \
              "return " text,                                                                                          \
              f, node)
    SAME("sphere(0.8)", hewn_sphere(f, 0.8));
    SAME("torus(0.8, 0.2)", hewn_torus(f, 0.8, 0.2));
    SAME("cylinder(0.8, 1.2)", hewn_cylinder(f, 0.8, 1.2));
    SAME("capsule(0.8, 0)", hewn_capsule(f, 0.8, 0));
    SAME("box_frame(1, 1.2, 1.4, 0.1)", hewn_box_frame(f, 1, 1.2, 1.4, 0.1));
    SAME("ellipsoid(0.5, 0.8, 1.1)", hewn_ellipsoid(f, 0.5, 0.8, 1.1));
    SAME("round_cone(0.5, 0.2, 1.1)", hewn_round_cone(f, 0.5, 0.2, 1.1));
    SAME("link(0.4, 0.5, 0.1)", hewn_link(f, 0.4, 0.5, 0.1));
    SAME("prism(5, 0.6, 1)", hewn_prism(f, 5, 0.6, 1));
    SAME("pyramid(1.3, 0.9)", hewn_pyramid(f, 1.3, 0.9));
    SAME("tetrahedron(1.1)", hewn_tetrahedron(f, 1.1));
    SAME("octahedron(1.1)", hewn_octahedron(f, 1.1));
    SAME("dodecahedron(1.1)", hewn_dodecahedron(f, 1.1));
    SAME("icosahedron(1.1)", hewn_icosahedron(f, 1.1));
    SAME("tube({{-1, 0, 0}, {0, 0.5, 0.2}, {1, 0, 0.3}, {1, 1, 1}}, 0.2)", hewn_tube(f, path, 4, 0.2));
    SAME("bezier_tube({{-1, 0, 0}, {0, 0.5, 0.2}, {1, 0, 0.3}, {1, 1, 1}}, 0.2)", hewn_bezier_tube(f, path, 4, 0.2));
    SAME("helix(0.8, 0.5, 2, 0.1)", hewn_helix(f, 0.8, 0.5, 2, 0.1));
    SAME("circle(0.9)", hewn_circle(f, 0.9));
    SAME("rectangle(0.9, 1.3)", hewn_rectangle(f, 0.9, 1.3));
    SAME("ellipse(0.9, 1.3)", hewn_ellipse(f, 0.9, 1.3));
    SAME("polygon{{0, 0}, {1, 0.1}, {0.8, 1}, {-0.2, 0.7}}", hewn_polygon(f, corners, 4));
    SAME("regular_polygon(7, 1.3)", hewn_regular_polygon(f, 7, 1.3));
    SAME("star(7, 1.3, 0.6)", hewn_star(f, 7, 1.3, 0.6));
    SAME("outline{{1, 0}, {1.2, 0.8, 0.5, 1}, {0, 1.2, -0.5, 0.5, 0, 0}}", hewn_outline(f, curves, 3));
    SAME("flat:extrude(0.7)", hewn_extrude(f, flat, 0.7));
    SAME("flat:revolve()", hewn_revolve(f, flat));
    SAME("loft(flat, other, 0.7)", hewn_loft(f, flat, other, 0.7));
    SAME("label(a, 7)", hewn_label(f, a, 7));
    SAME("gyroid(0.9, 0.1)", hewn_gyroid(f, 0.9, 0.1));
    SAME("schwarz_p(0.9)", hewn_schwarz_p(f, 0.9, 0));
    SAME("schwarz_d(0.9, 0.1)", hewn_schwarz_d(f, 0.9, 0.1));
    SAME("neovius(0.9, 0.1)", hewn_neovius(f, 0.9, 0.1));
    SAME("lidinoid(0.9, 0.1)", hewn_lidinoid(f, 0.9, 0.1));
    SAME("iwp(0.9, 0.1)", hewn_iwp(f, 0.9, 0.1));
    SAME("frd(0.9, 0.1)", hewn_frd(f, 0.9, 0.1));
    SAME("fischer_koch_s(0.9, 0.1)", hewn_fischer_koch_s(f, 0.9, 0.1));
    SAME("noise(0.7, 3, 'cellular')", hewn_noise(f, HEWN_NOISE_CELLULAR, 0.7, 3));
    SAME("fbm(0.7, 3)", hewn_fbm(f, &octaves));
    SAME("ridged(0.7, 3, 5, 'simplex', 0.6, 1.9)", hewn_ridged(f, &all));
    SAME("billow(0.7, 3, 5, 'simplex', 0.6, 1.9)", hewn_billow(f, &all));
    SAME("a:xor(b)", hewn_xor(f, a, b));
    SAME("chamfer_union(a, b, 0.1)", hewn_chamfer_union(f, a, b, 0.1));
    SAME("chamfer_intersection(a, b, 0.1)", hewn_chamfer_intersection(f, a, b, 0.1));
    SAME("chamfer_difference(a, b, 0.1)", hewn_chamfer_difference(f, a, b, 0.1));
    SAME("round_union(a, b, 0.1)", hewn_round_union(f, a, b, 0.1));
    SAME("round_intersection(a, b, 0.1)", hewn_round_intersection(f, a, b, 0.1));
    SAME("round_difference(a, b, 0.1)", hewn_round_difference(f, a, b, 0.1));
    SAME("stairs_union(a, b, 0.1, 3)", hewn_stairs_union(f, a, b, 0.1, 3));
    SAME("stairs_intersection(a, b, 0.1, 3)", hewn_stairs_intersection(f, a, b, 0.1, 3));
    SAME("stairs_difference(a, b, 0.1, 3)", hewn_stairs_difference(f, a, b, 0.1, 3));
    SAME("a:shell(0.1)", hewn_shell(f, a, 0.1));
    SAME("b:offset(-0.1)", hewn_offset(f, b, -0.1));
    SAME("a:displace(0.1 * x)", hewn_displace(f, a, hewn_mul(f, hewn_constant(f, 0.1), hewn_x(f))));
    SAME("a:morph(b, 0.3)", hewn_morph(f, a, b, hewn_constant(f, 0.3)));
    SAME("b:mirror('x')", hewn_mirror(f, b, 0));
    SAME("b:symmetric('z')", hewn_symmetric(f, b, 2));
    SAME("b:array(2, 3, 1, 0.6, 0.7, 0)", hewn_array(f, b, 2, 3, 1, 0.6, 0.7, 0));
    SAME("b:radial(5)", hewn_radial(f, b, 5, 1));
    SAME("b:tile(2, 0, 3)", hewn_tile(f, b, 2, 0, 3));
    SAME("b:mirror_tile(2, 0, 3)", hewn_mirror_tile(f, b, 2, 0, 3));
    SAME("b:twist(50)", hewn_twist(f, b, 50 * DEGREE));
    SAME("b:bend(50)", hewn_bend(f, b, 50 * DEGREE));
    SAME("b:taper(1, 0.5, 0.8)", hewn_taper(f, b, 1, 0.5, 0.8));
    SAME("b:elongate(0.2, 0, 0.3)", hewn_elongate(f, b, 0.2, 0, 0.3));
    SAME("b:warp(0.2, 0.4, 9)", hewn_warp(f, b, 0.2, 0.4, 9));
#undef SAME
    for (size_t i = 0; i < hewn_function_count; i++)
        read += !hewn_functions[i].call;
    assert_int_equal(called, read);
    test_same("return half_space(1, 2, 3, 0.5)", f, hewn_half_space(f, 1, 2, 3, 0.5));
    test_same("return radial(sphere(0.3):move(0, 1, 0), 5, 'z')", f,
              hewn_radial(f, hewn_translate(f, hewn_sphere(f, 0.3), 0, 1, 0), 5, 2));
    assert_int_equal(hewn_field_status(f, NULL), HEWN_OK);
    hewn_field_destroy(&f);
}

static void messages_name_the_argument(void **state)
{
    (void)state;
    static const struct {
        const char *text, *part;
    } cases[] = {
        {"box_frame(1, 1, 1)", "box_frame takes 4 arguments, not 3"},
        {"box_frame(1, 1, 0, 1)", "box_frame: argument 3 must be a positive number, not 0"},
        {"box_frame(1, 1, 1, 0.5)", "box_frame: its edge, 0.5, must be below half of the least size"},
        {"prism(2.5, 1, 1)", "prism: argument 1 must be a whole number from 3 to 1024, not 2.5"},
        {"prism(2, 1, 1)", "prism: argument 1 must be a whole number from 3 to 1024, not 2"},
        {"link(-1, 1, 1)", "link: argument 1 must be a number of at least 0, not -1"},
        {"polygon(3)", "polygon: argument 1 must be a list of points {x, y}, not 3"},
        {"polygon{{0, 0}, {1, 0}}", "polygon: it needs three points or more, not 2"},
        {"polygon{{0, 0}, {1, 0}, 5}", "polygon: item 3 of the list must be a list of numbers, not a number"},
        {"polygon{{0, 0}, {1, 0}, {1}}", "polygon: item 3 of the list must have 2 numbers"},
        {"polygon{{0, 0}, {1, 0}, {1, 2, 3}}", "polygon: item 3 of the list has more than 2 numbers"},
        {"polygon{{0, 0}, {1, 'a'}, {1, 2}}", "polygon: item 2 of the list: number 2 must be a finite number"},
        {"polygon{{0, 0}, {1, 0/0}, {1, 2}}", "polygon: item 2 of the list: number 2 must be a finite number"},
        {"outline{{0, 0}, {1, 0, 2}, {1, 2}}", "outline: item 2 of the list must have 2, 4 or 6 numbers"},
        {"tube({{0, 0, 0}}, 1)", "tube: it has 2 to 65536 points, not 1"},
        {"tube({{0, 0, 0}, {1, 1}}, 1)", "tube: item 2 of the list must have 3 numbers"},
        {"x:mirror('w')", "mirror: 'w' is not \"x\", \"y\" or \"z\""},
        {"x:mirror(1)", "mirror: argument 1 must be \"x\", \"y\" or \"z\", not 1"},
        {"mirror(x, 1)", "mirror: argument 2 must be \"x\", \"y\" or \"z\", not 1"},
        {"extrude(1, 1)", "extrude: argument 1 must be a field, not 1"},
        {"x:twist('a')", "twist: argument 1 must be a finite number, not a string"},
        {"noise(1, 0, 'pink')", "noise: 'pink' is not \"value\", \"gradient\", \"simplex\" or \"cellular\""},
        {"noise(1, -1)", "noise: argument 2 must be a whole number from 0 to 16777215, not -1"},
        {"fbm(1, 17)", "fbm: argument 2 must be a whole number from 1 to 16, not 17"},
        {"fbm(1)", "fbm takes 2 to 6 arguments, not 1"},
        {"gyroid(1, -0.1)", "gyroid: argument 2 must be a number of at least 0, not -0.1"},
        {"half_space(0, 0, 0, 1)", "half_space: the normal must not be 0, 0, 0"},
        {"x:array(1000, 1000, 1000, 1, 1, 1)", "array: 1000000000 copies of the shape are too many"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[256];
        snprintf(text, sizeof text, "local a = 1\nreturn %s", cases[i].text);
        test_refused(text, HEWN_SCENE_LUA, 2, cases[i].part);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_same_as_from_c),
        cmocka_unit_test(messages_name_the_argument),
    };
    return cmocka_run_group_tests_name("scene_catalogue", tests, NULL, NULL);
}
