/* Labels as small numbers, with a layer of outside around the volume. */
#ifndef HEWN_SRC_LABELS_IDS_H
#define HEWN_SRC_LABELS_IDS_H

#include "hewn/labels.h"

/* `dims` counts the layers around: sample (i, j, k) is number (i + 1) + dims[0] ((j + 1) + dims[1] (k + 1)). */
typedef struct hewn_label_ids {
    uint32_t dims[3];
    uint16_t *ids;         /* of the heap; 0 is the outside */
    uint32_t label_count;  /* ids go up to here */
    int64_t *labels;       /* of id n at n - 1, ascending */
    uint64_t *voxel_count; /* likewise */
} hewn_label_ids;

/* The errors of hewn_labels_mesh(); free it also then. */
hewn_result hewn_label_ids_find(const hewn_volume *volume, const hewn_label_desc *desc, hewn_label_ids *out,
                                hewn_error *error);
void hewn_label_ids_free(hewn_label_ids *ids);

#endif
