/* Noise over a lattice of cells of size 1: in double, with derivatives and bounds. What is random comes from integer
 * hashes of a cell's coordinates and a seed, so that it is the same everywhere; what is added up is sums and products
 * only. Value and gradient noise after Perlin (An Image Synthesizer, 1985; Improving Noise, 2002), simplex noise after
 * his skewed lattice (Noise Hardware, 2001), cellular noise after Worley (A Cellular Texture Basis Function, 1996). The
 * final mixing of the hash is Wellons' lowbias32. */
#include <math.h>
#include <string.h>

#include "field/internal.h"
#include "field/interval.h"
#include "field/operate.h"

/* Lattice cells farther out than this are those at the rim: floats have no fractions there. */
#define RIM 0x1p24

/* How steep each noise is at most along an axis: what corners of the worst signs give at the worst place. The gradients
 * of corners are the twelve directions to a cube's edges; their sums reach 1.037 (gradient) and 0.01301 (simplex). */
#define VALUE_SLOPE 3.75
#define GRADIENT_SLOPE 3.7
#define GRADIENT_SCALE 0.96
#define SIMPLEX_SLOPE 7.0
#define SIMPLEX_SCALE 76.0

typedef struct place {
    int32_t cell[3];
    double at[3]; /* in the cell, from 0 to 1 */
    uint32_t seed;
} place;

static double kept(double at)
{
    return isnan(at) ? 0 : fmin(fmax(at, -RIM), RIM);
}

static place place_of(const hewn_node_data *node, const double *in)
{
    place out = {.seed = (uint32_t)node->parameter[0]};
    for (int i = 0; i < 3; i++) {
        double at = kept(in[i]), whole = floor(at);
        out.cell[i] = (int32_t)whole;
        out.at[i] = at - whole;
    }
    return out;
}

static uint32_t hash(const int32_t *cell, int dx, int dy, int dz, uint32_t seed)
{
    uint32_t h = (uint32_t)(cell[0] + dx) * 0x9e3779b1u + (uint32_t)(cell[1] + dy) * 0x94d049bbu +
                 (uint32_t)(cell[2] + dz) * 0xd1b54a33u + seed * 0x7f4a7c15u;
    h ^= h >> 16;
    h *= 0x7feb352du;
    h ^= h >> 15;
    h *= 0x846ca68bu;
    return h ^ h >> 16;
}

/* --- corners of a cube ---------------------------------------------------------------------------------------------
 */

/* One of the twelve directions to the edges of a cube. */
static void direction(uint32_t h, double out[3])
{
    uint32_t flat = h % 3;
    double first = h >> 8 & 1 ? -1 : 1, second = h >> 9 & 1 ? -1 : 1;
    out[0] = flat == 0 ? 0 : first;
    out[1] = flat == 1 ? 0 : flat == 0 ? first : second;
    out[2] = flat == 2 ? 0 : second;
}

/* What a corner adds at the place: a value, and its own slopes there. */
static void corner(const hewn_node_data *node, const place *p, const int *off, double out[4])
{
    uint32_t h = hash(p->cell, off[0], off[1], off[2], p->seed);
    memset(out, 0, 4 * sizeof *out);
    if (node->op == HEWN_OP_NOISE_VALUE) {
        out[0] = (double)(h >> 8) * 0x1p-23 - 1;
        return;
    }
    direction(h, out + 1);
    for (int i = 0; i < 3; i++)
        out[0] += out[1 + i] * (p->at[i] - off[i]);
}

/* Between the eight corners by Perlin's quintic, which has flat second derivatives at cells' ends. */
static void between_corners(const hewn_node_data *node, const place *p, double out[4])
{
    double weight[3][2], slope[3][2];
    for (int i = 0; i < 3; i++) {
        double f = p->at[i];
        weight[i][1] = f * f * f * (f * (f * 6 - 15) + 10);
        weight[i][0] = 1 - weight[i][1];
        slope[i][1] = 30 * f * f * (f - 1) * (f - 1);
        slope[i][0] = -slope[i][1];
    }
    memset(out, 0, 4 * sizeof *out);
    for (int c = 0; c < 8; c++) {
        const int off[3] = {c & 1, c >> 1 & 1, c >> 2};
        double own[4];
        double w[3] = {weight[0][off[0]], weight[1][off[1]], weight[2][off[2]]};
        corner(node, p, off, own);
        out[0] += w[0] * w[1] * w[2] * own[0];
        for (int i = 0; i < 3; i++) {
            int j = (i + 1) % 3, k = (i + 2) % 3;
            out[1 + i] += slope[i][off[i]] * w[j] * w[k] * own[0] + w[0] * w[1] * w[2] * own[1 + i];
        }
    }
    for (int i = 0; i < 4 && node->op == HEWN_OP_NOISE_GRADIENT; i++)
        out[i] *= GRADIENT_SCALE;
}

/* --- simplex -------------------------------------------------------------------------------------------------------
 */

static void simplex(const hewn_node_data *node, const double *in, double out[4])
{
    double at[3] = {kept(in[0]), kept(in[1]), kept(in[2])};
    double skew = (at[0] + at[1] + at[2]) / 3, d[3];
    int32_t cell[3];
    int off[3] = {0, 0, 0};
    for (int i = 0; i < 3; i++)
        cell[i] = (int32_t)floor(at[i] + skew);
    for (int i = 0; i < 3; i++)
        d[i] = at[i] - cell[i] + ((double)cell[0] + cell[1] + cell[2]) / 6;
    /* From the cube's first corner to its last, along the largest coordinate first. */
    const int later[3] = {(d[1] > d[0]) + (d[2] > d[0]), (d[0] >= d[1]) + (d[2] > d[1]),
                          (d[0] >= d[2]) + (d[1] >= d[2])};
    memset(out, 0, 4 * sizeof *out);
    for (int c = 0; c < 4; c++) {
        double g[3], e[3], rest = 0.5, dot = 0;
        direction(hash(cell, off[0], off[1], off[2], (uint32_t)node->parameter[0]), g);
        for (int i = 0; i < 3; i++) {
            e[i] = d[i] - off[i] + c / 6.0;
            rest -= e[i] * e[i];
            dot += g[i] * e[i];
        }
        rest = fmax(rest, 0);
        double cube = rest * rest * rest;
        out[0] += SIMPLEX_SCALE * cube * rest * dot;
        for (int i = 0; i < 3; i++)
            out[1 + i] += SIMPLEX_SCALE * (cube * rest * g[i] - 8 * cube * dot * e[i]);
        for (int i = 0; i < 3; i++)
            off[i] = later[i] <= c;
    }
}

/* --- cellular ------------------------------------------------------------------------------------------------------
 */

/* The square of the distance to the nearest of one point a cell, at most 1: nearer ones are all in the cells around. */
static void cellular(const place *p, double out[4])
{
    memset(out, 0, 4 * sizeof *out);
    out[0] = 1;
    for (int c = 0; c < 27; c++) {
        const int off[3] = {c % 3 - 1, c / 3 % 3 - 1, c / 9 - 1};
        uint32_t h = hash(p->cell, off[0], off[1], off[2], p->seed);
        double d[3], square = 0;
        for (int i = 0; i < 3; i++) {
            d[i] = p->at[i] - off[i] - ((double)(h >> 10 * i & 1023u) + 0.5) / 1024;
            square += d[i] * d[i];
        }
        if (square < out[0]) {
            out[0] = square;
            for (int i = 0; i < 3; i++)
                out[1 + i] = 2 * d[i];
        }
    }
}

/* --- all -----------------------------------------------------------------------------------------------------------
 */

void hewn_noise_slopes(const hewn_node_data *node, const double in[3], double out[4])
{
    place p = place_of(node, in);
    switch (node->op) {
    case HEWN_OP_NOISE_SIMPLEX: simplex(node, in, out); break;
    case HEWN_OP_NOISE_CELLULAR: cellular(&p, out); break;
    default: between_corners(node, &p, out);
    }
    if (isnan(in[0]) || isnan(in[1]) || isnan(in[2]))
        out[0] = (double)NAN;
}

double hewn_noise_point(const hewn_node_data *node, const double in[3])
{
    double out[4];
    hewn_noise_slopes(node, in, out);
    return out[0];
}

/* Along all three axes at once; the cellular one is the square of a distance of at most 1. */
double hewn_op_noise_slope(hewn_op op)
{
    switch (op) {
    case HEWN_OP_NOISE_VALUE: return VALUE_SLOPE * sqrt(3) * (1 + 1e-12);
    case HEWN_OP_NOISE_GRADIENT: return GRADIENT_SLOPE * sqrt(3) * (1 + 1e-12);
    case HEWN_OP_NOISE_SIMPLEX: return SIMPLEX_SLOPE * sqrt(3) * (1 + 1e-12);
    case HEWN_OP_NOISE_CELLULAR: return 2;
    default: return INFINITY;
    }
}

/* About the value in the middle, from how steep the noise can be. */
hewn_interval hewn_noise_interval(const hewn_node_data *node, const hewn_interval in[3])
{
    double middle[3], half[3], sum = 0, far = 0;
    bool nan = in[0].maybe_nan || in[1].maybe_nan || in[2].maybe_nan;
    bool is_cellular = node->op == HEWN_OP_NOISE_CELLULAR;
    double lo = is_cellular ? 0 : -1;
    for (int i = 0; i < 3; i++) {
        middle[i] = 0.5 * kept(in[i].lo) + 0.5 * kept(in[i].hi);
        half[i] = (0.5 * kept(in[i].hi) - 0.5 * kept(in[i].lo)) * (1 + 0x1p-50);
        sum += half[i];
        far += fabs(middle[i]);
    }
    double value = hewn_noise_point(node, middle), error = 0x1p-44 * (1 + far);
    if (is_cellular) {
        double root = sqrt(value), reach = sqrt(half[0] * half[0] + half[1] * half[1] + half[2] * half[2]);
        double least = fmax(root - reach, 0), most = root + reach;
        return (hewn_interval){fmax(hewn_lower(least * least, error), lo), fmin(hewn_upper(most * most, error), 1),
                               nan};
    }
    double slope = node->op == HEWN_OP_NOISE_VALUE      ? VALUE_SLOPE
                   : node->op == HEWN_OP_NOISE_GRADIENT ? GRADIENT_SLOPE
                                                        : SIMPLEX_SLOPE;
    return (hewn_interval){fmax(hewn_lower(value - slope * sum, error), lo),
                           fmin(hewn_upper(value + slope * sum, error), 1), nan};
}
