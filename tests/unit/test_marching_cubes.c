/* The derived table: any two cells that share a face agree on it, and no diagonal lies in a face. Together these make
 * every mesh a closed oriented 2-manifold. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "iso/cube.h"
#include "iso/marching_cubes.h"

static hewn_mc_table table;

static uint32_t entry_edge(uint32_t pattern, uint32_t i)
{
    return table.words[pattern][1 + i / 6] >> (16 * (i / 3 % 2) + 4 * (i % 3)) & 15;
}

/* uses[a][b]: how many triangles of the pattern run from cube edge a to cube edge b. */
static void count_uses(uint32_t pattern, uint8_t uses[12][12])
{
    memset(uses, 0, 144);
    for (uint32_t t = 0; t < table.words[pattern][0]; t++)
        for (uint32_t c = 0; c < 3; c++)
            uses[entry_edge(pattern, 3 * t + c)][entry_edge(pattern, 3 * t + (c + 1) % 3)]++;
}

static bool crossed(uint32_t pattern, uint32_t edge)
{
    uint32_t start = hewn_cube_edge_start(edge), end = start | 1u << edge / 4;
    return (pattern >> start & 1) != (pattern >> end & 1);
}

static void test_uses_exactly_the_crossed_edges(void **state)
{
    (void)state;
    for (uint32_t pattern = 0; pattern < 256; pattern++) {
        uint8_t uses[12][12];
        count_uses(pattern, uses);
        for (uint32_t edge = 0; edge < 12; edge++) {
            uint32_t sum = 0;
            for (uint32_t other = 0; other < 12; other++)
                sum += uses[edge][other];
            assert_int_equal(sum > 0, crossed(pattern, edge));
        }
        assert_int_equal(uses[0][0], 0);
    }
}

static void test_diagonals_are_paired_and_inside_the_cell(void **state)
{
    (void)state;
    for (uint32_t pattern = 0; pattern < 256; pattern++) {
        uint8_t uses[12][12];
        count_uses(pattern, uses);
        for (uint32_t a = 0; a < 12; a++)
            for (uint32_t b = 0; b < 12; b++) {
                if (uses[a][b] == 0)
                    continue;
                assert_int_equal(uses[a][b], 1);
                if (!hewn_cube_edges_share_face(a, b))
                    assert_int_equal(uses[b][a], 1);
                else
                    assert_int_equal(uses[b][a], 0);
            }
    }
}

/* The pattern's mirror image across a face, as the neighbour there sees it: same signs on the face, anything beyond. */
static void test_neighbours_agree_on_every_face(void **state)
{
    (void)state;
    uint8_t mine[12][12], theirs[12][12];
    for (uint32_t axis = 0; axis < 3; axis++) {
        for (uint32_t pattern = 0; pattern < 256; pattern++) {
            count_uses(pattern, mine);
            for (uint32_t beyond = 0; beyond < 256; beyond++) {
                bool fits = true;
                for (uint32_t c = 0; c < 8; c++)
                    fits &= !(c >> axis & 1) || (pattern >> c & 1) == (beyond >> (c ^ 1u << axis) & 1);
                if (!fits)
                    continue;
                count_uses(beyond, theirs);
                uint32_t corners[4], edges[4], twins[4];
                hewn_cube_face_corners(2 * axis + 1, corners);
                for (uint32_t i = 0; i < 4; i++) {
                    edges[i] = hewn_cube_edge_between(corners[i], corners[(i + 1) % 4]);
                    twins[i] = hewn_cube_edge_between(corners[i] ^ 1u << axis, corners[(i + 1) % 4] ^ 1u << axis);
                }
                for (uint32_t i = 0; i < 4; i++)
                    for (uint32_t j = 0; j < 4; j++)
                        assert_int_equal(mine[edges[i]][edges[j]], theirs[twins[j]][twins[i]]);
            }
        }
    }
}

static void test_triangles_face_outward(void **state)
{
    (void)state;
    /* One inside corner: the triangle's normal points away from it. */
    for (uint32_t corner = 0; corner < 8; corner++) {
        double at[3][3];
        assert_int_equal(table.words[1u << corner][0], 1);
        for (uint32_t i = 0; i < 3; i++) {
            uint32_t edge = entry_edge(1u << corner, i), start = hewn_cube_edge_start(edge);
            for (uint32_t axis = 0; axis < 3; axis++)
                at[i][axis] = axis == edge / 4 ? 0.5 : start >> axis & 1;
        }
        double dot = 0;
        for (uint32_t a = 0; a < 3; a++) {
            uint32_t b = (a + 1) % 3, c = (a + 2) % 3;
            double normal =
                (at[1][b] - at[0][b]) * (at[2][c] - at[0][c]) - (at[1][c] - at[0][c]) * (at[2][b] - at[0][b]);
            dot += normal * (at[0][a] - (double)(corner >> a & 1));
        }
        assert_true(dot > 0);
    }
}

int main(void)
{
    hewn_mc_table_derive(&table);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_uses_exactly_the_crossed_edges),
        cmocka_unit_test(test_diagonals_are_paired_and_inside_the_cell),
        cmocka_unit_test(test_neighbours_agree_on_every_face),
        cmocka_unit_test(test_triangles_face_outward),
    };
    return cmocka_run_group_tests_name("marching_cubes", tests, NULL, NULL);
}
