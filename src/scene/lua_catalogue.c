/* The functions of the catalogue: arguments are read as it says, so that each message names the argument. What is
 * written in more than one way (src/field/catalogue.h: `call`) is read by hand in lua_shapes.c, lua_combining.c and
 * lua_moving.c. */
#include <math.h>
#include <string.h>

#include "field/catalogue.h"
#include "scene/lua_state.h"

static const double degree = 3.14159265358979323846 / 180;

static double whole(lua_State *L, int argument, const hewn_function *function, const hewn_argument_info *info)
{
    double value = lua_tonumber(L, argument);
    if (lua_type(L, argument) != LUA_TNUMBER || value != floor(value) || value < info->least || value > info->most) {
        char what[64];
        snprintf(what, sizeof what, "a whole number from %.0f to %.0f", info->least, info->most);
        hewn_lua_argument_error(L, argument, function->name, what);
    }
    return value;
}

static double not_negative(lua_State *L, int argument, const char *name)
{
    double value = hewn_lua_number(L, argument, name);
    if (value < 0)
        hewn_lua_argument_error(L, argument, name, "a number of at least 0");
    return value;
}

/* Which of some words the argument is. */
static double word(lua_State *L, int argument, const char *name, const char *const *words, const char *what)
{
    const char *given = lua_type(L, argument) == LUA_TSTRING ? lua_tostring(L, argument) : "";
    for (int i = 0; words[i]; i++)
        if (strcmp(given, words[i]) == 0)
            return i;
    if (lua_type(L, argument) == LUA_TSTRING)
        return luaL_error(L, "%s: '%s' is not %s", name, given, what);
    return hewn_lua_argument_error(L, argument, name, what);
}

/* --- lists ---------------------------------------------------------------------------------------------------------
 */

/* Item `i` of the list at `argument` as numbers, `most` at most; returns how many it has. */
static int numbers_of(lua_State *L, int argument, const char *name, lua_Integer i, int most, double *out)
{
    if (lua_rawgeti(L, argument, i) != LUA_TTABLE)
        return luaL_error(L, "%s: item %d of the list must be a list of numbers, not a %s", name, (int)i,
                          luaL_typename(L, -1));
    int count = (int)lua_rawlen(L, -1);
    if (count > most)
        return luaL_error(L, "%s: item %d of the list has more than %d numbers", name, (int)i, most);
    for (int k = 0; k < count; k++) {
        lua_rawgeti(L, -1, k + 1);
        out[k] = lua_tonumber(L, -1);
        if (lua_type(L, -1) != LUA_TNUMBER || !isfinite(out[k]))
            return luaL_error(L, "%s: item %d of the list: number %d must be a finite number", name, (int)i, k + 1);
        lua_pop(L, 1);
    }
    lua_pop(L, 1);
    return count;
}

static lua_Integer list_length(lua_State *L, int argument, const char *name, const char *what)
{
    if (lua_type(L, argument) != LUA_TTABLE)
        hewn_lua_argument_error(L, argument, name, what);
    lua_Integer count = (lua_Integer)lua_rawlen(L, argument);
    if (count > HEWN_OUTLINE_MOST)
        return luaL_error(L, "%s: the list has more than %d items", name, (int)HEWN_OUTLINE_MOST);
    return count;
}

/* The memory is Lua's, and lives as long as the call. */
static void read_points(lua_State *L, int argument, const char *name, int dimensions, hewn_argument *out)
{
    lua_Integer count =
        list_length(L, argument, name, dimensions == 2 ? "a list of points {x, y}" : "a list of points {x, y, z}");
    double *points = lua_newuserdatauv(L, ((size_t)count * (size_t)dimensions + 1) * sizeof *points, 0);
    for (lua_Integer i = 0; i < count; i++)
        if (numbers_of(L, argument, name, i + 1, dimensions, points + i * dimensions) != dimensions)
            luaL_error(L, "%s: item %d of the list must have %d numbers", name, (int)(i + 1), dimensions);
    out->points = points;
    out->count = (size_t)count;
}

static void read_curves(lua_State *L, int argument, const char *name, hewn_argument *out)
{
    lua_Integer count = list_length(L, argument, name, "a list of curves");
    hewn_curve *curves = lua_newuserdatauv(L, ((size_t)count + 1) * sizeof *curves, 0);
    for (lua_Integer i = 0; i < count; i++) {
        int numbers = numbers_of(L, argument, name, i + 1, 6, curves[i].points[0]);
        if (numbers < 2 || numbers % 2 != 0)
            luaL_error(L, "%s: item %d of the list must have 2, 4 or 6 numbers", name, (int)(i + 1));
        curves[i].degree = (unsigned)numbers / 2;
    }
    out->curves = curves;
    out->count = (size_t)count;
}

/* --- all -----------------------------------------------------------------------------------------------------------
 */

static void read_argument(lua_State *L, int argument, const hewn_function *function, const hewn_argument_info *info,
                          hewn_argument *out)
{
    static const char *const axes[] = {"x", "y", "z", NULL};
    static const char *const noises[] = {"value", "gradient", "simplex", "cellular", NULL};
    const char *name = function->name;
    switch (info->kind) {
    case HEWN_ARGUMENT_FIELD: out->node = hewn_lua_field(L, argument, name); break;
    case HEWN_ARGUMENT_OPERAND: out->node = hewn_lua_operand(L, argument, name); break;
    case HEWN_ARGUMENT_NUMBER: out->number = hewn_lua_number(L, argument, name); break;
    case HEWN_ARGUMENT_POSITIVE: out->number = hewn_lua_positive(L, argument, name); break;
    case HEWN_ARGUMENT_PART: out->number = hewn_lua_part(L, argument, name); break;
    case HEWN_ARGUMENT_NOT_NEGATIVE: out->number = not_negative(L, argument, name); break;
    case HEWN_ARGUMENT_ANGLE: out->number = hewn_lua_number(L, argument, name) * degree; break;
    case HEWN_ARGUMENT_WHOLE: out->number = whole(L, argument, function, info); break;
    case HEWN_ARGUMENT_AXIS: out->number = word(L, argument, name, axes, "\"x\", \"y\" or \"z\""); break;
    case HEWN_ARGUMENT_NOISE:
        out->number = word(L, argument, name, noises, "\"value\", \"gradient\", \"simplex\" or \"cellular\"");
        break;
    case HEWN_ARGUMENT_POINTS: read_points(L, argument, name, 3, out); break;
    case HEWN_ARGUMENT_FLAT_POINTS: read_points(L, argument, name, 2, out); break;
    case HEWN_ARGUMENT_CURVES: read_curves(L, argument, name, out); break;
    }
}

static int call(lua_State *L)
{
    const hewn_function *function = &hewn_functions[lua_tointeger(L, lua_upvalueindex(1))];
    hewn_argument values[HEWN_ARGUMENTS_MOST];
    int needed, most = hewn_function_arguments(function, &needed), given = lua_gettop(L);
    hewn_lua_check_count(L, function->name, needed, most);
    memset(values, 0, sizeof values);
    luaL_checkstack(L, HEWN_ARGUMENTS_MOST + 8, NULL);
    for (int i = 0; i < most; i++)
        if (i < given)
            read_argument(L, i + 1, function, &function->arguments[i], &values[i]);
        else
            values[i].number = function->arguments[i].otherwise;
    return hewn_lua_push_field(L, function->build(hewn_lua_of(L)->scene->field, values));
}

void hewn_lua_open_catalogue(lua_State *L, int methods)
{
    for (size_t i = 0; i < hewn_function_count; i++) {
        const hewn_function *function = &hewn_functions[i];
        if (function->call)
            continue;
        lua_pushinteger(L, (lua_Integer)i);
        lua_pushcclosure(L, call, 1);
        if (function->arguments[0].kind == HEWN_ARGUMENT_FIELD) {
            lua_pushvalue(L, -1);
            lua_setfield(L, methods, function->name);
        }
        lua_setglobal(L, function->name);
    }
}
