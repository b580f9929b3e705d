/* Tangents of the limit surface: left eigenvectors of the subdivision matrix around a vertex, for the two subdominant
 * eigenvalues (Hoppe and others 1994; DeRose, Kass and Truong 1998; Biermann, Levin and Zorin 2000). */
#include <math.h>

#include "subdivide/points.h"
#include "subdivide/sharp.h"

typedef struct star {
    const sub_level *level;
    const double *in;
    uint32_t v, begin, count; /* its ring */
    bool closed;
} star;

static const double *position(const star *at, uint32_t v)
{
    return at->in + 3 * (size_t)v;
}

static uint32_t ring_edge(const star *at, uint32_t i)
{
    return at->level->vert_edges[at->begin + i % at->count];
}

static const double *neighbour(const star *at, uint32_t i)
{
    return position(at, sub_other(at->level, ring_edge(at, i), at->v));
}

/* The far corner of the quadrilateral between edges i and i + 1. */
static const double *far_corner(const star *at, uint32_t i)
{
    const sub_level *level = at->level;
    uint32_t e = ring_edge(at, i);
    uint32_t corner = level->edge_corners[2 * (size_t)e + (level->edge_verts[2 * (size_t)e] != at->v)];
    return position(at, level->corner_verts[(corner & ~3u) | ((corner + 2) & 3u)]);
}

static void add(double *to, const double *from, double weight)
{
    for (int i = 0; i < 3; i++)
        to[i] += weight * from[i];
}

static void smooth_tangents(const star *at, bool loop, double t[2][3])
{
    double turn = 2 * M_PI / at->count, c = cos(turn);
    double edge = loop ? 1 : 1 + c + cos(turn / 2) * sqrt(2 * (9 + c));
    for (uint32_t i = 0; i < at->count; i++) {
        double a = i * turn, b = (i + 1) * turn;
        add(t[0], neighbour(at, i), edge * cos(a));
        add(t[1], neighbour(at, i), edge * sin(a));
        if (loop)
            continue;
        add(t[0], far_corner(at, i), cos(a) + cos(b));
        add(t[1], far_corner(at, i), sin(a) + sin(b));
    }
}

/* Across a crease, over the k faces from ring edge `from` on. Rows of the edges between are those of a closed ring, and
 * what is left of the eigenvector's equations gives the weights of the vertex and of the crease's ends. */
static void cross_quads(const star *at, uint32_t from, uint32_t k, double t[3])
{
    double theta = M_PI / k, c = cos(theta), r = (c + 1) / sin(theta);
    add(t, position(at, at->v), 4 * r * (c - 1));
    add(t, neighbour(at, from), -r * (1 + 2 * c));
    add(t, neighbour(at, from + k), -r * (1 + 2 * c));
    for (uint32_t i = 0; i < k; i++) {
        if (i > 0)
            add(t, neighbour(at, from + i), 4 * sin(i * theta));
        add(t, far_corner(at, from + i), sin(i * theta) + sin((i + 1) * theta));
    }
}

static void cross_triangles(const star *at, uint32_t from, uint32_t k, double t[3])
{
    double theta = M_PI / k, c = cos(theta), s = sin(theta), sum = 0;
    for (uint32_t i = 1; i < k; i++) {
        sum += sin(i * theta);
        add(t, neighbour(at, from + i), sin(i * theta));
    }
    double value = 0.375 + 0.25 * c, d = 2 * c - 1, middle = -s, end;
    if (fabs(d) > 1e-6) {
        middle = (s / d + 0.375 * sum) / (value - 0.75 - 1 / d);
        end = (s + middle) / d;
    } else {
        end = (value - 0.75) * middle - 0.375 * sum;
    }
    add(t, position(at, at->v), middle);
    add(t, neighbour(at, from), end);
    add(t, neighbour(at, from + k), end);
}

/* With one face both rules fall together: along the bisector. */
static void crease_tangents(const star *at, bool loop, uint32_t from, uint32_t k, double t[2][3])
{
    add(t[0], neighbour(at, from), 0.5);
    add(t[0], neighbour(at, from + k), -0.5);
    if (k == 1) {
        add(t[1], neighbour(at, from), 1);
        add(t[1], neighbour(at, from + k), 1);
        add(t[1], position(at, at->v), -2);
    } else if (loop) {
        cross_triangles(at, from, k, t[1]);
    } else {
        cross_quads(at, from, k, t[1]);
    }
}

static void corner_tangents(const star *at, uint32_t from, uint32_t to, double t[2][3])
{
    add(t[0], neighbour(at, from), 1);
    add(t[0], position(at, at->v), -1);
    add(t[1], neighbour(at, to), 1);
    add(t[1], position(at, at->v), -1);
}

void hewn_sub_tangents(const sub_level *level, sub_masks masks, const double *in, uint32_t v, double t[2][3])
{
    star at = {level, in, v, level->vert_first[v], level->vert_first[v + 1] - level->vert_first[v], true};
    bool loop = masks.scheme == HEWN_SCHEME_LOOP;
    sub_rule rule = masks.linear ? SUB_CORNER : SUB_SMOOTH;
    for (int i = 0; i < 6; i++)
        t[i / 3][i % 3] = 0;
    if (at.count < 2)
        return;
    at.closed = !sub_is_boundary(level, ring_edge(&at, 0));
    uint32_t ends[2] = {0, 1}, sharp = 0;
    for (uint32_t i = 0; level->edge_sharp && i < at.count; i++)
        if (level->edge_sharp[ring_edge(&at, i)] > 0 && sharp++ < 2)
            ends[sharp - 1] = i;
    if (level->edge_sharp && rule == SUB_SMOOTH)
        rule = hewn_sub_rule_of(level, v, masks.creasing).rule;
    if (rule == SUB_CORNER)
        corner_tangents(&at, sharp > 1 ? ends[0] : 0, sharp > 1 ? ends[1] : 1, t);
    else if (rule == SUB_CREASE)
        crease_tangents(&at, loop, ends[0], ends[1] - ends[0], t);
    else
        smooth_tangents(&at, loop, t);
}
