/* Islands of labels: choosing them gives the very mesh of the volume in which a flood fill made the choice; and shells
 * stay closed when they are simplified together. */
#include <math.h>
#include <omp.h>

#include "hewn/labels.h"
#include "test_model_support.h"

enum { MOST = 24 * 24 * 24 };

typedef struct lattice {
    uint32_t dims[3], count;
    uint8_t labels[MOST];
    uint32_t island[MOST]; /* from 1 on */
} lattice;

static hewn_volume volume_of(const lattice *of)
{
    return (hewn_volume){.dims = {of->dims[0], of->dims[1], of->dims[2]},
                         .frame_count = 1,
                         .type = HEWN_VOXEL_UINT8,
                         .samples = of->labels,
                         .slope = 1,
                         .to_world = {0, 2, 0, 1, 1, 0, 0, 2, 0, 0, 0.5, 3, 0, 0, 0, 1}}; /* a voxel is 1 */
}

static void make_random(random_state *random, lattice *out, uint32_t labels, uint32_t most)
{
    out->count = 1;
    for (int axis = 0; axis < 3; axis++) {
        out->dims[axis] = 1 + random_below(random, most);
        out->count *= out->dims[axis];
    }
    uint32_t empty = random_below(random, 80);
    for (uint32_t n = 0; n < out->count; n++) {
        uint32_t from = n >= 1 && random_below(random, 2) ? n - 1 : n >= out->dims[0] ? n - out->dims[0] : n;
        bool alike = from < n && random_below(random, 3) != 0;
        out->labels[n] = alike                               ? out->labels[from]
                         : random_below(random, 100) < empty ? 0
                                                             : (uint8_t)(1 + random_below(random, labels));
    }
    out->labels[out->count / 2] = 1;
}

/* --- flood fills -------------------------------------------------------------------------------------------------- */

/* The neighbour of a voxel, or -1 outside of the volume. */
static int64_t step(const lattice *of, uint32_t at, int di, int dj, int dk)
{
    int64_t i = at % of->dims[0] + di, j = at / of->dims[0] % of->dims[1] + dj, k = at / of->dims[0] / of->dims[1] + dk;
    bool there = i >= 0 && j >= 0 && k >= 0 && i < of->dims[0] && j < of->dims[1] && k < of->dims[2];
    return there ? i + of->dims[0] * (j + of->dims[1] * k) : -1;
}

/* Numbers the islands: labels over faces, 0 over edges too. */
static uint32_t flood(lattice *of)
{
    static uint32_t stack[MOST];
    uint32_t count = 0;
    memset(of->island, 0, sizeof of->island);
    for (uint32_t seed = 0; seed < of->count; seed++) {
        uint32_t height = 0;
        if (of->island[seed])
            continue;
        of->island[seed] = ++count;
        stack[height++] = seed;
        while (height > 0) {
            uint32_t at = stack[--height];
            for (int n = 0; n < 27; n++) {
                int d[3] = {n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1}, far = abs(d[0]) + abs(d[1]) + abs(d[2]);
                int64_t to = step(of, at, d[0], d[1], d[2]);
                if (to < 0 || far > (of->labels[at] == 0 ? 2 : 1) || of->island[to] || of->labels[to] != of->labels[at])
                    continue;
                of->island[to] = count;
                stack[height++] = (uint32_t)to;
            }
        }
    }
    return count;
}

static void drop(lattice *of, const hewn_body_choice *choice)
{
    static uint32_t size[MOST + 1];
    static uint8_t label[MOST + 1];
    static bool gone[MOST + 1];
    uint32_t count = flood(of);
    memset(size, 0, sizeof size);
    for (uint32_t n = 0; n < of->count; n++) {
        size[of->island[n]]++;
        label[of->island[n]] = of->labels[n];
    }
    for (uint32_t own = 1; own <= count; own++) {
        uint32_t larger = 0;
        for (uint32_t other = 1; other <= count; other++)
            larger +=
                label[other] == label[own] && (size[other] > size[own] || (size[other] == size[own] && other < own));
        gone[own] = (choice->largest > 0 && larger >= choice->largest) || size[own] < choice->least_volume;
    }
    for (uint32_t n = 0; n < of->count; n++)
        if (gone[of->island[n]])
            of->labels[n] = 0;
}

/* Hollows of 0 that touch neither the border nor, over faces, more than one label. */
static void fill(lattice *of)
{
    static uint8_t around[MOST + 1];
    const int steps[6][3] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    flood(of);
    memset(around, 0, sizeof around);
    for (uint32_t n = 0; n < of->count; n++)
        for (int d = 0; d < 6 && of->labels[n] == 0; d++) {
            int64_t to = step(of, n, steps[d][0], steps[d][1], steps[d][2]);
            uint8_t met = to < 0 ? 255 : of->labels[to], *known = &around[of->island[n]];
            if (met != 0)
                *known = *known == 0 || *known == met ? met : 255;
        }
    for (uint32_t n = 0; n < of->count; n++)
        if (of->labels[n] == 0 && around[of->island[n]] != 0 && around[of->island[n]] != 255)
            of->labels[n] = around[of->island[n]];
}

/* --- islands ------------------------------------------------------------------------------------------------------ */

static void check_same(const hewn_label_mesh *one, const hewn_label_mesh *other)
{
    assert_int_equal(one->label_count, other->label_count);
    assert_int_equal(one->vertex_count, other->vertex_count);
    assert_int_equal(one->triangle_count, other->triangle_count);
    assert_memory_equal(one->labels, other->labels, one->label_count * sizeof *one->labels);
    assert_memory_equal(one->voxel_count, other->voxel_count, one->label_count * sizeof *one->voxel_count);
    assert_memory_equal(one->positions, other->positions, 3 * one->vertex_count * sizeof *one->positions);
    assert_memory_equal(one->indices, other->indices, 3 * one->triangle_count * sizeof *one->indices);
    assert_memory_equal(one->sides, other->sides, 2 * one->triangle_count * sizeof *one->sides);
}

static void check_shells(const hewn_label_mesh *mesh, bool whole)
{
    for (uint32_t n = 1; n <= mesh->label_count; n++) {
        hewn_model shell;
        hewn_triangles triangles;
        hewn_certificate is;
        assert_int_equal(hewn_label_mesh_shell(mesh, n, &shell, NULL), HEWN_OK);
        assert_int_equal(hewn_triangles_from_model(&shell, &triangles, NULL), HEWN_OK);
        assert_int_equal(hewn_certify(&triangles, NULL, &is, NULL), HEWN_OK);
        assert_true(is.closed && is.manifold && is.oriented && is.volume > 0);
        if (whole)
            assert_int_equal(is.components, 1);
        hewn_triangles_destroy(&triangles);
        hewn_model_destroy(&shell);
    }
}

static void test_islands(void **state)
{
    (void)state;
    static lattice given, wanted;
    random_state random = {77};
    uint32_t trials = getenv("HEWN_LONG") ? 3000 : 120;
    for (uint32_t trial = 0; trial < trials; trial++) {
        uint32_t labels = 1 + trial % 4;
        hewn_body_choice choice = {
            .largest = trial % 3, .least_volume = trial % 5 == 0 ? 3 : 0, .fill_cavities = trial % 2 == 0};
        make_random(&random, &given, labels, 9);
        wanted = given;
        drop(&wanted, &choice);
        if (choice.fill_cavities)
            fill(&wanted);
        hewn_volume before = volume_of(&given), after = volume_of(&wanted);
        hewn_label_desc desc = {.relaxations = trial % 4, .keep = &choice};
        hewn_label_mesh chosen, mesh;
        omp_set_num_threads(1 + (int)(trial % 3));
        hewn_result result = hewn_labels_mesh(&before, &desc, &chosen, NULL);
        desc.keep = NULL;
        assert_int_equal(hewn_labels_mesh(&after, &desc, &mesh, NULL), result);
        if (result == HEWN_OK) {
            check_same(&chosen, &mesh);
            check_shells(&chosen, labels == 1 && choice.largest == 1 && choice.fill_cavities);
        } else {
            assert_int_equal(result, HEWN_BAD_INPUT);
        }
        hewn_label_mesh_destroy(&chosen);
        hewn_label_mesh_destroy(&mesh);
    }
    omp_set_num_threads(omp_get_num_procs());
}

/* One label in one piece without hollows is one component: the outside is joined as the mesh joins it. */
static void test_one_piece(void **state)
{
    (void)state;
    static lattice given;
    random_state random = {5};
    uint32_t trials = getenv("HEWN_LONG") ? 3000 : 80;
    hewn_body_choice choice = {.largest = 1, .fill_cavities = true};
    for (uint32_t trial = 0; trial < trials; trial++) {
        make_random(&random, &given, 1, 10);
        hewn_volume volume = volume_of(&given);
        hewn_label_desc desc = {.relaxations = 4, .keep = &choice};
        hewn_label_mesh mesh;
        assert_int_equal(hewn_labels_mesh(&volume, &desc, &mesh, NULL), HEWN_OK);
        assert_int_equal(mesh.islands.kept_bodies, 1);
        assert_int_equal(mesh.islands.kept_cavities, 0);
        check_shells(&mesh, true);
        hewn_label_mesh_destroy(&mesh);
    }
}

/* --- simplification ----------------------------------------------------------------------------------------------- */

/* Lumps of labels, so that there is something between the curves where they meet. */
static void make_lumps(random_state *random, lattice *out, uint32_t labels)
{
    double middles[16][3];
    out->dims[0] = out->dims[1] = out->dims[2] = 22;
    out->count = 22 * 22 * 22;
    for (uint32_t n = 0; n < labels; n++)
        for (int axis = 0; axis < 3; axis++)
            middles[n][axis] = 4 + random_below(random, 14);
    for (uint32_t n = 0; n < out->count; n++) {
        double at[3] = {n % 22, n / 22 % 22, n / 484}, best = 64;
        out->labels[n] = 0;
        for (uint32_t m = 0; m < labels; m++) {
            double sum = 0;
            for (int axis = 0; axis < 3; axis++)
                sum += (at[axis] - middles[m][axis]) * (at[axis] - middles[m][axis]);
            out->labels[n] = sum < best ? (uint8_t)(m + 1) : out->labels[n];
            best = sum < best ? sum : best;
        }
        if (random_below(random, 60) == 0)
            out->labels[n] = (uint8_t)random_below(random, labels + 1);
    }
}

static void test_simplified_together(void **state)
{
    (void)state;
    static lattice given;
    random_state random = {12};
    uint32_t trials = getenv("HEWN_LONG") ? 200 : 6;
    for (uint32_t trial = 0; trial < trials; trial++) {
        make_lumps(&random, &given, 2 + trial % 8);
        hewn_volume volume = volume_of(&given);
        hewn_label_desc desc = {.relaxations = 8};
        hewn_label_mesh mesh;
        hewn_simplify_desc target = {.ratio = trial % 2 ? 0.01 : 0.3};
        hewn_simplify_report report;
        assert_int_equal(hewn_labels_mesh(&volume, &desc, &mesh, NULL), HEWN_OK);
        uint64_t before = mesh.triangle_count;
        assert_int_equal(hewn_label_mesh_simplify(&mesh, &target, &report, NULL), HEWN_OK);
        assert_true(mesh.triangle_count < before);
        check_shells(&mesh, false);
        hewn_label_mesh_destroy(&mesh);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_islands), cmocka_unit_test(test_one_piece),
                                       cmocka_unit_test(test_simplified_together)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
