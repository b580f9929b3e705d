/* Grids of .vdb files that are left in blocks give the samples and the meshes that they give when they are made dense,
 * and take memory for what is active only. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "hewn/volume_job.h"
#include "test_volume_support.h"
#include "vdb_write.h"
#include "volume/blocks.h"

/* --- both ways ---------------------------------------------------------------------------------------------------- */

static void assert_same_mesh(const hewn_volume *a, const hewn_volume *b, const hewn_volume_extract_desc *desc,
                             uint64_t *meshes)
{
    hewn_triangles one, other;
    hewn_volume_extract_stats first, second;
    hewn_result result = hewn_volume_extract(a, desc, &one, &first, NULL);
    assert_int_equal(hewn_volume_extract(b, desc, &other, &second, NULL), result);
    if (result != HEWN_OK)
        return;
    assert_int_equal(one.vertex_count, other.vertex_count);
    assert_int_equal(one.triangle_count, other.triangle_count);
    assert_memory_equal(one.positions, other.positions, 12 * one.vertex_count);
    assert_memory_equal(one.normals, other.normals, 12 * one.vertex_count);
    assert_memory_equal(one.indices, other.indices, 12 * one.triangle_count);
    assert_int_equal(first.cap_vertices, second.cap_vertices);
    hewn_triangles_destroy(&one);
    hewn_triangles_destroy(&other);
    (*meshes)++;
}

/* Samples at some distance, all heads, and meshes at some values. */
static uint64_t compare(const char *path, const char *grid)
{
    hewn_volume_read_desc desc = {.grid = grid};
    hewn_volume dense = read_volume(path, &desc);
    desc.blocks = true;
    hewn_volume blocks = read_volume(path, &desc);
    uint64_t meshes = 0, size = hewn_volume_frame_size(&dense);
    assert_true(blocks.blocks && !blocks.samples && dense.samples && !dense.blocks);
    assert_memory_equal(dense.dims, blocks.dims, sizeof dense.dims);
    assert_memory_equal(dense.to_world, blocks.to_world, sizeof dense.to_world);
    assert_string_equal(dense.name, blocks.name);
    assert_int_equal(dense.type, blocks.type);
    assert_int_equal(dense.level_set, blocks.level_set);
    for (uint64_t n = 0; n < size; n += size / 20000 + 1)
        assert_true(hewn_volume_sample(&dense, n) == hewn_volume_sample(&blocks, n));
    hewn_volume_range a = hewn_volume_find_range(&dense, 0), b = hewn_volume_find_range(&blocks, 0);
    assert_true(a.lo == b.lo && a.hi == b.hi && a.finite_count == b.finite_count);
    for (int share = -1; share <= 3; share += getenv("HEWN_LONG") ? 1 : 2) {
        const hewn_volume_extract_desc wanted = {.iso = share < 0 ? 0 : a.lo + (a.hi - a.lo) * share / 4,
                                                 .open = share == 1};
        assert_same_mesh(&dense, &blocks, &wanted, &meshes);
    }
    hewn_volume_destroy(&dense);
    hewn_volume_destroy(&blocks);
    return meshes;
}

/* --- files -------------------------------------------------------------------------------------------------------- */

/* The names of a file's grids, which an error lists. */
static uint64_t compare_grids(const char *path)
{
    const hewn_volume_read_desc desc = {.grid = "no such grid"};
    hewn_volume volume;
    hewn_error error = {0};
    uint64_t meshes = 0;
    assert_int_equal(hewn_volume_read(path, &desc, &volume, &error), HEWN_BAD_INPUT);
    char *at = strstr(error.message, "there are: ");
    assert_non_null(at);
    for (at += 11; at && *at;) {
        char *end = strstr(at, " ("), *next = strstr(at, "), ");
        bool scalars = end && strncmp(end, " (vec", 5) != 0 && strncmp(end, " (ptdata", 8) != 0;
        assert_non_null(end);
        *end = '\0';
        if (scalars && strcmp(at, "empty") != 0 && strcmp(at, "frustum") != 0)
            meshes += compare(path, at);
        at = next ? next + 3 : NULL;
    }
    return meshes;
}

static void test_data(void **state)
{
    (void)state;
    static const char *const names[] = {"sphere", "icosahedron", "grid0"};
    char data[4096], path[4200];
    if (!data_folder(data))
        skip();
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
        snprintf(path, sizeof path, "%s/vdb/%s.vdb", data, names[n]);
        assert_true(compare_grids(path) >= 2);
    }
}

/* Floats, halves, doubles, whole numbers and bools; spheres whose file has halves. */
static void test_types(void **state)
{
    (void)state;
    char folder[64], path[96];
    const int32_t dims[3] = {13, 9, 17}, first[3] = {-3, 4090, 124};
    const double to_world[16] = {0.5, 0.1, 0, 3, 0, -0.7, 0, 1, 0.2, 0, 0.9, -2, 0, 0, 0, 1};
    const double centres[3][3] = {{0, 0, 0}, {9, 5, -127}, {30, 20, 128}};
    static double values[13 * 9 * 17];
    uint64_t random = 77;
    for (size_t n = 0; n < sizeof values / sizeof *values; n++) {
        random = random * 6364136223846793005u + 1442695040888963407u;
        values[n] = random >> 62 ? (double)(random >> 40) / (1 << 20) - 8 : 0;
    }
    make_folder(folder);
    snprintf(path, sizeof path, "%s/a.vdb", folder);
    vdb_write(path, dims, values, first, to_world);
    assert_true(compare_grids(path) >= 5);
    vdb_write_spheres(path, 3, centres, 12.3, true);
    assert_true(compare_grids(path) >= 2);
    assert_int_equal(unlink(path), 0);
    assert_int_equal(rmdir(folder), 0);
}

static void test_random_trees(void **state)
{
    (void)state;
    char folder[64], path[96];
    uint64_t meshes = 0, seeds = getenv("HEWN_LONG") ? 60 : 4;
    make_folder(folder);
    snprintf(path, sizeof path, "%s/a.vdb", folder);
    for (uint64_t seed = 0; seed < seeds; seed++) {
        vdb_write_tree(path, seed, seed % 4 == 3);
        meshes += compare(path, "tree");
    }
    assert_true(meshes >= 2 * seeds);
    assert_int_equal(unlink(path), 0);
    assert_int_equal(rmdir(folder), 0);
}

/* --- damaged files ------------------------------------------------------------------------------------------------ */

/* Puts other coordinates everywhere where these are in a file. */
static void move_places(const char *path, const int32_t from[3], const int32_t to[3])
{
    static char bytes[1 << 16];
    FILE *file = fopen(path, "r+b");
    assert_non_null(file);
    const size_t length = fread(bytes, 1, sizeof bytes, file);
    uint64_t count = 0;
    assert_true(length < sizeof bytes);
    for (size_t at = 0; at + 12 <= length; at++)
        if (memcmp(bytes + at, from, 12) == 0) {
            memcpy(bytes + at, to, 12);
            count++;
        }
    assert_int_equal(count, 1);
    rewind(file);
    assert_int_equal(fwrite(bytes, 1, length, file), length);
    assert_int_equal(fclose(file), 0);
}

/* Leaves, nodes and tiles say in the file where they are. Wherever that is not where the tree has them, the file is
 * refused, in blocks as well as dense; nothing is written out of place. */
static void test_misplaced(void **state)
{
    (void)state;
    const int32_t active[3] = {16, 24, 32}, passive[3] = {8, 24, 40}, tile[3] = {-4096, 4096, 8192};
    static const struct {
        const char *what; /* NULL: as it was */
        int32_t to[3];
    } cases[] = {{NULL, {0}},
                 {"leaf", {10, 24, 40}}, /* samples end before the box begins */
                 {"leaf", {16, 24, 32}}, /* where there is another */
                 {"leaf", {-1, 24, 40}},
                 {"leaf", {8, 24, 40 + 8192}},
                 {"leaf", {INT32_MAX, INT32_MIN, 7}},
                 {"active leaf", {17, 24, 32}},
                 {"active leaf", {8, 24, 40}},
                 {"active leaf", {INT32_MAX - 7, INT32_MAX - 7, INT32_MAX - 7}},
                 {"tile", {-100, 0, 0}},
                 {"tile", {16, 24, 32}},
                 {"tile", {INT32_MIN, INT32_MIN, -1}}};
    char folder[64], path[96];
    make_folder(folder);
    snprintf(path, sizeof path, "%s/a.vdb", folder);
    for (size_t n = 0; n < 2 * sizeof cases / sizeof *cases; n++) {
        const char *what = cases[n / 2].what;
        const hewn_volume_read_desc desc = {.blocks = n % 2 == 0, .memory_limit = 1 << 24};
        hewn_volume volume;
        hewn_error error = {0};
        vdb_write_mask(path, active, passive, tile);
        if (what)
            move_places(path,
                        strcmp(what, "tile") == 0   ? tile
                        : strcmp(what, "leaf") == 0 ? passive
                                                    : active,
                        cases[n / 2].to);
        hewn_result result = hewn_volume_read(path, &desc, &volume, &error);
        if (result != (what ? HEWN_BAD_INPUT : HEWN_OK) || (what && !strstr(error.message, "which belongs at")))
            fail_msg("case %zu: %d, %s", n, result, error.message);
        hewn_volume_destroy(&volume);
    }
    assert_int_equal(unlink(path), 0);
    assert_int_equal(rmdir(folder), 0);
}

/* --- memory ------------------------------------------------------------------------------------------------------- */

/* Their box has a thousand million million samples, which nobody can make dense. */
static void test_far_apart(void **state)
{
    (void)state;
    char folder[64], path[96], out[96];
    const double centres[2][3] = {{3, 2, 1}, {99991, 99992, 99993}}, radius = 20;
    const double expected = 2 * 4.0 / 3 * 3.14159265358979 * radius * radius * radius;
    hewn_error error = {0};
    hewn_volume_report report;
    make_folder(folder);
    snprintf(path, sizeof path, "%s/a.vdb", folder);
    snprintf(out, sizeof out, "%s/a.ply", folder);
    vdb_write_spheres(path, 2, centres, radius, false);
    hewn_volume_job_desc job = {.input = path, .output = out};
    for (int parts = 0; parts < 2; parts++) {
        job.max_memory = parts ? 16 << 20 : 0;
        if (hewn_volume_convert(&job, &report, &error) != HEWN_OK)
            fail_msg("%s", error.message);
        assert_true(report.dims[0] > 100000 && report.dims[1] > 100000 && report.dims[2] > 100000);
        assert_int_equal(report.certificate.components, 2);
        assert_true(report.certificate.closed && report.certificate.genus == 0);
        assert_true(report.certificate.volume > 0.97 * expected && report.certificate.volume < 1.01 * expected);
        if (report.peak_host_bytes > 400u << 20)
            fail_msg("%llu bytes", (unsigned long long)report.peak_host_bytes);
        hewn_volume_report_destroy(&report);
    }
    hewn_volume_read_desc read = {.blocks = true};
    hewn_volume volume = read_volume(path, &read);
    assert_true(volume.memory_length < 8 << 20);
    hewn_volume_destroy(&volume);
    const hewn_volume_smooth_desc smooth = {.length = 1}; /* this needs all samples in a row */
    job.max_memory = 0;
    job.filter = &smooth;
    assert_int_equal(hewn_volume_convert(&job, &report, &error), HEWN_LIMIT);
    assert_non_null(strstr(error.message, "over the limit"));
    assert_int_equal(unlink(out), 0);
    assert_int_equal(unlink(path), 0);
    assert_int_equal(rmdir(folder), 0);
}

/* Reading is not disturbed by other threads that use TBB, as OpenVDB does, at the same time: they hold locks. */
static void test_beside_others(void **state)
{
    (void)state;
    static const double centre[1][3] = {{0, 0, 0}};
    char folder[64], path[96];
    make_folder(folder);
    snprintf(path, sizeof path, "%s/a.vdb", folder);
    vdb_write_spheres(path, 1, centre, 12, false);
    vdb_write_busy(true);
    for (int n = 0; n < 6; n++) {
        const hewn_volume_read_desc desc = {.blocks = n % 2 == 0};
        hewn_volume volume = read_volume(path, &desc);
        assert_true(volume.level_set);
        hewn_volume_destroy(&volume);
    }
    vdb_write_busy(false);
    assert_int_equal(unlink(path), 0);
    assert_int_equal(rmdir(folder), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_far_apart),    cmocka_unit_test(test_data),      cmocka_unit_test(test_types),
        cmocka_unit_test(test_random_trees), cmocka_unit_test(test_misplaced), cmocka_unit_test(test_beside_others),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
