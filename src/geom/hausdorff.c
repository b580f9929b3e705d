#include "geom/hausdorff.h"

#include <float.h>

#include "base/alloc.h"
#include "base/error.h"
#include "geom/nearest.h"

/* A triangle in this many pieces, or at this depth, is taken as it stands. */
enum { MOST_PIECES = 1 << 20, MOST_DEPTH = 90 };

/* Fewer vertices or triangles are done by one thread. */
enum { FEW = 2000 };

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

/* Also by a corner's distance and how far the others are from it, or how far a point can be from all of them (a
 * triangle whose longest side is 1 has none that is more than 1 / sqrt(3) from every corner), which shrinks with the
 * piece whatever is there. */
static double bound(const reach_survey *survey, const reach_piece *piece)
{
    double least = INFINITY, furthest = 0, longest = 0;
    for (int k = 0; k < 3; k++) {
        const reach_spot *corner = &piece->corner[k], *one = &piece->corner[(k + 1) % 3],
                         *two = &piece->corner[(k + 2) % 3];
        double first = gap(corner->at, one->at), second = gap(corner->at, two->at);
        double wide = corner->distance + (first > second ? first : second);
        least = wide < least ? wide : least;
        furthest = corner->distance > furthest ? corner->distance : furthest;
        longest = first > longest ? first : longest;
        if (k > 0 && corner->nearest == piece->corner[0].nearest)
            continue;
        double narrow = bound_by(survey, piece, corner->nearest);
        least = narrow < least ? narrow : least;
    }
    const double near = furthest + 0.57735026918963 * longest; /* rounded up */
    return near < least ? near : least;
}

/* --- cutting ------------------------------------------------------------------------------------------------------ */

/* The planes through the edges of a triangle and along its normal, n x = n[3], positive outside. */
static void walls_of(double p[3][3], double walls[3][4])
{
    double side[3][3], normal[3];
    for (int k = 0; k < 3; k++)
        for (int axis = 0; axis < 3; axis++)
            side[k][axis] = p[(k + 1) % 3][axis] - p[k][axis];
    for (int x = 0; x < 3; x++)
        normal[x] = side[0][(x + 1) % 3] * side[1][(x + 2) % 3] - side[0][(x + 2) % 3] * side[1][(x + 1) % 3];
    for (int k = 0; k < 3; k++) {
        walls[k][3] = 0;
        for (int x = 0; x < 3; x++) {
            walls[k][x] = side[k][(x + 1) % 3] * normal[(x + 2) % 3] - side[k][(x + 2) % 3] * normal[(x + 1) % 3];
            walls[k][3] += walls[k][x] * p[k][x];
        }
    }
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

/* The longest side, by its first corner. */
static int longest_of(const double a[3], const double b[3], const double c[3], double *length)
{
    const double sides[3] = {gap(a, b), gap(b, c), gap(c, a)};
    int longest = 0;
    for (int k = 1; k < 3; k++)
        longest = sides[k] > sides[longest] ? k : longest;
    *length = sides[longest];
    return longest;
}

/* A piece that is much larger than the triangle nearest to its middle is halved. Else it is cut where one of its sides
 * runs through a wall of that triangle: what is within all walls is near the triangle everywhere. A cut next to a
 * corner would leave a piece as it was. */
static void cut(const reach_survey *survey, const reach_piece *whole, uint32_t nearest, reach_piece out[2])
{
    const reach_spot *corner = whole->corner;
    const uint32_t *names = survey->to->corners + 3 * (uint64_t)nearest;
    double walls[3][4], p[3][3], length, other;
    for (int k = 0; k < 3; k++)
        hewn_triangle_point(survey->to, names[k], p[k]);
    const int longest = longest_of(corner[0].at, corner[1].at, corner[2].at, &length);
    (void)longest_of(p[0], p[1], p[2], &other);
    walls_of(p, walls);
    for (int w = 0; w < 3 && length < 2 * other && whole->depth % 8 != 7; w++) {
        double off[3];
        for (int k = 0; k < 3; k++)
            off[k] = walls[w][0] * corner[k].at[0] + walls[w][1] * corner[k].at[1] + walls[w][2] * corner[k].at[2] -
                     walls[w][3];
        for (int k = 0; k < 3; k++) {
            const double share = off[k] / (off[k] - off[(k + 1) % 3]);
            if (share > 1e-3 && share < 1 - 1e-3) {
                halve(survey, whole, k, share, out);
                return;
            }
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
    uint32_t nearest = whole->corner[0].nearest;
    if (least > enough) { /* the triangle that is nearest to the middle may serve all corners */
        double middle[3];
        for (int axis = 0; axis < 3; axis++)
            middle[axis] = (whole->corner[0].at[axis] + whole->corner[1].at[axis] + whole->corner[2].at[axis]) / 3;
        nearest = look(survey, middle, nearest).nearest;
        double by = bound_by(survey, whole, nearest);
        least = by < least ? by : least;
    }
    if (least <= enough || whole->depth >= MOST_DEPTH || survey->pieces >= MOST_PIECES) {
        survey->high = least > survey->high ? least : survey->high;
        return;
    }
    reach_piece halves[2];
    survey->pieces += 2;
    cut(survey, whole, nearest, halves);
    prove(survey, &halves[0]);
    prove(survey, &halves[1]);
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

/* What rounding may do to any point or distance here: each cut rounds a point anew, MOST_DEPTH times at most. */
static double rounding(const hewn_triangle_view *mesh)
{
    double most = 0;
#pragma omp parallel for schedule(static) reduction(max : most) if (mesh->vertex_count > FEW)
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
#pragma omp parallel for schedule(dynamic) reduction(max : low) if (from->vertex_count > FEW)
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
#pragma omp parallel for schedule(dynamic, 256) reduction(max : low, high) if (from->triangle_count > FEW)
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
        if (desc->far && all.accept > desc->limit - 2 * slack) /* for the sake of `far` */
            all.accept = desc->limit - 2 * slack;
        all.accept = all.accept > 0 ? all.accept : 0;
        prove_all(&all, from, spots, desc, slack, out);
    }
    hewn_free(spots);
    hewn_free(used);
    return result;
}

/* --- a glance ----------------------------------------------------------------------------------------------------- */

/* The greatest distance of the points of a triangle that are in a grid, without its corners. */
static double furthest_point(const reach_survey *all, const reach_spot *const corner[3], uint32_t inner)
{
    const uint32_t parts = inner + 1;
    uint32_t guess = corner[0]->nearest;
    double most = 0;
    for (uint32_t a = 0; a < parts; a++)
        for (uint32_t b = 0; a + b <= parts; b++) {
            const uint32_t c = parts - a - b;
            if (b == parts || c == parts)
                continue;
            double at[3];
            for (int axis = 0; axis < 3; axis++)
                at[axis] = (a * corner[0]->at[axis] + b * corner[1]->at[axis] + c * corner[2]->at[axis]) / parts;
            const reach_spot spot = look(all, at, guess);
            guess = spot.nearest;
            most = spot.distance > most ? spot.distance : most;
        }
    return most;
}

static uint64_t mark_far(const reach_survey *all, const hewn_triangle_view *from, const reach_spot *spots,
                         uint32_t inner, double limit, double near, uint8_t *far)
{
    uint64_t count = 0;
#pragma omp parallel for schedule(dynamic, 256) reduction(+ : count) if (from->triangle_count > FEW)
    for (uint64_t t = 0; t < from->triangle_count; t++) {
        const reach_spot *corner[3];
        double most = 0;
        for (uint64_t k = 0; k < 3; k++) {
            corner[k] = &spots[from->corners[3 * t + k]];
            most = corner[k]->distance > most ? corner[k]->distance : most;
        }
        const double within = inner > 0 && most <= limit ? furthest_point(all, corner, inner) : 0;
        most = within > most ? within : most;
        far[t] = most > near * limit;
        count += most > limit;
    }
    return count;
}

hewn_result hewn_surface_glance(const hewn_triangle_view *from, const hewn_triangle_view *to, const hewn_bvh *bvh,
                                uint32_t inner, double limit, double near, uint8_t *far, uint64_t *count,
                                hewn_error *error)
{
    const reach_survey all = {.to = to, .bvh = bvh};
    reach_spot *spots = hewn_alloc(from->vertex_count, sizeof *spots);
    uint8_t *used = hewn_alloc_zero(from->vertex_count, 1);
    hewn_result result =
        spots && used ? HEWN_OK : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory measuring a distance");
    *count = 0;
    if (result == HEWN_OK) {
        (void)look_at_vertices(&all, from, spots, used);
        *count = mark_far(&all, from, spots, inner, limit, near, far);
    }
    hewn_free(spots);
    hewn_free(used);
    return result;
}
