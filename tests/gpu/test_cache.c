/* The caches on disk: they may be damaged, shared, unwritable or absent, and nothing but time is ever lost. */
#include "cache_folder.h"
#include "gpu_test.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/alloc.h"
#include "gpu/compiler.h"
#include "gpu/device.h"

static const char glsl_format[] = "#version 460\n"
                                  "#extension GL_EXT_buffer_reference : require\n"
                                  "#extension GL_EXT_scalar_block_layout : require\n"
                                  "layout(local_size_x = 1) in;\n"
                                  "layout(buffer_reference, scalar) buffer Words { uint at[]; };\n"
                                  "layout(push_constant, scalar) uniform P { Words to; };\n"
                                  "void main() { to.at[0] = %uu; }\n";

static hewn_cache open_cache(void)
{
    hewn_cache cache;
    GPU_TEST_TRY(hewn_cache_open(&cache, &error));
    return cache;
}

static hewn_hash key_of(uint32_t number)
{
    return hewn_hash_bytes(hewn_hash_begin(), &number, sizeof number);
}

static void path_of(const hewn_cache *cache, const char *below, hewn_hash key, char out[256])
{
    char name[33];
    hewn_hash_print(key, name);
    snprintf(out, 256, "%s/%s/%s", cache->root, below, name);
}

static void write_file(const char *path, const void *bytes, size_t length)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, length, file), length);
    assert_int_equal(fclose(file), 0);
}

static size_t read_file(const char *path, void *bytes, size_t room)
{
    FILE *file = fopen(path, "rb");
    if (!file)
        return 0;
    size_t length = fread(bytes, 1, room, file);
    fclose(file);
    return length;
}

static unsigned count_files(const char *below, uint64_t *bytes)
{
    char path[256];
    snprintf(path, sizeof path, "%s/hewn/%s", folder, below);
    DIR *listing = opendir(path);
    unsigned count = 0;
    *bytes = 0;
    for (struct dirent *entry; listing && (entry = readdir(listing));) {
        struct stat about;
        if (fstatat(dirfd(listing), entry->d_name, &about, 0) == 0 && S_ISREG(about.st_mode)) {
            count++;
            *bytes += (uint64_t)about.st_size;
        }
    }
    if (listing)
        closedir(listing);
    return count;
}

static void test_place(void **state)
{
    (void)state;
    char expected[128];
    hewn_cache cache = open_cache();
    snprintf(expected, sizeof expected, "%s/hewn", folder);
    assert_string_equal(cache.root, expected);
    hewn_cache_close(&cache);
    assert_null(cache.root);
    const char *present = getenv("HOME");
    char *home = present ? strdup(present) : NULL;
    setenv("XDG_CACHE_HOME", "not/absolute", 1);
    setenv("HOME", folder, 1);
    cache = open_cache();
    snprintf(expected, sizeof expected, "%s/.cache/hewn", folder);
    assert_string_equal(cache.root, expected);
    hewn_cache_store(&cache, "spirv", key_of(1), "abc", 3);
    size_t length;
    char *bytes = hewn_cache_load(&cache, "spirv", key_of(1), &length);
    assert_non_null(bytes);
    assert_memory_equal(bytes, "abc", 3);
    hewn_free(bytes);
    hewn_cache_close(&cache);
    unsetenv("HOME");
    unsetenv("XDG_CACHE_HOME");
    cache = open_cache();
    assert_null(cache.root);
    hewn_cache_store(&cache, "spirv", key_of(1), "abc", 3);
    assert_null(hewn_cache_load(&cache, "spirv", key_of(1), &length));
    hewn_cache_close(&cache);
    if (home)
        setenv("HOME", home, 1);
    free(home);
}

static void test_round_trip(void **state)
{
    (void)state;
    hewn_cache cache = open_cache();
    size_t length = 9;
    assert_null(hewn_cache_load(&cache, "spirv", key_of(1), &length));
    assert_int_equal(length, 0);
    const size_t sizes[] = {0, 1, 4, 1000, 1u << 20};
    char *bytes = calloc(1, 1u << 20);
    for (size_t i = 0; i < 5; i++) {
        memset(bytes, (int)i + 1, sizes[i]);
        hewn_cache_store(&cache, "spirv", key_of(3), bytes, sizes[i]);
        void *got = hewn_cache_load(&cache, "spirv", key_of(3), &length);
        assert_non_null(got);
        assert_int_equal(length, sizes[i]);
        assert_memory_equal(got, bytes, sizes[i]);
        hewn_free(got);
        assert_null(hewn_cache_load(&cache, "pipeline", key_of(3), &length));
        assert_null(hewn_cache_load(&cache, "spirv", key_of(4), &length));
    }
    uint64_t total;
    assert_int_equal(count_files("spirv", &total), 1);
    free(bytes);
    hewn_cache_close(&cache);
}

/* Every byte of a file changed in turn, every shorter length, a longer one, and another key's file. */
static void test_damage(void **state)
{
    (void)state;
    hewn_cache cache = open_cache();
    unsigned char payload[200], file[400];
    for (size_t i = 0; i < sizeof payload; i++)
        payload[i] = (unsigned char)(i * 31);
    char path[256], other[256];
    path_of(&cache, "spirv", key_of(5), path);
    path_of(&cache, "spirv", key_of(6), other);
    hewn_cache_store(&cache, "spirv", key_of(5), payload, sizeof payload);
    const size_t size = read_file(path, file, sizeof file);
    assert_true(size > sizeof payload && size < sizeof file);
    size_t length;
    for (size_t i = 0; i < size; i++)
        for (int bit = 0; bit < 8; bit += 3) {
            file[i] ^= (unsigned char)(1 << bit);
            write_file(path, file, size);
            assert_null(hewn_cache_load(&cache, "spirv", key_of(5), &length));
            file[i] ^= (unsigned char)(1 << bit);
        }
    for (size_t i = 0; i < size; i++) {
        write_file(path, file, i);
        assert_null(hewn_cache_load(&cache, "spirv", key_of(5), &length));
    }
    write_file(path, file, size + 1);
    assert_null(hewn_cache_load(&cache, "spirv", key_of(5), &length));
    write_file(other, file, size);
    assert_null(hewn_cache_load(&cache, "spirv", key_of(6), &length));
    write_file(path, file, size);
    void *got = hewn_cache_load(&cache, "spirv", key_of(5), &length);
    assert_non_null(got);
    hewn_free(got);
    hewn_cache_close(&cache);
}

/* Things that are no files where the files should be. */
static void test_odd_places(void **state)
{
    (void)state;
    hewn_cache cache = open_cache();
    char path[256];
    size_t length;
    hewn_cache_store(&cache, "spirv", key_of(1), "abc", 3);
    path_of(&cache, "spirv", key_of(1), path);
    unlink(path);
    assert_int_equal(mkfifo(path, 0600), 0);
    assert_null(hewn_cache_load(&cache, "spirv", key_of(1), &length));
    unlink(path);
    assert_int_equal(mkdir(path, 0700), 0);
    assert_null(hewn_cache_load(&cache, "spirv", key_of(1), &length));
    hewn_cache_store(&cache, "spirv", key_of(1), "abc", 3);
    uint64_t total;
    assert_int_equal(count_files("spirv", &total), 0);
    rmdir(path);
    snprintf(path, sizeof path, "%s/file", folder);
    write_file(path, "x", 1);
    hewn_cache_close(&cache);
    /* A file where the folder should be: neither to be made nor written, whoever one is. */
    setenv("XDG_CACHE_HOME", path, 1);
    cache = open_cache();
    hewn_cache_store(&cache, "spirv", key_of(1), "abc", 3);
    assert_null(hewn_cache_load(&cache, "spirv", key_of(1), &length));
    hewn_cache_close(&cache);
    setenv("XDG_CACHE_HOME", folder, 1);
}

/* The folder stays under its limit, and what was used last survives. */
static void test_limit(void **state)
{
    (void)state;
    hewn_cache cache = open_cache();
    cache.limit = 64 << 10;
    char bytes[4000] = {0};
    size_t length;
    uint64_t total;
    for (uint32_t i = 0; i < 60; i++) {
        char path[256];
        hewn_cache_store(&cache, "spirv", key_of(i), bytes, sizeof bytes);
        path_of(&cache, "spirv", key_of(i), path);
        const struct timespec times[2] = {{1000 + i, 0}, {1000 + i, 0}};
        utimensat(AT_FDCWD, path, times, 0);
        void *first = hewn_cache_load(&cache, "spirv", key_of(0), &length);
        assert_non_null(first);
        hewn_free(first);
        assert_true(count_files("spirv", &total) <= 16);
        assert_true(total <= cache.limit);
    }
    assert_int_equal(count_files("spirv", &total), 16);
    assert_null(hewn_cache_load(&cache, "spirv", key_of(1), &length));
    void *last = hewn_cache_load(&cache, "spirv", key_of(59), &length);
    assert_non_null(last);
    hewn_free(last);
    hewn_cache_close(&cache);
}

/* A payload that tells its own key, so that a mix-up shows. */
static size_t fill_payload(uint32_t number, uint32_t *out)
{
    size_t count = 100 + number * 531 % 3000;
    for (size_t i = 0; i < count; i++)
        out[i] = number * 2654435761u + (uint32_t)i;
    return count * 4;
}

static int race(uint32_t seed, int rounds)
{
    hewn_cache cache;
    if (hewn_cache_open(&cache, NULL) != HEWN_OK)
        return 1;
    cache.limit = 100 << 10; /* small enough that trimming joins the race */
    static uint32_t right[4096];
    uint64_t random = 12345 + seed;
    int hits = 0;
    for (int i = 0; i < rounds; i++) {
        uint32_t number = gpu_test_random(&random) % 24;
        size_t size = fill_payload(number, right), length;
        if (gpu_test_random(&random) % 2) {
            hewn_cache_store(&cache, "spirv", key_of(number), right, size);
            continue;
        }
        void *got = hewn_cache_load(&cache, "spirv", key_of(number), &length);
        if (got && (length != size || memcmp(got, right, size) != 0))
            return 2;
        hits += got != NULL;
        hewn_free(got);
    }
    hewn_cache_close(&cache);
    return hits > 0 ? 0 : 3;
}

static void wait_for(pid_t *children, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        int status = 0;
        assert_int_equal(waitpid(children[i], &status, 0), children[i]);
        assert_true(WIFEXITED(status));
        assert_int_equal(WEXITSTATUS(status), 0);
    }
}

static void test_processes_race(void **state)
{
    (void)state;
    pid_t children[6];
    const int rounds = gpu_test_long() ? 20000 : 1000;
    for (uint32_t i = 0; i < 6; i++) {
        children[i] = fork();
        if (children[i] == 0)
            _exit(race(i, rounds));
        assert_true(children[i] > 0);
    }
    wait_for(children, 6);
    uint64_t total;
    char path[128];
    snprintf(path, sizeof path, "%s/hewn/spirv", folder);
    count_files("spirv", &total);
    assert_true(total <= 200 << 10);
    /* No half-written file is left behind. */
    DIR *listing = opendir(path);
    assert_non_null(listing);
    for (struct dirent *entry; (entry = readdir(listing));)
        assert_null(strstr(entry->d_name, "tmp"));
    closedir(listing);
}

/* Runs the shader that writes `number` and returns what came, or 0 and a failed test. */
static uint32_t run_shader(hewn_device *device, uint32_t number)
{
    char glsl[1024];
    snprintf(glsl, sizeof glsl, glsl_format, number);
    const hewn_program_desc desc = {.name = "number", .glsl = glsl, .push_bytes = 8};
    hewn_program *program = NULL;
    hewn_buffer buffer = {0};
    hewn_commands *commands = NULL;
    uint32_t got = 0;
    if (hewn_program_create(device, &desc, &program, NULL) == HEWN_OK &&
        hewn_buffer_create(device, "a number", 4, HEWN_BUFFER_READBACK, &buffer, NULL) == HEWN_OK &&
        hewn_commands_begin(device, &commands, NULL) == HEWN_OK) {
        hewn_commands_dispatch(commands, program, &buffer.address, NULL, (hewn_dispatch_size){1, 1, 1});
        if (hewn_commands_submit(&commands, NULL, NULL) == HEWN_OK)
            got = *(uint32_t *)buffer.mapped;
    }
    hewn_buffer_destroy(device, &buffer);
    hewn_program_destroy(device, &program);
    return got;
}

static int whole_process(uint32_t seed)
{
    for (int again = 0; again < 2; again++) {
        hewn_device *device;
        if (hewn_device_create(NULL, &device, NULL) != HEWN_OK)
            return 1;
        for (uint32_t i = 0; i < 6; i++)
            if (run_shader(device, 100 + (seed + i) % 6) != 100 + (seed + i) % 6)
                return 2;
        hewn_device_destroy(&device);
    }
    return 0;
}

/* Whole processes that all start on an empty cache and want the same shaders. */
static void test_processes_compile(void **state)
{
    (void)state;
    pid_t children[4];
    for (uint32_t i = 0; i < 4; i++) {
        children[i] = fork();
        if (children[i] == 0)
            _exit(whole_process(i));
        assert_true(children[i] > 0);
    }
    wait_for(children, 4);
    uint64_t total;
    assert_int_equal(count_files("spirv", &total), 6);
}

/* The cache is really read: what it holds under a shader's key is what runs. And a damaged entry is compiled anew. */
static void test_spirv_is_kept(void **state)
{
    (void)state;
    unsigned messages;
    hewn_device *device = gpu_test_open(&messages);
    uint64_t total;
    assert_int_equal(count_files("spirv", &total), 0);
    assert_int_equal(run_shader(device, 41), 41);
    assert_int_equal(run_shader(device, 42), 42);
    assert_int_equal(count_files("spirv", &total), 2);
    char glsl[1024], path[256];
    snprintf(glsl, sizeof glsl, glsl_format, 41);
    const hewn_hash key = hewn_compiler_key(glsl);
    snprintf(glsl, sizeof glsl, glsl_format, 42);
    uint32_t *words;
    size_t bytes;
    GPU_TEST_TRY(hewn_compiler_run("42", glsl, &words, &bytes, &error));
    hewn_cache_store(&device->cache, "spirv", key, words, bytes);
    assert_int_equal(run_shader(device, 41), 42);
    path_of(&device->cache, "spirv", key, path);
    write_file(path, "rubbish", 7);
    assert_int_equal(run_shader(device, 41), 41);
    assert_int_equal(truncate(path, 40), 0);
    assert_int_equal(run_shader(device, 41), 41);
    assert_int_equal(run_shader(device, 41), 41);
    /* Whole, but no SPIR-V. */
    hewn_cache_store(&device->cache, "spirv", key, "abcdabcdabcdabcdabcdabcd", 24);
    assert_int_equal(run_shader(device, 41), 41);
    hewn_cache_store(&device->cache, "spirv", key, words, bytes - 1);
    assert_int_equal(run_shader(device, 41), 41);
    hewn_free(words);
    gpu_test_close(&device, &messages);
}

static PFN_vkGetPipelineCacheData real_data;
static size_t growth;

/* Drivers differ in what they keep (software ones nothing), so a test makes the data grow itself. */
static VKAPI_ATTR VkResult VKAPI_CALL growing_data(VkDevice device, VkPipelineCache cache, size_t *length, void *bytes)
{
    size_t room = *length, own = room;
    VkResult result = real_data(device, cache, &own, NULL);
    *length = own + growth;
    if (result != VK_SUCCESS || !bytes)
        return result;
    if (room < own + growth)
        return VK_INCOMPLETE;
    memset((char *)bytes + own, 0, growth);
    return real_data(device, cache, &own, bytes);
}

static hewn_device *open_growing(unsigned *messages)
{
    hewn_device *device = gpu_test_open(messages);
    real_data = device->vk.GetPipelineCacheData;
    device->vk.GetPipelineCacheData = growing_data;
    return device;
}

/* The driver's cache: written when it grew, left alone if not, damaged or foreign without harm. */
static void test_pipelines_are_kept(void **state)
{
    (void)state;
    unsigned messages;
    char path[256];
    struct stat first, second;
    hewn_device *device = open_growing(&messages);
    path_of(&device->cache, "pipeline", device->pipeline_key, path);
    growth = 0;
    gpu_test_close(&device, &messages);
    assert_int_not_equal(stat(path, &first), 0);
    device = open_growing(&messages);
    growth = 20;
    assert_int_equal(run_shader(device, 7), 7);
    gpu_test_close(&device, &messages);
    assert_int_equal(stat(path, &first), 0);
    device = open_growing(&messages);
    growth = 0;
    assert_int_equal(run_shader(device, 7), 7);
    gpu_test_close(&device, &messages);
    assert_int_equal(stat(path, &second), 0);
    assert_int_equal(first.st_ino, second.st_ino);
    /* Cut off, damaged, and whole but of another driver: each opens and is replaced. */
    for (int i = 0; i < 3; i++) {
        hewn_cache cache = open_cache();
        device = open_growing(&messages);
        const hewn_hash key = device->pipeline_key;
        growth = 0;
        gpu_test_close(&device, &messages);
        if (i == 0)
            assert_int_equal(truncate(path, 50), 0);
        else if (i == 1)
            write_file(path, "something else", 14);
        else
            hewn_cache_store(&cache, "pipeline", key, "another driver's cache, of some length at least", 47);
        device = open_growing(&messages);
        growth = 20;
        assert_int_equal(run_shader(device, 7), 7);
        gpu_test_close(&device, &messages);
        size_t length;
        char *bytes = hewn_cache_load(&cache, "pipeline", key, &length);
        assert_non_null(bytes);
        assert_true(length >= 52 && memcmp(bytes, "another", 7) != 0);
        hewn_free(bytes);
        hewn_cache_close(&cache);
    }
}

static void test_unwritable(void **state)
{
    (void)state;
    const char *places[] = {"/proc/nowhere", "/dev/null", "/sys"};
    for (size_t i = 0; i < 3; i++) {
        setenv("XDG_CACHE_HOME", places[i], 1);
        unsigned messages;
        hewn_device *device = gpu_test_open(&messages);
        assert_int_equal(run_shader(device, 17), 17);
        assert_int_equal(run_shader(device, 17), 17);
        gpu_test_close(&device, &messages);
    }
}

static void test_keys_differ(void **state)
{
    (void)state;
    hewn_hash a = hewn_compiler_key("void main() {}"), b = hewn_compiler_key("void main() { }");
    hewn_hash again = hewn_compiler_key("void main() {}");
    assert_memory_equal(&a, &again, sizeof a);
    assert_memory_not_equal(&a, &b, sizeof a);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, make_folder, remove_folder)

int main(void)
{
    /* Those that fork come first: a driver's threads do not follow into a child. */
    const struct CMUnitTest tests[] = {
        TEST(test_processes_race), TEST(test_processes_compile),  TEST(test_place),      TEST(test_round_trip),
        TEST(test_damage),         TEST(test_odd_places),         TEST(test_limit),      TEST(test_keys_differ),
        TEST(test_spirv_is_kept),  TEST(test_pipelines_are_kept), TEST(test_unwritable),
    };
    return cmocka_run_group_tests_name("cache", tests, NULL, NULL);
}
