/* Shared by the tests of the half-edge mesh: meshes to start from, attributes that say what they should be, and checks.
 *
 * Three attributes follow positions exactly: "place" (vertices) and "spot" (corners) are doubles equal to the position,
 * "tint" a float colour of both. Operations blend linearly, so they stay equal whatever is done. */
#ifndef HEWN_TEST_MESH_HALF_H
#define HEWN_TEST_MESH_HALF_H

#include "test_mesh_support.h"

#include "hewn/mesh.h"

#define assert_works(call)                                                                                             \
    do {                                                                                                               \
        hewn_error works_error = {0};                                                                                  \
        hewn_error *error = &works_error;                                                                              \
        if ((call) != HEWN_OK)                                                                                         \
            fail_msg("%s: %s", #call, works_error.message);                                                            \
        (void)error;                                                                                                   \
    } while (0)

#define assert_refused(call, result, text)                                                                             \
    do {                                                                                                               \
        hewn_error refused_error = {0};                                                                                \
        hewn_error *error = &refused_error;                                                                            \
        assert_int_equal((call), (result));                                                                            \
        assert_int_equal(refused_error.code, (result));                                                                \
        if (!strstr(refused_error.message, (text)))                                                                    \
            fail_msg("\"%s\" does not say \"%s\"", refused_error.message, (text));                                     \
        (void)error;                                                                                                   \
    } while (0)

static inline void assert_valid(const hewn_mesh *mesh)
{
    assert_works(hewn_mesh_validate(mesh, error));
}

static inline int64_t euler_number(const hewn_mesh *mesh)
{
    return (int64_t)hewn_mesh_vert_count(mesh) - hewn_mesh_edge_count(mesh) + hewn_mesh_face_count(mesh);
}

static inline hewn_mesh *mesh_of(const double *positions, uint64_t verts, const uint64_t *first,
                                 const uint32_t *corners, uint64_t faces)
{
    const hewn_polygons polygons = {verts, positions, faces, first, corners};
    hewn_mesh *mesh = NULL;
    assert_works(hewn_mesh_from_polygons(&polygons, &mesh, error));
    assert_valid(mesh);
    return mesh;
}

static inline hewn_mesh *tetrahedron(void)
{
    static const double positions[] = {1, 1, 1, -1, -1, 1, -1, 1, -1, 1, -1, -1};
    static const uint32_t corners[] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    return mesh_of(positions, 4, NULL, corners, 4);
}

/* The unit cube of six quadrilaterals, corners numbered by their bits. */
static inline hewn_mesh *quad_cube(void)
{
    static const uint64_t first[] = {0, 4, 8, 12, 16, 20, 24};
    static const uint32_t corners[] = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
    double positions[24];
    for (uint32_t v = 0; v < 8; v++)
        for (uint32_t k = 0; k < 3; k++)
            positions[3 * v + k] = v >> k & 1;
    return mesh_of(positions, 8, first, corners, 6);
}

/* A square of n × n quads in the plane z = 0, cut in two if `triangles`. Vertex (i, j) has the number i (n + 1) + j. */
static inline hewn_mesh *flat_grid(uint32_t n, bool triangles)
{
    double *positions = malloc((n + 1) * (n + 1) * 3 * sizeof *positions);
    uint32_t *corners = malloc((size_t)n * n * 6 * sizeof *corners), count = 0;
    uint64_t *first = malloc(((size_t)n * n + 1) * sizeof *first);
    for (uint32_t i = 0; i <= n; i++)
        for (uint32_t j = 0; j <= n; j++) {
            double *at = positions + 3 * (i * (n + 1) + j);
            at[0] = i;
            at[1] = j;
            at[2] = 0;
        }
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++) {
            uint32_t a = i * (n + 1) + j, b = a + n + 1, c = b + 1, d = a + 1;
            const uint32_t cut[] = {a, b, c, a, c, d}, quad[] = {a, b, c, d};
            first[i * n + j] = count;
            memcpy(corners + count, triangles ? cut : quad, triangles ? sizeof cut : sizeof quad);
            count += triangles ? 6 : 4;
        }
    first[n * n] = count;
    hewn_mesh *mesh = mesh_of(positions, (n + 1) * (n + 1), triangles ? NULL : first, corners,
                              triangles ? 2 * (uint64_t)n * n : (uint64_t)n * n);
    free(positions);
    free(corners);
    free(first);
    return mesh;
}

static inline hewn_mesh *torus(uint32_t n, uint32_t m)
{
    hewn_triangles triangles = make_torus(n, m);
    hewn_mesh *mesh = NULL;
    assert_works(hewn_mesh_from_triangles(&triangles, &mesh, error));
    assert_valid(mesh);
    hewn_triangles_destroy(&triangles);
    return mesh;
}

/* --- attributes that follow --------------------------------------------------------------------------------------- */

static inline uint32_t attribute_named(const hewn_mesh *mesh, hewn_domain domain, const char *name)
{
    uint32_t at = 0;
    assert_true(hewn_mesh_find_attribute(mesh, domain, name, &at));
    return at;
}

static inline void set_vert_values(hewn_mesh *mesh, hewn_vert v)
{
    const double *position = hewn_vert_position(mesh, v);
    float *tint = hewn_mesh_attribute_at(mesh, attribute_named(mesh, HEWN_DOMAIN_VERT, "tint"), v.id);
    memcpy(hewn_mesh_attribute_at(mesh, attribute_named(mesh, HEWN_DOMAIN_VERT, "place"), v.id), position,
           3 * sizeof *position);
    for (int k = 0; k < 3; k++)
        tint[k] = (float)position[k];
}

static inline void set_face_values(hewn_mesh *mesh, hewn_face f, int32_t label)
{
    uint32_t spot = attribute_named(mesh, HEWN_DOMAIN_CORNER, "spot");
    hewn_half first = hewn_face_half(mesh, f), h = first;
    *(int32_t *)hewn_mesh_attribute_at(mesh, attribute_named(mesh, HEWN_DOMAIN_FACE, "label"), f.id) = label;
    do {
        memcpy(hewn_mesh_attribute_at(mesh, spot, h.id), hewn_vert_position(mesh, hewn_half_head(mesh, h)),
               3 * sizeof(double));
        h = hewn_half_next(mesh, h);
    } while (h.id != first.id);
}

/* Face f gets the label f + 1. */
static inline void add_values(hewn_mesh *mesh)
{
    const hewn_attribute_info place = {"place", HEWN_DOMAIN_VERT, HEWN_SCALAR_DOUBLE, 3};
    const hewn_attribute_info tint = {"tint", HEWN_DOMAIN_VERT, HEWN_SCALAR_FLOAT, 3};
    const hewn_attribute_info spot = {"spot", HEWN_DOMAIN_CORNER, HEWN_SCALAR_DOUBLE, 3};
    const hewn_attribute_info label = {"label", HEWN_DOMAIN_FACE, HEWN_SCALAR_INT32, 1};
    assert_works(hewn_mesh_add_attribute(mesh, &place, NULL, error));
    assert_works(hewn_mesh_add_attribute(mesh, &tint, NULL, error));
    assert_works(hewn_mesh_add_attribute(mesh, &spot, NULL, error));
    assert_works(hewn_mesh_add_attribute(mesh, &label, NULL, error));
    for (uint32_t v = 0; v < hewn_mesh_vert_bound(mesh); v++)
        if (hewn_mesh_has_vert(mesh, (hewn_vert){v}))
            set_vert_values(mesh, (hewn_vert){v});
    for (uint32_t f = 0; f < hewn_mesh_face_bound(mesh); f++)
        if (hewn_mesh_has_face(mesh, (hewn_face){f}))
            set_face_values(mesh, (hewn_face){f}, (int32_t)f + 1);
}

static inline void assert_same_place(const double *value, const double *position, double tolerance, const char *what,
                                     uint32_t id)
{
    for (int k = 0; k < 3; k++)
        if (!(fabs(value[k] - position[k]) <= tolerance))
            fail_msg("%s %u has %.17g instead of %.17g", what, id, value[k], position[k]);
}

static inline void assert_values(const hewn_mesh *mesh, double tolerance)
{
    uint32_t place = attribute_named(mesh, HEWN_DOMAIN_VERT, "place");
    uint32_t tint = attribute_named(mesh, HEWN_DOMAIN_VERT, "tint");
    uint32_t spot = attribute_named(mesh, HEWN_DOMAIN_CORNER, "spot");
    uint32_t label = attribute_named(mesh, HEWN_DOMAIN_FACE, "label");
    for (uint32_t v = 0; v < hewn_mesh_vert_bound(mesh); v++) {
        const double *position = hewn_vert_position(mesh, (hewn_vert){v});
        if (!position)
            continue;
        assert_same_place(hewn_mesh_attribute_read(mesh, place, v), position, tolerance, "vertex", v);
        const float *colour = hewn_mesh_attribute_read(mesh, tint, v);
        for (int k = 0; k < 3; k++)
            assert_true(fabs((double)colour[k] - position[k]) < 1e-4 * (1 + fabs(position[k])));
    }
    for (uint32_t h = 0; h < hewn_mesh_half_bound(mesh); h++)
        if (hewn_half_face(mesh, (hewn_half){h}).id != HEWN_NONE)
            assert_same_place(hewn_mesh_attribute_read(mesh, spot, h),
                              hewn_vert_position(mesh, hewn_half_head(mesh, (hewn_half){h})), tolerance, "corner", h);
    for (uint32_t f = 0; f < hewn_mesh_face_bound(mesh); f++)
        if (hewn_mesh_has_face(mesh, (hewn_face){f}))
            assert_true(*(const int32_t *)hewn_mesh_attribute_read(mesh, label, f) > 0);
}

#endif
