#include "hewn/model.h"

#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/hash.h"

enum { MOST_COMPONENTS = 16 };

static void clear_channel(hewn_channel *channel)
{
    for (uint32_t i = 0; i < channel->name_count; i++)
        hewn_free(channel->names[i]);
    hewn_free(channel->names);
    hewn_free(channel->slots);
    hewn_free(channel->values);
    hewn_free((void *)channel->info.name);
}

void hewn_model_destroy(hewn_model *model)
{
    if (!model)
        return;
    for (uint32_t i = 0; i < model->channel_count; i++)
        clear_channel(&model->channels[i]);
    hewn_free(model->channels);
    hewn_free(model->positions);
    hewn_free(model->first);
    hewn_free(model->corners);
    *model = (hewn_model){0};
}

uint64_t hewn_model_corner_count(const hewn_model *model)
{
    return model->first ? model->first[model->face_count] : 3 * model->face_count;
}

uint64_t hewn_model_domain_count(const hewn_model *model, hewn_domain domain)
{
    switch (domain) {
    case HEWN_DOMAIN_VERT: return model->vertex_count;
    case HEWN_DOMAIN_CORNER: return hewn_model_corner_count(model);
    case HEWN_DOMAIN_FACE: return model->face_count;
    }
    return 0;
}

hewn_polygons hewn_model_polygons(const hewn_model *model)
{
    return (hewn_polygons){.vertex_count = model->vertex_count,
                           .positions = model->positions,
                           .face_count = model->face_count,
                           .first = model->first,
                           .corners = model->corners};
}

/* --- channels ----------------------------------------------------------------------------------------------------- */

hewn_channel *hewn_model_find_channel(const hewn_model *model, hewn_domain domain, const char *name)
{
    for (uint32_t i = 0; i < model->channel_count; i++) {
        hewn_channel *channel = &model->channels[i];
        if (channel->info.domain == domain && strcmp(channel->info.name, name) == 0)
            return channel;
    }
    return NULL;
}

static hewn_result check_info(const hewn_model *model, const hewn_attribute_info *info, hewn_error *error)
{
    if (!info->name || info->name[0] == '\0')
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a channel needs a name");
    if (info->components < 1 || info->components > MOST_COMPONENTS)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "channel \"%s\" cannot have %u components, only 1 to %d",
                         info->name, info->components, MOST_COMPONENTS);
    if (hewn_scalar_size(info->scalar) == 0 || (unsigned)info->domain > HEWN_DOMAIN_FACE)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "channel \"%s\" has an unknown domain or scalar", info->name);
    if (hewn_model_find_channel(model, info->domain, info->name))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the model has a channel \"%s\" there already", info->name);
    return HEWN_OK;
}

hewn_result hewn_model_add_channel(hewn_model *model, const hewn_attribute_info *info, hewn_channel **out,
                                   hewn_error *error)
{
    *out = NULL;
    HEWN_TRY(check_info(model, info, error));
    hewn_channel channel = {.info = *info};
    channel.info.name = hewn_strdup(info->name);
    channel.values = hewn_alloc_zero(hewn_model_domain_count(model, info->domain),
                                     info->components * hewn_scalar_size(info->scalar));
    hewn_channel *grown = hewn_realloc(model->channels, (size_t)model->channel_count + 1, sizeof *grown);
    model->channels = grown ? grown : model->channels;
    if (!grown || !channel.values || !channel.info.name) {
        clear_channel(&channel);
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the channel \"%s\"", info->name);
    }
    *out = &model->channels[model->channel_count++];
    **out = channel;
    return HEWN_OK;
}

/* The slot of a name in an open-addressing table, which is never full. */
static uint32_t *find_slot(const hewn_channel *channel, const char *name)
{
    uint32_t mask = channel->slot_count - 1,
             at = (uint32_t)hewn_hash_bytes(hewn_hash_begin(), name, strlen(name)).a & mask;
    while (channel->slots[at] != HEWN_NONE && strcmp(channel->names[channel->slots[at]], name) != 0)
        at = (at + 1) & mask;
    return &channel->slots[at];
}

/* Makes room for one name more: names and a table of twice as many slots, at powers of two. */
static hewn_result grow_names(hewn_channel *channel, hewn_error *error)
{
    uint32_t room = channel->slot_count ? channel->slot_count : 8;
    if (room > UINT32_MAX / 4)
        return hewn_fail(error, HEWN_LIMIT, "channel \"%s\" has too many names", channel->info.name);
    while (room < channel->name_count + 1)
        room *= 2;
    char **names = hewn_realloc(channel->names, room, sizeof *names);
    channel->names = names ? names : channel->names;
    uint32_t *slots = names ? hewn_realloc(channel->slots, 2 * (size_t)room, sizeof *slots) : NULL;
    if (!slots)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for names");
    channel->slots = slots;
    channel->slot_count = 2 * room;
    memset(slots, 0xff, channel->slot_count * sizeof *slots);
    for (uint32_t i = 0; i < channel->name_count; i++)
        *find_slot(channel, channel->names[i]) = i;
    return HEWN_OK;
}

hewn_result hewn_channel_value(hewn_channel *channel, const char *name, int32_t *out, hewn_error *error)
{
    *out = 0;
    if (2 * ((uint64_t)channel->name_count + 1) > channel->slot_count)
        HEWN_TRY(grow_names(channel, error));
    uint32_t *slot = find_slot(channel, name);
    if (*slot == HEWN_NONE) {
        channel->names[channel->name_count] = hewn_strdup(name);
        if (!channel->names[channel->name_count])
            return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for names");
        *slot = channel->name_count++;
    }
    *out = (int32_t)*slot;
    return HEWN_OK;
}

/* --- what is promised ----------------------------------------------------------------------------------------------
 */

static hewn_result check_faces(const hewn_model *model, hewn_error *error)
{
    if (!model->first)
        return HEWN_OK;
    if (model->first[0] != 0)
        return hewn_fail(error, HEWN_BAD_INPUT, "the first face does not begin with the first corner");
    for (uint64_t face = 0; face < model->face_count; face++)
        if (model->first[face + 1] < model->first[face])
            return hewn_fail(error, HEWN_BAD_INPUT, "face %llu ends before it begins", (unsigned long long)face);
    return HEWN_OK;
}

static uint64_t face_of_corner(const hewn_model *model, uint64_t corner)
{
    uint64_t face = 0;
    if (!model->first)
        return corner / 3;
    while (model->first[face + 1] <= corner)
        face++;
    return face;
}

static hewn_result check_corners(const hewn_model *model, hewn_error *error)
{
    uint64_t count = hewn_model_corner_count(model);
    for (uint64_t i = 0; i < count; i++)
        if (model->corners[i] >= model->vertex_count)
            return hewn_fail(error, HEWN_BAD_INPUT, "face %llu names vertex %u, but there are %llu vertices",
                             (unsigned long long)face_of_corner(model, i), model->corners[i],
                             (unsigned long long)model->vertex_count);
    return HEWN_OK;
}

hewn_result hewn_model_check(const hewn_model *model, hewn_error *error)
{
    if (model->vertex_count > UINT32_MAX)
        return hewn_fail(error, HEWN_LIMIT, "more than 4294967295 vertices");
    if (model->face_count > UINT32_MAX || (!model->first && model->face_count > UINT64_MAX / 3))
        return hewn_fail(error, HEWN_LIMIT, "more than 4294967295 faces");
    HEWN_TRY(check_faces(model, error));
    if ((model->vertex_count > 0 && !model->positions) || (hewn_model_corner_count(model) > 0 && !model->corners))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a model without positions or corners");
    for (uint64_t i = 0; i < 3 * model->vertex_count; i++)
        if (!isfinite(model->positions[i]))
            return hewn_fail(error, HEWN_BAD_INPUT, "the position of vertex %llu is not finite",
                             (unsigned long long)(i / 3));
    return check_corners(model, error);
}
