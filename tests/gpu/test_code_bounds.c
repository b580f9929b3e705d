/* Intervals on the GPU contain what the GPU itself computes inside them, and are not much wider than the oracle's. */
#include "test_code_support.h"

typedef struct fixture {
    hewn_device *device;
    unsigned messages;
    uint64_t random;
} fixture;

enum { INSIDE = 16 /* points a box */ };

/* --- boxes ------------------------------------------------------------------------------------------------------- */

/* One side of a box of some kind: a point, small, large, huge, around zero, endless, narrow, or with awkward ends. */
static void make_side(uint64_t *random, uint32_t kind, float *lo, float *hi)
{
    float a = (float)code_between(random, -3, 3), b = (float)code_between(random, -3, 3);
    switch (kind) {
    case 0: b = a; break;
    case 1: b = a + (float)code_between(random, 0, 0.05); break;
    case 2: break;
    case 3:
        a = code_any_size(random, 1e-3, 1e3);
        b = code_any_size(random, 1e-3, 1e3);
        break;
    case 4:
        a = code_any_size(random, 1e-44, 3e38);
        b = code_any_size(random, 1e-44, 3e38);
        break;
    case 5:
        a = code_awkward_at(gpu_test_random(random) % CODE_AWKWARD);
        b = code_awkward_at(gpu_test_random(random) % CODE_AWKWARD);
        break;
    default: a = 0; b = code_any_size(random, 1e-6, 10);
    }
    a = isnan(a) ? 0 : a;
    b = isnan(b) ? 1 : b;
    *lo = fminf(a, b);
    *hi = fmaxf(a, b);
}

static float within(uint64_t *random, float lo, float hi)
{
    if (isinf(lo) && isinf(hi))
        return lo == hi ? lo : code_any_size(random, 1e-40, 3e38);
    if (isinf(lo) || isinf(hi)) {
        float step = fabsf(code_any_size(random, 1e-10, 1e38));
        return isinf(lo) ? hi - step : lo + step;
    }
    float value = (float)code_between(random, (double)lo, (double)hi);
    return fminf(fmaxf(value, lo), hi);
}

/* Boxes as lo x, y, z, hi x, y, z, and for each its corners and points inside. */
static void make_boxes(uint64_t *random, bool moderate, size_t count, float *boxes, float *points)
{
    for (size_t i = 0; i < count; i++) {
        float *box = boxes + 6 * i, *point = points + 3 * INSIDE * i;
        for (int k = 0; k < 3; k++)
            make_side(random, moderate ? gpu_test_random(random) % 3 : gpu_test_random(random) % 8, box + k,
                      box + 3 + k);
        for (int p = 0; p < INSIDE; p++)
            for (int k = 0; k < 3; k++)
                point[3 * p + k] = p < 8 ? box[(p >> k & 1) * 3 + k] : within(random, box[k], box[3 + k]);
    }
}

/* --- containment ------------------------------------------------------------------------------------------------- */

/* Devices may take a denormal for zero wherever one turns up. */
static float flushed(float a)
{
    return code_is_denormal(a) ? 0 : a;
}

static bool contains(const float *interval, float value)
{
    if (isnan(interval[0]) || isnan(interval[1]))
        return false;
    if (isnan(value))
        return isinf(interval[0]) && isinf(interval[1]) && interval[0] < 0 && interval[1] > 0;
    return flushed(interval[0]) <= flushed(value) && flushed(value) <= flushed(interval[1]);
}

static size_t count_misses(const char *name, size_t count, const float *boxes, const float *points,
                           const float *intervals, const float *values)
{
    size_t misses = 0;
    for (size_t i = 0; i < count * INSIDE; i++) {
        const float *box = boxes + 6 * (i / INSIDE), *bounds = intervals + 2 * (i / INSIDE), *p = points + 3 * i;
        if (!contains(bounds, values[i]) && misses++ < 4)
            print_error("# %s: [%.9g, %.9g] x [%.9g, %.9g] x [%.9g, %.9g] gave [%.9g, %.9g], but (%.9g, %.9g, %.9g) "
                        "gives %.9g\n",
                        name, (double)box[0], (double)box[3], (double)box[1], (double)box[4], (double)box[2],
                        (double)box[5], (double)bounds[0], (double)bounds[1], (double)p[0], (double)p[1], (double)p[2],
                        (double)values[i]);
    }
    return misses;
}

typedef struct box_trial {
    size_t count;
    float *boxes, *points, *intervals, *values;
} box_trial;

static box_trial run_trial(fixture *state, const hewn_code *code, bool moderate, size_t count)
{
    box_trial trial = {.count = count,
                       .boxes = hewn_alloc(count * 6, sizeof(float)),
                       .points = hewn_alloc(count * INSIDE * 3, sizeof(float)),
                       .intervals = hewn_alloc(count * 2, sizeof(float)),
                       .values = hewn_alloc(count * INSIDE, sizeof(float))};
    assert_true(trial.boxes && trial.points && trial.intervals && trial.values);
    make_boxes(&state->random, moderate, count, trial.boxes, trial.points);
    GPU_TEST_TRY(hewn_code_eval_boxes(state->device, code, trial.boxes, count, trial.intervals, &error));
    GPU_TEST_TRY(hewn_code_eval_points(state->device, code, trial.points, count * INSIDE, trial.values, &error));
    return trial;
}

static void free_trial(box_trial *trial)
{
    hewn_free(trial->boxes);
    hewn_free(trial->points);
    hewn_free(trial->intervals);
    hewn_free(trial->values);
}

static size_t check_containment(fixture *state, const char *name, const hewn_code *code, size_t count)
{
    box_trial trial = run_trial(state, code, false, count);
    size_t misses = count_misses(name, count, trial.boxes, trial.points, trial.intervals, trial.values);
    free_trial(&trial);
    return misses;
}

static void intervals_contain_values(void **test_state)
{
    fixture *state = *test_state;
    size_t misses = 0, count = gpu_test_long() ? 200000 : 20000;
    for (int op = 0; op < HEWN_OP_COUNT; op++) {
        if (hewn_op_is_link((hewn_op)op))
            continue;
        double parameters[HEWN_MAX_PARAMETERS];
        hewn_node root;
        code_parameters((hewn_op)op, &state->random, parameters);
        hewn_field *field = code_one_op((hewn_op)op, parameters, &root);
        hewn_code *code = code_of(state->device, field, root);
        misses += check_containment(state, hewn_op_infos[op].name, code, count);
        hewn_code_destroy(state->device, &code);
        hewn_field_destroy(&field);
    }
    assert_int_equal(misses, 0);
}

/* Operations on a constant have code of their own. */
static void intervals_with_constants_contain_values(void **test_state)
{
    static const hewn_op ops[] = {HEWN_OP_ADD, HEWN_OP_SUB, HEWN_OP_MUL,   HEWN_OP_DIV,    HEWN_OP_MIN,
                                  HEWN_OP_MAX, HEWN_OP_MOD, HEWN_OP_ATAN2, HEWN_OP_COMPARE};
    static const double constants[] = {0.7, -1.3, 0, 1e30, -1e-38, NAN};
    fixture *state = *test_state;
    size_t misses = 0;
    for (size_t i = 0; i < sizeof ops / sizeof *ops; i++)
        for (size_t k = 0; k < 2 * sizeof constants / sizeof *constants; k++) {
            hewn_field *field;
            GPU_TEST_TRY(hewn_field_create(&field, &error));
            hewn_node number = hewn_constant(field, constants[k / 2]);
            const uint32_t operands[2] = {k % 2 ? hewn_y(field).id : number.id, k % 2 ? number.id : hewn_y(field).id};
            hewn_node root = code_node(field, ops[i], operands, NULL);
            hewn_code *code = code_of(state->device, field, root);
            misses += check_containment(state, hewn_op_infos[ops[i]].name, code, 2000);
            hewn_code_destroy(state->device, &code);
            hewn_field_destroy(&field);
        }
    assert_int_equal(misses, 0);
}

/* NaN that arises below must not get lost in what bounds its operands. */
static void what_may_be_nan_stays_unknown(void **test_state)
{
    static const hewn_op ops[] = {HEWN_OP_SQRT, HEWN_OP_LN,  HEWN_OP_ASIN, HEWN_OP_ACOS,
                                  HEWN_OP_TAN,  HEWN_OP_DIV, HEWN_OP_MOD,  HEWN_OP_EXP};
    fixture *state = *test_state;
    size_t misses = 0;
    for (size_t i = 0; i < 2 * sizeof ops / sizeof *ops; i++) {
        hewn_field *field;
        GPU_TEST_TRY(hewn_field_create(&field, &error));
        hewn_node x = hewn_x(field), y = hewn_y(field), z = hewn_z(field);
        const uint32_t operands[2] = {hewn_mul(field, x, z).id, y.id};
        hewn_node inner = code_node(field, ops[i / 2], operands, NULL);
        hewn_node root =
            i % 2 ? hewn_min(field, hewn_square(field, inner), z)
                  : hewn_compare(field, hewn_smooth_union(field, hewn_atan(field, inner), y, HEWN_BLEND_QUADRATIC, 0.5),
                                 z);
        hewn_code *code = code_of(state->device, field, root);
        misses += check_containment(state, hewn_op_infos[ops[i / 2]].name, code, 4000);
        hewn_code_destroy(state->device, &code);
        hewn_field_destroy(&field);
    }
    assert_int_equal(misses, 0);
}

static void intervals_of_graphs_contain_values(void **test_state)
{
    fixture *state = *test_state;
    size_t misses = 0;
    for (int i = 0; i < (gpu_test_long() ? 300 : 16); i++) {
        uint64_t seed = state->random;
        hewn_node root;
        char name[64];
        snprintf(name, sizeof name, "graph of seed %llx", (unsigned long long)seed);
        hewn_field *field = code_random_graph(&state->random, (size_t)(8 + 12 * (i % 16 + 1)), &root);
        hewn_code *code = code_of(state->device, field, root);
        misses += check_containment(state, name, code, 2000);
        hewn_code_destroy(state->device, &code);
        hewn_field_destroy(&field);
    }
    assert_int_equal(misses, 0);
}

/* --- tightness --------------------------------------------------------------------------------------------------- */

/* How far an interval may go past the exact one, over the size of what it is made of. */
static double slack_of(hewn_op op)
{
    switch (op) {
    case HEWN_OP_CONE: return 2e-5;
    case HEWN_OP_TAN: return 1e-5;
    case HEWN_OP_NOISE_SIMPLEX: return 3e-4;
    case HEWN_OP_ZIGZAG: return 2e-5;
    default: return 6e-6;
    }
}

/* How much of the boxes have intervals wider than the oracle's by more than rounding. */
static size_t count_loose(const hewn_field *field, hewn_node root, const box_trial *trial, double slack,
                          const char *name)
{
    size_t loose = 0;
    for (size_t i = 0; i < trial->count; i++) {
        const float *b = trial->boxes + 6 * i, *got = trial->intervals + 2 * i;
        hewn_box box;
        hewn_interval best;
        for (int k = 0; k < 3; k++) {
            box.lo[k] = (double)b[k];
            box.hi[k] = (double)b[3 + k];
        }
        GPU_TEST_TRY(hewn_field_bound(field, root, &box, &best, &error));
        if (best.maybe_nan)
            continue;
        bool fits = (double)got[0] >= best.lo - slack * (4 + fabs(best.lo)) &&
                    (double)got[1] <= best.hi + slack * (4 + fabs(best.hi));
        if (!fits && loose++ < 2)
            print_message("# %s: [%.9g, %.9g] x [%.9g, %.9g] x [%.9g, %.9g]: [%.9g, %.9g] against [%.9g, %.9g]\n", name,
                          (double)b[0], (double)b[3], (double)b[1], (double)b[4], (double)b[2], (double)b[5],
                          (double)got[0], (double)got[1], best.lo, best.hi);
    }
    return loose;
}

static void intervals_are_tight(void **test_state)
{
    fixture *state = *test_state;
    for (int op = 0; op < HEWN_OP_COUNT; op++) {
        if (hewn_op_is_link((hewn_op)op))
            continue;
        double parameters[HEWN_MAX_PARAMETERS];
        hewn_node root;
        code_parameters((hewn_op)op, &state->random, parameters);
        hewn_field *field = code_one_op((hewn_op)op, parameters, &root);
        hewn_code *code = code_of(state->device, field, root);
        box_trial trial = run_trial(state, code, true, 4000);
        size_t loose = count_loose(field, root, &trial, slack_of((hewn_op)op), hewn_op_infos[op].name);
        free_trial(&trial);
        hewn_code_destroy(state->device, &code);
        hewn_field_destroy(&field);
        /* at poles and steps the two may decide differently about a box whose end is just there */
        if (loose > 4000 / 100)
            fail_msg("%s: %zu of 4000 intervals are loose", hewn_op_infos[op].name, loose);
    }
}

static int open_device(void **test_state)
{
    static fixture state;
    const char *seed = getenv("HEWN_SEED");
    state.random = seed ? strtoull(seed, NULL, 16) : 0xfeedc0de12345u;
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
        cmocka_unit_test(intervals_contain_values),      cmocka_unit_test(intervals_with_constants_contain_values),
        cmocka_unit_test(what_may_be_nan_stays_unknown), cmocka_unit_test(intervals_of_graphs_contain_values),
        cmocka_unit_test(intervals_are_tight),
    };
    return cmocka_run_group_tests_name("code_bounds", tests, open_device, close_device);
}
