/* Where the meshes of labels go. */
#ifndef HEWN_SRC_PIPELINE_LABEL_PATHS_H
#define HEWN_SRC_PIPELINE_LABEL_PATHS_H

#include "pipeline/label_job.h"

typedef enum hewn_label_target {
    HEWN_LABELS_TOGETHER, /* one file */
    HEWN_LABELS_FOLDER,   /* a file each in a folder, by name */
    HEWN_LABELS_PATTERN   /* a file each, {label} and {name} filled in */
} hewn_label_target;

/* What a job's output means, and the format of what is written. HEWN_INVALID_ARGUMENT where nobody knows the format or
 * it cannot hold what is asked for. */
hewn_result hewn_label_target_find(const hewn_label_job_desc *desc, hewn_label_target *out, hewn_mesh_format *format,
                                   hewn_error *error);

/* Fills in the path of each label's file; the characters of names that no file can have become `_`. `single` labels may
 * go together in any format. HEWN_INVALID_ARGUMENT where two have the same; HEWN_OUT_OF_MEMORY. */
hewn_result hewn_label_paths_find(const hewn_label_job_desc *desc, hewn_label_target target, hewn_mesh_format format,
                                  hewn_label_fact *labels, uint32_t count, hewn_error *error);

/* Makes the folder of a job that has one, unless it is there; `*made` says whether it was. HEWN_IO. */
hewn_result hewn_label_folder_make(const hewn_label_job_desc *desc, hewn_label_target target, bool *made,
                                   hewn_error *error);

#endif
