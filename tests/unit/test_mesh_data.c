/* Meshes of the test data: what was counted in them by others (STATS.txt) is what the half-edge mesh has, also after a
 * way through every format that can hold it. */
#include "test_mesh_half.h"

#include <unistd.h>

#include "hewn/io.h"
#include "lib3mf_read.h"

enum { PATH = 4096 };

typedef struct stats {
    char name[256];
    uint32_t verts, faces, boundary, non_manifold, flipped;
    int32_t euler;
} stats;

/* Fields are parted by spaces or tabs. */
static bool number_after(const char *line, const char *key, int32_t *out)
{
    const char *at = line;
    while ((at = strstr(at, key)) != NULL && at > line && at[-1] != ' ' && at[-1] != '\t')
        at++;
    return at && sscanf(at + strlen(key), "%d", out) == 1;
}

static bool parse_stats(const char *line, stats *out)
{
    int32_t verts, faces, boundary, non_manifold, flipped;
    if (sscanf(line, "%255s", out->name) != 1 || !number_after(line, "V=", &verts) ||
        !number_after(line, "F=", &faces) || !number_after(line, "chi=", &out->euler) ||
        !number_after(line, "bndE=", &boundary) || !number_after(line, "nonmanE=", &non_manifold) ||
        !number_after(line, "flipE=", &flipped))
        return false;
    out->verts = (uint32_t)verts;
    out->faces = (uint32_t)faces;
    out->boundary = (uint32_t)boundary;
    out->non_manifold = (uint32_t)non_manifold;
    out->flipped = (uint32_t)flipped;
    return true;
}

static uint32_t boundary_edges(const hewn_mesh *mesh)
{
    uint32_t count = 0;
    for (uint32_t h = 0; h < hewn_mesh_half_bound(mesh); h++)
        count += hewn_half_face(mesh, (hewn_half){h}).id == HEWN_NONE;
    return count;
}

/* --- round trips -------------------------------------------------------------------------------------------------- */

typedef struct format {
    const char *extension;
    bool polygons, doubles, shared; /* shared: vertices keep their numbers */
} format;

static const format formats[] = {{"obj", true, true, true},
                                 {"ply", true, true, true},
                                 {"off", true, true, true},
                                 {"glb", false, false, true},
                                 {"stl", false, false, false}};

static void assert_same_position(const double *was, const double *is, bool doubles)
{
    for (int axis = 0; axis < 3; axis++) {
        double wanted = doubles ? was[axis] : (double)(float)was[axis];
        assert_true(wanted == is[axis]);
    }
}

/* The same vertices in the same order, and the same faces. */
static void assert_same_model(const hewn_model *was, const hewn_model *is, bool doubles)
{
    assert_int_equal(is->vertex_count, was->vertex_count);
    assert_int_equal(is->face_count, was->face_count);
    assert_int_equal(hewn_model_corner_count(is), hewn_model_corner_count(was));
    for (uint64_t v = 0; v < was->vertex_count; v++)
        assert_same_position(was->positions + 3 * v, is->positions + 3 * v, doubles);
    for (uint64_t c = 0; c < hewn_model_corner_count(was); c++)
        assert_int_equal(is->corners[c], was->corners[c]);
    for (uint64_t f = 0; was->first && is->first && f <= was->face_count; f++)
        assert_true(is->first[f] == was->first[f]);
}

/* The same triangles, corner by corner, whatever the vertices' numbers. */
static void assert_same_triangles(const hewn_triangles *was, const hewn_model *is)
{
    assert_int_equal(is->face_count, was->triangle_count);
    assert_null(is->first);
    for (uint64_t c = 0; c < 3 * was->triangle_count; c++)
        for (int axis = 0; axis < 3; axis++)
            assert_true((double)was->positions[3 * (size_t)was->indices[c] + axis] ==
                        is->positions[3 * (size_t)is->corners[c] + axis]);
}

static bool bits_less(const float *a, const float *b)
{
    return a[0] != b[0] ? a[0] < b[0] : a[1] != b[1] ? a[1] < b[1] : a[2] < b[2];
}

static int by_position(const void *a, const void *b)
{
    const float *left = a, *right = b;
    return bits_less(right, left) - bits_less(left, right);
}

/* Whether no two vertices round to the same floats: else a format without shared vertices must merge them. */
static bool positions_differ(const hewn_triangles *triangles)
{
    float *sorted = malloc((triangles->vertex_count + 1) * 3 * sizeof *sorted);
    assert_non_null(sorted);
    memcpy(sorted, triangles->positions, triangles->vertex_count * 3 * sizeof *sorted);
    qsort(sorted, triangles->vertex_count, 3 * sizeof *sorted, by_position);
    bool differ = true;
    for (uint64_t v = 1; v < triangles->vertex_count; v++)
        differ = differ && by_position(sorted + 3 * v - 3, sorted + 3 * v) != 0;
    free(sorted);
    return differ;
}

static void assert_same_topology(const hewn_mesh *was, const hewn_model *model, uint32_t isolated)
{
    hewn_mesh *is;
    assert_works(hewn_mesh_from_model(model, NULL, &is, NULL, error));
    assert_int_equal(euler_number(is), euler_number(was) - isolated);
    assert_int_equal(boundary_edges(is), boundary_edges(was));
    hewn_mesh_destroy(&is);
}

static void round_trip(const hewn_model *model, const hewn_mesh *mesh, uint32_t isolated, const format *by)
{
    char path[64];
    hewn_model again;
    hewn_triangles triangles;
    snprintf(path, sizeof path, "round_trip_%d.%s", (int)getpid(), by->extension);
    assert_works(hewn_model_write(model, path, NULL, error));
    assert_works(hewn_model_read(path, NULL, &again, error));
    assert_works(hewn_triangles_from_model(model, &triangles, error));
    unlink(path);
    if (by->polygons)
        assert_same_model(model, &again, by->doubles);
    else
        assert_same_triangles(&triangles, &again);
    if (by->shared) {
        assert_int_equal(again.vertex_count, model->vertex_count);
        assert_same_topology(mesh, &again, 0);
    } else if (positions_differ(&triangles)) {
        assert_int_equal(again.vertex_count, model->vertex_count - isolated);
        assert_same_topology(mesh, &again, isolated);
    }
    hewn_triangles_destroy(&triangles);
    hewn_model_destroy(&again);
}

/* 3MF is read by another library, which keeps floats. */
static void round_trip_3mf(const hewn_model *model, bool closed)
{
    char path[64];
    lib3mf_facts facts;
    hewn_triangles triangles;
    if (!lib3mf_is_there())
        return;
    snprintf(path, sizeof path, "round_trip_%d.3mf", (int)getpid());
    assert_works(hewn_model_write(model, path, NULL, error));
    assert_works(hewn_triangles_from_model(model, &triangles, error));
    assert_true(lib3mf_read(path, &facts));
    unlink(path);
    assert_int_equal(facts.warnings, 0);
    assert_int_equal(facts.vertices, triangles.vertex_count);
    assert_int_equal(facts.triangles, triangles.triangle_count);
    assert_true(facts.manifold == closed);
    assert_memory_equal(facts.corners, triangles.indices, 12 * triangles.triangle_count);
    for (uint64_t i = 0; i < 3 * triangles.vertex_count; i++)
        assert_true(facts.positions[i] == triangles.positions[i]);
    lib3mf_forget(&facts);
    hewn_triangles_destroy(&triangles);
}

/* --- counts ------------------------------------------------------------------------------------------------------- */

/* Edges with more than two faces, or two that run the same way, are split and counted, and what is left is manifold. */
static void compare_split(const hewn_model *model, const stats *wanted)
{
    hewn_mesh *mesh;
    hewn_error reason;
    hewn_repair_report report;
    assert_int_equal(hewn_mesh_from_model(model, NULL, &mesh, NULL, &reason), HEWN_BAD_INPUT);
    assert_true(strstr(reason.message, "edge") != NULL);
    hewn_repair_desc desc = hewn_repair_desc_default();
    assert_works(hewn_mesh_from_model(model, &desc, &mesh, &report, error));
    assert_valid(mesh);
    if (wanted->non_manifold > 0)
        assert_true(report.non_manifold_edges > 0);
    if (wanted->flipped > 0)
        assert_true(report.turned_faces + report.one_sided_cuts + report.non_manifold_edges > 0);
    hewn_mesh_destroy(&mesh);
}

static void compare(const char *folder, const stats *wanted)
{
    char path[PATH + 256];
    hewn_model model;
    hewn_mesh *mesh;
    snprintf(path, sizeof path, "%s/%s", folder, wanted->name);
    assert_works(hewn_model_read(path, NULL, &model, error));
    assert_int_equal(model.vertex_count, wanted->verts);
    assert_int_equal(model.face_count, wanted->faces);
    if (wanted->non_manifold > 0 || wanted->flipped > 0) {
        compare_split(&model, wanted);
        hewn_model_destroy(&model);
        return;
    }
    assert_works(hewn_mesh_from_model(&model, NULL, &mesh, NULL, error));
    assert_valid(mesh);
    uint32_t isolated = 0;
    for (uint32_t v = 0; v < hewn_mesh_vert_bound(mesh); v++)
        isolated += hewn_vert_half(mesh, (hewn_vert){v}).id == HEWN_NONE;
    assert_int_equal(euler_number(mesh) - isolated, wanted->euler);
    assert_int_equal(boundary_edges(mesh), wanted->boundary);
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++)
        round_trip(&model, mesh, isolated, &formats[i]);
    if (wanted->faces > 0)
        round_trip_3mf(&model, wanted->boundary == 0);
    int64_t before = euler_number(mesh);
    assert_works(hewn_mesh_triangulate(mesh, error));
    assert_valid(mesh);
    assert_int_equal(euler_number(mesh), before);
    hewn_mesh_destroy(&mesh);
    hewn_model_destroy(&model);
}

static void test_counts(void **state)
{
    (void)state;
    static const char *const folders[] = {"mesh-scan/", "mesh-control/", "mesh-open/"};
    char folder[PATH], path[PATH + 16], line[PATH];
    if (!data_folder(folder)) {
        print_message("# there is no folder of test data\n");
        skip();
    }
    snprintf(path, sizeof path, "%s/STATS.txt", folder);
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    uint32_t compared = 0;
    while (fgets(line, sizeof line, file)) {
        stats wanted;
        bool chosen = false;
        for (size_t i = 0; i < sizeof folders / sizeof *folders; i++)
            chosen |= strncmp(line, folders[i], strlen(folders[i])) == 0;
        if (chosen && parse_stats(line, &wanted)) {
            print_message("# %s\n", wanted.name);
            compare(folder, &wanted);
            compared++;
        }
    }
    fclose(file);
    print_message("# %u files compared\n", compared);
    assert_true(compared >= 40);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_counts)};
    return cmocka_run_group_tests_name("mesh_data", tests, NULL, NULL);
}
