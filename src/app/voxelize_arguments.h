/* What `hewn voxelize` and `hewn convert SCENE -o VOLUME` share. */
#ifndef HEWN_SRC_APP_VOXELIZE_ARGUMENTS_H
#define HEWN_SRC_APP_VOXELIZE_ARGUMENTS_H

#include "app/app.h"

#define HEWN_OPTIONS_VOXELIZE                                                                                          \
    {0, "cell", "LENGTH", "The distance of samples, in the input's unit. Default: a 128th of the longest side."},      \
        {0, "band", "CELLS",                                                                                           \
         "Keep distances up to so many cells from the surface; past that only which side it is. Default: 3."},         \
        {0, "dense", NULL, "Keep all distances of the box, not those near the surface alone."},                        \
        {0, "bounds", "BOX",                                                                                           \
         "The part of a scene to sample, x0,y0,z0,x1,y1,z1. Default: the scene's own, or found from its field."},      \
        {'D', NULL, "NAME=VALUE", "Set a parameter of a scene. May be repeated."},                                     \
    {                                                                                                                  \
        0, "allow-path", NULL, "Let a scene read files outside its own folder."                                        \
    }

/* As `hewn convert` has it for volumes too. */
#define HEWN_OPTION_MOST_SAMPLES                                                                                       \
    {                                                                                                                  \
        0, "max-memory", "SIZE",                                                                                       \
            "Refuse samples that would take more than SIZE bytes; K, M and G stand for 2^10, 2^20 and 2^30. Default: " \
            "2G."                                                                                                      \
    }

/* Whether the arguments ask for a volume of a scene or a mesh: by the input's or the output's name, --from or --to. */
bool hewn_voxelize_wanted(const hewn_arguments *arguments);

/* HEWN_INVALID_ARGUMENT where one of these options is given, for conversions of other kinds. */
hewn_result hewn_voxelize_refuse(const hewn_arguments *arguments, hewn_error *error);

/* Runs it all, and returns the exit code. The table of options has those above, max-memory, output, from, to, unit,
 * report and quiet. */
int hewn_voxelize_run(const hewn_command *command, const hewn_arguments *arguments);

#endif
