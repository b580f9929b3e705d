/* Growing a model while a file is read. */
#ifndef HEWN_SRC_IO_BUILDER_H
#define HEWN_SRC_IO_BUILDER_H

#include "base/alloc.h"
#include "base/error.h"
#include "hewn/model.h"

/* Zero is empty. `model` counts what is there. */
typedef struct hewn_builder {
    hewn_model model;
    uint64_t corner_count;
    size_t position_room, first_room, corner_room;
} hewn_builder;

static inline hewn_result hewn_builder_add_vertex(hewn_builder *builder, const double position[3], hewn_error *error)
{
    hewn_model *model = &builder->model;
    void *items = model->positions;
    HEWN_TRY(hewn_reserve(&items, &builder->position_room, model->vertex_count + 1, 3 * sizeof(double), error));
    model->positions = items;
    for (int axis = 0; axis < 3; axis++)
        model->positions[3 * model->vertex_count + axis] = position[axis];
    model->vertex_count++;
    return HEWN_OK;
}

/* Adds a corner to the face that hewn_builder_end_face() will end. Indices past 2^32 - 1 must not come here; others are
 * checked by hewn_builder_finish(). */
static inline hewn_result hewn_builder_add_corner(hewn_builder *builder, uint32_t vertex, hewn_error *error)
{
    void *items = builder->model.corners;
    HEWN_TRY(hewn_reserve(&items, &builder->corner_room, builder->corner_count + 1, sizeof(uint32_t), error));
    builder->model.corners = items;
    builder->model.corners[builder->corner_count++] = vertex;
    return HEWN_OK;
}

/* Makes a face of the corners since the last one, three or more: a reader refuses or passes over smaller ones. */
hewn_result hewn_builder_end_face(hewn_builder *builder, hewn_error *error);

static inline hewn_result hewn_builder_add_triangle(hewn_builder *builder, uint32_t a, uint32_t b, uint32_t c,
                                                    hewn_error *error)
{
    HEWN_TRY(hewn_builder_add_corner(builder, a, error));
    HEWN_TRY(hewn_builder_add_corner(builder, b, error));
    HEWN_TRY(hewn_builder_add_corner(builder, c, error));
    return hewn_builder_end_face(builder, error);
}

/* Gives back spare room and checks indices and positions: HEWN_BAD_INPUT, naming the file, or HEWN_LIMIT for more
 * vertices than indices can name. Channels may then be added to `builder->model`, which must get no more faces. */
hewn_result hewn_builder_finish(hewn_builder *builder, const char *name, hewn_error *error);

/* Hands the model to `out` and empties the builder. */
void hewn_builder_move(hewn_builder *builder, hewn_model *out);

/* Frees what is there and empties the builder. */
void hewn_builder_clear(hewn_builder *builder);

#endif
