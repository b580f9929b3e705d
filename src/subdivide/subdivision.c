#include "subdivide/subdivision.h"

#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/progress.h"
#include "subdivide/plan.h"
#include "subdivide/points.h"
#include "subdivide/tags.h"

/* --- words and defaults ------------------------------------------------------------------------------------------- */

const char *hewn_scheme_name(hewn_scheme scheme)
{
    static const char *const names[] = {"catmull-clark", "loop", "bilinear"};
    return (unsigned)scheme < HEWN_SCHEME_COUNT ? names[scheme] : NULL;
}

const char *hewn_subdivide_boundary_name(hewn_subdivide_boundary boundary)
{
    static const char *const names[] = {"edge-and-corner", "edge-only", "none"};
    return (unsigned)boundary < HEWN_BOUNDARY_COUNT ? names[boundary] : NULL;
}

const char *hewn_creasing_name(hewn_creasing creasing)
{
    static const char *const names[] = {"uniform", "chaikin"};
    return (unsigned)creasing < HEWN_CREASING_COUNT ? names[creasing] : NULL;
}

const char *hewn_uv_rule_name(hewn_uv_rule rule)
{
    static const char *const names[] = {"corners-plus1", "none", "corners-only", "corners-plus2", "boundaries", "all"};
    return (unsigned)rule < HEWN_UV_COUNT ? names[rule] : NULL;
}

hewn_subdivide_desc hewn_subdivide_desc_default(void)
{
    return (hewn_subdivide_desc){.levels = 1};
}

static hewn_result check_desc(const hewn_subdivide_desc *desc, hewn_error *error)
{
    if ((unsigned)desc->scheme >= HEWN_SCHEME_COUNT || (unsigned)desc->boundary >= HEWN_BOUNDARY_COUNT ||
        (unsigned)desc->creasing >= HEWN_CREASING_COUNT || (unsigned)desc->uv >= HEWN_UV_COUNT)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "there is no such scheme, boundary, creasing or rule for uv");
    if (desc->levels != HEWN_LEVELS_NONE && desc->levels > HEWN_MOST_LEVELS)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "levels are at most %d, not %u", HEWN_MOST_LEVELS, desc->levels);
    if (!(desc->crease_angle >= 0 && desc->crease_angle <= 180))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the angle of creases must be from 0 to 180 degrees, not %g",
                         desc->crease_angle);
    return HEWN_OK;
}

/* --- building ----------------------------------------------------------------------------------------------------- */

static hewn_result check_faces(const hewn_subdivision *sub, hewn_error *error)
{
    const sub_level *base = &sub->levels[0];
    bool needs_quads = sub->limit && sub->count == 0 && sub->masks.scheme == HEWN_SCHEME_CATMULL_CLARK;
    uint32_t wanted = sub->masks.scheme == HEWN_SCHEME_LOOP ? 3 : needs_quads ? 4 : 0;
    for (uint32_t f = 0; wanted && base->sides != wanted && f < base->faces; f++) {
        uint32_t degree = sub_face_begin(base, f + 1) - sub_face_begin(base, f);
        if (degree != wanted && needs_quads)
            return hewn_fail(error, HEWN_BAD_INPUT, "face %u has %u corners: its limit needs one level at least", f,
                             degree);
        if (degree != wanted)
            return hewn_fail(error, HEWN_BAD_INPUT, "face %u has %u corners, and Loop's scheme is for triangles", f,
                             degree);
    }
    return HEWN_OK;
}

hewn_result hewn_subdivision_grow(hewn_subdivision *sub, const hewn_subdivide_desc *desc, hewn_error *error)
{
    HEWN_TRY(check_faces(sub, error));
    HEWN_TRY(hewn_sub_plan(sub, desc->max_memory, error));
    for (uint32_t i = 0; i < sub->count; i++) {
        HEWN_TRY(hewn_progress_report(desc->progress, "subdivide", (double)i / sub->count, error));
        bool edges = i + 1 < sub->count || sub->limit;
        HEWN_TRY(hewn_sub_level_refine(&sub->levels[i], sub->masks.scheme == HEWN_SCHEME_LOOP, edges,
                                       sub->masks.creasing, &sub->levels[i + 1], error));
    }
    const sub_level *last = &sub->levels[sub->count];
    sub->first = hewn_alloc((size_t)last->faces + 1, sizeof *sub->first);
    if (!sub->first)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %u faces", last->faces);
    for (uint32_t f = 0; f <= last->faces; f++)
        sub->first[f] = f == last->faces ? last->corners : sub_face_begin(last, f);
    return HEWN_OK;
}

static hewn_result build(hewn_subdivision *sub, const hewn_polygons *polygons, const hewn_subdivide_desc *desc,
                         hewn_error *error)
{
    HEWN_TRY(hewn_sub_level_create(polygons, &sub->levels[0], error));
    HEWN_TRY(hewn_sub_tag(&sub->levels[0], polygons->positions, desc, &sub->tags, error));
    return hewn_subdivision_grow(sub, desc, error);
}

hewn_result hewn_subdivision_create(const hewn_polygons *polygons, const hewn_subdivide_desc *desc,
                                    hewn_subdivision **out, hewn_error *error)
{
    const hewn_subdivide_desc standard = {0};
    *out = NULL;
    desc = desc ? desc : &standard;
    HEWN_TRY(check_desc(desc, error));
    hewn_subdivision *sub = hewn_alloc_zero(1, sizeof *sub);
    if (!sub)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory subdividing");
    sub->count = desc->levels == HEWN_LEVELS_NONE ? 0 : desc->levels == 0 ? 1 : desc->levels;
    sub->masks = (sub_masks){desc->scheme, desc->creasing, desc->scheme == HEWN_SCHEME_BILINEAR};
    sub->limit = desc->limit;
    hewn_result result = build(sub, polygons, desc, error);
    if (result != HEWN_OK)
        hewn_subdivision_destroy(&sub);
    *out = sub;
    return result;
}

void hewn_subdivision_destroy(hewn_subdivision **subdivision)
{
    hewn_subdivision *sub = *subdivision;
    if (!sub)
        return;
    for (uint32_t i = 0; i <= HEWN_MOST_LEVELS; i++)
        hewn_sub_level_free(&sub->levels[i]);
    hewn_free(sub->first);
    hewn_free(sub);
    *subdivision = NULL;
}

/* --- reading ------------------------------------------------------------------------------------------------------ */

uint32_t hewn_subdivision_vert_count(const hewn_subdivision *subdivision)
{
    return subdivision->levels[subdivision->count].verts;
}

uint32_t hewn_subdivision_face_count(const hewn_subdivision *subdivision)
{
    return subdivision->levels[subdivision->count].faces;
}

hewn_polygons hewn_subdivision_polygons(const hewn_subdivision *subdivision)
{
    const sub_level *last = &subdivision->levels[subdivision->count];
    return (hewn_polygons){.vertex_count = last->verts,
                           .face_count = last->faces,
                           .first = last->sides == 3 ? NULL : subdivision->first,
                           .corners = last->corner_verts};
}

/* --- evaluation --------------------------------------------------------------------------------------------------- */

hewn_result hewn_subdivision_refine(const hewn_subdivision *sub, const double *control, uint32_t width, double *out,
                                    hewn_error *error)
{
    if (sub->count == 0) {
        memcpy(out, control, (size_t)sub->levels[0].verts * width * sizeof *out);
        return HEWN_OK;
    }
    /* Levels go by turns to `out` and to room for the last but one, such that the last goes to `out`. */
    double *room = sub->count > 1 ? hewn_alloc((size_t)sub->levels[sub->count - 1].verts * width, sizeof *room) : NULL;
    if (sub->count > 1 && !room)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %u vertices", sub->levels[sub->count].verts);
    const double *from = control;
    for (uint32_t i = 0; i < sub->count; i++) {
        double *to = (sub->count - i) % 2 ? out : room;
        hewn_sub_points(&sub->levels[i], sub->masks, from, width, to);
        from = to;
    }
    hewn_free(room);
    return HEWN_OK;
}

hewn_result hewn_subdivision_evaluate(const hewn_subdivision *subdivision, const double *control, uint32_t components,
                                      double *out, hewn_error *error)
{
    const sub_level *last = &subdivision->levels[subdivision->count];
    if (!subdivision->limit)
        return hewn_subdivision_refine(subdivision, control, components, out, error);
    double *room = hewn_alloc((size_t)last->verts * components, sizeof *room);
    if (!room)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %u vertices", last->verts);
    hewn_result result = hewn_subdivision_refine(subdivision, control, components, room, error);
    if (result == HEWN_OK)
        hewn_sub_limits(last, subdivision->masks, room, components, out);
    hewn_free(room);
    return result;
}

static void write_tangents(const hewn_subdivision *sub, const double *values, double *u, double *v, double *normals)
{
    const sub_level *last = &sub->levels[sub->count];
#pragma omp parallel for schedule(static)
    for (uint32_t i = 0; i < last->verts; i++) {
        double t[2][3];
        hewn_sub_tangents(last, sub->masks, values, i, t);
        double n[3] = {t[0][1] * t[1][2] - t[0][2] * t[1][1], t[0][2] * t[1][0] - t[0][0] * t[1][2],
                       t[0][0] * t[1][1] - t[0][1] * t[1][0]};
        double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        for (size_t axis = 0; axis < 3; axis++) {
            if (u)
                u[3 * (size_t)i + axis] = t[0][axis];
            if (v)
                v[3 * (size_t)i + axis] = t[1][axis];
            if (normals)
                normals[3 * (size_t)i + axis] = length > 0 ? n[axis] / length : 0;
        }
    }
}

hewn_result hewn_subdivision_limit(const hewn_subdivision *subdivision, const double *control, double *positions,
                                   double *tangents_u, double *tangents_v, double *normals, hewn_error *error)
{
    const sub_level *last = &subdivision->levels[subdivision->count];
    if (!subdivision->limit)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the subdivision was made without its limit");
    double *room = hewn_alloc(last->verts, 3 * sizeof *room);
    if (!room)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %u vertices", last->verts);
    hewn_result result = hewn_subdivision_refine(subdivision, control, 3, room, error);
    if (result == HEWN_OK && positions)
        hewn_sub_limits(last, subdivision->masks, room, 3, positions);
    if (result == HEWN_OK)
        write_tangents(subdivision, room, tangents_u, tangents_v, normals);
    hewn_free(room);
    return result;
}
