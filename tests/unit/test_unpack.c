/* Input that gzip compressed: what comes out, damage of every kind, limits, and the files of the test data. */
#include <sys/resource.h>
#include <zlib.h>

#include "io/unpack.h"
#include "io_support.h"

static const uint64_t NO_LIMIT = (uint64_t)1 << 40;

/* Appends a member; returns the new length. */
static size_t pack(char *to, size_t at, size_t room, const char *bytes, size_t length, int level)
{
    z_stream stream = {0};
    assert_int_equal(deflateInit2(&stream, level, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY), Z_OK);
    stream.next_in = (Bytef *)(uintptr_t)bytes;
    stream.avail_in = (unsigned)length;
    stream.next_out = (Bytef *)to + at;
    stream.avail_out = (unsigned)(room - at);
    assert_int_equal(deflate(&stream, Z_FINISH), Z_STREAM_END);
    at = room - stream.avail_out;
    deflateEnd(&stream);
    return at;
}

static hewn_result unpack(const char *bytes, size_t length, uint64_t limit, char **out, size_t *out_length,
                          hewn_error *error)
{
    char *exact = hewn_alloc(length, 1);
    assert_non_null(exact);
    memcpy(exact, bytes, length);
    hewn_result result = hewn_unpack(exact, length, limit, "given", NULL, out, out_length, error);
    hewn_free(exact);
    assert_true((*out == NULL) == (result != HEWN_OK));
    if (result == HEWN_OK)
        assert_int_equal((*out)[*out_length], 0);
    else
        assert_int_equal(*out_length, 0);
    return result;
}

static void assert_unpacks(const char *packed, size_t packed_length, const char *bytes, size_t length)
{
    char *out;
    size_t out_length;
    assert_int_equal(unpack(packed, packed_length, length, &out, &out_length, NULL), HEWN_OK);
    assert_int_equal(out_length, length);
    if (length > 0)
        assert_memory_equal(out, bytes, length);
    hewn_free(out);
    hewn_error error = {0};
    if (length == 0)
        return;
    assert_int_equal(unpack(packed, packed_length, length - 1, &out, &out_length, &error), HEWN_LIMIT);
    assert_string_equal(error.file, "given");
}

static void assert_refused(const char *packed, size_t length, const char *part)
{
    char *out;
    size_t out_length;
    hewn_error error = {0};
    assert_int_equal(unpack(packed, length, NO_LIMIT, &out, &out_length, &error), HEWN_BAD_INPUT);
    if (!strstr(error.message, part))
        fail_msg("\"%s\" (not \"%s\")", error.message, part);
    assert_string_equal(error.file, "given");
}

static void test_members(void **state)
{
    (void)state;
    random_state random = {5};
    enum { LENGTH = 300000, ROOM = 1 << 20 };
    char *bytes = hewn_alloc(LENGTH, 1), *packed = hewn_alloc(ROOM, 1);
    for (int round = 0; round < 60; round++) {
        size_t length = random_below(&random, random_below(&random, 3) ? 2000 : LENGTH), end = 0, at = 0;
        uint32_t kinds = 1 + random_below(&random, 255), members = random_below(&random, 4) ? 1 : 4;
        for (size_t i = 0; i < length; i++)
            bytes[i] = (char)random_below(&random, kinds);
        for (uint32_t member = 0; member < members; member++) {
            size_t part = member + 1 < members ? random_below(&random, (uint32_t)(length - at) + 1) : length - at;
            end = pack(packed, end, ROOM, bytes + at, part, (int)random_below(&random, 10));
            at += part;
        }
        assert_true(hewn_is_packed(packed, end));
        assert_unpacks(packed, end, bytes, length);
        memset(packed + end, 0, 700);
        assert_unpacks(packed, end + 1, bytes, length); /* zeros may trail */
        assert_unpacks(packed, end + 700, bytes, length);
    }
    hewn_free(packed);
    hewn_free(bytes);
}

static void test_damage(void **state)
{
    (void)state;
    static const char text[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    char packed[512], *out;
    size_t out_length, refused = 0, end = pack(packed, 0, sizeof packed, text, sizeof text, 9);
    for (size_t cut = 2; cut < end; cut++)
        assert_refused(packed, cut, "end early");
    for (size_t i = 2; i < end; i++)
        for (int bit = 0; bit < 8; bit++) {
            if (i >= 4 && i < 10)
                continue; /* time, level and system say nothing about the data */
            packed[i] = (char)(packed[i] ^ 1 << bit);
            /* a flag of the header and the last bits after the data mean nothing: then all comes out as it was */
            if (unpack(packed, end, NO_LIMIT, &out, &out_length, NULL) == HEWN_OK) {
                assert_int_equal(out_length, sizeof text);
                assert_memory_equal(out, text, sizeof text);
            } else {
                refused++;
            }
            hewn_free(out);
            packed[i] = (char)(packed[i] ^ 1 << bit);
        }
    assert_true(refused >= 8 * (end - 8) - 8);
    packed[end] = 'x';
    assert_refused(packed, end + 1, "something else follows");
    memcpy(packed + end, "\0\0\x1f", 3);
    assert_refused(packed, end + 3, "something else follows");
    memcpy(packed + end, "\x1f\x8b", 2); /* a second member that is none */
    assert_refused(packed, end + 2, "end early");
    assert_refused("\x1f\x8b\x07\0\0\0\0\0\0\0\0\0", 12, "damaged");
    assert_false(hewn_is_packed("\x1f", 1));
    assert_false(hewn_is_packed("\x1f\x8c", 2));
    assert_false(hewn_is_packed("", 0));
}

/* 200 MB of zeros in a fifth of a MB cost what the limit allows and no more. */
static void test_bombs(void **state)
{
    (void)state;
    enum { PART = 10000000, ROOM = 1 << 20 };
    char *zeros = hewn_alloc_zero(PART, 1), *packed = hewn_alloc(ROOM, 1), *out;
    size_t end = 0, out_length;
    for (int i = 0; i < 20; i++)
        end = pack(packed, end, ROOM, zeros, PART, 9);
    struct rusage before, after;
    getrusage(RUSAGE_SELF, &before);
    hewn_error error = {0};
    assert_int_equal(unpack(packed, end, 20000000, &out, &out_length, &error), HEWN_LIMIT);
    assert_non_null(strstr(error.message, "20000000"));
    getrusage(RUSAGE_SELF, &after);
    assert_true(after.ru_maxrss - before.ru_maxrss < 64 * 1024);
    assert_int_equal(unpack(packed, end, 0, &out, &out_length, NULL), HEWN_LIMIT);
    hewn_free(packed);
    hewn_free(zeros);
}

static bool stop(void *user, const char *stage, double fraction)
{
    (void)user;
    assert_string_equal(stage, "load");
    assert_true(fraction >= 0 && fraction <= 1);
    return false;
}

static void test_cancelling(void **state)
{
    (void)state;
    char packed[64], *out;
    size_t out_length, end = pack(packed, 0, sizeof packed, "text", 4, 9);
    hewn_progress progress = {stop, NULL};
    assert_int_equal(hewn_unpack(packed, end, NO_LIMIT, "given", &progress, &out, &out_length, NULL), HEWN_CANCELLED);
    assert_null(out);
}

/* Compressed files read as the file inside would. */
static void test_files(void **state)
{
    (void)state;
    static const char *const extensions[] = {"ply", "stl", "obj", "off", "glb"};
    hewn_model model = make_ring_model(20, 10, 3);
    char folder[64], plain[128], path[160];
    make_folder(folder);
    for (size_t i = 0; i < sizeof extensions / sizeof *extensions; i++) {
        char *bytes;
        size_t length;
        snprintf(plain, sizeof plain, "%s/mesh.%s", folder, extensions[i]);
        snprintf(path, sizeof path, "%s.GZ", plain);
        write_model(&model, plain, NULL);
        assert_int_equal(hewn_file_read(plain, SIZE_MAX / 4, &bytes, &length, NULL), HEWN_OK);
        char *packed = hewn_alloc(length + 100, 1);
        size_t end = pack(packed, 0, length + 100, bytes, length, 6);
        FILE *file = fopen(path, "wb");
        assert_non_null(file);
        assert_int_equal(fwrite(packed, 1, end, file), end);
        assert_int_equal(fclose(file), 0);
        hewn_model expected = read_model(plain), read = read_model(path), none;
        assert_same_model(&expected, &read);
        assert_int_equal(hewn_model_read(path, &(hewn_read_desc){.memory_limit = length - 1}, &none, NULL), HEWN_LIMIT);
        hewn_model_destroy(&expected);
        hewn_model_destroy(&read);
        hewn_free(packed);
        hewn_free(bytes);
        assert_int_equal(unlink(plain), 0);
        assert_int_equal(unlink(path), 0);
    }
    assert_int_equal(rmdir(folder), 0);
    hewn_model_destroy(&model);
}

static void check_data_file(const char *path, const char *statistics)
{
    hewn_model model = read_model(path);
    assert_int_equal(model.vertex_count, statistic(statistics, "V="));
    assert_int_equal(model.face_count, statistic(statistics, "F="));
    hewn_model again = through_file(&model, strstr(path, ".stl") ? "stl" : "ply");
    assert_same_model(&model, &again);
    hewn_model_destroy(&again);
    hewn_model_destroy(&model);
}

static void test_data(void **state)
{
    (void)state;
    static const char *const folders[] = {"dem", "mesh-scan"};
    int checked = for_each_statistic(folders, 2, "gz", check_data_file);
    if (checked < 0)
        skip();
    assert_int_equal(checked, 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_members),    cmocka_unit_test(test_damage), cmocka_unit_test(test_bombs),
        cmocka_unit_test(test_cancelling), cmocka_unit_test(test_files),  cmocka_unit_test(test_data),
    };
    return cmocka_run_group_tests_name("unpack", tests, NULL, NULL);
}
