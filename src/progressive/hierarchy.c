#include "progressive/hierarchy.h"

#include <math.h>
#include <string.h>

#include "base/alloc.h"

void hewn_hierarchy_release(progressive_hierarchy *of)
{
    hewn_free(of->below.first);
    hewn_free(of->below.to);
    hewn_free(of->above.first);
    hewn_free(of->above.to);
    hewn_free(of->parents);
    hewn_free(of->children);
    hewn_free(of->regions);
    *of = (progressive_hierarchy){0};
}

/* --- regions ------------------------------------------------------------------------------------------------------ */

static double length_of(const double v[3])
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* Spheres are made a little too large, so that rounding leaves none outside. */
static void hold_sphere(progressive_region *of, const double center[3], double radius)
{
    const double d[3] = {center[0] - of->center[0], center[1] - of->center[1], center[2] - of->center[2]};
    const double apart = length_of(d);
    if (of->radius >= 0 && apart + radius <= of->radius)
        return;
    if (of->radius < 0 || apart + of->radius <= radius) {
        memcpy(of->center, center, sizeof of->center);
        of->radius = radius;
        return;
    }
    const double whole = (apart + radius + of->radius) / 2, step = (whole - of->radius) / apart;
    for (int axis = 0; axis < 3; axis++)
        of->center[axis] += d[axis] * step;
    of->radius = whole * (1 + 1e-12) + 1e-14 * length_of(of->center);
}

static void hold_cone(progressive_region *of, const double axis[3], double angle)
{
    const double cosine = of->axis[0] * axis[0] + of->axis[1] * axis[1] + of->axis[2] * axis[2];
    const double apart = acos(fmax(-1, fmin(1, cosine)));
    if (of->angle >= 0 && apart + angle <= of->angle)
        return;
    if (of->angle < 0 || apart + of->angle <= angle) {
        memcpy(of->axis, axis, sizeof of->axis);
        of->angle = angle + 1e-7;
        return;
    }
    const double whole = (apart + angle + of->angle) / 2;
    if (whole >= M_PI || sin(apart) < 1e-9) {
        of->angle = 4;
        return;
    }
    const double turn = whole - of->angle, a = sin(apart - turn) / sin(apart), b = sin(turn) / sin(apart);
    for (int k = 0; k < 3; k++)
        of->axis[k] = a * of->axis[k] + b * axis[k];
    const double length = length_of(of->axis);
    for (int k = 0; k < 3; k++)
        of->axis[k] /= length;
    of->angle = whole + 1e-7;
}

static void hold_triangle(progressive_region *of, const double *a, const double *b, const double *c)
{
    const double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    const double length = length_of(n);
    hold_sphere(of, a, 0);
    hold_sphere(of, b, 0);
    hold_sphere(of, c, 0);
    if (!(length > 0) || !isfinite(length))
        return;
    for (int k = 0; k < 3; k++)
        n[k] /= length;
    hold_cone(of, n, 0);
}

static void hold_region(progressive_region *of, const progressive_region *other)
{
    hold_sphere(of, other->center, other->radius);
    if (other->angle >= 0)
        hold_cone(of, other->axis, other->angle);
    of->error = fmax(of->error, other->error);
}

/* --- links -------------------------------------------------------------------------------------------------------- */

/* Folds that changed what is around each vertex since its own last one, as lists in `next`. */
typedef struct traces {
    const hewn_progressive *from;
    uint32_t *wedges; /* of triangles' corners, at the time that folding has come to */
    uint32_t *heads;  /* of vertices */
    uint32_t *folds, *nexts;
    size_t count, room, next_room;
    uint32_t *links; /* pairs: a split and a finer one that stands on it */
    size_t link_count, link_room;
    uint32_t *stamps; /* of vertices and then of splits, by the split that looked at them last */
} traces;

static hewn_result add_trace(traces *of, uint32_t vertex, uint32_t fold, hewn_error *error)
{
    HEWN_TRY(hewn_reserve((void **)&of->folds, &of->room, of->count + 1, sizeof *of->folds, error));
    HEWN_TRY(hewn_reserve((void **)&of->nexts, &of->next_room, of->count + 1, sizeof *of->nexts, error));
    if (of->count >= HEWN_NONE)
        return hewn_fail(error, HEWN_LIMIT, "too many vertices to refine");
    of->folds[of->count] = fold;
    of->nexts[of->count] = of->heads[vertex];
    of->heads[vertex] = (uint32_t)of->count++;
    return HEWN_OK;
}

/* All folds around a vertex are what split `i` carries. */
static hewn_result take_traces(traces *of, uint32_t vertex, uint32_t i, hewn_error *error)
{
    uint32_t *seen = of->stamps + of->from->vertex_count;
    for (uint32_t at = of->heads[vertex]; at != HEWN_NONE && of->folds && of->nexts; at = of->nexts[at]) {
        const uint32_t fold = of->folds[at];
        if (seen[fold] == i)
            continue;
        seen[fold] = i;
        HEWN_TRY(hewn_reserve((void **)&of->links, &of->link_room, of->link_count + 2, sizeof *of->links, error));
        of->links[of->link_count++] = i;
        of->links[of->link_count++] = fold;
    }
    of->heads[vertex] = HEWN_NONE;
    return HEWN_OK;
}

static hewn_result look_at_triangle(traces *of, uint32_t triangle, uint32_t i, progressive_hierarchy *out,
                                    hewn_error *error)
{
    const hewn_progressive *from = of->from;
    const uint32_t vertex = from->base_vertices + i, parent = from->splits[i].parent;
    uint32_t v[3];
    for (size_t k = 0; k < 3; k++)
        v[k] = from->wedge_vertices[of->wedges[3 * (size_t)triangle + k]];
    hold_triangle(&out->regions[i], from->positions + 3 * (size_t)v[0], from->positions + 3 * (size_t)v[1],
                  from->positions + 3 * (size_t)v[2]);
    for (size_t k = 0; k < 3; k++) {
        if (v[k] == vertex || v[k] == parent || of->stamps[v[k]] == i)
            continue;
        of->stamps[v[k]] = i;
        HEWN_TRY(add_trace(of, v[k], i, error));
    }
    return HEWN_OK;
}

/* Folds split `i`, and finds what it carries. */
static hewn_result fold_back(traces *of, uint32_t i, progressive_hierarchy *out, hewn_error *error)
{
    const hewn_progressive *from = of->from;
    const progressive_split *split = &from->splits[i];
    out->regions[i] = (progressive_region){.radius = -1, .angle = -1, .error = (double)split->error};
    for (size_t k = 0; k < 2; k++)
        if (out->children[2 * (size_t)i + k] != HEWN_NONE)
            hold_region(&out->regions[i], &out->regions[out->children[2 * (size_t)i + k]]);
    HEWN_TRY(take_traces(of, from->base_vertices + i, i, error));
    HEWN_TRY(take_traces(of, split->parent, i, error));
    for (uint32_t t = split->first_triangle; t < progressive_triangles_at(from, i + 1ull); t++)
        HEWN_TRY(look_at_triangle(of, t, i, out, error));
    for (uint32_t c = split->first_change; c < progressive_changes_at(from, i + 1ull); c++) {
        HEWN_TRY(look_at_triangle(of, from->changes[c].corner / 3, i, out, error));
        of->wedges[from->changes[c].corner] = from->changes[c].before;
        HEWN_TRY(look_at_triangle(of, from->changes[c].corner / 3, i, out, error));
    }
    return add_trace(of, split->parent, i, error);
}

static hewn_result begin_traces(traces *of, progressive_hierarchy *out, hewn_error *error)
{
    const hewn_progressive *from = of->from;
    const size_t corners = 3 * from->triangle_count, marks = from->vertex_count + from->split_count;
    of->wedges = hewn_alloc(corners, sizeof *of->wedges);
    of->heads = hewn_alloc(from->vertex_count, sizeof *of->heads);
    of->stamps = hewn_alloc(marks, sizeof *of->stamps);
    out->regions = hewn_alloc(from->split_count, sizeof *out->regions);
    if (!of->wedges || !of->heads || !of->stamps || !out->regions)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for refinement");
    memset(of->heads, 0xff, from->vertex_count * sizeof *of->heads);
    memset(of->stamps, 0xff, marks * sizeof *of->stamps);
    if (corners > 0)
        memcpy(of->wedges, from->triangles, corners * sizeof *of->wedges);
    for (size_t c = 0; c < from->change_count; c++)
        of->wedges[from->changes[c].corner] = from->changes[c].after;
    return HEWN_OK;
}

/* The tree of vertices, from coarse to fine. `last` of a vertex is the last split that it took part in. */
static hewn_result make_tree(const hewn_progressive *from, progressive_hierarchy *out, hewn_error *error)
{
    uint32_t *last = hewn_alloc(from->vertex_count, sizeof *last);
    out->parents = hewn_alloc(from->split_count, sizeof *out->parents);
    out->children = hewn_alloc(from->split_count, 2 * sizeof *out->children);
    if (!last || !out->parents || !out->children) {
        hewn_free(last);
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for refinement");
    }
    memset(last, 0xff, from->vertex_count * sizeof *last);
    memset(out->children, 0xff, from->split_count * 2 * sizeof *out->children);
    for (uint32_t i = 0; i < from->split_count; i++) {
        const uint32_t vertex = from->splits[i].parent, before = last[vertex];
        out->parents[i] = before;
        if (before != HEWN_NONE)
            out->children[2 * (size_t)before + (vertex == from->base_vertices + before)] = i;
        last[vertex] = last[from->base_vertices + i] = i;
    }
    hewn_free(last);
    return HEWN_OK;
}

/* Lists by the number at `key` of each pair, of the numbers at the other place. */
static bool sort_links(const traces *of, size_t splits, size_t key, progressive_links *out)
{
    out->first = hewn_alloc_zero(splits + 2, sizeof *out->first);
    out->to = hewn_alloc(of->link_count / 2, sizeof *out->to);
    if (!out->first || !out->to)
        return false;
    for (size_t i = 0; i < of->link_count; i += 2)
        out->first[of->links[i + key] + 2]++;
    for (size_t i = 0; i < splits; i++)
        out->first[i + 2] += out->first[i + 1];
    for (size_t i = 0; i < of->link_count; i += 2)
        out->to[out->first[of->links[i + key] + 1]++] = of->links[i + 1 - key];
    return true;
}

hewn_result hewn_hierarchy_make(const hewn_progressive *from, progressive_hierarchy *out, hewn_error *error)
{
    traces of = {.from = from};
    hewn_result result = begin_traces(&of, out, error);
    if (result == HEWN_OK)
        result = make_tree(from, out, error);
    for (size_t i = from->split_count; result == HEWN_OK && i-- > 0;)
        result = fold_back(&of, (uint32_t)i, out, error);
    if (result == HEWN_OK &&
        !(sort_links(&of, from->split_count, 0, &out->above) && sort_links(&of, from->split_count, 1, &out->below)))
        result = hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for refinement");
    hewn_free(of.wedges);
    hewn_free(of.heads);
    hewn_free(of.folds);
    hewn_free(of.nexts);
    hewn_free(of.links);
    hewn_free(of.stamps);
    return result;
}
