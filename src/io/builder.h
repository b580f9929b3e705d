/* Growing triangle buffers while a file is read. */
#ifndef HEWN_SRC_IO_BUILDER_H
#define HEWN_SRC_IO_BUILDER_H

#include "base/alloc.h"
#include "base/error.h"
#include "hewn/triangles.h"

/* Zero is empty. `mesh` counts what is there; normals, where there are any, one a vertex. */
typedef struct hewn_builder {
    hewn_triangles mesh;
    size_t position_room, normal_room, index_room; /* in triples */
} hewn_builder;

static inline hewn_result hewn_builder_add_vertex(hewn_builder *builder, const float position[3], hewn_error *error)
{
    hewn_triangles *mesh = &builder->mesh;
    void *items = mesh->positions;
    HEWN_TRY(hewn_reserve(&items, &builder->position_room, mesh->vertex_count + 1, 3 * sizeof(float), error));
    mesh->positions = items;
    for (int axis = 0; axis < 3; axis++)
        mesh->positions[3 * mesh->vertex_count + axis] = position[axis];
    mesh->vertex_count++;
    return HEWN_OK;
}

/* Indices past 2^32 - 1 must not come here; others are checked by hewn_builder_finish(). */
static inline hewn_result hewn_builder_add_triangle(hewn_builder *builder, uint32_t a, uint32_t b, uint32_t c,
                                                    hewn_error *error)
{
    hewn_triangles *mesh = &builder->mesh;
    void *items = mesh->indices;
    HEWN_TRY(hewn_reserve(&items, &builder->index_room, mesh->triangle_count + 1, 3 * sizeof(uint32_t), error));
    mesh->indices = items;
    uint32_t *corner = mesh->indices + 3 * mesh->triangle_count++;
    corner[0] = a;
    corner[1] = b;
    corner[2] = c;
    return HEWN_OK;
}

/* Hands the buffers to `out` and empties the builder, whatever the outcome. HEWN_BAD_INPUT, naming the file, where a
 * position is not finite or an index is out of range; HEWN_LIMIT for more vertices than indices can name. Normals that
 * are not of length 1 are made so; where one cannot be, all are dropped. */
hewn_result hewn_builder_finish(hewn_builder *builder, const char *name, hewn_triangles *out, hewn_error *error);

/* Frees what is there and empties the builder. */
void hewn_builder_clear(hewn_builder *builder);

#endif
