/* Jobs from volume file to mesh file. */
#ifndef HEWN_VOLUME_JOB_H
#define HEWN_VOLUME_JOB_H

#include "hewn/job.h"
#include "hewn/simplify.h"
#include "hewn/smooth.h"
#include "hewn/volume_extract.h"
#include "hewn/volume_io.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What to mesh, how, and where to. Zero everywhere but `input` and `output` is a sensible default, but most volumes
 * need an iso value: without one level sets are meshed at 0 and others at Otsu's threshold. */
typedef struct hewn_volume_job_desc {
    const char *input; /* "-" is standard input */
    hewn_volume_read_desc read;
    const char *output;      /* "-" is standard output (not for GLB and 3MF) */
    hewn_mesh_format format; /* HEWN_MESH_UNKNOWN: from the output's extension */
    const char *report;      /* file for the report as JSON, written last; "-" is standard output; NULL: none */
    uint64_t frame;
    const hewn_iso *iso; /* NULL: 0 for a level set, else Otsu's threshold */
    hewn_inside inside;
    hewn_method method;
    bool open;
    /* What is done besides, in this order. Lengths and volumes are in the volume's own unit, whatever the mesh is in;
     * those of meshes in voxels' space are in voxels. Frames, labels and progress are not looked at. NULL: not done. */
    const hewn_volume_smooth_desc *filter; /* the iso value is found in what it gives */
    const hewn_body_choice *keep;          /* not with `open` */
    const hewn_smooth_desc *smooth;
    const hewn_simplify_desc *simplify;
    hewn_space space;              /* the default is glTF's for GLB, else RAS or the world */
    const hewn_unit *unit;         /* what the input is in, whatever it says itself; NULL: as it says */
    const hewn_unit *to_unit;      /* what the output shall be in; NULL: metres in glTF's space, else as it is */
    uint32_t threads;              /* on the host; 0: what OpenMP chooses */
    double began;                  /* CLOCK_MONOTONIC seconds from which the report counts; 0: when the job starts */
    const hewn_progress *progress; /* or NULL; its stages have the names of the report's */
} hewn_volume_job_desc;

enum { HEWN_VOLUME_REPORT_BINS = 32 };

/* What a job did. Zero is the empty one. Owned by whoever holds the struct; leave it with
 * hewn_volume_report_destroy(). docs/volumes.md describes the JSON that it prints as. */
typedef struct hewn_volume_report {
    char *input, *output;
    char *remark; /* what the reader had to say; NULL: nothing */
    hewn_volume_format from;
    hewn_mesh_format to;
    hewn_method method;
    hewn_space space; /* of the mesh */
    uint32_t dims[3];
    hewn_voxel type;
    double slope, intercept;
    uint64_t frame_count, frame;
    double iso_value;             /* that was used */
    hewn_iso iso;                 /* as it was asked for, or chosen */
    const hewn_unit *unit_before; /* of the volume's world; NULL: nobody knows */
    const hewn_unit *unit;        /* of the mesh; NULL: nobody knows, or voxels */
    double place[16];             /* from (i, j, k, 1) to the mesh */
    bool iso_chosen;              /* by the job, not the caller */
    bool unit_assumed;            /* unit_before is neither the file's nor the caller's word */
    bool anatomical, left_handed, open;
    bool box_shaped; /* most of the mesh is the cap: the iso value parts hardly anything off */
    /* Where the mesh is mostly its cap, or a report is written: what values there are. Bins are HEWN_VOLUME_REPORT_BINS
     * equal parts of the range. */
    bool measured;
    hewn_volume_range range;
    uint64_t bins[HEWN_VOLUME_REPORT_BINS];
    hewn_volume_extract_stats extraction;
    hewn_volume_smooth_desc filter; /* as asked for; a length of 0: the volume was not smoothed */
    bool smoothed, simplified;
    hewn_smooth_method smooth_method;
    hewn_smooth_report smooth;     /* in the mesh's unit */
    hewn_simplify_report simplify; /* likewise */
    hewn_certificate certificate;
    uint64_t vertices, faces;
    uint64_t peak_host_bytes;
    double seconds;
    hewn_report_stage stages[12]; /* load, filter, iso, measure, extract, smooth, simplify, certify, write */
    uint32_t stage_count;
} hewn_volume_report;

/* Runs a job: the mesh appears only when it is complete and was proven manifold, oriented and (but for `open`) closed.
 * What can be refused early is. HEWN_INVALID_ARGUMENT for a description that makes no sense; HEWN_BAD_INPUT for a file
 * that cannot be read or used, or without a surface at that value, then with the range of the values in the message;
 * HEWN_IO for an output that cannot be written; HEWN_LIMIT, HEWN_OUT_OF_MEMORY, HEWN_CANCELLED; HEWN_INTERNAL if the
 * proof fails. On failure nothing is left behind and `*out` is zero. `threads` other than 0 sets OpenMP's number of
 * threads for the calling thread. */
HEWN_API hewn_result hewn_volume_convert(const hewn_volume_job_desc *desc, hewn_volume_report *out, hewn_error *error);

/* Writes a report as JSON ("-": standard output). HEWN_IO, HEWN_OUT_OF_MEMORY. */
HEWN_API hewn_result hewn_volume_report_write(const hewn_volume_report *report, const char *path, hewn_error *error);

HEWN_API void hewn_volume_report_destroy(hewn_volume_report *report);

#ifdef __cplusplus
}
#endif
#endif
