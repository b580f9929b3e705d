/* Where two edges that meet at a corner share one of three distances only, the middle one of the three is, near the
 * corner, the less of the two edges' distances where the corner is convex and the greater where it is not: the corner
 * stays sharp however coarse the texels are (V. Chlumsky, Shape decomposition for multi-channel distance fields, 2015).
 */
#include "atlas/colours.h"

#include <math.h>

#include "base/alloc.h"
#include "base/error.h"

static hewn_bezier moved(const hewn_bezier *curve, double scale, const double move[2])
{
    hewn_bezier out = *curve;
    for (unsigned k = 0; k <= curve->degree; k++)
        for (int axis = 0; axis < 2; axis++)
            out.p[k][axis] = scale * curve->p[k][axis] + move[axis];
    return out;
}

static bool is_corner(const hewn_bezier *one, const hewn_bezier *next, double corner)
{
    double a[2], b[2];
    hewn_bezier_direction(one, 1, a);
    hewn_bezier_direction(next, 0, b);
    return atan2(fabs(a[0] * b[1] - a[1] * b[0]), a[0] * b[0] + a[1] * b[1]) >= corner;
}

/* From one corner round to itself: three colours for three parts, of which the first and the last meet at the corner.
 */
static void colour_drop(hewn_edge *edges, size_t count, size_t corner)
{
    static const unsigned colours[3] = {HEWN_RED | HEWN_BLUE, HEWN_WHITE, HEWN_RED | HEWN_GREEN};
    for (size_t i = 0; i < count; i++)
        edges[(corner + i) % count].colour = colours[3 * i / count];
}

/* From corner to corner in turn; the last part differs from its neighbour on both sides. */
static void colour_sides(hewn_edge *edges, size_t count, size_t first, size_t corners, const bool *is_at)
{
    static const unsigned colours[3] = {HEWN_GREEN | HEWN_BLUE, HEWN_RED | HEWN_BLUE, HEWN_RED | HEWN_GREEN};
    size_t part = 0;
    for (size_t i = 0; i < count; i++) {
        size_t at = (first + i) % count;
        part += i > 0 && is_at[at];
        bool last = part == corners - 1 && corners % 3 == 1;
        edges[at].colour = colours[last ? 1 : part % 3];
    }
}

/* The colours of one contour. `corners` has room for a flag an edge. */
static void colour_contour(hewn_edge *edges, size_t count, double corner, bool *corners)
{
    size_t found = 0, first = 0;
    for (size_t i = count; i-- > 0;) {
        corners[i] = is_corner(&edges[(i + count - 1) % count].curve, &edges[i].curve, corner);
        found += corners[i];
        first = corners[i] ? i : first;
    }
    for (size_t i = 0; i < count; i++)
        edges[i].colour = HEWN_WHITE;
    if (found == 1)
        colour_drop(edges, count, first);
    else if (found > 1)
        colour_sides(edges, count, first, found, corners);
}

/* How many parts a contour's curves are divided into: with a single corner there must be three edges at least. */
static unsigned parts_of(const hewn_glyph_outline *outline, size_t begin, size_t end, double corner)
{
    size_t count = end - begin, corners = 0;
    for (size_t i = 0; i < count; i++)
        corners += is_corner(&outline->curves[begin + (i + count - 1) % count], &outline->curves[begin + i], corner);
    return corners == 1 && count < 3 ? 3 : 1;
}

hewn_result hewn_shape_create(const hewn_glyph_outline *outline, double scale, const double move[2], double corner,
                              hewn_shape *out, hewn_error *error)
{
    *out = (hewn_shape){0};
    size_t room = 3 * outline->count;
    bool *corners = hewn_alloc(room, sizeof *corners);
    out->edges = hewn_alloc(room, sizeof *out->edges);
    if (!corners || !out->edges) {
        hewn_free(corners);
        hewn_shape_clear(out);
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for an outline");
    }
    for (size_t contour = 0, begin = 0; contour < outline->contours; begin = outline->ends[contour++]) {
        unsigned parts = parts_of(outline, begin, outline->ends[contour], corner);
        size_t first = out->count;
        for (size_t i = begin; i < outline->ends[contour]; i++) {
            hewn_bezier curve = moved(&outline->curves[i], scale, move);
            for (unsigned k = 0; k < parts; k++)
                out->edges[out->count++].curve =
                    parts == 1 ? curve : hewn_bezier_part(&curve, (double)k / parts, (double)(k + 1) / parts);
        }
        for (size_t i = first; parts > 1 && i < out->count; i++) { /* the very same points where parts meet */
            size_t next = i + 1 < out->count ? i + 1 : first;
            hewn_bezier *one = &out->edges[i].curve;
            for (int axis = 0; axis < 2; axis++)
                one->p[one->degree][axis] = out->edges[next].curve.p[0][axis];
        }
        colour_contour(out->edges + first, out->count - first, corner, corners);
    }
    for (size_t i = 0; i < out->count; i++)
        hewn_edge_prepare(&out->edges[i]);
    hewn_free(corners);
    return HEWN_OK;
}

void hewn_shape_clear(hewn_shape *shape)
{
    hewn_free(shape->edges);
    *shape = (hewn_shape){0};
}
