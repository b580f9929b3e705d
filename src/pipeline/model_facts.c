#include "pipeline/model_facts.h"

#include <math.h>

#include "base/alloc.h"
#include "base/error.h"
#include "pipeline/json_parts.h"

hewn_model_facts hewn_model_facts_of(const hewn_model *model)
{
    hewn_model_facts facts = {.corners = hewn_model_corner_count(model)};
    for (uint64_t f = 0; f < model->face_count; f++) {
        uint64_t degree = model->first ? model->first[f + 1] - model->first[f] : 3;
        facts.triangles += degree == 3;
        facts.quads += degree == 4;
        facts.polygons += degree > 4;
        facts.most_corners = degree > facts.most_corners ? degree : facts.most_corners;
    }
    for (int axis = 0; axis < 3 && model->vertex_count > 0; axis++)
        facts.bounds.lo[axis] = facts.bounds.hi[axis] = model->positions[axis];
    for (uint64_t i = 0; i < 3 * model->vertex_count; i++) {
        double value = model->positions[i], *lo = &facts.bounds.lo[i % 3], *hi = &facts.bounds.hi[i % 3];
        *lo = value < *lo ? value : *lo;
        *hi = value > *hi ? value : *hi;
    }
    return facts;
}

static double value_at(const hewn_channel *channel, uint64_t at)
{
    switch (channel->info.scalar) {
    case HEWN_SCALAR_FLOAT: return (double)((const float *)channel->values)[at];
    case HEWN_SCALAR_DOUBLE: return ((const double *)channel->values)[at];
    case HEWN_SCALAR_UINT8: return ((const uint8_t *)channel->values)[at];
    case HEWN_SCALAR_INT32: return ((const int32_t *)channel->values)[at];
    }
    return NAN;
}

void hewn_channel_range(const hewn_model *model, const hewn_channel *channel, uint32_t component, double *lo,
                        double *hi)
{
    uint64_t count = hewn_model_domain_count(model, channel->info.domain);
    *lo = *hi = NAN;
    for (uint64_t i = 0; i < count; i++) {
        double value = value_at(channel, i * channel->info.components + component);
        *lo = value < *lo || isnan(*lo) ? value : *lo;
        *hi = value > *hi || isnan(*hi) ? value : *hi;
    }
}

hewn_result hewn_channel_uses(const hewn_model *model, const hewn_channel *channel, uint64_t **out, hewn_error *error)
{
    uint64_t count = hewn_model_domain_count(model, channel->info.domain) * channel->info.components;
    const int32_t *values = channel->values;
    *out = hewn_alloc_zero(channel->name_count, sizeof **out);
    if (!*out)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %u names", channel->name_count);
    for (uint64_t i = 0; channel->info.scalar == HEWN_SCALAR_INT32 && i < count; i++)
        if (values[i] >= 0 && (uint32_t)values[i] < channel->name_count)
            (*out)[values[i]]++;
    return HEWN_OK;
}

const char *hewn_domain_name(hewn_domain domain)
{
    switch (domain) {
    case HEWN_DOMAIN_VERT: return "vertex";
    case HEWN_DOMAIN_CORNER: return "corner";
    case HEWN_DOMAIN_FACE: return "face";
    }
    return "?";
}

const char *hewn_scalar_name(hewn_scalar scalar)
{
    switch (scalar) {
    case HEWN_SCALAR_FLOAT: return "float";
    case HEWN_SCALAR_DOUBLE: return "double";
    case HEWN_SCALAR_UINT8: return "uint8";
    case HEWN_SCALAR_INT32: return "int32";
    }
    return "?";
}

/* --- JSON -------------------------------------------------------------------------------------------------------- */

static hewn_result print_channel(hewn_json *json, const hewn_model *model, const hewn_channel *channel,
                                 hewn_error *error)
{
    double lo, hi;
    uint64_t *uses;
    hewn_json_object(json, NULL);
    hewn_json_string(json, "name", channel->info.name);
    hewn_json_string(json, "domain", hewn_domain_name(channel->info.domain));
    hewn_json_string(json, "type", hewn_scalar_name(channel->info.scalar));
    hewn_json_unsigned(json, "components", channel->info.components);
    for (int side = 0; side < 2; side++) {
        hewn_json_array(json, side ? "hi" : "lo");
        for (uint32_t k = 0; k < channel->info.components; k++) {
            hewn_channel_range(model, channel, k, &lo, &hi);
            hewn_json_number(json, NULL, side ? hi : lo);
        }
        hewn_json_end_array(json);
    }
    if (channel->name_count > 0) {
        HEWN_TRY(hewn_channel_uses(model, channel, &uses, error));
        hewn_json_array(json, "values");
        for (uint32_t i = 0; i < channel->name_count; i++) {
            hewn_json_object(json, NULL);
            hewn_json_string(json, "name", channel->names[i]);
            hewn_json_unsigned(json, "count", uses[i]);
            hewn_json_end_object(json);
        }
        hewn_json_end_array(json);
        hewn_free(uses);
    }
    hewn_json_end_object(json);
    return HEWN_OK;
}

hewn_result hewn_json_model(hewn_json *json, const hewn_model *model, hewn_error *error)
{
    hewn_model_facts facts = hewn_model_facts_of(model);
    hewn_json_object(json, "counts");
    hewn_json_unsigned(json, "vertices", model->vertex_count);
    hewn_json_unsigned(json, "faces", model->face_count);
    hewn_json_unsigned(json, "corners", facts.corners);
    hewn_json_unsigned(json, "triangles", facts.triangles);
    hewn_json_unsigned(json, "quads", facts.quads);
    hewn_json_unsigned(json, "polygons", facts.polygons);
    hewn_json_unsigned(json, "most_corners", facts.most_corners);
    hewn_json_end_object(json);
    hewn_json_string(json, "unit", model->unit ? model->unit->name : NULL);
    hewn_json_string(json, "up", model->up_known ? hewn_axis_name(model->up) : NULL);
    hewn_json_box(json, "bounds", &facts.bounds);
    hewn_json_array(json, "attributes");
    for (uint32_t i = 0; i < model->channel_count; i++)
        HEWN_TRY(print_channel(json, model, &model->channels[i], error));
    hewn_json_end_array(json);
    return HEWN_OK;
}
