/* Lua's own functions that a scene may call. What is not named here does not exist in a scene: no io, os, package,
 * debug, coroutine, load, dofile, require, collectgarbage. */
#include <stdio.h>
#include <string.h>

#include "scene/lua_state.h"

enum { PRINT_LIMIT = 1 << 16 };

/* --- errors --------------------------------------------------------------------------------------------------------
 */

static int protected_call(lua_State *L)
{
    luaL_checkany(L, 1);
    lua_pushboolean(L, 1);
    lua_insert(L, 1);
    int status = lua_pcall(L, lua_gettop(L) - 2, LUA_MULTRET, 0);
    hewn_lua_check_status(L, status);
    if (status == LUA_OK)
        return lua_gettop(L);
    lua_pushboolean(L, 0);
    lua_insert(L, -2);
    return 2;
}

/* Upvalue: the script's handler. It must not run for the error that stops a scene: that is raised inside the count
 * hook, where no hook would watch the handler. */
static int call_handler(lua_State *L)
{
    if (hewn_lua_of(L)->stop != HEWN_LUA_RUNNING)
        return 1;
    lua_settop(L, 1);
    lua_pushvalue(L, lua_upvalueindex(1));
    lua_insert(L, 1);
    lua_call(L, 1, 1);
    return 1;
}

/* xpcall(function, handler, arguments...) */
static int protected_call_with_handler(lua_State *L)
{
    luaL_checktype(L, 2, LUA_TFUNCTION);
    lua_pushvalue(L, 2);
    lua_pushcclosure(L, call_handler, 1);
    lua_replace(L, 2);
    lua_pushboolean(L, 1);
    lua_pushvalue(L, 1);
    lua_rotate(L, 3, 2); /* function, handler, true, function, arguments... */
    int status = lua_pcall(L, lua_gettop(L) - 4, LUA_MULTRET, 2);
    hewn_lua_check_status(L, status);
    if (status == LUA_OK)
        return lua_gettop(L) - 2;
    lua_pushboolean(L, 0);
    lua_insert(L, -2);
    return 2;
}

/* --- tables --------------------------------------------------------------------------------------------------------
 */

/* setmetatable(table, metatable). The table gets a copy of the metamethods that the metatable has now, without __gc
 * (finalizers run outside the count hook) and __mode (clearing weak tables can take a time that grows with the square
 * of their size). Because scripts cannot reach the copy, neither can come in later. */
static int set_metatable(lua_State *L)
{
    static const char *const events[] = {
        "__index", "__newindex", "__call",   "__tostring", "__name", "__pairs", "__close", "__len", "__eq",
        "__lt",    "__le",       "__concat", "__unm",      "__add",  "__sub",   "__mul",   "__div", "__mod",
        "__pow",   "__idiv",     "__band",   "__bor",      "__bxor", "__bnot",  "__shl",   "__shr"};
    luaL_checktype(L, 1, LUA_TTABLE);
    if (!lua_isnoneornil(L, 2))
        luaL_checktype(L, 2, LUA_TTABLE);
    if (luaL_getmetafield(L, 1, "__protected") != LUA_TNIL)
        return luaL_error(L, "cannot change a protected metatable");
    lua_settop(L, 2);
    if (lua_isnil(L, 2)) {
        lua_setmetatable(L, 1); /* leaves the table alone on the stack */
        return 1;
    }
    static const char *const refused[] = {"__gc", "__mode"};
    for (size_t i = 0; i < sizeof refused / sizeof refused[0]; i++) {
        lua_pushstring(L, refused[i]);
        if (lua_rawget(L, 2) != LUA_TNIL)
            return luaL_error(L, "setmetatable: a scene's tables cannot have %s", refused[i]);
        lua_pop(L, 1);
    }
    lua_newtable(L);
    for (size_t i = 0; i < sizeof events / sizeof events[0]; i++) {
        lua_pushstring(L, events[i]);
        lua_pushvalue(L, -1);
        if (lua_rawget(L, 2) != LUA_TNIL)
            lua_rawset(L, 3);
        else
            lua_pop(L, 2);
    }
    lua_pushliteral(L, "__metatable"); /* what getmetatable() answers: the script's own table */
    if (lua_rawget(L, 2) != LUA_TNIL) {
        lua_pushboolean(L, 1);
        lua_setfield(L, 3, "__protected");
    } else {
        lua_pop(L, 1);
        lua_pushvalue(L, 2);
    }
    lua_setfield(L, 3, "__metatable");
    lua_setmetatable(L, 1);
    lua_settop(L, 1);
    return 1;
}

/* How keys are ordered: booleans, numbers, strings, then all else as it comes. */
static int key_rank(lua_State *L, int index)
{
    switch (lua_type(L, index)) {
    case LUA_TBOOLEAN: return 0;
    case LUA_TNUMBER: return 1;
    case LUA_TSTRING: return 2;
    default: return 3;
    }
}

static int key_less(lua_State *L)
{
    int a = key_rank(L, 1), b = key_rank(L, 2);
    bool less = a < b;
    if (a == b && a == 0)
        less = !lua_toboolean(L, 1) && lua_toboolean(L, 2);
    else if (a == b && a == 1)
        less = lua_compare(L, 1, 2, LUA_OPLT);
    else if (a == b && a == 2) {
        size_t m, n;
        const char *s = lua_tolstring(L, 1, &m), *t = lua_tolstring(L, 2, &n);
        int order = memcmp(s, t, m < n ? m : n);
        less = order != 0 ? order < 0 : m < n;
    }
    lua_pushboolean(L, less);
    return 1;
}

/* Upvalues: the ordered keys, how many of them were handed out. */
static int next_pair(lua_State *L)
{
    luaL_checktype(L, 1, LUA_TTABLE);
    lua_settop(L, 1);
    lua_Integer at = lua_tointeger(L, lua_upvalueindex(2));
    for (;;) {
        if (lua_rawgeti(L, lua_upvalueindex(1), ++at) == LUA_TNIL)
            return 1;
        lua_pushvalue(L, -1);
        if (lua_rawget(L, 1) != LUA_TNIL) /* nil: removed since */
            break;
        lua_pop(L, 2);
    }
    lua_pushinteger(L, at);
    lua_replace(L, lua_upvalueindex(2));
    return 2;
}

/* pairs(table), in the order of the keys: Lua's own order changes from run to run, and a scene must not.
 * Upvalue: table.sort. */
static int ordered_pairs(lua_State *L)
{
    luaL_checkany(L, 1);
    if (luaL_getmetafield(L, 1, "__pairs") != LUA_TNIL) {
        lua_pushvalue(L, 1);
        lua_call(L, 1, 3);
        return 3;
    }
    luaL_checktype(L, 1, LUA_TTABLE);
    lua_settop(L, 1);
    lua_newtable(L);
    lua_Integer count = 0;
    bool sorted = true;
    for (lua_pushnil(L); lua_next(L, 1) != 0; lua_pop(L, 1)) {
        lua_pushvalue(L, -2);
        /* A plain list comes in order already. */
        sorted = sorted && lua_isinteger(L, -1) && lua_tointeger(L, -1) == count + 1;
        lua_rawseti(L, 2, ++count);
    }
    if (count > HEWN_LUA_TABLE_LIMIT)
        return luaL_error(L, "pairs: the table has too many keys");
    if (!sorted) {
        lua_pushvalue(L, lua_upvalueindex(1));
        lua_pushvalue(L, 2);
        lua_pushcfunction(L, key_less);
        lua_call(L, 2, 0);
        hewn_lua_check(L);
    }
    lua_pushinteger(L, 0);
    lua_pushcclosure(L, next_pair, 2);
    lua_pushvalue(L, 1);
    lua_pushnil(L);
    return 3;
}

/* --- output --------------------------------------------------------------------------------------------------------
 */

/* To standard error, without control characters, and not without end. */
static void print_text(hewn_lua *lua, const char *text, size_t length)
{
    while (length > 0 && lua->printed <= PRINT_LIMIT) {
        char line[1024];
        const char *newline = memchr(text, '\n', length);
        size_t piece = newline ? (size_t)(newline - text) : length;
        if (piece > sizeof line - 1)
            piece = sizeof line - 1;
        hewn_text_clean(line, sizeof line, text, piece);
        fputs(line, stderr);
        if (newline == text + piece) {
            fputc('\n', stderr);
            piece++;
        }
        lua->printed += piece;
        text += piece;
        length -= piece;
    }
}

static int print(lua_State *L)
{
    hewn_lua *lua = hewn_lua_of(L);
    int count = lua_gettop(L);
    for (int i = 1; i <= count; i++) {
        size_t length;
        const char *text = luaL_tolstring(L, i, &length);
        print_text(lua, i > 1 ? "  " : "", i > 1 ? 2 : 0);
        print_text(lua, text, length);
        lua_pop(L, 1);
    }
    if (lua->printed <= PRINT_LIMIT)
        fputc('\n', stderr);
    lua->printed++;
    return 0;
}

void hewn_lua_open_base(lua_State *L)
{
    static const char *const kept[] = {"assert",   "error",    "getmetatable", "ipairs",  "next",
                                       "rawequal", "rawget",   "rawlen",       "rawset",  "select",
                                       "tonumber", "tostring", "type",         "_VERSION"};
    static const luaL_Reg own[] = {{"pcall", protected_call},
                                   {"xpcall", protected_call_with_handler},
                                   {"setmetatable", set_metatable},
                                   {"print", print},
                                   {NULL, NULL}};
    lua_pushcfunction(L, luaopen_base);
    lua_call(L, 0, 1); /* fills the table of globals */
    lua_newtable(L);
    for (size_t i = 0; i < sizeof kept / sizeof kept[0]; i++) {
        lua_getfield(L, -2, kept[i]);
        lua_setfield(L, -2, kept[i]);
    }
    luaL_setfuncs(L, own, 0);
    lua_pushvalue(L, -1);
    lua_setfield(L, -2, "_G");
    lua_rawseti(L, LUA_REGISTRYINDEX, LUA_RIDX_GLOBALS);
    luaL_requiref(L, LUA_TABLIBNAME, luaopen_table, 0);
    lua_getfield(L, -1, "sort");
    lua_pushcclosure(L, ordered_pairs, 1);
    lua_setglobal(L, "pairs");
    lua_pop(L, 2);
}
