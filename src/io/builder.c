#include "io/builder.h"

/* Up to the first face that is no triangle there is no `first`. */
static hewn_result begin_polygons(hewn_builder *builder, hewn_error *error)
{
    hewn_model *model = &builder->model;
    void *items = NULL;
    HEWN_TRY(hewn_reserve(&items, &builder->first_room, model->face_count + 2, sizeof(uint64_t), error));
    model->first = items;
    for (uint64_t face = 0; face <= model->face_count; face++)
        model->first[face] = 3 * face;
    return HEWN_OK;
}

hewn_result hewn_builder_end_face(hewn_builder *builder, hewn_error *error)
{
    hewn_model *model = &builder->model;
    if (!model->first && builder->corner_count == 3 * (model->face_count + 1)) {
        model->face_count++;
        return HEWN_OK;
    }
    if (!model->first)
        HEWN_TRY(begin_polygons(builder, error));
    void *items = model->first;
    HEWN_TRY(hewn_reserve(&items, &builder->first_room, model->face_count + 2, sizeof(uint64_t), error));
    model->first = items;
    model->first[++model->face_count] = builder->corner_count;
    return HEWN_OK;
}

static void shrink(void **items, uint64_t count, size_t room, size_t size)
{
    if (*items && count < room) {
        void *smaller = hewn_realloc(*items, count, size);
        *items = smaller ? smaller : *items;
    }
}

hewn_result hewn_builder_finish(hewn_builder *builder, const char *name, hewn_error *error)
{
    hewn_model *model = &builder->model;
    hewn_error reason = {0};
    hewn_result result = hewn_model_check(model, &reason);
    if (result != HEWN_OK)
        return hewn_fail_at(error, result, name, 0, "%s", reason.message);
    void *positions = model->positions, *first = model->first, *corners = model->corners;
    shrink(&positions, model->vertex_count, builder->position_room, 3 * sizeof(double));
    shrink(&first, model->face_count + 1, builder->first_room, sizeof(uint64_t));
    shrink(&corners, builder->corner_count, builder->corner_room, sizeof(uint32_t));
    model->positions = positions;
    model->first = first;
    model->corners = corners;
    return HEWN_OK;
}

void hewn_builder_move(hewn_builder *builder, hewn_model *out)
{
    *out = builder->model;
    *builder = (hewn_builder){0};
}

void hewn_builder_clear(hewn_builder *builder)
{
    hewn_model_destroy(&builder->model);
    *builder = (hewn_builder){0};
}
