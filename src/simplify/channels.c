#include "simplify/channels.h"

#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"

/* What a difference of the whole range of an attribute weighs, in half sides of the mesh's box. */
static const double uv_weight = 0.05, color_weight = 0.02, normal_weight = 0.01;

static double scalar_at(const hewn_channel *channel, uint64_t element, uint32_t component)
{
    const uint64_t at = element * channel->info.components + component;
    switch (channel->info.scalar) {
    case HEWN_SCALAR_FLOAT: return (double)((const float *)channel->values)[at];
    case HEWN_SCALAR_DOUBLE: return ((const double *)channel->values)[at];
    case HEWN_SCALAR_UINT8: return ((const uint8_t *)channel->values)[at];
    default: return ((const int32_t *)channel->values)[at];
    }
}

static void set_scalar(hewn_channel *channel, uint64_t element, uint32_t component, double value)
{
    const uint64_t at = element * channel->info.components + component;
    switch (channel->info.scalar) {
    case HEWN_SCALAR_FLOAT: ((float *)channel->values)[at] = (float)value; break;
    case HEWN_SCALAR_DOUBLE: ((double *)channel->values)[at] = value; break;
    case HEWN_SCALAR_UINT8: ((uint8_t *)channel->values)[at] = (uint8_t)(value + 0.5); break;
    default: ((int32_t *)channel->values)[at] = (int32_t)value; break;
    }
}

static bool is_named(const hewn_channel *channel, const char *name)
{
    return strncmp(channel->info.name, name, strlen(name)) == 0;
}

/* The bit of `preserve` that speaks for a channel of vertices or corners; 0: none does. */
static uint32_t bit_of(const hewn_channel *channel)
{
    return is_named(channel, "uv")       ? HEWN_PRESERVE_UV
           : is_named(channel, "color")  ? HEWN_PRESERVE_COLOR
           : is_named(channel, "normal") ? HEWN_PRESERVE_NORMAL
                                         : 0;
}

/* Normals that do not count are made anew; texture coordinates that do not count mean nothing without their seams. */
static bool is_carried(const hewn_channel *channel, uint32_t preserve)
{
    const uint32_t bit = bit_of(channel);
    return channel->info.domain != HEWN_DOMAIN_FACE && (bit == 0 || (bit & preserve) || bit == HEWN_PRESERVE_COLOR);
}

static bool is_counted(const hewn_channel *channel, uint32_t preserve)
{
    return channel->info.domain != HEWN_DOMAIN_FACE && channel->info.scalar != HEWN_SCALAR_INT32 &&
           (bit_of(channel) & preserve);
}

static bool makes_seams(const hewn_channel *channel, uint32_t preserve)
{
    const uint32_t bit = bit_of(channel);
    return channel->info.domain == HEWN_DOMAIN_CORNER && (bit == 0 || (bit & preserve));
}

/* --- wedges ------------------------------------------------------------------------------------------------------- */

/* Whether two corners have the same values in all channels that make seams. */
static bool are_alike(const hewn_model *model, uint32_t preserve, uint32_t a, uint32_t b)
{
    for (uint32_t i = 0; i < model->channel_count; i++) {
        const hewn_channel *channel = &model->channels[i];
        const size_t stride = channel->info.components * hewn_scalar_size(channel->info.scalar);
        const char *values = channel->values;
        if (makes_seams(channel, preserve) && memcmp(values + a * stride, values + b * stride, stride) != 0)
            return false;
    }
    return true;
}

/* Corners by vertex, in order. */
static void list_corners(const hewn_model *model, uint64_t count, uint32_t *first, uint32_t *list)
{
    for (uint64_t c = 0; c < count; c++)
        first[model->corners[c] + 1]++;
    for (uint64_t v = 0; v < model->vertex_count; v++)
        first[v + 1] += first[v];
    for (uint64_t c = count; c-- > 0;)
        list[--first[model->corners[c] + 1]] = (uint32_t)c;
}

/* Afterwards first[v + 1] is where the list of v begins. Each corner takes the wedge of the first that is like it. */
static hewn_result find_wedges(const hewn_model *model, uint32_t preserve, simplify_channels *out, hewn_error *error)
{
    const uint64_t count = hewn_model_corner_count(model);
    uint32_t *first = hewn_alloc_zero(model->vertex_count + 2, sizeof *first);
    uint32_t *list = hewn_alloc(count, sizeof *list);
    out->corners = hewn_alloc(count, sizeof *out->corners);
    if (first && list && out->corners) {
        uint32_t wedges = 0;
        list_corners(model, count, first, list);
        for (uint64_t v = 0; v < model->vertex_count; v++) {
            const uint32_t begin = first[v + 1], end = v + 1 < model->vertex_count ? first[v + 2] : (uint32_t)count;
            for (uint32_t i = begin; i < end; i++) {
                uint32_t k = begin;
                while (k < i && !are_alike(model, preserve, list[k], list[i]))
                    k++;
                out->corners[list[i]] = k < i ? out->corners[list[k]] : wedges++;
            }
        }
        out->wedges.count = wedges;
        out->wedges.corners = out->corners;
    }
    const bool done = first && list && out->corners;
    hewn_free(first);
    hewn_free(list);
    return done ? HEWN_OK : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for attributes");
}

/* --- scalars ------------------------------------------------------------------------------------------------------ */

static double weight_of(const hewn_model *model, const hewn_channel *channel)
{
    if (bit_of(channel) == HEWN_PRESERVE_NORMAL)
        return normal_weight;
    if (bit_of(channel) == HEWN_PRESERVE_COLOR)
        return channel->info.scalar == HEWN_SCALAR_UINT8 ? color_weight / 255 : color_weight;
    const uint64_t count = hewn_model_domain_count(model, channel->info.domain);
    double least = INFINITY, most = -INFINITY;
    for (uint64_t i = 0; i < count; i++)
        for (uint32_t k = 0; k < channel->info.components; k++) {
            const double value = scalar_at(channel, i, k);
            least = fmin(least, value);
            most = fmax(most, value);
        }
    return most > least && isfinite(most - least) ? uv_weight / (most - least) : 0;
}

/* Those that count come first. */
static hewn_result place_scalars(const hewn_model *model, uint32_t preserve, simplify_channels *out, hewn_error *error)
{
    simplify_wedges *wedges = &out->wedges;
    out->first = hewn_alloc(model->channel_count, sizeof *out->first);
    if (!out->first)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for attributes");
    for (int counted = 1; counted >= 0; counted--) {
        for (uint32_t i = 0; i < model->channel_count; i++) {
            const hewn_channel *channel = &model->channels[i];
            const bool counts = is_counted(channel, preserve);
            if (counted)
                out->first[i] = HEWN_NONE;
            if (!is_carried(channel, preserve) || counts != (counted == 1))
                continue;
            if (counts && wedges->scalars + channel->info.components > SIMPLIFY_MOST_COUNTED)
                return hewn_fail(error, HEWN_LIMIT, "at most %d numbers a corner can be preserved",
                                 SIMPLIFY_MOST_COUNTED);
            out->first[i] = wedges->scalars;
            for (uint32_t k = 0; counts && k < channel->info.components; k++)
                wedges->weights[wedges->scalars + k] = weight_of(model, channel);
            wedges->scalars += channel->info.components;
        }
        wedges->counted = counted ? wedges->scalars : wedges->counted;
    }
    return HEWN_OK;
}

static hewn_result fill_scalars(const hewn_model *model, simplify_channels *out, hewn_error *error)
{
    simplify_wedges *wedges = &out->wedges;
    const uint64_t count = hewn_model_corner_count(model);
    wedges->values = hewn_alloc_zero(wedges->count, wedges->scalars * sizeof *wedges->values);
    wedges->fixed = hewn_alloc_zero(wedges->scalars, 1);
    if (!wedges->values || !wedges->fixed)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for attributes");
    for (uint32_t i = 0; i < model->channel_count; i++) {
        const hewn_channel *channel = &model->channels[i];
        if (out->first[i] == HEWN_NONE)
            continue;
        for (uint32_t k = 0; k < channel->info.components; k++) {
            wedges->fixed[out->first[i] + k] = channel->info.scalar == HEWN_SCALAR_INT32;
            for (uint64_t c = count; c-- > 0;) {
                const uint32_t vertex = model->corners[c], wedge = out->corners ? out->corners[c] : vertex;
                const uint64_t element = channel->info.domain == HEWN_DOMAIN_VERT ? vertex : c;
                wedges->values[(size_t)wedge * wedges->scalars + out->first[i] + k] = scalar_at(channel, element, k);
            }
        }
    }
    return HEWN_OK;
}

hewn_result hewn_simplify_take_channels(const hewn_model *model, uint32_t preserve, simplify_channels *out,
                                        hewn_error *error)
{
    bool seams = false;
    *out = (simplify_channels){.wedges = {.count = (uint32_t)model->vertex_count}};
    HEWN_TRY(place_scalars(model, preserve, out, error));
    for (uint32_t i = 0; i < model->channel_count; i++)
        seams |= makes_seams(&model->channels[i], preserve);
    if (seams)
        HEWN_TRY(find_wedges(model, preserve, out, error));
    return out->wedges.scalars > 0 ? fill_scalars(model, out, error) : HEWN_OK;
}

void hewn_simplify_release_channels(simplify_channels *channels)
{
    hewn_free(channels->first);
    hewn_free(channels->corners);
    hewn_free(channels->wedges.values);
    hewn_free(channels->wedges.fixed);
    *channels = (simplify_channels){0};
}

/* --- back --------------------------------------------------------------------------------------------------------- */

static void give_wedges(const simplify_channels *channels, uint32_t first, const simplify_result *result,
                        hewn_channel *out)
{
    const hewn_simplified *mesh = &result->mesh;
    const bool vertices = out->info.domain == HEWN_DOMAIN_VERT;
    for (uint64_t c = 3 * mesh->face_count; c-- > 0;) {
        const double *values = result->values + (size_t)result->wedges[c] * channels->wedges.scalars + first;
        for (uint32_t k = 0; k < out->info.components; k++)
            set_scalar(out, vertices ? mesh->corners[c] : c, k, values[k]);
    }
}

static void give_faces(const hewn_channel *from, const simplify_result *result, hewn_channel *out)
{
    const size_t stride = from->info.components * hewn_scalar_size(from->info.scalar);
    for (uint64_t f = 0; f < result->mesh.face_count; f++)
        memcpy((char *)out->values + f * stride, (const char *)from->values + result->mesh.face_origins[f] * stride,
               stride);
}

static void lengthen(hewn_channel *normals, uint64_t count)
{
    for (uint64_t i = 0; i < count; i++) {
        double n[3], square = 0;
        for (uint32_t k = 0; k < 3; k++) {
            n[k] = scalar_at(normals, i, k);
            square += n[k] * n[k];
        }
        for (uint32_t k = 0; k < 3 && square > 0; k++)
            set_scalar(normals, i, k, n[k] / sqrt(square));
    }
}

static bool is_direction(const hewn_channel *channel)
{
    return strcmp(channel->info.name, "normal") == 0 && channel->info.components == 3 &&
           (channel->info.scalar == HEWN_SCALAR_FLOAT || channel->info.scalar == HEWN_SCALAR_DOUBLE);
}

hewn_result hewn_simplify_give_channels(const hewn_model *from, const simplify_channels *channels,
                                        const simplify_result *result, hewn_model *out, hewn_error *error)
{
    for (uint32_t i = 0; i < from->channel_count; i++) {
        const hewn_channel *channel = &from->channels[i];
        const bool anew = is_direction(channel) && channels->first[i] == HEWN_NONE;
        hewn_channel *made;
        if (channel->info.domain != HEWN_DOMAIN_FACE && channels->first[i] == HEWN_NONE && !anew)
            continue;
        HEWN_TRY(hewn_model_add_channel(out, &channel->info, &made, error));
        for (uint32_t n = 0; n < channel->name_count; n++) {
            int32_t value;
            HEWN_TRY(hewn_channel_value(made, channel->names[n], &value, error));
        }
        if (channel->info.domain == HEWN_DOMAIN_FACE)
            give_faces(channel, result, made);
        else if (!anew)
            give_wedges(channels, channels->first[i], result, made);
        if (!anew && is_direction(made) && made->info.domain != HEWN_DOMAIN_FACE)
            lengthen(made, hewn_model_domain_count(out, made->info.domain));
    }
    return HEWN_OK;
}

/* --- labels ------------------------------------------------------------------------------------------------------- */

/* Groups for shading are no labels. */
static bool is_label(const hewn_channel *channel, uint32_t preserve)
{
    if (channel->info.domain != HEWN_DOMAIN_FACE)
        return false;
    if (channel->info.scalar == HEWN_SCALAR_INT32)
        return (preserve & HEWN_PRESERVE_LABEL) && strcmp(channel->info.name, "smooth") != 0;
    return (preserve & HEWN_PRESERVE_COLOR) && is_named(channel, "color");
}

/* Numbers are mixed by a hash, which may take few of many kinds for one. */
hewn_result hewn_simplify_join_labels(const hewn_model *model, uint32_t preserve, int32_t **out, hewn_error *error)
{
    *out = NULL;
    for (uint32_t i = 0; i < model->channel_count; i++) {
        const hewn_channel *channel = &model->channels[i];
        if (!is_label(channel, preserve))
            continue;
        if (!*out)
            *out = hewn_alloc_zero(model->face_count, sizeof **out);
        if (!*out)
            return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for labels");
        const size_t stride = channel->info.components * hewn_scalar_size(channel->info.scalar);
        for (uint64_t f = 0; f < model->face_count; f++) {
            const unsigned char *bytes = (const unsigned char *)channel->values + f * stride;
            uint64_t mixed = (uint32_t)(*out)[f];
            for (size_t b = 0; b < stride; b++)
                mixed = (mixed ^ bytes[b]) * 0x100000001b3u + (mixed >> 29);
            mixed = (mixed ^ mixed >> 31) * 0xbf58476d1ce4e5b9u;
            (*out)[f] = (int32_t)(uint32_t)(mixed >> 32);
        }
    }
    return HEWN_OK;
}
