#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "hewn/model.h"

static hewn_result copy_names(const hewn_channel *from, hewn_channel *to, hewn_error *error)
{
    int32_t value;
    for (uint32_t i = 0; i < from->name_count; i++)
        HEWN_TRY(hewn_channel_value(to, from->names[i], &value, error));
    return HEWN_OK;
}

static hewn_result copy_channel(const hewn_model *from, const hewn_channel *channel, hewn_model *to, hewn_error *error)
{
    hewn_channel *copy;
    HEWN_TRY(hewn_model_add_channel(to, &channel->info, &copy, error));
    size_t count = (size_t)hewn_model_domain_count(from, channel->info.domain);
    memcpy(copy->values, channel->values, count * channel->info.components * hewn_scalar_size(channel->info.scalar));
    return copy_names(channel, copy, error);
}

static void *copy_array(const void *from, size_t count, size_t size)
{
    void *to = hewn_alloc(count, size);
    if (to && count > 0)
        memcpy(to, from, count * size);
    return to;
}

static hewn_result copy_parts(const hewn_model *model, hewn_model *out, hewn_error *error)
{
    *out = *model;
    out->channels = NULL;
    out->channel_count = 0;
    out->positions = copy_array(model->positions, model->vertex_count, 3 * sizeof *out->positions);
    out->corners = copy_array(model->corners, hewn_model_corner_count(model), sizeof *out->corners);
    out->first = model->first ? copy_array(model->first, model->face_count + 1, sizeof *out->first) : NULL;
    if (!out->positions || !out->corners || (model->first && !out->first))
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a copy of %llu faces",
                         (unsigned long long)model->face_count);
    for (uint32_t i = 0; i < model->channel_count; i++)
        HEWN_TRY(copy_channel(model, &model->channels[i], out, error));
    return HEWN_OK;
}

hewn_result hewn_model_copy(const hewn_model *model, hewn_model *out, hewn_error *error)
{
    hewn_result result = copy_parts(model, out, error);
    if (result != HEWN_OK)
        hewn_model_destroy(out);
    return result;
}
