/* The topology of dual surfaces, on the serial twin: random grids of several kinds must give closed, oriented
 * 2-manifolds of quads, which they do not without the faces that are joined the other way. HEWN_LONG asks for ten
 * thousand grids of each kind. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "../oracle/dual.h"
#include "../oracle/random_grid.h"
#include "hewn/check.h"

typedef enum sign_kind { EVEN, SPARSE, DENSE, CHECKERED, BLOBS, SLABS, SIGN_KINDS } sign_kind;

static const char *const kind_names[SIGN_KINDS] = {"even odds",    "few inside", "few outside",
                                                   "checkerboard", "blobs",      "layers"};

static bool sample(uint64_t *random, sign_kind kind, const uint32_t at[3], uint32_t (*centres)[4])
{
    switch (kind) {
    case EVEN: return random_below(random, 2) == 0;
    case SPARSE: return random_below(random, 6) == 0;
    case DENSE: return random_below(random, 6) != 0;
    case CHECKERED: return ((at[0] + at[1] + at[2]) % 2 == 0) != (random_below(random, 8) == 0);
    case SLABS: return ((at[0] + 2 * at[1]) % 3 == 0) != (random_below(random, 5) == 0);
    default: break;
    }
    bool inside = false;
    for (int ball = 0; ball < 4; ball++) {
        uint32_t square = 0;
        for (int axis = 0; axis < 3; axis++) {
            uint32_t a = 4 * at[axis], b = centres[ball][axis];
            square += a > b ? (a - b) * (a - b) : (b - a) * (b - a);
        }
        inside ^= square < centres[ball][3] * centres[ball][3];
    }
    return inside;
}

/* Samples of a grid; the border is outside where it is closed. */
static bool *make_signs(uint64_t seed, sign_kind kind, const uint32_t cells[3], bool open)
{
    uint64_t random = seed * UINT64_C(0x9E3779B97F4A7C15) + 77;
    uint32_t centres[4][4];
    for (int i = 0; i < 16; i++)
        centres[i / 4][i % 4] =
            i % 4 == 3 ? 5 + random_below(&random, 14) : random_below(&random, 4 * cells[i % 4] + 1);
    bool *inside = malloc((size_t)(cells[0] + 1) * (cells[1] + 1) * (cells[2] + 1));
    assert_non_null(inside);
    size_t number = 0;
    for (uint32_t z = 0; z <= cells[2]; z++)
        for (uint32_t y = 0; y <= cells[1]; y++)
            for (uint32_t x = 0; x <= cells[0]; x++) {
                uint32_t at[3] = {x, y, z};
                bool border = false;
                for (int axis = 0; axis < 3; axis++)
                    border |= at[axis] == 0 || at[axis] == cells[axis];
                bool value = sample(&random, kind, at, centres);
                inside[number++] = value && (open || !border);
            }
    return inside;
}

/* As a grid with a layer of cells without thickness has them: the outermost samples twice. */
static bool *thicken(const bool *inside, uint32_t cells[3])
{
    uint32_t side[3] = {cells[0] + 3, cells[1] + 3, cells[2] + 3};
    bool *out = malloc((size_t)side[0] * side[1] * side[2]);
    assert_non_null(out);
    for (size_t i = 0; i < (size_t)side[0] * side[1] * side[2]; i++) {
        size_t at[3] = {i % side[0], i / side[0] % side[1], i / side[0] / side[1]};
        for (int axis = 0; axis < 3; axis++)
            at[axis] = at[axis] == 0 ? 0 : at[axis] - 1 > cells[axis] ? cells[axis] : at[axis] - 1;
        out[i] = inside[at[0] + (cells[0] + 1) * (at[1] + (cells[1] + 1) * at[2])];
    }
    for (int axis = 0; axis < 3; axis++)
        cells[axis] += 2;
    return out;
}

/* --- what a surface of quads is ------------------------------------------------------------------------------------
 */

typedef struct side {
    uint32_t from, to, quad;
} side;

static int compare_sides(const void *a, const void *b)
{
    const side *p = a, *q = b;
    return p->from != q->from ? (p->from < q->from ? -1 : 1) : p->to != q->to ? (p->to < q->to ? -1 : 1) : 0;
}

static const side *find_side(const side *sides, uint32_t count, uint32_t from, uint32_t to)
{
    side key = {from, to, 0};
    return count ? bsearch(&key, sides, count, sizeof key, compare_sides) : NULL;
}

typedef struct verdict {
    uint32_t doubled, border, split; /* edges run along twice; edges with one quad; vertices of several fans */
    int64_t euler;
} verdict;

/* Steps from quad to quad around each vertex; what is not reached is another fan. */
static uint32_t count_split(const oracle_dual *dual, const side *sides)
{
    uint32_t corners = 4 * dual->quad_count, split = 0;
    uint32_t *first = malloc(dual->vertex_count * sizeof *first + 1);
    uint32_t *around = calloc(dual->vertex_count + 1, sizeof *around);
    assert_non_null(first);
    assert_non_null(around);
    for (uint32_t i = 0; i < corners; i++) {
        first[dual->quads[i]] = i;
        around[dual->quads[i]]++;
    }
    for (uint32_t i = 0; i < corners; i++) { /* where a vertex is on the border, the quad that nothing comes before */
        uint32_t next = dual->quads[4 * (i / 4) + (i + 1) % 4];
        if (!find_side(sides, corners, next, dual->quads[i]))
            first[dual->quads[i]] = i;
    }
    for (uint32_t vertex = 0; vertex < dual->vertex_count; vertex++) {
        if (around[vertex] == 0)
            continue;
        uint32_t at = first[vertex], steps = 0;
        for (bool more = true; more && steps < 16;) {
            uint32_t before = dual->quads[4 * (at / 4) + (at + 3) % 4];
            const side *next = find_side(sides, corners, vertex, before);
            steps++;
            for (uint32_t k = 0; next && k < 4; k++)
                if (dual->quads[4 * next->quad + k] == vertex)
                    at = 4 * next->quad + k;
            more = next && at != first[vertex];
        }
        split += steps != around[vertex];
    }
    free(first);
    free(around);
    return split;
}

static verdict examine(const oracle_dual *dual)
{
    uint32_t corners = 4 * dual->quad_count, used = 0;
    side *sides = malloc(corners * sizeof *sides + 1);
    bool *seen = calloc(dual->vertex_count + 1, sizeof *seen);
    assert_non_null(sides);
    assert_non_null(seen);
    for (uint32_t i = 0; i < corners; i++) {
        sides[i] = (side){dual->quads[i], dual->quads[4 * (i / 4) + (i + 1) % 4], i / 4};
        used += !seen[dual->quads[i]];
        seen[dual->quads[i]] = true;
    }
    qsort(sides, corners, sizeof *sides, compare_sides);
    verdict out = {0};
    for (uint32_t i = 0; i < corners; i++) {
        out.doubled += i > 0 && compare_sides(&sides[i - 1], &sides[i]) == 0;
        out.border += !find_side(sides, corners, sides[i].to, sides[i].from);
    }
    out.split = out.doubled ? 0 : count_split(dual, sides);
    out.euler = (int64_t)used - (int64_t)(corners + out.border) / 2 + dual->quad_count;
    free(sides);
    free(seen);
    return out;
}

/* --- properties ----------------------------------------------------------------------------------------------------
 */

static uint32_t trials(void)
{
    return getenv("HEWN_LONG") ? 10000 : 90;
}

static void test_closed_grids(void **state)
{
    (void)state;
    for (sign_kind kind = EVEN; kind < SIGN_KINDS; kind++) {
        uint32_t flips = 0, helped = 0;
        for (uint32_t seed = 0; seed < trials(); seed++) {
            uint32_t cells[3] = {5 + seed % 5, 5 + seed / 5 % 4, 7};
            bool *inside = make_signs(seed, kind, cells, false);
            oracle_dual dual = oracle_dual_trace(cells, inside, true), plain = oracle_dual_trace(cells, inside, false);
            verdict found = examine(&dual);
            if (found.doubled || found.border || found.split || found.euler % 2)
                fail_msg("%s, seed %u: %u doubled edges, %u with one quad, %u split vertices, Euler number %lld",
                         kind_names[kind], (unsigned)seed, (unsigned)found.doubled, (unsigned)found.border,
                         (unsigned)found.split, (long long)found.euler);
            flips += dual.flips;
            helped += examine(&plain).doubled > 0;
            oracle_dual_free(&dual);
            oracle_dual_free(&plain);
            free(inside);
        }
        print_message("# %s: %u faces joined the other way; without that %u of %u grids are not manifold\n",
                      kind_names[kind], (unsigned)flips, (unsigned)helped, (unsigned)trials());
        assert_true(kind != EVEN || (flips > 0 && helped > 0));
    }
}

/* Boundaries are simple curves: as many of their edges arrive at a vertex as leave it, at most one. */
static void test_open_grids(void **state)
{
    (void)state;
    for (sign_kind kind = EVEN; kind < SIGN_KINDS; kind++)
        for (uint32_t seed = 0; seed < trials(); seed++) {
            uint32_t cells[3] = {4 + seed % 3, 5, 4 + seed / 3 % 3};
            bool *plain = make_signs(seed, kind, cells, true), *inside = thicken(plain, cells);
            oracle_dual dual = oracle_dual_trace(cells, inside, true);
            verdict found = examine(&dual);
            if (found.doubled || found.split)
                fail_msg("%s, seed %u: %u doubled edges, %u split vertices", kind_names[kind], (unsigned)seed,
                         (unsigned)found.doubled, (unsigned)found.split);
            oracle_dual_free(&dual);
            free(inside);
            free(plain);
        }
}

/* Every pattern of the twelve samples of two cells beside each other along each axis, with nothing around them. */
static void test_all_pairs_of_cells(void **state)
{
    (void)state;
    for (uint32_t axis = 0; axis < 3; axis++)
        for (uint32_t bits = 0; bits < 4096; bits++) {
            uint32_t cells[3] = {3, 3, 3};
            bool inside[80] = {false};
            cells[axis] = 4;
            for (uint32_t i = 0; i < 12; i++) {
                uint32_t at[3];
                at[axis] = 1 + i / 4;
                at[(axis + 1) % 3] = 1 + (i & 1);
                at[(axis + 2) % 3] = 1 + (i >> 1 & 1);
                inside[at[0] + (cells[0] + 1) * (at[1] + (cells[1] + 1) * at[2])] = bits >> i & 1;
            }
            oracle_dual dual = oracle_dual_trace(cells, inside, true);
            verdict found = examine(&dual);
            if (found.doubled || found.border || found.split)
                fail_msg("axis %u, samples %x: %u doubled edges, %u split vertices", (unsigned)axis, (unsigned)bits,
                         (unsigned)found.doubled, (unsigned)found.split);
            oracle_dual_free(&dual);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_closed_grids),
        cmocka_unit_test(test_open_grids),
        cmocka_unit_test(test_all_pairs_of_cells),
    };
    return cmocka_run_group_tests_name("dual", tests, NULL, NULL);
}
