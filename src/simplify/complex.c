#include "simplify/complex.h"

#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "simplify/run.h"
#include "simplify/work.h"

/* A complex cut along its curves: each fan of a vertex is a vertex of its own. */
typedef struct fans {
    uint64_t count;
    double *positions;
    uint32_t *corners;
    uint32_t *groups; /* of each vertex: that of the complex */
} fans;

static void release(fans *cut)
{
    hewn_free(cut->positions);
    hewn_free(cut->corners);
    hewn_free(cut->groups);
}

static uint32_t root_of(uint32_t *parent, uint32_t corner)
{
    while (parent[corner] != corner)
        corner = parent[corner] = parent[parent[corner]];
    return corner;
}

static void join(uint32_t *parent, uint32_t a, uint32_t b)
{
    a = root_of(parent, a);
    b = root_of(parent, b);
    parent[a > b ? a : b] = a > b ? b : a;
}

/* Corners that are joined across edges with a twin are one vertex. `parent` has an entry a corner of `work`. */
static void join_corners(const simplify_work *work, uint32_t *parent)
{
    const uint32_t halves = 3 * work->face_count;
    for (uint32_t h = 0; h < halves; h++)
        parent[h] = h;
    for (uint32_t h = 0; h < halves; h++)
        if (work->twin[h] != HEWN_NONE && work->twin[h] > h) {
            join(parent, h, simplify_next(work->twin[h]));
            join(parent, simplify_next(h), work->twin[h]);
        }
}

/* Numbers fans by their first corners. Corners of faces that `work` left out are zeroes, three of one vertex, which it
 * leaves out again. */
static hewn_result number_fans(const simplify_work *work, const hewn_polygons *triangles, uint32_t *parent, fans *cut,
                               hewn_error *error)
{
    const uint32_t halves = 3 * work->face_count;
    cut->groups = hewn_alloc((size_t)halves + 1, sizeof *cut->groups);
    cut->corners = hewn_alloc_zero(triangles->face_count, 3 * sizeof *cut->corners);
    if (!cut->groups || !cut->corners)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
    join_corners(work, parent);
    for (uint32_t h = 0; h < halves; h++) {
        const uint32_t root = root_of(parent, h);
        uint32_t *to = cut->corners + 3 * (size_t)work->face_origins[h / 3] + h % 3;
        if (root == h) {
            cut->groups[cut->count] = work->tail[h];
            *to = (uint32_t)cut->count++;
        } else {
            *to = cut->corners[3 * (size_t)work->face_origins[root / 3] + root % 3];
        }
    }
    cut->positions = hewn_alloc(cut->count, 3 * sizeof *cut->positions);
    if (!cut->positions)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
    for (uint64_t v = 0; v < cut->count; v++)
        memcpy(cut->positions + 3 * v, triangles->positions + 3 * (size_t)cut->groups[v], 3 * sizeof *cut->positions);
    return HEWN_OK;
}

static hewn_result cut_fans(const hewn_polygons *triangles, fans *cut, hewn_error *error)
{
    static const hewn_simplify_desc none;
    simplify_work work = {.desc = &none};
    hewn_result result = hewn_simplify_build(&work, triangles, error);
    uint32_t *parent = result == HEWN_OK ? hewn_alloc(work.face_count, 3 * sizeof *parent) : NULL;
    if (result == HEWN_OK)
        result = parent ? number_fans(&work, triangles, parent, cut, error)
                        : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
    hewn_free(parent);
    hewn_simplify_release(&work);
    return result;
}

/* Fans of one vertex become one again; they are in the same place to the bit. */
static hewn_result join_fans(const fans *cut, uint64_t vertices, hewn_simplified *mesh, hewn_error *error)
{
    uint32_t *number = hewn_alloc(vertices, sizeof *number), *place = hewn_alloc(mesh->vertex_count, sizeof *place);
    uint32_t count = 0;
    hewn_result result = number && place ? HEWN_OK : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
    if (result == HEWN_OK)
        memset(number, 0xFF, vertices * sizeof *number);
    for (uint64_t v = 0; v < mesh->vertex_count && result == HEWN_OK; v++) {
        const uint32_t group = cut->groups[mesh->vertex_origins[v]];
        if (number[group] == HEWN_NONE) {
            memmove(mesh->positions + 3 * (size_t)count, mesh->positions + 3 * v, 3 * sizeof *mesh->positions);
            mesh->vertex_origins[count] = group;
            number[group] = count++;
        }
        place[v] = number[group];
    }
    for (uint64_t c = 0; c < 3 * mesh->face_count && result == HEWN_OK; c++)
        mesh->corners[c] = place[mesh->corners[c]];
    if (result == HEWN_OK)
        mesh->vertex_count = count;
    hewn_free(number);
    hewn_free(place);
    return result;
}

hewn_result hewn_complex_simplify(const hewn_polygons *triangles, const hewn_simplify_desc *desc, hewn_simplified *out,
                                  hewn_simplify_report *report, hewn_error *error)
{
    fans cut = {0};
    simplify_result result = {0};
    *out = (hewn_simplified){0};
    if (triangles->first)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a complex has triangles only");
    if (desc && desc->no_self_intersections)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "self-intersections of a complex are not looked for");
    HEWN_TRY(hewn_simplify_check_polygons(triangles, error));
    if (3 * triangles->face_count >= SIMPLIFY_GONE)
        return hewn_fail(error, HEWN_LIMIT, "too many triangles to simplify: %llu",
                         (unsigned long long)triangles->face_count);
    hewn_result done = cut_fans(triangles, &cut, error);
    if (done == HEWN_OK) {
        const hewn_polygons fans_only = {.vertex_count = cut.count,
                                         .positions = cut.positions,
                                         .face_count = cut.count > 0 ? triangles->face_count : 0,
                                         .corners = cut.corners};
        hewn_simplify_desc own = desc ? *desc : (hewn_simplify_desc){0};
        own.labels = NULL;
        own.lock_labels = false;
        own.frozen = NULL;
        done = hewn_simplify_polygons(&fans_only, &own, NULL, cut.groups, &result, report, error);
    }
    if (done == HEWN_OK)
        done = join_fans(&cut, triangles->vertex_count, &result.mesh, error);
    if (done == HEWN_OK) {
        *out = result.mesh;
        result.mesh = (hewn_simplified){0};
    }
    hewn_simplify_result_release(&result);
    release(&cut);
    return done;
}
