#include "subdivide/points.h"

#include <math.h>
#include <string.h>

#include "subdivide/sharp.h"

/* One pass under way. Functions take `width` as a parameter of their own, so that those for three are compiled for it.
 */
typedef struct pass {
    const sub_level *level;
    sub_masks masks;
    const double *in;
    double *out;
} pass;

static inline void add(double *to, const double *value, double weight, uint32_t width)
{
    for (uint32_t i = 0; i < width; i++)
        to[i] += weight * value[i];
}

static inline const double *at(const double *values, uint32_t index, uint32_t width)
{
    return values + (size_t)index * width;
}

/* --- faces -------------------------------------------------------------------------------------------------------- */

static inline void face_points(const pass *now, uint32_t width)
{
    const sub_level *level = now->level;
    double *out = now->out + ((size_t)level->verts + level->edges) * width;
#pragma omp parallel for schedule(static)
    for (uint32_t f = 0; f < level->faces; f++) {
        uint32_t begin = sub_face_begin(level, f), end = sub_face_begin(level, f + 1);
        double *to = out + (size_t)f * width, share = 1.0 / (end - begin);
        for (uint32_t i = 0; i < width; i++)
            to[i] = 0;
        for (uint32_t c = begin; c < end; c++)
            add(to, at(now->in, level->corner_verts[c], width), 1, width);
        for (uint32_t i = 0; i < width; i++)
            to[i] *= share;
    }
}

/* --- edges -------------------------------------------------------------------------------------------------------- */

/* What stands across an edge: its two face points, or the opposite corners of its two triangles. */
static inline const double *across(const pass *now, uint32_t corner, uint32_t width)
{
    const sub_level *level = now->level;
    if (now->masks.scheme == HEWN_SCHEME_LOOP)
        return at(now->in, level->corner_verts[sub_prev(level, corner)], width);
    return at(now->out, level->verts + level->edges + sub_face_of(level, corner), width);
}

static inline void edge_points(const pass *now, uint32_t width)
{
    const sub_level *level = now->level;
    double ends = now->masks.scheme == HEWN_SCHEME_LOOP ? 0.375 : 0.25;
    bool linear = now->masks.linear;
#pragma omp parallel for schedule(static)
    for (uint32_t e = 0; e < level->edges; e++) {
        const uint32_t *corner = level->edge_corners + 2 * (size_t)e;
        const double *a = at(now->in, level->edge_verts[2 * (size_t)e], width);
        const double *b = at(now->in, level->edge_verts[2 * (size_t)e + 1], width);
        double *to = now->out + ((size_t)level->verts + e) * width;
        double middle = linear ? 1 : level->edge_sharp ? hewn_sub_edge_share(level, e, now->masks.creasing) : 0;
        if (middle == 1) {
            for (uint32_t i = 0; i < width; i++)
                to[i] = 0.5 * (a[i] + b[i]);
            continue;
        }
        const double *c = across(now, corner[0], width), *d = across(now, corner[1], width);
        for (uint32_t i = 0; i < width; i++) {
            double smooth = ends * (a[i] + b[i]) + (0.5 - ends) * (c[i] + d[i]);
            to[i] = middle > 0 ? middle * 0.5 * (a[i] + b[i]) + (1 - middle) * smooth : smooth;
        }
    }
}

/* --- vertices ----------------------------------------------------------------------------------------------------- */

/* Loop's weight of each neighbour. */
static double loop_weight(uint32_t valence)
{
    if (valence == 6)
        return 0.0625;
    double cosine = 0.375 + 0.25 * cos(2 * M_PI / valence);
    return (0.625 - cosine * cosine) / valence;
}

/* Adds `share` times the smooth rule. Of a vertex without boundary, each face around it lies beside two of its edges.
 */
static inline void add_smooth(const pass *now, uint32_t v, double share, double *to, uint32_t width)
{
    const sub_level *level = now->level;
    uint32_t begin = level->vert_first[v], n = level->vert_first[v + 1] - begin;
    bool loop = now->masks.scheme == HEWN_SCHEME_LOOP;
    double edge = loop ? loop_weight(n) : 1.0 / n / n;
    add(to, at(now->in, v, width), share * (loop ? 1 - n * edge : 1 - 2.0 / n), width);
    for (uint32_t i = begin; i < begin + n; i++) {
        uint32_t e = level->vert_edges[i];
        add(to, at(now->in, sub_other(level, e, v), width), share * edge, width);
        if (loop)
            continue;
        const uint32_t *corner = level->edge_corners + 2 * (size_t)e;
        uint32_t left = level->edge_verts[2 * (size_t)e] == v ? corner[0] : corner[1];
        add(to, across(now, left, width), share * edge, width);
    }
}

static inline void add_rule(const pass *now, uint32_t v, sub_rule rule, const uint32_t ends[2], double share,
                            double *to, uint32_t width)
{
    if (rule == SUB_SMOOTH || rule == SUB_DART) {
        add_smooth(now, v, share, to, width);
        return;
    }
    add(to, at(now->in, v, width), rule == SUB_CORNER ? share : 0.75 * share, width);
    for (int k = 0; k < 2 && rule == SUB_CREASE; k++)
        add(to, at(now->in, ends[k], width), 0.125 * share, width);
}

static inline void vert_points(const pass *now, uint32_t width)
{
    const sub_level *level = now->level;
    bool linear = now->masks.linear;
#pragma omp parallel for schedule(static)
    for (uint32_t v = 0; v < level->verts; v++) {
        double *to = now->out + (size_t)v * width;
        bool stays = linear || level->vert_first[v] == level->vert_first[v + 1];
        for (uint32_t i = 0; i < width; i++)
            to[i] = stays ? now->in[(size_t)v * width + i] : 0;
        if (stays)
            continue;
        if (!level->edge_sharp) {
            add_smooth(now, v, 1, to, width);
            continue;
        }
        sub_vert_rule rule = hewn_sub_rule_of(level, v, now->masks.creasing);
        add_rule(now, v, rule.rule, rule.ends, rule.share, to, width);
        if (rule.share < 1)
            add_rule(now, v, rule.child, rule.child_ends, 1 - rule.share, to, width);
    }
}

static inline void all_points(const pass *now, uint32_t width)
{
    if (now->masks.scheme != HEWN_SCHEME_LOOP)
        face_points(now, width);
    edge_points(now, width);
    vert_points(now, width);
}

void hewn_sub_points(const sub_level *level, sub_masks masks, const double *in, uint32_t width, double *out)
{
    pass now = {level, masks, in, out};
    if (width == 3)
        all_points(&now, 3);
    else if (width == 2)
        all_points(&now, 2);
    else
        all_points(&now, width);
}

/* --- limits ------------------------------------------------------------------------------------------------------- */

/* The corner of the quadrilateral left of an edge that leaves v, across from v. */
static inline uint32_t diagonal(const sub_level *level, uint32_t edge, uint32_t v)
{
    uint32_t corner = level->edge_corners[2 * (size_t)edge + (level->edge_verts[2 * (size_t)edge] != v)];
    return level->corner_verts[(corner & ~3u) | ((corner + 2) & 3u)];
}

static void add_smooth_limit(const pass *now, uint32_t v, double *to, uint32_t width)
{
    const sub_level *level = now->level;
    uint32_t begin = level->vert_first[v], n = level->vert_first[v + 1] - begin;
    bool loop = now->masks.scheme == HEWN_SCHEME_LOOP;
    double edge = loop ? 1 / (n + 0.375 / loop_weight(n)) : 4.0 / (n * (n + 5.0));
    double face = loop ? 0 : edge / 4;
    add(to, at(now->in, v, width), 1 - n * (edge + face), width);
    for (uint32_t i = begin; i < begin + n; i++) {
        uint32_t e = level->vert_edges[i];
        add(to, at(now->in, sub_other(level, e, v), width), edge, width);
        if (!loop)
            add(to, at(now->in, diagonal(level, e, v), width), face, width);
    }
}

static void limit_of(const pass *now, uint32_t v, double *to, uint32_t width)
{
    const sub_level *level = now->level;
    sub_vert_rule rule = {.rule = SUB_SMOOTH};
    bool stays = now->masks.linear || level->vert_first[v] == level->vert_first[v + 1];
    if (level->edge_sharp && !stays)
        rule = hewn_sub_rule_of(level, v, now->masks.creasing);
    stays = stays || rule.rule == SUB_CORNER;
    for (uint32_t i = 0; i < width; i++)
        to[i] = stays ? now->in[(size_t)v * width + i] : 0;
    if (stays)
        return;
    if (rule.rule != SUB_CREASE) {
        add_smooth_limit(now, v, to, width);
        return;
    }
    add(to, at(now->in, v, width), 2.0 / 3, width);
    for (int k = 0; k < 2; k++)
        add(to, at(now->in, rule.ends[k], width), 1.0 / 6, width);
}

void hewn_sub_limits(const sub_level *level, sub_masks masks, const double *in, uint32_t width, double *out)
{
    pass now = {level, masks, in, out};
#pragma omp parallel for schedule(static)
    for (uint32_t v = 0; v < level->verts; v++)
        limit_of(&now, v, out + (size_t)v * width, width);
}
