/* Scenes: files that describe a field. Lua 5.4 (`.lua`) in a sandbox, and fidget's `.vm` text. docs/scene.md has the
 * language. */
#ifndef HEWN_SCENE_H
#define HEWN_SCENE_H

#include "hewn/sampling.h"
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

/* How a scene wants a mesh sampled, as hewn_mesh_sampling_desc has it. */
typedef struct hewn_scene_mesh {
    double cell, band; /* 0: the default */
    bool dense;
    uint64_t memory_limit;
} hewn_scene_mesh;

/* How a scene wants heights read; only raw files need more than their path. */
typedef struct hewn_scene_heights {
    uint32_t columns, rows; /* 0: as the file says */
    const char *type;       /* "uint8", "uint16", "float" ...; NULL: uint16 */
    bool big_endian;
    uint64_t offset; /* bytes before the first value */
} hewn_scene_heights;

/* What came of a mesh. */
typedef struct hewn_scene_sampled {
    char *path; /* as messages show it */
    bool is_mesh;
    double cell;                 /* of a mesh */
    double confidence, doubtful; /* of a mesh, as hewn_mesh_sampling_report has them */
    uint64_t bytes;
} hewn_scene_sampled;

/* Who reads the files that a scene samples: hewn_scene_reader_standard() of hewn/voxelize_job.h does. */
typedef struct hewn_scene_reader {
    hewn_result (*mesh)(const char *path, const hewn_scene_mesh *how, hewn_sampling **out, hewn_sampling_place *place,
                        hewn_scene_sampled *report, hewn_error *error);
    hewn_result (*heights)(const char *path, const hewn_scene_heights *how, hewn_sampling **out, hewn_error *error);
} hewn_scene_reader;

typedef struct hewn_scene_desc {
    const char *path;         /* the scene's file; "-" reads standard input */
    hewn_scene_format format; /* needed for "-" */
    const hewn_scene_setting *settings;
    size_t setting_count;
    bool allow_path;                 /* let files that the scene asks for lie outside its folder */
    uint64_t instruction_limit;      /* Lua VM instructions; 0 is 200 million */
    uint64_t memory_limit;           /* bytes of the Lua state; 0 is 256 MiB */
    const hewn_scene_reader *reader; /* NULL: a scene that samples files is refused */
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
HEWN_API size_t hewn_scene_file_count(const hewn_scene *scene);    /* the scene and every file it imported */
HEWN_API size_t hewn_scene_sampled_count(const hewn_scene *scene); /* files that it sampled */
HEWN_API const hewn_scene_sampled *hewn_scene_sampled_at(const hewn_scene *scene, size_t index);
HEWN_API const char *hewn_scene_file(const hewn_scene *scene, size_t index);

#ifdef __cplusplus
}
#endif
#endif
