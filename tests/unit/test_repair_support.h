/* Shared by the tests of repair: soups that grow, and a repair whose every result is checked. */
#ifndef HEWN_TEST_REPAIR_SUPPORT_H
#define HEWN_TEST_REPAIR_SUPPORT_H

#include "hewn/check.h"
#include "hewn/repair.h"
#include "test_mesh_support.h"

/* A soup made piece by piece. Plenty of room is taken at once. */
typedef struct builder {
    hewn_polygons polygons;
    double *positions;
    uint64_t *first;
    uint32_t *corners;
} builder;

static inline builder make_builder(size_t vertices, size_t faces, size_t corners)
{
    builder made = {.positions = hewn_alloc_zero(vertices, 3 * sizeof(double)),
                    .first = hewn_alloc_zero(faces + 1, sizeof(uint64_t)),
                    .corners = hewn_alloc_zero(corners, sizeof(uint32_t))};
    assert_true(made.positions && made.first && made.corners);
    made.polygons = (hewn_polygons){0, made.positions, 0, made.first, made.corners};
    return made;
}

static inline void free_builder(builder *made)
{
    hewn_free(made->positions);
    hewn_free(made->first);
    hewn_free(made->corners);
}

static inline uint32_t add_vertex(builder *to, double x, double y, double z)
{
    double *p = to->positions + 3 * to->polygons.vertex_count;
    p[0] = x;
    p[1] = y;
    p[2] = z;
    return (uint32_t)to->polygons.vertex_count++;
}

static inline void add_face(builder *to, uint32_t count, const uint32_t *corners)
{
    uint64_t at = to->first[to->polygons.face_count];
    for (uint32_t i = 0; i < count; i++)
        to->corners[at + i] = corners[i];
    to->first[++to->polygons.face_count] = at + count;
}

static inline void add_triangle(builder *to, uint32_t a, uint32_t b, uint32_t c)
{
    add_face(to, 3, (uint32_t[]){a, b, c});
}

/* The unit cube at a corner, of quads, over vertices of its own; `without` is a side to leave out (6: none). Sides: -x,
 * x, -y, y, -z, z. */
static inline void add_cube(builder *to, double x, double y, double z, int without)
{
    static const uint32_t sides[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                         {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    uint32_t base = (uint32_t)to->polygons.vertex_count;
    for (uint32_t v = 0; v < 8; v++)
        add_vertex(to, x + (v & 1), y + (v >> 1 & 1), z + (v >> 2 & 1));
    for (int s = 0; s < 6; s++) {
        uint32_t corners[4];
        for (int k = 0; k < 4; k++)
            corners[k] = base + sides[s][k];
        if (s != without)
            add_face(to, 4, corners);
    }
}

static inline void turn_face(builder *soup, uint64_t face)
{
    uint64_t a = soup->first[face], b = soup->first[face + 1];
    while (a + 1 < b) {
        uint32_t kept = soup->corners[a];
        soup->corners[a++] = soup->corners[--b];
        soup->corners[b] = kept;
    }
}

static inline builder copy_triangles(const hewn_triangles *mesh)
{
    builder made = make_builder(mesh->vertex_count + 1, mesh->triangle_count + 1, 3 * mesh->triangle_count + 1);
    for (uint64_t v = 0; v < mesh->vertex_count; v++)
        add_vertex(&made, (double)mesh->positions[3 * v], (double)mesh->positions[3 * v + 1],
                   (double)mesh->positions[3 * v + 2]);
    for (uint64_t t = 0; t < mesh->triangle_count; t++)
        add_face(&made, 3, mesh->indices + 3 * t);
    return made;
}

typedef struct repaired {
    hewn_mesh *mesh;
    hewn_repair_report report;
    hewn_repair_origins origins;
    hewn_certificate certificate;
} repaired;

static inline void free_repaired(repaired *result)
{
    hewn_mesh_destroy(&result->mesh);
    hewn_repair_origins_destroy(&result->origins);
}

/* The result as a soup again; positions are the caller's to free. */
static inline hewn_polygons polygons_of(const repaired *result, double **positions)
{
    const hewn_repair_origins *o = &result->origins;
    *positions = hewn_alloc(o->vertex_count, 3 * sizeof(double));
    assert_non_null(*positions);
    for (uint32_t v = 0; v < o->vertex_count; v++)
        memcpy(*positions + 3 * (size_t)v, hewn_vert_position(result->mesh, (hewn_vert){v}), 3 * sizeof(double));
    return (hewn_polygons){o->vertex_count, *positions, o->face_count, o->first, o->corners};
}

/* Every element must lie where its origin does. */
static inline void check_origins(const hewn_polygons *soup, const repaired *result, bool welded)
{
    const hewn_repair_origins *o = &result->origins;
    assert_int_equal(o->vertex_count, hewn_mesh_vert_count(result->mesh));
    assert_int_equal(o->face_count, hewn_mesh_face_count(result->mesh));
    for (uint32_t v = 0; v < o->vertex_count; v++) {
        if (o->vertex_origins[v] == HEWN_NONE)
            continue;
        assert_true(o->vertex_origins[v] < soup->vertex_count);
        assert_memory_equal(hewn_vert_position(result->mesh, (hewn_vert){v}),
                            soup->positions + 3 * (size_t)o->vertex_origins[v], 3 * sizeof(double));
    }
    for (uint32_t f = 0; f < o->face_count; f++) {
        uint32_t face = o->face_origins[f];
        assert_int_equal(hewn_face_degree(result->mesh, (hewn_face){f}), o->first[f + 1] - o->first[f]);
        for (uint64_t c = o->first[f]; c < o->first[f + 1]; c++) {
            uint32_t corner = o->corner_origins[c];
            assert_int_equal(corner == HEWN_NONE, face == HEWN_NONE);
            if (corner == HEWN_NONE)
                continue;
            assert_true(soup->first ? corner >= soup->first[face] && corner < soup->first[face + 1]
                                    : corner / 3 == face);
            assert_true(welded || soup->corners[corner] == o->vertex_origins[o->corners[c]]);
        }
    }
}

/* Repairs, and checks what every result must have. */
static inline repaired repair(const hewn_polygons *soup, const hewn_repair_desc *desc)
{
    repaired result;
    hewn_error error = {0};
    if (hewn_mesh_from_soup(soup, desc, &result.mesh, &result.report, &result.origins, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    if (hewn_mesh_validate(result.mesh, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    check_origins(soup, &result, desc && desc->weld);
    double *positions;
    hewn_polygons polygons = polygons_of(&result, &positions);
    hewn_check *check;
    if (hewn_check_polygons(&polygons, &(hewn_check_desc){.skip_self_intersections = true}, &check, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    result.certificate = check->certificate;
    hewn_check_destroy(&check);
    hewn_free(positions);
    assert_true(result.certificate.manifold);
    assert_true(result.certificate.oriented);
    return result;
}

/* The same once more must find nothing to do and give the same mesh. */
static inline void check_idempotent(const repaired *once, const hewn_repair_desc *desc)
{
    double *positions;
    hewn_polygons soup = polygons_of(once, &positions);
    repaired twice = repair(&soup, desc);
    hewn_repair_report none = {.kept_holes = twice.report.kept_holes};
    assert_memory_equal(&twice.report, &none, sizeof none);
    assert_int_equal(twice.origins.vertex_count, soup.vertex_count);
    assert_int_equal(twice.origins.face_count, soup.face_count);
    assert_memory_equal(twice.origins.first, soup.first, (soup.face_count + 1) * sizeof *soup.first);
    assert_memory_equal(twice.origins.corners, soup.corners, soup.first[soup.face_count] * sizeof *soup.corners);
    free_repaired(&twice);
    hewn_free(positions);
}

/* Repairs and frees the soup. */
static inline repaired take(builder soup, const hewn_repair_desc *desc)
{
    repaired result = repair(&soup.polygons, desc);
    free_builder(&soup);
    return result;
}

static inline void assert_refused(const hewn_polygons *soup, const hewn_repair_desc *desc, hewn_result code,
                                  const char *part)
{
    hewn_mesh *mesh = (hewn_mesh *)&code;
    hewn_error error = {0};
    hewn_repair_origins origins = {.face_count = 1};
    hewn_result result = hewn_mesh_from_soup(soup, desc, &mesh, NULL, &origins, &error);
    if (result != code || !strstr(error.message, part))
        fail_msg("result %d, \"%s\" (not \"%s\")", result, error.message, part);
    assert_null(mesh);
    assert_int_equal(origins.face_count, 0);
    assert_null(origins.first);
}

#endif
