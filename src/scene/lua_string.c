/* Lua's libraries of strings and tables, with guards around what could work for ever inside one call, where the count
 * hook does not reach: patterns that backtrack, counts without end, lengths that a metamethod makes up. */
#include <string.h>

#include "scene/lua_state.h"

enum { PATTERN_LIMIT = 256 };

#define PATTERN_WORK 1e9 /* steps; some seconds at the very worst */

/* Upvalue 1 is the guarded function: calls it with this call's arguments. */
static int call_guarded(lua_State *L)
{
    lua_pushvalue(L, lua_upvalueindex(1));
    lua_insert(L, 1);
    lua_call(L, lua_gettop(L) - 1, LUA_MULTRET);
    hewn_lua_check(L);
    return lua_gettop(L);
}

/* Puts `guard` around the function `name` of the library at `library`. */
static void set_guard(lua_State *L, int library, const char *name, lua_CFunction guard)
{
    lua_getfield(L, library, name);
    lua_pushcclosure(L, guard, 1);
    lua_setfield(L, library, name);
}

/* --- strings -------------------------------------------------------------------------------------------------------
 */

/* A bound on the steps of a match. Every repetition may try each length, `?` two ways, at every place to begin;
 * scanning for %b or a repeated capture, or through a [set], multiplies that. Counting repetition signs inside sets too
 * only makes the bound larger. */
static double bound_match(const char *pattern, size_t pattern_length, size_t length)
{
    double positions = (double)length + 1, work = positions;
    bool scans = false, has_set = false;
    for (size_t i = 0; i < pattern_length; i++) {
        switch (pattern[i]) {
        case '%':
            i++; /* the escaped character repeats nothing */
            scans = scans || (i < pattern_length && (pattern[i] == 'b' || (pattern[i] >= '0' && pattern[i] <= '9')));
            break;
        case '[': has_set = true; break;
        case '*':
        case '+':
        case '-': work *= positions; break;
        case '?': work *= 2; break;
        default: break;
        }
    }
    return work * (scans ? positions : 1) * (has_set ? (double)pattern_length : 1);
}

static void check_pattern(lua_State *L, const char *name)
{
    size_t length, pattern_length;
    luaL_checklstring(L, 1, &length);
    const char *pattern = luaL_checklstring(L, 2, &pattern_length);
    if (pattern_length > PATTERN_LIMIT)
        luaL_error(L, "%s: the pattern is longer than %d bytes", name, PATTERN_LIMIT);
    if (bound_match(pattern, pattern_length, length) > PATTERN_WORK)
        luaL_error(L, "%s: matching this pattern with a text of %d bytes could take too long", name, (int)length);
}

static int guarded_find(lua_State *L)
{
    if (!lua_toboolean(L, 4)) /* a plain search takes no time that matters */
        check_pattern(L, "string.find");
    return call_guarded(L);
}

static int guarded_match(lua_State *L)
{
    check_pattern(L, "string.match");
    return call_guarded(L);
}

static int guarded_gmatch(lua_State *L)
{
    check_pattern(L, "string.gmatch");
    return call_guarded(L);
}

static int guarded_gsub(lua_State *L)
{
    check_pattern(L, "string.gsub");
    return call_guarded(L);
}

static int guarded_rep(lua_State *L)
{
    size_t length, separator;
    luaL_checklstring(L, 1, &length);
    lua_Integer count = luaL_checkinteger(L, 2);
    luaL_optlstring(L, 3, "", &separator);
    if (count <= 0 || length + separator == 0) {
        lua_pushliteral(L, "");
        return 1;
    }
    if ((size_t)count > HEWN_LUA_STRING_LIMIT / (length + separator))
        return luaL_error(L, "string.rep: the result would be longer than %d bytes", (int)HEWN_LUA_STRING_LIMIT);
    return call_guarded(L);
}

/* math.randomseed() of no argument would seed by the clock; scenes are the same on every run. */
static int guarded_randomseed(lua_State *L)
{
    luaL_checknumber(L, 1);
    return call_guarded(L);
}

void hewn_lua_open_strings(lua_State *L)
{
    int top = lua_gettop(L);
    luaL_requiref(L, LUA_STRLIBNAME, luaopen_string, 1);
    int library = lua_gettop(L);
    lua_pushnil(L);
    lua_setfield(L, library, "dump");
    set_guard(L, library, "find", guarded_find);
    set_guard(L, library, "match", guarded_match);
    set_guard(L, library, "gmatch", guarded_gmatch);
    set_guard(L, library, "gsub", guarded_gsub);
    set_guard(L, library, "rep", guarded_rep);
    lua_getglobal(L, LUA_MATHLIBNAME);
    library = lua_gettop(L);
    lua_getfield(L, library, "randomseed");
    lua_pushinteger(L, 0);
    lua_call(L, 1, 0);
    set_guard(L, library, "randomseed", guarded_randomseed);
    lua_settop(L, top);
}

/* --- tables --------------------------------------------------------------------------------------------------------
 */

static int guarded_list(lua_State *L)
{
    luaL_checktype(L, 1, LUA_TTABLE);
    if (luaL_getmetafield(L, 1, "__len") != LUA_TNIL)
        return luaL_error(L, "the functions of table do not take a table with __len");
    if (lua_rawlen(L, 1) > (lua_Unsigned)HEWN_LUA_TABLE_LIMIT)
        return luaL_error(L, "the functions of table do not take a list of more than %d items",
                          (int)HEWN_LUA_TABLE_LIMIT);
    return call_guarded(L);
}

/* Raises an error unless the stretch from `first` to `last` is of a sane length. */
static void check_stretch(lua_State *L, lua_Integer first, lua_Integer last)
{
    if (last > first && (lua_Unsigned)last - (lua_Unsigned)first >= (lua_Unsigned)HEWN_LUA_TABLE_LIMIT)
        luaL_error(L, "the functions of table do not take a list of more than %d items", (int)HEWN_LUA_TABLE_LIMIT);
}

static int guarded_concat(lua_State *L)
{
    if (!lua_isnoneornil(L, 4))
        check_stretch(L, luaL_optinteger(L, 3, 1), luaL_checkinteger(L, 4));
    return guarded_list(L);
}

static int guarded_unpack(lua_State *L)
{
    if (!lua_isnoneornil(L, 3))
        check_stretch(L, luaL_optinteger(L, 2, 1), luaL_checkinteger(L, 3));
    return guarded_list(L);
}

static int guarded_move(lua_State *L)
{
    check_stretch(L, luaL_checkinteger(L, 2), luaL_checkinteger(L, 3));
    return call_guarded(L);
}

void hewn_lua_open_tables(lua_State *L)
{
    int top = lua_gettop(L);
    luaL_requiref(L, LUA_TABLIBNAME, luaopen_table, 1);
    int library = lua_gettop(L);
    set_guard(L, library, "insert", guarded_list);
    set_guard(L, library, "remove", guarded_list);
    set_guard(L, library, "sort", guarded_list);
    set_guard(L, library, "concat", guarded_concat);
    set_guard(L, library, "unpack", guarded_unpack);
    set_guard(L, library, "move", guarded_move);
    lua_settop(L, top);
}
