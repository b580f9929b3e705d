#include <string.h>
#include <strings.h>

#include "base/alloc.h"
#include "base/error.h"
#include "hewn/io.h"
#include "io/formats.h"

static bool is_gltf_text(const char *path)
{
    const char *dot = strrchr(path, '.');
    return dot && strcasecmp(dot, ".gltf") == 0;
}

hewn_result hewn_mesh_read(const char *path, hewn_triangles *out, hewn_error *error)
{
    *out = (hewn_triangles){0};
    hewn_mesh_format format = is_gltf_text(path) ? HEWN_MESH_GLB : hewn_mesh_format_of(path);
    if (format == HEWN_MESH_UNKNOWN)
        return hewn_fail_at(error, HEWN_INVALID_ARGUMENT, path, 0,
                            "no known mesh format; known extensions are .glb, .gltf, .obj, .ply and .stl");
    char *bytes;
    size_t length;
    HEWN_TRY(hewn_file_read(path, SIZE_MAX / 4, &bytes, &length, error));
    hewn_result result = HEWN_INTERNAL;
    switch (format) {
    case HEWN_MESH_GLB: result = hewn_gltf_read(bytes, length, path, path, out, error); break;
    case HEWN_MESH_OBJ: result = hewn_obj_read(bytes, length, path, out, error); break;
    case HEWN_MESH_PLY: result = hewn_ply_read(bytes, length, path, out, error); break;
    case HEWN_MESH_STL: result = hewn_stl_read(bytes, length, path, out, error); break;
    case HEWN_MESH_UNKNOWN: break;
    }
    hewn_free(bytes);
    return result;
}
