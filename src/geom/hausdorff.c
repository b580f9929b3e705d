#include "geom/hausdorff.h"

#include <float.h>

#include "base/alloc.h"
#include "base/error.h"
#include "geom/nearest.h"

/* A triangle in this many pieces, or at this depth, is taken as it stands. */
enum { MOST_PIECES = 20000, MOST_DEPTH = 60 };

/* A corner of a piece: where it is, and which triangle is nearest. */
typedef struct reach_spot {
    double at[3], distance;
    uint32_t nearest;
} reach_spot;

typedef struct reach_piece {
    reach_spot corner[3];
    uint32_t depth;
} reach_piece;

typedef struct reach_survey {
    const hewn_triangle_view *to;
    const hewn_bvh *bvh;
    double tolerance;
    double accept; /* pieces within this need no more cutting */
    double low, high;
    uint32_t pieces;
} reach_survey;

static double gap(const double a[3], const double b[3])
{
    double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return sqrt(x * x + y * y + z * z);
}

static reach_spot look(const reach_survey *survey, const double at[3], uint32_t guess)
{
    reach_spot out = {.at = {at[0], at[1], at[2]}};
    out.nearest = hewn_bvh_nearest(survey->bvh, survey->to, at, guess, &out.distance);
    return out;
}

/* --- bounds ------------------------------------------------------------------------------------------------------- */

/* The distance to one triangle is convex: no point of the piece is further from it than the furthest corner. */
static double bound_by(const reach_survey *survey, const reach_piece *piece, uint32_t triangle)
{
    double most = 0;
    for (int k = 0; k < 3; k++) {
        const reach_spot *corner = &piece->corner[k];
        double reach =
            corner->nearest == triangle ? corner->distance : hewn_view_reach(survey->to, triangle, corner->at);
        most = reach > most ? reach : most;
    }
    return most;
}

/* Also by a corner's distance and how far the others are from it, which shrinks with the piece whatever is there. */
static double bound(const reach_survey *survey, const reach_piece *piece)
{
    double least = INFINITY;
    for (int k = 0; k < 3; k++) {
        const reach_spot *corner = &piece->corner[k], *one = &piece->corner[(k + 1) % 3],
                         *two = &piece->corner[(k + 2) % 3];
        double first = gap(corner->at, one->at), second = gap(corner->at, two->at);
        double wide = corner->distance + (first > second ? first : second);
        least = wide < least ? wide : least;
        if (k > 0 && corner->nearest == piece->corner[0].nearest)
            continue;
        double narrow = bound_by(survey, piece, corner->nearest);
        least = narrow < least ? narrow : least;
    }
    return least;
}

/* --- cutting ------------------------------------------------------------------------------------------------------ */

/* The plane that parts two triangles with a common edge, n x = n[3]: through the edge and between their normals. */
static bool part(const reach_survey *survey, uint32_t one, uint32_t two, double n[4])
{
    const uint32_t *a = survey->to->corners + 3 * (uint64_t)one, *b = survey->to->corners + 3 * (uint64_t)two;
    double p[2][3], tip[2][3], toward[2][3], along[3], square = 0;
    int shared = 0, tips = 0;
    for (int k = 0; k < 3; k++) {
        bool both = a[k] == b[0] || a[k] == b[1] || a[k] == b[2];
        if (both && shared == 2)
            return false;
        hewn_triangle_point(survey->to, a[k], both ? p[shared++] : tip[tips++ ? 1 : 0]);
    }
    if (shared != 2)
        return false;
    for (int k = 0; k < 3; k++)
        if (b[k] != a[0] && b[k] != a[1] && b[k] != a[2])
            hewn_triangle_point(survey->to, b[k], tip[1]);
    for (int axis = 0; axis < 3; axis++) {
        along[axis] = p[1][axis] - p[0][axis];
        square += along[axis] * along[axis];
    }
    for (int t = 0; t < 2; t++) { /* unit vectors in each triangle, across the edge */
        double dot = 0, length = 0;
        for (int axis = 0; axis < 3; axis++)
            dot += (tip[t][axis] - p[0][axis]) * along[axis];
        for (int axis = 0; axis < 3; axis++) {
            toward[t][axis] = tip[t][axis] - p[0][axis] - (square > 0 ? dot / square : 0) * along[axis];
            length += toward[t][axis] * toward[t][axis];
        }
        for (int axis = 0; axis < 3; axis++)
            toward[t][axis] /= sqrt(length);
    }
    n[3] = 0;
    for (int axis = 0; axis < 3; axis++) {
        n[axis] = toward[0][axis] - toward[1][axis];
        n[3] += n[axis] * p[0][axis];
    }
    return isfinite(n[3]);
}

/* Cuts a piece at a point between the corners k and k + 1. */
static void halve(const reach_survey *survey, const reach_piece *whole, int k, double share, reach_piece out[2])
{
    const reach_spot *from = &whole->corner[k], *to = &whole->corner[(k + 1) % 3];
    double at[3];
    for (int axis = 0; axis < 3; axis++)
        at[axis] = from->at[axis] + share * (to->at[axis] - from->at[axis]);
    const reach_spot middle = look(survey, at, share < 0.5 ? from->nearest : to->nearest);
    out[0] = out[1] = *whole;
    out[0].corner[(k + 1) % 3] = middle;
    out[1].corner[k] = middle;
    out[0].depth = out[1].depth = whole->depth + 1;
}

/* Where two corners are nearest to neighbours, where their side crosses the plane between these; else in the middle of
 * the longest side. A cut next to a corner would leave a piece as it was. */
static void cut(const reach_survey *survey, const reach_piece *whole, reach_piece out[2])
{
    int longest = 0;
    double most = -1;
    for (int k = 0; k < 3; k++) {
        const reach_spot *from = &whole->corner[k], *to = &whole->corner[(k + 1) % 3];
        double n[4], length = gap(from->at, to->at);
        if (length > most) {
            most = length;
            longest = k;
        }
        if (from->nearest == to->nearest || whole->depth % 4 == 3 || !part(survey, from->nearest, to->nearest, n))
            continue;
        double before = n[0] * from->at[0] + n[1] * from->at[1] + n[2] * from->at[2] - n[3];
        double after = n[0] * to->at[0] + n[1] * to->at[1] + n[2] * to->at[2] - n[3];
        double share = before / (before - after);
        if (share > 1e-3 && share < 1 - 1e-3) {
            halve(survey, whole, k, share, out);
            return;
        }
    }
    halve(survey, whole, longest, 0.5, out);
}

/* --- one triangle ------------------------------------------------------------------------------------------------- */

/* Proves a piece, or cuts it. Every corner is a point that was found, so it raises `low`. */
static void prove(reach_survey *survey, const reach_piece *whole)
{
    for (int k = 0; k < 3; k++)
        survey->low = whole->corner[k].distance > survey->low ? whole->corner[k].distance : survey->low;
    double least = bound(survey, whole), enough = survey->low * (1 + survey->tolerance);
    enough = enough > survey->accept ? enough : survey->accept;
    if (least > enough) { /* the triangle that is nearest to the middle may serve all corners */
        double middle[3];
        for (int axis = 0; axis < 3; axis++)
            middle[axis] = (whole->corner[0].at[axis] + whole->corner[1].at[axis] + whole->corner[2].at[axis]) / 3;
        const reach_spot best = look(survey, middle, whole->corner[0].nearest);
        double by = bound_by(survey, whole, best.nearest);
        least = by < least ? by : least;
    }
    if (least <= enough || whole->depth >= MOST_DEPTH || survey->pieces >= MOST_PIECES) {
        survey->high = least > survey->high ? least : survey->high;
        return;
    }
    reach_piece halves[2];
    survey->pieces += 2;
    cut(survey, whole, halves);
    prove(survey, &halves[0]);
    prove(survey, &halves[1]);
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

/* What rounding may do to any point or distance here: each cut rounds a point anew, MOST_DEPTH times at most. */
static double rounding(const hewn_triangle_view *mesh)
{
    double most = 0;
#pragma omp parallel for schedule(static) reduction(max : most)
    for (uint64_t v = 0; v < mesh->vertex_count; v++) {
        double at[3];
        hewn_triangle_point(mesh, (uint32_t)v, at);
        for (int axis = 0; axis < 3; axis++)
            most = fabs(at[axis]) > most ? fabs(at[axis]) : most;
    }
    return most * DBL_EPSILON * (4 * MOST_DEPTH);
}

/* Distances of all vertices that triangles use; in order, so that each is a guess for the next. */
static double look_at_vertices(const reach_survey *survey, const hewn_triangle_view *from, reach_spot *spots,
                               uint8_t *used)
{
    const uint64_t run = 1024, runs = (from->vertex_count + run - 1) / run;
    double low = 0;
    for (uint64_t c = 0; c < 3 * from->triangle_count; c++)
        used[from->corners[c]] = 1;
#pragma omp parallel for schedule(dynamic) reduction(max : low)
    for (uint64_t r = 0; r < runs; r++) {
        uint32_t guess = 0;
        for (uint64_t v = r * run; v < (r + 1) * run && v < from->vertex_count; v++) {
            double at[3];
            if (!used[v])
                continue;
            hewn_triangle_point(from, (uint32_t)v, at);
            spots[v] = look(survey, at, guess);
            guess = spots[v].nearest;
            low = spots[v].distance > low ? spots[v].distance : low;
        }
    }
    return low;
}

static void prove_all(const reach_survey *all, const hewn_triangle_view *from, const reach_spot *spots,
                      const hewn_reach_desc *desc, double slack, hewn_reach *out)
{
    double low = all->low, high = all->accept;
#pragma omp parallel for schedule(dynamic, 256) reduction(max : low, high)
    for (uint64_t t = 0; t < from->triangle_count; t++) {
        reach_survey one = *all;
        one.low = one.high = 0;
        reach_piece whole = {.depth = 0};
        for (int k = 0; k < 3; k++)
            whole.corner[k] = spots[from->corners[3 * t + (uint64_t)k]];
        prove(&one, &whole);
        low = one.low > low ? one.low : low;
        high = one.high > high ? one.high : high;
        if (desc->far)
            desc->far[t] = one.high + slack > desc->limit;
    }
    out->low = low - slack > 0 ? low - slack : 0;
    out->high = high + slack;
}

hewn_result hewn_surface_reach(const hewn_triangle_view *from, const hewn_triangle_view *to, const hewn_bvh *bvh,
                               const hewn_reach_desc *desc, hewn_reach *out, hewn_error *error)
{
    *out = (hewn_reach){0};
    reach_spot *spots = hewn_alloc(from->vertex_count, sizeof *spots);
    uint8_t *used = hewn_alloc_zero(from->vertex_count, 1);
    hewn_result result =
        spots && used ? HEWN_OK : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory measuring a distance");
    if (result == HEWN_OK) {
        reach_survey all = {.to = to, .bvh = bvh, .tolerance = desc->tolerance};
        const double here = rounding(from), there = rounding(to), slack = here > there ? here : there;
        all.low = look_at_vertices(&all, from, spots, used);
        all.accept = all.low * (1 + desc->tolerance);
        all.accept = all.low + desc->floor > all.accept ? all.low + desc->floor : all.accept;
        if (desc->far && all.accept > desc->limit - slack) /* for the sake of `far` */
            all.accept = desc->limit - slack;
        all.accept = all.accept > 0 ? all.accept : 0;
        prove_all(&all, from, spots, desc, slack, out);
    }
    hewn_free(spots);
    hewn_free(used);
    return result;
}
