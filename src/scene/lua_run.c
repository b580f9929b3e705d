/* One run of a scene: open the sandbox, load the text, call it, take its field. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/text.h"
#include "scene/lua_state.h"

enum { READ_STEP = 4096, ENOUGH_LEVELS = 64 };

/* --- where -------------------------------------------------------------------------------------------------------- */

bool hewn_lua_find_place(lua_State *L, hewn_lua_place *out)
{
    lua_Debug record;
    for (int level = 0; level < ENOUGH_LEVELS && lua_getstack(L, level, &record); level++) {
        lua_getinfo(L, "Sl", &record);
        if (record.currentline <= 0 || record.source[0] != '@')
            continue;
        const char *path = record.source + 1;
        size_t length = strlen(path);
        const char *tail = length < sizeof out->file ? path : path + (length - sizeof out->file + 1);
        snprintf(out->file, sizeof out->file, "%s", tail);
        out->line = (uint32_t)record.currentline;
        return true;
    }
    return false;
}

/* How Lua names a file in its messages: its path, cut at the front if it is long. */
static void shorten(const char *path, char out[LUA_IDSIZE])
{
    size_t length = strlen(path);
    if (length < LUA_IDSIZE)
        memcpy(out, path, length + 1);
    else
        snprintf(out, LUA_IDSIZE, "...%s", path + (length - (LUA_IDSIZE - 4)));
}

/* Splits "file:line: text" where the file is one of the scene's; returns the text, or NULL for another kind of
 * message. */
static const char *split_message(const hewn_scene *scene, const char *message, const char **file, uint32_t *line)
{
    for (size_t i = 0; i < scene->source_count; i++) {
        char name[LUA_IDSIZE], *end;
        shorten(scene->sources[i].path, name);
        size_t length = strlen(name);
        if (strncmp(message, name, length) != 0 || message[length] != ':')
            continue;
        unsigned long number = strtoul(message + length + 1, &end, 10);
        if (end == message + length + 1 || strncmp(end, ": ", 2) != 0)
            continue;
        *file = scene->sources[i].path;
        *line = number > UINT32_MAX ? 0 : (uint32_t)number;
        return end + 2;
    }
    return NULL;
}

static void push_message(lua_State *L, const char *path, uint32_t line, const char *message)
{
    char name[LUA_IDSIZE];
    shorten(path, name);
    lua_pushfstring(L, "%s:%d: %s", name, (int)line, message);
}

int hewn_lua_raise_at(lua_State *L, const char *path, uint32_t line, const char *message)
{
    push_message(L, path, line, message);
    return lua_error(L);
}

int hewn_lua_on_error(lua_State *L)
{
    const char *file;
    uint32_t line;
    if (!lua_isstring(L, 1)) {
        lua_pushfstring(L, "the scene raised an error that is a %s, not a text", luaL_typename(L, 1));
        lua_replace(L, 1);
    }
    const char *message = lua_tostring(L, 1);
    if (!split_message(hewn_lua_of(L)->scene, message, &file, &line)) {
        hewn_lua_place place;
        if (hewn_lua_find_place(L, &place)) {
            push_message(L, place.file, place.line, message);
            return 1;
        }
    }
    lua_settop(L, 1);
    return 1;
}

/* --- loading ----------------------------------------------------------------------------------------------------- */

typedef struct text_reader {
    const char *text;
    size_t left;
} text_reader;

/* Hands the text over in pieces: the parser runs no count hook, so this is where its time is watched. */
static const char *read_piece(lua_State *L, void *user, size_t *size)
{
    text_reader *reader = user;
    hewn_lua_check(L);
    *size = reader->left < READ_STEP ? reader->left : READ_STEP;
    const char *piece = reader->text;
    reader->text += *size;
    reader->left -= *size;
    return *size ? piece : NULL;
}

int hewn_lua_load(lua_State *L, const char *path, const char *text, size_t length)
{
    text_reader reader = {text, length};
    if (length >= 3 && memcmp(text, "\xEF\xBB\xBF", 3) == 0) {
        reader.text += 3; /* the mark that some editors put before UTF-8 */
        reader.left -= 3;
    }
    if (reader.left && reader.text[0] == LUA_SIGNATURE[0]) {
        push_message(L, path, 1, "this is compiled Lua; a scene must be text");
        return LUA_ERRSYNTAX;
    }
    if (reader.left &&
        reader.text[0] == '#') { /* "#!": a line for the shell; its newline stays, for the line numbers */
        const char *newline = memchr(reader.text, '\n', reader.left);
        size_t skipped = newline ? (size_t)(newline - reader.text) : reader.left;
        reader.text += skipped;
        reader.left -= skipped;
    }
    lua_pushfstring(L, "@%s", path);
    int status = lua_load(L, read_piece, &reader, lua_tostring(L, -1), "t");
    lua_remove(L, -2);
    return status;
}

/* --- running ----------------------------------------------------------------------------------------------------- */

typedef struct scene_text {
    const char *text;
    size_t length;
} scene_text;

static void open_sandbox(lua_State *L)
{
    hewn_lua_open_base(L);
    luaL_requiref(L, LUA_MATHLIBNAME, luaopen_math, 1);
    luaL_requiref(L, LUA_UTF8LIBNAME, luaopen_utf8, 1);
    lua_settop(L, 1);
    hewn_lua_open_strings(L);
    hewn_lua_open_tables(L);
    int methods = hewn_lua_open_fields(L);
    hewn_lua_open_arithmetic(L, methods);
    hewn_lua_open_shapes(L);
    hewn_lua_open_catalogue(L, methods);
    hewn_lua_open_combining(L, methods);
    hewn_lua_open_moving(L, methods);
    hewn_lua_open_paint(L, methods);
    hewn_lua_open_scene(L);
    hewn_lua_open_import(L);
    hewn_lua_open_text(L);
    hewn_lua_open_sampled(L);
    lua_settop(L, 1);
}

/* Checks what a scene returned: the values above stack index 1. */
static int take_result(lua_State *L)
{
    hewn_lua *lua = hewn_lua_of(L);
    int count = lua_gettop(L) - 1;
    const char *advice = NULL;
    if (count == 0)
        advice = "the scene returned nothing: end it with `return shape`";
    else if (count > 1)
        advice = "the scene returned %d values: return one field, for example union(a, b)";
    else if (lua_type(L, 2) == LUA_TTABLE)
        advice = "the scene returned a table: return one field, for example union(a, b)";
    else if (!hewn_lua_is_field(L, 2))
        return luaL_error(L, "the scene returned a %s: return a field", luaL_typename(L, 2));
    if (advice)
        return luaL_error(L, advice, count);
    lua->root = hewn_lua_field(L, 2, "the scene");
    return 0;
}

/* Called protected, with the scene_text as its argument. */
static int run_protected(lua_State *L)
{
    hewn_lua *lua = hewn_lua_of(L);
    const scene_text *source = lua_touserdata(L, 1);
    open_sandbox(L);
    int status = hewn_lua_load(L, lua->scene->sources[0].path, source->text, source->length);
    if (status != LUA_OK) {
        hewn_lua_check_status(L, status);
        return lua_error(L);
    }
    lua_call(L, 0, LUA_MULTRET);
    return take_result(L);
}

/* Turns what ended the run into the caller's error. */
static hewn_result explain(hewn_lua *lua, int status, hewn_error *error)
{
    char text[sizeof error->message];
    if (status == LUA_ERRMEM && lua->stop == HEWN_LUA_RUNNING) {
        lua->stop = lua->refusal == HEWN_LUA_RUNNING ? HEWN_LUA_STOP_HOST_MEMORY : lua->refusal;
        lua->stop_place = lua->refusal_place;
    }
    if (lua->stop != HEWN_LUA_RUNNING) {
        hewn_result code = lua->stop == HEWN_LUA_STOP_HOST_MEMORY ? HEWN_OUT_OF_MEMORY : HEWN_BAD_INPUT;
        const char *file = lua->stop_place.file[0] ? lua->stop_place.file : lua->scene->sources[0].path;
        hewn_lua_describe_stop(lua, text, sizeof text);
        return hewn_fail_at(error, code, file, lua->stop_place.line, "%s", text);
    }
    const char *message = lua_type(lua->L, -1) == LUA_TSTRING ? lua_tostring(lua->L, -1) : "the scene failed";
    const char *file = lua->scene->sources[0].path;
    uint32_t line = 0;
    const char *rest = split_message(lua->scene, message, &file, &line);
    if (rest)
        message = rest;
    hewn_text_clean(text, sizeof text, message, strlen(message));
    return hewn_fail_at(error, HEWN_BAD_INPUT, file, line, "%s", text);
}

hewn_result hewn_lua_run(hewn_scene *scene, const hewn_lua_limits *limits, const char *text, size_t length,
                         hewn_error *error)
{
    hewn_lua lua = {.scene = scene, .limits = *limits, .root = HEWN_NODE_NONE};
    scene_text source = {text, length};
    lua_State *L = lua_newstate(hewn_lua_allocate, &lua);
    if (!L)
        return explain(&lua, LUA_ERRMEM, error);
    lua.L = L;
    *(hewn_lua **)lua_getextraspace(L) = &lua;
    hewn_lua_watch(&lua);
    lua_pushcfunction(L, hewn_lua_on_error);
    lua_pushcfunction(L, run_protected);
    lua_pushlightuserdata(L, &source);
    int status = lua_pcall(L, 1, 0, 1);
    hewn_result result = HEWN_OK;
    if (status != LUA_OK || lua.stop != HEWN_LUA_RUNNING)
        result = explain(&lua, status, error);
    lua_close(L);
    HEWN_TRY(result);
    hewn_error reason = {0};
    result = hewn_field_status(scene->field, &reason);
    if (result != HEWN_OK)
        return hewn_fail_at(error, result == HEWN_OUT_OF_MEMORY ? result : HEWN_BAD_INPUT, scene->sources[0].path, 0,
                            "%s", reason.message);
    return hewn_field_set_root(scene->field, lua.root, error);
}
