/* `hewn convert` of a volume. */
#ifndef HEWN_SRC_APP_VOLUME_CONVERT_H
#define HEWN_SRC_APP_VOLUME_CONVERT_H

#include "app/app.h"

#define HEWN_OPTIONS_VOLUME_MESH                                                                                       \
    {0, "method", "NAME",                                                                                              \
     "Of a volume: mc33 (connected as the trilinear interpolant of the samples is), mc (marching cubes by signs "      \
     "alone), nets (surface nets: vertices in cells, at the mean of the crossings) or dc (dual contouring: where "     \
     "their planes meet, which keeps edges). Default: mc33."},                                                         \
        {0, "inside", "SIDE",                                                                                          \
         "What of a volume is inside: above (values from the iso value on) or below. Default: below of a level set, "  \
         "else above."},                                                                                               \
        {0, "space", "SPACE",                                                                                          \
         "Write a volume's mesh in ras or lps (of the patient), gltf (+Y up, front to +Z, in metres), world (as the "  \
         "file has it) or voxel (i, j, k). Default: gltf for GLB, else ras, or world where the file knows no "         \
         "patient."},                                                                                                  \
        {0, "smooth-volume", "LENGTH",                                                                                 \
         "First smooth a volume's values by a Gaussian of this standard deviation, in the volume's unit (mm of a "     \
         "patient); median:LENGTH takes the median within that radius."},                                              \
        {0, "largest", "N", "Keep the N largest bodies, by their volume; of labels, each one's N largest islands."},   \
        {0, "min-volume", "V", "Keep bodies of at least this volume, in the volume's unit cubed (mm3 of a patient)."}, \
        {0, "fill-cavities", NULL,                                                                                     \
         "Fill the hollows in bodies, with what lies in them; of labels, those with one label around."},               \
        {0, "open", NULL,                                                                                              \
         "Leave the surface open where it leaves the volume. Default: close it there with a flat cap."},               \
        {0, "max-memory", "SIZE",                                                                                      \
         "Mesh a volume in parts that take at most SIZE bytes of memory; K, M and G stand for 2^10, 2^20 and 2^30. A " \
         "raw, .nrrd, .mha or .nii file that is not compressed is read slab by slab. The parts wait on disk beside "   \
         "the output, and the mesh is the same. Default: no limit. What is sampled into a volume is refused where it " \
         "takes more. Default: 2G."},                                                                                  \
    {                                                                                                                  \
        0, "threads", "N", "Mesh a volume with N threads. Default: one for each processor."                            \
    }

/* Whether any of the options above is given, or of those that say how a volume is read. */
bool hewn_volume_convert_any(const hewn_arguments *arguments);

/* Reads the arguments, runs the job and prints what was done, unless quiet. Returns the exit code. */
int hewn_volume_convert_run(const hewn_command *command, const hewn_arguments *arguments, hewn_volume_format format);

#endif
