#include "atlas/glyph.h"

#include <math.h>

#include "base/alloc.h"
#include "base/error.h"

uint8_t hewn_texel_of(double distance, double range)
{
    return (uint8_t)(255 * fmin(fmax(distance / range + 0.5, 0), 1) + 0.5);
}

/* Distances differ between neighbours by no more than these are apart, so the last texel tells what not to look at. */
static void begin_near(const double known[4], hewn_near near[4])
{
    for (int k = 0; k < 4; k++)
        near[k] = (hewn_near){.distance = known[k] * (1 + 1e-9) + 1 + 1e-9, .skew = INFINITY};
}

static void draw_row(const hewn_shape *shape, hewn_atlas_type type, hewn_drawn *drawn, uint32_t row, double first[4])
{
    double known[4];
    for (int k = 0; k < 4; k++)
        known[k] = first[k];
    for (uint32_t x = 0; x < drawn->width; x++) {
        const double p[2] = {x + 0.5, drawn->height - row - 0.5};
        size_t at = (size_t)row * drawn->width + x;
        hewn_near near[4];
        begin_near(known, near);
        hewn_shape_nearest(shape, p, near);
        for (int k = 0; k < 4; k++) {
            known[k] = near[k].edge ? near[k].distance : INFINITY;
            if (x == 0)
                first[k] = known[k];
        }
        double distance = hewn_shape_holds(shape, p) ? near[3].distance : -near[3].distance;
        drawn->distances[at] = distance;
        drawn->texels[at][3] = hewn_texel_of(distance, drawn->range);
        for (int k = 0; k < 3; k++) {
            const hewn_near *own = type == HEWN_ATLAS_PSDF ? &near[3] : &near[k];
            drawn->texels[at][k] = hewn_texel_of(own->edge ? hewn_near_straight(own, p) : -INFINITY, drawn->range);
        }
    }
}

static void copy_texels(const hewn_drawn *drawn, hewn_atlas_type type, const hewn_texels *texels)
{
    for (uint32_t y = 0; y < drawn->height; y++)
        for (uint32_t x = 0; x < drawn->width; x++) {
            const uint8_t *from = drawn->texels[(size_t)y * drawn->width + x];
            uint8_t *to = texels->first + y * texels->stride + (size_t)x * texels->channels;
            for (uint32_t k = 0; k < texels->channels; k++)
                to[k] = from[type == HEWN_ATLAS_SDF ? 3 : k];
        }
}

hewn_result hewn_glyph_draw(const hewn_shape *shape, hewn_atlas_type type, double range, const hewn_texels *texels,
                            size_t *softened, hewn_error *error)
{
    size_t count = (size_t)texels->width * texels->height;
    hewn_drawn drawn = {.width = texels->width, .height = texels->height, .range = range};
    drawn.texels = hewn_alloc(count, sizeof *drawn.texels);
    drawn.distances = hewn_alloc(count, sizeof *drawn.distances);
    hewn_result result = drawn.texels && drawn.distances ? HEWN_OK : HEWN_OUT_OF_MEMORY;
    *softened = 0;
    double first[4] = {INFINITY, INFINITY, INFINITY, INFINITY};
    for (uint32_t y = 0; y < drawn.height && result == HEWN_OK; y++)
        draw_row(shape, type, &drawn, y, first);
    if (result == HEWN_OK && (type == HEWN_ATLAS_MSDF || type == HEWN_ATLAS_MTSDF))
        result = hewn_drawn_soften(shape, &drawn, softened, NULL);
    if (result == HEWN_OK)
        copy_texels(&drawn, type, texels);
    hewn_free(drawn.texels);
    hewn_free(drawn.distances);
    return result == HEWN_OK ? HEWN_OK : hewn_fail(error, result, "out of memory for a letter");
}
