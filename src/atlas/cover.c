/* What letters cover at four times the resolution of their texels, and what is drawn of it. */
#include <math.h>

#include "atlas/glyph.h"
#include "base/alloc.h"
#include "base/error.h"

enum { PARTS = 4 };

/* Of a pixel 1 / PARTS texels wide whose middle is so far inside, as edges are made smooth. */
static double coverage(double distance)
{
    return fmin(fmax(PARTS * distance + 0.5, 0), 1);
}

hewn_result hewn_shape_cover(const hewn_shape *shape, uint32_t width, uint32_t height, hewn_covered *out,
                             hewn_error *error)
{
    *out = (hewn_covered){.width = PARTS * (width - 1), .height = PARTS * (height - 1)};
    out->shares = hewn_alloc((size_t)out->width * out->height, sizeof *out->shares);
    if (!out->shares)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a letter");
    for (uint32_t y = 0; y < out->height; y++)
        for (uint32_t x = 0; x < out->width; x++) {
            const double p[2] = {0.5 + (x + 0.5) / PARTS, 0.5 + (y + 0.5) / PARTS};
            out->shares[x + (size_t)out->width * y] = (float)coverage(hewn_shape_distance(shape, p, 0.5));
        }
    return HEWN_OK;
}

/* One of a texel's three at a point between four of them, x and y being their shares. */
static double channel(const hewn_drawn *drawn, size_t at, int k, double x, double y)
{
    const uint8_t(*t)[4] = (const uint8_t(*)[4])drawn->texels;
    double upper = t[at][k] + x * (t[at + 1][k] - t[at][k]);
    double lower = t[at + drawn->width][k] + x * (t[at + drawn->width + 1][k] - t[at + drawn->width][k]);
    return upper + y * (lower - upper);
}

double hewn_drawn_wrong(const hewn_drawn *drawn, const hewn_covered *covered)
{
    double sum = 0;
    for (uint32_t y = 0; y < covered->height; y++)
        for (uint32_t x = 0; x < covered->width; x++) {
            uint32_t row = covered->height - 1 - y; /* the highest first */
            size_t at = x / PARTS + (size_t)drawn->width * (row / PARTS);
            double u = (x % PARTS + 0.5) / PARTS, v = (row % PARTS + 0.5) / PARTS, c[3];
            for (int k = 0; k < 3; k++)
                c[k] = channel(drawn, at, k, u, v);
            double middle = fmax(fmin(c[0], c[1]), fmin(fmax(c[0], c[1]), c[2]));
            double shown = (middle / 255 - 0.5) * drawn->range;
            sum += fabs(coverage(shown) - (double)covered->shares[x + (size_t)covered->width * y]);
        }
    return sum / (PARTS * PARTS);
}
