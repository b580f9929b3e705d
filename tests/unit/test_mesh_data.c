/* Meshes of the test data: what was counted in them by others (STATS.txt) is what the half-edge mesh has. */
#include "test_mesh_half.h"

#include "hewn/io.h"

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

/* An OFF file as polygons, comments and colours passed over; NULL where it cannot be read. */
static bool next_line(FILE *file, char line[PATH])
{
    while (fgets(line, PATH, file)) {
        const char *at = line + strspn(line, " \t\r\n");
        if (*at != '\0' && *at != '#')
            return true;
    }
    return false;
}

static hewn_mesh *read_off(const char *path, hewn_result *result, hewn_error *reason)
{
    char line[PATH];
    unsigned verts = 0, faces = 0;
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    assert_true(next_line(file, line) && strstr(line, "OFF"));
    assert_true(next_line(file, line) && sscanf(line, "%u %u", &verts, &faces) == 2);
    double *positions = calloc(verts + 1u, 3 * sizeof *positions);
    uint64_t *first = calloc(faces + 1u, sizeof *first);
    uint32_t *corners = calloc(faces + 1u, 16 * sizeof *corners);
    for (unsigned v = 0; v < verts; v++) {
        double *at = positions + 3 * v;
        assert_true(next_line(file, line) && sscanf(line, "%lf %lf %lf", at, at + 1, at + 2) == 3);
    }
    for (unsigned f = 0; f < faces; f++) {
        assert_true(next_line(file, line));
        char *at = line;
        uint64_t degree = strtoul(at, &at, 10);
        assert_true(degree <= 16);
        first[f + 1] = first[f] + degree;
        for (uint64_t i = first[f]; i < first[f + 1]; i++)
            corners[i] = (uint32_t)strtoul(at, &at, 10);
    }
    fclose(file);
    const hewn_polygons polygons = {verts, positions, faces, first, corners};
    hewn_mesh *mesh;
    *result = hewn_mesh_from_polygons(&polygons, &mesh, reason);
    free(positions);
    free(first);
    free(corners);
    return mesh;
}

static hewn_mesh *read_other(const char *path, hewn_result *result, hewn_error *reason)
{
    hewn_triangles triangles;
    hewn_mesh *mesh = NULL;
    assert_works(hewn_mesh_read(path, &triangles, error));
    *result = hewn_mesh_from_triangles(&triangles, &mesh, reason);
    hewn_triangles_destroy(&triangles);
    return mesh;
}

static uint32_t boundary_edges(const hewn_mesh *mesh)
{
    uint32_t count = 0;
    for (uint32_t h = 0; h < hewn_mesh_half_bound(mesh); h++)
        count += hewn_half_face(mesh, (hewn_half){h}).id == HEWN_NONE;
    return count;
}

/* Returns whether the file was compared. */
static bool compare(const char *folder, const stats *wanted)
{
    char path[PATH + 256];
    hewn_error reason = {0};
    hewn_result result = HEWN_OK;
    snprintf(path, sizeof path, "%s/%s", folder, wanted->name);
    const char *dot = strrchr(wanted->name, '.');
    bool off = strcmp(dot, ".off") == 0;
    if (!off && hewn_mesh_format_of(path) == HEWN_MESH_UNKNOWN)
        return false;
    hewn_mesh *mesh = off ? read_off(path, &result, &reason) : read_other(path, &result, &reason);
    if (wanted->non_manifold > 0 || wanted->flipped > 0) {
        assert_int_equal(result, HEWN_BAD_INPUT);
        assert_true(strstr(reason.message, "edge") != NULL);
        return true;
    }
    if (result != HEWN_OK)
        fail_msg("%s: %s", wanted->name, reason.message);
    assert_valid(mesh);
    /* Other formats come as triangles, cut from polygons one by one: counts of faces are those of OFF files only. */
    uint32_t used = 0;
    for (uint32_t v = 0; v < hewn_mesh_vert_bound(mesh); v++)
        used += hewn_vert_half(mesh, (hewn_vert){v}).id != HEWN_NONE;
    assert_int_equal(hewn_mesh_vert_bound(mesh), wanted->verts);
    if (off)
        assert_int_equal(hewn_mesh_face_count(mesh), wanted->faces);
    if (used == wanted->verts)
        assert_int_equal(euler_number(mesh), wanted->euler);
    assert_int_equal(boundary_edges(mesh), wanted->boundary);
    int64_t before = euler_number(mesh);
    assert_works(hewn_mesh_triangulate(mesh, error));
    assert_valid(mesh);
    assert_int_equal(euler_number(mesh), before);
    hewn_mesh_destroy(&mesh);
    return true;
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
        if (chosen && parse_stats(line, &wanted))
            compared += compare(folder, &wanted);
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
