/* Long random sequences of operations: the mesh stays valid, attributes follow, the Euler number changes as each
 * operation says. */
#include "test_mesh_half.h"

enum { SHORT_RUN = 10000, LONG_RUN = 100000, MOST_FACES = 200 };

typedef enum change {
    FLIP,
    SPLIT,
    COLLAPSE,
    POKE,
    CUT,
    DELETE_FACE,
    DELETE_VERT,
    SWEEP,
    ADD_FACE,
    CLOSE_HOLE,
    REVERSE,
    COMPACT,
    KIND_COUNT
} change;

static const char *const kind_names[] = {"flip",        "split", "collapse", "poke", "cut",     "delete face",
                                         "delete vert", "sweep", "add face", "fill", "reverse", "compact"};

typedef struct sequence {
    hewn_mesh *mesh;
    random_state random;
    uint32_t done[KIND_COUNT];
    int32_t labels;
} sequence;

static hewn_half any_half(sequence *run)
{
    for (;;) {
        hewn_half h = {random_below(&run->random, hewn_mesh_half_bound(run->mesh))};
        if (hewn_mesh_has_half(run->mesh, h))
            return h;
    }
}

static hewn_face any_face(sequence *run)
{
    for (;;) {
        hewn_face f = hewn_half_face(run->mesh, any_half(run));
        if (f.id != HEWN_NONE)
            return f;
    }
}

static bool flip(sequence *run)
{
    hewn_half h = any_half(run);
    if (!hewn_mesh_can_flip(run->mesh, h))
        return false;
    hewn_vert left = hewn_half_head(run->mesh, hewn_half_next(run->mesh, h));
    hewn_mesh_flip(run->mesh, h);
    assert_int_equal(hewn_half_head(run->mesh, h).id, left.id);
    return true;
}

static bool split(sequence *run)
{
    hewn_vert v;
    hewn_half h = any_half(run);
    hewn_vert tail = hewn_half_tail(run->mesh, h);
    assert_works(hewn_mesh_split(run->mesh, h, random_unit(&run->random), &v, error));
    assert_int_equal(hewn_half_head(run->mesh, h).id, v.id);
    assert_int_equal(hewn_half_tail(run->mesh, h).id, tail.id);
    return true;
}

static bool collapse(sequence *run)
{
    hewn_half h = any_half(run);
    if (!hewn_mesh_can_collapse(run->mesh, h))
        return false;
    hewn_vert tail = hewn_half_tail(run->mesh, h), head = hewn_half_head(run->mesh, h);
    hewn_mesh_collapse(run->mesh, h);
    assert_false(hewn_mesh_has_vert(run->mesh, tail));
    assert_true(hewn_mesh_has_vert(run->mesh, head));
    return true;
}

/* Area over squared side lengths of the triangle that begins at a half-edge. */
static double shape(const hewn_mesh *mesh, hewn_half h)
{
    const double *a = hewn_vert_position(mesh, hewn_half_tail(mesh, h));
    const double *b = hewn_vert_position(mesh, hewn_half_head(mesh, h));
    const double *c = hewn_vert_position(mesh, hewn_half_head(mesh, hewn_half_next(mesh, h)));
    double area = 0, sides = 0;
    for (int k = 0; k < 3; k++) {
        int u = (k + 1) % 3, v = (k + 2) % 3;
        double part = (b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u]);
        area += part * part;
        sides += (b[k] - a[k]) * (b[k] - a[k]) + (c[k] - b[k]) * (c[k] - b[k]) + (a[k] - c[k]) * (a[k] - c[k]);
    }
    return sides > 0 ? sqrt(area) / sides : 0;
}

/* Beside a face that is not flat the new vertex goes where the blend says, so that values keep following. */
static bool poke(sequence *run)
{
    hewn_face f = any_face(run);
    double middle[3] = {0};
    uint32_t degree = hewn_face_degree(run->mesh, f);
    hewn_half h = hewn_face_half(run->mesh, f);
    for (uint32_t i = 0; i < degree; i++, h = hewn_half_next(run->mesh, h))
        for (int k = 0; k < 3; k++)
            middle[k] += hewn_vert_position(run->mesh, hewn_half_head(run->mesh, h))[k] / degree;
    bool well_shaped = shape(run->mesh, hewn_face_half(run->mesh, f)) > 1e-5;
    hewn_vert v;
    assert_works(hewn_mesh_poke(run->mesh, f, middle, &v, error));
    assert_int_equal(hewn_vert_valence(run->mesh, v), degree);
    const double *place =
        hewn_mesh_attribute_read(run->mesh, attribute_named(run->mesh, HEWN_DOMAIN_VERT, "place"), v.id);
    if (degree == 3 && well_shaped)
        assert_same_place(place, middle, 1e-9, "poked vertex", v.id);
    hewn_vert_set_position(run->mesh, v, place);
    set_vert_values(run->mesh, v); /* the floats: weights may be large */
    return true;
}

static bool cut(sequence *run)
{
    hewn_error error;
    hewn_face f = any_face(run);
    if (hewn_face_degree(run->mesh, f) == 3)
        return false;
    hewn_result result = hewn_mesh_triangulate_face(run->mesh, f, &error);
    assert_true(result == HEWN_OK || result == HEWN_INVALID_ARGUMENT);
    assert_int_equal(hewn_face_degree(run->mesh, f) == 3, result == HEWN_OK);
    return result == HEWN_OK;
}

static bool delete_face(sequence *run)
{
    hewn_face f = any_face(run);
    assert_works(hewn_mesh_delete_face(run->mesh, f, error));
    assert_false(hewn_mesh_has_face(run->mesh, f));
    return true;
}

static bool delete_vert(sequence *run)
{
    hewn_vert v = hewn_half_head(run->mesh, any_half(run));
    assert_works(hewn_mesh_delete_vert(run->mesh, v, error));
    assert_false(hewn_mesh_has_vert(run->mesh, v));
    return true;
}

static bool offer_face(sequence *run, const hewn_vert *corners, uint32_t count)
{
    hewn_face f;
    hewn_error error;
    hewn_result result = hewn_mesh_add_face(run->mesh, corners, count, &f, &error);
    assert_true(result == HEWN_OK || result == HEWN_INVALID_ARGUMENT);
    if (result == HEWN_OK)
        set_face_values(run->mesh, f, run->labels++);
    return result == HEWN_OK;
}

/* A half-edge without face if some tries find one. */
static hewn_half boundary_half(sequence *run)
{
    hewn_half h = any_half(run);
    for (int i = 0; i < 20 && hewn_half_face(run->mesh, h).id != HEWN_NONE; i++)
        h = any_half(run);
    return h;
}

/* A triangle at a boundary edge, with a vertex of the loop, of elsewhere, or a new one. */
static bool add_face(sequence *run)
{
    hewn_half h = boundary_half(run);
    if (hewn_half_face(run->mesh, h).id != HEWN_NONE)
        return false;
    hewn_vert corners[3] = {hewn_half_tail(run->mesh, h), hewn_half_head(run->mesh, h), HEWN_VERT_NONE};
    uint32_t choice = random_below(&run->random, 3);
    if (choice == 0) {
        corners[2] = hewn_half_head(run->mesh, hewn_half_next(run->mesh, h));
    } else if (choice == 1) {
        corners[2] = hewn_half_head(run->mesh, any_half(run));
    } else {
        double position[3];
        for (int k = 0; k < 3; k++)
            position[k] = random_unit(&run->random);
        assert_works(hewn_mesh_add_vert(run->mesh, position, &corners[2], error));
        set_vert_values(run->mesh, corners[2]);
    }
    return offer_face(run, corners, 3);
}

static bool close_hole(sequence *run)
{
    hewn_half first = boundary_half(run), h = first;
    hewn_vert corners[12];
    uint32_t count = 0;
    if (hewn_half_face(run->mesh, h).id != HEWN_NONE)
        return false;
    do {
        if (count == 12)
            return false;
        corners[count++] = hewn_half_head(run->mesh, h);
        h = hewn_half_next(run->mesh, h);
    } while (h.id != first.id);
    bool done = offer_face(run, corners, count);
    assert_true(done);
    assert_int_equal(hewn_half_face(run->mesh, first).id != HEWN_NONE, 1);
    return true;
}

static bool reverse(sequence *run)
{
    hewn_mesh_reverse(run->mesh);
    return true;
}

/* The mesh, taken apart into polygons, is accepted by the builder and has the same counts: validation alone could be
 * wrong in the same way as an operation. */
static void assert_builds_again(const hewn_mesh *mesh)
{
    uint32_t faces = hewn_mesh_face_count(mesh), verts = hewn_mesh_vert_count(mesh);
    uint64_t *first = calloc(faces + 1u, sizeof *first);
    uint32_t *corners = malloc((hewn_mesh_half_bound(mesh) + 1u) * sizeof *corners);
    double *positions = malloc((verts + 1u) * 3 * sizeof *positions);
    for (uint32_t v = 0; v < verts; v++)
        memcpy(positions + 3 * v, hewn_vert_position(mesh, (hewn_vert){v}), 3 * sizeof *positions);
    for (uint32_t f = 0; f < faces; f++) {
        uint32_t degree = hewn_face_degree(mesh, (hewn_face){f});
        hewn_half h = hewn_face_half(mesh, (hewn_face){f});
        first[f + 1] = first[f] + degree;
        for (uint32_t i = 0; i < degree; i++, h = hewn_half_next(mesh, h))
            corners[first[f] + i] = hewn_half_head(mesh, h).id;
    }
    hewn_mesh *again = mesh_of(positions, verts, first, corners, faces);
    assert_int_equal(hewn_mesh_edge_count(again), hewn_mesh_edge_count(mesh));
    assert_int_equal(hewn_mesh_face_count(again), faces);
    for (uint32_t v = 0; v < verts; v++)
        assert_int_equal(hewn_vert_valence(again, (hewn_vert){v}), hewn_vert_valence(mesh, (hewn_vert){v}));
    hewn_mesh_destroy(&again);
    free(first);
    free(corners);
    free(positions);
}

/* Isolated vertices, which deleting leaves behind, would add up. */
static bool sweep(sequence *run)
{
    for (uint32_t v = 0; v < hewn_mesh_vert_bound(run->mesh); v++)
        if (hewn_mesh_has_vert(run->mesh, (hewn_vert){v}) && hewn_vert_half(run->mesh, (hewn_vert){v}).id == HEWN_NONE)
            assert_works(hewn_mesh_delete_vert(run->mesh, (hewn_vert){v}, error));
    return true;
}

static bool compact(sequence *run)
{
    uint32_t verts = hewn_mesh_vert_count(run->mesh);
    assert_works(hewn_mesh_compact(run->mesh, error));
    assert_int_equal(hewn_mesh_vert_bound(run->mesh), verts);
    assert_int_equal(hewn_mesh_half_bound(run->mesh), 2 * hewn_mesh_edge_count(run->mesh));
    assert_builds_again(run->mesh);
    return true;
}

static bool (*const kinds[])(sequence *) = {flip,        split, collapse, poke,       cut,     delete_face,
                                            delete_vert, sweep, add_face, close_hole, reverse, compact};

static change choose_kind(sequence *run)
{
    uint32_t faces = hewn_mesh_face_count(run->mesh), choice = random_below(&run->random, 1000);
    if (choice < 10)
        return COMPACT;
    if (choice < 20)
        return REVERSE;
    if (choice < 30)
        return SWEEP;
    if (faces < 4)
        return choice < 500 ? POKE : SPLIT;
    if (faces > MOST_FACES)
        return choice < 900 ? COLLAPSE : DELETE_VERT;
    if (choice < 250)
        return FLIP;
    if (choice < 350)
        return SPLIT;
    if (choice < 650)
        return COLLAPSE;
    if (choice < 700)
        return POKE;
    if (choice < 750)
        return CUT;
    if (choice < 775)
        return DELETE_FACE;
    if (choice < 810)
        return DELETE_VERT;
    return choice < 870 ? ADD_FACE : CLOSE_HOLE;
}

static void step(sequence *run)
{
    change kind = choose_kind(run);
    int64_t before = euler_number(run->mesh), faces = hewn_mesh_face_count(run->mesh);
    uint32_t verts = hewn_mesh_vert_count(run->mesh);
    bool done = kinds[kind](run);
    run->done[kind] += done;
    hewn_error error;
    if (hewn_mesh_validate(run->mesh, &error) != HEWN_OK)
        fail_msg("after %s: %s", kind_names[kind], error.message);
    if (kind <= CUT || kind >= REVERSE)
        assert_int_equal(euler_number(run->mesh), before);
    if (kind == CLOSE_HOLE)
        assert_int_equal(euler_number(run->mesh), before + done);
    if (kind == DELETE_FACE) {
        assert_int_equal(hewn_mesh_face_count(run->mesh), faces - 1);
        assert_true(hewn_mesh_vert_count(run->mesh) >= verts);
    }
    if (random_below(&run->random, 4) == 0)
        assert_values(run->mesh, 0);
}

static void run_from(hewn_mesh *mesh, uint64_t seed)
{
    sequence run = {.mesh = mesh, .random = {seed}, .labels = 1000000};
    uint32_t steps = getenv("HEWN_LONG") ? LONG_RUN : SHORT_RUN;
    add_values(mesh);
    hewn_mesh *start = NULL;
    assert_works(hewn_mesh_duplicate(mesh, &start, error));
    for (uint32_t i = 0; i < steps; i++) {
        step(&run);
        if (hewn_mesh_face_count(run.mesh) == 0) {
            hewn_mesh_destroy(&run.mesh);
            assert_works(hewn_mesh_duplicate(start, &run.mesh, error));
        }
    }
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        if (run.done[kind] == 0)
            fail_msg("%s was never done", kind_names[kind]);
        print_message("# %s: %u\n", kind_names[kind], run.done[kind]);
    }
    hewn_mesh_destroy(&run.mesh);
    hewn_mesh_destroy(&start);
}

static void test_from_tetrahedron(void **state)
{
    (void)state;
    run_from(tetrahedron(), 1);
}

static void test_from_grid(void **state)
{
    (void)state;
    run_from(flat_grid(6, true), 2);
}

static void test_from_cube_of_quads(void **state)
{
    (void)state;
    run_from(quad_cube(), 3);
}

static void test_from_torus(void **state)
{
    (void)state;
    run_from(torus(7, 5), 4);
}

static void test_from_grid_of_quads(void **state)
{
    (void)state;
    run_from(flat_grid(5, false), 5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_from_tetrahedron),   cmocka_unit_test(test_from_grid),
        cmocka_unit_test(test_from_cube_of_quads), cmocka_unit_test(test_from_torus),
        cmocka_unit_test(test_from_grid_of_quads),
    };
    return cmocka_run_group_tests_name("mesh_random", tests, NULL, NULL);
}
