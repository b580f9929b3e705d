/* The check against twins that count the slow and obvious way, on random soups of small polygons. */
#include "base/alloc.h"
#include "geom/triangle_meet.h"
#include "mesh/cut.h"
#include "test_check_support.h"

enum { MOST_VERTICES = 14, MOST_FACES = 40, MOST_SIDES = 8 };

/* --- the twin ----------------------------------------------------------------------------------------------------- */

typedef struct twin {
    const soup *of;
    uint64_t faces; /* with sides */
    uint64_t vertices, edges, boundary, crowded, unoriented, bad_vertices, components, loops, duplicates, degenerate,
        isolated;
    bool one_sided;
} twin;

static uint32_t length_of(const soup *s, uint64_t f)
{
    return (uint32_t)(s->first[f + 1] - s->first[f]);
}

static uint32_t corner_of(const soup *s, uint64_t f, uint32_t i)
{
    return s->corners[s->first[f] + i % length_of(s, f)];
}

static bool has_sides(const soup *s, uint64_t f)
{
    for (uint32_t i = 0; i < length_of(s, f); i++)
        for (uint32_t j = 0; j < i; j++)
            if (corner_of(s, f, i) == corner_of(s, f, j))
                return false;
    return length_of(s, f) >= 3;
}

/* Whether face f goes from a to b. */
static bool runs(const soup *s, uint64_t f, uint32_t a, uint32_t b)
{
    for (uint32_t i = 0; i < length_of(s, f); i++)
        if (corner_of(s, f, i) == a && corner_of(s, f, i + 1) == b)
            return true;
    return false;
}

static bool touches(const soup *s, uint64_t f, uint32_t v)
{
    for (uint32_t i = 0; i < length_of(s, f); i++)
        if (corner_of(s, f, i) == v)
            return true;
    return false;
}

static uint32_t count_uses(const soup *s, uint32_t a, uint32_t b)
{
    uint32_t uses = 0;
    for (uint64_t f = 0; f < s->faces; f++)
        uses += has_sides(s, f) && runs(s, f, a, b);
    return uses;
}

static void twin_edges(twin *t)
{
    const soup *s = t->of;
    for (uint32_t a = 0; a < s->vertices; a++)
        for (uint32_t b = a + 1; b < s->vertices; b++) {
            uint32_t there = count_uses(s, a, b), back = count_uses(s, b, a), uses = there + back;
            t->edges += uses > 0;
            t->boundary += uses == 1;
            t->crowded += uses > 2;
            t->unoriented += uses > 1 && there != back;
        }
}

/* Whether two faces share an edge, one that ends at `at` where that is a vertex. */
static bool share_edge(const soup *s, uint64_t f, uint64_t g, uint32_t at)
{
    for (uint32_t i = 0; i < length_of(s, f); i++) {
        uint32_t a = corner_of(s, f, i), b = corner_of(s, f, i + 1);
        if ((at == UINT32_MAX || a == at || b == at) && (runs(s, g, a, b) || runs(s, g, b, a)))
            return true;
    }
    return false;
}

static bool share_vertex(const soup *s, uint64_t f, uint64_t g)
{
    for (uint32_t i = 0; i < length_of(s, f); i++)
        if (touches(s, g, corner_of(s, f, i)))
            return true;
    return false;
}

/* Groups of the faces at a vertex that hang together by edges there, or (without a vertex) of all by vertices; the
 * group of each face is its least member. */
static uint32_t find_groups(const soup *s, uint32_t at, uint32_t *group)
{
    uint32_t count = 0;
    for (uint32_t f = 0; f < s->faces; f++)
        group[f] = has_sides(s, f) && (at == UINT32_MAX || touches(s, f, at)) ? f : UINT32_MAX;
    for (bool changed = true; changed;) {
        changed = false;
        for (uint32_t f = 0; f < s->faces; f++)
            for (uint32_t g = 0; g < s->faces; g++)
                if (group[f] != UINT32_MAX && group[g] != UINT32_MAX && group[g] < group[f] &&
                    (at == UINT32_MAX ? share_vertex(s, f, g) : share_edge(s, f, g, at))) {
                    group[f] = group[g];
                    changed = true;
                }
    }
    for (uint32_t f = 0; f < s->faces; f++)
        count += group[f] == f;
    return count;
}

static void twin_vertices(twin *t)
{
    const soup *s = t->of;
    uint32_t group[MOST_FACES];
    for (uint32_t v = 0; v < s->vertices; v++) {
        bool named = false, crowded = false;
        for (uint64_t f = 0; f < s->faces; f++)
            named = named || touches(s, f, v);
        for (uint32_t w = 0; w < s->vertices; w++)
            crowded = crowded || (w != v && count_uses(s, v, w) + count_uses(s, w, v) > 2);
        uint32_t fans = find_groups(s, v, group);
        t->vertices += fans > 0;
        t->isolated += !named;
        t->bad_vertices += crowded || fans > 1;
    }
    t->components = find_groups(s, UINT32_MAX, group);
}

/* Sides without a partner; two belong to one loop where they end in one fan of a vertex. */
typedef struct lone_side {
    uint32_t face, tail, head, loop;
} lone_side;

static bool meet_in_fan(const soup *s, const lone_side *a, const lone_side *b)
{
    uint32_t group[MOST_FACES];
    const uint32_t ends[2] = {a->tail, a->head};
    for (int k = 0; k < 2; k++) {
        if (ends[k] != b->tail && ends[k] != b->head)
            continue;
        find_groups(s, ends[k], group);
        if (group[a->face] == group[b->face])
            return true;
    }
    return false;
}

static void twin_loops(twin *t)
{
    const soup *s = t->of;
    lone_side sides[MOST_FACES * MOST_SIDES];
    uint32_t count = 0;
    for (uint32_t f = 0; f < s->faces; f++)
        for (uint32_t i = 0; has_sides(s, f) && i < length_of(s, f); i++) {
            uint32_t a = corner_of(s, f, i), b = corner_of(s, f, i + 1);
            if (count_uses(s, a, b) + count_uses(s, b, a) == 1) {
                sides[count] = (lone_side){f, a, b, count};
                count++;
            }
        }
    for (bool changed = true; changed;) {
        changed = false;
        for (uint32_t i = 0; i < count; i++)
            for (uint32_t j = 0; j < count; j++)
                if (sides[j].loop < sides[i].loop && meet_in_fan(s, &sides[i], &sides[j])) {
                    sides[i].loop = sides[j].loop;
                    changed = true;
                }
    }
    for (uint32_t i = 0; i < count; i++)
        t->loops += sides[i].loop == i;
}

/* Colours faces so that those beside an edge of two agree, as long as that goes. */
static void twin_orient(twin *t)
{
    const soup *s = t->of;
    int turn[MOST_FACES] = {0};
    for (uint32_t seed = 0; seed < s->faces; seed++) {
        if (!has_sides(s, seed) || turn[seed] != 0)
            continue;
        turn[seed] = 1;
        for (bool changed = true; changed;) {
            changed = false;
            for (uint32_t a = 0; a < s->vertices; a++)
                for (uint32_t b = a + 1; b < s->vertices; b++) {
                    if (count_uses(s, a, b) + count_uses(s, b, a) != 2)
                        continue;
                    uint32_t pair[2] = {0}, count = 0;
                    for (uint32_t f = 0; f < s->faces; f++)
                        if (has_sides(s, f) && (runs(s, f, a, b) || runs(s, f, b, a)))
                            pair[count++] = f;
                    int wanted = runs(s, pair[0], a, b) == runs(s, pair[1], a, b) ? -1 : 1;
                    for (int k = 0; k < 2; k++)
                        if (turn[pair[k]] != 0 && turn[pair[1 - k]] == 0) {
                            turn[pair[1 - k]] = wanted * turn[pair[k]];
                            changed = true;
                        }
                    t->one_sided = t->one_sided || turn[pair[0]] * turn[pair[1]] == -wanted;
                }
        }
    }
}

static bool same_cycle(const soup *s, uint64_t f, uint64_t g)
{
    uint32_t length = length_of(s, f);
    if (length_of(s, g) != length)
        return false;
    for (uint32_t turn = 0; turn < length; turn++)
        for (int back = 0; back < 2; back++) {
            bool same = true;
            for (uint32_t i = 0; i < length && same; i++)
                same = corner_of(s, f, i) == corner_of(s, g, back ? 2 * length + turn - i : turn + i);
            if (same)
                return true;
        }
    return length == 0;
}

/* Positions are small integers here, so plain arithmetic is exact. */
static bool on_line(const double *a, const double *b, const double *c)
{
    for (int k = 0; k < 3; k++) {
        int u = (k + 1) % 3, v = (k + 2) % 3;
        if ((b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u]) != 0)
            return false;
    }
    return true;
}

static bool is_flat(const soup *s, uint64_t f)
{
    for (uint32_t i = 0; i < length_of(s, f); i++)
        for (uint32_t j = 0; j < i; j++)
            for (uint32_t k = 0; k < j; k++)
                if (!on_line(s->positions + 3 * (size_t)corner_of(s, f, i),
                             s->positions + 3 * (size_t)corner_of(s, f, j),
                             s->positions + 3 * (size_t)corner_of(s, f, k)))
                    return false;
    return true;
}

static void twin_faces(twin *t)
{
    const soup *s = t->of;
    for (uint64_t f = 0; f < s->faces; f++) {
        bool again = false;
        for (uint64_t g = 0; g < f; g++)
            again = again || same_cycle(s, f, g);
        t->duplicates += again;
        t->faces += has_sides(s, f);
        t->degenerate += !has_sides(s, f) || is_flat(s, f);
    }
}

/* Faces whose triangles meet improperly, pair by pair. */
static uint64_t twin_crossings(const soup *s, uint32_t (*pairs)[2])
{
    hewn_polygons polygons = polygons_of(s);
    uint32_t *corners, owner[MOST_FACES * MOST_SIDES];
    uint64_t count, at = 0, found = 0;
    bool meet[MOST_FACES][MOST_FACES] = {{false}};
    assert_int_equal(hewn_cut_polygons(&polygons, &corners, &count, NULL, NULL), HEWN_OK);
    for (uint32_t f = 0; f < s->faces; f++)
        for (uint32_t i = 2; i < length_of(s, f); i++)
            owner[at++] = f;
    assert_int_equal(at, count);
    for (uint64_t a = 0; a < count; a++)
        for (uint64_t b = 0; b < a; b++) {
            hewn_facet facets[2];
            for (int k = 0; k < 3; k++) {
                facets[0].index[k] = s->corners[corners[3 * a + (uint64_t)k]];
                facets[1].index[k] = s->corners[corners[3 * b + (uint64_t)k]];
                for (int j = 0; j < 2; j++)
                    memcpy(facets[j].point[k], s->positions + 3 * (size_t)facets[j].index[k],
                           sizeof facets[j].point[k]);
            }
            uint32_t f = owner[b], g = owner[a];
            bool itself = f == g && (!has_sides(s, f) || is_flat(s, f));
            meet[f][g] = meet[f][g] || (!itself && hewn_facets_meet_improperly(&facets[0], &facets[1]));
        }
    for (uint32_t f = 0; f < s->faces; f++)
        for (uint32_t g = f; g < s->faces; g++)
            if (meet[f][g]) {
                pairs[found][0] = f;
                pairs[found++][1] = g;
            }
    hewn_free(corners);
    return found;
}

/* --- comparing ---------------------------------------------------------------------------------------------------- */

static void assert_equal(uint64_t got, uint64_t expected, const char *what, int run)
{
    if (got != expected)
        fail_msg("soup %d: %llu %s, the twin counts %llu", run, (unsigned long long)got, what,
                 (unsigned long long)expected);
}

static void assert_as_twin(const soup *s, int run)
{
    static uint32_t pairs[MOST_FACES * MOST_FACES][2];
    twin t = {.of = s};
    twin_edges(&t);
    twin_vertices(&t);
    twin_loops(&t);
    twin_orient(&t);
    twin_faces(&t);
    hewn_check *c = check_soup(s, &(hewn_check_desc){.most_pairs = MOST_FACES * MOST_FACES});
    assert_equal(c->sided_faces, t.faces, "faces with sides", run);
    assert_equal(c->used_vertices, t.vertices, "vertices", run);
    assert_equal(c->edges, t.edges, "edges", run);
    assert_equal(c->certificate.boundary_edges, t.boundary, "boundary edges", run);
    assert_equal(c->certificate.non_manifold_edges, t.crowded, "non-manifold edges", run);
    assert_equal(c->unoriented_edges, t.unoriented, "unoriented edges", run);
    assert_equal(c->certificate.non_manifold_vertices, t.bad_vertices, "non-manifold vertices", run);
    assert_equal(c->certificate.components, t.components, "components", run);
    assert_equal(c->boundary_loops, t.loops, "boundary loops", run);
    assert_equal(!c->orientable, t.one_sided, "one-sided", run);
    assert_equal(c->duplicate_faces, t.duplicates, "duplicate faces", run);
    assert_equal(c->certificate.degenerate_faces, t.degenerate, "degenerate faces", run);
    assert_equal(c->isolated_vertices, t.isolated, "isolated vertices", run);
    assert_equal(c->self_intersections, twin_crossings(s, pairs), "self-intersections", run);
    if (c->pair_count > 0)
        assert_memory_equal(c->pairs, pairs, c->pair_count * sizeof *pairs);
    hewn_component sum = {0};
    for (uint32_t k = 0; k < c->component_count; k++) {
        sum.faces += c->components[k].faces;
        sum.edges += c->components[k].edges;
        sum.vertices += c->components[k].vertices;
        sum.boundary_loops += c->components[k].boundary_loops;
        sum.euler += c->components[k].euler;
        bool genus_known = c->components[k].manifold;
        assert_true(genus_known ? c->components[k].genus >= 0 : c->components[k].genus == -1);
    }
    assert_equal(sum.faces, t.faces, "faces of components", run);
    assert_equal(sum.edges, t.edges, "edges of components", run);
    assert_equal(sum.vertices, t.vertices, "vertices of components", run);
    assert_equal(sum.boundary_loops, t.loops, "loops of components", run);
    assert_true(sum.euler == c->euler);
    hewn_check_destroy(&c);
}

static void add_points(soup *s, uint32_t count, random_state *random)
{
    for (uint32_t v = 0; v < count; v++)
        add_point(s, random_below(random, 4), random_below(random, 4), random_below(random, 4));
}

static void test_random_polygons(void **state)
{
    (void)state;
    random_state random = {1};
    for (int run = 0; run < (getenv("HEWN_LONG") ? 5000 : 250); run++) {
        soup *s = make_soup();
        uint32_t vertices = 3 + random_below(&random, MOST_VERTICES - 2), faces = random_below(&random, 16);
        add_points(s, vertices, &random);
        for (uint32_t f = 0; f < faces; f++) {
            uint32_t corners[MOST_SIDES], count = run % 2 ? 3 + random_below(&random, 3) : random_below(&random, 7);
            for (uint32_t i = 0; i < count; i++)
                corners[i] = random_below(&random, run % 3 || vertices < 5 ? vertices : 5);
            add_polygon(s, corners, count);
        }
        assert_as_twin(s, run);
        free(s);
    }
}

/* Pieces of a grid of quads, its sides glued in one way or another: many are manifold. */
static void test_random_sheets(void **state)
{
    (void)state;
    random_state random = {2};
    for (int run = 0; run < (getenv("HEWN_LONG") ? 5000 : 250); run++) {
        soup *s = make_soup();
        uint32_t n = 3 + random_below(&random, 2), m = 3, around = random_below(&random, 3);
        add_points(s, n * m, &random);
        for (uint32_t i = 0; i + (around == 0) < n; i++)
            for (uint32_t j = 0; j < m; j++) {
                uint32_t k = (j + 1) % m, flip = around == 2 && i + 1 == n, at = (i + 1) % n * m;
                if (random_below(&random, 8) == 0)
                    continue;
                uint32_t quad[4] = {i * m + j, at + (flip ? (m - j) % m : j), at + (flip ? (m - k) % m : k), i * m + k};
                if (random_below(&random, 8) == 0)
                    add_quad(s, quad[3], quad[2], quad[1], quad[0]);
                else if (random_below(&random, 3) == 0)
                    add_triangle(s, quad[0], quad[1], quad[2]);
                else
                    add_polygon(s, quad, 4);
            }
        assert_as_twin(s, run);
        free(s);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random_polygons),
        cmocka_unit_test(test_random_sheets),
    };
    return cmocka_run_group_tests_name("check_soups", tests, NULL, NULL);
}
