/* Meshes of label volumes: of random ones every shell is closed, manifold and oriented, shells fit each other, and
 * nothing runs through anything. */
#include <math.h>
#include <omp.h>

#include "base/order.h"
#include "hewn/check.h"
#include "hewn/labels.h"
#include "test_model_support.h"
#include "volume/blocks.h"

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

/* Whether a shell is closed, manifold and oriented outward (`flat`: or without volume), also when equal positions are
 * one vertex. The volume of it. */
static double check_any_shell(const hewn_label_mesh *mesh, uint32_t number, bool flat)
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
    assert_true(volume > 0 || flat);
    hewn_check_destroy(&check);
    hewn_model_destroy(&shell);
    return volume;
}

static double check_shell(const hewn_label_mesh *mesh, uint32_t number)
{
    return check_any_shell(mesh, number, false);
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
        assert_true(mesh->sides[2 * t] > mesh->sides[2 * t + 1]);
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
    int rounds = is_long() ? 20000 : 400;
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
    assert_int_equal(pierced[0], 0);
    assert_int_equal(pierced[1], 0);
    print_message("# %llu triangles as made, %llu pairs meet; %llu relaxed, %llu pairs meet\n",
                  (unsigned long long)triangles[0], (unsigned long long)pierced[0], (unsigned long long)triangles[1],
                  (unsigned long long)pierced[1]);
}

/* The least distance of two vertices, along the axis where it is greatest. */
static double find_nearest(const hewn_label_mesh *mesh)
{
    double nearest = INFINITY;
    for (uint64_t v = 0; v < mesh->vertex_count; v++)
        for (uint64_t w = 0; w < v; w++) {
            double distance = 0;
            for (int axis = 0; axis < 3; axis++)
                distance = fmax(distance, fabs(mesh->positions[3 * v + axis] - mesh->positions[3 * w + axis]));
            nearest = fmin(nearest, distance);
        }
    return nearest;
}

/* The next way to part eight corners into classes, numbered in the order in which they appear; false after the last. */
static bool next_parting(uint8_t of[8])
{
    for (int at = 7; at > 0; at--) {
        uint8_t most = 0;
        for (int i = 0; i < at; i++)
            most = of[i] > most ? of[i] : most;
        if (of[at] <= most) {
            of[at]++;
            memset(of + at + 1, 0, (size_t)(7 - at));
            return true;
        }
    }
    return false;
}

/* Every way in which a cell can be parted, with the outside around; one class is outside too in turn. Classes' order
 * decides where two labels cross on a face, so each is meshed in both orders. */
static void test_all_cells(void **state)
{
    (void)state;
    uint8_t parting[8] = {0};
    uint64_t pierced = 0, count = 0;
    double nearest = INFINITY;
    hewn_volume volume = make_volume(2, 2, 2, HEWN_VOXEL_UINT8);
    uint8_t *voxels = volume.memory;
    do {
        for (int turned = 0; turned < 2; turned++)
            for (uint8_t outside = 0; outside < 3; outside++) { /* none, or class 0 or 1 */
                uint64_t inside = 0;
                for (int i = 0; i < 8; i++) {
                    voxels[i] = (uint8_t)(parting[i] + 1 == outside ? 0 : turned ? 9 - parting[i] : parting[i] + 1);
                    inside += voxels[i] != 0;
                }
                if (inside == 0)
                    continue;
                hewn_label_mesh mesh = mesh_labels(&volume, (uint32_t)turned * 3);
                check_mesh(&volume, &mesh, &pierced);
                nearest = turned ? nearest : fmin(nearest, find_nearest(&mesh));
                hewn_label_mesh_destroy(&mesh);
                count++;
            }
    } while (next_parting(parting));
    assert_true(count > 20000);
    print_message("# vertices are at least %g of a cell apart before they are relaxed\n", nearest);
    assert_true(nearest > 2.6 / 32); /* so those that may go 1 / 32 do not meet (src/labels/relax.c) */
    assert_int_equal(pierced, 0);
    hewn_volume_destroy(&volume);
}

static void assert_same(const hewn_label_mesh *one, const hewn_label_mesh *other)
{
    assert_int_equal(one->vertex_count, other->vertex_count);
    assert_int_equal(one->triangle_count, other->triangle_count);
    assert_memory_equal(one->positions, other->positions, one->vertex_count * 3 * sizeof(double));
    assert_memory_equal(one->indices, other->indices, one->triangle_count * 3 * sizeof(uint32_t));
    assert_memory_equal(one->sides, other->sides, one->triangle_count * 2 * sizeof(uint16_t));
    assert_memory_equal(one->faces, other->faces, one->triangle_count * 2 * sizeof(uint32_t));
}

/* The same bytes for any number of threads. */
static void test_threads(void **state)
{
    (void)state;
    random_state random = {11};
    int before = omp_get_max_threads();
    for (int round = 0; round < 10; round++) {
        hewn_volume volume = make_random(&random, 5, 8);
        omp_set_num_threads(1);
        hewn_label_mesh one = mesh_labels(&volume, 4);
        omp_set_num_threads(5);
        hewn_label_mesh many = mesh_labels(&volume, 4);
        assert_same(&one, &many);
        hewn_label_mesh_destroy(&one);
        hewn_label_mesh_destroy(&many);
        hewn_volume_destroy(&volume);
    }
    omp_set_num_threads(before);
}

/* A block of voxels in an oblique, anisotropic lattice of either hand: its corners' faces are where they should be,
 * half a voxel beyond the outermost centres, and its volume is positive. */
static void test_place(void **state)
{
    (void)state;
    for (int hand = -1; hand <= 1; hand += 2) {
        hewn_volume volume = make_volume(7, 6, 5, HEWN_VOXEL_UINT8);
        const double to_world[16] = {0.8 * hand, -0.3, 0.1, 10, 0.2 * hand, 1.1, 0.4, -20, 0, 0.1, 2.5, 7, 0, 0, 0, 1};
        memcpy(volume.to_world, to_world, sizeof to_world);
        for (int k = 1; k < 4; k++)
            for (int j = 2; j < 6; j++)
                for (int i = 0; i < 4; i++)
                    ((uint8_t *)volume.memory)[i + 7 * (j + 6 * k)] = 3;
        hewn_label_mesh mesh = mesh_labels(&volume, 0);
        assert_int_equal(mesh.label_count, 1);
        double lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY}, back[12];
        hewn_volume_from_world(&volume, back);
        for (uint64_t v = 0; v < mesh.vertex_count; v++)
            for (int row = 0; row < 3; row++) {
                const double *p = mesh.positions + 3 * v, *m = back + 4 * row;
                double at = m[0] * p[0] + m[1] * p[1] + m[2] * p[2] + m[3];
                lo[row] = fmin(lo[row], at);
                hi[row] = fmax(hi[row], at);
            }
        const double low[3] = {-0.5, 1.5, 0.5}, high[3] = {3.5, 5.5, 3.5};
        for (int axis = 0; axis < 3; axis++)
            assert_true(fabs(lo[axis] - low[axis]) < 1e-9 && fabs(hi[axis] - high[axis]) < 1e-9);
        double is = check_shell(&mesh, 1), of_block = 4 * 4 * 3 * fabs(hewn_volume_determinant(&volume));
        assert_true(is > 0.7 * of_block && is < of_block); /* its edges are blunt */
        hewn_label_mesh_destroy(&mesh);
        hewn_volume_destroy(&volume);
    }
}

/* What was asked for, from samples of any type, with slope and intercept. */
/* The same samples in blocks: some of them, what is around them being one label. */
static hewn_volume in_blocks(const hewn_volume *dense, uint64_t background)
{
    const int32_t first[3] = {-5, 4090, 122};
    const size_t size = hewn_voxel_size(dense->type);
    hewn_volume volume = *dense;
    hewn_blocks_plan plan;
    assert_int_equal(hewn_blocks_begin(dense, first, &background, &plan, NULL), HEWN_OK);
    for (int pass = 0; pass < 2; pass++) {
        char *to = NULL;
        if (pass == 1) {
            volume.memory_length = hewn_blocks_bytes(&plan);
            volume.memory = hewn_alloc(volume.memory_length, 1);
            assert_non_null(volume.memory);
            to = hewn_blocks_finish(&plan, volume.memory);
        }
        for (int32_t n = 0; n < 5 * 5 * 5; n++) {
            const int32_t origin[3] = {-8 + 8 * (n % 5), 4088 + 8 * (n / 5 % 5), 120 + 8 * (n / 25)};
            bool added = n % 3 != 0 && hewn_blocks_hold(&plan, origin);
            if (added && pass == 0)
                assert_int_equal(hewn_blocks_add_block(&plan, origin, &added, NULL), HEWN_OK);
            for (int32_t i = 0; i < HEWN_BLOCK_SAMPLES; i++) {
                uint32_t at[3] = {(uint32_t)(origin[0] + i % 8 - first[0]),
                                  (uint32_t)(origin[1] + i / 8 % 8 - first[1]),
                                  (uint32_t)(origin[2] + i / 64 - first[2])};
                if (at[0] >= dense->dims[0] || at[1] >= dense->dims[1] || at[2] >= dense->dims[2])
                    continue;
                char *sample = (char *)dense->memory +
                               size * (at[0] + dense->dims[0] * (at[1] + (uint64_t)dense->dims[1] * at[2]));
                if (added && pass == 1)
                    memcpy(to + size * (size_t)i, sample, size);
                else if (!added)
                    memcpy(sample, &background, size);
            }
            to += added && pass == 1 ? size * HEWN_BLOCK_SAMPLES : 0;
        }
    }
    hewn_blocks_clear(&plan);
    volume.samples = NULL;
    volume.blocks = volume.memory;
    return volume;
}

static void test_blocks(void **state)
{
    (void)state;
    static const hewn_voxel types[] = {HEWN_VOXEL_UINT8, HEWN_VOXEL_INT16, HEWN_VOXEL_INT32};
    random_state random = {53};
    for (size_t n = 0; n < sizeof types / sizeof *types; n++) {
        hewn_volume dense = make_volume(20, 17, 22, types[n]);
        const size_t size = hewn_voxel_size(types[n]);
        for (size_t i = 0; i < (size_t)20 * 17 * 22; i++)
            ((char *)dense.memory)[size * i] = (char)random_below(&random, 4);
        hewn_volume blocks = in_blocks(&dense, n);
        hewn_label_mesh a = mesh_labels(&dense, 2), b = mesh_labels(&blocks, 2);
        assert_same(&a, &b);
        assert_true(a.label_count == 3);
        hewn_label_mesh_destroy(&a);
        hewn_label_mesh_destroy(&b);
        hewn_volume_destroy(&dense);
        hewn_volume_destroy(&blocks);
    }
}

static void test_choice(void **state)
{
    (void)state;
    for (int type = 0; type < HEWN_VOXEL_COUNT; type++) {
        hewn_volume volume = make_volume(5, 1, 1, (hewn_voxel)type);
        static const int values[5] = {0, 1, 2, 1, 3}; /* 4, 6, 8, 6, 10 as labels */
        static const uint16_t halves[4] = {0, 0x3c00, 0x4000, 0x4200};
        for (int i = 0; i < 5; i++) {
            int64_t whole = values[i];
            double real = values[i];
            float single = (float)real;
            const void *from = type == HEWN_VOXEL_FLOAT    ? (const void *)&single
                               : type == HEWN_VOXEL_DOUBLE ? (const void *)&real
                               : type == HEWN_VOXEL_HALF   ? (const void *)&halves[values[i]]
                                                           : (const void *)&whole;
            memcpy((char *)volume.memory + (size_t)i * hewn_voxel_size((hewn_voxel)type), from,
                   hewn_voxel_size((hewn_voxel)type));
        }
        volume.slope = 2;
        volume.intercept = 4;
        const int64_t wanted[] = {10, 6, 6, 77};
        hewn_label_mesh mesh;
        assert_int_equal(hewn_labels_mesh(&volume, &(hewn_label_desc){.labels = wanted, .label_count = 4}, &mesh, NULL),
                         HEWN_OK);
        assert_int_equal(mesh.label_count, 2);
        assert_true(mesh.labels[0] == 6 && mesh.labels[1] == 10);
        assert_true(mesh.voxel_count[0] == 2 && mesh.voxel_count[1] == 1);
        assert_int_equal(hewn_label_mesh_find(&mesh, 10), 2);
        assert_int_equal(hewn_label_mesh_find(&mesh, 77), 0);
        check_shell(&mesh, 1);
        check_shell(&mesh, 2);
        hewn_label_mesh_destroy(&mesh);
        assert_int_equal(hewn_labels_mesh(&volume, NULL, &mesh, NULL), HEWN_OK); /* 4 is no outside */
        assert_int_equal(mesh.label_count, 4);
        hewn_label_mesh_destroy(&mesh);
        hewn_volume_destroy(&volume);
    }
}

static void test_refused(void **state)
{
    (void)state;
    hewn_volume volume = make_volume(3, 2, 2, HEWN_VOXEL_DOUBLE);
    double *voxels = volume.memory;
    static const double bad[] = {0.5, NAN, INFINITY, -1e300, 9007199254740994.0};
    hewn_label_mesh mesh;
    hewn_error error;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        voxels[10] = bad[i];
        assert_int_equal(hewn_labels_mesh(&volume, NULL, &mesh, &error), HEWN_BAD_INPUT);
        assert_non_null(strstr(error.message, "voxel 1,1,1 is "));
        assert_null(mesh.positions);
    }
    voxels[10] = 0;
    assert_int_equal(hewn_labels_mesh(&volume, NULL, &mesh, &error), HEWN_BAD_INPUT);
    voxels[10] = 1;
    const int64_t none[] = {5};
    assert_int_equal(hewn_labels_mesh(&volume, &(hewn_label_desc){.labels = none, .label_count = 1}, &mesh, &error),
                     HEWN_BAD_INPUT);
    assert_int_equal(hewn_labels_mesh(&volume, &(hewn_label_desc){.frame = 1}, &mesh, &error), HEWN_INVALID_ARGUMENT);
    hewn_volume_destroy(&volume);
    volume = make_volume(300, 300, 1, HEWN_VOXEL_INT32);
    for (int i = 0; i < 90000; i++)
        ((int32_t *)volume.memory)[i] = i;
    assert_int_equal(hewn_labels_mesh(&volume, NULL, &mesh, &error), HEWN_LIMIT);
    hewn_volume_destroy(&volume);
}

/* Smoothing all shells as one leaves them fitting each other. */
static void test_smooth(void **state)
{
    (void)state;
    random_state random = {13};
    for (int round = 0; round < 12; round++) {
        hewn_volume volume = make_random(&random, 4, 6);
        hewn_label_mesh mesh = mesh_labels(&volume, 0);
        double *before = hewn_alloc(mesh.vertex_count, 3 * sizeof *before);
        memcpy(before, mesh.positions, mesh.vertex_count * 3 * sizeof *before);
        hewn_smooth_desc desc = {.method = (hewn_smooth_method)(round % HEWN_SMOOTH_COUNT), .iterations = 2};
        hewn_smooth_report report;
        hewn_error error = {0};
        if (hewn_label_mesh_smooth(&mesh, &desc, &report, &error) != HEWN_OK)
            fail_msg("%s", error.message);
        assert_true(report.largest_move > 0);
        assert_true(memcmp(before, mesh.positions, mesh.vertex_count * 3 * sizeof *before) != 0);
        double inside = 0, outside = 0;
        for (uint32_t n = 0; n <= mesh.label_count; n++)
            for (uint64_t i = mesh.first[n]; i < mesh.first[n + 1]; i++) {
                double one = signed_volume(mesh.positions, mesh.indices + 3 * (size_t)(mesh.faces[i] >> 1), 1);
                *(n ? &inside : &outside) += mesh.faces[i] & 1 ? -one : one;
            }
        assert_true(fabs(inside + outside) <= 1e-9 * inside);
        hewn_free(before);
        hewn_label_mesh_destroy(&mesh);
        hewn_volume_destroy(&volume);
    }
}

/* --- simplification ---------------------------------------------------------------------------------------------- */

static double volume_of(const hewn_label_mesh *mesh, uint32_t number)
{
    double sum = 0;
    for (uint64_t i = mesh->first[number]; i < mesh->first[number + 1]; i++) {
        const double one = signed_volume(mesh->positions, mesh->indices + 3 * (size_t)(mesh->faces[i] >> 1), 1);
        sum += mesh->faces[i] & 1 ? -one : one;
    }
    return sum;
}

static int64_t euler_of(const hewn_label_mesh *mesh, uint32_t number)
{
    hewn_model shell;
    hewn_check *check;
    assert_int_equal(hewn_label_mesh_shell(mesh, number, &shell, NULL), HEWN_OK);
    const hewn_polygons polygons = hewn_model_polygons(&shell);
    assert_int_equal(hewn_check_polygons(&polygons, &(hewn_check_desc){.skip_self_intersections = true}, &check, NULL),
                     HEWN_OK);
    const int64_t euler = check->euler, components = (int64_t)check->certificate.components;
    hewn_check_destroy(&check);
    hewn_model_destroy(&shell);
    return 1000 * components + euler;
}

/* Each shell alone is sound and has the components and handles that it had, and together they still fill what they
 * filled without a gap: what two share is the same to the bit, for the mesh has it once. */
static void check_simplified(const hewn_label_mesh *before, const hewn_label_mesh *after, bool flat)
{
    double inside = 0;
    assert_int_equal(before->label_count, after->label_count);
    for (uint32_t n = 1; n <= after->label_count; n++) {
        inside += check_any_shell(after, n, flat);
        assert_int_equal(euler_of(before, n), euler_of(after, n));
    }
    assert_true(fabs(inside + volume_of(after, 0)) <= 1e-9 * (1 + inside));
    check_places(after);
    for (uint64_t t = 0; t < after->triangle_count; t++)
        assert_true(after->sides[2 * t] > after->sides[2 * t + 1]);
}

static void test_simplified_noise(void **state)
{
    (void)state;
    random_state random = {19};
    uint64_t before = 0, left = 0;
    const int rounds = is_long() ? 4000 : 60;
    for (int round = 0; round < rounds; round++) {
        hewn_volume volume = make_random(&random, 1 + (uint32_t)round % 6, 1 + (uint32_t)round % 6);
        hewn_label_mesh mesh = mesh_labels(&volume, 8), small = mesh_labels(&volume, 8);
        hewn_error error = {0};
        hewn_simplify_report report;
        if (hewn_label_mesh_simplify(&small, &(hewn_simplify_desc){.faces = 1}, &report, &error) != HEWN_OK)
            fail_msg("%s", error.message);
        assert_int_equal(report.triangles_before, mesh.triangle_count);
        assert_int_equal(report.triangles, small.triangle_count);
        check_simplified(&mesh, &small, true);
        before += mesh.triangle_count;
        left += small.triangle_count;
        hewn_label_mesh_destroy(&mesh);
        hewn_label_mesh_destroy(&small);
        hewn_volume_destroy(&volume);
    }
    print_message("# %llu triangles became %llu\n", (unsigned long long)before, (unsigned long long)left);
    assert_true(2 * left < before);
}

/* A ball of 4 labels, one a quarter, so that a curve runs from pole to pole and four more over the surface. */
static hewn_volume make_quartered_ball(uint32_t n)
{
    hewn_volume volume = make_volume(n, n, n, HEWN_VOXEL_UINT8);
    const double middle = (n - 1) / 2.0;
    for (uint32_t k = 0; k < n; k++)
        for (uint32_t j = 0; j < n; j++)
            for (uint32_t i = 0; i < n; i++) {
                const double x = i - middle, y = j - middle, z = k - middle;
                if (x * x + y * y + z * z < 0.2 * n * n)
                    ((uint8_t *)volume.memory)[i + (size_t)n * (j + (size_t)n * k)] =
                        (uint8_t)(1 + (x > 0.1 * y) + 2 * (y > 0));
            }
    return volume;
}

/* Vertices at the ends of edges that have not two triangles. */
static uint64_t count_curve_vertices(const hewn_label_mesh *mesh)
{
    const uint64_t count = 3 * mesh->triangle_count;
    uint64_t *edges = malloc(count * sizeof *edges), sum = 0;
    uint8_t *on_curve = calloc(mesh->vertex_count, 1);
    assert_true(edges && on_curve);
    for (uint64_t c = 0; c < count; c++) {
        const uint64_t a = mesh->indices[c], b = mesh->indices[c % 3 == 2 ? c - 2 : c + 1];
        edges[c] = a < b ? a << 32 | b : b << 32 | a;
    }
    qsort(edges, count, sizeof *edges, hewn_order_uint64);
    for (uint64_t i = 0, end; i < count; i = end) {
        for (end = i + 1; end < count && edges[end] == edges[i];)
            end++;
        if (end - i != 2)
            on_curve[edges[i] >> 32] = on_curve[(uint32_t)edges[i]] = 1;
    }
    for (uint64_t v = 0; v < mesh->vertex_count; v++)
        sum += on_curve[v];
    free(edges);
    free(on_curve);
    return sum;
}

/* Curves between labels become coarser, stay where they were, and do not if they are locked. The error is kept. */
static void test_simplified_curves(void **state)
{
    (void)state;
    hewn_volume volume = make_quartered_ball(48);
    hewn_label_mesh mesh = mesh_labels(&volume, 16);
    for (int kind = 0; kind < 3; kind++) {
        hewn_label_mesh small = mesh_labels(&volume, 16);
        const hewn_simplify_desc desc = {
            .ratio = kind < 2 ? 0.02 : 0, .error = kind < 2 ? 0 : 0.5, .lock_boundary = kind == 1};
        hewn_simplify_report report;
        hewn_error error = {0};
        if (hewn_label_mesh_simplify(&small, &desc, &report, &error) != HEWN_OK)
            fail_msg("%s", error.message);
        check_simplified(&mesh, &small, false);
        assert_int_equal(report.reached, kind != 1);
        if (kind == 1) /* each once, however many labels meet there */
            assert_int_equal(report.locked_vertices, count_curve_vertices(&small));
        assert_true(kind != 2 || (report.distance <= 0.5 && small.triangle_count < mesh.triangle_count / 10));
        for (uint32_t n = 1; n <= 4 && kind != 1; n++) { /* locked curves leave too few triangles for the rest */
            const double change = fabs(volume_of(&small, n) / volume_of(&mesh, n) - 1);
            if (change > (kind == 0 ? 0.03 : 0.1)) /* an error of 0.5 is that of a radius of 21 */
                fail_msg("kind %d, label %u: the volume changed by %g", kind, n, change);
        }
        hewn_label_mesh_destroy(&small);
    }
    hewn_label_mesh_destroy(&mesh);
    hewn_volume_destroy(&volume);
}

static void test_simplified_threads(void **state)
{
    (void)state;
    hewn_volume volume = make_quartered_ball(72);
    const int threads = omp_get_max_threads();
    hewn_label_mesh one = {0};
    for (int count = 1; count <= 5; count += 2) {
        omp_set_num_threads(count);
        hewn_label_mesh mesh = mesh_labels(&volume, 4);
        assert_int_equal(hewn_label_mesh_simplify(&mesh, &(hewn_simplify_desc){.ratio = 0.1}, NULL, NULL), HEWN_OK);
        if (count == 1) {
            one = mesh;
            continue;
        }
        assert_int_equal(one.vertex_count, mesh.vertex_count);
        assert_int_equal(one.triangle_count, mesh.triangle_count);
        assert_memory_equal(one.positions, mesh.positions, one.vertex_count * 3 * sizeof(double));
        assert_memory_equal(one.indices, mesh.indices, one.triangle_count * 3 * sizeof(uint32_t));
        assert_memory_equal(one.sides, mesh.sides, one.triangle_count * 2 * sizeof(uint16_t));
        hewn_label_mesh_destroy(&mesh);
    }
    omp_set_num_threads(threads);
    hewn_label_mesh_destroy(&one);
    hewn_volume_destroy(&volume);
}

static void test_simplify_refused(void **state)
{
    (void)state;
    hewn_volume volume = make_quartered_ball(12);
    hewn_label_mesh mesh = mesh_labels(&volume, 0);
    const uint64_t before = mesh.triangle_count;
    hewn_error error;
    const hewn_simplify_desc bad[] = {{0}, {.ratio = 2}, {.error = NAN}, {.faces = 9, .no_self_intersections = true}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_int_equal(hewn_label_mesh_simplify(&mesh, &bad[i], NULL, &error), HEWN_INVALID_ARGUMENT);
    assert_int_equal(mesh.triangle_count, before);
    check_shell(&mesh, 1);
    hewn_label_mesh_destroy(&mesh);
    hewn_volume_destroy(&volume);
}

/* The shells side by side and the shared mesh, as models. */
static void test_models(void **state)
{
    (void)state;
    random_state random = {17};
    hewn_volume volume = make_random(&random, 3, 3);
    hewn_label_mesh mesh = mesh_labels(&volume, 2);
    hewn_model model;
    char names[8][8];
    const char *list[8];
    for (uint32_t n = 0; n < mesh.label_count; n++) {
        snprintf(names[n], sizeof names[n], "n%u", n);
        list[n] = names[n];
    }
    assert_int_equal(hewn_label_mesh_shells(&mesh, list, &model, NULL), HEWN_OK);
    assert_int_equal(hewn_model_check(&model, NULL), HEWN_OK);
    assert_int_equal(model.face_count, mesh.first[mesh.label_count + 1] - mesh.first[1]);
    hewn_channel *object = hewn_model_find_channel(&model, HEWN_DOMAIN_FACE, "object");
    assert_int_equal(object->name_count, mesh.label_count);
    assert_int_equal(((int32_t *)object->values)[model.face_count - 1], mesh.label_count - 1);
    hewn_model_destroy(&model);
    assert_int_equal(hewn_label_mesh_model(&mesh, -1, &model, NULL), HEWN_OK);
    assert_int_equal(hewn_model_check(&model, NULL), HEWN_OK);
    const int32_t *front = hewn_model_find_channel(&model, HEWN_DOMAIN_FACE, "front")->values;
    for (uint64_t t = 0; t < model.face_count; t++)
        assert_true(front[t] == -1 ? mesh.sides[2 * t + 1] == 0 : mesh.labels[mesh.sides[2 * t + 1] - 1] == front[t]);
    hewn_model_destroy(&model);
    assert_int_equal(hewn_label_mesh_shell(&mesh, 0, &model, NULL), HEWN_INVALID_ARGUMENT);
    assert_int_equal(hewn_label_mesh_shell(&mesh, mesh.label_count + 1, &model, NULL), HEWN_INVALID_ARGUMENT);
    hewn_label_mesh_destroy(&mesh);
    hewn_volume_destroy(&volume);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random),
        cmocka_unit_test(test_all_cells),
        cmocka_unit_test(test_threads),
        cmocka_unit_test(test_place),
        cmocka_unit_test(test_blocks),
        cmocka_unit_test(test_choice),
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_smooth),
        cmocka_unit_test(test_simplified_noise),
        cmocka_unit_test(test_simplified_curves),
        cmocka_unit_test(test_simplified_threads),
        cmocka_unit_test(test_simplify_refused),
        cmocka_unit_test(test_models),
    };
    omp_set_num_threads(1); /* volumes are small, and many */
    return cmocka_run_group_tests_name("labels", tests, NULL, NULL);
}
