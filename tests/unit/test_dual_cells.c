/* The loops of cells, enumerated: what makes a dual mesh a manifold whatever the signs are. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "iso/cube.h"
#include "iso/dual_cells.h"

static uint32_t crossed_edges(uint32_t pattern)
{
    uint32_t edges = 0;
    for (uint32_t edge = 0; edge < 12; edge++) {
        uint32_t start = hewn_cube_edge_start(edge), end = start | 1u << edge / 4;
        edges |= (pattern >> start & 1) != (pattern >> end & 1) ? 1u << edge : 0;
    }
    return edges;
}

static uint32_t face_edges(uint32_t face)
{
    uint32_t edges = 0;
    for (uint32_t edge = 0; edge < 12; edge++)
        edges |= hewn_cube_edge_in_face(edge, face) ? 1u << edge : 0;
    return edges;
}

static uint32_t count_bits(uint32_t bits)
{
    uint32_t count = 0;
    for (; bits; bits &= bits - 1)
        count++;
    return count;
}

/* Faces whose four edges are crossed. */
static uint32_t ambiguous_faces(uint32_t pattern)
{
    uint32_t faces = 0;
    for (uint32_t face = 0; face < 6; face++)
        faces |= count_bits(crossed_edges(pattern) & face_edges(face)) == 4 ? 1u << face : 0;
    return faces;
}

/* Faces of which one loop has four edges: both cuts are its. */
static uint32_t doubled_faces(const hewn_dual_cell *cell)
{
    uint32_t faces = 0;
    for (uint32_t face = 0; face < 6; face++)
        for (uint32_t i = 0; i < cell->loop_count; i++)
            faces |= count_bits(cell->edges[i] & face_edges(face)) == 4 ? 1u << face : 0;
    return faces;
}

static void check_loops(uint32_t pattern, const hewn_dual_cell *cell)
{
    uint32_t seen = 0, sum = 0;
    assert_true(cell->loop_count <= HEWN_DUAL_MOST_LOOPS);
    for (uint32_t i = 0; i < cell->loop_count; i++) {
        assert_true(count_bits(cell->edges[i]) >= 3);
        assert_true(i == 0 || (cell->edges[i] & -cell->edges[i]) > (cell->edges[i - 1] & -cell->edges[i - 1]));
        seen |= cell->edges[i];
        sum += count_bits(cell->edges[i]);
    }
    assert_int_equal(seen, crossed_edges(pattern));
    assert_int_equal(sum, count_bits(seen)); /* no edge in two loops */
    for (uint32_t edge = 0; edge < 12; edge++)
        if (seen >> edge & 1)
            assert_true(hewn_cube_edges_share_face(edge, cell->next[edge]));
}

static void test_every_crossed_edge_is_in_one_loop(void **state)
{
    (void)state;
    for (uint32_t pattern = 0; pattern < 256; pattern++)
        for (uint32_t turned = 0; turned < 64; turned++) {
            hewn_dual_cell cell;
            hewn_dual_cell_derive(pattern, turned & ambiguous_faces(pattern), &cell);
            check_loops(pattern, &cell);
        }
}

/* What the header says of doubtful faces, and all that has to be known of them. */
static void test_turning_a_doubtful_face_is_enough(void **state)
{
    (void)state;
    uint32_t patterns = 0;
    for (uint32_t pattern = 0; pattern < 256; pattern++) {
        hewn_dual_cell plain, turned;
        hewn_dual_cell_derive(pattern, 0, &plain);
        uint32_t doubled = doubled_faces(&plain), face = hewn_dual_doubtful_face(pattern);
        assert_int_equal(doubled, face == HEWN_DUAL_NO_FACE ? 0 : 1u << face);
        if (doubled == 0)
            continue;
        patterns++;
        assert_int_equal(plain.loop_count, 1);
        assert_int_equal(ambiguous_faces(pattern), doubled);
        hewn_dual_cell_derive(pattern, doubled, &turned);
        assert_int_equal(turned.loop_count, 2);
        assert_int_equal(doubled_faces(&turned), 0);
    }
    assert_int_equal(patterns, 36);
}

/* For each pair of cells that can meet at a face, the cuts on it are the same on both sides, in opposite directions,
 * and no two of them join the same two vertices. */
static void check_pair(uint32_t axis, uint32_t below, uint32_t above)
{
    uint32_t face = 2 * axis + 1, other = 2 * axis;
    bool turn = hewn_dual_doubtful_face(below) == face && hewn_dual_doubtful_face(above) == other;
    hewn_dual_cell low, high;
    hewn_dual_cell_derive(below, turn ? 1u << face : 0, &low);
    hewn_dual_cell_derive(above, turn ? 1u << other : 0, &high);
    bool joined[HEWN_DUAL_MOST_LOOPS][HEWN_DUAL_MOST_LOOPS] = {{false}};
    for (uint32_t edge = 0; edge < 12; edge++) {
        if (!hewn_cube_edge_in_face(edge, face) || !(crossed_edges(below) >> edge & 1))
            continue;
        uint32_t to = low.next[edge];
        if (!hewn_cube_edge_in_face(to, face))
            continue;
        /* The same grid edges, as the cell above numbers them. */
        uint32_t step = hewn_cube_edge_start(edge) & ~(1u << axis), step_to = hewn_cube_edge_start(to) & ~(1u << axis);
        uint32_t back = hewn_cube_edge_between(step, step | 1u << edge / 4);
        uint32_t back_to = hewn_cube_edge_between(step_to, step_to | 1u << to / 4);
        assert_int_equal(high.next[back_to], back);
        for (uint32_t i = 0; i < low.loop_count; i++)
            for (uint32_t k = 0; k < high.loop_count; k++)
                if ((low.edges[i] >> edge & 1) && (high.edges[k] >> back & 1)) {
                    assert_false(joined[i][k]);
                    joined[i][k] = true;
                }
    }
}

static void test_no_two_cuts_of_a_face_join_the_same_vertices(void **state)
{
    (void)state;
    for (uint32_t axis = 0; axis < 3; axis++)
        for (uint32_t below = 0; below < 256; below++)
            for (uint32_t above = 0; above < 256; above++) {
                bool fit = true;
                for (uint32_t corner = 0; corner < 8; corner++)
                    fit =
                        fit && ((corner >> axis & 1) || (above >> corner & 1) == (below >> (corner | 1u << axis) & 1));
                if (fit)
                    check_pair(axis, below, above);
            }
}

static void test_table_says_the_same(void **state)
{
    (void)state;
    static hewn_dual_table table;
    hewn_dual_table_derive(&table);
    for (uint32_t entry = 0; entry < 512; entry++) {
        uint32_t face = hewn_dual_doubtful_face(entry / 2), *words = table.words[entry];
        hewn_dual_cell cell;
        hewn_dual_cell_derive(entry / 2, entry % 2 && face != HEWN_DUAL_NO_FACE ? 1u << face : 0, &cell);
        assert_int_equal(words[0] & 7, cell.loop_count);
        assert_int_equal(words[0] >> 4, face);
        for (uint32_t i = 0; i < HEWN_DUAL_MOST_LOOPS; i++)
            assert_int_equal(words[1 + i / 2] >> 16 * (i % 2) & 0xFFFF, cell.edges[i]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_crossed_edge_is_in_one_loop),
        cmocka_unit_test(test_turning_a_doubtful_face_is_enough),
        cmocka_unit_test(test_no_two_cuts_of_a_face_join_the_same_vertices),
        cmocka_unit_test(test_table_says_the_same),
    };
    return cmocka_run_group_tests_name("dual_cells", tests, NULL, NULL);
}
