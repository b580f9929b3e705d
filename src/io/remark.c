#include "io/remark.h"

#include <math.h>
#include <string.h>

#include "io/shim/number.h"

void hewn_remark_print(hewn_text *text, const hewn_unit *unit, const hewn_axis *up, const char *space)
{
    char metres[HEWN_NUMBER_ROOM] = "?";
    if (unit)
        *hewn_number_print_float(metres, (float)hewn_unit_metres(unit)) = '\0';
    hewn_text_print(text, "1 unit = %s m, %s up", metres, up ? hewn_axis_name(*up) : "?");
    if (space)
        hewn_text_print(text, ", SPACE=%s", space);
}

/* The units are far apart, so a length that was rounded still names one. */
static const hewn_unit *unit_of(double metres)
{
    const hewn_unit *unit;
    for (size_t i = 0; (unit = hewn_unit_at(i)); i++)
        if (fabs(metres - hewn_unit_metres(unit)) <= 1e-6 * hewn_unit_metres(unit))
            return unit;
    return NULL;
}

/* What stands after `word`, or NULL where that does not stand here. */
static const char *pass(const char *at, const char *end, const char *word)
{
    size_t length = strlen(word);
    return at && (size_t)(end - at) >= length && memcmp(at, word, length) == 0 ? at + length : NULL;
}

/* A length in metres, or "?". NULL where neither is there. */
static const char *read_unit(const char *at, const char *end, const hewn_unit **out)
{
    const char *unknown = pass(at, end, "?");
    double metres;
    *out = NULL;
    if (unknown)
        return unknown;
    at = hewn_number_parse_double(at, end, &metres);
    *out = at ? unit_of(metres) : NULL;
    return *out ? at : NULL;
}

static const char *read_axis(const char *at, const char *end, hewn_axis *out, bool *known)
{
    const hewn_axis axes[] = {HEWN_AXIS_PLUS_X, HEWN_AXIS_PLUS_Y, HEWN_AXIS_PLUS_Z};
    *known = false;
    for (size_t i = 0; i < sizeof axes / sizeof *axes; i++)
        if (pass(at, end, hewn_axis_name(axes[i]))) {
            *known = true;
            *out = axes[i];
            return at + 2;
        }
    return pass(at, end, "?");
}

void hewn_remark_read(const char *begin, const char *end, hewn_model *model)
{
    static const char before[] = "1 unit = ";
    const char *at = memmem(begin, (size_t)(end - begin), before, sizeof before - 1);
    if (!at || model->unit)
        return;
    const hewn_unit *unit;
    hewn_axis up = HEWN_AXIS_PLUS_Y;
    bool up_known = false;
    at = read_unit(at + sizeof before - 1, end, &unit);
    at = pass(at, end, " m, ");
    at = at ? read_axis(at, end, &up, &up_known) : NULL;
    if (!pass(at, end, " up"))
        return;
    model->unit = unit;
    model->up = up;
    model->up_known = up_known;
}
