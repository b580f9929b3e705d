/* Jobs from mesh file to mesh file: read, say what it is, repair, subdivide, simplify,
 * smooth, convert, write; and a report of exactly what
 * was done. */
#ifndef HEWN_FILE_JOB_H
#define HEWN_FILE_JOB_H

#include "hewn/check.h"
#include "hewn/io.h"
#include "hewn/job.h"
#include "hewn/simplify.h"
#include "hewn/smooth.h"
#include "hewn/subdivide.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Smoothing in a job; lengths are in the input's unit. */
typedef struct hewn_file_smooth {
    hewn_smooth_desc desc; /* its labels, freedom and progress are not looked at */
    bool lock_labels;      /* vertices where faces differ in label, material, group or object stay */
    const char *mask;      /* a vertex attribute of one component, 0 (stays) to 1 (bytes: to 255); NULL: none */
} hewn_file_smooth;

/* Subdivision in a job. */
typedef struct hewn_file_subdivide {
    hewn_subdivide_desc desc; /* its creases, corners and progress are not looked at */
    const char *creases;      /* a file of tags as OBJ has them, lines `t crease 2/1/0 A B SHARPNESS` and
                                 `t corner 1/1/0 V SHARPNESS` with vertices from 0; NULL: none */
    double adaptive;          /* see hewn_model_subdivide() */
    bool triangulate;         /* polygons are cut into triangles first, as Loop's scheme needs */
} hewn_file_subdivide;

/* Zero everywhere but `input` and `output` copies from format to format. */
typedef struct hewn_file_job_desc {
    const char *input;              /* "-" is standard input */
    hewn_mesh_format from;          /* HEWN_MESH_UNKNOWN: from the input's extension */
    const char *output;             /* may be the input; "-" is standard output (not for GLB and 3MF) */
    hewn_mesh_format to;            /* HEWN_MESH_UNKNOWN: from the output's extension */
    const char *report;             /* file for the report as JSON, written last; "-" is standard output; NULL: none */
    const hewn_unit *unit;          /* what the input is in, whatever it says itself; NULL: as it says */
    const hewn_axis *up;            /* likewise */
    const hewn_unit *to_unit;       /* what the output shall be in; NULL: what its format is always in, else as it is */
    const hewn_axis *to_up;         /* likewise */
    const hewn_repair_desc *repair; /* in the input's unit; its progress is not looked at. NULL: no repair */
    const hewn_file_subdivide *subdivide; /* after repair; NULL: no subdivision */
    const hewn_file_smooth *smooth;       /* after that; NULL: no smoothing */
    const hewn_simplify_desc *simplify;   /* after that, lengths in the input's unit; its labels, frozen and progress
                                             are not looked at. NULL: no simplification */
    /* Bytes that the whole process may take at most, as the system counts what is resident, pages of files included; 0:
     * no limit. Goes with simplification alone. What the process holds already is taken off, in steps of 24 MiB. What
     * does not fit then is done in parts, with temporary files beside the output (docs/memory.md); where it fits the
     * result is the same as without a limit. */
    uint64_t max_memory;
    bool check;                    /* examine what will be written, */
    bool skip_self_intersections;  /* but for these */
    double began;                  /* CLOCK_MONOTONIC seconds from which the report counts; 0: when the job starts */
    const hewn_progress *progress; /* or NULL; its stages have the names of the report's */
} hewn_file_job_desc;

/* What a format could not hold of a model. */
typedef struct hewn_file_losses {
    uint64_t cut_faces; /* polygons that became triangles */
    double rounding;    /* greatest change of a coordinate by becoming a float, in the output's unit */
    uint64_t rounded;   /* vertices so changed */
    uint64_t isolated;  /* vertices without a face that were left out */
    uint64_t rejoined;  /* copies that repair made of vertices, which readers of this format make one again */
    char **channels;    /* names of the attributes that were left out, with their domain: "vertex quality" */
    uint32_t channel_count;
} hewn_file_losses;

/* Zero is the empty one. Owned by whoever holds the struct; leave it with hewn_file_report_destroy(). docs/files.md
 * describes the JSON that it prints as. */
typedef struct hewn_file_report {
    char *input, *output;
    hewn_mesh_format from, to;
    uint64_t vertices_before, faces_before, vertices, faces;
    const hewn_unit *file_unit; /* what the input says of itself; NULL: nothing */
    hewn_axis file_up;          /* meaningful where file_up_known */
    bool file_up_known;
    hewn_conversion conversion; /* from what the input was taken for; its unit_after is NULL where nobody knows */
    bool up_known;              /* of the output */
    bool repaired;
    hewn_repair_report repair;
    bool subdivided;
    hewn_scheme scheme;
    hewn_subdivide_report subdivide;
    bool simplified;
    hewn_simplify_report simplify;
    uint64_t max_memory; /* asked for; 0 where it was not */
    uint32_t passes;     /* over a mesh that does not fit in that; 0: it fits */
    uint32_t parts;      /* most in a pass */
    uint64_t disk_bytes; /* of temporary files */
    bool smoothed;
    hewn_smooth_method smooth_method;
    hewn_smooth_report smooth;
    hewn_check *check; /* NULL: not examined */
    hewn_file_losses losses;
    hewn_report_stage stages[8]; /* load, repair, subdivide, simplify, smooth, check, write */
    uint32_t stage_count;
    uint64_t peak_host_bytes;
    double seconds;
} hewn_file_report;

/* Runs a job. Formats, options and the output's folder are checked before the input is read, and nothing is left behind
 * after a failure. HEWN_INVALID_ARGUMENT for a description that makes no sense or a unit or axis that the format cannot
 * have; HEWN_BAD_INPUT for a file that cannot be read or used, or that strict repair refuses; HEWN_IO for an output
 * that cannot be written, or temporary files beside it; HEWN_OUT_OF_MEMORY, also for a limit that is too small, saying
 * why; HEWN_LIMIT, HEWN_CANCELLED. */
HEWN_API hewn_result hewn_file_convert(const hewn_file_job_desc *desc, hewn_file_report *out, hewn_error *error);

/* Writes a report as JSON ("-": standard output). HEWN_IO, HEWN_OUT_OF_MEMORY. */
HEWN_API hewn_result hewn_file_report_write(const hewn_file_report *report, const char *path, hewn_error *error);

HEWN_API void hewn_file_report_destroy(hewn_file_report *report);

#ifdef __cplusplus
}
#endif
#endif
