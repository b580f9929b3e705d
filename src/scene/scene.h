/* The inside of a hewn_scene, shared by the front ends that fill one in. */
#ifndef HEWN_SRC_SCENE_SCENE_H
#define HEWN_SRC_SCENE_SCENE_H

#include "hewn/scene.h"

/* No scene file may be longer. */
#define HEWN_SCENE_FILE_LIMIT ((size_t)64 << 20)

/* Graphs past this many nodes are refused: no scene needs them, and hostile ones would take all memory. */
#define HEWN_SCENE_NODE_LIMIT ((uint32_t)1 << 21)

typedef struct hewn_scene_source {
    char *path; /* as messages show it: the scene's own path, or one built from it */
    char *real; /* without links and dots: what tells two files apart; NULL for standard input */
} hewn_scene_source;

/* A file that was sampled, and how: the same once more is not sampled again. */
typedef struct hewn_scene_sampling {
    hewn_scene_sampled report;
    char *real; /* of the file */
    union {
        hewn_scene_mesh mesh;
        hewn_scene_heights heights;
    } how;
    char type[16]; /* that heights.type names */
    hewn_sampling *sampling;
    hewn_sampling_place place;
} hewn_scene_sampling;

struct hewn_scene {
    hewn_field *field;
    hewn_scene_sampling *samplings;
    size_t sampling_count, sampling_capacity;
    hewn_scene_parameter *parameters; /* names and help are owned */
    size_t parameter_count, parameter_capacity;
    hewn_scene_source *sources; /* the scene's own file first */
    size_t source_count, source_capacity;
    bool has_bounds;
    hewn_box bounds;
    const hewn_unit *unit; /* NULL: the scene says none */
    hewn_axis up;
    /* only while loading: */
    char *root; /* the folder that imports must stay in, without links; NULL lets them lie anywhere */
    const hewn_scene_setting *settings;
    size_t setting_count;
    const hewn_scene_reader *reader;
};

/* Loads a scene whose text is already in memory; `desc->path` names it, and imports are looked for beside that path.
 * Otherwise as hewn_scene_load. */
hewn_result hewn_scene_load_text(const hewn_scene_desc *desc, const char *text, size_t length, hewn_scene **out,
                                 hewn_error *error);

/* Adds a file and takes over both strings, also on failure. */
hewn_result hewn_scene_add_source(hewn_scene *scene, char *path, char *real, hewn_error *error);

/* --- paths ------------------------------------------------------------------------------------------------------- */

/* The folder of `path` without links and dots, or NULL (errno says why). Owned by the caller (hewn_free). */
char *hewn_path_real_folder(const char *path);

/* `path` without links and dots, or NULL (errno says why). Owned by the caller (hewn_free). */
char *hewn_path_real(const char *path);

/* `name` as seen from the folder of the file `from`: "parts/a.lua" and "b.lua" give "parts/b.lua". NULL when out of
 * memory. Owned by the caller (hewn_free). */
char *hewn_path_beside(const char *from, const char *name);

/* Whether the real path `path` lies in the real folder `folder`, at any depth. */
bool hewn_path_is_inside(const char *path, const char *folder);

/* Copies text for a message: control characters become spaces and what is no UTF-8 becomes '?'; cut at a whole
 * character where it does not fit. */
void hewn_text_clean(char *out, size_t capacity, const char *text, size_t length);

/* --- front ends -------------------------------------------------------------------------------------------------- */

/* Builds the graph of a `.vm` text in `field`. `path` is for messages. */
hewn_result hewn_vm_parse(hewn_field *field, const char *path, const char *text, size_t length, hewn_node *out,
                          hewn_error *error);

typedef struct hewn_lua_limits {
    uint64_t instructions;
    uint64_t memory;
} hewn_lua_limits;

/* Runs a Lua scene, whose file is the scene's source 0, and sets the field's root. */
hewn_result hewn_lua_run(hewn_scene *scene, const hewn_lua_limits *limits, const char *text, size_t length,
                         hewn_error *error);

#endif
