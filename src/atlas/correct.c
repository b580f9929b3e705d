/* What interpolation between texels shows is compared with the outline itself, at points between them. Far from the
 * outline the plain distances of the texels say which side a point is on; near it the distance is computed. */
#include <math.h>
#include <string.h>

#include "atlas/glyph.h"
#include "base/alloc.h"
#include "base/error.h"

enum { FINE = 4, MOST_ROUNDS = 16 };

/* Up to here, in texels, an outline may be off. */
#define SLACK 0.08

static double middle_of_three(double a, double b, double c)
{
    return fmax(fmin(a, b), fmin(fmax(a, b), c));
}

/* Between four texels, in the order of rows. */
static double between(const double v[4], double x, double y)
{
    double upper = v[0] + x * (v[1] - v[0]), lower = v[2] + x * (v[3] - v[2]);
    return upper + y * (lower - upper);
}

/* Four neighbours, and what they show: the distances as texels hold them, in texels. */
typedef struct square {
    size_t at[4];
    double shown[4][4]; /* of each of the three and the plain one, at each of the four */
} square;

static square square_at(const hewn_drawn *drawn, uint32_t x, uint32_t y)
{
    size_t first = (size_t)y * drawn->width + x;
    square own = {.at = {first, first + 1, first + drawn->width, first + drawn->width + 1}};
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 4; k++)
            own.shown[k][i] = (drawn->texels[own.at[i]][k] / 255.0 - 0.5) * drawn->range;
    return own;
}

static bool is_coloured(const hewn_drawn *drawn, const square *own)
{
    for (int i = 0; i < 4; i++) {
        const uint8_t *texel = drawn->texels[own->at[i]];
        if (texel[0] != texel[1] || texel[1] != texel[2])
            return true;
    }
    return false;
}

/* How far on the wrong side something is. */
static double error_of(double shown, double true_distance)
{
    return (shown >= 0) == (true_distance >= 0) ? 0 : fabs(true_distance);
}

static bool is_wrong(const hewn_shape *shape, const hewn_drawn *drawn, const square *own, uint32_t x, uint32_t y)
{
    double least = INFINITY, first = drawn->distances[own->at[0]];
    bool alike = true;
    for (int i = 0; i < 4; i++) {
        least = fmin(least, fabs(drawn->distances[own->at[i]]));
        alike = alike && (drawn->distances[own->at[i]] >= 0) == (first >= 0);
    }
    bool far = alike && least > 0.75; /* no point of a square is farther from its corners */
    for (int i = 0; i < FINE * FINE; i++) {
        double u = (i % FINE + 0.5) / FINE, v = (i / FINE + 0.5) / FINE;
        double shown =
            middle_of_three(between(own->shown[0], u, v), between(own->shown[1], u, v), between(own->shown[2], u, v));
        if (far) {
            if ((shown >= 0) != (first >= 0))
                return true;
            continue;
        }
        const double p[2] = {x + 0.5 + u, drawn->height - y - 0.5 - v};
        double true_distance = hewn_shape_distance(shape, p, fabs(first) + 1.5);
        double error = error_of(shown, true_distance);
        if (error > SLACK && error > error_of(between(own->shown[3], u, v), true_distance))
            return true;
    }
    return false;
}

/* One look at all squares that are not known to be good; what is wrong is marked in `marked`. */
static size_t find_wrong(const hewn_shape *shape, const hewn_drawn *drawn, const uint8_t *changed, uint8_t *marked)
{
    size_t count = 0;
    for (uint32_t y = 0; y + 1 < drawn->height; y++)
        for (uint32_t x = 0; x + 1 < drawn->width; x++) {
            square own = square_at(drawn, x, y);
            bool again = false;
            for (int i = 0; i < 4; i++)
                again = again || changed[own.at[i]];
            if (!again || !is_coloured(drawn, &own) || !is_wrong(shape, drawn, &own, x, y))
                continue;
            for (int i = 0; i < 4; i++)
                marked[own.at[i]] = 1;
            count++;
        }
    return count;
}

hewn_result hewn_drawn_soften(const hewn_shape *shape, hewn_drawn *drawn, size_t *count, hewn_error *error)
{
    size_t texels = (size_t)drawn->width * drawn->height;
    uint8_t *changed = hewn_alloc(texels, 1), *marked = hewn_alloc_zero(texels, 1);
    *count = 0;
    if (!changed || !marked) {
        hewn_free(changed);
        hewn_free(marked);
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a letter");
    }
    memset(changed, 1, texels);
    for (int round = 0; round < MOST_ROUNDS && find_wrong(shape, drawn, changed, marked) > 0; round++) {
        for (size_t i = 0; i < texels; i++) {
            uint8_t *texel = drawn->texels[i];
            changed[i] = marked[i] && (texel[0] != texel[3] || texel[1] != texel[3] || texel[2] != texel[3]);
            if (changed[i])
                memset(texel, texel[3], 3);
            *count += changed[i];
            marked[i] = 0;
        }
    }
    hewn_free(changed);
    hewn_free(marked);
    return HEWN_OK;
}
