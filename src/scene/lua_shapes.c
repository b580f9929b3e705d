/* Shapes whose arguments depend on each other or may be left out; the others are read by the catalogue. Each checks its
 * measures itself, so that the message says which argument is wrong. */
#include <math.h>

#include "scene/lua_state.h"

static hewn_field *field_of(lua_State *L)
{
    return hewn_lua_of(L)->scene->field;
}

static double at_least_zero(lua_State *L, int argument, const char *name)
{
    double value = hewn_lua_number(L, argument, name);
    if (value < 0)
        hewn_lua_argument_error(L, argument, name, "a number of at least 0");
    return value;
}

static int box(lua_State *L)
{
    int count = lua_gettop(L);
    if (count != 1 && count != 3)
        return luaL_error(L, "box takes 1 or 3 arguments, not %d", count);
    double size[3];
    for (int i = 0; i < 3; i++)
        size[i] = hewn_lua_positive(L, count == 1 ? 1 : i + 1, "box");
    return hewn_lua_push_field(L, hewn_box_shape(field_of(L), size[0], size[1], size[2]));
}

static int rounded_box(lua_State *L)
{
    static const char name[] = "rounded_box";
    double size[3];
    hewn_lua_check_count(L, name, 4, 4);
    for (int i = 0; i < 3; i++)
        size[i] = hewn_lua_positive(L, i + 1, name);
    double radius = at_least_zero(L, 4, name);
    double most = 0.5 * fmin(size[0], fmin(size[1], size[2]));
    if (radius > most)
        return luaL_error(L, "%s: argument 4, the radius, is %f; half of the least size, %f, is the most", name, radius,
                          most);
    return hewn_lua_push_field(L, hewn_rounded_box(field_of(L), size[0], size[1], size[2], radius));
}

static int cone(lua_State *L)
{
    hewn_lua_check_count(L, "cone", 3, 3);
    double bottom = at_least_zero(L, 1, "cone"), top = at_least_zero(L, 2, "cone");
    double height = hewn_lua_positive(L, 3, "cone");
    if (bottom == 0 && top == 0)
        return luaL_error(L, "cone: one of the two radii must be above 0");
    return hewn_lua_push_field(L, hewn_cone(field_of(L), bottom, top, height));
}

static int push_plane(lua_State *L, const char *name)
{
    double value[4];
    hewn_lua_check_count(L, name, 4, 4);
    for (int i = 0; i < 4; i++)
        value[i] = hewn_lua_number(L, i + 1, name);
    if (value[0] == 0 && value[1] == 0 && value[2] == 0)
        return luaL_error(L, "%s: the normal must not be 0, 0, 0", name);
    return hewn_lua_push_field(L, hewn_plane(field_of(L), value[0], value[1], value[2], value[3]));
}

static int plane(lua_State *L)
{
    return push_plane(L, "plane");
}

static int half_space(lua_State *L)
{
    return push_plane(L, "half_space");
}

void hewn_lua_open_shapes(lua_State *L)
{
    static const luaL_Reg shapes[] = {{"box", box},     {"rounded_box", rounded_box}, {"cone", cone},
                                      {"plane", plane}, {"half_space", half_space},   {NULL, NULL}};
    for (const luaL_Reg *shape = shapes; shape->name; shape++)
        hewn_lua_add_function(L, 0, shape->name, shape->func);
}
