/* What a scene says of itself: parameters, bounds, units, which way is up. */
#include <ctype.h>
#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "scene/lua_state.h"

enum { NAME_LIMIT = 64, HELP_LIMIT = 1000, PARAMETER_LIMIT = 1000 };

/* --- parameters ----------------------------------------------------------------------------------------------------
 */

static const char *read_name(lua_State *L)
{
    const char *name = hewn_lua_string(L, 1, "param");
    size_t length = strlen(name);
    bool good = length > 0 && length <= NAME_LIMIT && !isdigit((unsigned char)name[0]);
    for (size_t i = 0; i < length; i++)
        good = good && (unsigned char)name[i] < 0x80 && (isalnum((unsigned char)name[i]) || name[i] == '_');
    if (!good)
        luaL_error(L, "param: '%s' is no name: letters, digits and _ make one, at most %d of them", name,
                   (int)NAME_LIMIT);
    return name;
}

static double read_limit(lua_State *L, const char *key, double missing)
{
    double value = missing;
    if (lua_getfield(L, 3, key) != LUA_TNIL) {
        value = lua_tonumber(L, -1);
        if (lua_type(L, -1) != LUA_TNUMBER || isnan(value))
            luaL_error(L, "param: %s must be a number", key);
    }
    lua_pop(L, 1);
    return value;
}

/* The options in the table at index 3. The help text stays on the stack, so that it lives on. */
static void read_options(lua_State *L, hewn_scene_parameter *parameter)
{
    static const char *const known[] = {"min", "max", "integer", "help"};
    for (lua_pushnil(L); lua_next(L, 3) != 0; lua_pop(L, 1)) {
        const char *key = lua_type(L, -2) == LUA_TSTRING ? lua_tostring(L, -2) : "";
        size_t i = 0, count = sizeof known / sizeof known[0];
        while (i < count && strcmp(key, known[i]) != 0)
            i++;
        if (i == count)
            luaL_error(L, "param: there is no option '%s'; there are min, max, integer, help", key);
    }
    parameter->lo = read_limit(L, "min", parameter->lo);
    parameter->hi = read_limit(L, "max", parameter->hi);
    if (lua_getfield(L, 3, "integer") > LUA_TBOOLEAN)
        luaL_error(L, "param: integer must be true or false");
    parameter->integer = lua_toboolean(L, -1);
    lua_pop(L, 1);
    if (lua_getfield(L, 3, "help") != LUA_TNIL) {
        size_t length;
        parameter->help = lua_type(L, -1) == LUA_TSTRING ? lua_tolstring(L, -1, &length) : NULL;
        if (!parameter->help || strlen(parameter->help) != length || length > HELP_LIMIT)
            luaL_error(L, "param: help must be a text of at most %d bytes", (int)HELP_LIMIT);
    }
}

/* Raises an error unless the parameter can have `value`; `what` says whose value it is. */
static void check_value(lua_State *L, const hewn_scene_parameter *parameter, double value, const char *what)
{
    if (parameter->integer && (value != floor(value) || fabs(value) > 9007199254740992.0))
        luaL_error(L, "parameter '%s': %s, %f, must be a whole number", parameter->name, what, value);
    if (value >= parameter->lo && value <= parameter->hi)
        return;
    if (isinf(parameter->lo))
        luaL_error(L, "parameter '%s': %s, %f, is above %f", parameter->name, what, value, parameter->hi);
    if (isinf(parameter->hi))
        luaL_error(L, "parameter '%s': %s, %f, is below %f", parameter->name, what, value, parameter->lo);
    luaL_error(L, "parameter '%s': %s, %f, is outside %f to %f", parameter->name, what, value, parameter->lo,
               parameter->hi);
}

static hewn_scene_parameter *find_parameter(hewn_scene *scene, const char *name)
{
    for (size_t i = 0; i < scene->parameter_count; i++)
        if (strcmp(scene->parameters[i].name, name) == 0)
            return &scene->parameters[i];
    return NULL;
}

/* Copies a parameter into the scene, its strings too. */
static hewn_result add_parameter(hewn_scene *scene, const hewn_scene_parameter *parameter)
{
    void *items = scene->parameters;
    HEWN_TRY(
        hewn_reserve(&items, &scene->parameter_capacity, scene->parameter_count + 1, sizeof *scene->parameters, NULL));
    scene->parameters = items;
    hewn_scene_parameter copy = *parameter;
    copy.name = hewn_strdup(parameter->name);
    copy.help = parameter->help ? hewn_strdup(parameter->help) : NULL;
    if (!copy.name || (parameter->help && !copy.help)) {
        hewn_free((char *)copy.name);
        hewn_free((char *)copy.help);
        return HEWN_OUT_OF_MEMORY;
    }
    scene->parameters[scene->parameter_count++] = copy;
    return HEWN_OK;
}

static int push_value(lua_State *L, const hewn_scene_parameter *parameter)
{
    if (parameter->integer)
        lua_pushinteger(L, (lua_Integer)parameter->value);
    else
        lua_pushnumber(L, parameter->value);
    return 1;
}

/* param(name, default [, {min =, max =, integer =, help =}]) */
static int declare_parameter(lua_State *L)
{
    hewn_scene *scene = hewn_lua_of(L)->scene;
    hewn_lua_check_count(L, "param", 2, 3);
    hewn_scene_parameter parameter = {.name = read_name(L), .lo = -INFINITY, .hi = INFINITY};
    parameter.initial = hewn_lua_number(L, 2, "param");
    if (lua_gettop(L) == 3 && lua_type(L, 3) != LUA_TTABLE)
        return hewn_lua_argument_error(L, 3, "param", "a table of options");
    if (lua_gettop(L) == 3)
        read_options(L, &parameter);
    if (!(parameter.lo <= parameter.hi))
        return luaL_error(L, "parameter '%s': min is above max", parameter.name);
    check_value(L, &parameter, parameter.initial, "the default");
    const hewn_scene_parameter *earlier = find_parameter(scene, parameter.name);
    if (earlier) {
        if (earlier->initial != parameter.initial || earlier->lo != parameter.lo || earlier->hi != parameter.hi ||
            earlier->integer != parameter.integer)
            return luaL_error(L, "parameter '%s' is declared twice, with different defaults or ranges", parameter.name);
        return push_value(L, earlier);
    }
    parameter.value = parameter.initial;
    for (size_t i = 0; i < scene->setting_count; i++)
        if (strcmp(scene->settings[i].name, parameter.name) == 0) {
            parameter.value = scene->settings[i].value;
            check_value(L, &parameter, parameter.value, "the value set");
        }
    if (scene->parameter_count >= PARAMETER_LIMIT)
        return luaL_error(L, "param: more than %d parameters", (int)PARAMETER_LIMIT);
    if (add_parameter(scene, &parameter) != HEWN_OK)
        return luaL_error(L, "param: out of memory");
    return push_value(L, &parameter);
}

/* --- the scene as a whole ------------------------------------------------------------------------------------------
 */

/* Whether what is said now speaks for the scene: an imported file may say it too, for when it is a scene of its own. */
static bool speaks_for_scene(lua_State *L)
{
    return hewn_lua_of(L)->import_depth == 0;
}

/* bounds(x0, y0, z0, x1, y1, z1) */
static int set_bounds(lua_State *L)
{
    hewn_box box;
    hewn_lua_check_count(L, "bounds", 6, 6);
    for (int i = 0; i < 3; i++) {
        box.lo[i] = hewn_lua_number(L, i + 1, "bounds");
        box.hi[i] = hewn_lua_number(L, i + 4, "bounds");
        if (!(box.lo[i] < box.hi[i]))
            return luaL_error(L, "bounds: along %c the lower end, %f, must be below the upper, %f", 'x' + i, box.lo[i],
                              box.hi[i]);
    }
    if (speaks_for_scene(L)) {
        hewn_lua_of(L)->scene->bounds = box;
        hewn_lua_of(L)->scene->has_bounds = true;
    }
    return 0;
}

static int set_units(lua_State *L)
{
    hewn_lua_check_count(L, "units", 1, 1);
    const char *name = hewn_lua_string(L, 1, "units");
    const hewn_unit *unit = hewn_unit_find(name);
    if (!unit)
        return luaL_error(L, "units: there is no unit '%s'; there are %s", name, hewn_unit_names());
    if (speaks_for_scene(L))
        hewn_lua_of(L)->scene->unit = unit;
    return 0;
}

static int set_up(lua_State *L)
{
    hewn_axis up;
    hewn_lua_check_count(L, "up", 1, 1);
    const char *name = hewn_lua_string(L, 1, "up");
    if (!hewn_axis_find(name, &up))
        return luaL_error(L, "up: there is no direction '%s'; there are +Y, +Z, +X", name);
    if (speaks_for_scene(L))
        hewn_lua_of(L)->scene->up = up;
    return 0;
}

void hewn_lua_open_scene(lua_State *L)
{
    hewn_lua_add_function(L, 0, "param", declare_parameter);
    hewn_lua_add_function(L, 0, "bounds", set_bounds);
    hewn_lua_add_function(L, 0, "units", set_units);
    hewn_lua_add_function(L, 0, "up", set_up);
}
