/* Whole jobs that end in a picture: a scene or a mesh file in, a PNG file out. */
#ifndef HEWN_RENDER_JOB_H
#define HEWN_RENDER_JOB_H

#include "hewn/io.h"
#include "hewn/render.h"
#include "hewn/scene.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Zero everywhere but `scene.path` and `output` is a sensible default. */
typedef struct hewn_render_job_desc {
    hewn_scene_desc scene;     /* the file, also where it is a mesh */
    hewn_mesh_format mesh;     /* HEWN_MESH_UNKNOWN: a mesh where the extension says so, else a scene */
    const char *output;        /* a PNG file; "-" is standard output */
    hewn_render_desc render;   /* its camera and up axis are set by the job */
    const hewn_camera *camera; /* NULL: from `view`; its `up` may be 0: then it is the scene's */
    hewn_view view;
    const hewn_axis *up;    /* NULL: what the file says, +Z where it does not */
    const hewn_box *bounds; /* scene units; NULL: the scene's own, else a box found from the field. Not for meshes */
    bool plane;             /* a filled picture of the plane z = bounds->lo[2] of a field, or of z = 0 without bounds;
                               then sides of the plane that are not given are those of the scene, -1 to 1 for a .vm */
    const char *device;     /* as of hewn_mesh_job_desc; "host": rays are followed by the host's processors */
    bool validation;
    double began;                  /* CLOCK_MONOTONIC seconds from which the report counts; 0: when the job starts */
    const hewn_progress *progress; /* or NULL; the last stage is "write", before which no file is there */
} hewn_render_job_desc;

/* What a job did. Plain data. */
typedef struct hewn_render_report {
    uint32_t width, height;
    hewn_render_stats stats;
    hewn_plane_stats plane;
    double lo, hi;   /* of a picture of depths */
    char where[256]; /* the device's name, or "host" */
    uint64_t validation_messages;
    double seconds;
} hewn_render_report;

/* Renders a file. The picture appears under its name only when it is complete. HEWN_INVALID_ARGUMENT for a description
 * that makes no sense; HEWN_BAD_INPUT for a file that cannot be read or used; HEWN_IO for an output that cannot be
 * written; HEWN_CANCELLED, device errors. */
HEWN_API hewn_result hewn_render_file(const hewn_render_job_desc *desc, hewn_render_report *out, hewn_error *error);

#ifdef __cplusplus
}
#endif
#endif
