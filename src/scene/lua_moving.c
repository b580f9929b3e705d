/* Moving, turning and scaling shapes. Angles are degrees here: what people write. */
#include <math.h>
#include <string.h>

#include "scene/lua_state.h"

static hewn_field *field_of(lua_State *L)
{
    return hewn_lua_of(L)->scene->field;
}

static int translate(lua_State *L)
{
    static const char name[] = "translate";
    hewn_lua_check_count(L, name, 4, 4);
    hewn_node shape = hewn_lua_field(L, 1, name);
    double x = hewn_lua_number(L, 2, name), y = hewn_lua_number(L, 3, name), z = hewn_lua_number(L, 4, name);
    return hewn_lua_push_field(L, hewn_translate(field_of(L), shape, x, y, z));
}

static int push_rotated(lua_State *L, hewn_node shape, const double *axis, double degrees)
{
    /* Whole turns are taken off in degrees, where that is exact. */
    double radians = fmod(degrees, 360.0) * (3.14159265358979323846 / 180.0);
    return hewn_lua_push_field(L, hewn_rotate(field_of(L), shape, axis[0], axis[1], axis[2], radians));
}

/* rotate(shape, "x" | "y" | "z", degrees) or rotate(shape, x, y, z, degrees) */
static int rotate(lua_State *L)
{
    static const char name[] = "rotate";
    int count = lua_gettop(L);
    double axis[3] = {0, 0, 0};
    if (count != 3 && count != 5)
        return luaL_error(L, "rotate takes a shape, an axis (\"x\", \"y\", \"z\" or three numbers) and degrees");
    hewn_node shape = hewn_lua_field(L, 1, name);
    if (count == 3) {
        const char *word = lua_type(L, 2) == LUA_TSTRING ? lua_tostring(L, 2) : "";
        if (strlen(word) != 1 || word[0] < 'x' || word[0] > 'z')
            return hewn_lua_argument_error(L, 2, name, "\"x\", \"y\" or \"z\"");
        axis[word[0] - 'x'] = 1;
    } else {
        for (int i = 0; i < 3; i++)
            axis[i] = hewn_lua_number(L, i + 2, name);
        if (axis[0] == 0 && axis[1] == 0 && axis[2] == 0)
            return luaL_error(L, "rotate: the axis must not be 0, 0, 0");
    }
    return push_rotated(L, shape, axis, hewn_lua_number(L, count, name));
}

static int rotate_about(lua_State *L, const char *name, int which)
{
    double axis[3] = {0, 0, 0};
    axis[which] = 1;
    hewn_lua_check_count(L, name, 2, 2);
    hewn_node shape = hewn_lua_field(L, 1, name);
    return push_rotated(L, shape, axis, hewn_lua_number(L, 2, name));
}

static int rotate_x(lua_State *L)
{
    return rotate_about(L, "rotate_x", 0);
}

static int rotate_y(lua_State *L)
{
    return rotate_about(L, "rotate_y", 1);
}

static int rotate_z(lua_State *L)
{
    return rotate_about(L, "rotate_z", 2);
}

/* scale(shape, factor) or scale(shape, x, y, z) */
static int scale(lua_State *L)
{
    static const char name[] = "scale";
    int count = lua_gettop(L);
    if (count != 2 && count != 4)
        return luaL_error(L, "scale takes a shape and 1 or 3 factors");
    hewn_node shape = hewn_lua_field(L, 1, name);
    double x = hewn_lua_positive(L, 2, name);
    if (count == 2)
        return hewn_lua_push_field(L, hewn_scale(field_of(L), shape, x));
    double y = hewn_lua_positive(L, 3, name), z = hewn_lua_positive(L, 4, name);
    return hewn_lua_push_field(L, hewn_stretch(field_of(L), shape, x, y, z));
}

static int remap(lua_State *L)
{
    static const char name[] = "remap";
    hewn_node axis[3];
    hewn_lua_check_count(L, name, 4, 4);
    hewn_node shape = hewn_lua_field(L, 1, name);
    for (int i = 0; i < 3; i++)
        axis[i] = hewn_lua_operand(L, i + 2, name);
    return hewn_lua_push_field(L, hewn_remap(field_of(L), shape, axis[0], axis[1], axis[2]));
}

void hewn_lua_open_moving(lua_State *L, int methods)
{
    static const luaL_Reg functions[] = {{"translate", translate}, {"move", translate},    {"rotate", rotate},
                                         {"rotate_x", rotate_x},   {"rotate_y", rotate_y}, {"rotate_z", rotate_z},
                                         {"scale", scale},         {"remap", remap},       {NULL, NULL}};
    for (const luaL_Reg *function = functions; function->name; function++)
        hewn_lua_add_function(L, methods, function->name, function->func);
}
