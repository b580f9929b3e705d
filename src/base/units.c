#include "hewn/units.h"

#include <string.h>

/* Their names in order are those of hewn_unit_names(). An inch is 25.4 mm and a foot 12 of them, exactly. */
static const hewn_unit units[] = {{"m", 1, 1},     {"cm", 1, 100},    {"mm", 1, 1000},  {"um", 1, 1000000},
                                  {"km", 1000, 1}, {"in", 127, 5000}, {"ft", 381, 1250}};

const hewn_unit *hewn_unit_at(size_t index)
{
    return index < sizeof units / sizeof *units ? &units[index] : NULL;
}

const hewn_unit *hewn_unit_find(const char *name)
{
    for (size_t i = 0; i < sizeof units / sizeof *units; i++)
        if (strcmp(units[i].name, name) == 0)
            return &units[i];
    return NULL;
}

double hewn_unit_metres(const hewn_unit *unit)
{
    return (double)unit->numerator / (double)unit->denominator;
}

const char *hewn_unit_names(void)
{
    return "m, cm, mm, um, km, in, ft";
}

static const char *const axes[] = {[HEWN_AXIS_PLUS_Y] = "+Y", [HEWN_AXIS_PLUS_Z] = "+Z", [HEWN_AXIS_PLUS_X] = "+X"};

const char *hewn_axis_name(hewn_axis axis)
{
    return (unsigned)axis < sizeof axes / sizeof *axes ? axes[axis] : "?";
}

bool hewn_axis_find(const char *name, hewn_axis *out)
{
    for (size_t i = 0; i < sizeof axes / sizeof *axes; i++)
        if (strcmp(axes[i], name) == 0) {
            *out = (hewn_axis)i;
            return true;
        }
    return false;
}
