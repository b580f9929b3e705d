/* The files of the test data that are open, turned about or worse, against what is known of them. */
#include "hewn/io.h"
#include "test_repair_support.h"

/* A file, and what repairing it must find. */
typedef struct known {
    const char *name;
    uint64_t boundary_edges; /* after repair without filling */
    bool turned;
    bool fills; /* all holes of up to HEWN_FILL_LIMIT edges, so that it closes */
} known;

static const known files[] = {
    {"mesh-nasty/blobby-shuffled.off", 0, true, true},
    {"mesh-nasty/cube-shuffled.off", 0, true, true},
    {"mesh-nasty/far-out-ring.obj", 0, false, true},
    {"mesh-nasty/nonmanifold.stl", 3, false, true},
    {"mesh-nasty/in.off", 4, false, true},
    {"mesh-open/cat_head.obj", 12, false, true},
    {"mesh-open/cube-ouvert.off", 4, false, true},
    {"mesh-open/fandisk-box.off", 0, false, true},
    {"mesh-open/goathead.obj", 0, false, true},
    {"mesh-open/head.off", 58, false, true},
    {"mesh-open/lion-head.off", 36, false, true},
    {"mesh-open/mask_cone.off", 124, false, true},
    {"mesh-open/mesh_with_border.off", 80, false, true},
    {"mesh-open/nefertiti.off", 34, false, true},
    {"mesh-open/plane_holes.obj", 341, false, true},
    {"mesh-open/three_peaks.off", 141, false, true},
    {"mesh-misc/conrod.off", 9, true, false}, /* three faces given twice are flaps once their twins are gone */
    {"mesh-scan/spider.ply", 0, false, true},
};

static bool read_file(const char *folder, const char *name, builder *out)
{
    char path[5000];
    hewn_triangles mesh;
    hewn_error error = {0};
    snprintf(path, sizeof path, "%s/%s", folder, name);
    if (hewn_triangles_read(path, &mesh, &error) != HEWN_OK) {
        print_message("# %s cannot be read: %s\n", name, error.message);
        return false;
    }
    *out = copy_triangles(&mesh);
    hewn_triangles_destroy(&mesh);
    return true;
}

static void check_file(const known *file, builder *soup)
{
    repaired plain = repair(&soup->polygons, NULL);
    print_message("# %s: %llu boundary edges, %llu faces turned, %llu edges and %llu vertices split\n", file->name,
                  (unsigned long long)plain.certificate.boundary_edges, (unsigned long long)plain.report.turned_faces,
                  (unsigned long long)plain.report.non_manifold_edges,
                  (unsigned long long)plain.report.non_manifold_vertices);
    assert_int_equal(plain.certificate.boundary_edges, file->boundary_edges);
    assert_int_equal(plain.report.turned_faces > 0, file->turned);
    assert_int_equal(plain.report.one_sided_cuts, 0);
    assert_true(!plain.certificate.closed || !file->turned || plain.certificate.volume > 0);
    check_idempotent(&plain, NULL);
    free_repaired(&plain);
    hewn_repair_desc desc = {.fill_edges = HEWN_FILL_LIMIT, .weld = true};
    repaired filled = repair(&soup->polygons, &desc);
    assert_int_equal(filled.certificate.closed, file->fills);
    assert_int_equal(filled.report.filled_holes > 0, file->boundary_edges > 0 && file->fills);
    free_repaired(&filled);
}

static void test_files(void **state)
{
    (void)state;
    char buffer[4096];
    const char *folder = data_folder(buffer);
    if (!folder)
        skip();
    size_t read = 0;
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        builder soup;
        if (!read_file(folder, files[i].name, &soup))
            continue;
        check_file(files + i, &soup);
        free_builder(&soup);
        read++;
    }
    print_message("# %zu of %zu files read\n", read, sizeof files / sizeof *files);
    assert_true(read > 0);
}

/* Quads in a ring with a half turn, stored torn: the file needs welding to be a band at all. */
static void test_moebius_file(void **state)
{
    (void)state;
    char buffer[4096];
    const char *folder = data_folder(buffer);
    builder soup = {0};
    if (!folder || !read_file(folder, "mesh-open/moebius.obj", &soup))
        skip();
    repaired result = take(soup, &(hewn_repair_desc){.weld = true});
    assert_true(result.report.one_sided_cuts > 0);
    assert_int_equal(result.certificate.components, 1);
    free_repaired(&result);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_files), cmocka_unit_test(test_moebius_file)};
    return cmocka_run_group_tests_name("repair_data", tests, NULL, NULL);
}
