#include "pipeline/paths.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "base/error.h"
#include "base/file.h"

static bool is_dash(const char *path)
{
    return strcmp(path, "-") == 0;
}

/* A file is begun and given up, because nothing else tells for sure that it can be written. Devices and pipes are left
 * alone: opening and closing one is something that its reader would notice. */
hewn_result hewn_output_check(const char *path, hewn_error *error)
{
    struct stat status;
    if (is_dash(path))
        return HEWN_OK;
    if (stat(path, &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode))
        return HEWN_OK;
    hewn_output *output = NULL;
    HEWN_TRY(hewn_output_create(path, &output, error));
    hewn_output_destroy(&output);
    return HEWN_OK;
}

hewn_result hewn_output_format(const char *path, hewn_mesh_format format, hewn_mesh_format *out, hewn_error *error)
{
    *out = format != HEWN_MESH_UNKNOWN || is_dash(path) ? format : hewn_mesh_format_of(path);
    size_t length = strlen(path);
    if (*out == HEWN_MESH_UNKNOWN && is_dash(path))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "standard output has no extension: name its format with --to obj, ply, stl or off");
    if (*out == HEWN_MESH_UNKNOWN)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "the name '%s' does not end in .glb, .obj, .ply, .stl, .off or .3mf, so its format is unknown",
                         path);
    if (*out == HEWN_MESH_GLTF)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "glTF as text (.gltf) can be read only; .glb can be written");
    if (*out == HEWN_MESH_HPM)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "progressive meshes (.hpm) are written by `hewn lod` only");
    if (is_dash(path) && (*out == HEWN_MESH_GLB || *out == HEWN_MESH_3MF))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "%s cannot be written to standard output; obj, ply, stl and off can",
                         *out == HEWN_MESH_GLB ? "GLB" : "3MF");
    if (length > 3 && strcasecmp(path + length - 3, ".gz") == 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "'%s': compressed files can be read only", path);
    return HEWN_OK;
}

hewn_result hewn_input_format(const char *path, hewn_mesh_format format, hewn_mesh_format *out, hewn_error *error)
{
    *out = format != HEWN_MESH_UNKNOWN || is_dash(path) ? format : hewn_mesh_format_of(path);
    if (*out == HEWN_MESH_UNKNOWN && is_dash(path))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "standard input has no extension: name its format with --from glb, obj, ply, stl or off");
    if (*out == HEWN_MESH_UNKNOWN)
        return hewn_fail(
            error, HEWN_INVALID_ARGUMENT,
            "the name '%s' ends in no mesh format that Hewn reads: .glb, .gltf, .obj, .ply, .stl, .off, .hpm, "
            "also with .gz; --from names one",
            path);
    if (*out == HEWN_MESH_3MF)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "3MF can be written, but not read");
    return HEWN_OK;
}

hewn_result hewn_blame_input(hewn_result result, const char *path, hewn_error *error)
{
    if (result == HEWN_IO)
        result = HEWN_BAD_INPUT;
    if (result == HEWN_BAD_INPUT && error) {
        error->code = result;
        if (!error->file[0] || is_dash(error->file)) {
            hewn_error copy = *error;
            hewn_fail_at(error, result, is_dash(path) ? "standard input" : path, copy.line, "%s", copy.message);
        }
    }
    return result;
}

void hewn_path_stem(const char *path, char *out, size_t size)
{
    const char *slash = strrchr(path, '/');
    const char *base = is_dash(path) ? "mesh" : slash ? slash + 1 : path;
    snprintf(out, size, "%s", base);
    for (int i = 0; i < 2; i++) {
        char *dot = strrchr(out, '.');
        bool packed = dot && strcasecmp(dot, ".gz") == 0;
        if (dot && dot != out)
            *dot = '\0';
        if (!packed)
            break;
    }
}
