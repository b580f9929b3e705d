#include <string.h>

#include "hewn/extract.h"

static const struct {
    const char *name;
    bool dual;
} methods[] = {
    [HEWN_METHOD_MARCHING_CUBES] = {"mc", false},
    [HEWN_METHOD_MC33] = {"mc33", false},
    [HEWN_METHOD_NETS] = {"nets", true},
    [HEWN_METHOD_DC] = {"dc", true},
};
#define METHOD_COUNT (sizeof methods / sizeof *methods)

/* The place in the list; METHOD_COUNT past its end. */
static size_t place_of(hewn_method method)
{
    size_t place = method == HEWN_METHOD_DEFAULT ? HEWN_METHOD_DC : (size_t)method;
    return place < METHOD_COUNT ? place : METHOD_COUNT;
}

const char *hewn_method_name(hewn_method method)
{
    size_t place = place_of(method);
    return place < METHOD_COUNT ? methods[place].name : NULL;
}

bool hewn_method_named(const char *name, hewn_method *out)
{
    for (size_t i = HEWN_METHOD_DEFAULT + 1; i < METHOD_COUNT; i++)
        if (strcmp(methods[i].name, name) == 0) {
            *out = (hewn_method)i;
            return true;
        }
    return false;
}

bool hewn_method_is_dual(hewn_method method)
{
    size_t place = place_of(method);
    return place < METHOD_COUNT && methods[place].dual;
}
