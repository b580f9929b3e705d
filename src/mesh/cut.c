#include "mesh/cut.h"

#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/progress.h"
#include "mesh/ears.h"
#include "mesh/plane.h"

/* Corners cut between two looks at the progress callback. */
enum { SLICE = 1 << 18 };

typedef struct cutter {
    const hewn_polygons *soup;
    uint64_t corner_count;
    uint32_t most_corners; /* of a face */
    /* The edges that a diagonal might double: those between corners of polygons, in a list at the end that has fewer
     * corners. Neighbours in the soup are neighbours here, which a hash would tear apart. */
    uint32_t *degrees; /* corners at each vertex, 0 where no polygon is */
    uint32_t *heads;
    struct edge_node {
        uint32_t other, next;
    } * nodes;
    uint64_t node_count;
    /* The face at work. */
    uint64_t begin;
    const double **points;
    double *plane;
    uint32_t *order, *next, *prev;
    uint32_t *out; /* where the next triangle goes */
} cutter;

static uint64_t face_begin(const hewn_polygons *soup, uint64_t face)
{
    return soup->first ? soup->first[face] : 3 * face;
}

static uint64_t face_length(const hewn_polygons *soup, uint64_t face)
{
    return face_begin(soup, face + 1) - face_begin(soup, face);
}

/* --- input -------------------------------------------------------------------------------------------------------- */

static hewn_result check_soup(const hewn_polygons *soup, hewn_error *error)
{
    uint64_t faces = soup->face_count;
    if ((soup->vertex_count > 0 && !soup->positions) || (faces > 0 && !soup->corners))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "polygons without positions or corners");
    if (soup->vertex_count > UINT32_MAX || faces > UINT32_MAX)
        return hewn_fail(error, HEWN_LIMIT, "%llu vertices and %llu faces are more than can be cut",
                         (unsigned long long)soup->vertex_count, (unsigned long long)faces);
    for (uint64_t f = 0; f < faces && soup->first; f++)
        if (soup->first[f] > soup->first[f + 1] || soup->first[0] != 0)
            return hewn_fail(error, HEWN_BAD_INPUT, "face %llu does not begin where the one before it ends",
                             (unsigned long long)f);
    uint64_t corners = face_begin(soup, faces);
    if (corners > UINT32_MAX)
        return hewn_fail(error, HEWN_LIMIT, "faces with %llu corners are more than can be cut",
                         (unsigned long long)corners);
    for (uint64_t c = 0; c < corners; c++)
        if (soup->corners[c] >= soup->vertex_count)
            return hewn_fail(error, HEWN_BAD_INPUT, "corner %llu names vertex %u, but there are %llu",
                             (unsigned long long)c, soup->corners[c], (unsigned long long)soup->vertex_count);
    return HEWN_OK;
}

/* --- edges that are taken ----------------------------------------------------------------------------------------- */

/* The end whose list has an edge; walks are short, as one end of most edges has few corners. */
static uint32_t keeper(const cutter *cut, uint32_t a, uint32_t b)
{
    if (cut->degrees[a] != cut->degrees[b])
        return cut->degrees[a] < cut->degrees[b] ? a : b;
    return a < b ? a : b;
}

static bool has_edge(const cutter *cut, uint32_t a, uint32_t b)
{
    uint32_t keep = keeper(cut, a, b), other = a == keep ? b : a, at = cut->heads[keep];
    while (at != HEWN_NONE && cut->nodes[at].other != other)
        at = cut->nodes[at].next;
    return at != HEWN_NONE;
}

static void add_edge(cutter *cut, uint32_t a, uint32_t b)
{
    if (has_edge(cut, a, b))
        return;
    uint32_t keep = keeper(cut, a, b), at = (uint32_t)cut->node_count++;
    cut->nodes[at].other = a == keep ? b : a;
    cut->nodes[at].next = cut->heads[keep];
    cut->heads[keep] = at;
}

/* Finds the degrees, and how many edges there may be at most: diagonals, and sides between corners of polygons. */
static uint64_t find_degrees(cutter *cut)
{
    const hewn_polygons *soup = cut->soup;
    uint64_t edges = 0;
    for (uint64_t f = 0; f < soup->face_count; f++) {
        uint64_t begin = face_begin(soup, f), length = face_length(soup, f);
        for (uint64_t i = 0; i < length && length > 3; i++)
            cut->degrees[soup->corners[begin + i]] = 1;
        edges += length > 3 ? length - 3 : 0;
    }
    for (uint64_t f = 0; f < soup->face_count; f++) {
        const uint32_t *corners = soup->corners + face_begin(soup, f);
        uint64_t length = face_length(soup, f);
        for (uint64_t i = 0; i < length; i++) {
            bool near = cut->degrees[corners[i]] > 0;
            edges += near && cut->degrees[corners[i + 1 < length ? i + 1 : 0]] > 0;
            cut->degrees[corners[i]] += near;
        }
    }
    return edges;
}

static hewn_result note_edges(cutter *cut, hewn_error *error)
{
    const hewn_polygons *soup = cut->soup;
    cut->degrees = hewn_alloc_zero(soup->vertex_count, sizeof *cut->degrees);
    cut->heads = hewn_alloc(soup->vertex_count, sizeof *cut->heads);
    uint64_t edges = cut->degrees && cut->heads ? find_degrees(cut) : 0;
    if (edges >= HEWN_NONE)
        return hewn_fail(error, HEWN_LIMIT, "%llu edges are more than can be told apart", (unsigned long long)edges);
    cut->nodes = hewn_alloc(edges, sizeof *cut->nodes);
    if (!cut->degrees || !cut->heads || !cut->nodes)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the edges of %llu faces",
                         (unsigned long long)soup->face_count);
    memset(cut->heads, 0xFF, soup->vertex_count * sizeof *cut->heads);
    for (uint64_t f = 0; f < soup->face_count; f++) {
        const uint32_t *corners = soup->corners + face_begin(soup, f);
        uint64_t length = face_length(soup, f);
        for (uint64_t i = 0; i < length; i++) {
            uint32_t a = corners[i], b = corners[i + 1 < length ? i + 1 : 0];
            if (cut->degrees[a] > 0 && cut->degrees[b] > 0)
                add_edge(cut, a, b);
        }
    }
    return HEWN_OK;
}

/* --- cutting ------------------------------------------------------------------------------------------------------ */

static bool may_join(const void *user, uint32_t a, uint32_t b)
{
    const cutter *cut = user;
    const uint32_t *corners = cut->soup->corners + cut->begin;
    return !has_edge(cut, corners[a], corners[b]);
}

static void emit(cutter *cut, uint32_t a, uint32_t b, uint32_t c)
{
    *cut->out++ = (uint32_t)cut->begin + a;
    *cut->out++ = (uint32_t)cut->begin + b;
    *cut->out++ = (uint32_t)cut->begin + c;
}

static void add_diagonal(cutter *cut, uint32_t a, uint32_t b)
{
    const uint32_t *corners = cut->soup->corners + cut->begin;
    add_edge(cut, corners[a], corners[b]);
}

static void emit_fan(cutter *cut, uint32_t count)
{
    for (uint32_t i = 1; i + 1 < count; i++) {
        emit(cut, 0, i, i + 1);
        if (i > 1)
            add_diagonal(cut, 0, i);
    }
}

static void emit_ears(cutter *cut, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        cut->next[i] = i + 1 < count ? i + 1 : 0;
        cut->prev[i] = i > 0 ? i - 1 : count - 1;
    }
    uint32_t left = 0;
    for (uint32_t i = 0; i + 3 < count; i++) {
        uint32_t ear = cut->order[i], before = cut->prev[ear], after = cut->next[ear];
        emit(cut, before, ear, after);
        add_diagonal(cut, before, after);
        cut->next[before] = after;
        cut->prev[after] = before;
        left = after;
    }
    emit(cut, cut->prev[left], left, cut->next[left]);
}

/* Points at the corners; false where one is not finite. */
static bool point_at_corners(cutter *cut, uint32_t count)
{
    bool finite = true;
    for (uint32_t i = 0; i < count; i++) {
        const double *p = cut->soup->positions + 3 * (size_t)cut->soup->corners[cut->begin + i];
        cut->points[i] = p;
        finite = finite && isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]);
    }
    return finite;
}

static void cut_quad(cutter *cut)
{
    uint32_t from = hewn_quad_cut(cut->plane, may_join, cut);
    if (from > 1)
        from = hewn_quad_cut(cut->plane, NULL, NULL);
    emit(cut, 0, 1, from == 0 ? 2 : 3);
    emit(cut, from, 2, 3);
    add_diagonal(cut, from, from + 2);
}

static hewn_result cut_face(cutter *cut, uint32_t count, hewn_error *error)
{
    if (count == 3)
        emit(cut, 0, 1, 2);
    if (count <= 3)
        return HEWN_OK;
    if (!point_at_corners(cut, count)) {
        emit_fan(cut, count);
        return HEWN_OK;
    }
    hewn_plane_project(cut->points, count, count, cut->plane);
    if (count == 4) {
        cut_quad(cut);
        return HEWN_OK;
    }
    bool found;
    HEWN_TRY(hewn_ears_cut(cut->plane, count, may_join, cut, cut->order, &found, error));
    if (!found)
        HEWN_TRY(hewn_ears_cut(cut->plane, count, NULL, NULL, cut->order, &found, error));
    if (found)
        emit_ears(cut, count);
    else
        emit_fan(cut, count);
    return HEWN_OK;
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

static hewn_result make_room(cutter *cut, uint32_t **triangles, uint64_t *count, hewn_error *error)
{
    for (uint64_t f = 0; f < cut->soup->face_count; f++) {
        uint64_t length = face_length(cut->soup, f);
        *count += length > 2 ? length - 2 : 0;
        cut->most_corners = length > cut->most_corners ? (uint32_t)length : cut->most_corners;
    }
    size_t most = cut->most_corners;
    *triangles = hewn_alloc(*count, 3 * sizeof **triangles);
    cut->points = hewn_alloc(most, sizeof *cut->points);
    cut->plane = hewn_alloc(most, 2 * sizeof *cut->plane);
    cut->order = hewn_alloc(most, sizeof *cut->order);
    cut->next = hewn_alloc(most, sizeof *cut->next);
    cut->prev = hewn_alloc(most, sizeof *cut->prev);
    if (!*triangles || !cut->points || !cut->plane || !cut->order || !cut->next || !cut->prev)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %llu triangles", (unsigned long long)*count);
    cut->out = *triangles;
    return HEWN_OK;
}

static hewn_result cut_faces(cutter *cut, const hewn_progress *progress, hewn_error *error)
{
    const hewn_polygons *soup = cut->soup;
    if (cut->most_corners > 3)
        HEWN_TRY(note_edges(cut, error));
    uint64_t reported = 0;
    for (uint64_t f = 0; f < soup->face_count; f++) {
        cut->begin = face_begin(soup, f);
        HEWN_TRY(cut_face(cut, (uint32_t)face_length(soup, f), error));
        if (cut->begin < reported + SLICE)
            continue;
        reported = cut->begin;
        HEWN_TRY(hewn_progress_report(progress, "triangulate", (double)reported / (double)cut->corner_count, error));
    }
    return hewn_progress_report(progress, "triangulate", 1, error);
}

hewn_result hewn_cut_polygons(const hewn_polygons *polygons, uint32_t **triangle_corners, uint64_t *triangle_count,
                              const hewn_progress *progress, hewn_error *error)
{
    *triangle_corners = NULL;
    *triangle_count = 0;
    HEWN_TRY(check_soup(polygons, error));
    cutter cut = {.soup = polygons, .corner_count = face_begin(polygons, polygons->face_count)};
    uint32_t *triangles = NULL;
    uint64_t count = 0;
    hewn_result result = make_room(&cut, &triangles, &count, error);
    if (result == HEWN_OK)
        result = cut_faces(&cut, progress, error);
    hewn_free(cut.degrees);
    hewn_free(cut.heads);
    hewn_free(cut.nodes);
    hewn_free(cut.points);
    hewn_free(cut.plane);
    hewn_free(cut.order);
    hewn_free(cut.next);
    hewn_free(cut.prev);
    if (result == HEWN_OK) {
        *triangle_corners = triangles;
        *triangle_count = count;
    } else {
        hewn_free(triangles);
    }
    return result;
}
