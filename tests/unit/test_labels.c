/* Meshes of label volumes: of random ones every shell is closed, manifold and oriented, shells fit each other, and
 * nothing runs through anything. */
#include <math.h>
#include <omp.h>

#include "hewn/check.h"
#include "hewn/labels.h"
#include "test_model_support.h"

static hewn_volume make_volume(uint32_t x, uint32_t y, uint32_t z, hewn_voxel type)
{
    hewn_volume volume = {.dims = {x, y, z}, .frame_count = 1, .type = type, .slope = 1};
    for (int i = 0; i < 4; i++)
        volume.to_world[5 * i] = 1;
    volume.samples = volume.memory = hewn_alloc_zero((size_t)x * y * z, hewn_voxel_size(type));
    assert_non_null(volume.samples);
    return volume;
}

/* Labels 0 to `labels`, in lumps where `lumps` is above 1. */
static hewn_volume make_random(random_state *random, uint32_t labels, uint32_t lumps)
{
    uint32_t dims[3];
    for (int axis = 0; axis < 3; axis++)
        dims[axis] = 1 + random_below(random, 5 * lumps);
    hewn_volume volume = make_volume(dims[0], dims[1], dims[2], HEWN_VOXEL_UINT8);
    uint8_t *to = volume.memory;
    for (uint32_t k = 0; k < dims[2]; k++)
        for (uint32_t j = 0; j < dims[1]; j++)
            for (uint32_t i = 0; i < dims[0]; i++) {
                size_t from = i / lumps * lumps + dims[0] * (j / lumps * lumps + (size_t)dims[1] * (k / lumps * lumps));
                size_t at = i + dims[0] * (j + (size_t)dims[1] * k);
                bool lump = lumps > 1 && random_below(random, 8) != 0;
                to[at] = lump && from < at ? to[from] : (uint8_t)random_below(random, labels + 1);
            }
    to[0] = 1;
    return volume;
}

static hewn_label_mesh mesh_labels(const hewn_volume *volume, uint32_t relaxations)
{
    hewn_label_mesh mesh;
    hewn_error error = {0};
    hewn_label_desc desc = {.relaxations = relaxations};
    if (hewn_labels_mesh(volume, &desc, &mesh, &error) != HEWN_OK)
        fail_msg("%s", error.message);
    return mesh;
}

static double signed_volume(const double *positions, const uint32_t *corners, uint64_t count)
{
    double sum = 0;
    for (uint64_t t = 0; t < count; t++) {
        const double *a = positions + 3 * (size_t)corners[3 * t], *b = positions + 3 * (size_t)corners[3 * t + 1],
                     *c = positions + 3 * (size_t)corners[3 * t + 2];
        sum += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
               a[2] * (b[0] * c[1] - b[1] * c[0]);
    }
    return sum / 6;
}

/* Whether a shell is closed, manifold and oriented outward, also when equal positions are one vertex. The volume of it.
 */
static double check_shell(const hewn_label_mesh *mesh, uint32_t number)
{
    hewn_model shell;
    hewn_check *check;
    assert_int_equal(hewn_label_mesh_shell(mesh, number, &shell, NULL), HEWN_OK);
    hewn_polygons polygons = hewn_model_polygons(&shell);
    hewn_check_desc desc = {.skip_self_intersections = true};
    assert_int_equal(hewn_check_polygons(&polygons, &desc, &check, NULL), HEWN_OK);
    hewn_certificate is = check->certificate;
    if (!is.closed || !is.manifold || !is.oriented || is.degenerate_faces != 0 || check->isolated_vertices != 0)
        fail_msg("label number %u: closed %d, manifold %d (%d edges, %d vertices), oriented %d, degenerate %d", number,
                 is.closed, is.manifold, (int)is.non_manifold_edges, (int)is.non_manifold_vertices, is.oriented,
                 (int)is.degenerate_faces);
    double volume = signed_volume(shell.positions, shell.corners, shell.face_count);
    assert_true(volume > 0);
    hewn_check_destroy(&check);
    hewn_model_destroy(&shell);
    return volume;
}

static int compare_points(const void *a, const void *b)
{
    const double *p = a, *q = b;
    for (int axis = 0; axis < 3; axis++)
        if (p[axis] != q[axis])
            return p[axis] < q[axis] ? -1 : 1;
    return 0;
}

static void check_places(const hewn_label_mesh *mesh)
{
    double *points = hewn_alloc(mesh->vertex_count, 3 * sizeof *points);
    memcpy(points, mesh->positions, mesh->vertex_count * 3 * sizeof *points);
    qsort(points, mesh->vertex_count, 3 * sizeof *points, compare_points);
    for (uint64_t v = 1; v < mesh->vertex_count; v++)
        if (compare_points(points + 3 * v - 3, points + 3 * v) == 0)
            fail_msg("two vertices at %g %g %g", points[3 * v], points[3 * v + 1], points[3 * v + 2]);
    hewn_free(points);
}

/* Everything that holds of every mesh. `pierced` counts triangles that meet others. */
static void check_mesh(const hewn_volume *volume, const hewn_label_mesh *mesh, uint64_t *pierced)
{
    double sum = 0;
    uint64_t faces = 0, count, voxels = 0, not_outside = 0;
    for (uint32_t n = 1; n <= mesh->label_count; n++) {
        sum += check_shell(mesh, n);
        faces += mesh->first[n + 1] - mesh->first[n];
        voxels += mesh->voxel_count[n - 1];
    }
    for (uint64_t at = 0; at < hewn_volume_frame_size(volume); at++)
        not_outside += hewn_volume_value(volume, at) != 0;
    assert_int_equal(voxels, not_outside);
    assert_int_equal(faces + mesh->first[1], 2 * mesh->triangle_count);
    check_places(mesh);
    /* What all labels take together is what the outside leaves: so there is no gap and no overlap. */
    double outside = 0;
    for (uint64_t i = 0; i < mesh->first[1]; i++) {
        const uint32_t *c = mesh->indices + 3 * (size_t)(mesh->faces[i] >> 1);
        double one = signed_volume(mesh->positions, c, 1);
        outside += mesh->faces[i] & 1 ? -one : one;
    }
    assert_true(fabs(sum + outside) <= 1e-9 * (1 + sum));
    for (uint64_t t = 0; t < mesh->triangle_count; t++)
        assert_int_not_equal(mesh->sides[2 * t], mesh->sides[2 * t + 1]);
    assert_int_equal(hewn_count_self_intersections(mesh->positions, mesh->vertex_count, mesh->indices,
                                                   mesh->triangle_count, 0, NULL, NULL, &count, NULL),
                     HEWN_OK);
    *pierced += count;
}

static bool is_long(void)
{
    const char *value = getenv("HEWN_LONG");
    return value && *value && strcmp(value, "0") != 0;
}

static void test_random(void **state)
{
    (void)state;
    random_state random = {7};
    int rounds = is_long() ? 20000 : 1500;
    uint64_t pierced[2] = {0}, triangles[2] = {0};
    for (int round = 0; round < rounds; round++) {
        hewn_volume volume = make_random(&random, 1 + (uint32_t)round % 6, 1 + (uint32_t)round % 3);
        for (uint32_t relaxed = 0; relaxed < 2; relaxed++) {
            hewn_label_mesh mesh = mesh_labels(&volume, relaxed * 8);
            check_mesh(&volume, &mesh, &pierced[relaxed]);
            triangles[relaxed] += mesh.triangle_count;
            hewn_label_mesh_destroy(&mesh);
        }
        hewn_volume_destroy(&volume);
    }
    print_message("# %llu triangles as made, %llu pairs meet; %llu relaxed, %llu pairs meet\n",
                  (unsigned long long)triangles[0], (unsigned long long)pierced[0], (unsigned long long)triangles[1],
                  (unsigned long long)pierced[1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random),
    };
    return cmocka_run_group_tests_name("labels", tests, NULL, NULL);
}
