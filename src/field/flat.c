/* Flat shapes, which are fields of x and y alone, and what becomes of them in space. */
#include <string.h>

#include "base/alloc.h"
#include "field/compose.h"

hewn_node hewn_circle(hewn_field *f, double radius)
{
    if (!all_above_0(f, "circle", 1, &radius))
        return HEWN_NODE_NONE;
    return plus(f, length_of_two(f, hewn_x(f), hewn_y(f)), -radius);
}

hewn_node hewn_rectangle(hewn_field *f, double width, double height)
{
    if (!all_above_0(f, "rectangle", 2, (const double[2]){width, height}))
        return HEWN_NODE_NONE;
    return corner(f, plus(f, hewn_abs(f, hewn_x(f)), -0.5 * width), plus(f, hewn_abs(f, hewn_y(f)), -0.5 * height));
}

hewn_node hewn_ellipse(hewn_field *f, double x, double y)
{
    if (!all_above_0(f, "ellipse", 2, (const double[2]){x, y}))
        return HEWN_NODE_NONE;
    hewn_node away = length_of_two(f, times(f, hewn_x(f), 1 / x), times(f, hewn_y(f), 1 / y));
    return times(f, plus(f, away, -1), fmin(x, y));
}

/* --- polygons ------------------------------------------------------------------------------------------------------
 */

/* Links of the chain that an outline is. */
typedef struct chain {
    hewn_field *field;
    hewn_node last;
    double first[2], at[2], size;
    size_t edges;
} chain;

static chain chain_from(hewn_field *f, double x, double y)
{
    return (chain){f, hewn_constant(f, HEWN_OUTLINE_START), {x, y}, {x, y}, fmax(fabs(x), fabs(y)), 0};
}

static void chain_to(chain *own, double x, double y)
{
    if (x == own->at[0] && y == own->at[1])
        return;
    if (own->edges == HEWN_OUTLINE_MOST) {
        hewn_field_refuse(own->field, HEWN_INVALID_ARGUMENT, "an outline has more than %d edges",
                          (int)HEWN_OUTLINE_MOST);
        own->last = HEWN_NODE_NONE;
    }
    hewn_node_data link = {.op = HEWN_OP_EDGE,
                           .operand = {own->last.id, HEWN_ID_X, HEWN_ID_Y},
                           .parameter = {own->at[0], own->at[1], x, y}};
    own->last = hewn_field_add_node(own->field, &link);
    own->at[0] = x;
    own->at[1] = y;
    own->size = fmax(own->size, fmax(fabs(x), fabs(y)));
    own->edges++;
}

static hewn_node chain_closed(chain *own, const char *name)
{
    chain_to(own, own->first[0], own->first[1]);
    if (own->edges < 3)
        return hewn_field_refuse(own->field, HEWN_INVALID_ARGUMENT, "%s: it needs three different points or more",
                                 name);
    return hewn_field_add_node(own->field, &(hewn_node_data){.op = HEWN_OP_OUTLINE,
                                                             .operand = {own->last.id, HEWN_ID_X, HEWN_ID_Y},
                                                             .parameter = {own->size}});
}

static bool points_are_fine(hewn_field *f, const char *name, const double *points, size_t count)
{
    if (!points || count > HEWN_OUTLINE_MOST) {
        hewn_field_refuse(f, HEWN_INVALID_ARGUMENT, "%s: it has %s", name,
                          points ? "more than 65536 points" : "no points");
        return false;
    }
    for (size_t i = 0; i < 2 * count; i++)
        if (!(fabs(points[i]) < 1e12)) {
            hewn_field_refuse(f, HEWN_INVALID_ARGUMENT, "%s: point %zu is not finite, or too far out", name, i / 2 + 1);
            return false;
        }
    return true;
}

/* Goes on with another outline, elsewhere. */
static void chain_jump(chain *own, double x, double y)
{
    own->first[0] = own->at[0] = x;
    own->first[1] = own->at[1] = y;
}

hewn_node hewn_contours(hewn_field *f, const double *points, const size_t *counts, size_t count)
{
    size_t all = 0;
    for (size_t i = 0; counts && i < count; i++) {
        if (counts[i] < 3 || counts[i] > HEWN_OUTLINE_MOST - all)
            return hewn_field_refuse(f, HEWN_INVALID_ARGUMENT, "contours: contour %zu has %zu points", i + 1,
                                     counts[i]);
        all += counts[i];
    }
    if (!counts || count == 0)
        return hewn_field_refuse(f, HEWN_INVALID_ARGUMENT, "contours: there are none");
    if (!points_are_fine(f, "contours", points, all))
        return HEWN_NODE_NONE;
    chain own = chain_from(f, points[0], points[1]);
    for (size_t i = 0; i < count; points += 2 * counts[i++]) {
        chain_jump(&own, points[0], points[1]);
        for (size_t k = 1; k < counts[i]; k++)
            chain_to(&own, points[2 * k], points[2 * k + 1]);
        chain_to(&own, points[0], points[1]);
    }
    return chain_closed(&own, "contours");
}

hewn_node hewn_polygon(hewn_field *f, const double *points, size_t count)
{
    if (!points_are_fine(f, "polygon", points, count))
        return HEWN_NODE_NONE;
    if (count < 3)
        return hewn_field_refuse(f, HEWN_INVALID_ARGUMENT, "polygon: it needs three points or more, not %zu", count);
    chain own = chain_from(f, points[0], points[1]);
    for (size_t i = 1; i < count; i++)
        chain_to(&own, points[2 * i], points[2 * i + 1]);
    return chain_closed(&own, "polygon");
}

/* Corners at two radii in turn, the first one straight up; `count` of them. */
static hewn_node ring(hewn_field *f, const char *name, unsigned count, double outer, double inner)
{
    double *points = hewn_alloc((size_t)count * 2, sizeof *points);
    if (!points)
        return hewn_field_refuse(f, HEWN_OUT_OF_MEMORY, "out of memory for a %s", name);
    for (unsigned i = 0; i < count; i++) {
        double angle = 2 * acos(-1) * i / count, radius = i % 2 ? inner : outer;
        points[2 * i] = -radius * sin(angle);
        points[2 * i + 1] = radius * cos(angle);
    }
    hewn_node out = hewn_polygon(f, points, count);
    hewn_free(points);
    return out;
}

static bool sides_are_fine(hewn_field *f, const char *name, unsigned sides, unsigned least)
{
    if (sides >= least && sides <= 1024)
        return true;
    hewn_field_refuse(f, HEWN_INVALID_ARGUMENT, "%s: it has %u to 1024 corners, not %u", name, least, sides);
    return false;
}

hewn_node hewn_regular_polygon(hewn_field *f, unsigned sides, double radius)
{
    if (!all_above_0(f, "regular_polygon", 1, &radius) || !sides_are_fine(f, "regular_polygon", sides, 3))
        return HEWN_NODE_NONE;
    return ring(f, "regular_polygon", sides, radius, radius);
}

hewn_node hewn_star(hewn_field *f, unsigned corners, double outer, double inner)
{
    if (!all_above_0(f, "star", 2, (const double[2]){outer, inner}) || !sides_are_fine(f, "star", corners, 2))
        return HEWN_NODE_NONE;
    return ring(f, "star", 2 * corners, outer, inner);
}

/* A curve of `degree` from where the chain is: chords that stay within a 4,000th of the outline's size. */
static void chain_along(chain *own, unsigned degree, const double *controls, double off)
{
    double p[8] = {own->at[0], own->at[1]}, bend = 0;
    memcpy(p + 2, controls, 2 * degree * sizeof *p);
    for (unsigned k = 0; k + 2 <= degree; k++)
        bend = fmax(bend,
                    hypot(p[2 * k] - 2 * p[2 * k + 2] + p[2 * k + 4], p[2 * k + 1] - 2 * p[2 * k + 3] + p[2 * k + 5]));
    double chords = fmin(fmax(ceil(sqrt(bend * degree * (degree - 1) / (8 * off))), 1), 256);
    for (double i = 1; i < chords; i++) {
        double t = i / chords, level[8]; /* de Casteljau */
        memcpy(level, p, sizeof level);
        for (unsigned round = degree; round > 0; round--)
            for (unsigned k = 0; k < 2 * round; k++)
                level[k] += t * (level[k + 2] - level[k]);
        chain_to(own, level[0], level[1]);
    }
    chain_to(own, p[2 * degree], p[2 * degree + 1]);
}

hewn_node hewn_outline(hewn_field *f, const hewn_curve *curves, size_t count)
{
    if (!curves || count < 1 || count > 4096)
        return hewn_field_refuse(f, HEWN_INVALID_ARGUMENT, "outline: it has 1 to 4096 curves, not %zu", count);
    double size = 0;
    for (size_t i = 0; i < count; i++) {
        if (curves[i].degree < 1 || curves[i].degree > 3)
            return hewn_field_refuse(f, HEWN_INVALID_ARGUMENT, "outline: curve %zu has the degree %u", i + 1,
                                     curves[i].degree);
        if (!points_are_fine(f, "outline", curves[i].points[0], curves[i].degree))
            return HEWN_NODE_NONE;
        for (unsigned k = 0; k < 2 * curves[i].degree; k++)
            size = fmax(size, fabs(curves[i].points[k / 2][k % 2]));
    }
    const hewn_curve *last = &curves[count - 1];
    chain own = chain_from(f, last->points[last->degree - 1][0], last->points[last->degree - 1][1]);
    for (size_t i = 0; i < count; i++)
        chain_along(&own, curves[i].degree, curves[i].points[0], size / 4000);
    return chain_closed(&own, "outline");
}

/* --- into space ----------------------------------------------------------------------------------------------------
 */

hewn_node hewn_extrude(hewn_field *f, hewn_node shape, double height)
{
    hewn_box box;
    if (!all_above_0(f, "extrude", 1, &height))
        return HEWN_NODE_NONE;
    hewn_node out = corner(f, shape, plus(f, hewn_abs(f, hewn_z(f)), -0.5 * height));
    if (!hewn_field_known_box(f, shape, &box))
        return out;
    box.lo[2] = -0.5 * height;
    box.hi[2] = 0.5 * height;
    return bounded(f, out, &box);
}

hewn_node hewn_revolve(hewn_field *f, hewn_node shape)
{
    hewn_box box;
    hewn_node turned =
        hewn_remap_revolved(f, shape, length_of_two(f, hewn_x(f), hewn_z(f)), hewn_y(f), hewn_constant(f, 0));
    return hewn_field_known_box(f, shape, &box) ? bounded_by_cylinder(f, turned, box.hi[0], box.lo[1], box.hi[1])
                                                : turned;
}

/* What is inside the mix is inside one of the two. */
hewn_node hewn_loft(hewn_field *f, hewn_node bottom, hewn_node top, double height)
{
    hewn_box box, other;
    if (!all_above_0(f, "loft", 1, &height))
        return HEWN_NODE_NONE;
    hewn_node part = clamped(f, plus(f, times(f, hewn_z(f), 1 / height), 0.5), 0, 1);
    hewn_node mix = hewn_add(f, bottom, hewn_mul(f, part, hewn_sub(f, top, bottom)));
    hewn_node out = corner(f, mix, plus(f, hewn_abs(f, hewn_z(f)), -0.5 * height));
    if (!hewn_field_known_box(f, bottom, &box) || !hewn_field_known_box(f, top, &other))
        return out;
    for (int i = 0; i < 2; i++) {
        box.lo[i] = fmin(box.lo[i], other.lo[i]);
        box.hi[i] = fmax(box.hi[i], other.hi[i]);
    }
    box.lo[2] = -0.5 * height;
    box.hi[2] = 0.5 * height;
    return bounded(f, out, &box);
}

hewn_node hewn_prism(hewn_field *f, unsigned sides, double radius, double height)
{
    if (!all_above_0(f, "prism", 2, (const double[2]){radius, height}) || !sides_are_fine(f, "prism", sides, 3))
        return HEWN_NODE_NONE;
    hewn_node upright = hewn_extrude(f, hewn_regular_polygon(f, sides, radius), height);
    return hewn_rotate(f, upright, 1, 0, 0, -0.5 * acos(-1));
}
