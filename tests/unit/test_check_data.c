/* The check of every mesh of the test data, against the statistics that came with it. */
#include "hewn/check.h"
#include "hewn/io.h"
#include "test_mesh_support.h"

typedef struct known_stats {
    char name[256];
    long long vertices, faces, components, euler, boundary, crowded, flipped;
} known_stats;

static bool read_number(const char *line, const char *key, long long *out)
{
    const char *at = strstr(line, key);
    return at && sscanf(at + strlen(key), "%lld", out) == 1;
}

/* A line that tells of a mesh. */
static bool read_line(const char *line, known_stats *out)
{
    static const char *const kinds[] = {".obj\t", ".off\t", ".ply\t", ".stl\t", ".STL\t", ".gz\t", NULL};
    bool mesh = false;
    for (int i = 0; kinds[i]; i++)
        mesh = mesh || strstr(line, kinds[i]);
    return mesh && sscanf(line, "%255[^\t]", out->name) == 1 && read_number(line, " V=", &out->vertices) &&
           read_number(line, " F=", &out->faces) && read_number(line, " comp=", &out->components) &&
           read_number(line, " chi=", &out->euler) && read_number(line, " bndE=", &out->boundary) &&
           read_number(line, " nonmanE=", &out->crowded) && read_number(line, " flipE=", &out->flipped);
}

static void assert_known(const known_stats *known, const char *what, uint64_t got, long long expected)
{
    if ((long long)got != expected)
        fail_msg("%s: %llu %s, known are %lld", known->name, (unsigned long long)got, what, expected);
}

/* Whether the file could be read. */
static bool compare(const char *folder, const known_stats *known)
{
    char path[4400];
    hewn_model model;
    hewn_error error = {0};
    snprintf(path, sizeof path, "%s/%s", folder, known->name);
    if (hewn_model_read(path, NULL, &model, &error) != HEWN_OK)
        return false;
    hewn_polygons polygons = hewn_model_polygons(&model);
    hewn_check *c = NULL;
    const hewn_check_desc desc = {.skip_self_intersections = true};
    if (hewn_check_polygons(&polygons, &desc, &c, &error) != HEWN_OK)
        fail_msg("%s: %s", known->name, error.message);
    assert_known(known, "vertices", c->vertex_count, known->vertices);
    assert_known(known, "faces", c->face_count, known->faces);
    assert_known(known, "components", c->certificate.components, known->components);
    assert_known(known, "boundary edges", c->certificate.boundary_edges, known->boundary);
    if (c->sided_faces == c->face_count) { /* the statistics count the sides of collapsed faces, too */
        assert_known(known, "non-manifold edges", c->certificate.non_manifold_edges, known->crowded);
        if (c->euler != known->euler)
            fail_msg("%s: Euler characteristic %lld, known is %lld", known->name, (long long)c->euler, known->euler);
    }
    if (known->crowded == 0) /* and of edges of two faces only whether they are flipped */
        assert_known(known, "flipped edges", c->unoriented_edges, known->flipped);
    hewn_check_destroy(&c);
    hewn_model_destroy(&model);
    return true;
}

static void test_statistics(void **state)
{
    (void)state;
    char folder[4096], path[4200], line[4096];
    if (!data_folder(folder)) {
        print_message("# there is no folder of test data\n");
        skip();
    }
    snprintf(path, sizeof path, "%s/STATS.txt", folder);
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    int compared = 0;
    while (fgets(line, sizeof line, file)) {
        known_stats known = {0};
        if (read_line(line, &known))
            compared += compare(folder, &known);
    }
    fclose(file);
    print_message("# %d meshes\n", compared);
    assert_true(compared > 60);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_statistics)};
    return cmocka_run_group_tests_name("check_data", tests, NULL, NULL);
}
