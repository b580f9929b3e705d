/* Points of the input, each kept with a triangle of the simplified mesh that is near it: so what a collapse does to
 * the distance is known before it is done. As in Klein, Liebich and Strasser 1996, 'Mesh reduction with error
 * control', the distance to the triangles around stands for that to the whole surface, so it is never too small. */
#ifndef HEWN_SRC_SIMPLIFY_SAMPLES_H
#define HEWN_SRC_SIMPLIFY_SAMPLES_H

#include "geom/bvh.h"
#include "geom/facing.h"
#include "simplify/collapse.h"
#include "simplify/fan.h"

typedef struct simplify_sample {
    double at[3];    /* in coordinates of the work */
    float normal[3]; /* area vector of the input's triangles around; may be zero */
    float gap;       /* to the mesh: at most this */
    float weight;    /* of the area that it stands for; their mean is 1 */
    uint32_t next;   /* of the same triangle; HEWN_NONE */
} simplify_sample;

typedef struct simplify_samples {
    simplify_sample *items;
    uint32_t count;
    uint32_t *first;         /* one a triangle; HEWN_NONE */
    uint32_t *rings, *faces; /* the input's triangles around each sample: where they begin, with one more at the end */
    double *positions;       /* of the input's vertices, in coordinates of the work */
    hewn_bvh bvh;            /* of the input */
    hewn_facing facing;
    hewn_triangle_view input;
    double aim_factor;    /* the distance that is aimed at, in means by cost */
    double turned_factor; /* how much more a collapse costs that turns a triangle away from the input */
    bool strict;          /* collapses and moves look in all of the input for what triangles turn away from */
    double aim, price;    /* a collapse that comes to `aim` costs at least `price` */
} simplify_samples;

/* What the mesh would be around a collapse or a move, and where samples would be then. Zero is an empty one; its arrays
 * grow and are used again. */
typedef struct simplify_probe {
    simplify_fan fan;           /* triangles as they would be */
    simplify_fan_point *points; /* samples there */
    size_t point_count, point_capacity;
    struct probe_mark *marks; /* points of the mesh */
    simplify_mark_block *blocks;
    size_t mark_count, mark_capacity, block_capacity;
    uint32_t cleared[2]; /* triangles that would go; HEWN_NONE */
    double most;         /* the greatest distance that grew */
    double enough,
        plenty;   /* set before: distances below the one make no difference; past the other no more is looked at */
    bool refuses; /* set before: nothing past `plenty` will do, from the mesh to the input either */
    bool cut;     /* something is past `plenty`, or will not do: what else there is was not looked at */
    bool sums;   /* set before: `before` and `after` are wanted; else samples that make no difference are placed late */
    double gain; /* set before, with sums: will not do unless after < gain × before and nothing is turned; 0: it may */
    double back; /* of the new vertex to the input */
    double before, after; /* sums of squares of all distances, by weights, if they are wanted */
    bool turned;          /* a triangle would face away from what is near its middle, among samples */
    double place[3];      /* that of the fan */
} simplify_probe;
void hewn_simplify_probe_release(simplify_probe *probe);

/* One sample for each of the input's vertices, or for each so-many-th where there are many for `target` triangles.
 * `work` must be in order. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_simplify_samples_make(const simplify_work *work, const hewn_polygons *input, uint32_t target,
                                       simplify_samples *out, hewn_error *error);
void hewn_simplify_samples_release(simplify_samples *samples);

/* Samples of `work` that may move by themselves; all else is shared with these. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_simplify_samples_copy(const simplify_work *work, simplify_samples *out, hewn_error *error);
void hewn_simplify_samples_drop(simplify_samples *copy);

/* How good the mesh is, less being better: by the mean and the greatest distance between samples and mesh and between
 * points of the mesh and the input, and by how many triangles face away. `work` is in order. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_simplify_score(const simplify_work *work, double *score);

/* Triangles, in coordinates of the work, along the curve of hewn_simplify_order(), for hewn_bvh_build_along(). NULL:
 * out of memory. */
uint32_t *hewn_simplify_along(const hewn_triangle_view *triangles);

/* HEWN_OUT_OF_MEMORY. */
hewn_result hewn_simplify_probe_collapse(const simplify_work *work, const simplify_plan *plan, simplify_probe *probe);
hewn_result hewn_simplify_probe_move(const simplify_work *work, uint32_t v, const double to[3], simplify_probe *probe);

/* After one of these, if it was not cut: how many triangles would face away from what is nearest to their middles in
 * all of the input, not just around the nearest sample; no more are looked for than one past `most`. 0 where there are
 * no samples. */
uint32_t hewn_simplify_probe_turns(const simplify_work *work, const simplify_probe *probe, uint32_t most);

/* `h` is a half-edge that may be swapped. */
hewn_result hewn_simplify_probe_swap(const simplify_work *work, uint32_t h, simplify_probe *probe);

/* Whether a triangle faces away from the input's triangle that is nearest to its middle, or from one of those that are
 * equally near. How: 2, or 1 where it is one of these only. */
bool hewn_simplify_is_turned(const simplify_work *work, uint32_t face);
int hewn_simplify_how_turned(const simplify_work *work, uint32_t face);

/* How many of the triangles around `v` do, but for those with `but`. */
uint32_t hewn_simplify_count_turned(const simplify_work *work, uint32_t v, uint32_t but);

/* The input's triangle nearest to a triangle's middle. */
uint32_t hewn_simplify_nearest(const simplify_work *work, uint32_t face);

/* Which side of a triangle is towards the input's triangle nearest to its middle, as far as is told soon; `guess` is
 * one near it. */
hewn_side hewn_simplify_side(const simplify_work *work, const double a[3], const double b[3], const double c[3],
                             uint32_t guess);

/* Samples go to where the probe found them, just before or after the collapse or move is done. */
void hewn_simplify_probe_settle(const simplify_work *work, simplify_probe *probe);

#endif
