/* The part of a command line that says which scene to run and how: SCENE, -D, --from, --allow-path. */
#ifndef HEWN_SRC_APP_SCENE_ARGUMENTS_H
#define HEWN_SRC_APP_SCENE_ARGUMENTS_H

#include "app/options.h"
#include "hewn/io.h"
#include "hewn/scene.h"

typedef struct hewn_scene_arguments {
    hewn_scene_desc desc; /* points into argv and into what follows */
    hewn_scene_setting *settings;
    char **names; /* of the settings */
    size_t count;
} hewn_scene_arguments;

/* Takes the one operand and these options. HEWN_INVALID_ARGUMENT, HEWN_OUT_OF_MEMORY; destroy in any case. */
hewn_result hewn_scene_arguments_read(const hewn_arguments *arguments, hewn_scene_arguments *out, hewn_error *error);

/* The same where the operand may also be a mesh, which --from may say: `*mesh` is then its format. */
hewn_result hewn_scene_arguments_read_mesh_too(const hewn_arguments *arguments, hewn_scene_arguments *out,
                                               hewn_mesh_format *mesh, hewn_error *error);
void hewn_scene_arguments_destroy(hewn_scene_arguments *scene);

#endif
