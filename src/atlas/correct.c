/* What interpolation between texels shows is compared with the outline itself, at points between them. Far from the
 * outline the plain distances of the texels say which side a point is on; near it the distance is computed. */
#include <math.h>
#include <string.h>

#include "atlas/glyph.h"
#include "base/alloc.h"
#include "base/error.h"

enum { FINE = 8, MOST_ROUNDS = 16 };

/* In texels: how far an outline may be off; and how near to the middle of the range nothing shall come that is DEEP
 * from the outline, lest it be seen where edges are made smooth. */
#define SLACK 0.08
#define NEAR 0.04
#define DEEP 0.75

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
        if (texel[0] != texel[3] || texel[1] != texel[3] || texel[2] != texel[3])
            return true;
    }
    return false;
}

static bool is_off(double shown, double true_distance)
{
    double depth = fabs(true_distance);
    return true_distance >= 0 ? (shown < 0 && depth > SLACK) || (shown < NEAR && depth > DEEP)
                              : (shown >= 0 && depth > SLACK) || (shown > -NEAR && depth > DEEP);
}

/* Whether two of the three distances have the plain one's side at all four texels: then they have it between them too,
 * and so does the middle one. */
static bool is_sure(const square *own)
{
    int sure = 0;
    for (int k = 0; k < 3; k++) {
        bool alike = true;
        for (int i = 0; i < 4; i++)
            alike = alike && (own->shown[k][i] >= 0) == (own->shown[3][0] >= 0);
        sure += alike;
    }
    return sure >= 2;
}

/* Only where the middle one and the plain one disagree it matters who is right. */
static bool is_wrong(const hewn_shape *shape, const hewn_drawn *drawn, const square *own, uint32_t x, uint32_t y)
{
    double least = INFINITY, first = drawn->distances[own->at[0]];
    bool alike = true;
    for (int i = 0; i < 4; i++) {
        least = fmin(least, fabs(drawn->distances[own->at[i]]));
        alike = alike && (drawn->distances[own->at[i]] >= 0) == (first >= 0);
    }
    bool far = alike && least > 0.75; /* no point of a square is farther from its corners */
    if (alike && is_sure(own))
        return false;
    for (int i = 0; i < FINE * FINE; i++) {
        double u = (i % FINE + 0.5) / FINE, v = (i / FINE + 0.5) / FINE;
        double shown =
            middle_of_three(between(own->shown[0], u, v), between(own->shown[1], u, v), between(own->shown[2], u, v));
        double plain = between(own->shown[3], u, v);
        if ((shown >= 0) == (plain >= 0) && (fabs(shown) >= NEAR || fabs(plain) < 0.5))
            continue;
        if (far && is_off(shown, first))
            return true;
        if (far)
            continue;
        const double p[2] = {x + 0.5 + u, drawn->height - y - 0.5 - v};
        double true_distance = hewn_shape_distance(shape, p, fabs(first) + 1.5);
        if (is_off(shown, true_distance))
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

uint8_t hewn_texel_middle(const uint8_t texel[4])
{
    uint8_t low = texel[0] < texel[1] ? texel[0] : texel[1], high = texel[0] < texel[1] ? texel[1] : texel[0];
    return texel[2] < low ? low : texel[2] > high ? high : texel[2];
}

static void soften(uint8_t texel[4], bool gently)
{
    bool coloured = texel[0] != texel[1] || texel[1] != texel[2];
    memset(texel, gently && coloured ? hewn_texel_middle(texel) : texel[3], 3);
}

hewn_result hewn_drawn_soften(const hewn_shape *shape, hewn_drawn *drawn, bool gently, size_t *count, hewn_error *error)
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
            *count += changed[i] && (texel[0] != texel[1] || texel[1] != texel[2]);
            if (changed[i])
                soften(texel, gently);
            marked[i] = 0;
        }
    }
    hewn_free(changed);
    hewn_free(marked);
    return HEWN_OK;
}
