/* Values, derivatives and bounds of samplings in double. */
#include <math.h>

#include "field/interval.h"
#include "field/sampling.h"

enum { BRICK = HEWN_SAMPLING_BRICK, SIDE = HEWN_SAMPLING_SIDE };

/* The cell that a point is in, or, past the lattice, the nearest point of it. */
typedef struct place {
    const float *samples; /* of the cell's first corner */
    size_t row, layer;
    double t[3], scale; /* where in the cell, which is 1 / scale cells long */
    double beyond[3];   /* what is left of the point past the lattice */
} place;

static place find(const hewn_sampling *s, const double at[3])
{
    place out = {.scale = 1};
    uint32_t cell[3], brick[3];
    double inside[3];
    for (int i = 0; i < 3; i++) {
        double u = (isnan(at[i]) ? 0 : at[i]) + 0.5 * s->cells[i];
        inside[i] = u < 0 ? 0 : u > s->cells[i] ? s->cells[i] : u;
        out.beyond[i] = u - inside[i];
        cell[i] = (uint32_t)inside[i];
        cell[i] -= cell[i] == s->cells[i] && cell[i] > 0;
        brick[i] = cell[i] / BRICK;
    }
    bool flat = s->cells[2] == 0;
    const float *fine =
        hewn_sampling_brick(s, brick[0] + (uint64_t)s->bricks[0] * (brick[1] + (uint64_t)s->bricks[1] * brick[2]));
    uint32_t from[3];
    out.row = fine ? SIDE : s->bricks[0] + 1;
    out.layer = flat ? 0 : fine ? SIDE * SIDE : out.row * (s->bricks[1] + 1);
    for (int i = 0; i < 3; i++) {
        from[i] = fine ? cell[i] - BRICK * brick[i] : brick[i];
        out.t[i] = fine ? inside[i] - cell[i] : (inside[i] - BRICK * brick[i]) / BRICK;
    }
    out.scale = fine ? 1 : 1.0 / BRICK;
    out.samples = (fine ? fine : hewn_sampling_corners(s)) + from[0] + out.row * from[1] + out.layer * from[2];
    return out;
}

static double mix(double a, double b, double t)
{
    return a + t * (b - a);
}

/* Trilinear, with derivatives after t. */
static double between(const place *p, double slopes[3])
{
    const float *v = p->samples;
    double edge[4], rise[4];
    for (int i = 0; i < 4; i++) {
        const float *from = v + (i & 1 ? p->row : 0) + (i & 2 ? p->layer : 0);
        edge[i] = mix((double)from[0], (double)from[1], p->t[0]);
        rise[i] = (double)from[1] - (double)from[0];
    }
    double low = mix(edge[0], edge[1], p->t[1]), high = mix(edge[2], edge[3], p->t[1]);
    slopes[0] = mix(mix(rise[0], rise[1], p->t[1]), mix(rise[2], rise[3], p->t[1]), p->t[2]);
    slopes[1] = mix(edge[1] - edge[0], edge[3] - edge[2], p->t[2]);
    slopes[2] = high - low;
    return mix(low, high, p->t[2]);
}

/* Past the lattice a point is farther from what lies in it than by a right angle at the nearest point of the box, which
 * is convex: |p - s|² >= |p - q|² + |q - s|². */
double hewn_sampling_value(const hewn_sampling *s, const double at[3], double slopes[3])
{
    place p = find(s, at);
    double d[3], value = between(&p, d), beyond = 0;
    for (int i = 0; i < 3; i++) {
        d[i] *= p.scale;
        d[i] = p.beyond[i] != 0 || (i == 2 && s->cells[2] == 0) ? 0 : d[i];
        beyond += p.beyond[i] * p.beyond[i];
    }
    bool past = beyond > 0 && !s->endless;
    double length = past ? sqrt(beyond + value * value) : value;
    for (int i = 0; slopes && i < 3; i++)
        slopes[i] = past ? (p.beyond[i] + value * d[i]) / length : d[i];
    return isnan(at[0]) || isnan(at[1]) || isnan(at[2]) ? (double)NAN : length;
}

/* --- bounds ------------------------------------------------------------------------------------------------------ */

typedef struct extent {
    float least, greatest, steepest;
} extent;

/* Of the entry that holds a box of cells. */
static extent extent_of(const hewn_sampling *s, const uint32_t from[3], const uint32_t to[3])
{
    uint32_t longest = 0, level = 0, size = 0;
    for (int i = 0; i < 3; i++)
        longest = to[i] / BRICK - from[i] / BRICK > longest ? to[i] / BRICK - from[i] / BRICK : longest;
    if (longest > 0)
        level = 1;
    for (; 1u << size < longest; size++)
        level++;
    uint64_t number = 0;
    for (int i = 2; i >= 0; i--)
        number = number * hewn_sampling_entries(s, i, level) + (from[i] / BRICK >> size);
    const float *entry = (const float *)(const void *)(s->words + s->words[level]) + 3 * number;
    return (extent){entry[0], entry[1], entry[2]};
}

/* What the least and the greatest sample say. `gap` is how far past the lattice the box begins and ends. */
static hewn_interval by_extent(const extent *all, const double gap[2])
{
    double low = (double)all->least, high = (double)all->greatest;
    double away = low > 0 ? low : 0, farthest = high > 0 ? high : 0;
    if (gap[0] > 0)
        low = sqrt(gap[0] * gap[0] + away * away);
    if (gap[1] > 0)
        high = sqrt(gap[1] * gap[1] + farthest * farthest);
    return (hewn_interval){low, high, false};
}

/* Of the entry that holds a box of places, as far as they are on the lattice. */
static extent extent_at(const hewn_sampling *s, const hewn_interval in[3])
{
    uint32_t from[3], to[3];
    for (int i = 0; i < 3; i++) {
        double half = 0.5 * s->cells[i], room = 0x1p-40 * (1 + half);
        double low = fmin(fmax(in[i].lo + half - room, 0), s->cells[i]);
        double high = fmin(fmax(in[i].hi + half + room, 0), s->cells[i]);
        from[i] = (uint32_t)low;
        to[i] = (uint32_t)high;
        from[i] -= from[i] == s->cells[i] && from[i] > 0;
        to[i] -= to[i] == s->cells[i] && to[i] > 0;
    }
    return extent_of(s, from, to);
}

/* Past its lattice a sampling goes on as a distance from that. */
double hewn_sampling_steepest(const hewn_sampling *s, const hewn_interval in[3])
{
    double between = (double)s->steepest;
    if (!in[0].maybe_nan && !in[1].maybe_nan && !in[2].maybe_nan)
        between = (double)extent_at(s, in).steepest;
    return s->endless ? between : fmax(1, between);
}

hewn_interval hewn_sampling_bound(const hewn_sampling *s, const hewn_interval in[3])
{
    extent all = extent_at(s, in);
    double middle[3], reach = 0, far = 0, near_gap = 0, far_gap = 0;
    bool nan = in[0].maybe_nan || in[1].maybe_nan || in[2].maybe_nan;
    for (int i = 0; i < 3; i++) {
        double half = 0.5 * s->cells[i];
        double side = 0.5 * in[i].hi - 0.5 * in[i].lo;
        middle[i] = 0.5 * in[i].lo + 0.5 * in[i].hi;
        bool counts = s->cells[i] > 0;
        reach += counts ? side * side : 0;
        far += counts ? fmax(fabs(in[i].lo), fabs(in[i].hi)) + half : 0;
        double begins = fmax(fmax(in[i].lo - half, -half - in[i].hi), 0);
        double ends = fmax(fmax(-half - in[i].lo, in[i].hi - half), 0);
        near_gap += s->endless ? 0 : begins * begins;
        far_gap += s->endless ? 0 : ends * ends;
    }
    hewn_interval out = by_extent(&all, (const double[2]){sqrt(near_gap), sqrt(far_gap)});
    double size = fmax(fabs(out.lo), fabs(out.hi));
    double error = 0x1p-44 * (fmin(size, 0x1p1000) + (1 + (double)all.steepest) * (1 + fmin(far, 0x1p1000)));
    double slope = s->endless ? (double)all.steepest : fmax(1, (double)all.steepest);
    double room = slope * sqrt(reach);
    if (isfinite(room) && isfinite(error)) {
        double value = hewn_sampling_value(s, middle, NULL);
        out.lo = fmax(out.lo, value - room);
        out.hi = fmin(out.hi, value + room);
    }
    return (hewn_interval){hewn_lower(out.lo, error), hewn_upper(out.hi, error), nan};
}
