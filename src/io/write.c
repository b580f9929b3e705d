#include <math.h>
#include <string.h>
#include <strings.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/progress.h"
#include "hewn/io.h"
#include "io/formats.h"

const char *hewn_axis_name(hewn_axis axis)
{
    return axis == HEWN_AXIS_PLUS_Z ? "+Z" : axis == HEWN_AXIS_PLUS_X ? "+X" : "+Y";
}

hewn_mesh_format hewn_mesh_format_of(const char *path_or_extension)
{
    if (!path_or_extension)
        return HEWN_MESH_UNKNOWN;
    const char *slash = strrchr(path_or_extension, '/');
    const char *base = slash ? slash + 1 : path_or_extension;
    const char *dot = strrchr(base, '.');
    const char *extension = dot ? dot + 1 : slash ? "" : base; /* "glb" alone is an extension, "out/glb" has none */
    static const struct {
        const char *extension;
        hewn_mesh_format format;
    } known[] = {{"glb", HEWN_MESH_GLB}, {"obj", HEWN_MESH_OBJ}, {"ply", HEWN_MESH_PLY}, {"stl", HEWN_MESH_STL}};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (strcasecmp(extension, known[i].extension) == 0)
            return known[i].format;
    return HEWN_MESH_UNKNOWN;
}

static const hewn_mesh_writer *writer_of(hewn_mesh_format format)
{
    switch (format) {
    case HEWN_MESH_GLB: return &hewn_glb_writer;
    case HEWN_MESH_OBJ: return &hewn_obj_writer;
    case HEWN_MESH_PLY: return &hewn_ply_writer;
    case HEWN_MESH_STL: return &hewn_stl_writer;
    case HEWN_MESH_UNKNOWN: break;
    }
    return NULL;
}

/* The name given, or the file's without folder and extension, with control characters blanked: names stand in lines. */
static char *object_name(const char *given, const char *path)
{
    const char *slash = strrchr(path, '/');
    const char *from = given && *given ? given : strcmp(path, "-") == 0 ? "mesh" : slash ? slash + 1 : path;
    char *name = hewn_strdup(from);
    if (!name)
        return NULL;
    char *dot = strrchr(name, '.');
    if (!(given && *given) && dot && dot != name)
        *dot = '\0';
    for (char *at = name; *at; at++)
        if ((unsigned char)*at < 0x20 || *at == 0x7f)
            *at = ' ';
    return name;
}

static hewn_result check_numbers(const hewn_triangles *mesh, hewn_error *error)
{
    if ((mesh->vertex_count > 0 && !mesh->positions) || (mesh->triangle_count > 0 && !mesh->indices))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "triangles without positions or indices");
    for (uint64_t i = 0; i < 3 * mesh->triangle_count; i++)
        if (mesh->indices[i] >= mesh->vertex_count)
            return hewn_fail(error, HEWN_BAD_INPUT, "triangle %llu names vertex %u, but there are %llu vertices",
                             (unsigned long long)(i / 3), mesh->indices[i], (unsigned long long)mesh->vertex_count);
    for (uint64_t i = 0; i < 3 * mesh->vertex_count; i++) {
        if (!isfinite(mesh->positions[i]))
            return hewn_fail(error, HEWN_BAD_INPUT, "the position of vertex %llu is not finite",
                             (unsigned long long)(i / 3));
        if (mesh->normals && !isfinite(mesh->normals[i]))
            return hewn_fail(error, HEWN_BAD_INPUT, "the normal of vertex %llu is not finite",
                             (unsigned long long)(i / 3));
    }
    return HEWN_OK;
}

static hewn_result check_size(const hewn_triangles *mesh, const hewn_mesh_writer *writer, hewn_error *error)
{
    if (mesh->vertex_count > (uint64_t)UINT32_MAX + 1 || mesh->triangle_count > UINT64_MAX / 64)
        return hewn_fail(error, HEWN_LIMIT, "%llu vertices and %llu triangles are more than indices can name",
                         (unsigned long long)mesh->vertex_count, (unsigned long long)mesh->triangle_count);
    return writer->fits ? writer->fits(mesh, error) : HEWN_OK;
}

static hewn_result write_file(const hewn_mesh_writer *writer, const hewn_mesh_writing *job, const char *path,
                              hewn_error *error)
{
    hewn_output *output;
    HEWN_TRY(hewn_progress_report(job->progress, "write", 0, error));
    HEWN_TRY(hewn_output_create(path, &output, error));
    hewn_result result = writer->write(job, output, error);
    if (result == HEWN_OK)
        return hewn_output_finish(&output, error);
    hewn_output_destroy(&output);
    return result;
}

hewn_result hewn_mesh_write(const hewn_triangles *triangles, const char *path, const hewn_mesh_write_desc *desc,
                            hewn_error *error)
{
    static const hewn_mesh_write_desc defaults;
    const hewn_mesh_write_desc *wanted = desc ? desc : &defaults;
    hewn_mesh_format format = wanted->format != HEWN_MESH_UNKNOWN ? wanted->format : hewn_mesh_format_of(path);
    const hewn_mesh_writer *writer = writer_of(format);
    if (!writer)
        return hewn_fail_at(error, HEWN_INVALID_ARGUMENT, path, 0,
                            "no known mesh format; known extensions are .glb, .obj, .ply and .stl");
    if (format == HEWN_MESH_GLB && strcmp(path, "-") == 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "GLB cannot be written to standard output");
    double metres = wanted->metres_per_unit == 0 ? 1 : wanted->metres_per_unit;
    if (!(metres > 0 && isfinite(metres)))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "%g metres a unit make no sense", metres);
    HEWN_TRY(check_size(triangles, writer, error));
    hewn_mesh_writing job = {
        .mesh = triangles, .metres_per_unit = metres, .up = wanted->up, .progress = wanted->progress};
    char *name = object_name(wanted->name, path);
    job.name = name;
    hewn_result result =
        name ? check_numbers(triangles, error) : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for writing");
    if (result == HEWN_OK)
        result = writer->prepare(&job, error);
    if (result == HEWN_OK)
        result = write_file(writer, &job, path, error);
    hewn_free(job.head);
    hewn_free(name);
    return result;
}
