/* `hewn convert VOLUME --labels ...`. */
#ifndef HEWN_SRC_APP_LABEL_COMMAND_H
#define HEWN_SRC_APP_LABEL_COMMAND_H

#include "app/app.h"
#include "app/volume_arguments.h"

#define HEWN_OPTIONS_LABELS                                                                                            \
    {0, "labels", "LIST", "The file is a volume of labels: mesh these, as 1,2,5 or 10-19; `all` are all but 0."},      \
        {0, "names", "FILE",                                                                                           \
         "Names and colours of labels: as ITK-SNAP, FreeSurfer and 3D Slicer write them, or `number name [r g b]`."},  \
        {0, "smooth-labels", "N",                                                                                      \
         "Smooth labels in N passes, each vertex within the cell between eight voxels. Default: 16; 0: not at all."},  \
    {                                                                                                                  \
        0, "complex", NULL,                                                                                            \
            "Write the mesh that the labels' surfaces share, each face once, with the labels `back` and `front` of "   \
            "it. For .ply."                                                                                            \
    }

/* Whether any of the options above is given. */
bool hewn_label_arguments_any(const hewn_arguments *arguments);

/* The command; its exit code. */
int hewn_label_command_run(const hewn_command *command, const hewn_arguments *arguments);

#endif
