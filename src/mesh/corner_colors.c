#include "mesh/corner_colors.h"

#include <math.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/srgb.h"
#include "mesh/cut.h"

static const hewn_channel *find_colors(const hewn_model *model, hewn_domain domain)
{
    const hewn_channel *channel = hewn_model_find_channel(model, domain, "color");
    bool fits = channel && (channel->info.components == 3 || channel->info.components == 4);
    return fits && channel->info.scalar != HEWN_SCALAR_INT32 ? channel : NULL;
}

static float made_linear(double value, bool linear)
{
    double share = fmin(fmax(value, 0), 1); /* NaN is 0 */
    return (float)(linear ? share : hewn_srgb_to_linear(share));
}

static float color_at(const hewn_channel *channel, uint64_t element, uint32_t k, bool linear)
{
    uint64_t at = element * channel->info.components + k;
    switch (channel->info.scalar) {
    case HEWN_SCALAR_UINT8: return made_linear(((const uint8_t *)channel->values)[at] / 255.0, linear);
    case HEWN_SCALAR_FLOAT: return made_linear((double)((const float *)channel->values)[at], linear);
    default: return made_linear(((const double *)channel->values)[at], linear);
    }
}

/* What one corner of a face has. */
typedef struct colors {
    const hewn_channel *corners, *vertices, *faces;
    bool linear;
} colors;

static void take_corner(const colors *own, uint64_t corner, uint32_t vertex, uint64_t face, float out[3])
{
    for (uint32_t k = 0; k < 3; k++) {
        out[k] = 1;
        if (own->corners)
            out[k] = color_at(own->corners, corner, k, own->linear);
        else if (own->vertices)
            out[k] = color_at(own->vertices, vertex, k, own->linear);
        if (own->faces)
            out[k] *= color_at(own->faces, face, k, own->linear);
    }
}

static void fill(const hewn_model *model, const colors *own, const uint32_t *cut, uint64_t count, float *out)
{
    uint64_t face = 0;
    for (uint64_t i = 0; i < 3 * count; i++) {
        uint64_t corner = cut ? cut[i] : i;
        if (!model->first)
            face = i / 3;
        else if (i % 3 == 0) /* triangles follow their faces */
            while (corner >= model->first[face + 1])
                face++;
        take_corner(own, corner, model->corners[corner], face, out + 3 * i);
    }
}

hewn_result hewn_corner_colors_of_model(const hewn_model *model, bool linear, float **out, hewn_error *error)
{
    *out = NULL;
    HEWN_TRY(hewn_model_check(model, error));
    colors own = {find_colors(model, HEWN_DOMAIN_CORNER), find_colors(model, HEWN_DOMAIN_VERT),
                  find_colors(model, HEWN_DOMAIN_FACE), linear};
    if (!linear && (own.corners || own.vertices))
        own.faces = NULL;
    if (!own.corners && !own.vertices && !own.faces)
        return HEWN_OK;
    uint32_t *cut = NULL;
    uint64_t count = model->face_count;
    if (model->first) {
        hewn_polygons polygons = hewn_model_polygons(model);
        HEWN_TRY(hewn_cut_polygons(&polygons, &cut, &count, NULL, error));
    }
    *out = hewn_alloc(count, 9 * sizeof **out);
    if (*out)
        fill(model, &own, cut, count, *out);
    hewn_free(cut);
    return *out ? HEWN_OK
                : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the colours of %llu triangles",
                            (unsigned long long)count);
}
