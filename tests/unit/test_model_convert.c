/* Units and axes of models: exact fractions, quarter turns, and bits that stay where nothing is to be done. */
#include "test_model_support.h"

static const hewn_axis axes[] = {HEWN_AXIS_PLUS_Y, HEWN_AXIS_PLUS_Z, HEWN_AXIS_PLUS_X};

static hewn_model random_model(random_state *random, uint64_t vertices)
{
    hewn_model model = make_model(vertices, 1, 3, false);
    for (uint64_t i = 0; i < 3 * vertices; i++)
        model.positions[i] = (random_unit(random) - 0.5) * exp2(40 * random_unit(random) - 20);
    model.corners[1] = 1;
    model.corners[2] = 2;
    model.up_known = true;
    return model;
}

static double *copy_positions(const hewn_model *model)
{
    double *copy = hewn_alloc(model->vertex_count, 3 * sizeof *copy);
    assert_non_null(copy);
    memcpy(copy, model->positions, model->vertex_count * 3 * sizeof *copy);
    return copy;
}

static bool same_bits(const hewn_model *model, const double *positions)
{
    return memcmp(model->positions, positions, model->vertex_count * 3 * sizeof *positions) == 0;
}

static void convert(hewn_model *model, const hewn_unit *unit, const hewn_axis *up, hewn_conversion *record)
{
    hewn_error error = {0};
    if (hewn_model_convert(model, unit, up, record, &error) != HEWN_OK)
        fail_msg("%s", error.message);
}

static uint64_t common_factor(uint64_t a, uint64_t b)
{
    return b == 0 ? a : common_factor(b, a % b);
}

/* For every pair: the fraction is the units' quotient in lowest terms, positions are p × numerator ÷ denominator, and
 * the way back ends within two roundings of where it began. */
static void test_units(void **state)
{
    (void)state;
    random_state random = {1};
    const hewn_unit *before, *after;
    for (size_t i = 0; (before = hewn_unit_at(i)) != NULL; i++)
        for (size_t j = 0; (after = hewn_unit_at(j)) != NULL; j++) {
            hewn_model model = random_model(&random, 50);
            double *old = copy_positions(&model);
            hewn_conversion record;
            model.unit = before;
            convert(&model, after, NULL, &record);
            assert_ptr_equal(record.unit_before, before);
            assert_ptr_equal(record.unit_after, after);
            assert_ptr_equal(model.unit, after);
            assert_false(record.unit_assumed);
            uint64_t a = record.scale_numerator, b = record.scale_denominator;
            assert_int_equal(common_factor(a, b), 1);
            assert_true(a * before->denominator * after->numerator == b * before->numerator * after->denominator);
            for (uint64_t k = 0; k < 3 * model.vertex_count; k++)
                assert_true(model.positions[k] == old[k] * (double)a / (double)b);
            convert(&model, before, NULL, NULL);
            for (uint64_t k = 0; k < 3 * model.vertex_count; k++)
                assert_true(fabs(model.positions[k] - old[k]) <= 4 * 0x1p-53 * fabs(old[k]));
            hewn_free(old);
            hewn_model_destroy(&model);
        }
}

static void test_known_scales(void **state)
{
    (void)state;
    static const struct {
        const char *from, *to;
        double value, becomes;
        uint64_t numerator, denominator;
    } known[] = {
        {"in", "mm", 1, 25.4, 127, 5},       {"ft", "in", 2.5, 30, 12, 1},        {"mm", "m", 1, 0.001, 1, 1000},
        {"km", "um", 3, 3e9, 1000000000, 1}, {"um", "km", 5e9, 5, 1, 1000000000}, {"cm", "in", 127, 50, 50, 127},
    };
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        hewn_model model = make_model(1, 0, 0, false);
        hewn_conversion record;
        model.positions[0] = known[i].value;
        model.unit = hewn_unit_find(known[i].from);
        convert(&model, hewn_unit_find(known[i].to), NULL, &record);
        assert_true(model.positions[0] == known[i].becomes);
        assert_int_equal(record.scale_numerator, known[i].numerator);
        assert_int_equal(record.scale_denominator, known[i].denominator);
        hewn_model_destroy(&model);
    }
}

static void up_vector(hewn_axis axis, double out[3])
{
    out[0] = axis == HEWN_AXIS_PLUS_X;
    out[1] = axis == HEWN_AXIS_PLUS_Y;
    out[2] = axis == HEWN_AXIS_PLUS_Z;
}

static void apply(const int8_t rotation[9], const double in[3], double out[3])
{
    for (int row = 0; row < 3; row++)
        out[row] = rotation[3 * row] * in[0] + rotation[3 * row + 1] * in[1] + rotation[3 * row + 2] * in[2];
}

static int determinant(const int8_t m[9])
{
    return m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) + m[2] * (m[3] * m[7] - m[4] * m[6]);
}

/* Every turn is a rotation that takes one up axis to the other; there and back restores every bit. */
static void test_axes(void **state)
{
    (void)state;
    random_state random = {2};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            hewn_model model = random_model(&random, 50);
            double *old = copy_positions(&model), up[3], expected[3], got[3];
            hewn_conversion record;
            model.up = axes[i];
            convert(&model, NULL, &axes[j], &record);
            assert_int_equal(record.up_before, axes[i]);
            assert_int_equal(record.up_after, axes[j]);
            assert_int_equal(model.up, axes[j]);
            assert_int_equal(determinant(record.rotation), 1);
            up_vector(axes[i], up);
            up_vector(axes[j], expected);
            apply(record.rotation, up, got);
            assert_memory_equal(got, expected, sizeof got);
            for (uint64_t v = 0; v < model.vertex_count; v++) {
                apply(record.rotation, old + 3 * v, got);
                assert_memory_equal(got, model.positions + 3 * v, sizeof got);
            }
            convert(&model, NULL, &axes[i], NULL);
            assert_true(same_bits(&model, old));
            hewn_free(old);
            hewn_model_destroy(&model);
        }
}

/* What glTF's writer does to a model that has +Z up, and by way of the third axis it comes to the same. */
static void test_axes_agree(void **state)
{
    (void)state;
    hewn_axis y = HEWN_AXIS_PLUS_Y, x = HEWN_AXIS_PLUS_X;
    for (int around = 0; around < 2; around++) {
        hewn_model model = make_model(1, 0, 0, false);
        model.positions[0] = 1;
        model.positions[1] = 2;
        model.positions[2] = 3;
        model.up = HEWN_AXIS_PLUS_Z;
        model.up_known = true;
        if (around)
            convert(&model, NULL, &x, NULL);
        convert(&model, NULL, &y, NULL);
        assert_true(model.positions[0] == 1 && model.positions[1] == 3 && model.positions[2] == -2);
        hewn_model_destroy(&model);
    }
}

static void test_nothing_to_do(void **state)
{
    (void)state;
    static const double odd[] = {-0.0, 5e-324, 0.1, -1.7976931348623157e308, 3.0, 1e-300, 1, 2, 3};
    hewn_model model = make_model(3, 0, 0, false);
    memcpy(model.positions, odd, sizeof odd);
    model.unit = hewn_unit_find("in");
    model.up = HEWN_AXIS_PLUS_X;
    model.up_known = true;
    hewn_conversion record;
    convert(&model, hewn_unit_find("in"), &axes[2], &record);
    assert_true(same_bits(&model, odd));
    assert_int_equal(record.scale_numerator, 1);
    assert_int_equal(record.scale_denominator, 1);
    convert(&model, NULL, NULL, &record);
    assert_true(same_bits(&model, odd));
    assert_ptr_equal(record.unit_after, hewn_unit_find("in"));
    assert_int_equal(record.up_after, HEWN_AXIS_PLUS_X);
    hewn_model_destroy(&model);
}

/* What nobody said is taken for what is wanted, and then known. */
static void test_assumed(void **state)
{
    (void)state;
    random_state random = {3};
    hewn_model model = random_model(&random, 9);
    double *old = copy_positions(&model);
    hewn_conversion record;
    model.up_known = false;
    convert(&model, hewn_unit_find("mm"), &axes[1], &record);
    assert_true(record.unit_assumed && record.up_assumed);
    assert_null(record.unit_before);
    assert_int_equal(record.up_before, HEWN_AXIS_PLUS_Z);
    assert_true(same_bits(&model, old));
    assert_ptr_equal(model.unit, hewn_unit_find("mm"));
    assert_true(model.up_known && model.up == HEWN_AXIS_PLUS_Z);
    convert(&model, hewn_unit_find("m"), &axes[0], &record);
    assert_false(record.unit_assumed || record.up_assumed);
    assert_false(same_bits(&model, old));
    hewn_free(old);
    hewn_model_destroy(&model);
}

static void test_directions(void **state)
{
    (void)state;
    static const double given[] = {1, 2, 3, -1}, turned[] = {1, 3, -2, -1};
    static const struct {
        const char *name;
        uint32_t components;
        bool turns;
    } kinds[] = {{"normal", 3, true},  {"tangent", 4, true}, {"tangent", 3, true},
                 {"normal", 4, false}, {"color", 3, false},  {"velocity", 3, false}};
    for (size_t kind = 0; kind < sizeof kinds / sizeof *kinds; kind++)
        for (int domain = 0; domain < 3; domain++)
            for (int wide = 0; wide < 2; wide++) {
                hewn_model model = make_model(3, 1, 3, false);
                model.up = HEWN_AXIS_PLUS_Z;
                model.up_known = true;
                uint32_t components = kinds[kind].components;
                hewn_channel *channel = add_channel(&model, kinds[kind].name, (hewn_domain)domain,
                                                    wide ? HEWN_SCALAR_DOUBLE : HEWN_SCALAR_FLOAT, components);
                uint64_t last = (domain == HEWN_DOMAIN_FACE ? 0 : 2) * (uint64_t)components;
                for (uint32_t k = 0; k < components; k++) {
                    if (wide)
                        ((double *)channel->values)[last + k] = given[k];
                    else
                        ((float *)channel->values)[last + k] = (float)given[k];
                }
                convert(&model, NULL, &axes[0], NULL);
                for (uint32_t k = 0; k < components; k++) {
                    double got =
                        wide ? ((double *)channel->values)[last + k] : (double)((float *)channel->values)[last + k];
                    assert_true(got == (kinds[kind].turns ? turned : given)[k]);
                }
                hewn_model_destroy(&model);
            }
}

static void test_refused(void **state)
{
    (void)state;
    random_state random = {4};
    hewn_model model = random_model(&random, 9);
    model.positions[20] = 1e302;
    model.unit = hewn_unit_find("km");
    double *old = copy_positions(&model);
    hewn_conversion record;
    hewn_error error = {0};
    assert_int_equal(hewn_model_convert(&model, hewn_unit_find("um"), &axes[2], &record, &error), HEWN_LIMIT);
    assert_non_null(strstr(error.message, "vertex 6"));
    assert_true(same_bits(&model, old));
    assert_string_equal(model.unit->name, "km");
    assert_int_equal(model.up, HEWN_AXIS_PLUS_Y);
    hewn_axis none = (hewn_axis)9;
    hewn_unit flat = {"flat", 0, 1};
    assert_int_equal(hewn_model_convert(&model, NULL, &none, NULL, &error), HEWN_INVALID_ARGUMENT);
    assert_int_equal(hewn_model_convert(&model, &flat, NULL, NULL, &error), HEWN_INVALID_ARGUMENT);
    assert_true(same_bits(&model, old));
    hewn_free(old);
    hewn_model_destroy(&model);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_units),      cmocka_unit_test(test_known_scales),  cmocka_unit_test(test_axes),
        cmocka_unit_test(test_axes_agree), cmocka_unit_test(test_nothing_to_do), cmocka_unit_test(test_assumed),
        cmocka_unit_test(test_directions), cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests_name("model_convert", tests, NULL, NULL);
}
