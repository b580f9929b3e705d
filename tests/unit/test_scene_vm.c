/* The .vm text: the four models that are at hand, every operation, and lines that are wrong. */
#include "test_data.h"
#include "test_scene.h"

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

static hewn_scene *load_vm(const char *text)
{
    hewn_scene *scene;
    hewn_error error = {0};
    if (test_load(text, HEWN_SCENE_VM, &scene, &error) != HEWN_OK)
        fail_msg("%s\n%s:%u: %s", text, error.file, error.line, error.message);
    return scene;
}

/* A second reader, with nothing in common: names in a list, values computed line by line. */
static double interpret(const char *text, double x, double y, double z)
{
    static struct {
        char name[32];
        double value;
    } lines[10000];
    size_t count = 0;
    for (const char *at = text; *at;) {
        char name[32], op[32], a[32] = "", b[32] = "";
        int fields = *at == '#' ? 0 : sscanf(at, "%31s%31s%31[^\n]", name, op, a);
        bool blank = *at == '\n' || *at == '#';
        at = strchr(at, '\n') ? strchr(at, '\n') + 1 : at + strlen(at);
        if (blank || fields < 2)
            continue;
        char operands[32];
        snprintf(operands, sizeof operands, "%s", a);
        a[0] = '\0';
        sscanf(operands, "%31s%31s", a, b);
        double p = 0, q = 0;
        for (size_t i = 0; i < count && strcmp(op, "const") != 0; i++) {
            if (strcmp(lines[i].name, a) == 0)
                p = lines[i].value;
            if (strcmp(lines[i].name, b) == 0)
                q = lines[i].value;
        }
        const char *o = op;
        double value = strcmp(o, "const") == 0    ? atof(a)
                       : strcmp(o, "var-x") == 0  ? x
                       : strcmp(o, "var-y") == 0  ? y
                       : strcmp(o, "var-z") == 0  ? z
                       : strcmp(o, "add") == 0    ? p + q
                       : strcmp(o, "sub") == 0    ? p - q
                       : strcmp(o, "mul") == 0    ? p * q
                       : strcmp(o, "max") == 0    ? fmax(p, q)
                       : strcmp(o, "min") == 0    ? fmin(p, q)
                       : strcmp(o, "neg") == 0    ? -p
                       : strcmp(o, "sqrt") == 0   ? sqrt(p)
                       : strcmp(o, "square") == 0 ? p * p
                                                  : NAN;
        snprintf(lines[count].name, sizeof lines[count].name, "%s", name);
        lines[count++].value = value;
        assert_true(count < COUNT(lines));
    }
    return lines[count - 1].value;
}

static void test_models(void **state)
{
    (void)state;
    static const char *const names[] = {"hi.vm", "quarter.vm", "colonnade.vm", "prospero.vm"};
    for (size_t i = 0; i < COUNT(names); i++) {
        char name[64], path[8192];
        size_t length = 0;
        snprintf(name, sizeof name, "implicit/%s", names[i]);
        char *text = data_file(path, name) ? test_read(path, &length) : NULL;
        if (!text) {
            print_message("# %s is not at hand: skipped\n", path);
            skip();
        }
        hewn_scene_desc desc = {.path = path};
        hewn_scene *scene;
        hewn_error error = {0};
        if (hewn_scene_load(&desc, &scene, &error) != HEWN_OK)
            fail_msg("%s:%u: %s", error.file, error.line, error.message);
        hewn_box box;
        assert_true(hewn_scene_bounds(scene, &box));
        for (int k = 0; k < 3; k++)
            assert_true(box.lo[k] == -1 && box.hi[k] == 1);
        double points[3 * TEST_POINTS], values[TEST_POINTS];
        test_points(points);
        test_values(scene, values);
        for (int k = 0; k < (length > 10000 ? 3 : TEST_POINTS); k++) {
            double expected = interpret(text, points[3 * k], points[3 * k + 1], points[3 * k + 2]);
            if (!(fabs(values[k] - expected) <= 1e-12 * (1 + fabs(expected))))
                fail_msg("%s at point %d is %.17g, not %.17g", names[i], k, values[k], expected);
        }
        hewn_scene_destroy(&scene);
        free(text);
    }
}

static hewn_node recip(hewn_field *field, hewn_node a)
{
    return hewn_div(field, hewn_constant(field, 1), a);
}

static void test_operations(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        hewn_node (*one)(hewn_field *, hewn_node);
        hewn_node (*two)(hewn_field *, hewn_node, hewn_node);
    } ops[] = {
        {"neg", hewn_neg, NULL},       {"abs", hewn_abs, NULL},         {"sqrt", hewn_sqrt, NULL},
        {"square", hewn_square, NULL}, {"sin", hewn_sin, NULL},         {"cos", hewn_cos, NULL},
        {"tan", hewn_tan, NULL},       {"asin", hewn_asin, NULL},       {"acos", hewn_acos, NULL},
        {"atan", hewn_atan, NULL},     {"exp", hewn_exp, NULL},         {"ln", hewn_ln, NULL},
        {"floor", hewn_floor, NULL},   {"ceil", hewn_ceil, NULL},       {"round", hewn_round, NULL},
        {"not", hewn_logic_not, NULL}, {"recip", recip, NULL},          {"add", NULL, hewn_add},
        {"sub", NULL, hewn_sub},       {"mul", NULL, hewn_mul},         {"div", NULL, hewn_div},
        {"min", NULL, hewn_min},       {"max", NULL, hewn_max},         {"mod", NULL, hewn_mod},
        {"atan2", NULL, hewn_atan2},   {"compare", NULL, hewn_compare}, {"and", NULL, hewn_logic_and},
        {"or", NULL, hewn_logic_or},
    };
    double points[3 * TEST_POINTS], expected[TEST_POINTS], got[TEST_POINTS];
    test_points(points);
    for (size_t i = 0; i < COUNT(ops); i++) {
        char text[200];
        snprintf(text, sizeof text, "X var-x\nZ var-z\nfz floor Z\nr %s %s", ops[i].name, ops[i].one ? "X" : "fz X");
        hewn_field *field;
        assert_int_equal(hewn_field_create(&field, NULL), HEWN_OK);
        hewn_node x = hewn_x(field), z = hewn_floor(field, hewn_z(field));
        hewn_node node = ops[i].one ? ops[i].one(field, x) : ops[i].two(field, z, x);
        assert_int_equal(hewn_field_eval(field, node, points, TEST_POINTS, expected, NULL), HEWN_OK);
        hewn_scene *scene = load_vm(text);
        test_values(scene, got);
        for (int k = 0; k < TEST_POINTS; k++)
            if (!(got[k] == expected[k] || (isnan(got[k]) && isnan(expected[k]))))
                fail_msg("%s: %.17g, not %.17g", ops[i].name, got[k], expected[k]);
        hewn_scene_destroy(&scene);
        hewn_field_destroy(&field);
    }
}

static void test_forms(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        double value; /* at the first test point's place, x = 0.5, y = -1, z = 2 */
    } good[] = {
        {"a const 1", 1},
        {"a const -1.5e-2", -0.015},
        {"a const +.5", 0.5},
        {"a const 5.", 5},
        {"a var-x", 0.5},
        {"a var-y\r\n\r\nb neg a\r\n", 1},
        {"# only\n\n   \t\n  a\tvar-z   \n\t# more\n  b  add a   a\n", 4},
        {"\xEF\xBB\xBF"
         "a var-z",
         2},
        {"add var-x\nvar-x var-z\nconst mul add var-x", 1},
        {"\xC3\xA4 var-x\n-1 var-z\n~ sub \xC3\xA4 -1", -1.5},
        {"a var-x\nb neg a\nc const 7\n#", 7},
    };
    const double point[3] = {0.5, -1, 2};
    for (size_t i = 0; i < COUNT(good); i++) {
        hewn_scene *scene = load_vm(good[i].text);
        double value;
        const hewn_field *field = hewn_scene_field(scene);
        assert_int_equal(hewn_field_eval(field, hewn_field_root(field), point, 1, &value, NULL), HEWN_OK);
        if (value != good[i].value)
            fail_msg("%s\nis %g", good[i].text, value);
        hewn_scene_destroy(&scene);
    }
}

static void test_wrong_lines(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        uint32_t line;
        const char *part;
    } bad[] = {
        {"", 0, "no instruction"},
        {"\n# nothing\n", 0, "no instruction"},
        {"a", 1, "'a' has no operation"},
        {"a var-x\n\nb\n", 3, "'b' has no operation"},
        {"a var-w", 1, "unknown operation 'var-w'"},
        {"a VAR-X", 1, "unknown operation"},
        {"a var-x 1", 1, "var-x takes 0 operands, not 1"},
        {"a const", 1, "const takes 1 operand, not 0"},
        {"a const 1 2", 1, "const takes 1 operand, not 2"},
        {"a const x", 1, "'x' is not a number"},
        {"a const 1x", 1, "'1x' is not a number"},
        {"a const 1,5", 1, "not a number"},
        {"a const 0x10", 1, "not a number"},
        {"a const nan", 1, "not a number"},
        {"a const inf", 1, "not a number"},
        {"a const 1e", 1, "not a number"},
        {"a const --1", 1, "not a number"},
        {"a const 1-1", 1, "not a number"},
        {"a const 1e400", 1, "too large"},
        {"a neg b", 1, "no line above this one is called 'b'"},
        {"a neg a", 1, "no line above this one is called 'a'"},
        {"a var-x\nb add a c\nc var-y", 2, "no line above this one is called 'c'"},
        {"a var-x\nb add a", 2, "add takes 2 operands, not 1"},
        {"a var-x\nb neg a a", 2, "neg takes 1 operand, not 2"},
        {"a var-x\nb add a a a", 2, "add takes 2 operands, not more than 2"},
        {"a var-x\nb add a a # sum", 2, "more than 2"},
        {"a var-x\n\na var-y", 3, "'a' is already defined on line 1"},
        {"a neg 1", 1, "no line above"},
        {"a var-x\nb \x1b[31m a", 2, "unknown operation ' [31m'"},
        {"a var-x\nb \xff\xfe a", 2, "unknown operation '?\?'"},
    };
    for (size_t i = 0; i < COUNT(bad); i++)
        test_refused(bad[i].text, HEWN_SCENE_VM, bad[i].line, bad[i].part);
}

/* Zero bytes and words without end. */
static void test_odd_bytes(void **state)
{
    (void)state;
    static const char zero[] = "a var-x\nb ne\0g a";
    hewn_scene_desc desc = {.path = "scene.vm"};
    hewn_scene *scene;
    hewn_error error = {0};
    assert_int_equal(hewn_scene_load_text(&desc, zero, sizeof zero - 1, &scene, &error), HEWN_BAD_INPUT);
    assert_int_equal(error.line, 2);
    size_t length = 1 << 20;
    char *text = malloc(length + 1);
    assert_non_null(text);
    memset(text, '7', length);
    text[length] = '\0';
    assert_int_equal(hewn_scene_load_text(&desc, text, length, &scene, &error), HEWN_BAD_INPUT);
    memcpy(text, "a const ", 8);
    assert_int_equal(hewn_scene_load_text(&desc, text, length, &scene, &error), HEWN_BAD_INPUT);
    assert_non_null(strstr(error.message, "too large"));
    free(text);
}

static void test_settings_are_refused(void **state)
{
    (void)state;
    const hewn_scene_setting set = {"L", 1};
    hewn_scene_desc desc = {.path = "scene.vm", .settings = &set, .setting_count = 1};
    hewn_scene *scene;
    hewn_error error = {0};
    assert_int_equal(hewn_scene_load_text(&desc, "a var-x", 7, &scene, &error), HEWN_BAD_INPUT);
    assert_non_null(strstr(error.message, "no parameter 'L'"));
}

/* Many names: what is found by hash is what was put in. */
static void test_many_lines(void **state)
{
    (void)state;
    enum { LINES = 20000 };
    char *text = malloc(LINES * 40), *at = text;
    assert_non_null(text);
    at += sprintf(at, "n0 const 0\nx var-x\n");
    for (int i = 1; i < LINES; i++)
        at += sprintf(at, "c%d const %d\nn%d add n%d x\n", i, i, i, i - 1);
    hewn_scene *scene = load_vm(text);
    const double point[3] = {0.5, 0, 0};
    double value;
    const hewn_field *field = hewn_scene_field(scene);
    assert_int_equal(hewn_field_eval(field, hewn_field_root(field), point, 1, &value, NULL), HEWN_OK);
    assert_true(value == 0.5 * (LINES - 1));
    hewn_scene_destroy(&scene);
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_models),     cmocka_unit_test(test_operations),
        cmocka_unit_test(test_forms),      cmocka_unit_test(test_wrong_lines),
        cmocka_unit_test(test_odd_bytes),  cmocka_unit_test(test_settings_are_refused),
        cmocka_unit_test(test_many_lines),
    };
    return cmocka_run_group_tests_name("scene_vm", tests, NULL, NULL);
}
