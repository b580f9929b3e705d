/* Combining shapes: union and its relatives, sharp and smooth, as operators, functions and methods. */
#include <string.h>

#include "scene/lua_state.h"

typedef hewn_node (*combiner)(hewn_field *, hewn_node, hewn_node);
typedef hewn_node (*smooth_combiner)(hewn_field *, hewn_node, hewn_node, hewn_blend, double);

static hewn_field *field_of(lua_State *L)
{
    return hewn_lua_of(L)->scene->field;
}

/* --- sharp ---------------------------------------------------------------------------------------------------------
 */

/* All arguments, from the left: of a difference the first is cut by each of the others. */
static int combine_all(lua_State *L, const char *name, combiner combine)
{
    int count = lua_gettop(L);
    hewn_lua_check_count(L, name, 1, 1 << 24);
    hewn_node node = hewn_lua_field(L, 1, name);
    for (int i = 2; i <= count; i++)
        node = combine(field_of(L), node, hewn_lua_field(L, i, name));
    return hewn_lua_push_field(L, node);
}

static int unite(lua_State *L)
{
    return combine_all(L, "union", hewn_union);
}

static int intersect(lua_State *L)
{
    return combine_all(L, "intersection", hewn_intersection);
}

static int subtract(lua_State *L)
{
    return combine_all(L, "difference", hewn_difference);
}

static int complement(lua_State *L)
{
    hewn_lua_check_count(L, "complement", 1, 1);
    return hewn_lua_push_field(L, hewn_complement(field_of(L), hewn_lua_field(L, 1, "complement")));
}

static int unite_two(lua_State *L)
{
    hewn_node a = hewn_lua_field(L, 1, "|"), b = hewn_lua_field(L, 2, "|");
    return hewn_lua_push_field(L, hewn_union(field_of(L), a, b));
}

static int intersect_two(lua_State *L)
{
    hewn_node a = hewn_lua_field(L, 1, "&"), b = hewn_lua_field(L, 2, "&");
    return hewn_lua_push_field(L, hewn_intersection(field_of(L), a, b));
}

static int complement_one(lua_State *L)
{
    return hewn_lua_push_field(L, hewn_complement(field_of(L), hewn_lua_field(L, 1, "~")));
}

static int no_binary_complement(lua_State *L)
{
    return luaL_error(L, "~ between two fields means nothing: to cut b out of a write a & ~b");
}

/* --- smooth --------------------------------------------------------------------------------------------------------
 */

/* name(a, b, size [, blend]) */
static int combine_smooth(lua_State *L, const char *name, smooth_combiner combine)
{
    static const char *const blends[] = {"quadratic", "cubic", "circular", "exponential"};
    hewn_blend blend = HEWN_BLEND_QUADRATIC;
    hewn_lua_check_count(L, name, 3, 4);
    hewn_node a = hewn_lua_field(L, 1, name), b = hewn_lua_field(L, 2, name);
    double size = hewn_lua_positive(L, 3, name);
    if (lua_gettop(L) == 4) {
        const char *word = hewn_lua_string(L, 4, name);
        size_t i = 0, count = sizeof blends / sizeof blends[0];
        while (i < count && strcmp(word, blends[i]) != 0)
            i++;
        if (i == count)
            return luaL_error(L, "%s: there is no blend '%s'; there are quadratic, cubic, circular, exponential", name,
                              word);
        blend = (hewn_blend)i;
    }
    return hewn_lua_push_field(L, combine(field_of(L), a, b, blend, size));
}

static int smooth_unite(lua_State *L)
{
    return combine_smooth(L, "smooth_union", hewn_smooth_union);
}

static int smooth_intersect(lua_State *L)
{
    return combine_smooth(L, "smooth_intersection", hewn_smooth_intersection);
}

static int smooth_subtract(lua_State *L)
{
    return combine_smooth(L, "smooth_difference", hewn_smooth_difference);
}

void hewn_lua_open_combining(lua_State *L, int methods)
{
    static const luaL_Reg functions[] = {{"union", unite},
                                         {"intersection", intersect},
                                         {"difference", subtract},
                                         {"subtract", subtract},
                                         {"complement", complement},
                                         {"smooth_union", smooth_unite},
                                         {"smooth_intersection", smooth_intersect},
                                         {"smooth_difference", smooth_subtract},
                                         {NULL, NULL}};
    static const luaL_Reg events[] = {{"__bor", unite_two},
                                      {"__band", intersect_two},
                                      {"__bnot", complement_one},
                                      {"__bxor", no_binary_complement},
                                      {NULL, NULL}};
    for (const luaL_Reg *function = functions; function->name; function++)
        hewn_lua_add_function(L, methods, function->name, function->func);
    luaL_getmetatable(L, "field");
    luaL_setfuncs(L, events, 0);
    lua_pop(L, 1);
}
