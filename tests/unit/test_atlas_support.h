/* What tests of atlases share: outlines as FreeType alone tells them, and looking into an atlas as a shader does. */
#ifndef HEWN_TESTS_UNIT_TEST_ATLAS_SUPPORT_H
#define HEWN_TESTS_UNIT_TEST_ATLAS_SUPPORT_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "font/font.h"
#include "hewn/atlas.h"

#include FT_OUTLINE_H

enum { TRACK_MOST = 20000, TRACK_PARTS = 24 };

/* An outline as points that lie close, in ems, whatever the code makes of it. */
typedef struct track {
    double points[TRACK_MOST][2];
    bool begins[TRACK_MOST], corner[TRACK_MOST];
    size_t count;
    double unit;
} track;

static inline void track_note(track *own, double x, double y, bool begins, bool end)
{
    assert_true(own->count < TRACK_MOST);
    own->points[own->count][0] = x * own->unit;
    own->points[own->count][1] = y * own->unit;
    own->corner[own->count] = end;
    own->begins[own->count++] = begins;
}

static inline int track_move(const FT_Vector *to, void *user)
{
    track_note(user, (double)to->x, (double)to->y, true, true);
    return 0;
}

static inline int track_line(const FT_Vector *to, void *user)
{
    track_note(user, (double)to->x, (double)to->y, false, true);
    return 0;
}

static inline int track_cubic(const FT_Vector *b, const FT_Vector *c, const FT_Vector *to, void *user)
{
    track *own = user;
    double a[2] = {own->points[own->count - 1][0] / own->unit, own->points[own->count - 1][1] / own->unit};
    for (int i = 1; i <= TRACK_PARTS; i++) {
        double t = (double)i / TRACK_PARTS, s = 1 - t;
        double w[4] = {s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t};
        track_note(own, w[0] * a[0] + w[1] * (double)b->x + w[2] * (double)c->x + w[3] * (double)to->x,
                   w[0] * a[1] + w[1] * (double)b->y + w[2] * (double)c->y + w[3] * (double)to->y, false,
                   i == TRACK_PARTS);
    }
    return 0;
}

static inline int track_conic(const FT_Vector *b, const FT_Vector *to, void *user)
{
    track *own = user;
    double a[2] = {own->points[own->count - 1][0] / own->unit, own->points[own->count - 1][1] / own->unit};
    for (int i = 1; i <= TRACK_PARTS; i++) {
        double t = (double)i / TRACK_PARTS, s = 1 - t;
        track_note(own, s * s * a[0] + 2 * s * t * (double)b->x + t * t * (double)to->x,
                   s * s * a[1] + 2 * s * t * (double)b->y + t * t * (double)to->y, false, i == TRACK_PARTS);
    }
    return 0;
}

static inline size_t track_end(const track *own, size_t first)
{
    while (first + 1 < own->count && !own->begins[first + 1])
        first++;
    return first;
}

/* Flags are left where the outline turns by more than 5 degrees. */
static inline void track_find_corners(track *own)
{
    for (size_t first = 0; first < own->count;) {
        size_t last = track_end(own, first), count = last - first + 1;
        for (size_t i = 0; i < count; i++) {
            const double *p = own->points[first + i];
            double in[2] = {0, 0}, out[2] = {0, 0};
            for (size_t k = 1; k < count && in[0] == 0 && in[1] == 0; k++)
                for (int axis = 0; axis < 2; axis++)
                    in[axis] = p[axis] - own->points[first + (i + count - k) % count][axis];
            for (size_t k = 1; k < count && out[0] == 0 && out[1] == 0; k++)
                for (int axis = 0; axis < 2; axis++)
                    out[axis] = own->points[first + (i + k) % count][axis] - p[axis];
            double turn = atan2(fabs(in[0] * out[1] - in[1] * out[0]), in[0] * out[0] + in[1] * out[1]);
            own->corner[first + i] = own->corner[first + i] && turn > 0.09;
        }
        first = last + 1;
    }
}

static inline void track_read(track *own, hewn_font *font, uint32_t character)
{
    static const FT_Outline_Funcs calls = {
        .move_to = track_move, .line_to = track_line, .conic_to = track_conic, .cubic_to = track_cubic};
    own->count = 0;
    own->unit = 1 / font->units;
    assert_int_equal(FT_Load_Char(font->face, character, FT_LOAD_NO_SCALE), 0);
    assert_int_equal(FT_Outline_Decompose(&font->face->glyph->outline, &calls, own), 0);
    track_find_corners(own);
}

/* Distance (above 0 inside, by the nonzero rule) and how far the nearest corner is, by looking at each piece. */
static inline double track_distance(const track *own, const double p[2], double *to_corner)
{
    double least = INFINITY, turns = 0;
    *to_corner = INFINITY;
    for (size_t first = 0; first < own->count;) {
        size_t last = track_end(own, first);
        for (size_t i = first; i <= last; i++) {
            const double *a = own->points[i], *b = own->points[i == last ? first : i + 1];
            double ax = a[0] - p[0], ay = a[1] - p[1], bx = b[0] - p[0], by = b[1] - p[1], ex = bx - ax, ey = by - ay;
            double length = ex * ex + ey * ey, t = length > 0 ? fmin(fmax(-(ax * ex + ay * ey) / length, 0), 1) : 0;
            least = fmin(least, hypot(ax + t * ex, ay + t * ey));
            if (own->corner[i])
                *to_corner = fmin(*to_corner, hypot(ax, ay));
            if ((ay <= 0) != (by <= 0)) { /* crossings of the ray to the right */
                double cross = ax * by - ay * bx;
                turns += ay <= 0 ? (cross > 0 ? 1 : 0) : (cross < 0 ? -1 : 0);
            }
        }
        first = last + 1;
    }
    return turns != 0 ? least : -least;
}

/* --- looking into an atlas -----------------------------------------------------------------------------------------
 */

static inline const hewn_atlas_glyph *atlas_glyph(const hewn_atlas *atlas, uint32_t character)
{
    for (size_t i = 0; i < atlas->glyph_count; i++)
        if (atlas->glyphs[i].character == character)
            return &atlas->glyphs[i];
    return NULL;
}

/* One channel, interpolated between texels, at a point of the letter's plane in ems; 0 to 1. */
static inline double atlas_channel(const hewn_atlas *atlas, const hewn_atlas_glyph *glyph, uint32_t channel,
                                   const double p[2])
{
    double u = (p[0] - glyph->plane[0]) / (glyph->plane[2] - glyph->plane[0]) * (glyph->width - 1);
    double v = (glyph->plane[3] - p[1]) / (glyph->plane[3] - glyph->plane[1]) * (glyph->height - 1);
    double x = floor(fmin(fmax(u, 0), glyph->width - 2)), y = floor(fmin(fmax(v, 0), glyph->height - 2)), sum = 0;
    for (int i = 0; i < 4; i++) {
        size_t column = glyph->x + (size_t)x + (size_t)(i % 2), row = glyph->y + (size_t)y + (size_t)(i / 2);
        double share = (i % 2 ? u - x : 1 - u + x) * (i / 2 ? v - y : 1 - v + y);
        sum += share * atlas->texels[(row * atlas->width + column) * atlas->channels + channel] / 255.0;
    }
    return sum;
}

/* What a shader takes for the distance, in texels: of three the middle one. */
static inline double atlas_distance(const hewn_atlas *atlas, const hewn_atlas_glyph *glyph, const double p[2])
{
    double value = atlas_channel(atlas, glyph, 0, p);
    if (atlas->channels >= 3) {
        double b = atlas_channel(atlas, glyph, 1, p), c = atlas_channel(atlas, glyph, 2, p);
        value = fmax(fmin(value, b), fmin(fmax(value, b), c));
    }
    return (value - 0.5) * atlas->range;
}

static inline uint64_t atlas_random(uint64_t *state)
{
    *state += 0x9E3779B97F4A7C15u; /* splitmix64 */
    uint64_t z = *state;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
}

static inline double atlas_share(uint64_t *state) /* 0 to 1 */
{
    return (double)(atlas_random(state) >> 11) * 0x1p-53;
}

#endif
