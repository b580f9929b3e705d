#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/progress.h"
#include "io/formats.h"
#include "io/unpack.h"

static const uint64_t UNPACKED_LIMIT = (uint64_t)16 << 30;

static hewn_format_read reader_of(hewn_mesh_format format)
{
    switch (format) {
    case HEWN_MESH_GLB:
    case HEWN_MESH_GLTF: return hewn_gltf_read;
    case HEWN_MESH_OBJ: return hewn_obj_read;
    case HEWN_MESH_PLY: return hewn_ply_read;
    case HEWN_MESH_STL: return hewn_stl_read;
    case HEWN_MESH_OFF: return hewn_off_read;
    case HEWN_MESH_HPM: return hewn_hpm_read;
    case HEWN_MESH_3MF:
    case HEWN_MESH_UNKNOWN: break;
    }
    return NULL;
}

/* Replaces packed bytes by what they hold. */
static hewn_result unpack(char **bytes, size_t *length, const char *path, const hewn_read_desc *desc, hewn_error *error)
{
    char *unpacked;
    size_t unpacked_length;
    if (!hewn_is_packed(*bytes, *length))
        return HEWN_OK;
    uint64_t limit = desc->memory_limit ? desc->memory_limit : UNPACKED_LIMIT;
    HEWN_TRY(hewn_unpack(*bytes, *length, limit, path, desc->progress, &unpacked, &unpacked_length, error));
    hewn_free(*bytes);
    *bytes = unpacked;
    *length = unpacked_length;
    return HEWN_OK;
}

hewn_result hewn_model_read(const char *path, const hewn_read_desc *desc, hewn_model *out, hewn_error *error)
{
    static const hewn_read_desc defaults;
    const hewn_read_desc *wanted = desc ? desc : &defaults;
    *out = (hewn_model){0};
    hewn_mesh_format format = wanted->format != HEWN_MESH_UNKNOWN ? wanted->format : hewn_mesh_format_of(path);
    hewn_format_read read = reader_of(format);
    if (!read)
        return hewn_fail_at(error, HEWN_INVALID_ARGUMENT, path, 0,
                            "no format that can be read; known extensions are .glb, .gltf, .obj, .ply, .stl, .off and "
                            ".hpm, also with .gz");
    char *bytes;
    size_t length;
    HEWN_TRY(hewn_progress_report(wanted->progress, "load", 0, error));
    HEWN_TRY(hewn_file_read(path, SIZE_MAX / 4, &bytes, &length, error));
    hewn_result result = unpack(&bytes, &length, path, wanted, error);
    hewn_source source = {
        bytes, length, path, strcmp(path, "-") == 0 ? NULL : path, wanted->progress, wanted->base_colors};
    if (result == HEWN_OK)
        result = read(&source, out, error);
    hewn_free(bytes);
    return result;
}

hewn_result hewn_triangles_read(const char *path, hewn_triangles *out, hewn_error *error)
{
    hewn_model model;
    *out = (hewn_triangles){0};
    HEWN_TRY(hewn_model_read(path, NULL, &model, error));
    hewn_result result = hewn_triangles_from_model(&model, out, error);
    hewn_model_destroy(&model);
    return result;
}
