#include "pipeline/losses.h"

#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/text.h"

/* --- attributes -------------------------------------------------------------------------------------------------- */

static hewn_result name_lost(const hewn_channel *channel, hewn_file_losses *out, hewn_error *error)
{
    static const char *const domains[] = {
        [HEWN_DOMAIN_VERT] = "vertex", [HEWN_DOMAIN_CORNER] = "corner", [HEWN_DOMAIN_FACE] = "face"};
    hewn_text text = {0};
    hewn_text_print(&text, "%s %s", domains[channel->info.domain], channel->info.name);
    if (hewn_text_status(&text, error) != HEWN_OK) {
        hewn_text_clear(&text);
        return HEWN_OUT_OF_MEMORY;
    }
    out->channels[out->channel_count++] = text.bytes;
    return HEWN_OK;
}

static hewn_result find_channels(const hewn_model *model, hewn_mesh_format format, hewn_file_losses *out,
                                 hewn_error *error)
{
    out->channels = hewn_alloc_zero(model->channel_count, sizeof *out->channels);
    if (!out->channels)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the report");
    for (uint32_t i = 0; i < model->channel_count; i++)
        if (!hewn_mesh_format_keeps(format, model, &model->channels[i]))
            HEWN_TRY(name_lost(&model->channels[i], out, error));
    return HEWN_OK;
}

/* --- geometry ---------------------------------------------------------------------------------------------------- */

static void find_rounding(const hewn_model *model, hewn_file_losses *out)
{
    for (uint64_t v = 0; v < model->vertex_count; v++) {
        bool changed = false;
        for (uint64_t i = 3 * v; i < 3 * v + 3; i++) {
            double change = fabs((double)(float)model->positions[i] - model->positions[i]);
            changed = changed || change > 0;
            out->rounding = change > out->rounding ? change : out->rounding;
        }
        out->rounded += changed;
    }
}

static hewn_result find_isolated(const hewn_model *model, hewn_file_losses *out, hewn_error *error)
{
    uint8_t *used = hewn_alloc_zero(model->vertex_count, 1);
    if (!used)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the report");
    uint64_t corners = hewn_model_corner_count(model);
    for (uint64_t i = 0; i < corners; i++)
        used[model->corners[i]] = 1;
    for (uint64_t v = 0; v < model->vertex_count; v++)
        out->isolated += !used[v];
    hewn_free(used);
    return HEWN_OK;
}

hewn_result hewn_losses_find(const hewn_model *model, hewn_mesh_format format, hewn_file_losses *out, hewn_error *error)
{
    *out = (hewn_file_losses){0};
    bool triangles = format == HEWN_MESH_GLB || format == HEWN_MESH_STL || format == HEWN_MESH_3MF;
    for (uint64_t f = 0; triangles && model->first && f < model->face_count; f++)
        out->cut_faces += model->first[f + 1] - model->first[f] > 3;
    if (format == HEWN_MESH_GLB || format == HEWN_MESH_STL)
        find_rounding(model, out);
    hewn_result result = find_channels(model, format, out, error);
    if (result == HEWN_OK && format == HEWN_MESH_STL)
        result = find_isolated(model, out, error);
    if (result != HEWN_OK)
        hewn_losses_destroy(out);
    return result;
}

void hewn_losses_destroy(hewn_file_losses *losses)
{
    for (uint32_t i = 0; i < losses->channel_count; i++)
        hewn_free(losses->channels[i]);
    hewn_free((void *)losses->channels);
    *losses = (hewn_file_losses){0};
}
