#include "mesh/build.h"

#include <math.h>
#include <string.h>

#include "base/alloc.h"

/* --- faults ------------------------------------------------------------------------------------------------------- */

static uint32_t face_of_corner(const mesh_source *source, uint32_t corner)
{
    if (!source->first)
        return corner / 3;
    uint32_t low = 0, high = source->face_count;
    while (high - low > 1) {
        uint32_t middle = low + (high - low) / 2;
        if (source->first[middle] <= corner)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* The bucket is walked once for each of its half-edges; only the first fault pays for it. */
static uint32_t count_other(const mesh_entry *entries, uint32_t count, uint32_t other, uint32_t corner[2])
{
    uint32_t found = 0;
    for (uint32_t i = 0; i < count; i++)
        if (entries[i].other == other) {
            if (found < 2)
                corner[found] = entries[i].corner;
            found++;
        }
    return found;
}

/* Lists that large buckets were sorted into have equal others side by side; small ones are short. */
static uint32_t least_twice(const mesh_entry *entries, uint32_t count, uint32_t least)
{
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t j = i + 1; j < count && (j <= i + 1 || count <= 64); j++)
            if (entries[i].other == entries[j].other && entries[i].other < least)
                least = entries[i].other;
    return least;
}

hewn_result hewn_mesh_explain_fault(const mesh_source *source, const mesh_matching *matching, hewn_error *error)
{
    uint32_t v = matching->fault, begin = v == 0 ? 0 : matching->ends[2 * (size_t)v - 1];
    const mesh_entry *up = matching->entries + begin;
    uint32_t up_count = matching->ends[2 * (size_t)v] - begin;
    const mesh_entry *down = up + up_count;
    uint32_t down_count = matching->ends[2 * (size_t)v + 1] - begin - up_count;
    uint32_t other = least_twice(down, down_count, least_twice(up, up_count, HEWN_NONE));
    uint32_t up_corner[2], down_corner[2];
    uint32_t ups = count_other(up, up_count, other, up_corner);
    uint32_t downs = count_other(down, down_count, other, down_corner);
    if (ups + downs > 2)
        return hewn_fail(error, HEWN_BAD_INPUT, "the edge between the vertices %u and %u has %u faces", v, other,
                         ups + downs);
    const uint32_t *corner = ups == 2 ? up_corner : down_corner;
    uint32_t a = face_of_corner(source, corner[0]), b = face_of_corner(source, corner[1]);
    return hewn_fail(error, HEWN_BAD_INPUT,
                     "the faces %u and %u run along the edge from vertex %u to vertex %u the same way", a < b ? a : b,
                     a < b ? b : a, ups == 2 ? v : other, ups == 2 ? other : v);
}

/* The first vertex whose faces are not all reached by turning from one to the next. */
static hewn_result explain_fans(const hewn_mesh *mesh, hewn_error *error)
{
    uint32_t *corners = hewn_alloc_zero(mesh->vert_bound, sizeof *corners);
    if (!corners)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory checking vertices");
    for (uint32_t h = 0; h < mesh->half_bound; h++)
        corners[mesh->head[h]] += mesh->face[h] != HEWN_NONE;
    uint32_t v = 0;
    for (; v < mesh->vert_bound; v++) {
        if (corners[v] == 0)
            continue;
        uint32_t first = mesh->vert_half[v], h = first, seen = 0;
        while (mesh->face[h] != HEWN_NONE && (seen == 0 || h != first)) {
            seen++;
            h = mesh_ccw(mesh, h);
        }
        if (seen == 0 || h != first)
            for (h = first ^ 1; mesh->face[h] != HEWN_NONE; h = mesh->next[h] ^ 1)
                seen++;
        if (seen != corners[v])
            break;
    }
    hewn_free(corners);
    return hewn_fail(error, HEWN_BAD_INPUT, "the faces around vertex %u form more than one fan", v);
}

/* --- arrays ------------------------------------------------------------------------------------------------------- */

static hewn_result fill_positions(const mesh_source *source, double *positions, hewn_error *error)
{
    uint32_t bad = source->vert_count;
#pragma omp parallel for schedule(static) reduction(min : bad) if (source->vert_count >= HEWN_MESH_ALONE)
    for (uint32_t v = 0; v < source->vert_count; v++) {
        double *to = positions + 3 * (size_t)v;
        for (size_t i = 0; i < 3; i++)
            to[i] = source->doubles ? source->doubles[3 * (size_t)v + i] : (double)source->floats[3 * (size_t)v + i];
        if (!isfinite(to[0]) || !isfinite(to[1]) || !isfinite(to[2]))
            bad = v < bad ? v : bad;
    }
    return bad < source->vert_count ? hewn_fail(error, HEWN_BAD_INPUT, "the position of vertex %u is not finite", bad)
                                    : HEWN_OK;
}

static hewn_result allocate_verts(const mesh_source *source, hewn_mesh *mesh, hewn_error *error)
{
    mesh->vert_half = hewn_alloc(source->vert_count, sizeof *mesh->vert_half);
    mesh->position = hewn_alloc(source->vert_count, 3 * sizeof *mesh->position);
    mesh->face_half = hewn_alloc(source->face_count, sizeof *mesh->face_half);
    if (!mesh->vert_half || !mesh->position || !mesh->face_half)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a mesh of %u faces", source->face_count);
    mesh->vert_bound = mesh->vert_capacity = mesh->live_verts = source->vert_count;
    mesh->face_bound = mesh->face_capacity = mesh->live_faces = source->face_count;
    return HEWN_OK;
}

/* The bucket entries have done their work: their pages go to one of the arrays, which is never larger. */
static hewn_result allocate_halves(mesh_matching *matching, hewn_mesh *mesh, hewn_error *error)
{
    uint32_t edges = matching->edges[matching->parts];
    if (edges > MESH_MOST_IDS / 2)
        return hewn_fail(error, HEWN_LIMIT, "the mesh has %u edges, more than there are ids", edges);
    size_t count = 2 * (size_t)edges;
    hewn_free(matching->ends);
    matching->ends = NULL;
    mesh->next = hewn_realloc(matching->entries, count, sizeof *mesh->next);
    if (mesh->next)
        matching->entries = NULL;
    mesh->head = hewn_alloc(count, sizeof *mesh->head);
    mesh->prev = hewn_alloc(count, sizeof *mesh->prev);
    mesh->face = hewn_alloc(count, sizeof *mesh->face);
    if (!mesh->head || !mesh->next || !mesh->prev || !mesh->face)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a mesh of %u edges", edges);
    mesh->half_bound = mesh->half_capacity = (uint32_t)count;
    mesh->live_edges = edges;
    if (matching->open_edges > 0)
        memset(mesh->face, 0xFF, count * sizeof *mesh->face);
    return HEWN_OK;
}

/* --- links -------------------------------------------------------------------------------------------------------- */

/* The half-edge of a corner, counted from the first of all; its place in `halves` is brought up to date. */
static inline uint32_t settle_half(mesh_matching *matching, uint32_t tail, uint32_t head, uint32_t corner)
{
    uint32_t least = tail < head ? tail : head, part = 0;
    while (least >= matching->range[part + 1])
        part++;
    return matching->halves[corner] += 2 * matching->edges[part];
}

static void fill_triangle(const mesh_source *source, mesh_matching *matching, hewn_mesh *mesh, uint32_t f)
{
    uint32_t begin = 3 * f;
    const uint32_t *corner = source->corners + begin;
    uint32_t a = settle_half(matching, corner[0], corner[1], begin);
    uint32_t b = settle_half(matching, corner[1], corner[2], begin + 1);
    uint32_t c = settle_half(matching, corner[2], corner[0], begin + 2);
    mesh->head[a] = corner[1];
    mesh->head[b] = corner[2];
    mesh->head[c] = corner[0];
    mesh->face[a] = mesh->face[b] = mesh->face[c] = f;
    mesh->next[a] = mesh->prev[c] = b;
    mesh->next[b] = mesh->prev[a] = c;
    mesh->next[c] = mesh->prev[b] = a;
    mesh->face_half[f] = c;
}

static void fill_polygon(const mesh_source *source, mesh_matching *matching, hewn_mesh *mesh, uint32_t f)
{
    uint32_t begin = mesh_source_begin(source, f), last = mesh_source_begin(source, f + 1) - 1;
    const uint32_t *corners = source->corners;
    uint32_t before = settle_half(matching, corners[last], corners[begin], last);
    mesh->face_half[f] = before;
    for (uint32_t i = begin; i <= last; i++) {
        uint32_t head = corners[i < last ? i + 1 : begin];
        uint32_t h = i < last ? settle_half(matching, corners[i], head, i) : mesh->face_half[f];
        mesh->head[h] = head;
        mesh->face[h] = f;
        mesh_link(mesh, before, h);
        before = h;
    }
}

static void fill_faces(const mesh_source *source, mesh_matching *matching, hewn_mesh *mesh)
{
#pragma omp parallel for schedule(static) if (source->face_count >= HEWN_MESH_ALONE)
    for (uint32_t f = 0; f < source->face_count; f++) {
        if (source->first)
            fill_polygon(source, matching, mesh, f);
        else
            fill_triangle(source, matching, mesh, f);
    }
}

/* Completes and links the half-edges without face. False where two leave one vertex. */
static bool link_boundary(hewn_mesh *mesh)
{
    for (uint32_t h = 0; h < mesh->half_bound; h++) {
        if (mesh->face[h] != HEWN_NONE)
            continue;
        uint32_t tail = mesh->head[h ^ 1];
        mesh->head[h] = mesh->head[mesh->prev[h ^ 1]];
        if (mesh->face[mesh->vert_half[tail]] == HEWN_NONE)
            return false;
        mesh->vert_half[tail] = h;
    }
    for (uint32_t h = 0; h < mesh->half_bound; h++)
        if (mesh->face[h] == HEWN_NONE)
            mesh_link(mesh, h, mesh->vert_half[mesh->head[h]]);
    return true;
}

/* Heads of half-edges without face are needed by explain_fans() even where linking stopped early. */
static void complete_heads(hewn_mesh *mesh)
{
    for (uint32_t h = 0; h < mesh->half_bound; h++)
        if (mesh->face[h] == HEWN_NONE)
            mesh->head[h] = mesh->head[mesh->prev[h ^ 1]];
}

/* Every half-edge leaves one vertex; if the rings around the vertices' own half-edges have them all, no vertex has a
 * second ring. */
static bool rings_are_whole(const hewn_mesh *mesh)
{
    uint64_t reached = 0;
#pragma omp parallel for schedule(static) reduction(+ : reached) if (mesh->vert_bound >= HEWN_MESH_ALONE)
    for (uint32_t v = 0; v < mesh->vert_bound; v++) {
        uint32_t first = mesh->vert_half[v], h = first;
        if (first == HEWN_NONE)
            continue;
        do {
            reached++;
            h = mesh_ccw(mesh, h);
        } while (h != first);
    }
    return reached == mesh->half_bound;
}

static hewn_result link_verts(const mesh_matching *matching, hewn_mesh *mesh, hewn_error *error)
{
#pragma omp parallel for schedule(static) if (mesh->vert_bound >= HEWN_MESH_ALONE)
    for (uint32_t v = 0; v < mesh->vert_bound; v++)
        if (mesh->vert_half[v] != HEWN_NONE)
            mesh->vert_half[v] = matching->halves[mesh->vert_half[v]];
    if (matching->open_edges > 0 && !link_boundary(mesh)) {
        complete_heads(mesh);
        return explain_fans(mesh, error);
    }
    return rings_are_whole(mesh) ? HEWN_OK : explain_fans(mesh, error);
}

/* --- together ----------------------------------------------------------------------------------------------------- */

static hewn_result build_edges(const mesh_source *source, mesh_matching *matching, hewn_mesh *mesh, hewn_error *error)
{
    if (matching->fault != HEWN_NONE)
        return hewn_mesh_explain_fault(source, matching, error);
    HEWN_TRY(allocate_halves(matching, mesh, error));
    fill_faces(source, matching, mesh);
    return link_verts(matching, mesh, error);
}

static hewn_result build(const mesh_source *source, hewn_mesh *mesh, hewn_error *error)
{
    mesh_matching matching;
    HEWN_TRY(hewn_mesh_check_faces(source, error));
    HEWN_TRY(allocate_verts(source, mesh, error));
    HEWN_TRY(fill_positions(source, mesh->position, error));
    HEWN_TRY(hewn_mesh_match(source, mesh->vert_half, &matching, error));
    hewn_result result = build_edges(source, &matching, mesh, error);
    hewn_mesh_matching_free(&matching);
    return result;
}

static hewn_result from_source(const mesh_source *source, hewn_mesh **out, hewn_error *error)
{
    HEWN_TRY(hewn_mesh_create(out, error));
    hewn_result result = build(source, *out, error);
    if (result != HEWN_OK)
        hewn_mesh_destroy(out);
    return result;
}

static hewn_result check_sizes(uint64_t verts, uint64_t faces, uint64_t corners, hewn_error *error)
{
    if (verts > MESH_MOST_IDS || faces > MESH_MOST_IDS || corners > MESH_MOST_IDS)
        return hewn_fail(error, HEWN_LIMIT, "%llu vertices, %llu faces and %llu corners are more than there are ids",
                         (unsigned long long)verts, (unsigned long long)faces, (unsigned long long)corners);
    return HEWN_OK;
}

hewn_result hewn_mesh_from_polygons(const hewn_polygons *polygons, hewn_mesh **out, hewn_error *error)
{
    *out = NULL;
    const uint64_t *first = polygons->first;
    if ((polygons->vertex_count > 0 && !polygons->positions) || (polygons->face_count > 0 && !polygons->corners))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "polygons without positions or corners");
    if (first && first[0] != 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the corners of the first face must begin at 0");
    uint64_t triangles = polygons->face_count > MESH_MOST_IDS ? MESH_MOST_IDS : polygons->face_count;
    uint64_t corners = first ? first[polygons->face_count] : 3 * triangles;
    HEWN_TRY(check_sizes(polygons->vertex_count, polygons->face_count, corners, error));
    mesh_source source = {.vert_count = (uint32_t)polygons->vertex_count,
                          .face_count = (uint32_t)polygons->face_count,
                          .corner_count = (uint32_t)corners,
                          .doubles = polygons->positions,
                          .first = first,
                          .corners = polygons->corners};
    return from_source(&source, out, error);
}

static hewn_result add_normals(hewn_mesh *mesh, const float *normals, hewn_error *error)
{
    uint32_t attribute;
    const hewn_attribute_info info = {"normal", HEWN_DOMAIN_VERT, HEWN_SCALAR_FLOAT, 3};
    HEWN_TRY(hewn_mesh_add_attribute(mesh, &info, &attribute, error));
    memcpy(mesh->attributes[attribute].data, normals, mesh->vert_bound * 3 * sizeof *normals);
    return HEWN_OK;
}

hewn_result hewn_mesh_from_triangles(const hewn_triangles *triangles, hewn_mesh **out, hewn_error *error)
{
    *out = NULL;
    if ((triangles->vertex_count > 0 && !triangles->positions) ||
        (triangles->triangle_count > 0 && !triangles->indices))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "triangles without positions or indices");
    uint64_t count = triangles->triangle_count > MESH_MOST_IDS ? MESH_MOST_IDS : triangles->triangle_count;
    HEWN_TRY(check_sizes(triangles->vertex_count, triangles->triangle_count, 3 * count, error));
    mesh_source source = {.vert_count = (uint32_t)triangles->vertex_count,
                          .face_count = (uint32_t)count,
                          .corner_count = 3 * (uint32_t)count,
                          .floats = triangles->positions,
                          .corners = triangles->indices};
    HEWN_TRY(from_source(&source, out, error));
    if (!triangles->normals || triangles->vertex_count == 0)
        return HEWN_OK;
    hewn_result result = add_normals(*out, triangles->normals, error);
    if (result != HEWN_OK)
        hewn_mesh_destroy(out);
    return result;
}
