/* mesh_field() and heightmap(): files that a scene samples. The scene may read them through these functions alone, and
 * only where it may import from. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "scene/lua_state.h"

enum { FILES_LIMIT = 64 };
#define BYTES_LIMIT ((uint64_t)4 << 30) /* of all samples of a scene */

/* --- options -------------------------------------------------------------------------------------------------------
 */

static void check_options(lua_State *L, const char *name, const char *const *known, const char *list)
{
    if (lua_isnoneornil(L, 2))
        return;
    if (lua_type(L, 2) != LUA_TTABLE)
        hewn_lua_argument_error(L, 2, name, "a table of options");
    for (lua_pushnil(L); lua_next(L, 2) != 0; lua_pop(L, 1)) {
        const char *key = lua_type(L, -2) == LUA_TSTRING ? lua_tostring(L, -2) : "";
        size_t i = 0;
        while (known[i] && strcmp(key, known[i]) != 0)
            i++;
        if (!known[i])
            luaL_error(L, "%s: there is no option '%s'; there are %s", name, key, list);
    }
}

/* Leaves the option on the stack; false where it is not given. */
static bool get_option(lua_State *L, const char *key)
{
    if (lua_type(L, 2) != LUA_TTABLE) {
        lua_pushnil(L);
        return false;
    }
    return lua_getfield(L, 2, key) != LUA_TNIL;
}

static double number_option(lua_State *L, const char *name, const char *key, double missing)
{
    double value = missing;
    if (get_option(L, key)) {
        value = lua_tonumber(L, -1);
        if (lua_type(L, -1) != LUA_TNUMBER || !isfinite(value))
            luaL_error(L, "%s: %s must be a finite number", name, key);
    }
    lua_pop(L, 1);
    return value;
}

static double positive_option(lua_State *L, const char *name, const char *key, double missing)
{
    bool given = get_option(L, key);
    lua_pop(L, 1);
    double value = number_option(L, name, key, missing);
    if (given && value <= 0)
        luaL_error(L, "%s: %s must be above 0, not %f", name, key, value);
    return value;
}

static bool flag_option(lua_State *L, const char *name, const char *key)
{
    if (get_option(L, key) && lua_type(L, -1) != LUA_TBOOLEAN)
        luaL_error(L, "%s: %s must be true or false", name, key);
    bool value = lua_toboolean(L, -1);
    lua_pop(L, 1);
    return value;
}

/* Two numbers above 0, or one for both. */
static bool pair_option(lua_State *L, const char *name, const char *key, double out[2])
{
    bool given = get_option(L, key);
    if (given && lua_type(L, -1) == LUA_TNUMBER) {
        out[0] = out[1] = lua_tonumber(L, -1);
    } else if (given) {
        if (lua_type(L, -1) != LUA_TTABLE || lua_rawlen(L, -1) != 2)
            luaL_error(L, "%s: %s must be a number or a list of two", name, key);
        for (int i = 0; i < 2; i++) {
            out[i] = lua_rawgeti(L, -1, i + 1) == LUA_TNUMBER ? lua_tonumber(L, -1) : NAN;
            lua_pop(L, 1);
        }
    }
    lua_pop(L, 1);
    for (int i = 0; given && i < 2; i++)
        if (!(out[i] > 0) || !isfinite(out[i]))
            luaL_error(L, "%s: %s must be above 0 and finite", name, key);
    return given;
}

/* --- files ---------------------------------------------------------------------------------------------------------
 */

static bool same_request(const hewn_scene_sampling *a, const hewn_scene_sampling *b, const char *real)
{
    if (a->report.is_mesh != b->report.is_mesh || !a->real || strcmp(a->real, real) != 0)
        return false;
    if (a->report.is_mesh)
        return a->how.mesh.cell == b->how.mesh.cell && a->how.mesh.band == b->how.mesh.band &&
               a->how.mesh.dense == b->how.mesh.dense;
    const hewn_scene_heights *one = &a->how.heights, *two = &b->how.heights;
    return one->columns == two->columns && one->rows == two->rows && strcmp(a->type, b->type) == 0 &&
           one->big_endian == two->big_endian && one->offset == two->offset;
}

/* Reads the file; the entry's strings are the scene's once it is added. */
static hewn_result read_file(hewn_scene *scene, hewn_scene_sampling *wanted, const char *real, hewn_error *reason)
{
    if (wanted->report.is_mesh)
        return scene->reader->mesh(real, &wanted->how.mesh, &wanted->sampling, &wanted->place, &wanted->report, reason);
    hewn_scene_heights how = wanted->how.heights;
    how.type = wanted->type[0] ? wanted->type : NULL;
    return scene->reader->heights(real, &how, &wanted->sampling, reason);
}

static hewn_result add(hewn_scene *scene, hewn_scene_sampling *wanted, const char *path, const char *real,
                       hewn_error *reason)
{
    uint64_t bytes = 0;
    for (size_t i = 0; i < scene->sampling_count; i++)
        bytes += scene->samplings[i].report.bytes;
    if (scene->sampling_count >= FILES_LIMIT)
        return hewn_fail(reason, HEWN_LIMIT, "a scene samples at most %d files", (int)FILES_LIMIT);
    if (bytes >= BYTES_LIMIT)
        return hewn_fail(reason, HEWN_LIMIT, "the scene's samples take more than %.0f GiB",
                         (double)BYTES_LIMIT * 0x1p-30);
    uint64_t left = BYTES_LIMIT - bytes;
    if (wanted->how.mesh.memory_limit > left && wanted->report.is_mesh)
        wanted->how.mesh.memory_limit = left;
    HEWN_TRY(hewn_lua_note_file(scene, path, real, reason));
    void *items = scene->samplings;
    HEWN_TRY(
        hewn_reserve(&items, &scene->sampling_capacity, scene->sampling_count + 1, sizeof *scene->samplings, reason));
    scene->samplings = items;
    HEWN_TRY(read_file(scene, wanted, real, reason));
    wanted->report.bytes = hewn_sampling_size(wanted->sampling);
    wanted->report.path = hewn_strdup(path);
    wanted->real = hewn_strdup(real);
    scene->samplings[scene->sampling_count++] = *wanted; /* also without its strings, so that it is freed */
    return wanted->report.path && wanted->real ? HEWN_OK
                                               : hewn_fail(reason, HEWN_OUT_OF_MEMORY, "out of memory loading a scene");
}

/* What was asked for, of the file that argument 1 names. Nothing of ours is held where Lua can raise an error. */
static const hewn_scene_sampling *sample(lua_State *L, const char *name, hewn_scene_sampling *wanted)
{
    hewn_lua *lua = hewn_lua_of(L);
    hewn_scene *scene = lua->scene;
    const char *file = hewn_lua_string(L, 1, name);
    if (!scene->reader)
        luaL_error(L, "%s: this program reads no such files for a scene", name);
    hewn_lua_find_file(L, name, file);
    const char *path = lua_tostring(L, -2), *real = lua_tostring(L, -1);
    for (size_t i = 0; i < scene->sampling_count; i++)
        if (same_request(&scene->samplings[i], wanted, real))
            return &scene->samplings[i];
    hewn_error reason = {0};
    uint64_t paused = hewn_lua_pause();
    hewn_result result = add(scene, wanted, path, real, &reason);
    hewn_lua_resume(lua, paused);
    if (result != HEWN_OK)
        luaL_error(L, "%s: '%s': %s", name, file, reason.message);
    return &scene->samplings[scene->sampling_count - 1];
}

/* mesh_field(file [, {cell =, band =, dense =, memory =}]) */
static int mesh_field(lua_State *L)
{
    static const char name[] = "mesh_field";
    static const char *const known[] = {"cell", "band", "dense", "memory", NULL};
    enum { DEFAULT_MEBIBYTES = 2048 };
    hewn_lua_check_count(L, name, 1, 2);
    check_options(L, name, known, "cell, band, dense, memory");
    hewn_scene_sampling wanted = {.report = {.is_mesh = true}};
    wanted.how.mesh.cell = positive_option(L, name, "cell", 0);
    wanted.how.mesh.band = positive_option(L, name, "band", 0);
    wanted.how.mesh.dense = flag_option(L, name, "dense");
    double mebibytes = positive_option(L, name, "memory", DEFAULT_MEBIBYTES);
    wanted.how.mesh.memory_limit = (uint64_t)fmin(fmax(1, mebibytes * 0x1p20), (double)BYTES_LIMIT);
    const hewn_scene_sampling *made = sample(L, name, &wanted);
    return hewn_lua_push_field(L, hewn_sampled(hewn_lua_of(L)->scene->field, made->sampling, &made->place));
}

/* heightmap(file, {size =, height =, dims =, type =, endian =, offset =}) */
static int heightmap(lua_State *L)
{
    static const char name[] = "heightmap";
    static const char *const known[] = {"size", "height", "dims", "type", "endian", "offset", NULL};
    double size[2], dims[2] = {0, 0};
    hewn_lua_check_count(L, name, 2, 2);
    if (lua_type(L, 2) != LUA_TTABLE)
        hewn_lua_argument_error(L, 2, name, "a table of options");
    check_options(L, name, known, "size, height, dims, type, endian, offset");
    if (!pair_option(L, name, "size", size))
        luaL_error(L, "%s: it needs a size: how far it goes along x and y, as {100, 80}", name);
    double height = number_option(L, name, "height", 1);
    hewn_scene_sampling wanted = {0};
    if (pair_option(L, name, "dims", dims) &&
        (dims[0] != floor(dims[0]) || dims[1] != floor(dims[1]) || dims[0] > 1e5 || dims[1] > 1e5))
        luaL_error(L, "%s: dims must be whole numbers: columns and rows", name);
    wanted.how.heights.columns = (uint32_t)dims[0];
    wanted.how.heights.rows = (uint32_t)dims[1];
    double offset = number_option(L, name, "offset", 0);
    if (offset < 0 || offset != floor(offset) || offset > 0x1p50)
        luaL_error(L, "%s: offset must be a whole number of bytes", name);
    wanted.how.heights.offset = (uint64_t)offset;
    if (get_option(L, "type")) {
        const char *type = lua_type(L, -1) == LUA_TSTRING ? lua_tostring(L, -1) : "";
        if (strlen(type) == 0 || strlen(type) >= sizeof wanted.type)
            luaL_error(L, "%s: type must be \"uint8\", \"uint16\", \"float\" or the like", name);
        snprintf(wanted.type, sizeof wanted.type, "%s", type);
    }
    lua_pop(L, 1);
    if (get_option(L, "endian")) {
        const char *endian = lua_type(L, -1) == LUA_TSTRING ? lua_tostring(L, -1) : "";
        wanted.how.heights.big_endian = strcmp(endian, "big") == 0;
        if (!wanted.how.heights.big_endian && strcmp(endian, "little") != 0)
            luaL_error(L, "%s: endian must be \"little\" or \"big\"", name);
    }
    lua_pop(L, 1);
    const hewn_scene_sampling *made = sample(L, name, &wanted);
    return hewn_lua_push_field(L, hewn_heights(hewn_lua_of(L)->scene->field, made->sampling, size[0], size[1], height));
}

void hewn_lua_open_sampled(lua_State *L)
{
    hewn_lua_add_function(L, 0, "mesh_field", mesh_field);
    hewn_lua_add_function(L, 0, "heightmap", heightmap);
}
