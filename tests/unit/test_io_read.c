/* Reading meshes through the one door: every file of the test data is a mesh or a clear error. */
#include <ftw.h>
#include <strings.h>
#include <sys/resource.h>

#include "io_support.h"

static bool is_readable(const char *path)
{
    const char *dot = strrchr(path, '.');
    return dot && (hewn_mesh_format_of(path) != HEWN_MESH_UNKNOWN || strcasecmp(dot, ".gltf") == 0);
}

static size_t visited, refused;

static int visit(const char *path, const struct stat *status, int kind, struct FTW *where)
{
    (void)status;
    (void)where;
    if (kind != FTW_F || !is_readable(path))
        return 0;
    hewn_triangles mesh;
    hewn_error error = {0};
    hewn_certificate certificate;
    hewn_result result = hewn_triangles_read(path, &mesh, &error);
    visited++;
    if (result == HEWN_OK) {
        result = hewn_certify(&mesh, NULL, &certificate, &error);
        hewn_triangles_destroy(&mesh);
        return result != HEWN_OK;
    }
    refused++;
    bool told = (result == HEWN_BAD_INPUT || result == HEWN_IO) && error.message[0] && error.file[0];
    if (!told || mesh.positions || mesh.indices)
        print_error("%s: %d %s\n", path, result, error.message);
    return !told || mesh.positions || mesh.indices;
}

/* Every file is either a mesh that can be examined or a clear error, and none takes much memory. */
static void test_data_malformed(void **state)
{
    (void)state;
    char data[4096], path[4200];
    if (!data_folder(data))
        skip();
    struct rusage before, after;
    getrusage(RUSAGE_SELF, &before);
    visited = refused = 0;
    static const char *const parts[] = {"malformed", "mesh-nasty"};
    for (int i = 0; i < 2; i++) {
        snprintf(path, sizeof path, "%s/%s", data, parts[i]);
        assert_int_equal(nftw(path, visit, 8, FTW_PHYS), 0);
    }
    getrusage(RUSAGE_SELF, &after);
    assert_true(visited >= 50);
    assert_true(refused >= 15 && refused <= 30);
    assert_true(after.ru_maxrss - before.ru_maxrss < 64 * 1024);
}

static void test_data_known_results(void **state)
{
    (void)state;
    static const struct {
        const char *file;
        hewn_result result;
        uint32_t line;
        uint64_t vertices, triangles;
    } known[] = {
        {"malformed/Spider_ascii.stl", HEWN_OK, 0, 722, 1368},
        {"malformed/Wuson.ply", HEWN_OK, 0, 11184, 3732},
        {"malformed/busted.STL", HEWN_OK, 0, 1941, 3878},
        {"malformed/cornell_box.obj", HEWN_OK, 0, 76, 36},
        {"malformed/cube_binary_header_with_RN_newline.ply", HEWN_OK, 0, 8, 12},
        {"malformed/empty.stl", HEWN_OK, 0, 0, 0},
        {"malformed/wallhole.obj", HEWN_OK, 0, 92, 66},
        {"malformed/triangle_with_two_solids.stl", HEWN_OK, 0, 6, 2},
        {"malformed/negative_indices.obj", HEWN_OK, 0, 8, 12},
        {"mesh-nasty/far-out-ring.obj", HEWN_OK, 0, 1536, 3072},
        {"malformed/number_formats.obj", HEWN_BAD_INPUT, 11, 0, 0},
        {"malformed/test-nan.obj", HEWN_BAD_INPUT, 12, 0, 0},
        {"malformed/issue623.ply", HEWN_BAD_INPUT, 14, 0, 0},
        {"malformed/malformed.obj", HEWN_BAD_INPUT, 28, 0, 0},
        {"malformed/box_UTF16BE.obj", HEWN_BAD_INPUT, 1, 0, 0},
        {"mesh-nasty/invalidvertex.stl", HEWN_BAD_INPUT, 0, 0, 0},
        {"mesh-nasty/unparseable.stl", HEWN_BAD_INPUT, 4, 0, 0},
        {"mesh-nasty/empty.stl", HEWN_BAD_INPUT, 0, 0, 0},
    };
    char data[4096], path[4200];
    if (!data_folder(data))
        skip();
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        snprintf(path, sizeof path, "%s/%s", data, known[i].file);
        hewn_triangles mesh;
        hewn_error error = {0};
        hewn_result result = hewn_triangles_read(path, &mesh, &error);
        if (result != known[i].result || mesh.vertex_count != known[i].vertices ||
            mesh.triangle_count != known[i].triangles || (known[i].line && error.line != known[i].line))
            fail_msg("%s: %d, line %u %s, %llu vertices, %llu triangles", known[i].file, result, error.line,
                     error.message, (unsigned long long)mesh.vertex_count, (unsigned long long)mesh.triangle_count);
        hewn_triangles_destroy(&mesh);
    }
}

static long long number_after(const char *line, const char *key)
{
    const char *at = strstr(line, key);
    return at ? strtoll(at + strlen(key), NULL, 10) : -1;
}

/* One line of STATS.txt, which another program counted, against what Hewn reads and certifies. */
static bool check_stats(const char *data, const char *line)
{
    static const char *const parts[] = {"mesh-scan/", "mesh-open/", "mesh-control/", "subdiv-baseline/", "boolean/"};
    char file[256], path[4400];
    bool wanted = false;
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        wanted = wanted || strncmp(line, parts[i], strlen(parts[i])) == 0;
    if (!wanted || sscanf(line, "%255s", file) != 1 || !is_readable(file) || !strstr(line, " V="))
        return false;
    snprintf(path, sizeof path, "%s/%s", data, file);
    hewn_triangles mesh;
    hewn_error error = {0};
    hewn_certificate c;
    if (hewn_triangles_read(path, &mesh, &error) != HEWN_OK || hewn_certify(&mesh, NULL, &c, &error) != HEWN_OK)
        fail_msg("%s: %s", file, error.message);
    long long chi = number_after(line, " chi=");
    bool same = (long long)mesh.vertex_count == number_after(line, " V=") &&
                (long long)mesh.triangle_count == number_after(line, " triangulated=") &&
                (long long)c.components == number_after(line, " comp=") &&
                (long long)c.boundary_edges == number_after(line, " bndE=") &&
                (long long)c.non_manifold_edges == number_after(line, " nonmanE=") &&
                c.oriented == (number_after(line, " flipE=") == 0) &&
                (c.genus < 0 || 2 * ((long long)c.components - c.genus) == chi);
    if (!same)
        fail_msg("%s: %llu vertices, %llu components, genus %lld, %llu boundary, %llu non-manifold, oriented %d; %s",
                 file, (unsigned long long)mesh.vertex_count, (unsigned long long)c.components, (long long)c.genus,
                 (unsigned long long)c.boundary_edges, (unsigned long long)c.non_manifold_edges, c.oriented, line);
    hewn_triangles_destroy(&mesh);
    return true;
}

static void test_data_agrees_with_its_statistics(void **state)
{
    (void)state;
    char data[4096], path[4200], line[1024];
    FILE *stats = NULL;
    if (data_folder(data)) {
        snprintf(path, sizeof path, "%s/STATS.txt", data);
        stats = fopen(path, "r");
    }
    if (!stats)
        skip();
    size_t checked = 0;
    while (fgets(line, sizeof line, stats)) {
        char *tab = strchr(line, '\t');
        if (tab)
            *tab = ' ';
        checked += check_stats(data, line);
    }
    fclose(stats);
    assert_true(checked >= 60);
}

static void test_mesh_read_errors(void **state)
{
    (void)state;
    hewn_triangles mesh = {.vertex_count = 1};
    hewn_error error;
    assert_int_equal(hewn_triangles_read("x.unknown", &mesh, &error), HEWN_INVALID_ARGUMENT);
    assert_int_equal(mesh.vertex_count, 0);
    assert_int_equal(hewn_triangles_read("/nonexistent/x.stl", &mesh, &error), HEWN_IO);
    assert_string_equal(error.file, "/nonexistent/x.stl");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_data_malformed),
        cmocka_unit_test(test_data_known_results),
        cmocka_unit_test(test_data_agrees_with_its_statistics),
        cmocka_unit_test(test_mesh_read_errors),
    };
    return cmocka_run_group_tests_name("io_read", tests, NULL, NULL);
}
