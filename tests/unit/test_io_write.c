/* Writing meshes: what is written reads back as it was, by Hewn and by assimp, and failures leave nothing behind. */
#include <dirent.h>
#include <errno.h>
#include <omp.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/error.h"
#include "base/file.h"
#include "hewn/io.h"
#include "test_mesh_support.h"

static const char *const files[] = {"mesh.glb", "mesh.obj", "mesh.ply", "mesh.stl"};

static char folder[64];

static int enter_folder(void **state)
{
    (void)state;
    make_folder(folder);
    return chdir(folder);
}

static size_t count_entries(bool remove)
{
    size_t count = 0;
    DIR *open = opendir(".");
    for (struct dirent *entry; open && (entry = readdir(open));)
        if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0) {
            count++;
            if (remove)
                unlink(entry->d_name);
        }
    if (open)
        closedir(open);
    return count;
}

static int leave_folder(void **state)
{
    (void)state;
    count_entries(true);
    return chdir("/") != 0 || rmdir(folder) != 0;
}

static void write_mesh(const hewn_triangles *mesh, const char *path, const hewn_write_desc *desc)
{
    hewn_error error = {0};
    if (hewn_triangles_write(mesh, path, desc, &error) != HEWN_OK)
        fail_msg("%s: %s", path, error.message);
}

static hewn_triangles read_mesh(const char *path)
{
    hewn_triangles mesh;
    hewn_error error = {0};
    if (hewn_triangles_read(path, &mesh, &error) != HEWN_OK)
        fail_msg("%s: %s", path, error.message);
    return mesh;
}

static void assert_same_mesh(const hewn_triangles *a, const hewn_triangles *b)
{
    assert_int_equal(a->vertex_count, b->vertex_count);
    assert_int_equal(a->triangle_count, b->triangle_count);
    if (a->vertex_count > 0)
        assert_memory_equal(a->positions, b->positions, a->vertex_count * 3 * sizeof(float));
    if (a->triangle_count > 0)
        assert_memory_equal(a->indices, b->indices, a->triangle_count * 3 * sizeof(uint32_t));
    assert_int_equal(a->normals != NULL, b->normals != NULL);
    if (a->normals && a->vertex_count > 0)
        assert_memory_equal(a->normals, b->normals, a->vertex_count * 3 * sizeof(float));
}

/* STL keeps corners only: the same positions in the same order, and each position once. */
static void assert_same_corners(const hewn_triangles *given, const hewn_triangles *read)
{
    assert_int_equal(given->triangle_count, read->triangle_count);
    uint32_t fresh = 0;
    for (uint64_t i = 0; i < 3 * given->triangle_count; i++) {
        for (int axis = 0; axis < 3; axis++) {
            float expected = given->positions[3 * (size_t)given->indices[i] + axis] + 0.0f;
            assert_memory_equal(&expected, &read->positions[3 * (size_t)read->indices[i] + axis], sizeof expected);
        }
        assert_true(read->indices[i] <= fresh); /* numbered as they come */
        fresh += read->indices[i] == fresh;
    }
    assert_int_equal(fresh, read->vertex_count);
    for (uint64_t a = 0; a < read->vertex_count && read->vertex_count < 1000; a++)
        for (uint64_t b = 0; b < a; b++)
            assert_memory_not_equal(read->positions + 3 * a, read->positions + 3 * b, 3 * sizeof(float));
}

/* Through all four formats and back. */
static void round_trip(const hewn_triangles *mesh)
{
    for (int i = 0; i < 4; i++) {
        write_mesh(mesh, files[i], NULL);
        hewn_triangles read = read_mesh(files[i]);
        if (i == 3)
            assert_same_corners(mesh, &read);
        else
            assert_same_mesh(mesh, &read);
        hewn_triangles_destroy(&read);
    }
}

/* Any floats at all as positions, any triangles, a few positions twice; normals of unit length or none. */
static hewn_triangles random_mesh(random_state *random, uint32_t vertices, uint32_t triangles)
{
    hewn_triangles mesh = make_mesh(vertices, triangles);
    for (uint32_t i = 0; i < 3 * vertices; i++)
        mesh.positions[i] = random_below(random, 8) ? random_float(random) : -0.0f;
    for (uint32_t v = 1; v < vertices; v += 1 + random_below(random, 9))
        memcpy(mesh.positions + 3 * (size_t)v, mesh.positions, 3 * sizeof(float));
    for (uint32_t t = 0; t < 3 * triangles; t++)
        mesh.indices[t] = random_below(random, vertices);
    if (random_below(random, 2)) {
        mesh.normals = hewn_alloc(vertices, 3 * sizeof(float));
        for (uint32_t v = 0; v < vertices; v++) {
            double z = 2 * random_unit(random) - 1, angle = 2 * M_PI * random_unit(random), r = sqrt(1 - z * z);
            mesh.normals[3 * v] = (float)(r * cos(angle));
            mesh.normals[3 * v + 1] = (float)(r * sin(angle));
            mesh.normals[3 * v + 2] = (float)z;
        }
    }
    return mesh;
}

static void test_random_meshes_keep_every_bit(void **state)
{
    (void)state;
    random_state random = {21};
    int rounds = getenv("HEWN_LONG") ? 3000 : 60;
    for (int round = 0; round < rounds; round++) {
        hewn_triangles mesh = random_mesh(&random, 1 + random_below(&random, 300), 1 + random_below(&random, 500));
        round_trip(&mesh);
        hewn_triangles_destroy(&mesh);
    }
}

static void test_torus_stays_a_torus(void **state)
{
    (void)state;
    hewn_triangles mesh = make_torus(40, 30);
    round_trip(&mesh);
    for (int i = 0; i < 4; i++) {
        write_mesh(&mesh, files[i], NULL);
        hewn_triangles read = read_mesh(files[i]);
        hewn_certificate c;
        assert_int_equal(hewn_certify(&read, NULL, &c, NULL), HEWN_OK);
        assert_true(c.closed && c.manifold && c.oriented);
        assert_int_equal(c.genus, 1);
        hewn_triangles_destroy(&read);
    }
    hewn_triangles_destroy(&mesh);
}

/* 65,535 vertices have indices of 16 bits, one more has 32. */
static void test_index_sizes(void **state)
{
    (void)state;
    for (uint32_t vertices = 65534; vertices <= 65537; vertices++) {
        hewn_triangles mesh = make_mesh(vertices, 2);
        for (uint32_t v = 0; v < vertices; v++)
            mesh.positions[3 * v] = (float)v;
        set_triangle(&mesh, 0, 0, 1, vertices - 1);
        set_triangle(&mesh, 1, 2, vertices - 2, vertices - 1);
        round_trip(&mesh);
        char *bytes;
        size_t length;
        assert_int_equal(hewn_file_read("mesh.glb", SIZE_MAX / 4, &bytes, &length, NULL), HEWN_OK);
        assert_true((strstr(bytes + 20, "\"componentType\":5123") != NULL) == (vertices <= 65535));
        assert_true((strstr(bytes + 20, "\"componentType\":5125") != NULL) == (vertices > 65535));
        hewn_free(bytes);
        hewn_triangles_destroy(&mesh);
    }
}

static void test_empty_meshes(void **state)
{
    (void)state;
    hewn_triangles mesh = {0};
    round_trip(&mesh);
    mesh = make_mesh(5, 0); /* GLB and STL have no place for vertices alone */
    for (int i = 0; i < 4; i++) {
        write_mesh(&mesh, files[i], NULL);
        hewn_triangles read = read_mesh(files[i]);
        assert_int_equal(read.vertex_count, i == 1 || i == 2 ? 5 : 0);
        assert_int_equal(read.triangle_count, 0);
        hewn_triangles_destroy(&read);
    }
    hewn_triangles_destroy(&mesh);
}

static void test_same_bytes_every_time(void **state)
{
    (void)state;
    hewn_triangles mesh = make_torus(20, 20);
    for (int i = 0; i < 4; i++) {
        char *first, *second;
        size_t first_length, second_length;
        write_mesh(&mesh, files[i], NULL);
        assert_int_equal(hewn_file_read(files[i], SIZE_MAX / 4, &first, &first_length, NULL), HEWN_OK);
        write_mesh(&mesh, files[i], NULL);
        assert_int_equal(hewn_file_read(files[i], SIZE_MAX / 4, &second, &second_length, NULL), HEWN_OK);
        assert_int_equal(first_length, second_length);
        assert_memory_equal(first, second, first_length);
        hewn_free(first);
        hewn_free(second);
    }
    hewn_triangles_destroy(&mesh);
}

typedef struct file_bytes {
    char *bytes;
    size_t length;
} file_bytes;

static file_bytes bytes_of(const char *path)
{
    file_bytes of;
    assert_int_equal(hewn_file_read(path, SIZE_MAX / 4, &of.bytes, &of.length, NULL), HEWN_OK);
    return of;
}

/* Large enough for many more blocks than may wait to be written. */
static void test_same_bytes_for_any_number_of_threads(void **state)
{
    (void)state;
    static const char *const all[] = {"mesh.glb", "mesh.obj", "mesh.ply", "mesh.stl", "mesh.off"};
    hewn_triangles mesh = make_torus(500, 300);
    const int usual = omp_get_max_threads();
    for (int i = 0; i < 5; i++) {
        omp_set_num_threads(1);
        write_mesh(&mesh, all[i], NULL);
        file_bytes one = bytes_of(all[i]);
        for (int threads = 2; threads <= 9; threads += threads < 3 ? 1 : 3) {
            omp_set_num_threads(threads);
            write_mesh(&mesh, all[i], NULL);
            file_bytes more = bytes_of(all[i]);
            assert_int_equal(one.length, more.length);
            assert_memory_equal(one.bytes, more.bytes, one.length);
            hewn_free(more.bytes);
        }
        hewn_free(one.bytes);
    }
    omp_set_num_threads(usual);
    hewn_triangles_destroy(&mesh);
}

/* One face that is larger than any block, between many small ones. */
static void test_a_huge_face(void **state)
{
    (void)state;
    enum { SMALL = 9000, CORNERS = 1100000, AT = 5000 };
    static const char *const polygons[] = {"huge.ply", "huge.obj", "huge.off"};
    uint64_t *first = hewn_alloc(SMALL + 2, sizeof *first), at = 0;
    uint32_t *corners = hewn_alloc(3 * SMALL + CORNERS, sizeof *corners);
    double *positions = hewn_alloc(CORNERS, 3 * sizeof *positions);
    for (uint32_t f = 0; f <= SMALL; f++) {
        first[f] = at;
        for (uint32_t k = 0, count = f == AT ? CORNERS : 3; k < count; k++)
            corners[at++] = f == AT ? k : f + 7 * k;
    }
    first[SMALL + 1] = at;
    for (uint32_t i = 0; i < 3 * CORNERS; i++)
        positions[i] = i % 1009;
    hewn_model model = {
        .vertex_count = CORNERS, .positions = positions, .face_count = SMALL + 1, .first = first, .corners = corners};
    for (int i = 0; i < 3; i++) {
        hewn_error error = {0};
        hewn_model read;
        if (hewn_model_write(&model, polygons[i], NULL, &error) != HEWN_OK)
            fail_msg("%s: %s", polygons[i], error.message);
        assert_int_equal(hewn_model_read(polygons[i], NULL, &read, &error), HEWN_OK);
        assert_int_equal(read.face_count, SMALL + 1);
        assert_memory_equal(read.first, first, (SMALL + 2) * sizeof *first);
        assert_memory_equal(read.corners, corners, at * sizeof *corners);
        hewn_model_destroy(&read);
    }
    hewn_free(first);
    hewn_free(corners);
    hewn_free(positions);
}

static uint32_t word_at(const char *bytes, size_t at)
{
    uint32_t word;
    memcpy(&word, bytes + at, 4);
    return word;
}

static void test_headers(void **state)
{
    (void)state;
    hewn_triangles mesh = make_cube();
    hewn_write_desc desc = {.name = "solid\nline", .unit = hewn_unit_find("mm"), .up = HEWN_AXIS_PLUS_Z};
    char *bytes;
    size_t length;
    write_mesh(&mesh, "mesh.stl", &desc);
    assert_int_equal(hewn_file_read("mesh.stl", SIZE_MAX / 4, &bytes, &length, NULL), HEWN_OK);
    assert_int_equal(length, 84 + 50 * 12);
    assert_memory_not_equal(bytes, "solid", 5);
    assert_int_equal(word_at(bytes, 80), 12);
    float normal[3];
    memcpy(normal, bytes + 84, sizeof normal);
    assert_true(normal[0] == 0 && normal[1] == 0 && normal[2] == -1);
    hewn_free(bytes);
    write_mesh(&mesh, "mesh.ply", &desc);
    assert_int_equal(hewn_file_read("mesh.ply", SIZE_MAX / 4, &bytes, &length, NULL), HEWN_OK);
    assert_non_null(strstr(bytes, "comment 1 unit = 0.001 m, +Z up\ncomment object solid line\nelement vertex 8\n"));
    hewn_free(bytes);
    write_mesh(&mesh, "mesh.obj", &desc);
    assert_int_equal(hewn_file_read("mesh.obj", SIZE_MAX / 4, &bytes, &length, NULL), HEWN_OK);
    assert_non_null(strstr(bytes, "# 1 unit = 0.001 m, +Z up\no solid line\nv 0 0 0\n"));
    hewn_free(bytes);
    hewn_triangles_destroy(&mesh);
}

static void test_format_of(void **state)
{
    (void)state;
    assert_int_equal(hewn_mesh_format_of("a/b.c/d.GLB"), HEWN_MESH_GLB);
    assert_int_equal(hewn_mesh_format_of("obj"), HEWN_MESH_OBJ);
    assert_int_equal(hewn_mesh_format_of(".Ply"), HEWN_MESH_PLY);
    assert_int_equal(hewn_mesh_format_of("x.obj.stl"), HEWN_MESH_STL);
    assert_int_equal(hewn_mesh_format_of("folder.stl/obj"), HEWN_MESH_UNKNOWN);
    assert_int_equal(hewn_mesh_format_of("x.gltf"), HEWN_MESH_GLTF);
    assert_int_equal(hewn_mesh_format_of("x.stlx"), HEWN_MESH_UNKNOWN);
    assert_int_equal(hewn_mesh_format_of("-"), HEWN_MESH_UNKNOWN);
    assert_int_equal(hewn_mesh_format_of(""), HEWN_MESH_UNKNOWN);
    assert_int_equal(hewn_mesh_format_of(NULL), HEWN_MESH_UNKNOWN);
}

static void assert_refused(const hewn_triangles *mesh, const char *path, const hewn_write_desc *desc,
                           hewn_result expected)
{
    hewn_error error = {0};
    assert_int_equal(hewn_triangles_write(mesh, path, desc, &error), expected);
    assert_int_equal(error.code, expected);
    assert_true(error.message[0] != '\0');
    assert_int_equal(count_entries(false), 0);
}

static void test_refused_before_anything_is_written(void **state)
{
    (void)state;
    hewn_triangles mesh = make_cube();
    assert_refused(&mesh, "mesh.xyz", NULL, HEWN_INVALID_ARGUMENT);
    assert_refused(&mesh, "-", NULL, HEWN_INVALID_ARGUMENT);
    assert_refused(&mesh, "-", &(hewn_write_desc){.format = HEWN_MESH_GLB}, HEWN_INVALID_ARGUMENT);
    assert_refused(&mesh, "missing/mesh.obj", NULL, HEWN_IO);
    mesh.positions[0] = 3e38f;
    assert_refused(&mesh, "mesh.glb", &(hewn_write_desc){.unit = hewn_unit_find("km")}, HEWN_LIMIT);
    mesh.indices[7] = 8;
    for (int i = 0; i < 4; i++)
        assert_refused(&mesh, files[i], NULL, HEWN_BAD_INPUT);
    mesh.indices[7] = 0;
    mesh.positions[4] = NAN;
    for (int i = 0; i < 4; i++)
        assert_refused(&mesh, files[i], NULL, HEWN_BAD_INPUT);
    hewn_triangles_destroy(&mesh);
}

/* Counts alone decide, so nothing needs to be that large. */
static void test_limits(void **state)
{
    (void)state;
    float position[3] = {0};
    uint32_t index[3] = {0};
    hewn_triangles huge = {.positions = position, .normals = position, .indices = index};
    huge.triangle_count = 0x100000000u;
    huge.vertex_count = 3;
    assert_refused(&huge, "mesh.stl", NULL, HEWN_LIMIT);
    assert_refused(&huge, "mesh.glb", NULL, HEWN_LIMIT);
    huge.triangle_count = 0x100000000u / 12; /* 4 GiB of indices and a vertex more */
    huge.vertex_count = 70000;
    assert_refused(&huge, "mesh.glb", NULL, HEWN_LIMIT);
    huge.triangle_count = 1;
    huge.vertex_count = 0x80000001u;
    assert_refused(&huge, "mesh.ply", NULL, HEWN_LIMIT);
    huge.vertex_count = 0x100000001u;
    assert_refused(&huge, "mesh.obj", NULL, HEWN_LIMIT);
}

static bool count_down(void *user, const char *stage, double fraction)
{
    assert_string_equal(stage, "write");
    assert_true(fraction >= 0 && fraction <= 1 + 1e-12);
    return (*(int *)user)-- > 0;
}

static void test_cancelling_leaves_nothing(void **state)
{
    (void)state;
    hewn_triangles mesh = make_torus(90, 90); /* several blocks of each kind */
    for (int i = 0; i < 4; i++)
        for (int allowed = 0;; allowed++) {
            int left = allowed;
            hewn_progress progress = {count_down, &left};
            hewn_error error;
            hewn_result result =
                hewn_triangles_write(&mesh, files[i], &(hewn_write_desc){.progress = &progress}, &error);
            if (result == HEWN_OK) {
                assert_true(allowed > 1); /* how often it is asked depends on what the other threads do */
                assert_int_equal(count_entries(true), 1);
                break;
            }
            assert_int_equal(result, HEWN_CANCELLED);
            assert_int_equal(count_entries(false), 0);
        }
    hewn_triangles_destroy(&mesh);
}

/* A limit on the size of files stands in for a full disk, which an ordinary user cannot make. */
static void test_no_room_leaves_nothing(void **state)
{
    (void)state;
    hewn_triangles mesh = make_torus(200, 200);
    struct rlimit usual, small;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &usual), 0);
    small = usual;
    small.rlim_cur = 100000;
    void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
    for (int i = 0; i < 4; i++) {
        hewn_error error = {0};
        assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
        hewn_result result = hewn_triangles_write(&mesh, files[i], NULL, &error);
        assert_int_equal(setrlimit(RLIMIT_FSIZE, &usual), 0);
        assert_int_equal(result, HEWN_IO);
        assert_string_equal(error.file, files[i]);
        assert_non_null(strstr(error.message, strerror(EFBIG)));
        assert_int_equal(count_entries(false), 0);
    }
    signal(SIGXFSZ, handler);
    hewn_triangles_destroy(&mesh);
}

static void test_full_device(void **state)
{
    (void)state;
    if (access("/dev/full", W_OK) != 0)
        skip();
    hewn_triangles mesh = make_torus(30, 30);
    hewn_error error = {0};
    assert_int_equal(hewn_triangles_write(&mesh, "/dev/full", &(hewn_write_desc){.format = HEWN_MESH_PLY}, &error),
                     HEWN_IO);
    assert_string_equal(error.file, "/dev/full");
    assert_non_null(strstr(error.message, strerror(ENOSPC)));
    hewn_triangles_destroy(&mesh);
}

static void test_standard_output(void **state)
{
    (void)state;
    static const hewn_mesh_format formats[] = {HEWN_MESH_OBJ, HEWN_MESH_PLY, HEWN_MESH_STL};
    hewn_triangles mesh = make_torus(20, 20);
    fflush(stdout);
    for (int i = 0; i < 3; i++) {
        pid_t child = fork();
        if (child == 0) {
            if (!freopen(files[i + 1], "wb", stdout))
                _exit(2);
            _exit(hewn_triangles_write(&mesh, "-", &(hewn_write_desc){.format = formats[i]}, NULL) != HEWN_OK);
        }
        int status;
        assert_int_equal(waitpid(child, &status, 0), child);
        assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
        hewn_triangles read = read_mesh(files[i + 1]);
        if (formats[i] == HEWN_MESH_STL)
            assert_same_corners(&mesh, &read);
        else
            assert_same_mesh(&mesh, &read);
        hewn_triangles_destroy(&read);
    }
    hewn_triangles_destroy(&mesh);
}

/* The number after "LABEL:" in what `assimp info` says of a file. */
static long assimp_says(const char *path, const char *label)
{
    char command[256], line[512];
    snprintf(command, sizeof command, "assimp info %s -r 2>&1", path); /* -r: as the file has it */
    FILE *pipe = popen(command, "r");
    assert_non_null(pipe);
    long number = -1;
    while (fgets(line, sizeof line, pipe))
        if (number < 0 && strncmp(line, label, strlen(label)) == 0)
            number = strtol(line + strlen(label), NULL, 10);
    pclose(pipe);
    return number;
}

static void test_assimp_reads_it(void **state)
{
    (void)state;
    if (system("command -v assimp >/dev/null 2>&1") != 0)
        skip(); /* Debian's assimp-utils is not installed */
    hewn_triangles mesh = make_torus(60, 50);
    for (int i = 0; i < 4; i++) {
        write_mesh(&mesh, files[i], NULL);
        assert_int_equal(assimp_says(files[i], "Faces:"), mesh.triangle_count);
        assert_int_equal(assimp_says(files[i], "Meshes:"), 1);
        if (i == 0 || i == 2)
            assert_int_equal(assimp_says(files[i], "Vertices:"), mesh.vertex_count);
    }
    hewn_triangles_destroy(&mesh);
}

#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, enter_folder, leave_folder)

int main(void)
{
    const struct CMUnitTest tests[] = {
        IN_FOLDER(test_random_meshes_keep_every_bit),
        IN_FOLDER(test_torus_stays_a_torus),
        IN_FOLDER(test_index_sizes),
        IN_FOLDER(test_empty_meshes),
        IN_FOLDER(test_same_bytes_every_time),
        IN_FOLDER(test_same_bytes_for_any_number_of_threads),
        IN_FOLDER(test_a_huge_face),
        IN_FOLDER(test_headers),
        cmocka_unit_test(test_format_of),
        IN_FOLDER(test_refused_before_anything_is_written),
        IN_FOLDER(test_limits),
        IN_FOLDER(test_cancelling_leaves_nothing),
        IN_FOLDER(test_no_room_leaves_nothing),
        IN_FOLDER(test_full_device),
        IN_FOLDER(test_standard_output),
        IN_FOLDER(test_assimp_reads_it),
    };
    return cmocka_run_group_tests_name("io_write", tests, NULL, NULL);
}
