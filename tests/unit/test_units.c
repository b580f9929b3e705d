/* Units of length and axes. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "hewn/units.h"

/* Every unit is found by its name, stands in the list of names, and is as long as it is defined to be. */
static void test_units(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double metres;
    } known[] = {{"m", 1}, {"cm", 0.01}, {"mm", 0.001}, {"um", 1e-6}, {"km", 1000}, {"in", 0.0254}, {"ft", 0.3048}};
    char names[128] = "";
    size_t count = 0;
    for (const hewn_unit *unit; (unit = hewn_unit_at(count)) != NULL; count++) {
        assert_ptr_equal(hewn_unit_find(unit->name), unit);
        strcat(strcat(names, count > 0 ? ", " : ""), unit->name);
    }
    assert_int_equal(count, sizeof known / sizeof *known);
    assert_string_equal(names, hewn_unit_names());
    for (size_t i = 0; i < count; i++)
        assert_true(hewn_unit_metres(hewn_unit_find(known[i].name)) == known[i].metres);
    assert_null(hewn_unit_find("furlong"));
    assert_null(hewn_unit_find(""));
    assert_null(hewn_unit_find("MM"));
}

static void test_axes(void **state)
{
    (void)state;
    hewn_axis found = HEWN_AXIS_PLUS_Y;
    for (int axis = HEWN_AXIS_PLUS_Y; axis <= HEWN_AXIS_PLUS_X; axis++) {
        assert_true(hewn_axis_find(hewn_axis_name((hewn_axis)axis), &found));
        assert_int_equal(found, axis);
    }
    assert_false(hewn_axis_find("-Y", &found));
    assert_false(hewn_axis_find("", &found));
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_units), cmocka_unit_test(test_axes)};
    return cmocka_run_group_tests_name("units", tests, NULL, NULL);
}
