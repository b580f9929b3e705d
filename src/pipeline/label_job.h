/* Jobs from label volume to mesh files: read, mesh all labels at once, smooth them together, prove each shell, write.
 */
#ifndef HEWN_SRC_PIPELINE_LABEL_JOB_H
#define HEWN_SRC_PIPELINE_LABEL_JOB_H

#include "hewn/file_job.h"
#include "hewn/labels.h"
#include "hewn/volume_io.h"

/* Zero everywhere but `input`, `output` and `read.format` is a sensible default. */
typedef struct hewn_label_job_desc {
    const char *input; /* "-" is standard input */
    hewn_volume_read_desc read;
    uint64_t frame;
    const int64_t *labels; /* as in hewn_label_desc */
    size_t label_count;
    const char *names;                  /* a table file; NULL: none */
    const hewn_body_choice *keep;       /* as in hewn_label_desc; volumes are in the volume's unit */
    uint32_t relaxations;               /* as in hewn_label_desc */
    const hewn_file_smooth *smooth;     /* after that, all shells together; its mask is not looked at. NULL: none */
    const hewn_simplify_desc *simplify; /* after that, all shells together, lengths in the volume's unit. NULL: none */
    const char *output;  /* a file for all labels; or, a file each: a folder (ending in /, or one that is there) or a
                            name  with {label} or {name} in it */
    hewn_mesh_format to; /* HEWN_MESH_UNKNOWN: from the output's extension; in a folder STL */
    bool complex;        /* write the mesh that the shells share, with the labels on both sides of each face */
    const hewn_unit
        *unit;        /* what the volume is in, whatever it says; NULL: as it says, else mm where it is anatomical */
    hewn_space space; /* to write in; HEWN_SPACE_DEFAULT: glTF's in GLB, else RAS, or the volume's world */
    const hewn_unit *to_unit;
    const hewn_axis *to_up;
    const char *report; /* file for the report as JSON; "-" is standard output; NULL: none */
    double began;
    const hewn_progress *progress; /* or NULL */
} hewn_label_job_desc;

/* What is known of one label. */
typedef struct hewn_label_fact {
    int64_t label;
    char *name;
    char *path; /* of its own file; NULL: there is one for all */
    uint8_t color[4];
    uint64_t voxels, vertices, faces;
    hewn_certificate certificate; /* in the output's unit */
} hewn_label_fact;

/* Zero is the empty one; leave it with hewn_label_report_destroy(). */
typedef struct hewn_label_report {
    char *input, *output;
    hewn_label_fact *labels;
    int64_t *missing; /* labels that were asked for but have no voxel */
    uint32_t label_count, missing_count;
    hewn_volume_format from;
    hewn_mesh_format to;
    uint32_t dims[3];
    uint32_t unnamed_count;   /* labels that the table has not; 0 where there is no table */
    uint64_t vertices, faces; /* of the mesh that the shells share */
    hewn_body_counts islands; /* all 0 where no choice of them was asked for */
    hewn_smooth_report smooth;
    hewn_simplify_report simplify;
    hewn_conversion conversion;  /* from the volume's unit, in `space`, to the output */
    hewn_report_stage stages[8]; /* load, label, smooth, simplify, certify, write */
    uint64_t peak_host_bytes;
    double seconds;
    uint32_t stage_count;
    uint32_t relaxations;
    hewn_smooth_method smooth_method; /* where it was smoothed */
    bool smoothed, simplified;
    hewn_space space;
    bool anatomical;
    bool unit_assumed; /* nobody said the unit, and millimetres were taken */
    bool up_known;
} hewn_label_report;

/* Runs a job. What can be refused early is, before the volume is read; nothing is left behind after a failure, but
 * files that were there before and were written over. HEWN_INVALID_ARGUMENT for a description that makes no sense, a
 * frame that is not there, or files of two labels that would have one name; HEWN_BAD_INPUT for a volume or table that
 * cannot be read or used; HEWN_IO for an output that cannot be written; HEWN_LIMIT, HEWN_OUT_OF_MEMORY,
 * HEWN_CANCELLED; HEWN_INTERNAL if a proof fails. */
hewn_result hewn_labels_convert(const hewn_label_job_desc *desc, hewn_label_report *out, hewn_error *error);

/* As JSON (docs/labels.md) to a file, "-" is standard output. HEWN_IO, HEWN_OUT_OF_MEMORY. */
hewn_result hewn_label_report_write(const hewn_label_report *report, const char *path, hewn_error *error);

void hewn_label_report_destroy(hewn_label_report *report);

#endif
