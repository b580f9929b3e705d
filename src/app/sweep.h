/* --sweep NAME=FROM:TO:COUNT: the same command once for each of a row of values of a scene's parameter, its outputs
 * numbered. */
#ifndef HEWN_SRC_APP_SWEEP_H
#define HEWN_SRC_APP_SWEEP_H

#include "app/scene_arguments.h"

#define HEWN_OPTION_SWEEP                                                                                              \
    {                                                                                                                  \
        0, "sweep", "NAME=FROM:TO:COUNT",                                                                              \
            "Do it COUNT times, while the scene's parameter NAME goes from FROM to TO in even steps, and write "       \
            "FILE-0001, FILE-0002 and so on (before the extension). Stops at the first step that fails."               \
    }

enum { HEWN_SWEEP_MOST = 100000 };

typedef struct hewn_sweep {
    char *name;
    double from, to;
    uint32_t count;               /* 0: no sweep was asked for */
    hewn_scene_setting *settings; /* those of -D, and the parameter's */
    size_t setting_count;
} hewn_sweep;

/* Reads the option, if it is there; destroy in any case. HEWN_INVALID_ARGUMENT also where -D sets the same parameter,
 * or the scene is standard input. */
hewn_result hewn_sweep_read(const hewn_arguments *arguments, const hewn_scene_arguments *scene, hewn_sweep *out,
                            hewn_error *error);
void hewn_sweep_destroy(hewn_sweep *sweep);

/* Gives the parameter its value of step `step` (from 0), in what `scene` is to be loaded with. */
void hewn_sweep_set(hewn_sweep *sweep, uint32_t step, hewn_scene_desc *scene);

/* The name of a step's file: "folder/name-0001.ply". Owned by the caller (hewn_free), NULL when out of memory. */
char *hewn_sweep_path(const hewn_sweep *sweep, const char *path, uint32_t step);

/* Says in front of an error at which step it came, and returns `result`. */
hewn_result hewn_sweep_blame(const hewn_sweep *sweep, uint32_t step, hewn_result result, hewn_error *error);

#endif
