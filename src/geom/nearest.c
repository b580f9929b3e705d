#include "geom/nearest.h"

static HEWN_INTO_CLONES double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* From a point to a + s ab + t ac. */
static HEWN_INTO_CLONES double length_to(const double at[3], const double a[3], const double ab[3], const double ac[3],
                                         double s, double t)
{
    double d[3];
    for (int axis = 0; axis < 3; axis++)
        d[axis] = a[axis] + s * ab[axis] + t * ac[axis] - at[axis];
    return sqrt(dot(d, d));
}

static HEWN_INTO_CLONES double share(double part, double whole)
{
    double s = whole > 0 ? part / whole : 0;
    return s < 0 ? 0 : s > 1 ? 1 : s;
}

/* Shares are brought to the triangle before the point is made of them, so that it is always one of the triangle. */
double hewn_triangle_reach(const double at[3], const double a[3], const double b[3], const double c[3])
{
    double ab[3], ac[3], ap[3], bp[3], cp[3];
    for (int axis = 0; axis < 3; axis++) {
        ab[axis] = b[axis] - a[axis];
        ac[axis] = c[axis] - a[axis];
        ap[axis] = at[axis] - a[axis];
        bp[axis] = at[axis] - b[axis];
        cp[axis] = at[axis] - c[axis];
    }
    double d1 = dot(ab, ap), d2 = dot(ac, ap);
    if (d1 <= 0 && d2 <= 0)
        return sqrt(dot(ap, ap));
    double d3 = dot(ab, bp), d4 = dot(ac, bp);
    if (d3 >= 0 && d4 <= d3)
        return sqrt(dot(bp, bp));
    double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0)
        return length_to(at, a, ab, ac, share(d1, d1 - d3), 0);
    double d5 = dot(ab, cp), d6 = dot(ac, cp);
    if (d6 >= 0 && d5 <= d6)
        return sqrt(dot(cp, cp));
    double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0)
        return length_to(at, a, ab, ac, 0, share(d2, d2 - d6));
    double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
        double t = share(d4 - d3, (d4 - d3) + (d5 - d6));
        return length_to(at, a, ab, ac, 1 - t, t);
    }
    double sum = va + vb + vc, s = share(vb, sum), t = share(vc, sum);
    return length_to(at, a, ab, ac, s, s + t > 1 ? 1 - s : t);
}

double hewn_view_reach(const hewn_triangle_view *mesh, uint32_t triangle, const double at[3])
{
    const uint32_t *corner = mesh->corners + 3 * (uint64_t)triangle;
    double a[3], b[3], c[3];
    hewn_triangle_point(mesh, corner[0], a);
    hewn_triangle_point(mesh, corner[1], b);
    hewn_triangle_point(mesh, corner[2], c);
    return hewn_triangle_reach(at, a, b, c);
}

typedef struct near_search {
    const hewn_bvh *bvh;
    const hewn_triangle_view *mesh;
    const double *at;
    uint32_t best;
    double distance, square; /* boxes are looked into that are nearer than the square's root */
    double enough;
} near_search;

static inline void look_at(near_search *search, uint32_t triangle)
{
    double distance = hewn_view_reach(search->mesh, triangle, search->at);
    if (distance < search->distance || (distance == search->distance && triangle < search->best)) {
        search->best = triangle;
        search->distance = distance;
        search->square = distance > search->enough ? distance * distance : 0;
    }
}

/* A block on the way down: boxes that are still to be looked into. */
typedef struct near_step {
    double square[4];
    uint64_t block;
} near_step;

/* Nearer boxes first, of those as near in the order of their slots; those further away than what was found are passed
 * over. */
HEWN_CLONES static void descend(near_search *search)
{
    const hewn_bvh *bvh = search->bvh;
    near_step steps[HEWN_BVH_LEVELS];
    const uint32_t top = bvh->level_count - 1;
    uint32_t level = top;
    steps[top].block = 0;
    hewn_boxes4_squares(&bvh->level[top][0], search->at, steps[top].square);
    for (;;) {
        near_step *step = &steps[level];
        const int least = hewn_least_of4(step->square);
        if (!(step->square[least] < search->square)) {
            if (level++ == top)
                return;
            continue;
        }
        step->square[least] = INFINITY;
        const uint64_t child = 4 * step->block + (uint64_t)least;
        if (level == 0) {
            look_at(search, bvh->order[child]);
        } else {
            steps[--level].block = child;
            hewn_boxes4_squares(&bvh->level[level][child], search->at, steps[level].square);
        }
    }
}

uint32_t hewn_bvh_nearest_within(const hewn_bvh *bvh, const hewn_triangle_view *mesh, const double at[3],
                                 uint32_t guess, double enough, double *distance)
{
    near_search search = {.bvh = bvh, .mesh = mesh, .at = at, .best = guess, .enough = enough};
    search.distance = hewn_view_reach(mesh, guess, at);
    search.square = search.distance > enough ? search.distance * search.distance : 0;
    descend(&search);
    *distance = search.distance;
    return search.best;
}

uint32_t hewn_bvh_nearest(const hewn_bvh *bvh, const hewn_triangle_view *mesh, const double at[3], uint32_t guess,
                          double *distance)
{
    return hewn_bvh_nearest_within(bvh, mesh, at, guess, 0, distance);
}
