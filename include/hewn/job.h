/* Whole jobs: a scene file in, a mesh file out, and a report of what was done. */
#ifndef HEWN_JOB_H
#define HEWN_JOB_H

#include "hewn/device.h"
#include "hewn/extract.h"
#include "hewn/io.h"
#include "hewn/scene.h"
#include "hewn/simplify.h"
#include "hewn/triangles.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Cells on the longest side where neither a resolution nor a cell is given. */
#define HEWN_DEFAULT_RESOLUTION 128u

/* What a job leaves for the next one: the open device and the compiled field. Where a scene comes again with other
 * numbers in the same expressions, the job compiles nothing (see hewn_extractor_renumber()). Serves one job at a time.
 */
typedef struct hewn_mesh_kept hewn_mesh_kept;
HEWN_API hewn_result hewn_mesh_kept_create(hewn_mesh_kept **out, hewn_error *error);
HEWN_API void hewn_mesh_kept_destroy(hewn_mesh_kept **kept);

/* What to mesh, how, and where to. Zero everywhere but `scene` and `output` is a sensible default. */
typedef struct hewn_mesh_job_desc {
    hewn_scene_desc scene;
    const char *output;      /* file to write; "-" is standard output (not for GLB) */
    hewn_mesh_format format; /* HEWN_MESH_UNKNOWN: from the output's extension */
    const char *report;      /* file for the report as JSON, written last; "-" is standard output; NULL: none */
    const hewn_box *bounds;  /* scene units; NULL: the scene's own, else a box found from the field */
    uint32_t resolution;     /* cells on the longest side; 0: 128; not together with `cell` */
    double cell;             /* side of a cell in scene units; 0: from `resolution` */
    hewn_method method;
    bool open;       /* leave the surface open where it leaves the bounds */
    bool quads;      /* write faces of four corners: for a dual method, and a format that has polygons */
    double adaptive; /* how far triangles of dc may move where they are merged, scene units; 0: none are */
    const hewn_simplify_desc *simplify; /* lengths in scene units; NULL: no simplification */
    /* Bytes that making the mesh may take, of the device and the host together, see hewn_extract_desc; the mesh is then
     * made in parts, which wait on disk beside the output, and is the same. Not together with `adaptive` or `simplify`.
     * 0: no limit. The driver and the program itself are not counted. */
    uint64_t max_memory;
    const char *device; /* an index or a part of a name; NULL: HEWN_DEVICE from the environment, else the best */
    bool validation;    /* turn the validation layer on; its messages go to stderr and are counted in the report */
    uint32_t threads;   /* of this job, on the host and in a driver that runs on the host; 0: what they choose */
    double began;       /* CLOCK_MONOTONIC seconds from which the report counts; 0: when the job starts */
    const hewn_progress *progress; /* or NULL; its stages have the names of the report's */
    hewn_mesh_kept *kept;          /* or NULL: nothing is kept. Its device stays the one that the first job asked for */
} hewn_mesh_job_desc;

/* A stage of a job, in seconds since the job began. Stages may overlap. */
typedef struct hewn_report_stage {
    char name[16]; /* startup, load, compile, prepare, cull or count, evaluate, extract, read_back, collapse, paint,
                      simplify, certify, write, shutdown */
    double begin, end;
} hewn_report_stage;

typedef struct hewn_report_parameter {
    char *name;
    double value; /* in force */
} hewn_report_parameter;

typedef enum hewn_bounds_source {
    HEWN_BOUNDS_GIVEN, /* by the caller */
    HEWN_BOUNDS_SCENE, /* by the scene itself */
    HEWN_BOUNDS_FIELD  /* found from the field, with a margin */
} hewn_bounds_source;

/* What a job did. Zero is the empty one. Owned by whoever holds the struct; leave it with hewn_report_destroy().
 * docs/report.md describes the JSON that it prints as. */
typedef struct hewn_report {
    char *input;
    char *output;
    char **files; /* the scene and every file that it imported */
    size_t file_count;
    hewn_report_parameter *parameters;
    size_t parameter_count;
    hewn_scene_sampled *sampled; /* files that the scene sampled */
    size_t sampled_count;
    char units[16]; /* of the scene's coordinates, and so of the certificate's volume and area */
    hewn_device_info device;
    hewn_mesh_format format;
    hewn_method method;  /* that was used: not the default */
    uint32_t resolution; /* asked for; 0 where the cell was given */
    uint32_t threads;    /* asked for; 0 where they were not */
    bool open;
    bool quads;
    double adaptive;     /* asked for; 0 where it was not */
    uint64_t max_memory; /* asked for; 0 where it was not */
    bool colors;         /* whether vertices have colours, */
    bool labels;         /* and faces (GLB: vertices) labels, from the scene's paint */
    hewn_bounds_source bounds_source;
    hewn_extract_stats extraction; /* bounds, cells, counts of visited cells and bricks */
    bool simplified;
    hewn_simplify_report simplify;
    hewn_certificate certificate; /* of the mesh that was written, with its max_residual (NaN where simplified) */
    uint64_t vertices;
    uint64_t faces;               /* of the file: triangles or, where they were asked for, quads */
    uint64_t peak_host_bytes;     /* most memory that the process had resident so far */
    uint64_t peak_device_bytes;   /* most device memory in use at once */
    uint64_t validation_messages; /* given by the validation layer, from opening to closing the device */
    hewn_report_stage stages[24];
    uint32_t stage_count;
    double seconds; /* from the job's begin to its end */
} hewn_report;

/* Runs a scene and meshes its field into a file, which appears only when it is complete and its mesh was proven
 * manifold, oriented and (but for `open`) closed. What can be refused early is: an unknown format, a folder that cannot
 * be written. Where the report cannot be written in the end, the call fails but the mesh stays.
 *
 * HEWN_INVALID_ARGUMENT for a description that makes no sense; HEWN_BAD_INPUT for a scene that cannot be read or used,
 * or whose field has no surface in the bounds; HEWN_IO for an output that cannot be written; HEWN_LIMIT,
 * HEWN_CANCELLED, device errors; HEWN_INTERNAL if the proof fails. On failure nothing is left behind and `*out` is
 * zero.
 *
 * `threads` other than 0 sets OpenMP's number of threads for the calling thread and LP_NUM_THREADS in the environment
 * before the device opens, so it must not run beside threads that read or change the environment. */
HEWN_API hewn_result hewn_mesh_scene(const hewn_mesh_job_desc *desc, hewn_report *out, hewn_error *error);

/* Writes a report as JSON to a file, under a temporary name that success renames ("-": standard output).
 * HEWN_IO, HEWN_OUT_OF_MEMORY. */
HEWN_API hewn_result hewn_report_write(const hewn_report *report, const char *path, hewn_error *error);

HEWN_API void hewn_report_destroy(hewn_report *report);

#ifdef __cplusplus
}
#endif
#endif
