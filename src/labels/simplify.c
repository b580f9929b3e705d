#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "hewn/labels.h"
#include "labels/faces.h"
#include "simplify/complex.h"

/* The simplified triangles in the place of the mesh's own. */
static hewn_result take(hewn_label_mesh *mesh, hewn_simplified *made, hewn_error *error)
{
    hewn_label_mesh out = *mesh;
    out.sides = hewn_alloc(made->face_count, 2 * sizeof *out.sides);
    if (!out.sides)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the mesh of labels");
    for (uint64_t t = 0; t < made->face_count; t++)
        memcpy(out.sides + 2 * t, mesh->sides + 2 * (size_t)made->face_origins[t], 2 * sizeof *out.sides);
    out.vertex_count = made->vertex_count;
    out.triangle_count = made->face_count;
    out.positions = made->positions;
    out.indices = made->corners;
    out.first = NULL;
    out.faces = NULL;
    const hewn_result result = hewn_label_mesh_list_faces(&out, error);
    if (result != HEWN_OK) {
        hewn_free(out.sides);
        hewn_free(out.first);
        hewn_free(out.faces);
        return result;
    }
    hewn_free(mesh->positions);
    hewn_free(mesh->indices);
    hewn_free(mesh->sides);
    hewn_free(mesh->first);
    hewn_free(mesh->faces);
    *mesh = out;
    made->positions = NULL;
    made->corners = NULL;
    return HEWN_OK;
}

hewn_result hewn_label_mesh_simplify(hewn_label_mesh *mesh, const hewn_simplify_desc *desc,
                                     hewn_simplify_report *report, hewn_error *error)
{
    hewn_simplified made = {0};
    const hewn_polygons triangles = {.vertex_count = mesh->vertex_count,
                                     .positions = mesh->positions,
                                     .face_count = mesh->triangle_count,
                                     .corners = mesh->indices};
    /* Of two labels the greater is always behind, so triangles between the same two agree in direction. */
    hewn_result result = hewn_complex_simplify(&triangles, desc, &made, report, error);
    if (result == HEWN_OK)
        result = take(mesh, &made, error);
    hewn_simplified_destroy(&made);
    return result;
}
