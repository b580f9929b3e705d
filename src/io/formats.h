/* The formats' own readers and writers, behind hewn_model_read(), hewn_model_write() and hewn_triangles_write(). */
#ifndef HEWN_SRC_IO_FORMATS_H
#define HEWN_SRC_IO_FORMATS_H

#include "base/file.h"
#include "hewn/io.h"

/* --- readers ------------------------------------------------------------------------------------------------------ */

/* A whole file in memory, already unpacked. */
typedef struct hewn_source {
    const char *bytes;
    size_t length;
    const char *name; /* for messages */
    const char *path; /* where other files are looked for; NULL: nowhere */
    const hewn_progress *progress;
    bool base_colors; /* as of hewn_read_desc */
} hewn_source;

/* Makes a model of a source and keeps nothing of it; `*out` is zero after an error. */
typedef hewn_result (*hewn_format_read)(const hewn_source *source, hewn_model *out, hewn_error *error);

hewn_result hewn_gltf_read(const hewn_source *source, hewn_model *out, hewn_error *error); /* GLB or JSON */
hewn_result hewn_obj_read(const hewn_source *source, hewn_model *out, hewn_error *error);
hewn_result hewn_off_read(const hewn_source *source, hewn_model *out, hewn_error *error);
hewn_result hewn_ply_read(const hewn_source *source, hewn_model *out, hewn_error *error);
hewn_result hewn_hpm_read(const hewn_source *source, hewn_model *out, hewn_error *error);
hewn_result hewn_stl_read(const hewn_source *source, hewn_model *out, hewn_error *error);

/* --- writers ------------------------------------------------------------------------------------------------------ */

/* What is to be written, checked: indices in range, numbers finite. */
typedef struct hewn_writing {
    uint64_t vertex_count, face_count, corner_count;
    const float *floats;   /* positions, of triangle buffers, */
    const double *doubles; /* or of a model */
    bool all_float;        /* every position is a float */
    const uint64_t *first; /* NULL: every face has `each` corners */
    uint32_t each;
    const uint32_t *corners;
    const uint32_t *cut; /* for writers of triangles: 3 places in `corners` each; NULL: the faces are the triangles */
    uint64_t triangle_count;
    const hewn_channel *channels;
    uint32_t channel_count;
    const char *name;      /* of the object: one line, no control characters */
    const hewn_unit *unit; /* NULL: nobody knows */
    hewn_axis up;
    bool up_known;
    const char *space; /* of a patient, "RAS" or "LPS", or glTF's; NULL: none */
    const hewn_progress *progress;
    char *head; /* what a writer's prepare made; freed by the caller of both */
    size_t head_length;
    void *own; /* a writer's own state between prepare and write, freed by its release */
} hewn_writing;

/* One format. `fits` fails with HEWN_LIMIT where the format cannot hold that many, and looks at counts only; `prepare`,
 * still before a file exists, may make `head`, with which `write` begins. All but `write` may be NULL. */
typedef struct hewn_format_writer {
    bool triangles; /* polygons must be cut */
    bool to_stdout; /* may go to standard output */
    hewn_result (*fits)(const hewn_writing *job, hewn_error *error);
    hewn_result (*prepare)(hewn_writing *job, hewn_error *error);
    hewn_result (*write)(const hewn_writing *job, hewn_output *output, hewn_error *error);
    void (*release)(hewn_writing *job);
} hewn_format_writer;

extern const hewn_format_writer hewn_glb_writer, hewn_obj_writer, hewn_ply_writer, hewn_stl_writer, hewn_off_writer,
    hewn_3mf_writer;

/* A model's job, without triangles cut of polygons and without a name. */
hewn_writing hewn_writing_of(const hewn_model *model, const hewn_write_desc *wanted);

/* The name given, or the file's without folder and extension, with control characters blanked: names stand in lines.
 * The caller's (hewn_free); NULL when out of memory. */
char *hewn_object_name(const char *given, const char *path);

/* HEWN_BAD_INPUT for a number of a channel that is not finite. */
hewn_result hewn_writing_check(const hewn_writing *job, hewn_error *error);

/* How much is written between two looks at the progress callback. */
enum { HEWN_WRITE_BLOCK = 1 << 12 }; /* items */

static inline void hewn_writing_position(const hewn_writing *job, uint64_t vertex, double out[3])
{
    for (int axis = 0; axis < 3; axis++)
        out[axis] = job->floats ? (double)job->floats[3 * vertex + axis] : job->doubles[3 * vertex + axis];
}

/* The corners of triangle t, as places in `corners`. */
static inline void hewn_writing_triangle(const hewn_writing *job, uint64_t triangle, uint64_t out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = job->cut ? job->cut[3 * triangle + k] : 3 * triangle + k;
}

static inline uint64_t hewn_writing_first(const hewn_writing *job, uint64_t face)
{
    return job->first ? job->first[face] : job->each * face;
}

/* The channel of a name, or NULL. */
const hewn_channel *hewn_writing_channel(const hewn_writing *job, hewn_domain domain, const char *name);

/* Component `component` of element `index` as a real number. */
double hewn_channel_number(const hewn_channel *channel, uint64_t index, uint32_t component);

#endif
