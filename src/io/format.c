#include <string.h>
#include <strings.h>

#include "hewn/io.h"

static const struct {
    const char *extension;
    hewn_mesh_format format;
} known[] = {{"glb", HEWN_MESH_GLB}, {"gltf", HEWN_MESH_GLTF}, {"obj", HEWN_MESH_OBJ}, {"ply", HEWN_MESH_PLY},
             {"stl", HEWN_MESH_STL}, {"off", HEWN_MESH_OFF},   {"3mf", HEWN_MESH_3MF}, {"hpm", HEWN_MESH_HPM}};

/* The name of `path` without its folder and without a final ".gz". */
static size_t base_of(const char *path, const char **base)
{
    const char *slash = strrchr(path, '/');
    *base = slash ? slash + 1 : path;
    size_t length = strlen(*base);
    return length > 3 && strcasecmp(*base + length - 3, ".gz") == 0 ? length - 3 : length;
}

hewn_mesh_format hewn_mesh_format_of(const char *path_or_extension)
{
    const char *base;
    if (!path_or_extension)
        return HEWN_MESH_UNKNOWN;
    size_t length = base_of(path_or_extension, &base), begin = length;
    while (begin > 0 && base[begin - 1] != '.')
        begin--;
    if (begin == 0 && base != path_or_extension)
        return HEWN_MESH_UNKNOWN; /* "glb" alone is an extension, "out/glb" has none */
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (strlen(known[i].extension) == length - begin &&
            strncasecmp(base + begin, known[i].extension, length - begin) == 0)
            return known[i].format;
    return HEWN_MESH_UNKNOWN;
}

const char *hewn_mesh_format_name(hewn_mesh_format format)
{
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (known[i].format == format)
            return known[i].extension;
    return NULL;
}
