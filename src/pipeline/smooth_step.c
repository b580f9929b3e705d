#include "pipeline/smooth_step.h"

#include <string.h>

#include "base/alloc.h"
#include "base/error.h"

/* A byte of 255 is 1, as with colours. */
static double mask_at(const hewn_channel *channel, uint64_t v)
{
    switch (channel->info.scalar) {
    case HEWN_SCALAR_FLOAT: return (double)((const float *)channel->values)[v];
    case HEWN_SCALAR_DOUBLE: return ((const double *)channel->values)[v];
    case HEWN_SCALAR_UINT8: return ((const uint8_t *)channel->values)[v] / 255.0;
    default: return ((const int32_t *)channel->values)[v];
    }
}

static hewn_result read_mask(const hewn_model *model, const char *name, double **out, hewn_error *error)
{
    const hewn_channel *channel = hewn_model_find_channel(model, HEWN_DOMAIN_VERT, name);
    if (!channel || channel->info.components != 1)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the mesh has no vertex attribute \"%s\" of one component",
                         name);
    *out = hewn_alloc(model->vertex_count, sizeof **out);
    if (!*out)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the mask");
    for (uint64_t v = 0; v < model->vertex_count; v++)
        (*out)[v] = mask_at(channel, v);
    return HEWN_OK;
}

/* Labels are all whole numbers of faces but groups for shading; two faces are of one kind where all agree. A second
 * channel is mixed into the first by a hash, which may take few of many kinds for one. */
static hewn_result join_labels(const hewn_model *model, int32_t **out, hewn_error *error)
{
    size_t faces = model->face_count;
    *out = hewn_alloc_zero(faces, sizeof **out);
    if (!*out)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for labels");
    bool any = false;
    for (uint32_t i = 0; i < model->channel_count; i++) {
        const hewn_channel *channel = &model->channels[i];
        if (channel->info.domain != HEWN_DOMAIN_FACE || channel->info.scalar != HEWN_SCALAR_INT32 ||
            channel->info.components != 1 || strcmp(channel->info.name, "smooth") == 0)
            continue;
        for (size_t f = 0; f < faces; f++) { /* a mixing of both numbers, equal where both are */
            uint64_t both = (uint64_t)(uint32_t)(*out)[f] << 32 | (uint32_t)((const int32_t *)channel->values)[f];
            uint64_t mixed = (both ^ both >> 29) * 0xbf58476d1ce4e5b9u >> 32;
            (*out)[f] = (int32_t)(uint32_t)(any ? mixed : both);
        }
        any = true;
    }
    return HEWN_OK;
}

hewn_result hewn_smooth_step(hewn_model *model, const hewn_file_smooth *smooth, const hewn_progress *progress,
                             hewn_smooth_report *report, hewn_error *error)
{
    hewn_smooth_desc desc = smooth->desc;
    double *mask = NULL;
    int32_t *labels = NULL;
    hewn_result result = smooth->mask ? read_mask(model, smooth->mask, &mask, error) : HEWN_OK;
    if (result == HEWN_OK && smooth->lock_labels)
        result = join_labels(model, &labels, error);
    desc.freedom = mask;
    desc.labels = labels;
    desc.progress = progress;
    if (result == HEWN_OK)
        result = hewn_model_smooth(model, &desc, report, error);
    hewn_free(mask);
    hewn_free(labels);
    return result;
}

/* What the method does not have is null. */
static void print_parameter(hewn_json *json, const char *key, double value)
{
    hewn_json_number(json, key, value > 0 ? value : 0.0 / 0.0);
}

void hewn_smooth_json(hewn_json *json, hewn_smooth_method method, const hewn_smooth_report *report)
{
    hewn_json_object(json, "smooth");
    hewn_json_string(json, "method", hewn_smooth_method_name(method));
    hewn_json_unsigned(json, "iterations", report->iterations);
    print_parameter(json, "strength", report->strength);
    print_parameter(json, "passband", report->passband);
    print_parameter(json, "step", report->step);
    print_parameter(json, "angle", report->angle);
    print_parameter(json, "radius", report->radius);
    hewn_json_unsigned(json, "locked_vertices", report->locked_vertices);
    hewn_json_unsigned(json, "clamped_vertices", report->clamped_vertices);
    hewn_json_unsigned(json, "closed_components", report->closed_components);
    hewn_json_number(json, "volume_before", report->volume_before);
    hewn_json_number(json, "volume_after", report->volume_after);
    hewn_json_number(json, "area_before", report->area_before);
    hewn_json_number(json, "area_after", report->area_after);
    hewn_json_number(json, "largest_move", report->largest_move);
    hewn_json_number(json, "mean_move", report->mean_move);
    hewn_json_end_object(json);
}
