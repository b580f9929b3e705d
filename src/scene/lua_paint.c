/* color(shape, red, green, blue) and color(shape, "#rrggbb"). */
#include <ctype.h>
#include <string.h>

#include "scene/lua_state.h"

/* The two digits at `at` as a part of 1. */
static double byte_part(const char *at)
{
    double value = 0;
    for (int i = 0; i < 2; i++)
        value = 16 * value + (isdigit((unsigned char)at[i]) ? at[i] - '0' : tolower((unsigned char)at[i]) - 'a' + 10);
    return value / 255;
}

static int color(lua_State *L)
{
    static const char name[] = "color";
    double part[3];
    int count = lua_gettop(L);
    if (count != 2 && count != 4)
        return luaL_error(L, "color takes a shape and three numbers from 0 to 1, or a shape and \"#rrggbb\"");
    hewn_node shape = hewn_lua_field(L, 1, name);
    if (count == 2) {
        const char *text = hewn_lua_string(L, 2, name);
        if (text[0] != '#' || strlen(text) != 7 || strspn(text + 1, "0123456789abcdefABCDEF") != 6)
            return luaL_error(L, "color: '%s' is no colour: \"#rrggbb\" with digits of base 16 is one", text);
        for (int i = 0; i < 3; i++)
            part[i] = byte_part(text + 1 + 2 * i);
    } else {
        for (int i = 0; i < 3; i++)
            part[i] = hewn_lua_part(L, i + 2, name);
    }
    return hewn_lua_push_field(L, hewn_color(hewn_lua_of(L)->scene->field, shape, part[0], part[1], part[2]));
}

void hewn_lua_open_paint(lua_State *L, int methods)
{
    hewn_lua_add_function(L, methods, "color", color);
}
