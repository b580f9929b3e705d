/* The Lua front end: one interpreter a scene, closed again once the field is built. */
#ifndef HEWN_SRC_SCENE_LUA_STATE_H
#define HEWN_SRC_SCENE_LUA_STATE_H

#include <lauxlib.h>
#include <lua.h>
#include <lualib.h>

#include "scene/scene.h"

/* Why a scene is stopped for good. */
typedef enum hewn_lua_stop {
    HEWN_LUA_RUNNING = 0,
    HEWN_LUA_STOP_INSTRUCTIONS,
    HEWN_LUA_STOP_TIME,
    HEWN_LUA_STOP_MEMORY,
    HEWN_LUA_STOP_BLOCK, /* one string or buffer alone is too large */
    HEWN_LUA_STOP_HOST_MEMORY
} hewn_lua_stop;

/* Where a script stands. */
typedef struct hewn_lua_place {
    char file[256];
    uint32_t line;
} hewn_lua_place;

typedef struct hewn_lua {
    lua_State *L;
    hewn_scene *scene;
    hewn_lua_limits limits;
    hewn_lua_stop stop; /* once set it stays, and every further step of the script fails */
    hewn_lua_place stop_place;
    uint64_t instructions;   /* run so far, to the precision of the count hook */
    uint64_t memory;         /* bytes that Lua holds */
    uint64_t clock_looked;   /* coarse clock at the last look at the processor's time, ns */
    uint64_t processor_from; /* processor time of the thread at the start, ns */
    unsigned refusals;       /* allocations refused so far */
    hewn_lua_stop refusal;   /* why the last one was, and where */
    hewn_lua_place refusal_place;
    size_t printed;        /* bytes that print() has written */
    unsigned import_depth; /* files whose import is under way; 0 in the scene's own file */
    hewn_node root;
} hewn_lua;

static inline hewn_lua *hewn_lua_of(lua_State *L)
{
    return *(hewn_lua **)lua_getextraspace(L);
}

/* --- lua_limits.c ------------------------------------------------------------------------------------------------ */

/* Strings are kept this short, so that what C code does with a few of them is done in milliseconds. */
#define HEWN_LUA_STRING_LIMIT ((size_t)1 << 20)
#define HEWN_LUA_TABLE_LIMIT ((lua_Integer)1 << 20)

void *hewn_lua_allocate(void *user, void *block, size_t old_size, size_t new_size);

/* Starts counting instructions and time. */
void hewn_lua_watch(hewn_lua *lua);

/* Raises a Lua error if the scene has used up its time or memory; called from C functions that work for long. */
void hewn_lua_check(lua_State *L);

/* The thread's processor time, and what was used since then is not the script's: reading and sampling files. */
uint64_t hewn_lua_pause(void);
void hewn_lua_resume(hewn_lua *lua, uint64_t paused);

/* Raises a Lua error if the scene is stopped, or if `status` says that Lua ran out of memory. What pcall() calls, so
 * that no script lives on past its limits. */
void hewn_lua_check_status(lua_State *L, int status);

/* One sentence on why the scene was stopped. */
void hewn_lua_describe_stop(const hewn_lua *lua, char *out, size_t capacity);

/* --- lua_run.c --------------------------------------------------------------------------------------------------- */

/* Loads a file's text and leaves the chunk on the stack, or an error message, and returns Lua's status. */
int hewn_lua_load(lua_State *L, const char *path, const char *text, size_t length);

/* Raises an error that lies at a place of its own. */
int hewn_lua_raise_at(lua_State *L, const char *path, uint32_t line, const char *message);

/* A message handler: makes any error object a string that begins with file and line. */
int hewn_lua_on_error(lua_State *L);

/* The innermost script function under way: false if there is none. */
bool hewn_lua_find_place(lua_State *L, hewn_lua_place *out);

/* --- what a script can call -------------------------------------------------------------------------------------- */

/* Each adds its functions to the globals, those of them that also are methods of fields to the table at `methods`. */
void hewn_lua_open_base(lua_State *L);
void hewn_lua_open_strings(lua_State *L);
void hewn_lua_open_tables(lua_State *L);
int hewn_lua_open_fields(lua_State *L); /* leaves the table of methods on the stack and returns its index */
void hewn_lua_open_arithmetic(lua_State *L, int methods);
void hewn_lua_open_catalogue(lua_State *L, int methods);
void hewn_lua_open_shapes(lua_State *L);
void hewn_lua_open_combining(lua_State *L, int methods);
void hewn_lua_open_paint(lua_State *L, int methods);
void hewn_lua_open_moving(lua_State *L, int methods);
void hewn_lua_open_scene(lua_State *L);
void hewn_lua_open_import(lua_State *L);
void hewn_lua_open_text(lua_State *L);
void hewn_lua_open_sampled(lua_State *L);

/* --- lua_import.c: files ------------------------------------------------------------------------------------------ */

/* Finds a file that a script names, beside the file that says it: pushes its path as messages show it and its real
 * path. Raises an error, which begins with the name of the function that asks, where it is not to be found or lies
 * where the scene may not reach. */
void hewn_lua_find_file(lua_State *L, const char *function, const char *name);

/* Notes a file among the scene's, once. */
hewn_result hewn_lua_note_file(hewn_scene *scene, const char *path, const char *real, hewn_error *reason);

/* --- lua_field.c: values and arguments --------------------------------------------------------------------------- */

/* Raises "name: argument 2 must be WHAT, not a string". */
int hewn_lua_argument_error(lua_State *L, int argument, const char *name, const char *what);

/* Raises an error unless the call has between `least` and `most` arguments. */
void hewn_lua_check_count(lua_State *L, const char *name, int least, int most);

double hewn_lua_number(lua_State *L, int argument, const char *name);      /* finite */
double hewn_lua_positive(lua_State *L, int argument, const char *name);    /* finite, above 0 */
double hewn_lua_part(lua_State *L, int argument, const char *name);        /* from 0 to 1 */
const char *hewn_lua_string(lua_State *L, int argument, const char *name); /* without NUL inside */
bool hewn_lua_is_field(lua_State *L, int index);
hewn_node hewn_lua_field(lua_State *L, int argument, const char *name);   /* a field only */
hewn_node hewn_lua_operand(lua_State *L, int argument, const char *name); /* a field, or a number made one */

/* Pushes a field value, or raises what went wrong when it was built. Returns 1. */
int hewn_lua_push_field(lua_State *L, hewn_node node);

/* A function for globals and, where `methods` is not 0, fields. */
void hewn_lua_add_function(lua_State *L, int methods, const char *name, lua_CFunction function);

#endif
