/* The formats' own readers and writers, behind hewn_mesh_read() and hewn_mesh_write(). */
#ifndef HEWN_SRC_IO_FORMATS_H
#define HEWN_SRC_IO_FORMATS_H

#include "base/file.h"
#include "hewn/io.h"

/* --- readers: a whole file in memory. `name` is for messages; nothing of `bytes` is kept. ----------------------------
 */

hewn_result hewn_obj_read(const char *bytes, size_t length, const char *name, hewn_triangles *out, hewn_error *error);
hewn_result hewn_ply_read(const char *bytes, size_t length, const char *name, hewn_triangles *out, hewn_error *error);
hewn_result hewn_stl_read(const char *bytes, size_t length, const char *name, hewn_triangles *out, hewn_error *error);

/* GLB, or glTF's JSON; told apart by the first bytes. Buffers in files of their own are read from the folder of `path`;
 * where `path` is NULL they are HEWN_BAD_INPUT. */
hewn_result hewn_gltf_read(const char *bytes, size_t length, const char *name, const char *path, hewn_triangles *out,
                           hewn_error *error);

/* --- writers ---------------------------------------------------------------------------------------------------------
 */

/* What is to be written, checked: indices in range, numbers finite. */
typedef struct hewn_mesh_writing {
    const hewn_triangles *mesh;
    const char *name; /* of the object: one line, no control characters */
    double metres_per_unit;
    hewn_axis up;
    const hewn_progress *progress;
    char *head; /* what a writer's prepare made; freed by the caller of both */
    size_t head_length;
} hewn_mesh_writing;

/* One format. `fits` fails with HEWN_LIMIT where the format cannot hold that many, and looks at counts only; it may be
 * NULL. `prepare`, still before a file exists, makes `head`, with which `write` begins. */
typedef struct hewn_mesh_writer {
    hewn_result (*fits)(const hewn_triangles *mesh, hewn_error *error);
    hewn_result (*prepare)(hewn_mesh_writing *job, hewn_error *error);
    hewn_result (*write)(const hewn_mesh_writing *job, hewn_output *output, hewn_error *error);
} hewn_mesh_writer;

extern const hewn_mesh_writer hewn_glb_writer, hewn_obj_writer, hewn_ply_writer, hewn_stl_writer;

/* How much is written between two looks at the progress callback. */
enum { HEWN_WRITE_BLOCK = 1 << 12 }; /* vertices or triangles */

/* "+Y", "+Z" or "+X". */
const char *hewn_axis_name(hewn_axis axis);

#endif
