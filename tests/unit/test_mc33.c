/* The topology of the trilinear interpolant: the derived patches joined into meshes of random grids, of which every one
 * must be a closed manifold with the interpolant's Euler number and components. HEWN_LONG asks for ten thousand grids
 * of each kind, else it is a thousand in all. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "../oracle/mc33.h"
#include "../oracle/random_grid.h"
#include "../oracle/trilinear.h"
#include "hewn/check.h"
#include "iso/cube.h"

static hewn_mc33_table table;

static int derive_table(void **state)
{
    (void)state;
    return hewn_mc33_table_derive(&table, NULL) == HEWN_OK ? 0 : -1;
}

static int drop_table(void **state)
{
    (void)state;
    hewn_mc33_table_destroy(&table);
    return 0;
}

/* --- patches ------------------------------------------------------------------------------------------------------ */

static uint32_t uses_of(const hewn_patch *patch, uint32_t a, uint32_t b)
{
    uint32_t uses = 0;
    for (uint32_t t = 0; t < patch->triangle_count; t++)
        for (uint32_t c = 0; c < 3; c++)
            uses += patch->corners[t][c] == a && patch->corners[t][(c + 1) % 3] == b;
    return uses;
}

/* What the proof in mc33.h leans on: edges in a face are used one way and once, all others both ways and once, and
 * each crossed edge has one fan. */
static void check_patch(uint32_t pattern, const hewn_patch *patch)
{
    for (uint32_t a = 0; a < 16; a++) {
        uint32_t border = 0, used = 0;
        for (uint32_t b = 0; b < 16; b++) {
            uint32_t there = uses_of(patch, a, b), back = uses_of(patch, b, a);
            bool face = a < 12 && b < 12 && hewn_cube_edges_share_face(a, b);
            assert_true(there <= 1);
            assert_true(there + back <= (face ? 1 : 2));
            assert_true(face || there == back);
            border += face ? there : 0;
            used += there;
        }
        uint32_t start = a < 12 ? hewn_cube_edge_start(a) : 0;
        bool crossed = a < 12 && (pattern >> start & 1) != (pattern >> (start | 1u << a / 4) & 1);
        assert_int_equal(border, crossed);
        assert_int_equal(used > 0, crossed || (a >= 12 && a < 12 + patch->centre_count));
    }
}

static void test_patches_are_manifold(void **state)
{
    (void)state;
    for (uint32_t pattern = 0; pattern < 256; pattern++)
        for (uint32_t joined = 0; joined < 64; joined++)
            for (int join = 0; join < HEWN_MC33_JOINS; join++) {
                hewn_patch patch;
                if (joined & ~hewn_mc33_ambiguous(pattern))
                    continue;
                hewn_mc33_patch(pattern, joined, (hewn_mc33_join)join, &patch);
                check_patch(pattern, &patch);
            }
}

/* Connected pieces, by following triangles. */
static uint32_t count_pieces(const hewn_patch *patch)
{
    uint32_t piece[16], pieces = 0;
    for (uint32_t i = 0; i < 16; i++)
        piece[i] = 16;
    for (uint32_t t = 0; t < patch->triangle_count; t++)
        for (uint32_t c = 0; c < 3; c++)
            piece[patch->corners[t][c]] = patch->corners[t][c];
    for (uint32_t round = 0; round < 16; round++)
        for (uint32_t t = 0; t < patch->triangle_count; t++) {
            uint32_t least = 16;
            for (uint32_t c = 0; c < 3; c++)
                least = piece[patch->corners[t][c]] < least ? piece[patch->corners[t][c]] : least;
            for (uint32_t c = 0; c < 3; c++)
                piece[patch->corners[t][c]] = least;
        }
    for (uint32_t i = 0; i < 16; i++)
        pieces += piece[i] == i;
    return pieces;
}

/* Each combination of decisions that a cell can have, found by random cells: the patch has the cell's own pieces. */
static void test_cells_have_their_pieces(void **state)
{
    (void)state;
    uint64_t random = 5;
    uint32_t joins = 0, trials = getenv("HEWN_LONG") ? 1000000 : 40000;
    for (uint32_t trial = 0; trial < trials; trial++) {
        double values[8];
        uint32_t pattern = 0;
        for (uint32_t c = 0; c < 8; c++) {
            values[c] = random_value(&random, (random_kind)(trial % RANDOM_KINDS));
            pattern |= (values[c] < 0 ? 1u : 0u) << c;
        }
        oracle_cell cell = oracle_trilinear_cell(values);
        hewn_patch patch;
        uint32_t parts = 0;
        hewn_mc33_join join = oracle_mc33_join(values);
        hewn_mc33_patch(pattern, oracle_mc33_joined(values), join, &patch);
        for (uint32_t a = 0; a < 8; a++) {
            bool first = true;
            for (uint32_t b = 0; b < a; b++)
                first &= cell.label[a] != cell.label[b];
            parts += first;
        }
        assert_int_equal(count_pieces(&patch) + 1, parts);
        joins += join != HEWN_MC33_NO_JOIN;
    }
    assert_true(joins > 0);
}

/* --- grids -------------------------------------------------------------------------------------------------------- */

enum { N = 8 };

static bool check_grid(uint32_t seed, random_kind kind)
{
    static const uint32_t samples[3] = {N, N, N};
    double values[N * N * N];
    random_grid(seed, kind, N, values);
    hewn_triangles mesh = oracle_mc33(samples, values, &table);
    oracle_topology exact = oracle_trilinear(samples, values);
    hewn_certificate certificate;
    hewn_error error = {0};
    if (hewn_certify(&mesh, NULL, &certificate, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    int64_t euler = (int64_t)mesh.vertex_count - (int64_t)mesh.triangle_count / 2;
    bool whole = certificate.closed && certificate.manifold && certificate.oriented;
    bool same = euler == exact.euler && certificate.components == exact.components;
    if (!whole || !same)
        print_error("%s, seed %u: closed %d, manifold %d, Euler number %lld, not %lld, components %llu, not %llu\n",
                    random_kind_names[kind], (unsigned)seed, certificate.closed, certificate.manifold, (long long)euler,
                    (long long)exact.euler, (unsigned long long)certificate.components,
                    (unsigned long long)exact.components);
    hewn_triangles_destroy(&mesh);
    return whole && same;
}

static void check_grids(random_kind kind)
{
    uint32_t grids = getenv("HEWN_LONG") ? 10000 : 250, failed = 0;
    for (uint32_t seed = 0; seed < grids; seed++)
        failed += !check_grid(seed, kind);
    if (failed)
        fail_msg("%u of %u grids fail", (unsigned)failed, (unsigned)grids);
}

static void test_uniform(void **state)
{
    (void)state;
    check_grids(RANDOM_UNIFORM);
}

static void test_normal(void **state)
{
    (void)state;
    check_grids(RANDOM_NORMAL);
}

static void test_small_integers(void **state)
{
    (void)state;
    check_grids(RANDOM_INTEGERS);
}

static void test_at_the_iso_value(void **state)
{
    (void)state;
    check_grids(RANDOM_AT_ISO);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_patches_are_manifold),
        cmocka_unit_test(test_cells_have_their_pieces),
        cmocka_unit_test(test_uniform),
        cmocka_unit_test(test_normal),
        cmocka_unit_test(test_small_integers),
        cmocka_unit_test(test_at_the_iso_value),
    };
    return cmocka_run_group_tests_name("mc33", tests, derive_table, drop_table);
}
