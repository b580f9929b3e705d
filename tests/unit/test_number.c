/* Numbers in text: what is read is the nearest, what is written reads back and is as short as can be. */
#include "io/shim/number.h"
#include "test_mesh_support.h"

static void assert_number(const char *text, float single, double exact)
{
    float as_float = 1;
    double as_double = 1;
    const char *end = text + strlen(text);
    assert_ptr_equal(hewn_number_parse_float(text, end, &as_float), end);
    assert_ptr_equal(hewn_number_parse_double(text, end, &as_double), end);
    assert_memory_equal(&as_float, &single, sizeof single);
    assert_memory_equal(&as_double, &exact, sizeof exact);
}

static void test_reading(void **state)
{
    (void)state;
    assert_number("+1.5e+2", 150, 150);
    assert_number("-.5", -0.5f, -0.5);
    assert_number("1.", 1, 1);
    assert_number("-0", -0.0f, -0.0);
    assert_number("1e-46", 0, 1e-46);
    assert_number("-1e-400", -0.0f, -0.0);
    assert_number("0.00000000000000000000000000000000000000000000000000001", 0, 1e-53);
    assert_number("1e39", INFINITY, 1e39);
    assert_number("1e309", INFINITY, (double)INFINITY);
    assert_number("-1e99999999999999999999", -INFINITY, (double)-INFINITY);
    assert_number("1e-99999999999999999999", 0, 0);
    assert_number("16777217.0000001", 16777218, 16777217.0000001); /* the float through a double would be 16777216 */
    assert_number("9007199254740993.0000000000000000000001", 9007199254740992, 9007199254740994);
    static const char *const wrong[] = {"", "+", "-", "+-1", "++1", ".", "e5", "x"};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        float single;
        double exact;
        assert_null(hewn_number_parse_float(wrong[i], wrong[i] + strlen(wrong[i]), &single));
        assert_null(hewn_number_parse_double(wrong[i], wrong[i] + strlen(wrong[i]), &exact));
    }
    int64_t whole;
    static const char large[] = "9223372036854775808";
    assert_null(hewn_number_parse_integer(large, large + strlen(large), &whole));
}

/* The fewest digits with which the C library's printing reads back. */
static int digits_needed(double value, bool as_float)
{
    char text[64];
    for (int digits = 1;; digits++) {
        snprintf(text, sizeof text, "%.*e", digits - 1, value);
        if (as_float ? strtof(text, NULL) == (float)value : strtod(text, NULL) == value)
            return digits;
    }
}

static int digits_in(const char *text)
{
    int count = 0, zeroes = 0;
    for (; *text && *text != 'e'; text++) {
        if (*text < '0' || *text > '9' || (*text == '0' && count == 0))
            continue;
        zeroes = *text == '0' ? zeroes + 1 : 0;
        count++;
    }
    return count - zeroes; /* those at the end only hold the place */
}

static void check_double(double value)
{
    char text[HEWN_NUMBER_ROOM + 1];
    double again = 0;
    char *end = hewn_number_print_double(text, value);
    assert_true(end - text < HEWN_NUMBER_ROOM);
    *end = '\0';
    assert_ptr_equal(hewn_number_parse_double(text, end, &again), end);
    assert_memory_equal(&again, &value, sizeof value);
    if (value != 0 && fabs(value) < 1e15 && digits_in(text) > digits_needed(value, false))
        fail_msg("%s is longer than it need be", text);
}

static void check_float(float value)
{
    char text[HEWN_NUMBER_ROOM + 1];
    float again = 0;
    char *end = hewn_number_print_float(text, value);
    assert_true(end - text < HEWN_NUMBER_ROOM);
    *end = '\0';
    assert_ptr_equal(hewn_number_parse_float(text, end, &again), end);
    assert_memory_equal(&again, &value, sizeof value);
    if (value != 0 && fabsf(value) < 1e6f && digits_in(text) > digits_needed((double)value, true))
        fail_msg("%s is longer than it need be", text);
}

static void test_writing(void **state)
{
    (void)state;
    random_state random = {3};
    static const double awkward[] = {0,
                                     -0.0,
                                     1,
                                     -1,
                                     0.1,
                                     1e22,
                                     1e23,
                                     5e-324,
                                     2.2250738585072014e-308,
                                     1.7976931348623157e308,
                                     9007199254740994.0,
                                     0.3,
                                     123456789.125,
                                     -2.2250738585072011e-308};
    for (size_t i = 0; i < sizeof awkward / sizeof *awkward; i++)
        check_double(awkward[i]);
    int rounds = getenv("HEWN_LONG") ? 2000000 : 20000;
    for (int i = 0; i < rounds; i++) {
        uint64_t bits = random_bits(&random);
        double value;
        memcpy(&value, &bits, sizeof value);
        if (isfinite(value))
            check_double(value);
        check_double(floor(random_unit(&random) * 1e6) / 1e3);
        check_float(random_float(&random));
        check_float((float)floor(random_unit(&random) * 1e6) / 1e3f);
    }
}

/* Any digits, point and exponent, against the C library's reading, which rounds once. */
static void test_reading_against_the_c_library(void **state)
{
    (void)state;
    random_state random = {4};
    int rounds = getenv("HEWN_LONG") ? 5000000 : 100000;
    for (int i = 0; i < rounds; i++) {
        char text[64], *to = text;
        if (random_below(&random, 2))
            *to++ = '-';
        uint32_t digits = 1 + random_below(&random, 22), point = random_below(&random, digits + 8);
        for (uint32_t k = 0; k < digits; k++) {
            if (k == point)
                *to++ = '.';
            *to++ = (char)('0' + (random_below(&random, 5) ? random_below(&random, 10) : 0));
        }
        if (random_below(&random, 4) == 0)
            to += sprintf(to, "e%d", (int)random_below(&random, 90) - 45);
        *to = '\0';
        assert_number(text, strtof(text, NULL), strtod(text, NULL));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_reading),
        cmocka_unit_test(test_reading_against_the_c_library),
        cmocka_unit_test(test_writing),
    };
    return cmocka_run_group_tests_name("number", tests, NULL, NULL);
}
