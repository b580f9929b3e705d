/* What a script may use: instructions, memory, and processor time, which bounds what instructions alone do not: long
 * work inside one C function.
 *
 * A limit once exceeded stays exceeded: the count hook then fires at every instruction, every growing allocation fails,
 * and pcall() raises again what it caught. */
#include <stdio.h>
#include <time.h>

#include "base/alloc.h"
#include "field/graph.h"
#include "scene/lua_state.h"

enum {
    HOOK_INTERVAL = 256,
    REFUSALS = 16, /* each costs a whole garbage collection */
    NODE_BYTES = 128,
    STOPPED_BLOCK = 4096,   /* what a stopped scene may still allocate at once, */
    STOPPED_SLACK = 4 << 20 /* and in all above its limit */
};

#define LOOK_INTERVAL ((uint64_t)8000000)    /* ns between looks at the processor's time */
#define LEAST_TIME ((uint64_t)500000000)     /* ns */
#define TIME_PER_INSTRUCTION ((uint64_t)100) /* ns; an order of magnitude above what one takes */
#define BLOCK_LIMIT ((size_t)64 << 20)       /* bytes of one table or buffer */
#define UNLIMITED ((uint64_t)1 << 60)

static uint64_t read_clock(clockid_t id)
{
    struct timespec now = {0};
    clock_gettime(id, &now);
    return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}

uint64_t hewn_lua_pause(void)
{
    return read_clock(CLOCK_THREAD_CPUTIME_ID);
}

void hewn_lua_resume(hewn_lua *lua, uint64_t paused)
{
    lua->processor_from += read_clock(CLOCK_THREAD_CPUTIME_ID) - paused;
}

static uint64_t time_limit(const hewn_lua *lua)
{
    if (lua->limits.instructions > UNLIMITED / TIME_PER_INSTRUCTION)
        return UNLIMITED;
    uint64_t limit = lua->limits.instructions * TIME_PER_INSTRUCTION;
    return limit < LEAST_TIME ? LEAST_TIME : limit;
}

void hewn_lua_describe_stop(const hewn_lua *lua, char *out, size_t capacity)
{
    switch (lua->stop) {
    case HEWN_LUA_RUNNING: snprintf(out, capacity, "the scene is not stopped"); break;
    case HEWN_LUA_STOP_INSTRUCTIONS:
        snprintf(out, capacity, "the scene ran more than %llu instructions: an endless loop?",
                 (unsigned long long)lua->limits.instructions);
        break;
    case HEWN_LUA_STOP_TIME:
        snprintf(out, capacity, "the scene took more than %.3g s of processor time", 1e-9 * (double)time_limit(lua));
        break;
    case HEWN_LUA_STOP_MEMORY:
        snprintf(out, capacity, "the scene needs more than %.3g MiB of memory",
                 (double)lua->limits.memory / (1024.0 * 1024.0));
        break;
    case HEWN_LUA_STOP_BLOCK: snprintf(out, capacity, "the scene makes a string or table that is too large"); break;
    case HEWN_LUA_STOP_HOST_MEMORY: snprintf(out, capacity, "out of memory running a scene"); break;
    }
}

/* --- stopping ---------------------------------------------------------------------------------------------------- */

static void on_count(lua_State *L, lua_Debug *record);

static void stop(hewn_lua *lua, hewn_lua_stop why, const hewn_lua_place *place)
{
    if (lua->stop != HEWN_LUA_RUNNING)
        return;
    lua->stop = why;
    if (place)
        lua->stop_place = *place;
    else
        hewn_lua_find_place(lua->L, &lua->stop_place);
    lua_sethook(lua->L, on_count, LUA_MASKCOUNT, 1);
}

static int raise_stop(lua_State *L)
{
    char reason[160];
    hewn_lua_describe_stop(hewn_lua_of(L), reason, sizeof reason);
    return luaL_error(L, "%s", reason);
}

static uint64_t field_bytes(const hewn_lua *lua);

/* Sets `stop` where time or memory is used up. The coarse clock costs a few nanoseconds and the processor's time a
 * system call, so the latter is asked only when the former has moved. */
static void look(hewn_lua *lua)
{
    if (lua->stop != HEWN_LUA_RUNNING)
        return;
    if (lua->memory + field_bytes(lua) > lua->limits.memory) {
        stop(lua, HEWN_LUA_STOP_MEMORY, NULL);
        return;
    }
    uint64_t now = read_clock(CLOCK_MONOTONIC_COARSE);
    if (now - lua->clock_looked < LOOK_INTERVAL)
        return;
    lua->clock_looked = now;
    if (read_clock(CLOCK_THREAD_CPUTIME_ID) - lua->processor_from > time_limit(lua))
        stop(lua, HEWN_LUA_STOP_TIME, NULL);
}

static void on_count(lua_State *L, lua_Debug *record)
{
    (void)record;
    hewn_lua *lua = hewn_lua_of(L);
    lua->instructions += HOOK_INTERVAL;
    if (lua->instructions > lua->limits.instructions)
        stop(lua, HEWN_LUA_STOP_INSTRUCTIONS, NULL);
    look(lua);
    if (lua->stop != HEWN_LUA_RUNNING)
        raise_stop(L);
}

void hewn_lua_watch(hewn_lua *lua)
{
    lua->clock_looked = read_clock(CLOCK_MONOTONIC_COARSE);
    lua->processor_from = read_clock(CLOCK_THREAD_CPUTIME_ID);
    lua_sethook(lua->L, on_count, LUA_MASKCOUNT, HOOK_INTERVAL);
}

void hewn_lua_check(lua_State *L)
{
    hewn_lua *lua = hewn_lua_of(L);
    look(lua);
    if (lua->stop != HEWN_LUA_RUNNING)
        raise_stop(L);
}

void hewn_lua_check_status(lua_State *L, int status)
{
    hewn_lua *lua = hewn_lua_of(L);
    if (status == LUA_ERRMEM)
        stop(lua, lua->refusal == HEWN_LUA_RUNNING ? HEWN_LUA_STOP_HOST_MEMORY : lua->refusal, &lua->refusal_place);
    if (lua->stop != HEWN_LUA_RUNNING)
        raise_stop(L);
}

/* --- memory ------------------------------------------------------------------------------------------------------ */

/* Nodes live in the field, not in Lua's memory, but a script makes them: they count, by about what one takes. */
static uint64_t field_bytes(const hewn_lua *lua)
{
    return (uint64_t)hewn_field_node_count(lua->scene->field) * NODE_BYTES;
}

static void *refuse(hewn_lua *lua, hewn_lua_stop why)
{
    lua->refusals++;
    lua->refusal = why;
    if (lua->L)
        hewn_lua_find_place(lua->L, &lua->refusal_place);
    if (lua->refusals > REFUSALS && lua->L) /* else a script at its limit collects garbage for ever */
        stop(lua, why, &lua->refusal_place);
    return NULL;
}

static void *grant(hewn_lua *lua, void *block, size_t held, size_t new_size)
{
    void *moved = hewn_realloc(block, new_size, 1);
    if (!moved && new_size <= held)
        return block; /* Lua relies on shrinking */
    if (!moved)
        return refuse(lua, HEWN_LUA_STOP_HOST_MEMORY);
    lua->memory = lua->memory - held + new_size;
    return moved;
}

void *hewn_lua_allocate(void *user, void *block, size_t old_size, size_t new_size)
{
    hewn_lua *lua = user;
    /* Without a block, Lua passes the kind of object to come in place of its size. */
    size_t held = block ? old_size : 0;
    if (new_size == 0) {
        hewn_free(block);
        lua->memory -= held;
        return NULL;
    }
    if (new_size > held) {
        bool is_string = !block && old_size == LUA_TSTRING;
        if (lua->stop != HEWN_LUA_RUNNING &&
            (new_size > STOPPED_BLOCK || lua->memory > lua->limits.memory + STOPPED_SLACK))
            return NULL;
        if (lua->stop != HEWN_LUA_RUNNING)
            return grant(lua, block, held, new_size); /* enough to raise the error that ends the scene */
        if (new_size > (is_string ? HEWN_LUA_STRING_LIMIT + 64 : BLOCK_LIMIT))
            return refuse(lua, HEWN_LUA_STOP_BLOCK);
        if (lua->memory + field_bytes(lua) + (new_size - held) > lua->limits.memory)
            return refuse(lua, HEWN_LUA_STOP_MEMORY);
    }
    return grant(lua, block, held, new_size);
}
