#include "geom/triangle_meet.h"

#include "geom/predicates.h"

/* No projection shows an area. */
enum { FLAT = -1 };

/* --- in a plane --------------------------------------------------------------------------------------------------- */

/* orient2d of points seen along an axis. Seen along the right one, a plane's points keep their arrangement. */
static int turn(int axis, const double *a, const double *b, const double *c)
{
    int i = (axis + 1) % 3, j = (axis + 2) % 3;
    const double p[2] = {a[i], a[j]}, q[2] = {b[i], b[j]}, r[2] = {c[i], c[j]};
    return hewn_orient2d(p, q, r);
}

/* An axis along which the triangle abc shows an area; FLAT where the points are collinear. */
static int view_of(const double *a, const double *b, const double *c)
{
    for (int axis = 0; axis < 3; axis++)
        if (turn(axis, a, b, c) != 0)
            return axis;
    return FLAT;
}

/* Whether x lies between a and b (or on them), where the three are known to be collinear in the view. */
static bool between(int axis, const double *a, const double *b, const double *x)
{
    for (int k = 1; k < 3; k++) {
        int i = (axis + k) % 3;
        if ((x[i] < a[i] && x[i] < b[i]) || (x[i] > a[i] && x[i] > b[i]))
            return false;
    }
    return true;
}

/* Closed segments ab and cd in a plane; either may be a point. */
static bool segments_meet(int axis, const double *a, const double *b, const double *c, const double *d)
{
    int abc = turn(axis, a, b, c), abd = turn(axis, a, b, d), cda = turn(axis, c, d, a), cdb = turn(axis, c, d, b);
    if (abc * abd < 0 && cda * cdb < 0)
        return true;
    return (abc == 0 && between(axis, a, b, c)) || (abd == 0 && between(axis, a, b, d)) ||
           (cda == 0 && between(axis, c, d, a)) || (cdb == 0 && between(axis, c, d, b));
}

/* Whether x lies in the closed triangle t, which has an area in the view. */
static bool holds(int axis, const double (*t)[3], const double *x)
{
    int sides[3] = {turn(axis, t[0], t[1], x), turn(axis, t[1], t[2], x), turn(axis, t[2], t[0], x)};
    bool left = sides[0] > 0 || sides[1] > 0 || sides[2] > 0;
    bool right = sides[0] < 0 || sides[1] < 0 || sides[2] < 0;
    return !(left && right);
}

/* A segment and a triangle with an area, in one plane. */
static bool plane_segment_meets(int axis, const double *p, const double *q, const double (*t)[3])
{
    for (int k = 0; k < 3; k++)
        if (segments_meet(axis, p, q, t[k], t[(k + 1) % 3]))
            return true;
    return holds(axis, t, p);
}

static bool plane_triangles_meet(int axis, const double (*f)[3], const double (*g)[3])
{
    for (int k = 0; k < 3; k++)
        if (plane_segment_meets(axis, f[k], f[(k + 1) % 3], g))
            return true;
    return holds(axis, f, g[0]);
}

/* Whether the ray from p through x runs in the closed corner at p between the rays through b and c, which have an area
 * in the view; x is not p. */
static bool in_corner(int axis, const double *p, const double *b, const double *c, const double *x)
{
    int side = turn(axis, p, b, c);
    return turn(axis, p, b, x) * side >= 0 && turn(axis, p, x, c) * side >= 0;
}

/* --- on a line ---------------------------------------------------------------------------------------------------- */

/* Points in the order of their coordinates, x before y before z: along any line, the order on that line. */
static int compare(const double *a, const double *b)
{
    for (int i = 0; i < 3; i++)
        if (a[i] != b[i])
            return a[i] < b[i] ? -1 : 1;
    return 0;
}

/* The segment that three collinear points span. */
static void span(const double (*t)[3], const double **low, const double **high)
{
    *low = *high = t[0];
    for (int k = 1; k < 3; k++) {
        *low = compare(t[k], *low) < 0 ? t[k] : *low;
        *high = compare(t[k], *high) > 0 ? t[k] : *high;
    }
}

/* Whether the segments pa and pb have more in common than p. */
static bool same_ray(const double *p, const double *a, const double *b)
{
    int to_a = compare(a, p), to_b = compare(b, p);
    return to_a != 0 && to_a == to_b && view_of(p, a, b) == FLAT;
}

/* --- in space ------------------------------------------------------------------------------------------------------
 */

/* The sides of the plane of t on which the points of u lie. */
static void sides_of(const double (*t)[3], const double (*u)[3], int sides[3])
{
    for (int k = 0; k < 3; k++)
        sides[k] = hewn_orient3d(t[0], t[1], t[2], u[k]);
}

/* All strictly on one side. */
static bool apart(const int sides[3])
{
    return sides[0] != 0 && sides[0] == sides[1] && sides[1] == sides[2];
}

static bool all_zero(const int sides[3])
{
    return sides[0] == 0 && sides[1] == 0 && sides[2] == 0;
}

/* Whether the segment pq, whose ends are not both in the plane of t nor strictly on one side of it, meets the closed
 * triangle t: the line pq then passes all edges of t the same way around, or through one. */
static bool pierces(const double *p, const double *q, const double (*t)[3])
{
    int first = hewn_orient3d(p, q, t[0], t[1]), second = hewn_orient3d(p, q, t[1], t[2]);
    if (first * second < 0)
        return false;
    int third = hewn_orient3d(p, q, t[2], t[0]);
    return first * third >= 0 && second * third >= 0;
}

/* Whether an edge of u that passes through the plane of t meets t. Edges in the plane need no look: where u is not in
 * the plane, the ends of what u has in the plane are on the edges that pass through it. */
static bool an_edge_pierces(const double (*u)[3], const int sides[3], const double (*t)[3])
{
    for (int k = 0; k < 3; k++) {
        int next = (k + 1) % 3;
        if (sides[k] != sides[next] && pierces(u[k], u[next], t))
            return true;
    }
    return false;
}

/* The segment pq and the triangle t, which has an area in `view`. */
static bool segment_meets(const double *p, const double *q, int view, const double (*t)[3])
{
    int sides[2] = {hewn_orient3d(t[0], t[1], t[2], p), hewn_orient3d(t[0], t[1], t[2], q)};
    if (sides[0] == 0 && sides[1] == 0)
        return plane_segment_meets(view, p, q, t);
    return sides[0] != sides[1] && pierces(p, q, t);
}

/* Two segments in space, ends in order. */
static bool space_segments_meet(const double *a, const double *b, const double *c, const double *d)
{
    if (hewn_orient3d(a, b, c, d) != 0)
        return false;
    const double *ends[4] = {a, b, c, d};
    for (int left_out = 0; left_out < 4; left_out++) {
        int view = view_of(ends[(left_out + 1) % 4], ends[(left_out + 2) % 4], ends[(left_out + 3) % 4]);
        if (view != FLAT)
            return segments_meet(view, a, b, c, d);
    }
    return compare(a, d) <= 0 && compare(c, b) <= 0;
}

/* Triangles that share nothing by index: one has no area, or both are in one plane. */
static bool special_triangles_meet(const double (*f)[3], const double (*g)[3])
{
    int f_view = view_of(f[0], f[1], f[2]), g_view = view_of(g[0], g[1], g[2]);
    if (f_view != FLAT && g_view != FLAT)
        return plane_triangles_meet(f_view, f, g);
    const double *f_low, *f_high, *g_low, *g_high;
    span(f, &f_low, &f_high);
    span(g, &g_low, &g_high);
    if (f_view != FLAT)
        return segment_meets(g_low, g_high, f_view, f);
    if (g_view != FLAT)
        return segment_meets(f_low, f_high, g_view, g);
    return space_segments_meet(f_low, f_high, g_low, g_high);
}

static bool strangers_meet(const double (*f)[3], const double (*g)[3])
{
    int f_sides[3], g_sides[3];
    sides_of(f, g, g_sides);
    if (apart(g_sides))
        return false;
    sides_of(g, f, f_sides);
    if (apart(f_sides))
        return false;
    if (all_zero(f_sides) || all_zero(g_sides))
        return special_triangles_meet(f, g);
    return an_edge_pierces(f, f_sides, g) || an_edge_pierces(g, g_sides, f);
}

/* --- one shared vertex ---------------------------------------------------------------------------------------------
 */

/* Whether the segments from p to b and to c, all collinear, and the triangle pde, which has an area in `view`, have
 * more in common than p. */
static bool flat_leaves(const double *p, const double *b, const double *c, int view, const double *d, const double *e)
{
    const double *ends[2] = {b, c};
    for (int k = 0; k < 2; k++)
        if (compare(p, ends[k]) != 0 && hewn_orient3d(p, d, e, ends[k]) == 0 && in_corner(view, p, d, e, ends[k]))
            return true;
    return false;
}

/* As below, where one triangle has no area or both are in one plane. */
static bool special_fans_meet(const double *p, const double *b, const double *c, const double *d, const double *e)
{
    int f_view = view_of(p, b, c), g_view = view_of(p, d, e);
    if (f_view != FLAT && g_view != FLAT)
        return in_corner(f_view, p, b, c, d) || in_corner(f_view, p, b, c, e) || in_corner(f_view, p, d, e, b) ||
               in_corner(f_view, p, d, e, c);
    if (g_view != FLAT)
        return flat_leaves(p, b, c, g_view, d, e);
    if (f_view != FLAT)
        return flat_leaves(p, d, e, f_view, b, c);
    return same_ray(p, b, d) || same_ray(p, b, e) || same_ray(p, c, d) || same_ray(p, c, e);
}

/* A plane x = p, y = p or z = p with one triangle beyond it but for p, and the other not beyond it. */
static bool axis_parts(const double *p, const double *b, const double *c, const double *d, const double *e)
{
    for (int i = 0; i < 3; i++) {
        bool f_below = b[i] < p[i] && c[i]<p[i], f_above = b[i]> p[i] && c[i] > p[i];
        if ((f_below && d[i] >= p[i] && e[i] >= p[i]) || (f_above && d[i] <= p[i] && e[i] <= p[i]))
            return true;
        bool g_below = d[i] < p[i] && e[i]<p[i], g_above = d[i]> p[i] && e[i] > p[i];
        if ((g_below && b[i] >= p[i] && c[i] >= p[i]) || (g_above && b[i] <= p[i] && c[i] <= p[i]))
            return true;
    }
    return false;
}

/* Whether the triangles pbc and pde have more in common than p. */
static bool fans_meet(const double *p, const double *b, const double *c, const double *d, const double *e)
{
    if (axis_parts(p, b, c, d, e))
        return false;
    int side_d = hewn_orient3d(p, b, c, d), side_e = hewn_orient3d(p, b, c, e);
    if (side_d * side_e > 0)
        return false;
    int side_b = hewn_orient3d(p, d, e, b), side_c = hewn_orient3d(p, d, e, c);
    if (side_b * side_c > 0)
        return false;
    if ((side_b == 0 && side_c == 0) || (side_d == 0 && side_e == 0))
        return special_fans_meet(p, b, c, d, e);
    /* Both have an area, and their planes cross in a line through p. What a triangle has of that line begins at p and
     * ends on the edge across from p, if it does not end at p. */
    double f[3][3], g[3][3];
    for (int i = 0; i < 3; i++) {
        f[0][i] = g[0][i] = p[i];
        f[1][i] = b[i];
        f[2][i] = c[i];
        g[1][i] = d[i];
        g[2][i] = e[i];
    }
    return pierces(b, c, (const double(*)[3])g) || pierces(d, e, (const double(*)[3])f);
}

/* --- one shared edge ------------------------------------------------------------------------------------------------
 */

/* Whether c and d, on the line of a and b (which differ), lie beyond the same end of ab. */
static bool beyond_one_end(const double *a, const double *b, const double *c, const double *d)
{
    const double *low = compare(a, b) < 0 ? a : b, *high = low == a ? b : a;
    return (compare(c, low) < 0 && compare(d, low) < 0) || (compare(c, high) > 0 && compare(d, high) > 0);
}

/* Whether the triangles abc and abd have more in common than ab. */
static bool hinges_meet(const double *a, const double *b, const double *c, const double *d)
{
    if (hewn_orient3d(a, b, c, d) != 0)
        return false;
    int f_view = view_of(a, b, c), g_view = view_of(a, b, d);
    if (f_view != FLAT && g_view != FLAT)
        return turn(f_view, a, b, c) == turn(f_view, a, b, d);
    if (f_view != FLAT || g_view != FLAT)
        return false; /* the one without area lies on the line of ab, of which the other has ab alone */
    return compare(a, b) != 0 ? beyond_one_end(a, b, c, d) : same_ray(a, c, d);
}

/* --- faces ----------------------------------------------------------------------------------------------------------
 */

/* The vertices that both name, each once: where they are in f and in g. */
static int match(const hewn_facet *f, const hewn_facet *g, int in_f[3], int in_g[3])
{
    int count = 0;
    for (int i = 0; i < 3; i++) {
        if ((i > 0 && f->index[i] == f->index[0]) || (i > 1 && f->index[i] == f->index[1]))
            continue;
        for (int j = 0; j < 3; j++)
            if (f->index[i] == g->index[j]) {
                in_f[count] = i;
                in_g[count++] = j;
                break;
            }
    }
    return count;
}

bool hewn_facets_meet_improperly(const hewn_facet *f, const hewn_facet *g)
{
    int i[3], j[3];
    switch (match(f, g, i, j)) {
    case 0: return strangers_meet(f->point, g->point);
    case 1:
        return fans_meet(f->point[i[0]], f->point[(i[0] + 1) % 3], f->point[(i[0] + 2) % 3], g->point[(j[0] + 1) % 3],
                         g->point[(j[0] + 2) % 3]);
    case 2: return hinges_meet(f->point[i[0]], f->point[i[1]], f->point[3 - i[0] - i[1]], g->point[3 - j[0] - j[1]]);
    default: return true;
    }
}
