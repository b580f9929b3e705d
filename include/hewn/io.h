/* Mesh files in and out: GLB, OBJ, PLY and STL. */
#ifndef HEWN_IO_H
#define HEWN_IO_H

#include "hewn/scene.h"
#include "hewn/triangles.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum hewn_mesh_format {
    HEWN_MESH_UNKNOWN,
    HEWN_MESH_GLB, /* metres, +Y up, float; converted from the scene's units and axes */
    HEWN_MESH_OBJ, /* text, scene coordinates */
    HEWN_MESH_PLY, /* binary little-endian, scene coordinates */
    HEWN_MESH_STL  /* binary, scene coordinates, no shared vertices */
} hewn_mesh_format;

/* The format that a file's extension names (any case), or HEWN_MESH_UNKNOWN. */
HEWN_API hewn_mesh_format hewn_mesh_format_of(const char *path_or_extension);

typedef struct hewn_mesh_write_desc {
    hewn_mesh_format format; /* HEWN_MESH_UNKNOWN: from the path */
    const char *name;        /* of the object; NULL: the file's name without its extension */
    double metres_per_unit;  /* 0 is 1 */
    hewn_axis up;
    const hewn_progress *progress; /* or NULL */
} hewn_mesh_write_desc;

/* Writes a mesh under a temporary name and renames it over `path` ("-" is standard output, not for GLB). Same bytes for
 * the same input. HEWN_LIMIT where the format cannot hold it, before anything is written; HEWN_BAD_INPUT for an
 * index out of range or a number that is not finite; HEWN_IO; HEWN_CANCELLED. `desc` may be NULL; the stage is "write".
 */
HEWN_API hewn_result hewn_mesh_write(const hewn_triangles *triangles, const char *path,
                                     const hewn_mesh_write_desc *desc, hewn_error *error);

/* Reads a mesh file by its extension, those above or .gltf, into triangles: polygons are cut into fans, STL's equal
 * positions are welded, glTF's nodes are placed and the result stays in metres and +Y up. Normals are kept where each
 * vertex has exactly one. HEWN_BAD_INPUT says where and why; memory stays in proportion to the file. */
HEWN_API hewn_result hewn_mesh_read(const char *path, hewn_triangles *out, hewn_error *error);

#ifdef __cplusplus
}
#endif
#endif
