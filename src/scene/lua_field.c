/* Field values in Lua, and reading arguments with messages that a person understands. */
#include <math.h>
#include <string.h>

#include "scene/lua_state.h"

static const char type_name[] = "field";

/* --- arguments ---------------------------------------------------------------------------------------------------- */

int hewn_lua_argument_error(lua_State *L, int argument, const char *name, const char *what)
{
    lua_Debug record;
    const char *got = lua_type(L, argument) == LUA_TNUMBER ? lua_pushfstring(L, "%f", lua_tonumber(L, argument))
                      : lua_isnone(L, argument)            ? "nothing"
                                                           : lua_pushfstring(L, "a %s", luaL_typename(L, argument));
    if (hewn_lua_is_field(L, argument))
        got = "a field";
    if (lua_getstack(L, 0, &record) && lua_getinfo(L, "n", &record) && strcmp(record.namewhat, "method") == 0) {
        argument--; /* in a:move(1, 2, 3) the 1 is the first for whoever wrote it */
        if (argument == 0)
            return luaL_error(L, "%s: what it is called on must be %s, not %s", name, what, got);
    }
    return luaL_error(L, "%s: argument %d must be %s, not %s", name, argument, what, got);
}

void hewn_lua_check_count(lua_State *L, const char *name, int least, int most)
{
    int count = lua_gettop(L);
    if (count >= least && count <= most)
        return;
    if (least == most)
        luaL_error(L, "%s takes %d argument%s, not %d", name, least, least == 1 ? "" : "s", count);
    else
        luaL_error(L, "%s takes %d to %d arguments, not %d", name, least, most, count);
}

double hewn_lua_number(lua_State *L, int argument, const char *name)
{
    double value = lua_tonumber(L, argument);
    if (lua_type(L, argument) != LUA_TNUMBER || !isfinite(value))
        hewn_lua_argument_error(L, argument, name, "a finite number");
    return value;
}

double hewn_lua_positive(lua_State *L, int argument, const char *name)
{
    double value = lua_tonumber(L, argument);
    if (lua_type(L, argument) != LUA_TNUMBER || !isfinite(value) || !(value > 0))
        hewn_lua_argument_error(L, argument, name, "a positive number");
    return value;
}

double hewn_lua_part(lua_State *L, int argument, const char *name)
{
    double value = lua_tonumber(L, argument);
    if (lua_type(L, argument) != LUA_TNUMBER || !(value >= 0) || !(value <= 1))
        hewn_lua_argument_error(L, argument, name, "a number from 0 to 1");
    return value;
}

const char *hewn_lua_string(lua_State *L, int argument, const char *name)
{
    size_t length = 0;
    const char *text = lua_type(L, argument) == LUA_TSTRING ? lua_tolstring(L, argument, &length) : NULL;
    if (!text)
        hewn_lua_argument_error(L, argument, name, "a text");
    else if (strlen(text) != length)
        luaL_error(L, "%s: argument %d has a zero byte inside", name, argument);
    return text;
}

/* --- values --------------------------------------------------------------------------------------------------------
 */

bool hewn_lua_is_field(lua_State *L, int index)
{
    return luaL_testudata(L, index, type_name) != NULL;
}

hewn_node hewn_lua_field(lua_State *L, int argument, const char *name)
{
    const hewn_node *node = luaL_testudata(L, argument, type_name);
    if (!node) {
        hewn_lua_argument_error(L, argument, name, "a field");
        return HEWN_NODE_NONE;
    }
    return *node;
}

hewn_node hewn_lua_operand(lua_State *L, int argument, const char *name)
{
    const hewn_node *node = luaL_testudata(L, argument, type_name);
    if (node)
        return *node;
    double value = lua_tonumber(L, argument);
    if (lua_type(L, argument) != LUA_TNUMBER)
        hewn_lua_argument_error(L, argument, name, "a field or a number");
    if (isnan(value))
        luaL_error(L, "%s: argument %d is not a number (NaN: 0/0, or the root of a negative number?)", name, argument);
    return hewn_constant(hewn_lua_of(L)->scene->field, value);
}

int hewn_lua_push_field(lua_State *L, hewn_node node)
{
    hewn_lua_check(L);
    if (hewn_node_is_none(node)) {
        hewn_error reason = {0};
        hewn_field_status(hewn_lua_of(L)->scene->field, &reason);
        return luaL_error(L, "%s", reason.message);
    }
    hewn_node *value = lua_newuserdatauv(L, sizeof node, 0);
    *value = node;
    luaL_setmetatable(L, type_name);
    return 1;
}

static int same_field(lua_State *L)
{
    const hewn_node *a = luaL_testudata(L, 1, type_name), *b = luaL_testudata(L, 2, type_name);
    lua_pushboolean(L, a && b && a->id == b->id);
    return 1;
}

static int compare_advice(lua_State *L)
{
    return luaL_error(L, "fields cannot be compared with < or >: compare(a, b) makes a field of the answer");
}

static int field_text(lua_State *L)
{
    lua_pushstring(L, type_name);
    return 1;
}

/* Upvalue: the table of methods. */
static int find_method(lua_State *L)
{
    lua_pushvalue(L, 2);
    if (lua_rawget(L, lua_upvalueindex(1)) != LUA_TNIL)
        return 1;
    if (lua_type(L, 2) == LUA_TSTRING)
        return luaL_error(L, "a field has no method '%s'", lua_tostring(L, 2));
    return luaL_error(L, "a field has methods only: it cannot be indexed with a %s", luaL_typename(L, 2));
}

void hewn_lua_add_function(lua_State *L, int methods, const char *name, lua_CFunction function)
{
    lua_pushcfunction(L, function);
    if (methods) {
        lua_pushvalue(L, -1);
        lua_setfield(L, methods, name);
    }
    lua_setglobal(L, name);
}

int hewn_lua_open_fields(lua_State *L)
{
    static const luaL_Reg events[] = {{"__eq", same_field},
                                      {"__lt", compare_advice},
                                      {"__le", compare_advice},
                                      {"__tostring", field_text},
                                      {NULL, NULL}};
    hewn_field *field = hewn_lua_of(L)->scene->field;
    lua_newtable(L);
    int methods = lua_gettop(L);
    luaL_newmetatable(L, type_name);
    luaL_setfuncs(L, events, 0);
    lua_pushvalue(L, methods);
    lua_pushcclosure(L, find_method, 1);
    lua_setfield(L, -2, "__index");
    lua_pushstring(L, type_name); /* what getmetatable() answers */
    lua_setfield(L, -2, "__metatable");
    lua_pop(L, 1);
    hewn_lua_push_field(L, hewn_x(field));
    lua_setglobal(L, "x");
    hewn_lua_push_field(L, hewn_y(field));
    lua_setglobal(L, "y");
    hewn_lua_push_field(L, hewn_z(field));
    lua_setglobal(L, "z");
    return methods;
}
