/* The oracle of the trilinear interpolant against plain refinement: samples of the interpolant on ever finer grids, cut
 * by ordinary marching cubes, must come to the same Euler number and the same number of components. And against its own
 * definition at ties: 0 is outside, as if every value were greater by nearly nothing. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "../oracle/random_grid.h"
#include "../oracle/trilinear.h"
#include "iso/marching_cubes.h"

static hewn_mc_table table;

/* --- refinement --------------------------------------------------------------------------------------------------- */

typedef struct fine_grid {
    uint32_t n; /* samples on a side */
    float *values;
    uint32_t *parent;
} fine_grid;

static double interpolate(const double *values, uint32_t n, const uint32_t at[3], uint32_t times)
{
    double sum = 0;
    for (uint32_t c = 0; c < 8; c++) {
        double weight = 1;
        uint32_t index = 0, scale = 1;
        for (int axis = 0; axis < 3; axis++, scale *= n) {
            uint32_t cell = at[axis] / times == n - 1 ? n - 2 : at[axis] / times;
            double share = (double)(at[axis] - cell * times) / times;
            bool far = c >> axis & 1;
            weight *= far ? share : 1 - share;
            index += scale * (cell + far);
        }
        sum += weight * values[index];
    }
    return sum;
}

static uint32_t find(uint32_t *parent, uint32_t of)
{
    while (parent[of] != of)
        of = parent[of] = parent[parent[of]];
    return of;
}

static void join(uint32_t *parent, uint32_t a, uint32_t b)
{
    parent[find(parent, a)] = find(parent, b);
}

/* Marching cubes' own components: equal neighbours, and the outside across ambiguous faces. */
static void join_around(fine_grid *grid, uint32_t index, const uint32_t at[3])
{
    uint32_t step[3] = {1, grid->n, grid->n * grid->n};
    const float *v = grid->values + index;
    for (int axis = 0; axis < 3; axis++) {
        if (at[axis] + 1 == grid->n)
            continue;
        if ((v[0] < 0) == (v[step[axis]] < 0))
            join(grid->parent, index, index + step[axis]);
        int other = (axis + 1) % 3;
        if (at[other] + 1 == grid->n)
            continue;
        uint32_t a = step[axis], b = step[other];
        if ((v[0] < 0) == (v[a + b] < 0) && (v[a] < 0) == (v[b] < 0))
            join(grid->parent, v[0] < 0 ? index + a : index, v[0] < 0 ? index + b : index + a + b);
    }
}

static uint32_t pattern_at(const fine_grid *grid, uint32_t index)
{
    uint32_t pattern = 0;
    for (uint32_t c = 0; c < 8; c++) {
        uint32_t corner = index + (c & 1) + (c >> 1 & 1) * grid->n + (c >> 2) * grid->n * grid->n;
        pattern |= (grid->values[corner] < 0 ? 1u : 0u) << c;
    }
    return pattern;
}

static oracle_topology refine(const double *values, uint32_t n, uint32_t times)
{
    fine_grid grid = {.n = (n - 1) * times + 1};
    uint32_t count = grid.n * grid.n * grid.n, at[3];
    grid.values = malloc(count * sizeof *grid.values);
    grid.parent = malloc(count * sizeof *grid.parent);
    oracle_topology out = {0};
    int64_t vertices = 0, triangles = 0;
    for (uint32_t i = 0; i < count; i++) {
        grid.parent[i] = i;
        for (uint32_t axis = 0, rest = i; axis < 3; axis++, rest /= grid.n)
            at[axis] = rest % grid.n;
        grid.values[i] = (float)interpolate(values, n, at, times);
    }
    for (uint32_t i = 0; i < count; i++) {
        bool cell = true;
        uint32_t step = 1;
        for (uint32_t axis = 0, rest = i; axis < 3; axis++, rest /= grid.n, step *= grid.n) {
            at[axis] = rest % grid.n;
            bool room = at[axis] + 1 < grid.n;
            vertices += room && (grid.values[i] < 0) != (grid.values[i + step] < 0);
            cell &= room;
        }
        join_around(&grid, i, at);
        if (cell)
            triangles += table.words[pattern_at(&grid, i)][0];
    }
    for (uint32_t i = 0; i < count; i++)
        out.components += grid.parent[i] == i;
    out.components--;
    out.euler = vertices - triangles / 2;
    free(grid.values);
    free(grid.parent);
    return out;
}

static bool same(oracle_topology a, oracle_topology b)
{
    return a.euler == b.euler && a.components == b.components;
}

/* A single cell with free values, or two of them, in a border. */
static void test_as_refined(void **state)
{
    (void)state;
    enum { N = 4 };
    static const uint32_t samples[3] = {N, N, N};
    double values[N * N * N];
    uint32_t joined = 0, grids = getenv("HEWN_LONG") ? 2000 : 200;
    for (uint32_t seed = 0; seed < grids; seed++) {
        random_grid(seed, RANDOM_UNIFORM, N, values);
        oracle_topology exact = oracle_trilinear(samples, values), seen = refine(values, N, 8);
        joined += !same(exact, seen);
        for (uint32_t times = 16; !same(exact, seen) && times <= 64; times *= 2)
            seen = refine(values, N, times);
        if (!same(exact, seen))
            fail_msg("seed %u: Euler number %lld and %llu components, refined %lld and %llu", (unsigned)seed,
                     (long long)exact.euler, (unsigned long long)exact.components, (long long)seen.euler,
                     (unsigned long long)seen.components);
    }
    assert_true(joined > 0); /* some grids need the interpolant's own topology: the test can tell */
}

/* --- ties --------------------------------------------------------------------------------------------------------- */

static void test_ties_are_just_outside(void **state)
{
    (void)state;
    enum { N = 5 };
    static const uint32_t samples[3] = {N, N, N};
    double values[N * N * N], raised[N * N * N];
    uint32_t otherwise = 0;
    for (uint32_t seed = 0; seed < 400; seed++) {
        random_grid(seed, seed % 2 ? RANDOM_INTEGERS : RANDOM_AT_ISO, N, values);
        for (uint32_t i = 0; i < N * N * N; i++)
            raised[i] = values[i] + 0x1p-45;
        oracle_topology exact = oracle_trilinear(samples, values);
        assert_true(same(exact, oracle_trilinear(samples, raised)));
        for (uint32_t i = 0; i < N * N * N; i++)
            raised[i] = values[i] - 0x1p-45;
        otherwise += !same(exact, oracle_trilinear(samples, raised));
    }
    assert_true(otherwise > 100);
}

/* The three axes are alike: turning a cell turns its answer. */
static void test_axes_are_alike(void **state)
{
    (void)state;
    uint64_t random = 77;
    for (uint32_t trial = 0; trial < 4000; trial++) {
        double values[8], turned[8];
        for (uint32_t c = 0; c < 8; c++)
            values[c] = random_value(&random, (random_kind)(trial % RANDOM_KINDS));
        for (uint32_t c = 0; c < 8; c++)
            turned[(c << 1 | c >> 2) & 7] = values[c];
        oracle_cell one = oracle_trilinear_cell(values), other = oracle_trilinear_cell(turned);
        assert_int_equal(one.euler, other.euler);
        for (uint32_t a = 0; a < 8; a++)
            for (uint32_t b = 0; b < 8; b++)
                assert_int_equal(one.label[a] == one.label[b],
                                 other.label[(a << 1 | a >> 2) & 7] == other.label[(b << 1 | b >> 2) & 7]);
    }
}

int main(void)
{
    hewn_mc_table_derive(&table);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_as_refined),
        cmocka_unit_test(test_ties_are_just_outside),
        cmocka_unit_test(test_axes_are_alike),
    };
    return cmocka_run_group_tests_name("trilinear", tests, NULL, NULL);
}
