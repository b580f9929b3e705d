/* Jobs from a mesh file to a progressive mesh (.hpm), and from one to a mesh on its way. */
#ifndef HEWN_PROGRESSIVE_JOB_H
#define HEWN_PROGRESSIVE_JOB_H

#include "hewn/file_job.h"
#include "hewn/progressive.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What to do: with an output that ends in .hpm a progressive mesh is made, else a mesh is taken from the input, which
 * is one.
 *
 * faces: the base has no fewer triangles than that; or, of a mesh that is taken, the most that it may have. error: of a
 * mesh that is taken, the greatest proven distance to the whole, a length in the input's unit; the meshes are those
 * that were measured when the file was made. 0: none given. partial: an input that is cut off is taken as far as it
 * goes. */
typedef struct hewn_progressive_job_desc {
    const char *input;     /* "-" is standard input */
    hewn_mesh_format from; /* HEWN_MESH_UNKNOWN: from the input's extension */
    const char *output;    /* "-" is standard output */
    hewn_mesh_format to;   /* HEWN_MESH_UNKNOWN: from the output's extension */
    const char *report;    /* file for the report as JSON, written last; "-" is standard output; NULL: none */
    const hewn_unit *unit; /* these four as in hewn_file_job_desc */
    const hewn_axis *up;   /* */
    const hewn_unit *to_unit;
    const hewn_axis *to_up;
    uint64_t faces;
    double error;
    bool partial;
    double began; /* CLOCK_MONOTONIC seconds from which the report counts; 0: when the job starts */
    const hewn_progress *progress;
} hewn_progressive_job_desc;

/* What was written, and of what. Leave it with hewn_progressive_report_destroy(). docs/lod.md describes the JSON. */
typedef struct hewn_progressive_report {
    char *input, *output;
    hewn_mesh_format from, to;
    hewn_progressive_info info; /* of the progressive mesh; its marks are `marks` */
    hewn_progressive_mark *marks;
    uint64_t splits; /* that were done, of a mesh that was taken */
    uint64_t vertices, triangles;
    hewn_report_stage stages[4]; /* load, simplify, write */
    uint32_t stage_count;
    uint64_t peak_host_bytes;
    double seconds;
} hewn_progressive_report;

/* Runs a job. What can be refused is refused before the input is read. Errors as of hewn_file_convert(). */
HEWN_API hewn_result hewn_progressive_file(const hewn_progressive_job_desc *desc, hewn_progressive_report *out,
                                           hewn_error *error);

/* Writes a report as JSON ("-": standard output). HEWN_IO, HEWN_OUT_OF_MEMORY. */
HEWN_API hewn_result hewn_progressive_report_write(const hewn_progressive_report *report, const char *path,
                                                   hewn_error *error);

HEWN_API void hewn_progressive_report_destroy(hewn_progressive_report *report);

#ifdef __cplusplus
}
#endif
#endif
