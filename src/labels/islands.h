/* Islands of labels and hollows in them, taken out before anything is meshed. */
#ifndef HEWN_SRC_LABELS_ISLANDS_H
#define HEWN_SRC_LABELS_ISLANDS_H

#include "labels/ids.h"

/* Keeps of each label the islands that `choice` wants and fills hollows of the outside that only one label is around;
 * volumes are those of voxels, `voxel` each. Labels without voxels are left out, and the others numbered anew.
 * HEWN_BAD_INPUT where none would be left; HEWN_LIMIT for 2^32 runs of voxels; HEWN_OUT_OF_MEMORY. */
hewn_result hewn_label_islands_choose(hewn_label_ids *ids, const hewn_body_choice *choice, double voxel,
                                      hewn_body_counts *counts, hewn_error *error);

#endif
