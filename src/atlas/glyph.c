#include "atlas/glyph.h"

#include <math.h>
#include <string.h>

#include "atlas/colours.h"
#include "base/alloc.h"
#include "base/error.h"

/* How many ways to colour edges are tried. */
enum { COLOURINGS = 12 };

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

static void copy_texels(const uint8_t (*drawn)[4], hewn_atlas_type type, const hewn_texels *texels)
{
    for (uint32_t y = 0; y < texels->height; y++)
        for (uint32_t x = 0; x < texels->width; x++) {
            const uint8_t *from = drawn[(size_t)y * texels->width + x];
            uint8_t *to = texels->first + y * texels->stride + (size_t)x * texels->channels;
            for (uint32_t k = 0; k < texels->channels; k++)
                to[k] = from[type == HEWN_ATLAS_SDF ? 3 : k];
        }
}

/* What is kept of the colours that were tried. */
typedef struct trial {
    hewn_drawn raw, drawn; /* before and after softening; they share their plain distances */
    hewn_covered covered;
    uint8_t (*best)[4];
    double least; /* of what is wrong */
    size_t softened;
} trial;

static void draw_rows(const hewn_shape *shape, hewn_atlas_type type, hewn_drawn *drawn)
{
    double first[4] = {INFINITY, INFINITY, INFINITY, INFINITY};
    for (uint32_t y = 0; y < drawn->height; y++)
        draw_row(shape, type, drawn, y, first);
}

/* With the shape's colours as they are. */
static hewn_result try_colours(const hewn_shape *shape, hewn_atlas_type type, trial *own)
{
    size_t bytes = (size_t)own->raw.width * own->raw.height * sizeof *own->best;
    draw_rows(shape, type, &own->raw);
    for (int gently = 0; gently < 2; gently++) {
        size_t softened;
        memcpy(own->drawn.texels, own->raw.texels, bytes);
        HEWN_TRY(hewn_drawn_soften(shape, &own->drawn, gently, &softened, NULL));
        double wrong = hewn_drawn_wrong(&own->drawn, &own->covered);
        if (wrong < own->least) {
            own->least = wrong;
            own->softened = softened;
            memcpy(own->best, own->drawn.texels, bytes);
        }
    }
    return HEWN_OK;
}

static hewn_result draw_coloured(hewn_shape *shape, hewn_atlas_type type, trial *own)
{
    size_t count = (size_t)own->raw.width * own->raw.height;
    draw_rows(shape, type, &own->raw);
    memcpy(own->best, own->raw.texels, count * sizeof *own->best);
    memcpy(own->drawn.texels, own->raw.texels, count * sizeof *own->best);
    HEWN_TRY(hewn_drawn_soften(shape, &own->drawn, false, &own->softened, NULL));
    if (own->softened == 0)
        return HEWN_OK;
    HEWN_TRY(hewn_shape_cover(shape, own->raw.width, own->raw.height, &own->covered, NULL));
    own->least = INFINITY;
    for (uint32_t number = 0; number < COLOURINGS && own->softened > 0; number++) {
        hewn_shape_recolour(shape, number);
        HEWN_TRY(try_colours(shape, type, own));
    }
    return HEWN_OK;
}

hewn_result hewn_glyph_draw(hewn_shape *shape, hewn_atlas_type type, double range, const hewn_texels *texels,
                            size_t *softened, hewn_error *error)
{
    size_t count = (size_t)texels->width * texels->height;
    trial own = {.raw = {.width = texels->width, .height = texels->height, .range = range}};
    own.raw.distances = hewn_alloc(count, sizeof *own.raw.distances);
    own.drawn = own.raw;
    own.raw.texels = hewn_alloc(count, sizeof *own.raw.texels);
    own.drawn.texels = hewn_alloc(count, sizeof *own.drawn.texels);
    own.best = hewn_alloc(count, sizeof *own.best);
    hewn_result result =
        own.raw.distances && own.raw.texels && own.drawn.texels && own.best ? HEWN_OK : HEWN_OUT_OF_MEMORY;
    bool coloured = type == HEWN_ATLAS_MSDF || type == HEWN_ATLAS_MTSDF;
    if (result == HEWN_OK && coloured)
        result = draw_coloured(shape, type, &own);
    else if (result == HEWN_OK)
        draw_rows(shape, type, &own.raw);
    if (result == HEWN_OK)
        copy_texels(coloured ? (const uint8_t(*)[4])own.best : (const uint8_t(*)[4])own.raw.texels, type, texels);
    *softened = own.softened;
    hewn_free(own.raw.distances);
    hewn_free(own.raw.texels);
    hewn_free(own.drawn.texels);
    hewn_free(own.best);
    hewn_free(own.covered.shares);
    return result == HEWN_OK ? HEWN_OK : hewn_fail(error, result, "out of memory for a letter");
}
