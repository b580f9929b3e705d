/* Pairs of faces against an oracle of another kind: it cuts one triangle with the other's half-spaces in rational
 * numbers and looks whether a corner of what is left is outside of what the faces share. */
#include "geom/triangle_meet.h"
#include "test_exact_support.h"

/* --- the oracle --------------------------------------------------------------------------------------------------- */

enum { MOST = 12 };

/* A convex polygon in space as its corners in order, which may coincide; empty where count is 0. */
typedef struct polygon {
    int count;
    rational_point corner[MOST];
} polygon;

static void open_polygon(polygon *p)
{
    p->count = 0;
    for (int k = 0; k < MOST; k++)
        open_point(&p->corner[k]);
}

static void close_polygon(polygon *p)
{
    for (int k = 0; k < MOST; k++)
        close_point(&p->corner[k]);
}

static void add_corner(polygon *p, const rational_point *at)
{
    assert_true(p->count < MOST);
    for (int i = 0; i < 3; i++)
        mpq_set(p->corner[p->count].at[i], at->at[i]);
    p->count++;
}

/* normal · (x - origin). */
static void height(mpq_t out, const rational_point *normal, const rational_point *origin, const rational_point *x)
{
    rational_point difference;
    open_point(&difference);
    subtract_points(&difference, x, origin);
    dot_points(out, normal, &difference);
    close_point(&difference);
}

/* a + (b - a) s / (s - t): where a line from height s to height t is at height 0. */
static void add_crossing(polygon *p, const rational_point *a, const rational_point *b, const mpq_t s, const mpq_t t)
{
    rational_point at;
    mpq_t share;
    open_point(&at);
    mpq_init(share);
    mpq_sub(share, s, t);
    mpq_div(share, s, share);
    subtract_points(&at, b, a);
    for (int i = 0; i < 3; i++) {
        mpq_mul(at.at[i], at.at[i], share);
        mpq_add(at.at[i], at.at[i], a->at[i]);
    }
    add_corner(p, &at);
    close_point(&at);
    mpq_clear(share);
}

/* Keeps what of p has sign × height >= 0. */
static void cut(polygon *p, const rational_point *normal, const rational_point *origin, int sign)
{
    polygon kept;
    mpq_t here, next;
    mpq_init(here);
    mpq_init(next);
    open_polygon(&kept);
    for (int k = 0; k < p->count; k++) {
        const rational_point *a = &p->corner[k], *b = &p->corner[(k + 1) % p->count];
        height(here, normal, origin, a);
        height(next, normal, origin, b);
        if (mpq_sgn(here) * sign >= 0)
            add_corner(&kept, a);
        if (mpq_sgn(here) * mpq_sgn(next) < 0)
            add_crossing(&kept, a, b, here, next);
    }
    p->count = 0;
    for (int k = 0; k < kept.count; k++)
        add_corner(p, &kept.corner[k]);
    close_polygon(&kept);
    mpq_clear(here);
    mpq_clear(next);
}

static bool is_zero(const rational_point *p)
{
    return mpq_sgn(p->at[0]) == 0 && mpq_sgn(p->at[1]) == 0 && mpq_sgn(p->at[2]) == 0;
}

/* Keeps what of p is on the plane. */
static void cut_to_plane(polygon *p, const rational_point *normal, const rational_point *origin)
{
    cut(p, normal, origin, 1);
    cut(p, normal, origin, -1);
}

/* Keeps what of p is on the segment ab, or at a where b is there too. */
static void cut_to_segment(polygon *p, const rational_point *a, const rational_point *b)
{
    rational_point along, unit, normal;
    open_point(&along);
    open_point(&unit);
    open_point(&normal);
    subtract_points(&along, b, a);
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++)
            mpq_set_ui(unit.at[k], k == i, 1);
        if (is_zero(&along)) {
            cut_to_plane(p, &unit, a);
            continue;
        }
        cross_points(&normal, &along, &unit);
        if (!is_zero(&normal))
            cut_to_plane(p, &normal, a);
    }
    if (!is_zero(&along)) {
        cut(p, &along, a, 1);
        cut(p, &along, b, -1);
    }
    close_point(&along);
    close_point(&unit);
    close_point(&normal);
}

/* The two of three collinear points that are farthest from each other. */
static void find_ends(const rational_point t[3], int *first, int *last)
{
    mpq_t longest, length;
    rational_point difference;
    mpq_init(longest);
    mpq_init(length);
    open_point(&difference);
    *first = *last = 0;
    for (int k = 0; k < 3; k++) {
        subtract_points(&difference, &t[k], &t[(k + 1) % 3]);
        dot_points(length, &difference, &difference);
        if (mpq_cmp(length, longest) > 0) {
            mpq_set(longest, length);
            *first = k;
            *last = (k + 1) % 3;
        }
    }
    mpq_clear(longest);
    mpq_clear(length);
    close_point(&difference);
}

static void cut_to_triangle(polygon *p, const rational_point t[3])
{
    rational_point u, v, normal, inward;
    open_point(&u);
    open_point(&v);
    open_point(&normal);
    open_point(&inward);
    subtract_points(&u, &t[1], &t[0]);
    subtract_points(&v, &t[2], &t[0]);
    cross_points(&normal, &u, &v);
    if (is_zero(&normal)) {
        int first, last;
        find_ends(t, &first, &last);
        cut_to_segment(p, &t[first], &t[last]);
    } else {
        cut_to_plane(p, &normal, &t[0]);
        for (int k = 0; k < 3; k++) {
            subtract_points(&u, &t[(k + 1) % 3], &t[k]);
            cross_points(&inward, &normal, &u);
            cut(p, &inward, &t[k], 1);
        }
    }
    close_point(&u);
    close_point(&v);
    close_point(&normal);
    close_point(&inward);
}

/* Whether x is on the segment ab. */
static bool on_segment(const rational_point *a, const rational_point *b, const rational_point *x)
{
    polygon p;
    open_polygon(&p);
    add_corner(&p, x);
    cut_to_segment(&p, a, b);
    bool on = p.count > 0;
    close_polygon(&p);
    return on;
}

/* The corners of f whose vertices g has too, each vertex once. */
static int find_shared(const hewn_facet *f, const hewn_facet *g, int shared[3])
{
    int count = 0;
    for (int i = 0; i < 3; i++) {
        bool seen = false, has = false;
        for (int k = 0; k < i; k++)
            seen = seen || f->index[k] == f->index[i];
        for (int k = 0; k < 3; k++)
            has = has || g->index[k] == f->index[i];
        if (has && !seen)
            shared[count++] = i;
    }
    return count;
}

static bool oracle(const hewn_facet *f, const hewn_facet *g)
{
    int shared[3], count = find_shared(f, g, shared);
    if (count == 3)
        return true;
    rational_point first[3], second[3];
    polygon common;
    open_polygon(&common);
    for (int k = 0; k < 3; k++) {
        open_point(&first[k]);
        open_point(&second[k]);
        set_point(&first[k], f->point[k]);
        set_point(&second[k], g->point[k]);
        add_corner(&common, &first[k]);
    }
    cut_to_triangle(&common, second);
    bool improper = false;
    for (int k = 0; k < common.count && !improper; k++)
        improper = count == 0 || !on_segment(&first[shared[0]], &first[shared[count - 1]], &common.corner[k]);
    close_polygon(&common);
    for (int k = 0; k < 3; k++) {
        close_point(&first[k]);
        close_point(&second[k]);
    }
    return improper;
}

/* --- pairs -------------------------------------------------------------------------------------------------------- */

/* Faces of corners from a pool of vertices, `shared` of them common, the rest of their own; turned and mirrored at
 * random. Corners of one face may be one vertex where `collapse` is set. */
static void make_pair(random_state *random, double (*vertex)[3], int shared, bool collapse, hewn_facet *f,
                      hewn_facet *g)
{
    uint32_t own[2][3] = {{0, 1, 2}, {3, 4, 5}};
    for (int k = 0; k < shared; k++)
        own[1][k] = (uint32_t)k;
    if (collapse)
        own[random_below(random, 2)][random_below(random, 3)] = random_below(random, 6);
    hewn_facet *facets[2] = {f, g};
    for (int side = 0; side < 2; side++) {
        uint32_t turn = random_below(random, 3), step = 1 + random_below(random, 2);
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t v = own[side][(turn + k * step) % 3];
            facets[side]->index[k] = v;
            memcpy(facets[side]->point[k], vertex[v], sizeof vertex[v]);
        }
    }
}

typedef struct tally {
    int proper, improper;
} tally;

static void check_pair(const hewn_facet *f, const hewn_facet *g, tally *sum)
{
    bool expected = oracle(f, g), forth = hewn_facets_meet_improperly(f, g), back = hewn_facets_meet_improperly(g, f);
    if (forth != expected || back != expected) {
        for (int k = 0; k < 3; k++)
            print_message("# %u (%a %a %a)  %u (%a %a %a)\n", f->index[k], f->point[k][0], f->point[k][1],
                          f->point[k][2], g->index[k], g->point[k][0], g->point[k][1], g->point[k][2]);
        fail_msg("%d and %d, expected %d", forth, back, expected);
    }
    *(expected ? &sum->improper : &sum->proper) += 1;
}

/* Random pairs from a grid of `size` points a side (flat where axes is 2, on a line where it is 1). */
static void check_grid(int rounds, uint32_t size, int axes, uint64_t seed)
{
    random_state random = {seed};
    for (int shared = 0; shared < 3; shared++) {
        tally sum = {0};
        for (int round = 0; round < rounds; round++) {
            double vertex[6][3] = {0};
            uint32_t turn = random_below(&random, 3);
            for (int k = 0; k < 6 * axes; k++)
                vertex[k / axes][((uint32_t)(k % axes) + turn) % 3] = random_below(&random, size);
            hewn_facet f, g;
            make_pair(&random, vertex, shared, random_below(&random, 10) == 0, &f, &g);
            check_pair(&f, &g, &sum);
        }
        assert_true(sum.proper > rounds / 100 && sum.improper > rounds / 100);
    }
}

static void test_small_grid(void **state)
{
    (void)state;
    check_grid(effort(3000, 35), 3, 3, 1);
}

static void test_larger_grid(void **state)
{
    (void)state;
    check_grid(effort(3000, 35), 4, 3, 2);
}

static void test_plane_grid(void **state)
{
    (void)state;
    check_grid(effort(3000, 35), 4, 2, 3);
}

static void test_line_grid(void **state)
{
    (void)state;
    check_grid(effort(1000, 25), 5, 1, 4);
}

/* One face without area, a short segment or a point, in, on and around the other. */
static void test_without_area(void **state)
{
    (void)state;
    random_state random = {8};
    for (int shared = 0; shared < 3; shared++) {
        tally sum = {0};
        for (int round = 0, rounds = effort(2000, 35); round < rounds; round++) {
            double vertex[6][3] = {0};
            int axes = 2 + (int)random_below(&random, 2), step[3];
            for (int k = 0; k < 4 * axes; k++)
                vertex[k / axes][k % axes] = random_below(&random, 9);
            for (int i = 0; i < 3; i++)
                step[i] = (int)random_below(&random, 3) - 1;
            const double *from = vertex[shared > 0 ? 0 : 3];
            for (int k = shared > 1 ? 1 : 4; k < 6; k += k == 1 ? 4 : 1) {
                int steps = (int)random_below(&random, 5) - 2;
                for (int i = 0; i < 3; i++)
                    vertex[k][i] = from[i] + (i < axes ? steps * step[i] : 0);
            }
            hewn_facet f, g;
            make_pair(&random, vertex, shared, false, &f, &g);
            check_pair(&f, &g, &sum);
        }
        assert_true(sum.proper > 100 && sum.improper > 10);
    }
}

/* Every way to put five corners of two faces that share a vertex, and four of two that share an edge, on the corners of
 * a cube; and of two that share none, one way for each set of three. */
static void test_all_on_a_cube(void **state)
{
    (void)state;
    tally sum = {0};
    random_state random = {5};
    static const int bits[3] = {18, 15, 12};
    for (int shared = 0; shared < 3; shared++)
        for (uint32_t code = 0; code < 1u << bits[shared]; code += shared == 0 && !getenv("HEWN_LONG") ? 29 : 1) {
            double vertex[6][3] = {0};
            for (uint32_t k = 0, from = code; k < 6; k++) {
                if (k >= 3 && k < 3 + (uint32_t)shared)
                    continue;
                for (int i = 0; i < 3; i++, from >>= 1)
                    vertex[k][i] = from & 1;
            }
            hewn_facet f, g;
            make_pair(&random, vertex, shared, false, &f, &g);
            check_pair(&f, &g, &sum);
        }
    assert_true(sum.proper > 1000 && sum.improper > 1000);
}

/* Corners on or by the other face's plane, edges and corners, as near as doubles go. */
static void test_nearly_touching(void **state)
{
    (void)state;
    random_state random = {6};
    tally sum = {0};
    for (int round = 0, rounds = effort(3000, 25); round < rounds; round++) {
        double vertex[6][3], far = random_below(&random, 2) * 1000.0;
        for (int k = 0; k < 9; k++)
            vertex[k / 3][k % 3] = far + random_unit(&random);
        for (int k = 3; k < 6; k++) {
            double s = random_below(&random, 4) * 0.5 - 0.5, t = random_below(&random, 3) * 0.5;
            for (int i = 0; i < 3; i++) {
                double u = vertex[1][i] - vertex[0][i], v = vertex[2][i] - vertex[0][i];
                vertex[k][i] =
                    random_below(&random, 4) == 0 && k > 3 ? far + random_unit(&random) : vertex[0][i] + s * u + t * v;
                vertex[k][i] = nudge(&random, vertex[k][i]);
            }
        }
        hewn_facet f, g;
        make_pair(&random, vertex, (int)random_below(&random, 3), false, &f, &g);
        check_pair(&f, &g, &sum);
    }
    assert_true(sum.proper > 100 && sum.improper > 100);
}

/* --- by name ------------------------------------------------------------------------------------------------------ */

static bool meet(const double f[9], const double g[9], const uint32_t index[6])
{
    hewn_facet a, b;
    memcpy(a.point, f, sizeof a.point);
    memcpy(b.point, g, sizeof b.point);
    memcpy(a.index, index, sizeof a.index);
    memcpy(b.index, index + 3, sizeof b.index);
    return hewn_facets_meet_improperly(&a, &b);
}

static void test_named(void **state)
{
    (void)state;
    static const double flat[9] = {0, 0, 0, 4, 0, 0, 0, 4, 0};
    static const uint32_t none[6] = {0, 1, 2, 3, 4, 5}, vertex[6] = {0, 1, 2, 0, 4, 5}, edge[6] = {0, 1, 2, 1, 0, 5},
                          all[6] = {0, 1, 2, 2, 0, 1};
    assert_true(meet(flat, (double[]){1, 1, -1, 1, 1, 1, 9, 9, 9}, none));    /* crosses */
    assert_true(meet(flat, (double[]){1, 1, 0, 1, 1, 1, 9, 9, 9}, none));     /* touches with a corner */
    assert_true(meet(flat, (double[]){0, 0, 0, -1, -1, 1, -1, -2, 1}, none)); /* corner on corner, not by index */
    assert_false(meet(flat, (double[]){0, 0, 0, -1, -1, 1, -1, -2, 1}, vertex));
    assert_true(meet(flat, (double[]){1, 1, 0, 2, 1, 0, 1, 2, 0}, none));       /* lies inside */
    assert_false(meet(flat, (double[]){3, 3, 0, 5, 3, 0, 3, 5, 0}, none));      /* beside it in the plane */
    assert_false(meet(flat, (double[]){0, 0, 1, 4, 0, 1, 0, 4, 1}, none));      /* above it */
    assert_true(meet(flat, (double[]){0, 0, 0, 1, 1, 0, 1, 1, 3}, vertex));     /* leaves the vertex along the face */
    assert_false(meet(flat, (double[]){0, 0, 0, -1, 1, 0, -1, 1, 3}, vertex));  /* leaves it away from the face */
    assert_true(meet(flat, (double[]){0, 0, 0, 4, 0, 0, 1, 1, 0}, vertex));     /* one edge too many in common */
    assert_false(meet(flat, (double[]){4, 0, 0, 0, 0, 0, 0, -4, 0}, edge));     /* goes on flat */
    assert_true(meet(flat, (double[]){4, 0, 0, 0, 0, 0, 9, 1, 0}, edge));       /* folds back */
    assert_false(meet(flat, (double[]){4, 0, 0, 0, 0, 0, 9, 1, 1e-300}, edge)); /* does not quite */
    assert_true(meet(flat, (double[]){1, 1, 0, 1.25, 1, 0, 1.5, 1, 0}, none));  /* a segment inside */
    assert_true(meet(flat, (double[]){1, 1, 0, 1, 1, 0, 1, 1, 0}, none));       /* a point inside */
    assert_true(meet(flat, (double[]){0, 4, 0, 0, 0, 0, 4, 0, 0}, all));        /* twice the same */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_named),           cmocka_unit_test(test_small_grid),
        cmocka_unit_test(test_larger_grid),     cmocka_unit_test(test_plane_grid),
        cmocka_unit_test(test_line_grid),       cmocka_unit_test(test_all_on_a_cube),
        cmocka_unit_test(test_nearly_touching), cmocka_unit_test(test_without_area),
    };
    return cmocka_run_group_tests_name("triangle_meet", tests, NULL, NULL);
}
