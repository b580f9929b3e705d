/* import "part.lua": another file's result. Each file runs once a scene; what it returned is kept. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/file.h"
#include "scene/lua_state.h"

enum { DEPTH_LIMIT = 16, FILE_LIMIT = 1000 };

static const char results_key[] = "hewn.imports"; /* in the registry: real path -> result, or one of the two below */
static const char under_way[] = "hewn.under_way";
static const char no_result[] = "hewn.no_result";

/* The path of the script file that is calling, or that of the scene. */
static const char *calling_file(lua_State *L)
{
    lua_Debug record;
    for (int level = 1; lua_getstack(L, level, &record); level++) {
        lua_getinfo(L, "S", &record);
        if (record.source[0] == '@')
            return record.source + 1;
    }
    return hewn_lua_of(L)->scene->sources[0].path;
}

void hewn_lua_find_file(lua_State *L, const char *function, const char *name)
{
    const hewn_scene *scene = hewn_lua_of(L)->scene;
    if (name[0] == '/' && scene->root)
        luaL_error(L, "%s: '%s' is an absolute path; a scene's files stay in its folder (--allow-path lets it)",
                   function, name);
    char *path = hewn_path_beside(calling_file(L), name);
    char *real = path ? hewn_path_real(path) : NULL;
    int code = errno;
    char shown[512] = "", real_shown[4096] = "";
    bool fits = path && snprintf(shown, sizeof shown, "%s", path) < (int)sizeof shown;
    fits = fits && (!real || snprintf(real_shown, sizeof real_shown, "%s", real) < (int)sizeof real_shown);
    bool found = real != NULL;
    hewn_free(path); /* what follows may leave by an error: nothing of ours may be held then */
    hewn_free(real);
    struct stat status;
    if (!fits)
        luaL_error(L, "%s: the path of '%s' is too long", function, name);
    if (!found)
        luaL_error(L, "%s: cannot find '%s': %s", function, name, strerror(code));
    if (scene->root && !hewn_path_is_inside(real_shown, scene->root))
        luaL_error(L, "%s: '%s' lies outside the scene's folder (--allow-path lets it)", function, name);
    if (stat(real_shown, &status) != 0 || !S_ISREG(status.st_mode))
        luaL_error(L, "%s: '%s' is not a file", function, name);
    lua_pushstring(L, shown);
    lua_pushstring(L, real_shown);
}

static bool is_scene_itself(const hewn_scene *scene, const char *real)
{
    return scene->sources[0].real && strcmp(scene->sources[0].real, real) == 0;
}

static bool ends_in_vm(const char *path)
{
    size_t length = strlen(path);
    return length >= 3 && strcasecmp(path + length - 3, ".vm") == 0;
}

hewn_result hewn_lua_note_file(hewn_scene *scene, const char *path, const char *real, hewn_error *reason)
{
    for (size_t i = 0; i < scene->source_count; i++)
        if (scene->sources[i].real && strcmp(scene->sources[i].real, real) == 0)
            return HEWN_OK;
    if (scene->source_count >= FILE_LIMIT)
        return hewn_fail(reason, HEWN_BAD_INPUT, "a scene can use at most %d files", (int)FILE_LIMIT);
    return hewn_scene_add_source(scene, hewn_strdup(path), hewn_strdup(real), reason);
}

/* Runs a loaded chunk on the stack's top and leaves its result. */
static void run_chunk(lua_State *L)
{
    hewn_lua *lua = hewn_lua_of(L);
    lua_pushcfunction(L, hewn_lua_on_error); /* puts file and line of the imported file into the message */
    lua_insert(L, -2);
    lua->import_depth++;
    int status = lua_pcall(L, 0, 1, -2);
    lua->import_depth--;
    hewn_lua_check_status(L, status);
    if (status != LUA_OK)
        lua_error(L);
}

/* Reads and runs the file and leaves its result on the stack. Nothing of ours is held where Lua can raise an error. */
static void run_file(lua_State *L, const char *name, const char *path, const char *real)
{
    hewn_scene *scene = hewn_lua_of(L)->scene;
    hewn_error reason = {0};
    char *text = NULL;
    size_t length = 0;
    if (hewn_lua_note_file(scene, path, real, &reason) != HEWN_OK ||
        hewn_file_read(real, HEWN_SCENE_FILE_LIMIT, &text, &length, &reason) != HEWN_OK)
        luaL_error(L, "import: '%s': %s", name, reason.message);
    if (ends_in_vm(path)) {
        hewn_node node = HEWN_NODE_NONE;
        hewn_result result = hewn_vm_parse(scene->field, path, text, length, &node, &reason);
        hewn_free(text);
        if (result != HEWN_OK)
            hewn_lua_raise_at(L, path, reason.line, reason.message);
        hewn_lua_push_field(L, node);
        return;
    }
    int status = hewn_lua_load(L, path, text, length);
    hewn_free(text);
    hewn_lua_check_status(L, status);
    if (status != LUA_OK)
        lua_error(L);
    run_chunk(L);
}

/* Marks the file at stack index 3 (its real path) in the table at index 4. */
static void mark(lua_State *L, const char *state)
{
    lua_pushvalue(L, 3);
    if (state)
        lua_pushlightuserdata(L, (void *)state);
    else
        lua_pushnil(L);
    lua_rawset(L, 4);
}

/* Arguments: name, shown path, real path, table of results, as run by import() below. */
static int run_marked(lua_State *L)
{
    run_file(L, lua_tostring(L, 1), lua_tostring(L, 2), lua_tostring(L, 3));
    return 1;
}

static int import(lua_State *L)
{
    hewn_lua *lua = hewn_lua_of(L);
    hewn_lua_check_count(L, "import", 1, 1);
    hewn_lua_find_file(L, "import", hewn_lua_string(L, 1, "import"));
    luaL_getsubtable(L, LUA_REGISTRYINDEX, results_key);
    lua_pushvalue(L, 3);
    int type = lua_rawget(L, 4);
    const void *state = type == LUA_TLIGHTUSERDATA ? lua_touserdata(L, -1) : NULL;
    if (state == under_way || is_scene_itself(lua->scene, lua_tostring(L, 3)))
        return luaL_error(L, "import: '%s' is being imported already: the files import each other in a circle",
                          lua_tostring(L, 1));
    if (state == no_result)
        return 0;
    if (type != LUA_TNIL)
        return 1;
    if (lua->import_depth >= DEPTH_LIMIT)
        return luaL_error(L, "import: files import each other more than %d deep", (int)DEPTH_LIMIT);
    lua_settop(L, 4);
    mark(L, under_way);
    lua_pushcfunction(L, run_marked);
    for (int i = 1; i <= 3; i++)
        lua_pushvalue(L, i);
    int status = lua_pcall(L, 3, 1, 0);
    mark(L, NULL); /* a script that catches the error may try again */
    hewn_lua_check_status(L, status);
    if (status != LUA_OK)
        return lua_error(L);
    if (lua_isnil(L, -1)) {
        mark(L, no_result);
        return 1;
    }
    lua_pushvalue(L, 3);
    lua_pushvalue(L, -2);
    lua_rawset(L, 4);
    return 1;
}

void hewn_lua_open_import(lua_State *L)
{
    hewn_lua_add_function(L, 0, "import", import);
}
