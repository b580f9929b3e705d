/* Jobs from a mesh file to levels of detail. */
#ifndef HEWN_LOD_JOB_H
#define HEWN_LOD_JOB_H

#include "hewn/file_job.h"
#include "hewn/lod.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What to make of a mesh file.
 *
 * output: a .glb file gets all levels (MSFT_lod). Where it has "{level}" in its name, each level becomes a file of its
 * own, in any format, with its number (0 is the first) there. pixels, lines: levels in a GLB file are meant for a size
 * at which their error is no more than so many lines of a picture of so many; 0: 1 and 1080. */
typedef struct hewn_lod_job_desc {
    const char *input;     /* "-" is standard input */
    hewn_mesh_format from; /* HEWN_MESH_UNKNOWN: from the input's extension */
    const char *output;    /* not "-" */
    hewn_mesh_format to;   /* HEWN_MESH_UNKNOWN: from the output's extension */
    const char *report;    /* file for the report as JSON, written last; "-" is standard output; NULL: none */
    const hewn_unit *unit; /* these four as in hewn_file_job_desc */
    const hewn_axis *up;   /* */
    const hewn_unit *to_unit;
    const hewn_axis *to_up;
    hewn_lod_desc levels; /* errors are in the input's unit; labels, frozen and progress are not looked at */
    double pixels, lines;
    double began; /* CLOCK_MONOTONIC seconds from which the report counts; 0: when the job starts */
    const hewn_progress *progress;
} hewn_lod_job_desc;

/* One level as it was written. Lengths are in the input's unit. `error` bounds the distance from the input's surface to
 * what the file has, with what rounding to floats does to it. */
typedef struct hewn_lod_report_level {
    char *output; /* its file; NULL: the one for all */
    uint64_t vertices, triangles;
    double error, error_low;
    double coverage; /* the least share of the picture's height that it is meant for */
    bool reached;    /* as few triangles as were asked for */
} hewn_lod_report_level;

/* Zero is the empty one. Leave it with hewn_lod_report_destroy(). docs/lod.md describes the JSON. */
typedef struct hewn_lod_report {
    char *input, *output;
    hewn_mesh_format from, to;
    uint64_t vertices_before, faces_before, triangles_before;
    double diagonal; /* of the input's box */
    hewn_lod_report_level *levels;
    uint32_t level_count;
    hewn_report_stage stages[4]; /* load, simplify, write */
    uint32_t stage_count;
    uint64_t peak_host_bytes;
    double seconds;
} hewn_lod_report;

/* Runs a job. What can be refused is refused before the input is read. Of separate files those that are complete stay
 * where a later one fails to be written. Errors as of hewn_file_convert(). */
HEWN_API hewn_result hewn_lod_file(const hewn_lod_job_desc *desc, hewn_lod_report *out, hewn_error *error);

/* Writes a report as JSON ("-": standard output). HEWN_IO, HEWN_OUT_OF_MEMORY. */
HEWN_API hewn_result hewn_lod_report_write(const hewn_lod_report *report, const char *path, hewn_error *error);

HEWN_API void hewn_lod_report_destroy(hewn_lod_report *report);

#ifdef __cplusplus
}
#endif
#endif
