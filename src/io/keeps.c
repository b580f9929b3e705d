#include <string.h>

#include "io/glb_plan.h"

/* A channel that a format has a place for. */
typedef struct kept_channel {
    hewn_mesh_format format;
    hewn_domain domain;
    const char *name;
    uint32_t least, most; /* components */
    bool integer;         /* INT32 only, else any but that */
} kept_channel;

/* But for PLY, which keeps every channel, and GLB, whose plan says what it keeps. */
static const kept_channel kept[] = {
    {HEWN_MESH_OBJ, HEWN_DOMAIN_VERT, "color", 3, 3, false},
    {HEWN_MESH_OBJ, HEWN_DOMAIN_VERT, "normal", 3, 3, false},
    {HEWN_MESH_OBJ, HEWN_DOMAIN_VERT, "uv", 2, 2, false},
    {HEWN_MESH_OBJ, HEWN_DOMAIN_CORNER, "normal", 3, 3, false},
    {HEWN_MESH_OBJ, HEWN_DOMAIN_CORNER, "uv", 2, 2, false},
    {HEWN_MESH_OBJ, HEWN_DOMAIN_FACE, "object", 1, 1, true},
    {HEWN_MESH_OBJ, HEWN_DOMAIN_FACE, "group", 1, 1, true},
    {HEWN_MESH_OBJ, HEWN_DOMAIN_FACE, "material", 1, 1, true},
    {HEWN_MESH_OBJ, HEWN_DOMAIN_FACE, "smooth", 1, 1, true},
    {HEWN_MESH_OFF, HEWN_DOMAIN_VERT, "color", 3, 4, false},
    {HEWN_MESH_OFF, HEWN_DOMAIN_VERT, "normal", 3, 3, false},
    {HEWN_MESH_OFF, HEWN_DOMAIN_VERT, "uv", 2, 2, false},
    {HEWN_MESH_OFF, HEWN_DOMAIN_FACE, "color", 3, 4, false},
    {HEWN_MESH_STL, HEWN_DOMAIN_FACE, "attribute", 1, 1, true},
};

/* Where corners have texture coordinates or normals, OBJ leaves those of the vertices out. */
static bool is_hidden(const hewn_model *model, const hewn_attribute_info *info)
{
    return info->domain == HEWN_DOMAIN_VERT && strcmp(info->name, "color") != 0 &&
           hewn_model_find_channel(model, HEWN_DOMAIN_CORNER, info->name);
}

static bool glb_keeps(const hewn_model *model, const hewn_channel *channel)
{
    hewn_writing job = {.vertex_count = model->vertex_count,
                        .face_count = model->face_count,
                        .corner_count = hewn_model_corner_count(model),
                        .channels = model->channels,
                        .channel_count = model->channel_count};
    return hewn_glb_keeps(&job, channel);
}

bool hewn_mesh_format_keeps(hewn_mesh_format format, const hewn_model *model, const hewn_channel *channel)
{
    const hewn_attribute_info *info = &channel->info;
    if (format == HEWN_MESH_PLY)
        return true;
    if (format == HEWN_MESH_GLB)
        return glb_keeps(model, channel);
    if (format == HEWN_MESH_OBJ && is_hidden(model, info))
        return false;
    for (size_t i = 0; i < sizeof kept / sizeof *kept; i++) {
        const kept_channel *place = &kept[i];
        if (place->format == format && place->domain == info->domain && strcmp(place->name, info->name) == 0 &&
            info->components >= place->least && info->components <= place->most &&
            place->integer == (info->scalar == HEWN_SCALAR_INT32))
            return true;
    }
    return false;
}
