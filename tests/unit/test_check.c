/* The check of polygon soups: shapes that are known, and what may not depend on order. */
#include <float.h>
#include <omp.h>

#include "test_check_support.h"

/* --- known shapes ------------------------------------------------------------------------------------------------- */

static void assert_topology(const hewn_check *c, int64_t euler, uint64_t components, bool closed, uint64_t loops)
{
    assert_int_equal(c->euler, euler);
    assert_int_equal(c->certificate.components, components);
    assert_int_equal(c->certificate.closed, closed);
    assert_int_equal(c->boundary_loops, loops);
}

static void test_cube(void **state)
{
    (void)state;
    soup *s = make_soup();
    add_cube(s, 1, 2, 3, 2);
    hewn_check *c = take_soup(s);
    assert_topology(c, 2, 1, true, 0);
    assert_true(c->certificate.manifold && c->certificate.oriented && c->orientable);
    assert_int_equal(c->vertex_count, 8);
    assert_int_equal(c->used_vertices, 8);
    assert_int_equal(c->edges, 12);
    assert_int_equal(c->face_count, 6);
    assert_int_equal(c->certificate.genus, 0);
    assert_true(c->certificate.volume == 8 && c->certificate.area == 24);
    assert_true(isnan(c->certificate.max_residual));
    assert_int_equal(c->certificate.degenerate_faces + c->duplicate_faces + c->isolated_vertices, 0);
    assert_true(c->self_intersections_known);
    assert_int_equal(c->self_intersections, 0);
    assert_int_equal(c->component_count, 1);
    const hewn_component *one = &c->components[0];
    assert_true(one->closed && one->manifold && one->oriented && one->orientable);
    assert_int_equal(one->vertices, 8);
    assert_int_equal(one->edges, 12);
    assert_int_equal(one->faces, 6);
    assert_int_equal(one->euler, 2);
    assert_int_equal(one->genus, 0);
    assert_true(one->volume == 8 && one->area == 24);
    assert_true(one->bounds.lo[0] == 1 && one->bounds.hi[2] == 5);
    assert_int_equal(hewn_check_unmet(c, HEWN_REQUIRE_ALL), 0);
    hewn_check_destroy(&c);
    assert_null(c);
    hewn_check_destroy(&c);
}

static void test_dodecahedron(void **state)
{
    (void)state;
    static const uint32_t faces[12][5] = {{0, 8, 9, 4, 16},   {0, 12, 13, 1, 8},  {0, 16, 17, 2, 12},
                                          {8, 1, 18, 5, 9},   {12, 2, 10, 3, 13}, {16, 4, 14, 6, 17},
                                          {9, 5, 15, 14, 4},  {6, 11, 10, 2, 17}, {3, 19, 18, 1, 13},
                                          {7, 15, 5, 18, 19}, {7, 11, 6, 14, 15}, {7, 19, 3, 10, 11}};
    const double g = (1 + sqrt(5)) / 2, h = 1 / g;
    const double points[20][3] = {{1, 1, 1},   {1, 1, -1},  {1, -1, 1},   {1, -1, -1}, {-1, 1, 1},
                                  {-1, 1, -1}, {-1, -1, 1}, {-1, -1, -1}, {h, g, 0},   {-h, g, 0},
                                  {h, -g, 0},  {-h, -g, 0}, {g, 0, h},    {g, 0, -h},  {-g, 0, h},
                                  {-g, 0, -h}, {0, h, g},   {0, -h, g},   {0, h, -g},  {0, -h, -g}};
    soup *s = make_soup();
    for (int v = 0; v < 20; v++)
        add_point(s, points[v][0], points[v][1], points[v][2]);
    for (int f = 0; f < 12; f++)
        add_polygon(s, faces[f], 5);
    hewn_check *c = take_soup(s);
    assert_topology(c, 2, 1, true, 0);
    assert_int_equal(c->edges, 30);
    assert_true(c->certificate.manifold && c->certificate.oriented);
    double edge = 2 / g, volume = (15 + 7 * sqrt(5)) / 4 * edge * edge * edge;
    assert_true(fabs(fabs(c->certificate.volume) - volume) < 1e-12 * volume);
    assert_true(fabs(c->certificate.area - 3 * sqrt(25 + 10 * sqrt(5)) * edge * edge) < 1e-12 * volume);
    assert_int_equal(c->self_intersections, 0);
    assert_int_equal(c->certificate.degenerate_faces, 0);
    hewn_check_destroy(&c);
}

static void test_components_of_different_genus(void **state)
{
    (void)state;
    soup *s = make_soup();
    add_cube(s, 10, 0, 0, 1);
    add_torus(s, 8, 6, 0, false);
    add_cube(s, 20, 0, 0, 1);
    hewn_check *c = take_soup(s);
    assert_topology(c, 4, 3, true, 0);
    assert_int_equal(c->certificate.genus, 1);
    assert_int_equal(c->component_count, 3);
    assert_int_equal(c->components[0].genus, 1); /* most faces first, then by lowest vertex */
    assert_int_equal(c->components[0].euler, 0);
    assert_int_equal(c->components[1].genus, 0);
    assert_true(c->components[1].bounds.lo[0] == 10 && c->components[2].bounds.lo[0] == 20);
    assert_true(c->components[1].volume == 1 && c->components[2].area == 6);
    double sum = c->components[0].volume + c->components[1].volume + c->components[2].volume;
    assert_true(fabs(sum - c->certificate.volume) < 1e-12 * sum);
    assert_int_equal(hewn_check_unmet(c, HEWN_REQUIRE_ALL), HEWN_REQUIRE_ONE_COMPONENT);
    hewn_check_destroy(&c);
}

static void test_nested_spheres(void **state)
{
    (void)state;
    soup *s = make_soup();
    add_cube(s, 0, 0, 0, 4);
    uint64_t outer = s->faces;
    add_cube(s, 1, 1, 1, 1);
    for (uint64_t f = outer; f < s->faces; f++) { /* a cavity */
        uint32_t *q = s->corners + s->first[f], keep = q[1];
        q[1] = q[3];
        q[3] = keep;
    }
    hewn_check *c = take_soup(s);
    assert_topology(c, 4, 2, true, 0);
    assert_true(c->certificate.volume == 63 && c->certificate.area == 102);
    assert_int_equal(c->self_intersections, 0);
    assert_true(c->components[0].volume == 64 && c->components[1].volume == -1);
    hewn_check_destroy(&c);
}

static void test_one_sided(void **state)
{
    (void)state;
    soup *s = make_soup();
    add_band(s, 12, true);
    add_torus(s, 7, 6, 10, true);
    hewn_check *c = take_soup(s);
    assert_topology(c, 0, 2, false, 1);
    assert_true(c->certificate.manifold);
    assert_false(c->certificate.oriented);
    assert_false(c->orientable);
    const hewn_component *klein = &c->components[0], *moebius = &c->components[1];
    assert_true(klein->closed && klein->manifold && !klein->orientable);
    assert_int_equal(klein->genus, 2);
    assert_int_equal(moebius->genus, 1);
    assert_int_equal(moebius->boundary_loops, 1);
    assert_int_equal(moebius->boundary_edges, 24);
    assert_false(moebius->orientable);
    assert_int_equal(moebius->edges, 36);
    hewn_check_destroy(&c);
    s = make_soup();
    add_band(s, 12, false);
    c = take_soup(s);
    assert_topology(c, 0, 1, false, 2);
    assert_true(c->orientable && c->certificate.oriented);
    assert_int_equal(c->components[0].genus, 0);
    hewn_check_destroy(&c);
}

/* Faces that only disagree can be turned: the mesh is not oriented, but orientable. */
static void test_turned_face(void **state)
{
    (void)state;
    soup *s = make_soup();
    add_torus(s, 5, 5, 0, false);
    uint32_t *q = s->corners + s->first[7], keep = q[1];
    q[1] = q[3];
    q[3] = keep;
    hewn_check *c = take_soup(s);
    assert_false(c->certificate.oriented);
    assert_true(c->orientable && c->components[0].orientable);
    assert_int_equal(c->unoriented_edges, 4);
    assert_int_equal(c->components[0].genus, 1);
    assert_int_equal(c->certificate.genus, -1);
    hewn_check_destroy(&c);
}

static void test_torus_with_holes(void **state)
{
    (void)state;
    soup *s = make_soup();
    add_torus(s, 10, 10, 0, false);
    uint64_t kept = 0;
    for (uint64_t f = 0; f < s->faces; f++) { /* three faces go that do not touch */
        if (f == 11 || f == 44 || f == 77)
            continue;
        memmove(s->corners + 4 * kept, s->corners + 4 * f, 4 * sizeof *s->corners);
        kept++;
    }
    s->faces = kept;
    hewn_check *c = take_soup(s);
    assert_topology(c, -3, 1, false, 3);
    assert_int_equal(c->certificate.boundary_edges, 12);
    assert_int_equal(c->components[0].genus, 1);
    assert_int_equal(c->certificate.genus, -1);
    hewn_check_destroy(&c);
}

/* Two triangles and a cube that share a vertex each: fans are taken apart for the loops. */
static void test_pinched(void **state)
{
    (void)state;
    soup *s = make_soup();
    for (int v = 0; v < 5; v++)
        add_point(s, v, v * v, v == 2);
    add_triangle(s, 0, 1, 2);
    add_triangle(s, 2, 3, 4);
    hewn_check *c = take_soup(s);
    assert_topology(c, 1, 1, false, 2);
    assert_int_equal(c->certificate.non_manifold_vertices, 1);
    assert_int_equal(c->certificate.non_manifold_edges, 0);
    assert_false(c->certificate.manifold);
    assert_int_equal(c->components[0].genus, -1);
    assert_int_equal(c->components[0].non_manifold_vertices, 1);
    hewn_check_destroy(&c);
}

static void test_three_faces_at_an_edge(void **state)
{
    (void)state;
    soup *s = make_soup();
    add_point(s, 0, 0, 0);
    add_point(s, 0, 0, 1);
    for (int k = 0; k < 3; k++) {
        uint32_t a = add_point(s, k + 1, k * k, 0), b = add_point(s, k + 1, k * k, 1);
        add_quad(s, 0, 1, b, a);
    }
    hewn_check *c = take_soup(s);
    assert_int_equal(c->certificate.non_manifold_edges, 1);
    assert_int_equal(c->certificate.non_manifold_vertices, 2);
    assert_int_equal(c->certificate.boundary_edges, 9);
    assert_int_equal(c->self_intersections, 0);
    assert_false(c->certificate.oriented || c->certificate.closed);
    hewn_check_destroy(&c);
}

static void test_degenerate_and_duplicate_faces(void **state)
{
    (void)state;
    soup *s = make_soup();
    for (int v = 0; v < 6; v++)
        add_point(s, v % 3, v / 3, 0);
    uint32_t loose = add_point(s, 9, 9, 9), named = add_point(s, 8, 8, 8);
    (void)loose;
    add_quad(s, 0, 1, 4, 3);
    add_quad(s, 4, 3, 0, 1);      /* the same */
    add_quad(s, 1, 0, 3, 4);      /* reversed */
    add_quad(s, 0, 4, 1, 3);      /* another cycle of the same vertices */
    add_triangle(s, 0, 1, 2);     /* on a line */
    add_triangle(s, 3, 3, named); /* a vertex twice */
    add_triangle(s, 3, named, 3); /* the same */
    add_polygon(s, (uint32_t[]){5, 4}, 2);
    add_polygon(s, (uint32_t[]){4, 5}, 2);
    add_polygon(s, NULL, 0);
    add_quad(s, 0, 1, 0, 1);
    hewn_check *c = take_soup(s);
    assert_int_equal(c->face_count, 11);
    assert_int_equal(c->sided_faces, 5);
    assert_int_equal(c->duplicate_faces, 4);
    assert_int_equal(c->certificate.degenerate_faces, 7);
    assert_int_equal(c->isolated_vertices, 1);
    assert_int_equal(c->used_vertices, 5);
    hewn_check_destroy(&c);
}

/* Without area is decided exactly: one unit in the last place, or a size that products cannot hold, makes no doubt. */
static void test_area_of_exactly_zero(void **state)
{
    (void)state;
    static const double scales[] = {1, 1e-170, 0x1p-1000, 1e160, 0x1p1000, 3};
    for (size_t k = 0; k < sizeof scales / sizeof scales[0]; k++)
        for (int nudged = 0; nudged < 2; nudged++)
            for (uint32_t corners = 3; corners <= 5; corners++) {
                soup *s = make_soup();
                uint32_t polygon[5];
                for (uint32_t i = 0; i < corners; i++) {
                    double at = scales[k] * (i * i + 1);
                    polygon[i] = add_point(s, at, at, at);
                }
                if (nudged)
                    s->positions[3 * corners - 1] = nextafter(s->positions[3 * corners - 1], INFINITY);
                add_polygon(s, polygon, corners);
                add_polygon(s, polygon, 3);
                hewn_check *c = take_soup(s);
                bool second = nudged && corners == 3;
                assert_int_equal(c->certificate.degenerate_faces, 2 - nudged - second);
                hewn_check_destroy(&c);
            }
}

static void test_size_without_overflow(void **state)
{
    (void)state;
    static const int exponents[] = {-330, -300, 0, 300, 330};
    for (int k = 0; k < 5; k++) {
        soup *s = make_soup();
        double size = ldexp(1, exponents[k]);
        add_cube(s, 0, 0, 0, size);
        hewn_check *c = take_soup(s);
        assert_true(c->certificate.volume == size * size * size && c->certificate.area == 6 * size * size);
        assert_true(c->components[0].volume == size * size * size && c->components[0].area == 6 * size * size);
        assert_int_equal(c->certificate.degenerate_faces, 0);
        hewn_check_destroy(&c);
    }
    soup *s = make_soup();
    add_cube(s, -DBL_MAX, -DBL_MAX, -DBL_MAX, DBL_MAX);
    hewn_check *c = take_soup(s);
    assert_true(c->certificate.closed && isinf(c->certificate.volume) && c->certificate.volume > 0);
    hewn_check_destroy(&c);
}

static void test_empty(void **state)
{
    (void)state;
    hewn_polygons none = {0};
    hewn_check *c = NULL;
    assert_int_equal(hewn_check_polygons(&none, NULL, &c, NULL), HEWN_OK);
    assert_topology(c, 0, 0, true, 0);
    assert_int_equal(c->component_count, 0);
    assert_int_equal(hewn_check_unmet(c, HEWN_REQUIRE_ALL), HEWN_REQUIRE_ONE_COMPONENT | HEWN_REQUIRE_POSITIVE_VOLUME);
    hewn_check_destroy(&c);
    soup *s = make_soup();
    add_point(s, 1, 2, 3);
    c = take_soup(s);
    assert_int_equal(c->isolated_vertices, 1);
    assert_true(c->certificate.bounds.hi[0] == 0);
    hewn_check_destroy(&c);
}

static void test_lists_are_cut_short(void **state)
{
    (void)state;
    soup *s = make_soup();
    for (int k = 0; k < 100; k++)
        add_cube(s, k * (k < 50 ? 0.75 : 3), 0, 0, 1);
    hewn_check *all = check_soup(s, &(hewn_check_desc){.most_pairs = 100000, .most_components = 1000});
    assert_int_equal(all->component_count, 100);
    assert_true(all->self_intersections > 100);
    assert_int_equal(all->pair_count, all->self_intersections);
    hewn_check *few = check_soup(s, NULL);
    assert_int_equal(few->component_count, hewn_check_desc_default().most_components);
    assert_int_equal(few->pair_count, hewn_check_desc_default().most_pairs);
    assert_int_equal(few->certificate.components, 100);
    assert_int_equal(few->self_intersections, all->self_intersections);
    assert_memory_equal(few->pairs, all->pairs, few->pair_count * sizeof *few->pairs);
    for (uint32_t k = 0; k < few->component_count; k++)
        assert_memory_equal(&few->components[k].bounds, &all->components[k].bounds, sizeof all->components[k].bounds);
    hewn_check *skipped = check_soup(s, &(hewn_check_desc){.skip_self_intersections = true});
    assert_false(skipped->self_intersections_known);
    assert_int_equal(skipped->pair_count, 0);
    assert_int_equal(hewn_check_unmet(skipped, HEWN_REQUIRE_NO_SELF_INTERSECTIONS), HEWN_REQUIRE_NO_SELF_INTERSECTIONS);
    hewn_check_destroy(&all);
    hewn_check_destroy(&few);
    hewn_check_destroy(&skipped);
    free(s);
}

/* --- order and threads -------------------------------------------------------------------------------------------- */

static void assert_same_counts(const hewn_check *a, const hewn_check *b)
{
    const hewn_certificate *c = &a->certificate, *d = &b->certificate;
    assert_int_equal(a->used_vertices, b->used_vertices);
    assert_int_equal(a->edges, b->edges);
    assert_int_equal(a->sided_faces, b->sided_faces);
    assert_int_equal(a->euler, b->euler);
    assert_int_equal(a->orientable, b->orientable);
    assert_int_equal(a->boundary_loops, b->boundary_loops);
    assert_int_equal(a->unoriented_edges, b->unoriented_edges);
    assert_int_equal(a->duplicate_faces, b->duplicate_faces);
    assert_int_equal(a->isolated_vertices, b->isolated_vertices);
    assert_int_equal(c->closed, d->closed);
    assert_int_equal(c->manifold, d->manifold);
    assert_int_equal(c->oriented, d->oriented);
    assert_int_equal(c->components, d->components);
    assert_int_equal(c->genus, d->genus);
    assert_int_equal(c->boundary_edges, d->boundary_edges);
    assert_int_equal(c->non_manifold_edges, d->non_manifold_edges);
    assert_int_equal(c->non_manifold_vertices, d->non_manifold_vertices);
    assert_int_equal(c->degenerate_faces, d->degenerate_faces);
    assert_memory_equal(&c->bounds, &d->bounds, sizeof c->bounds);
}

static void test_order_does_not_matter(void **state)
{
    (void)state;
    random_state random = {11};
    for (int run = 0; run < 60; run++) {
        soup *s = make_soup();
        if (run % 3 == 0)
            add_torus(s, 9, 7, 0, run % 2 == 0);
        if (run % 3 == 1)
            add_band(s, 20, run % 2 == 0);
        for (int k = 0; k < 5; k++)
            add_cube(s, random_below(&random, 6), 0, 0, 1 + random_below(&random, 2));
        for (int k = 0; k < 12; k++) { /* and some that meet them anyhow */
            uint32_t corners[6], count = random_below(&random, 7);
            for (uint32_t i = 0; i < count; i++)
                corners[i] = random_below(&random, (uint32_t)s->vertices);
            add_polygon(s, corners, count);
        }
        hewn_check *first = check_soup(s, NULL);
        for (int reverse = 0; reverse < 2; reverse++) {
            soup *other = shuffle_soup(s, reverse, &random);
            hewn_check *second = take_soup(other);
            assert_same_counts(first, second);
            hewn_check_destroy(&second);
        }
        hewn_check_destroy(&first);
        free(s);
    }
}

static void test_threads_do_not_matter(void **state)
{
    (void)state;
    hewn_triangles mesh = join_meshes(make_torus(160, 110), make_torus(90, 60), 0.4);
    random_state random = {5};
    shuffle_mesh(&mesh, &random);
    int usual = omp_get_max_threads();
    hewn_check *first = NULL;
    for (int threads = 1; threads <= 5; threads += 2) {
        hewn_check *check = NULL;
        omp_set_num_threads(threads);
        assert_int_equal(hewn_check_triangles(&mesh, NULL, &check, NULL), HEWN_OK);
        if (!first) {
            first = check;
            continue;
        }
        assert_same_counts(first, check);
        assert_true(first->certificate.volume == check->certificate.volume);
        assert_int_equal(first->self_intersections, check->self_intersections);
        assert_int_equal(first->component_count, 2);
        for (int k = 0; k < 2; k++)
            assert_memory_equal(&first->components[k], &check->components[k], sizeof first->components[k]);
        hewn_check_destroy(&check);
    }
    omp_set_num_threads(usual);
    assert_true(first->self_intersections > 0);
    hewn_check_destroy(&first);
    hewn_triangles_destroy(&mesh);
}

/* Floats and the same numbers as doubles, as triangles and as polygons: all one. */
static void test_all_doors_agree(void **state)
{
    (void)state;
    hewn_triangles mesh = join_meshes(make_torus(40, 30), make_bipyramid(300), 0.5);
    mesh.triangle_count -= 3;
    double *positions = malloc(3 * mesh.vertex_count * sizeof *positions);
    uint64_t *first = malloc((mesh.triangle_count + 2) * sizeof *first);
    assert_true(positions && first);
    for (uint64_t i = 0; i < 3 * mesh.vertex_count; i++)
        positions[i] = (double)mesh.positions[i];
    for (uint64_t f = 0; f <= mesh.triangle_count + 1; f++)
        first[f] = f <= mesh.triangle_count ? 3 * f : 3 * mesh.triangle_count;
    hewn_certificate certificate;
    assert_int_equal(hewn_certify(&mesh, NULL, &certificate, NULL), HEWN_OK);
    hewn_polygons polygons = {mesh.vertex_count, positions, mesh.triangle_count, NULL, mesh.indices};
    for (int way = 0; way < 4; way++) {
        hewn_check *check = NULL;
        polygons.first = way == 1 ? NULL : first;
        polygons.face_count = mesh.triangle_count + (way == 3); /* a face of no corner makes them polygons */
        assert_int_equal(way == 0 ? hewn_check_triangles(&mesh, NULL, &check, NULL)
                                  : hewn_check_polygons(&polygons, NULL, &check, NULL),
                         HEWN_OK);
        check->certificate.max_residual = certificate.max_residual = 0;
        check->certificate.degenerate_faces -= way == 3;
        assert_int_equal(check->certificate.closed, certificate.closed);
        assert_int_equal(check->certificate.boundary_edges, certificate.boundary_edges);
        assert_int_equal(check->certificate.degenerate_faces, certificate.degenerate_faces);
        assert_int_equal(check->certificate.components, certificate.components);
        assert_true(check->certificate.volume == certificate.volume && check->certificate.area == certificate.area);
        uint64_t crossings = 0;
        assert_int_equal(hewn_triangles_count_self_intersections(&mesh, 0, NULL, NULL, &crossings, NULL), HEWN_OK);
        assert_int_equal(check->self_intersections, crossings);
        assert_true(crossings > 0);
        hewn_check_destroy(&check);
    }
    free(positions);
    free(first);
    hewn_triangles_destroy(&mesh);
}

/* --- failures ----------------------------------------------------------------------------------------------------- */

static void assert_refused_soup(const hewn_polygons *polygons, hewn_result result, const char *text)
{
    hewn_error error = {0};
    hewn_check *check = (hewn_check *)&error;
    assert_int_equal(hewn_check_polygons(polygons, NULL, &check, &error), result);
    assert_null(check);
    if (!strstr(error.message, text))
        fail_msg("\"%s\" does not say \"%s\"", error.message, text);
}

static void test_bad_input(void **state)
{
    (void)state;
    soup *s = make_soup();
    add_cube(s, 0, 0, 0, 1);
    hewn_polygons polygons = polygons_of(s);
    s->corners[9] = 8;
    assert_refused_soup(&polygons, HEWN_BAD_INPUT, "face 2 names vertex 8");
    s->corners[9] = 0;
    s->positions[10] = NAN;
    assert_refused_soup(&polygons, HEWN_BAD_INPUT, "vertex 3 ");
    s->positions[10] = 0;
    s->first[2] = 3;
    assert_refused_soup(&polygons, HEWN_BAD_INPUT, "face 1 ");
    s->first[2] = 8;
    polygons.corners = NULL;
    assert_refused_soup(&polygons, HEWN_INVALID_ARGUMENT, "without");
    polygons.vertex_count = 1ull << 32;
    assert_refused_soup(&polygons, HEWN_LIMIT, "more than");
    free(s);
}

static bool count_down(void *user, const char *stage, double fraction)
{
    assert_true(strcmp(stage, "check") == 0 || strcmp(stage, "triangulate") == 0 ||
                strcmp(stage, "self-intersections") == 0);
    assert_true(fraction >= 0 && fraction <= 1);
    return (*(int *)user)-- > 0;
}

static void test_cancels_at_every_report(void **state)
{
    (void)state;
    soup *s = make_soup();
    add_torus(s, 20, 20, 0, false);
    hewn_polygons polygons = polygons_of(s);
    for (int allowed = 0;; allowed++) {
        int left = allowed;
        hewn_progress progress = {count_down, &left};
        hewn_check_desc desc = {.progress = &progress};
        hewn_check *check = NULL;
        hewn_result result = hewn_check_polygons(&polygons, &desc, &check, NULL);
        if (result == HEWN_OK) {
            assert_true(allowed >= 6);
            hewn_check_destroy(&check);
            break;
        }
        assert_int_equal(result, HEWN_CANCELLED);
        assert_null(check);
    }
    free(s);
}

/* --- requirements ------------------------------------------------------------------------------------------------- */

static void test_requirements(void **state)
{
    (void)state;
    uint32_t bits = 7;
    hewn_error error = {0};
    assert_int_equal(hewn_requirements_parse("closed", &bits, NULL), HEWN_OK);
    assert_int_equal(bits, HEWN_REQUIRE_CLOSED);
    assert_int_equal(hewn_requirements_parse("closed,manifold, oriented ,no-self-intersections", &bits, NULL), HEWN_OK);
    assert_int_equal(bits, 15);
    char all[512] = "";
    for (uint32_t bit = 1; bit < HEWN_REQUIRE_ALL; bit *= 2) {
        assert_non_null(hewn_requirement_name((hewn_requirement)bit));
        snprintf(all + strlen(all), sizeof all - strlen(all), "%s%s", bit > 1 ? "," : "",
                 hewn_requirement_name((hewn_requirement)bit));
    }
    assert_int_equal(hewn_requirements_parse(all, &bits, NULL), HEWN_OK);
    assert_int_equal(bits, HEWN_REQUIRE_ALL);
    assert_null(hewn_requirement_name(HEWN_REQUIRE_ALL));
    static const char *const bad[] = {"", ",closed", "closed,", "closed,,manifold", "close", "closedd", NULL};
    for (int i = 0; bad[i]; i++) {
        assert_int_equal(hewn_requirements_parse(bad[i], &bits, &error), HEWN_INVALID_ARGUMENT);
        assert_int_equal(bits, 0);
        assert_non_null(strstr(error.message, "no-self-intersections"));
    }
    assert_int_equal(hewn_requirements_parse("closed, shiny", &bits, &error), HEWN_INVALID_ARGUMENT);
    assert_non_null(strstr(error.message, "\"shiny\" is no requirement"));
    assert_int_equal(hewn_requirements_parse(NULL, &bits, NULL), HEWN_INVALID_ARGUMENT);
}

static void test_unmet(void **state)
{
    (void)state;
    soup *s = make_soup();
    add_cube(s, 0, 0, 0, 1);
    add_cube(s, 0.5, 0.5, 0.5, 1);
    s->faces--;
    add_point(s, 9, 9, 9);
    add_triangle(s, 0, 0, 1);
    hewn_check *c = take_soup(s);
    assert_int_equal(hewn_check_unmet(c, HEWN_REQUIRE_ALL),
                     HEWN_REQUIRE_CLOSED | HEWN_REQUIRE_NO_SELF_INTERSECTIONS | HEWN_REQUIRE_NO_DEGENERATE_FACES |
                         HEWN_REQUIRE_NO_ISOLATED_VERTICES | HEWN_REQUIRE_ONE_COMPONENT | HEWN_REQUIRE_POSITIVE_VOLUME);
    assert_int_equal(hewn_check_unmet(c, HEWN_REQUIRE_MANIFOLD | HEWN_REQUIRE_ORIENTED), 0);
    hewn_check_destroy(&c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cube),
        cmocka_unit_test(test_dodecahedron),
        cmocka_unit_test(test_components_of_different_genus),
        cmocka_unit_test(test_nested_spheres),
        cmocka_unit_test(test_one_sided),
        cmocka_unit_test(test_turned_face),
        cmocka_unit_test(test_torus_with_holes),
        cmocka_unit_test(test_pinched),
        cmocka_unit_test(test_three_faces_at_an_edge),
        cmocka_unit_test(test_degenerate_and_duplicate_faces),
        cmocka_unit_test(test_area_of_exactly_zero),
        cmocka_unit_test(test_size_without_overflow),
        cmocka_unit_test(test_empty),
        cmocka_unit_test(test_lists_are_cut_short),
        cmocka_unit_test(test_order_does_not_matter),
        cmocka_unit_test(test_threads_do_not_matter),
        cmocka_unit_test(test_all_doors_agree),
        cmocka_unit_test(test_bad_input),
        cmocka_unit_test(test_cancels_at_every_report),
        cmocka_unit_test(test_requirements),
        cmocka_unit_test(test_unmet),
    };
    return cmocka_run_group_tests_name("check", tests, NULL, NULL);
}
