#include "io/builder.h"

#include <math.h>

static hewn_result check_mesh(const hewn_triangles *mesh, const char *name, hewn_error *error)
{
    if (mesh->vertex_count > UINT32_MAX)
        return hewn_fail_at(error, HEWN_LIMIT, name, 0, "more than 4294967295 vertices");
    for (uint64_t v = 0; v < mesh->vertex_count; v++) {
        const float *p = mesh->positions + 3 * v;
        if (!(isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2])))
            return hewn_fail_at(error, HEWN_BAD_INPUT, name, 0, "the position of vertex %llu is not finite",
                                (unsigned long long)v);
    }
    for (uint64_t i = 0; i < 3 * mesh->triangle_count; i++)
        if (mesh->indices[i] >= mesh->vertex_count)
            return hewn_fail_at(error, HEWN_BAD_INPUT, name, 0,
                                "triangle %llu names vertex %u, but there are %llu vertices",
                                (unsigned long long)(i / 3), mesh->indices[i], (unsigned long long)mesh->vertex_count);
    return HEWN_OK;
}

/* Whether all normals could be made unit length. One that nearly is stays as it is, so that a file read and written
 * again keeps its bits. */
static bool tidy_normals(hewn_triangles *mesh)
{
    for (uint64_t v = 0; v < mesh->vertex_count; v++) {
        float *n = mesh->normals + 3 * v;
        double x = (double)n[0], y = (double)n[1], z = (double)n[2];
        double length = sqrt(x * x + y * y + z * z);
        if (!isfinite(length) || length == 0)
            return false;
        if (fabs(length - 1) < 1e-4)
            continue;
        n[0] = (float)(x / length);
        n[1] = (float)(y / length);
        n[2] = (float)(z / length);
    }
    return true;
}

static void shrink(void **items, uint64_t count, size_t room, size_t size)
{
    if (*items && count < room) {
        void *smaller = hewn_realloc(*items, count, size);
        *items = smaller ? smaller : *items;
    }
}

hewn_result hewn_builder_finish(hewn_builder *builder, const char *name, hewn_triangles *out, hewn_error *error)
{
    hewn_triangles *mesh = &builder->mesh;
    hewn_result result = check_mesh(mesh, name, error);
    if (result != HEWN_OK) {
        hewn_builder_clear(builder);
        *out = (hewn_triangles){0};
        return result;
    }
    if (mesh->normals && !tidy_normals(mesh)) {
        hewn_free(mesh->normals);
        mesh->normals = NULL;
    }
    void *positions = mesh->positions, *normals = mesh->normals, *indices = mesh->indices;
    shrink(&positions, mesh->vertex_count, builder->position_room, 3 * sizeof(float));
    shrink(&normals, mesh->vertex_count, builder->normal_room, 3 * sizeof(float));
    shrink(&indices, mesh->triangle_count, builder->index_room, 3 * sizeof(uint32_t));
    mesh->positions = positions;
    mesh->normals = normals;
    mesh->indices = indices;
    *out = *mesh;
    *builder = (hewn_builder){0};
    return HEWN_OK;
}

void hewn_builder_clear(hewn_builder *builder)
{
    hewn_triangles_destroy(&builder->mesh);
    *builder = (hewn_builder){0};
}
