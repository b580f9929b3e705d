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

/* A number below `most` that looks like any other (splitmix64). */
static unsigned draw_lot(uint64_t *state, unsigned most)
{
    *state += 0x9E3779B97F4A7C15u;
    uint64_t z = (*state ^ (*state >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return (unsigned)((z >> 33) % most);
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
static void colour_sides(hewn_edge *edges, size_t count, size_t first, size_t corners)
{
    static const unsigned colours[3] = {HEWN_GREEN | HEWN_BLUE, HEWN_RED | HEWN_BLUE, HEWN_RED | HEWN_GREEN};
    size_t part = 0;
    for (size_t i = 0; i < count; i++) {
        size_t at = (first + i) % count;
        part += i > 0 && edges[at].begins;
        bool last = part == corners - 1 && corners % 3 == 1;
        edges[at].colour = colours[last ? 1 : part % 3];
    }
}

/* One of the three colours that is none of two others. */
static unsigned other_colour(uint64_t *lots, unsigned one, unsigned two)
{
    unsigned left[3], count = 0;
    for (unsigned k = 0; k < 3; k++)
        if (k != one && k != two)
            left[count++] = k;
    return left[draw_lot(lots, count)];
}

/* The same from corner to corner by lot; the last part differs from the first as well. */
static void colour_by_lot(hewn_edge *edges, size_t count, size_t first, size_t corners, uint64_t *lots)
{
    static const unsigned colours[3] = {HEWN_GREEN | HEWN_BLUE, HEWN_RED | HEWN_BLUE, HEWN_RED | HEWN_GREEN};
    unsigned begin = draw_lot(lots, 3), now = begin;
    size_t part = 0;
    for (size_t i = 0; i < count; i++) {
        hewn_edge *edge = &edges[(first + i) % count];
        if (i > 0 && edge->begins)
            now = other_colour(lots, now, ++part == corners - 1 ? begin : now);
        edge->colour = colours[now];
    }
}

/* The colours of one contour. */
static void colour_contour(hewn_edge *edges, size_t count, uint64_t *lots)
{
    static const unsigned smooth[4] = {HEWN_WHITE, HEWN_GREEN | HEWN_BLUE, HEWN_RED | HEWN_BLUE, HEWN_RED | HEWN_GREEN};
    size_t found = 0, first = 0;
    for (size_t i = count; i-- > 0;) {
        found += edges[i].begins;
        first = edges[i].begins ? i : first;
    }
    unsigned colour = lots && found == 0 ? smooth[draw_lot(lots, 4)] : HEWN_WHITE;
    for (size_t i = 0; i < count; i++)
        edges[i].colour = colour;
    if (found == 1)
        colour_drop(edges, count, first);
    else if (found > 1 && lots)
        colour_by_lot(edges, count, first, found, lots);
    else if (found > 1)
        colour_sides(edges, count, first, found);
}

void hewn_shape_recolour(hewn_shape *shape, uint32_t number)
{
    uint64_t lots = number;
    for (size_t i = 0, begin = 0; i < shape->contours; begin = shape->ends[i++])
        colour_contour(shape->edges + begin, shape->ends[i] - begin, number > 0 ? &lots : NULL);
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
    out->edges = hewn_alloc(room, sizeof *out->edges);
    out->ends = hewn_alloc(outline->contours, sizeof *out->ends);
    if (!out->ends || !out->edges) {
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
        for (size_t i = first, last = out->count - 1; i < out->count; last = i++)
            out->edges[i].begins = is_corner(&out->edges[last].curve, &out->edges[i].curve, corner);
        out->ends[out->contours++] = out->count;
    }
    hewn_shape_recolour(out, 0);
    for (size_t i = 0; i < out->count; i++)
        hewn_edge_prepare(&out->edges[i]);
    return HEWN_OK;
}

void hewn_shape_clear(hewn_shape *shape)
{
    hewn_free(shape->edges);
    hewn_free(shape->ends);
    *shape = (hewn_shape){0};
}
