/* Scenes: files that describe a field. Lua 5.4 (`.lua`) in a sandbox, and fidget's `.vm` text. docs/scene.md has the
 * language. */
#ifndef HEWN_SCENE_H
#define HEWN_SCENE_H

#include "hewn/field.h"
#include "hewn/units.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct hewn_scene hewn_scene;

typedef enum hewn_scene_format {
    HEWN_SCENE_BY_NAME, /* from the file's extension */
    HEWN_SCENE_LUA,
    HEWN_SCENE_VM
} hewn_scene_format;

/* One `-D name=value`. */
typedef struct hewn_scene_setting {
    const char *name;
    double value;
} hewn_scene_setting;

typedef struct hewn_scene_desc {
    const char *path;         /* the scene's file; "-" reads standard input */
    hewn_scene_format format; /* needed for "-" */
    const hewn_scene_setting *settings;
    size_t setting_count;
    bool allow_path;            /* let files that the scene asks for lie outside its folder */
    uint64_t instruction_limit; /* Lua VM instructions; 0 is 200 million */
    uint64_t memory_limit;      /* bytes of the Lua state; 0 is 256 MiB */
} hewn_scene_desc;

/* What a scene says of a parameter that it takes. */
typedef struct hewn_scene_parameter {
    const char *name;
    const char *help; /* or NULL */
    double initial;
    double value;  /* in force: initial, or what a setting said */
    double lo, hi; /* range, infinite where none was given */
    bool integer;
} hewn_scene_parameter;

/* Reads and runs a scene. HEWN_BAD_INPUT with file and line for a scene's own errors (also: a limit exceeded, an
 * unknown setting, a value outside its range), HEWN_IO for a file that cannot be read. */
HEWN_API hewn_result hewn_scene_load(const hewn_scene_desc *desc, hewn_scene **out, hewn_error *error);
HEWN_API void hewn_scene_destroy(hewn_scene **scene);

/* All that follows is owned by the scene and lives as long as it; safe from any thread. */
HEWN_API const hewn_field *hewn_scene_field(const hewn_scene *scene); /* its root is set */
HEWN_API size_t hewn_scene_parameter_count(const hewn_scene *scene);
HEWN_API const hewn_scene_parameter *hewn_scene_parameter_at(const hewn_scene *scene, size_t index);
HEWN_API bool hewn_scene_bounds(const hewn_scene *scene, hewn_box *out); /* false where the scene gives none */
HEWN_API const hewn_unit *hewn_scene_unit(const hewn_scene *scene);      /* metres by default */
HEWN_API double hewn_scene_metres_per_unit(const hewn_scene *scene);     /* the unit's length */
HEWN_API hewn_axis hewn_scene_up(const hewn_scene *scene);
HEWN_API size_t hewn_scene_file_count(const hewn_scene *scene); /* the scene and every file it imported */
HEWN_API const char *hewn_scene_file(const hewn_scene *scene, size_t index);

#ifdef __cplusplus
}
#endif
#endif
