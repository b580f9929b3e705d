/* Generated code as a whole: gradients against the oracle, one set of bits in all flavours, parameters without
 * recompilation, and large fields. */
#include "../unit/test_data.h"
#include "test_code_support.h"

#include <dirent.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/file.h"
#include "gpu/device.h"

typedef struct fixture {
    hewn_device *device;
    unsigned messages;
    uint64_t random;
} fixture;

/* --- gradients --------------------------------------------------------------------------------------------------- */

static bool near_all(const double *a, const double *b, double share)
{
    double size = 1;
    for (int k = 1; k < 4; k++)
        size = fmax(size, fabs(a[k]));
    for (int k = 1; k < 4; k++)
        if (!(fabs(a[k] - b[k]) <= share * size))
            return false;
    return true;
}

/* The oracle's gradient where it is the same all around: not at ties, corners and poles. */
static bool smooth_gradient(const hewn_field *field, hewn_node root, const double *point, double *out)
{
    GPU_TEST_TRY(hewn_field_gradient(field, root, point, 1, out, &error));
    for (int k = 0; k < 4; k++)
        if (!isfinite(out[k]))
            return false;
    for (int k = 0; k < 6; k++) {
        double other[4], moved[3] = {point[0], point[1], point[2]};
        moved[k / 2] += k % 2 ? 1e-5 : -1e-5;
        GPU_TEST_TRY(hewn_field_gradient(field, root, moved, 1, other, &error));
        if (!near_all(out, other, 1e-3))
            return false;
    }
    return true;
}

static void check_gradients(fixture *state, hewn_op op)
{
    enum { COUNT = 2000 };
    float points[3 * COUNT], got[4 * COUNT];
    double parameters[HEWN_MAX_PARAMETERS];
    hewn_node root;
    code_parameters(op, &state->random, parameters);
    hewn_field *field = code_one_op(op, parameters, &root);
    hewn_code *code = code_of(state->device, field, root);
    for (int i = 0; i < 3 * COUNT; i++)
        points[i] = (float)code_between(&state->random, i % 9 < 3 ? -0.9 : -3, i % 9 < 3 ? 0.9 : 3);
    GPU_TEST_TRY(hewn_code_eval_gradients(state->device, code, points, COUNT, got, &error));
    int compared = 0;
    for (int i = 0; i < COUNT; i++) {
        const double point[3] = {(double)points[3 * i], (double)points[3 * i + 1], (double)points[3 * i + 2]};
        const double value[4] = {(double)got[4 * i], (double)got[4 * i + 1], (double)got[4 * i + 2],
                                 (double)got[4 * i + 3]};
        double expected[4];
        if (!smooth_gradient(field, root, point, expected))
            continue;
        compared++;
        if (!near_all(expected, value, 2e-4))
            fail_msg("%s at (%.9g, %.9g, %.9g): gradient (%g, %g, %g) instead of (%g, %g, %g)", hewn_op_infos[op].name,
                     point[0], point[1], point[2], value[1], value[2], value[3], expected[1], expected[2], expected[3]);
    }
    hewn_code_destroy(state->device, &code);
    hewn_field_destroy(&field);
    if (compared < COUNT / 5)
        fail_msg("%s: only %d gradients of %d could be compared", hewn_op_infos[op].name, compared, COUNT);
}

static void gradients_are_the_oracles(void **test_state)
{
    for (int op = 0; op < HEWN_OP_COUNT; op++)
        if (!hewn_op_is_link((hewn_op)op))
            check_gradients(*test_state, (hewn_op)op);
}

/* --- one set of bits --------------------------------------------------------------------------------------------- */

enum { ROW = 10 /* floats a row: eight x, then y and z */ };

static hewn_program *row_program(hewn_device *device, const hewn_code *code)
{
    static const char head[] =
        "#version 460\n#extension GL_EXT_buffer_reference : require\n"
        "#extension GL_EXT_scalar_block_layout : require\n"
        "layout(local_size_x = 64) in;\n"
        "layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer rows { float at[]; };\n"
        "layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer signs { uint at[]; };\n"
        "layout(push_constant, scalar) uniform push { rows in_rows; signs out_signs; uint count; };\n"
        "float sample_x(uint i);\n";
    static const char body[] = "float sample_x(uint i) { return in_rows.at[i]; }\n"
                               "void main()\n{\nuint i = gl_GlobalInvocationID.x;\nif (i >= count)\nreturn;\n"
                               "out_signs.at[i] = field_row_inside(10 * i, in_rows.at[10 * i + 8], "
                               "in_rows.at[10 * i + 9]);\n}\n";
    const hewn_kernel_desc desc = {
        .name = "rows", .head = head, .body = body, .flavours = HEWN_FLAVOUR_ROW, .push_bytes = 20};
    hewn_program *program;
    GPU_TEST_TRY(hewn_code_program(device, code, &desc, &program, &error));
    return program;
}

static void run_rows(hewn_device *device, const hewn_code *code, const float *rows, uint32_t count, uint32_t *signs)
{
    hewn_buffer in, out;
    hewn_commands *commands;
    GPU_TEST_TRY(hewn_buffer_create(device, "rows", count * ROW * sizeof(float), HEWN_BUFFER_UPLOAD, &in, &error));
    GPU_TEST_TRY(hewn_buffer_create(device, "signs", count * sizeof(uint32_t), HEWN_BUFFER_READBACK, &out, &error));
    memcpy(in.mapped, rows, count * ROW * sizeof(float));
    hewn_program *program = row_program(device, code);
    const struct {
        uint64_t in, out;
        uint32_t count;
    } push = {in.address, out.address, count};
    GPU_TEST_TRY(hewn_commands_begin(device, &commands, &error));
    hewn_commands_dispatch(commands, program, &push, hewn_code_uniforms(code),
                           (hewn_dispatch_size){(count + 63) / 64, 1, 1});
    GPU_TEST_TRY(hewn_commands_submit(&commands, NULL, &error));
    memcpy(signs, out.mapped, count * sizeof(uint32_t));
    hewn_program_destroy(device, &program);
    hewn_buffer_destroy(device, &in);
    hewn_buffer_destroy(device, &out);
}

/* Everything that a code computes at the same arguments. */
enum { ROWS = 1000, SAMPLES = 8 * ROWS };
typedef struct bits {
    float values[SAMPLES], gradients[4 * SAMPLES], intervals[2 * SAMPLES];
    uint32_t signs[ROWS];
} bits;

static void compute_bits(fixture *state, const hewn_field *field, hewn_node root, hewn_numbers numbers,
                         const float *rows, const float *points, const float *boxes, bits *out)
{
    hewn_code *code = code_with(state->device, field, root, numbers);
    GPU_TEST_TRY(hewn_code_eval_points(state->device, code, points, SAMPLES, out->values, &error));
    GPU_TEST_TRY(hewn_code_eval_gradients(state->device, code, points, SAMPLES, out->gradients, &error));
    GPU_TEST_TRY(hewn_code_eval_boxes(state->device, code, boxes, SAMPLES, out->intervals, &error));
    run_rows(state->device, code, rows, ROWS, out->signs);
    hewn_code_destroy(state->device, &code);
}

/* Two codes of one field, one with its numbers in a buffer and one with literals. Gradients too, and the signs of their
 * zeros, since a mesh holds them; only where a factor is infinite a literal zero may win, and there is no normal. */
static void check_same(const bits *buffer, const bits *literals, const char *name)
{
    assert_memory_equal(buffer->signs, literals->signs, sizeof buffer->signs);
    for (int i = 0; i < SAMPLES; i++)
        if (!code_same(buffer->values[i], literals->values[i]))
            fail_msg("%s: value %.9g, with literals %.9g", name, (double)buffer->values[i],
                     (double)literals->values[i]);
    for (int i = 0; i < 2 * SAMPLES; i++)
        if (!code_same(buffer->intervals[i], literals->intervals[i]))
            fail_msg("%s: bound %.9g, with literals %.9g", name, (double)buffer->intervals[i],
                     (double)literals->intervals[i]);
    for (int i = 0; i < 4 * SAMPLES; i++) {
        float a = buffer->gradients[i], b = literals->gradients[i];
        if (i % 4 > 0 && isfinite(a) && isfinite(b) && code_bits(a) != code_bits(b))
            fail_msg("%s: derivative %.9g, with literals %.9g", name, (double)a, (double)b);
    }
}

/* Points, gradients' values and signs of rows agree, and wherever the numbers stand all has the same bits. */
static void check_bits(fixture *state, const hewn_field *field, hewn_node root, const char *name)
{
    static float rows[ROW * ROWS], points[3 * SAMPLES], boxes[6 * SAMPLES];
    static bits got, fixed;
    for (int i = 0; i < ROW * ROWS; i++)
        rows[i] = gpu_test_random(&state->random) % 16
                      ? (float)code_between(&state->random, -3, 3)
                      : code_awkward_at(gpu_test_random(&state->random) % CODE_AWKWARD);
    for (int i = 0; i < SAMPLES; i++) {
        points[3 * i] = rows[ROW * (i / 8) + i % 8];
        points[3 * i + 1] = rows[ROW * (i / 8) + 8];
        points[3 * i + 2] = rows[ROW * (i / 8) + 9];
        for (int k = 0; k < 6; k++)
            boxes[6 * i + k] = points[3 * i + k % 3] + (k < 3 ? 0.0f : (float)code_uniform(&state->random));
    }
    compute_bits(state, field, root, HEWN_NUMBERS_IN_BUFFER, rows, points, boxes, &got);
    compute_bits(state, field, root, HEWN_NUMBERS_IN_CODE, rows, points, boxes, &fixed);
    check_same(&got, &fixed, name);
    for (int i = 0; i < SAMPLES; i++) {
        float value = got.values[i];
        if (!code_same(value, got.gradients[4 * i]))
            fail_msg("%s: value %.9g, with gradient %.9g", name, (double)value, (double)got.gradients[4 * i]);
        if (!code_is_denormal(value) && (got.signs[i / 8] >> i % 8 & 1) != (value < 0))
            fail_msg("%s: value %.9g, sign bit %u", name, (double)value, got.signs[i / 8] >> i % 8 & 1);
    }
}

static void flavours_agree_bit_for_bit(void **test_state)
{
    fixture *state = *test_state;
    for (int op = 0; op < HEWN_OP_COUNT; op++) {
        double parameters[HEWN_MAX_PARAMETERS];
        hewn_node root;
        if (op == HEWN_OP_SAMPLED)
            continue; /* its samples come from elsewhere: test_sampled.c */
        code_parameters((hewn_op)op, &state->random, parameters);
        hewn_field *field = code_one_op((hewn_op)op, parameters, &root);
        check_bits(state, field, root, hewn_op_infos[op].name);
        hewn_field_destroy(&field);
    }
    for (int i = 0; i < (gpu_test_long() ? 200 : 8); i++) {
        hewn_node root;
        hewn_field *field = code_random_graph(&state->random, (size_t)(25 * (i % 8 + 1)), &root);
        check_bits(state, field, root, "graph");
        hewn_field_destroy(&field);
    }
}

/* --- parameters -------------------------------------------------------------------------------------------------- */

static size_t count_files(const char *folder)
{
    size_t count = 0;
    DIR *entries = opendir(folder);
    for (struct dirent *entry; entries && (entry = readdir(entries));)
        count += entry->d_name[0] != '.';
    if (entries)
        closedir(entries);
    return count;
}

static void remove_files(const char *folder)
{
    DIR *entries = opendir(folder);
    for (struct dirent *entry; entries && (entry = readdir(entries));) {
        char path[1024];
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        if (entry->d_name[0] != '.')
            (void)unlink(path);
    }
    if (entries)
        closedir(entries);
    (void)rmdir(folder);
}

static float value_with(hewn_device *device, double radius, double shift)
{
    hewn_field *field;
    GPU_TEST_TRY(hewn_field_create(&field, &error));
    hewn_node ball = hewn_translate(field, hewn_sphere(field, radius), shift, 0, 0);
    hewn_node cut = hewn_smooth_union(field, ball, hewn_mul(field, hewn_y(field), hewn_constant(field, shift)),
                                      HEWN_BLEND_CUBIC, radius / 8);
    hewn_code *code = code_with(device, field, cut, HEWN_NUMBERS_IN_BUFFER);
    const float point[3] = {0, 100, 0};
    float value;
    GPU_TEST_TRY(hewn_code_eval_points(device, code, point, 1, &value, &error));
    hewn_code_destroy(device, &code);
    hewn_field_destroy(&field);
    return value;
}

static void a_changed_number_compiles_nothing(void **test_state)
{
    (void)test_state;
    char folder[] = "/tmp/hewn_code_XXXXXX", spirv[64], path[64];
    const char *before = getenv("XDG_CACHE_HOME");
    char *kept = before ? hewn_strdup(before) : NULL;
    unsigned messages;
    assert_non_null(mkdtemp(folder));
    assert_int_equal(setenv("XDG_CACHE_HOME", folder, 1), 0);
    snprintf(spirv, sizeof spirv, "%s/hewn/spirv", folder);
    hewn_device *device = gpu_test_open(&messages);
    float first = value_with(device, 0.5, 0.25);
    size_t files = count_files(spirv);
    float second = value_with(device, 0.75, -0.4);
    size_t more = count_files(spirv);
    gpu_test_close(&device, &messages);
    remove_files(spirv);
    snprintf(path, sizeof path, "%s/hewn/pipeline", folder);
    remove_files(path);
    snprintf(path, sizeof path, "%s/hewn", folder);
    remove_files(path);
    remove_files(folder);
    assert_int_equal(kept ? setenv("XDG_CACHE_HOME", kept, 1) : unsetenv("XDG_CACHE_HOME"), 0);
    hewn_free(kept);
    assert_true(files > 0);
    assert_int_equal(more, files);
    assert_true(first != second);
}

/* --- large fields ------------------------------------------------------------------------------------------------ */

/* Values at a few points against the oracle; the field must err little. */
static void check_values(fixture *state, const hewn_field *field, hewn_node root, double most, const char *name)
{
    enum { COUNT = 500 };
    float points[3 * COUNT], values[COUNT], boxes[6 * COUNT], intervals[2 * COUNT];
    for (int i = 0; i < 3 * COUNT; i++) {
        points[i] = (float)code_between(&state->random, -1, 1);
        boxes[6 * (i / 3) + i % 3] = points[i] - 0.01f;
        boxes[6 * (i / 3) + 3 + i % 3] = points[i] + 0.01f;
    }
    double begin = hewn_clock_now();
    hewn_code *code = code_of(state->device, field, root);
    GPU_TEST_TRY(hewn_code_eval_points(state->device, code, points, COUNT, values, &error));
    double middle = hewn_clock_now();
    GPU_TEST_TRY(hewn_code_eval_boxes(state->device, code, boxes, COUNT, intervals, &error));
    print_message("# %s: %.2f s to the first values, %.2f s to the first intervals\n", name, middle - begin,
                  hewn_clock_now() - middle);
    hewn_code_destroy(state->device, &code);
    for (int i = 0; i < COUNT; i++) {
        const double point[3] = {(double)points[3 * i], (double)points[3 * i + 1], (double)points[3 * i + 2]};
        double expected;
        GPU_TEST_TRY(hewn_field_eval(field, root, point, 1, &expected, &error));
        if (!(fabs((double)values[i] - expected) <= most))
            fail_msg("%s at (%.9g, %.9g, %.9g): %.9g instead of %.9g", name, point[0], point[1], point[2],
                     (double)values[i], expected);
        assert_true(intervals[2 * i] <= values[i] && values[i] <= intervals[2 * i + 1]);
        assert_true(intervals[2 * i + 1] - intervals[2 * i] < 100);
    }
}

static void many_shapes_compile(void **test_state)
{
    fixture *state = *test_state;
    hewn_field *field;
    GPU_TEST_TRY(hewn_field_create(&field, &error));
    int count = gpu_test_long() ? 1000 : 100;
    hewn_node root = code_many_shapes(field, &state->random, count);
    check_values(state, field, root, 1e-5, count == 100 ? "100 shapes" : "1,000 shapes");
    hewn_field_destroy(&field);
}

/* More parameters than a block of uniforms holds are read through their address; a small limit stands in for them. */
static void parameters_may_outgrow_uniforms(void **test_state)
{
    fixture *state = *test_state;
    hewn_field *field;
    GPU_TEST_TRY(hewn_field_create(&field, &error));
    hewn_node root = code_many_shapes(field, &state->random, 8);
    const float point[3] = {0.25f, 0.5f, 0.125f};
    const uint64_t range = state->device->max_uniform_range;
    float values[3];
    hewn_code *codes[3];
    codes[0] = code_with(state->device, field, root, HEWN_NUMBERS_IN_BUFFER);
    codes[2] = code_with(state->device, field, root, HEWN_NUMBERS_IN_CODE);
    state->device->max_uniform_range = 64;
    codes[1] = code_with(state->device, field, root, HEWN_NUMBERS_IN_BUFFER);
    assert_true(hewn_code_uniforms(codes[0])->size > 64 && hewn_code_uniforms(codes[1])->size == 16);
    for (int i = 0; i < 3; i++) {
        state->device->max_uniform_range = i == 1 ? 64 : range;
        GPU_TEST_TRY(hewn_code_eval_points(state->device, codes[i], point, 1, &values[i], &error));
        hewn_code_destroy(state->device, &codes[i]);
    }
    state->device->max_uniform_range = range;
    hewn_field_destroy(&field);
    assert_true(code_same(values[0], values[1]) && code_same(values[0], values[2]));
}

static hewn_op vm_op(const char *name)
{
    for (int op = 0; op < HEWN_OP_COUNT; op++)
        if (strcmp(hewn_op_infos[op].name, name) == 0)
            return (hewn_op)op;
    fail_msg("no operation '%s'", name);
    return HEWN_OP_COUNT;
}

/* Just enough of a reader for the one model. */
static hewn_node read_vm(hewn_field *field, char *text)
{
    enum { MOST = 1 << 16 };
    hewn_node *nodes = hewn_alloc(MOST, sizeof *nodes);
    hewn_node last = HEWN_NODE_NONE;
    assert_non_null(nodes);
    char *rest = NULL;
    for (char *line = strtok_r(text, "\n", &rest); line; line = strtok_r(NULL, "\n", &rest)) {
        unsigned id, a = 0, b = 0;
        char name[16];
        double number = 0;
        if (sscanf(line, "_%x %15s", &id, name) != 2 || id >= MOST)
            continue;
        if (sscanf(line, "_%*x const %lf", &number) == 1) {
            last = hewn_constant(field, number);
        } else if (strncmp(name, "var-", 4) == 0) {
            last = name[4] == 'x' ? hewn_x(field) : name[4] == 'y' ? hewn_y(field) : hewn_z(field);
        } else {
            assert_true(sscanf(line, "_%*x %*s _%x _%x", &a, &b) >= 1 && a < id && b < id);
            const uint32_t operands[2] = {nodes[a].id, nodes[b].id};
            last = code_node(field, vm_op(name), operands, NULL);
        }
        nodes[id] = last;
    }
    hewn_free(nodes);
    return last;
}

static void prospero_compiles(void **test_state)
{
    fixture *state = *test_state;
    char path[8192], *text = NULL;
    size_t length;
    if (!data_file(path, "implicit/prospero.vm") ||
        hewn_file_read(path, (size_t)1 << 24, &text, &length, NULL) != HEWN_OK) {
        print_message("# skipped: %s is not there\n", path);
        skip();
    }
    hewn_field *field;
    GPU_TEST_TRY(hewn_field_create(&field, &error));
    hewn_node root = read_vm(field, text);
    check_values(state, field, root, 1e-5, "Prospero");
    hewn_free(text);
    hewn_field_destroy(&field);
}

/* --- batches ----------------------------------------------------------------------------------------------------- */

/* More items than one piece holds, and none at all. */
static void batches_have_any_size(void **test_state)
{
    fixture *state = *test_state;
    hewn_node root;
    const double parameters[HEWN_MAX_PARAMETERS] = {2, 0, 0, 1};
    hewn_field *field = code_one_op(HEWN_OP_AFFINE, parameters, &root);
    hewn_code *code = code_of(state->device, field, root);
    const size_t count = ((size_t)1 << 20) + 3;
    float *points = hewn_alloc(count * 3, sizeof *points), *values = hewn_alloc(count, sizeof *values);
    assert_true(points && values);
    for (size_t i = 0; i < count * 3; i++)
        points[i] = (float)i;
    GPU_TEST_TRY(hewn_code_eval_points(state->device, code, NULL, 0, NULL, &error));
    GPU_TEST_TRY(hewn_code_eval_points(state->device, code, points, count, values, &error));
    for (size_t i = 0; i < count; i++)
        assert_true(values[i] == 6.0f * (float)i + 1.0f);
    hewn_free(points);
    hewn_free(values);
    hewn_code_destroy(state->device, &code);
    hewn_field_destroy(&field);
}

static void constants_and_variables_are_fields(void **test_state)
{
    fixture *state = *test_state;
    hewn_field *field;
    GPU_TEST_TRY(hewn_field_create(&field, &error));
    const hewn_node roots[] = {hewn_constant(field, 0.5), hewn_constant(field, (double)NAN), hewn_z(field)};
    for (size_t i = 0; i < 3; i++) {
        hewn_code *code = code_of(state->device, field, roots[i]);
        const float point[3] = {1, 2, 3}, box[6] = {1, 2, 3, 4, 5, 6},
                    bounds[3][2] = {{0.5f, 0.5f}, {-INFINITY, INFINITY}, {3, 6}};
        float value, interval[2];
        GPU_TEST_TRY(hewn_code_eval_points(state->device, code, point, 1, &value, &error));
        GPU_TEST_TRY(hewn_code_eval_boxes(state->device, code, box, 1, interval, &error));
        assert_true(i == 1 ? isnan(value) : value == (i == 0 ? 0.5f : 3.0f));
        assert_true(interval[0] == bounds[i][0] && interval[1] == bounds[i][1]);
        hewn_code_destroy(state->device, &code);
    }
    hewn_field_destroy(&field);
}

static int open_device(void **test_state)
{
    static fixture state;
    const char *seed = getenv("HEWN_SEED");
    state.random = seed ? strtoull(seed, NULL, 16) : 0xc0ffee123u;
    state.device = gpu_test_open(&state.messages);
    *test_state = &state;
    return 0;
}

static int close_device(void **test_state)
{
    fixture *state = *test_state;
    gpu_test_close(&state->device, &state->messages);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(gradients_are_the_oracles),
        cmocka_unit_test(flavours_agree_bit_for_bit),
        cmocka_unit_test(a_changed_number_compiles_nothing),
        cmocka_unit_test(many_shapes_compile),
        cmocka_unit_test(parameters_may_outgrow_uniforms),
        cmocka_unit_test(prospero_compiles),
        cmocka_unit_test(batches_have_any_size),
        cmocka_unit_test(constants_and_variables_are_fields),
    };
    return cmocka_run_group_tests_name("code", tests, open_device, close_device);
}
