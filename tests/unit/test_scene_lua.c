/* The language of scenes, function by function, against the C API that it stands for. */
#include "test_scene.h"

static hewn_field *field; /* a fresh one for each test */

static int create_field(void **state)
{
    (void)state;
    return hewn_field_create(&field, NULL) == HEWN_OK ? 0 : -1;
}

static int destroy_field(void **state)
{
    (void)state;
    hewn_field_destroy(&field);
    return 0;
}

/* --- arithmetic ----------------------------------------------------------------------------------------------------
 */

static const struct {
    const char *name;
    hewn_node (*build)(hewn_field *, hewn_node);
} unaries[] = {
    {"neg", hewn_neg},     {"abs", hewn_abs},   {"sqrt", hewn_sqrt},   {"square", hewn_square},
    {"sin", hewn_sin},     {"cos", hewn_cos},   {"tan", hewn_tan},     {"asin", hewn_asin},
    {"acos", hewn_acos},   {"atan", hewn_atan}, {"exp", hewn_exp},     {"ln", hewn_ln},
    {"floor", hewn_floor}, {"ceil", hewn_ceil}, {"round", hewn_round}, {"logic_not", hewn_logic_not},
};

static const struct {
    const char *name;
    hewn_node (*build)(hewn_field *, hewn_node, hewn_node);
} binaries[] = {
    {"atan2", hewn_atan2}, {"mod", hewn_mod}, {"compare", hewn_compare},   {"logic_and", hewn_logic_and},
    {"min", hewn_min},     {"max", hewn_max}, {"logic_or", hewn_logic_or},
};

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

/* 1.5 x - y */
static hewn_node first_operand(void)
{
    return hewn_sub(field, hewn_mul(field, hewn_constant(field, 1.5), hewn_x(field)), hewn_y(field));
}

/* floor(z): also 0, and of either sign */
static hewn_node second_operand(void)
{
    return hewn_floor(field, hewn_z(field));
}

static void test_unary(void **state)
{
    (void)state;
    char text[200];
    for (size_t i = 0; i < COUNT(unaries); i++) {
        hewn_node expected = unaries[i].build(field, first_operand());
        snprintf(text, sizeof text, "return %s(1.5 * x - y)", unaries[i].name);
        test_same(text, field, expected);
        snprintf(text, sizeof text, "return (1.5 * x - y):%s()", unaries[i].name);
        test_same(text, field, expected);
    }
}

static void test_binary(void **state)
{
    (void)state;
    char text[200];
    for (size_t i = 0; i < COUNT(binaries); i++) {
        hewn_node a = first_operand(), b = second_operand();
        snprintf(text, sizeof text, "return %s(1.5 * x - y, floor(z))", binaries[i].name);
        test_same(text, field, binaries[i].build(field, a, b));
        snprintf(text, sizeof text, "return floor(z):%s(1.5 * x - y)", binaries[i].name);
        test_same(text, field, binaries[i].build(field, b, a));
        snprintf(text, sizeof text, "return %s(1.5 * x - y, 0.5)", binaries[i].name);
        test_same(text, field, binaries[i].build(field, a, hewn_constant(field, 0.5)));
        snprintf(text, sizeof text, "return %s(-0.25, floor(z))", binaries[i].name);
        test_same(text, field, binaries[i].build(field, hewn_constant(field, -0.25), b));
    }
}

/* On plain numbers a function gives the number that the field's own operation would. */
static void test_numbers(void **state)
{
    (void)state;
    static const double values[] = {0, -0.0, 0.5, -0.5, 1, -1, 2.5, -2.5, 0.3, 7, -3.25, 1e10};
    char text[300];
    for (size_t k = 0; k < COUNT(values); k++) {
        hewn_node a = hewn_constant(field, values[k]);
        for (size_t i = 0; i < COUNT(unaries); i++) {
            hewn_node sum = hewn_add(field, hewn_x(field), unaries[i].build(field, a));
            snprintf(text, sizeof text,
                     "local n = %s(%a) assert(type(n) == 'number') if n ~= n then return sqrt(x * 0 - 1) end "
                     "return x + n",
                     unaries[i].name, values[k]);
            test_same(text, field, sum);
        }
        for (size_t j = 0; j < COUNT(values); j++)
            for (size_t i = 0; i < COUNT(binaries); i++) {
                hewn_node b = hewn_constant(field, values[j]);
                hewn_node sum = hewn_add(field, hewn_x(field), binaries[i].build(field, a, b));
                snprintf(text, sizeof text,
                         "local n = %s(%a, %a) assert(type(n) == 'number') if n ~= n then return sqrt(x * 0 - 1) "
                         "end return x + n",
                         binaries[i].name, values[k], values[j]);
                test_same(text, field, sum);
            }
    }
}

static void test_operators(void **state)
{
    (void)state;
    hewn_node a = first_operand(), b = second_operand(), half = hewn_constant(field, 0.5);
    test_same("return x", field, hewn_x(field));
    test_same("return y", field, hewn_y(field));
    test_same("return z", field, hewn_z(field));
    test_same("return (1.5 * x - y) + floor(z)", field, hewn_add(field, a, b));
    test_same("return (1.5 * x - y) - floor(z)", field, hewn_sub(field, a, b));
    test_same("return (1.5 * x - y) * floor(z)", field, hewn_mul(field, a, b));
    test_same("return (1.5 * x - y) / floor(z)", field, hewn_div(field, a, b));
    test_same("return (1.5 * x - y) % floor(z)", field, hewn_mod(field, a, b));
    test_same("return 0.5 / floor(z)", field, hewn_div(field, half, b));
    test_same("return floor(z) - 0.5", field, hewn_sub(field, b, half));
    test_same("return 0.5 % (1.5 * x - y)", field, hewn_mod(field, half, a));
    test_same("return -(1.5 * x - y)", field, hewn_neg(field, a));
    test_same("return (1.5 * x - y) ^ 1", field, a);
    test_same("return (1.5 * x - y) ^ 2", field, hewn_square(field, a));
    test_same("return (1.5 * x - y) ^ 3", field, hewn_mul(field, hewn_square(field, a), a));
    test_same("return (1.5 * x - y) ^ 4", field, hewn_square(field, hewn_square(field, a)));
    test_same("return (1.5 * x - y) | floor(z)", field, hewn_union(field, a, b));
    test_same("return (1.5 * x - y) & floor(z)", field, hewn_intersection(field, a, b));
    test_same("return ~(1.5 * x - y)", field, hewn_complement(field, a));
    test_same("return (1.5 * x - y) & ~floor(z)", field, hewn_difference(field, a, b));
    test_same("assert(x == x and x ~= y and x + 1 == x + 1 and tostring(x) == 'field') return x", field, hewn_x(field));
}

static void test_many_arguments(void **state)
{
    (void)state;
    hewn_node a = hewn_x(field), b = hewn_y(field), c = hewn_z(field), half = hewn_constant(field, 0.5);
    test_same("return min(x, y, z, 0.5)", field, hewn_min(field, hewn_min(field, hewn_min(field, a, b), c), half));
    test_same("return max(0.25, 0.5, x, y, z)", field,
              hewn_max(field, hewn_max(field, hewn_max(field, half, a), b), c));
    test_same("assert(min(3, 1, 2) == 1 and max(3) == 3) return max(x)", field, a);
    test_same("return union(x, y, z)", field, hewn_union(field, hewn_union(field, a, b), c));
    test_same("return x:intersection(y, z)", field, hewn_intersection(field, hewn_intersection(field, a, b), c));
    test_same("return difference(x, y, z)", field, hewn_difference(field, hewn_difference(field, a, b), c));
    test_same("return x:subtract(y, z)", field, hewn_difference(field, hewn_difference(field, a, b), c));
    test_same("return x:complement()", field, hewn_complement(field, a));
    test_same("return union(x)", field, a);
}

/* --- shapes --------------------------------------------------------------------------------------------------------
 */

static void test_shapes(void **state)
{
    (void)state;
    test_same("return sphere(0.75)", field, hewn_sphere(field, 0.75));
    test_same("return box(1, 2, 0.5)", field, hewn_box_shape(field, 1, 2, 0.5));
    test_same("return box(1.25)", field, hewn_box_shape(field, 1.25, 1.25, 1.25));
    test_same("return rounded_box(1, 2, 0.5, 0.125)", field, hewn_rounded_box(field, 1, 2, 0.5, 0.125));
    test_same("return torus(1, 0.25)", field, hewn_torus(field, 1, 0.25));
    test_same("return cylinder(0.5, 1.5)", field, hewn_cylinder(field, 0.5, 1.5));
    test_same("return capsule(0.5, 1.5)", field, hewn_capsule(field, 0.5, 1.5));
    test_same("return cone(0.75, 0.25, 1.5)", field, hewn_cone(field, 0.75, 0.25, 1.5));
    test_same("return cone(0, 1, 1)", field, hewn_cone(field, 0, 1, 1));
    test_same("return plane(1, -2, 0.5, 0.25)", field, hewn_plane(field, 1, -2, 0.5, 0.25));
}

static void test_smooth(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        hewn_blend blend;
    } blends[] = {{", 'quadratic'", HEWN_BLEND_QUADRATIC},
                  {", 'cubic'", HEWN_BLEND_CUBIC},
                  {", 'circular'", HEWN_BLEND_CIRCULAR},
                  {", 'exponential'", HEWN_BLEND_EXPONENTIAL},
                  {"", HEWN_BLEND_QUADRATIC}};
    static const struct {
        const char *name;
        hewn_node (*build)(hewn_field *, hewn_node, hewn_node, hewn_blend, double);
    } forms[] = {{"smooth_union", hewn_smooth_union},
                 {"smooth_intersection", hewn_smooth_intersection},
                 {"smooth_difference", hewn_smooth_difference}};
    hewn_node a = hewn_sphere(field, 1), b = hewn_box_shape(field, 1.5, 1.5, 1.5);
    char text[200];
    for (size_t i = 0; i < COUNT(blends); i++)
        for (size_t j = 0; j < COUNT(forms); j++) {
            hewn_node expected = forms[j].build(field, a, b, blends[i].blend, 0.5);
            snprintf(text, sizeof text, "return %s(sphere(1), box(1.5), 0.5%s)", forms[j].name, blends[i].name);
            test_same(text, field, expected);
            snprintf(text, sizeof text, "return sphere(1):%s(box(1.5), 0.5%s)", forms[j].name, blends[i].name);
            test_same(text, field, expected);
        }
}

static void test_moving(void **state)
{
    (void)state;
    const double degree = 3.14159265358979323846 / 180;
    hewn_node shape = hewn_box_shape(field, 1, 2, 0.5);
    test_same("return box(1, 2, 0.5):move(0.5, -1, 2)", field, hewn_translate(field, shape, 0.5, -1, 2));
    test_same("return translate(box(1, 2, 0.5), 0.5, -1, 2)", field, hewn_translate(field, shape, 0.5, -1, 2));
    test_same("return box(1, 2, 0.5):rotate('x', 30)", field, hewn_rotate(field, shape, 1, 0, 0, 30 * degree));
    test_same("return box(1, 2, 0.5):rotate_x(30)", field, hewn_rotate(field, shape, 1, 0, 0, 30 * degree));
    test_same("return box(1, 2, 0.5):rotate('y', -45)", field, hewn_rotate(field, shape, 0, 1, 0, -45 * degree));
    test_same("return rotate_y(box(1, 2, 0.5), 315 - 360)", field, hewn_rotate(field, shape, 0, 1, 0, -45 * degree));
    test_same("return box(1, 2, 0.5):rotate('z', 370)", field, hewn_rotate(field, shape, 0, 0, 1, 10 * degree));
    test_same("return box(1, 2, 0.5):rotate_z(10)", field, hewn_rotate(field, shape, 0, 0, 1, 10 * degree));
    test_same("return rotate(box(1, 2, 0.5), 1, 2, -3, 20)", field, hewn_rotate(field, shape, 1, 2, -3, 20 * degree));
    test_same("return box(1, 2, 0.5):scale(1.5)", field, hewn_scale(field, shape, 1.5));
    test_same("return box(1, 2, 0.5):scale(1.5, 0.5, 2)", field, hewn_stretch(field, shape, 1.5, 0.5, 2));
    test_same("return box(1, 2, 0.5):remap(y, x + 1, 0)", field,
              hewn_remap(field, shape, hewn_y(field), hewn_add(field, hewn_x(field), hewn_constant(field, 1)),
                         hewn_constant(field, 0)));
    test_same("return sphere(1):subtract(box(1, 2, 0.5)):move(1, 0, 0)", field,
              hewn_translate(field, hewn_difference(field, hewn_sphere(field, 1), shape), 1, 0, 0));
}

/* A turn goes the right-handed way: about z, from x towards y. */
static void test_turn_direction(void **state)
{
    (void)state;
    hewn_scene *scene = test_load_lua("return sphere(0.1):move(1, 0, 0):rotate_z(90)");
    const double point[3] = {0, 1, 0};
    double value;
    const hewn_field *built = hewn_scene_field(scene);
    assert_int_equal(hewn_field_eval(built, hewn_field_root(built), point, 1, &value, NULL), HEWN_OK);
    assert_true(value < -0.09);
    hewn_scene_destroy(&scene);
}

/* --- Lua itself ----------------------------------------------------------------------------------------------------
 */

static void test_lua_stays(void **state)
{
    (void)state;
    test_same("local s = {} for i = 1, 3 do s[#s + 1] = sphere(i / 4):move(i, 0, 0) end return union(table.unpack(s))",
              field,
              hewn_union(field,
                         hewn_union(field, hewn_translate(field, hewn_sphere(field, 0.25), 1, 0, 0),
                                    hewn_translate(field, hewn_sphere(field, 0.5), 2, 0, 0)),
                         hewn_translate(field, hewn_sphere(field, 0.75), 3, 0, 0)));
    static const char *const good[] = {
        "local ok, message = pcall(sphere, -1) assert(not ok and message:find('positive number')) return x",
        "local ok, v = pcall(function(a, b) return a + b end, 1, 2) assert(ok and v == 3) return x",
        "assert(select('#', pcall(function() return 1, 2, 3 end)) == 4) return x",
        "local ok, m = xpcall(error, function(e) return e .. '!' end, 'a') assert(not ok and m == 'a!') return x",
        "local a, b, c = xpcall(function(...) return ... end, print, 5, 6) assert(a and b == 5 and c == 6) return x",
        "local ok, e = pcall(error, {code = 7}) assert(not ok and e.code == 7) return x",
        "assert(math.floor(2.5) == 2 and ('%d'):format(3) == '3' and #utf8.char(228) == 2) return x",
        "assert(('a,b,c'):gsub(',', ';') == 'a;b;c' and ('k=v'):match('(%w+)=(%w+)') == 'k') return x",
        "local n = 0 for w in ('one two three'):gmatch('%a+') do n = n + 1 end assert(n == 3) return x",
        "assert(('abc'):rep(3, '-') == 'abc-abc-abc' and ('x'):rep(0) == '' and (''):rep(1 << 60) == '') return x",
        "assert(table.concat({1, 2, 3}, ' ') == '1 2 3') local t = {3, 1, 2} table.sort(t) assert(t[1] == 1) return x",
        "local t = {1, 3} table.insert(t, 2, 2) assert(t[2] == 2 and table.remove(t) == 3 and #t == 2) return x",
        "local t = table.move({1, 2, 3}, 1, 3, 2) assert(t[4] == 3) assert(table.pack(1, nil).n == 2) return x",
        ("local C = {} C.__index = C function C:f() return self.v end C.__add = function(a, b) return a.v + b.v end "
         "local o = setmetatable({v = 4}, C) assert(o:f() == 4 and o + o == 8 and getmetatable(o) == C) return x"),
        ("local p = setmetatable({}, {__metatable = 'no'}) assert(getmetatable(p) == 'no') "
         "assert(not pcall(setmetatable, p, {})) return x"),
        "local o = setmetatable({}, {}) setmetatable(o, nil) assert(getmetatable(o) == nil) return x",
        "do local closed local o <close> = setmetatable({}, {__close = function() closed = true end}) end return x",
        "goto done do error('no') end ::done:: return x",
        "#!/usr/bin/env hewn\nreturn x",
        "\xEF\xBB\xBFreturn x",
        "assert(getmetatable(x) == 'field') return x",
        "print('a', 1, nil, x, 'two\\nlines \\27[31m') return x",
        "assert(_VERSION == 'Lua 5.4' and _G.sphere == sphere and rawlen({1}) == 1 and next({}) == nil) return x",
    };
    for (size_t i = 0; i < COUNT(good); i++) {
        hewn_scene *scene = test_load_lua(good[i]);
        hewn_scene_destroy(&scene);
    }
}

/* pairs() goes through a table in one order on every run: by type, then by value; items may be taken out on the way. */
static void test_pairs_in_order(void **state)
{
    (void)state;
    hewn_scene *scene = test_load_lua(
        "local t = {10, 20, nil, 40, b = 1, a = 2, [2.5] = 3, [-1] = 4, [true] = 5, [false] = 6, B = 7, aa = 8}\n"
        "local seen = {}\n"
        "for k, v in pairs(t) do seen[#seen + 1] = tostring(k) .. '=' .. v t[k] = nil end\n"
        "local got = table.concat(seen, ' ')\n"
        "assert(got == 'false=6 true=5 -1=4 1=10 2=20 2.5=3 4=40 B=7 a=2 aa=8 b=1', got)\n"
        "for k in pairs({a = 1, b = 2}) do assert(k == 'a' or k == 'b') end\n"
        "local n = 0 local u = {p = 1, q = 2} for k in pairs(u) do u.q = nil n = n + 1 end assert(n == 1)\n"
        "for k in pairs(setmetatable({}, {__pairs = function() return function() end end})) do error() end\n"
        "assert(not pcall(pairs({}), 5))\n"
        "return x");
    hewn_scene_destroy(&scene);
}

/* Nothing that a script can compute differs between two runs. */
static void test_random_is_fixed(void **state)
{
    (void)state;
    double first[TEST_POINTS], second[TEST_POINTS];
    for (int run = 0; run < 2; run++) {
        hewn_scene *scene = test_load_lua("return sphere(1 + math.random()):move(math.random(100), 0, 0)");
        test_values(scene, run ? second : first);
        hewn_scene_destroy(&scene);
    }
    assert_memory_equal(first, second, sizeof first);
    test_refused("math.randomseed()\nreturn x", HEWN_SCENE_LUA, 1, "bad argument #1 to 'randomseed'");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_unary, create_field, destroy_field),
        cmocka_unit_test_setup_teardown(test_binary, create_field, destroy_field),
        cmocka_unit_test_setup_teardown(test_numbers, create_field, destroy_field),
        cmocka_unit_test_setup_teardown(test_operators, create_field, destroy_field),
        cmocka_unit_test_setup_teardown(test_many_arguments, create_field, destroy_field),
        cmocka_unit_test_setup_teardown(test_shapes, create_field, destroy_field),
        cmocka_unit_test_setup_teardown(test_smooth, create_field, destroy_field),
        cmocka_unit_test_setup_teardown(test_moving, create_field, destroy_field),
        cmocka_unit_test(test_turn_direction),
        cmocka_unit_test_setup_teardown(test_lua_stays, create_field, destroy_field),
        cmocka_unit_test(test_pairs_in_order),
        cmocka_unit_test(test_random_is_fixed),
    };
    return cmocka_run_group_tests_name("scene_lua", tests, NULL, NULL);
}
