/* Whole jobs from a mesh file or a scene to a volume file, and what reads the files that scenes sample. */
#ifndef HEWN_VOXELIZE_JOB_H
#define HEWN_VOXELIZE_JOB_H

#include "hewn/io.h"
#include "hewn/sampling_io.h"
#include "hewn/scene.h"
#include "hewn/voxelize.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Reads mesh files as hewn_model_read() does and heights as hewn_heightmap_read() does. Where faces of a mesh leave
 * doubt, they are turned to agree with their neighbours (hewn_repair_desc) and the mesh is sampled again; the better
 * one is kept. Static storage. */
HEWN_API const hewn_scene_reader *hewn_scene_reader_standard(void);

/* Zero everywhere but `scene.path` and `output` is a sensible default. */
typedef struct hewn_voxelize_job_desc {
    hewn_scene_desc scene;     /* the file, also where it is a mesh; its reader is set where it is NULL */
    hewn_mesh_format mesh;     /* HEWN_MESH_UNKNOWN: a mesh where the extension says so, else a scene */
    const char *output;        /* "-" is standard output */
    hewn_volume_format format; /* HEWN_VOLUME_UNKNOWN: by the output's name */
    double cell;               /* 0: a 128th of the longest side */
    double band;               /* in cells; 0: 3 */
    bool dense;
    uint64_t memory_limit;  /* bytes of samples; 0 is 2 GiB */
    const hewn_box *bounds; /* of a scene; NULL: its own, else a box found from the field */
    const hewn_unit *unit;  /* what a mesh is in, whatever it says itself; NULL: as it says */
    const char *report;     /* file for the report as JSON, written last; "-" is standard output; NULL: none */
    double began;           /* CLOCK_MONOTONIC seconds from which the report counts; 0: when the job starts */
    const hewn_progress *progress;
} hewn_voxelize_job_desc;

typedef struct hewn_voxelize_report {
    bool is_mesh;
    uint64_t vertices, faces; /* of a mesh */
    double cell, band;
    double origin[3];               /* of sample (0, 0, 0) */
    hewn_mesh_sampling_report mesh; /* of a mesh; of a scene its cells only */
    hewn_sampling_written written;
    const hewn_unit *unit; /* NULL: nobody knows */
    uint64_t bytes;        /* of the samples in memory */
    uint64_t peak_host_bytes;
    double seconds;
} hewn_voxelize_report;

/* Runs a job. The output appears under its name only when it is complete. HEWN_INVALID_ARGUMENT for a description that
 * makes no sense; HEWN_BAD_INPUT for a file that cannot be read or used; HEWN_LIMIT where samples would take more than
 * the limit; HEWN_IO for an output that cannot be written; HEWN_OUT_OF_MEMORY, HEWN_CANCELLED. */
HEWN_API hewn_result hewn_voxelize_file(const hewn_voxelize_job_desc *desc, hewn_voxelize_report *out,
                                        hewn_error *error);

#ifdef __cplusplus
}
#endif
#endif
