/* text("Hewn", "font.ttf", size, {...}): letters as a flat shape. A font is read once a scene. */
#include <math.h>
#include <string.h>

#include "hewn/font.h"
#include "scene/lua_state.h"

enum { FONTS_MOST = 16, FACES_MOST = 1024 };

static const char fonts_key[] = "hewn.fonts"; /* in the registry: "face:real path" -> font */
static const char type_name[] = "hewn.font";

static int release(lua_State *L)
{
    hewn_font_destroy((hewn_font **)lua_touserdata(L, 1));
    return 0;
}

/* Reads the font whose shown and real path are on the stack's top, and leaves a userdata of it there. */
static hewn_font *read_font(lua_State *L, const char *name, uint32_t face)
{
    const char *shown = lua_tostring(L, -2), *real = lua_tostring(L, -1);
    hewn_scene *scene = hewn_lua_of(L)->scene;
    hewn_error reason = {0};
    hewn_font **own = lua_newuserdatauv(L, sizeof(hewn_font *), 0);
    *own = NULL;
    if (luaL_newmetatable(L, type_name)) {
        lua_pushcfunction(L, release);
        lua_setfield(L, -2, "__gc");
    }
    lua_setmetatable(L, -2);
    if (hewn_lua_note_file(scene, shown, real, &reason) != HEWN_OK ||
        hewn_font_open(real, face, own, &reason) != HEWN_OK)
        luaL_error(L, "text: '%s': %s", name, reason.message);
    return *own;
}

static hewn_font *find_font(lua_State *L, const char *name, uint32_t face)
{
    hewn_lua_find_file(L, "text", name);
    int real = lua_gettop(L);
    luaL_getsubtable(L, LUA_REGISTRYINDEX, fonts_key);
    int fonts = lua_gettop(L);
    const char *key = lua_pushfstring(L, "%d:%s", (int)face, lua_tostring(L, real));
    lua_pushvalue(L, -1);
    if (lua_rawget(L, fonts) == LUA_TUSERDATA)
        return *(hewn_font **)lua_touserdata(L, -1);
    int count = 0;
    for (lua_pushnil(L); lua_next(L, fonts) != 0; lua_pop(L, 1))
        count++;
    if (count >= FONTS_MOST)
        luaL_error(L, "text: a scene can use at most %d fonts", (int)FONTS_MOST);
    lua_pushvalue(L, real - 1);
    lua_pushvalue(L, real);
    hewn_font *font = read_font(L, name, face);
    lua_pushstring(L, key);
    lua_pushvalue(L, -2);
    lua_rawset(L, fonts);
    return font;
}

/* --- options -------------------------------------------------------------------------------------------------------
 */

static int option_word(lua_State *L, const char *key, const char *const *words, const char *what)
{
    const char *given = lua_type(L, -1) == LUA_TSTRING ? lua_tostring(L, -1) : "";
    for (int i = 0; words[i]; i++)
        if (strcmp(given, words[i]) == 0)
            return i;
    return luaL_error(L, "text: %s must be %s", key, what);
}

static double option_number(lua_State *L, const char *key, double least)
{
    double value = lua_tonumber(L, -1);
    if (lua_type(L, -1) != LUA_TNUMBER || !isfinite(value))
        luaL_error(L, "text: %s must be a finite number", key);
    if (value < least)
        luaL_error(L, "text: %s must be at least %f", key, least);
    return value;
}

/* The option on the stack's top. */
static void read_option(lua_State *L, const char *key, hewn_text_desc *desc, uint32_t *face)
{
    static const char *const aligns[] = {"left", "center", "right", NULL};
    static const char *const anchors[] = {"baseline", "top", "middle", "bottom", NULL};
    if (strcmp(key, "align") == 0) {
        desc->align = (hewn_align)option_word(L, key, aligns, "\"left\", \"center\" or \"right\"");
    } else if (strcmp(key, "anchor") == 0) {
        desc->anchor =
            (hewn_text_anchor)option_word(L, key, anchors, "\"baseline\", \"top\", \"middle\" or \"bottom\"");
    } else if (strcmp(key, "spacing") == 0) {
        desc->spacing = option_number(L, key, -INFINITY);
    } else if (strcmp(key, "line_spacing") == 0) {
        desc->line_spacing = option_number(L, key, 0.01);
    } else if (strcmp(key, "face") == 0) {
        double value = option_number(L, key, 1);
        if (value != floor(value) || value > FACES_MOST)
            luaL_error(L, "text: face must be a whole number from 1 to %d", (int)FACES_MOST);
        *face = (uint32_t)value - 1;
    } else if (strcmp(key, "kerning") == 0) {
        if (lua_type(L, -1) != LUA_TBOOLEAN)
            luaL_error(L, "text: kerning must be true or false");
        desc->no_kerning = !lua_toboolean(L, -1);
    } else {
        luaL_error(L, "text: there is no option '%s'; there are align, anchor, spacing, line_spacing, kerning, face",
                   key);
    }
}

static int text(lua_State *L)
{
    static const char name[] = "text";
    hewn_lua_check_count(L, name, 3, 4);
    const char *letters = hewn_lua_string(L, 1, name), *file = hewn_lua_string(L, 2, name);
    hewn_text_desc desc = {.size = hewn_lua_positive(L, 3, name)};
    uint32_t face = 0;
    if (lua_gettop(L) == 4) {
        if (lua_type(L, 4) != LUA_TTABLE)
            hewn_lua_argument_error(L, 4, name, "a table of options");
        for (lua_pushnil(L); lua_next(L, 4) != 0; lua_pop(L, 1)) {
            if (lua_type(L, -2) != LUA_TSTRING)
                return luaL_error(L, "text: options have names: {align = \"center\"}");
            read_option(L, lua_tostring(L, -2), &desc, &face);
        }
    }
    hewn_font *font = find_font(L, file, face);
    return hewn_lua_push_field(L, hewn_font_text(hewn_lua_of(L)->scene->field, font, letters, &desc));
}

void hewn_lua_open_text(lua_State *L)
{
    hewn_lua_add_function(L, 0, "text", text);
}
