/* Jobs from a mesh file to a GLB file of clusters with levels of detail. */
#ifndef HEWN_CLUSTERS_JOB_H
#define HEWN_CLUSTERS_JOB_H

#include "hewn/clusters.h"
#include "hewn/file_job.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct hewn_clusters_job_desc {
    const char *input;     /* "-" is standard input */
    hewn_mesh_format from; /* HEWN_MESH_UNKNOWN: from the input's extension */
    const char *output;    /* a GLB file */
    hewn_mesh_format to;   /* HEWN_MESH_UNKNOWN: from the output's extension */
    const char *report;    /* file for the report as JSON, written last; "-" is standard output; NULL: none */
    const hewn_unit *unit; /* these four as in hewn_file_job_desc */
    const hewn_axis *up;   /* */
    const hewn_unit *to_unit;
    const hewn_axis *to_up;
    hewn_clusters_desc clusters; /* its progress is not looked at */
    double began;                /* CLOCK_MONOTONIC seconds from which the report counts; 0: when the job starts */
    const hewn_progress *progress;
} hewn_clusters_job_desc;

typedef struct hewn_clusters_report_level {
    uint32_t clusters;
    uint64_t triangles;
    double error; /* the greatest of its clusters, a length in the file's unit */
} hewn_clusters_report_level;

/* Leave it with hewn_clusters_report_destroy(). docs/lod.md describes the JSON. */
typedef struct hewn_clusters_report {
    char *input, *output;
    hewn_mesh_format from;
    uint64_t vertices, triangles; /* of the finest level; vertices as the file has them */
    uint32_t clusters;
    hewn_clusters_report_level *levels;
    uint32_t level_count;
    double rounding;             /* how far positions moved by becoming floats; no error has it in it */
    hewn_report_stage stages[4]; /* load, simplify, write */
    uint32_t stage_count;
    uint64_t peak_host_bytes;
    double seconds;
} hewn_clusters_report;

/* Runs a job. What can be refused is refused before the input is read. Errors as of hewn_file_convert(). */
HEWN_API hewn_result hewn_clusters_file(const hewn_clusters_job_desc *desc, hewn_clusters_report *out,
                                        hewn_error *error);

/* Writes a report as JSON ("-": standard output). HEWN_IO, HEWN_OUT_OF_MEMORY. */
HEWN_API hewn_result hewn_clusters_report_write(const hewn_clusters_report *report, const char *path,
                                                hewn_error *error);

HEWN_API void hewn_clusters_report_destroy(hewn_clusters_report *report);

#ifdef __cplusplus
}
#endif
#endif
