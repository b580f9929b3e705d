/* Machine code that is written before it is needed: programs give what they should whether or not they had their turn,
 * what the driver has had is not done again, and the second device leaves nothing behind. */
#include "cache_folder.h"
#include "gpu_test.h"

#include <dirent.h>
#include <unistd.h>

#include "base/alloc.h"
#include "gpu/ahead.h"
#include "gpu/program.h"

enum { PROGRAMS = 12 };

/* Each has a text of its own, and some read uniforms and some do not. */
static const char glsl_format[] = "#version 460\n"
                                  "#extension GL_EXT_buffer_reference : require\n"
                                  "#extension GL_EXT_scalar_block_layout : require\n"
                                  "layout(local_size_x = 1) in;\n"
                                  "layout(buffer_reference, scalar) buffer Words { uint at[]; };\n"
                                  "layout(push_constant, scalar) uniform P { Words to; uint more; };\n"
                                  "%s"
                                  "void main() { to.at[%uu] = %uu + more%s; }\n";

typedef struct push {
    uint64_t to;
    uint32_t more, pad;
} push;

static hewn_program *make(hewn_device *device, uint32_t number, bool soon)
{
    char glsl[1024];
    bool uniforms = number % 2;
    snprintf(glsl, sizeof glsl, glsl_format,
             uniforms ? "layout(set = 0, binding = 0, scalar) uniform U { uint u; };\n" : "", number, number * number,
             uniforms ? " + u" : "");
    const hewn_program_desc desc = {
        .name = "test", .glsl = glsl, .push_bytes = sizeof(push), .uniforms = uniforms, .soon = soon};
    hewn_program *program;
    GPU_TEST_TRY(hewn_program_create(device, &desc, &program, &error));
    return program;
}

/* Makes programs, all but those of `dropped` numbers are run, and looks at what they wrote. */
static void make_and_run(hewn_device *device, uint32_t first, uint32_t dropped)
{
    hewn_program *programs[PROGRAMS];
    hewn_buffer out = {0}, uniforms = {0};
    GPU_TEST_TRY(hewn_buffer_create(device, "results", 4096, HEWN_BUFFER_READBACK, &out, &error));
    GPU_TEST_TRY(hewn_buffer_create(device, "uniforms", 256, HEWN_BUFFER_UPLOAD, &uniforms, &error));
    memcpy(uniforms.mapped, &(uint32_t){1000}, 4);
    for (uint32_t i = 0; i < PROGRAMS; i++)
        programs[i] = make(device, first + i, true);
    for (uint32_t i = 0; i < PROGRAMS; i++)
        if (dropped >> i & 1)
            hewn_program_destroy(device, &programs[i]);
    hewn_commands *commands;
    GPU_TEST_TRY(hewn_commands_begin(device, &commands, &error));
    hewn_commands_fill(commands, &out, 0, 4096, 0);
    for (uint32_t i = 0; i < PROGRAMS; i++)
        if (programs[i])
            hewn_commands_dispatch(commands, programs[i], &(push){.to = out.address, .more = i}, &uniforms,
                                   (hewn_dispatch_size){1, 1, 1});
    GPU_TEST_TRY(hewn_commands_submit(&commands, NULL, &error));
    for (uint32_t i = 0; i < PROGRAMS; i++) {
        uint32_t number = first + i, wanted = number * number + i + (number % 2 ? 1000 : 0);
        assert_int_equal(((const uint32_t *)out.mapped)[number], dropped >> i & 1 ? 0 : wanted);
        hewn_program_destroy(device, &programs[i]);
    }
    hewn_buffer_destroy(device, &out);
    hewn_buffer_destroy(device, &uniforms);
}

/* Files below the folder of that name in Hewn's own cache. */
static uint32_t count_files(const char *below)
{
    char path[128];
    snprintf(path, sizeof path, "%s/hewn/%s", folder, below);
    DIR *listing = opendir(path);
    uint32_t count = 0;
    for (struct dirent *entry; listing && (entry = readdir(listing));)
        count += entry->d_name[0] != '.';
    if (listing)
        closedir(listing);
    return count;
}

/* Programs that the device's driver is known to have had. */
static size_t count_known(const hewn_device *device)
{
    size_t bytes;
    void *known = hewn_cache_load(&device->cache, "known", device->pipeline_key, &bytes);
    hewn_free(known);
    assert_int_equal(bytes % sizeof(hewn_hash), 0);
    return bytes / sizeof(hewn_hash);
}

static void test_runs_right(void **state)
{
    (void)state;
    unsigned messages;
    hewn_device *device = gpu_test_open(&messages);
    make_and_run(device, 0, 0);
    if (hewn_ahead_pays(device))
        assert_int_equal(count_known(device), PROGRAMS);
    make_and_run(device, PROGRAMS / 2, 0); /* half of them again */
    if (hewn_ahead_pays(device))
        assert_int_equal(count_known(device), PROGRAMS + PROGRAMS / 2);
    gpu_test_close(&device, &messages);
}

/* Programs that go before their turn, or while the other thread is at them, are left alone. */
static void test_destroyed_before_their_turn(void **state)
{
    (void)state;
    unsigned messages;
    hewn_device *device = gpu_test_open(&messages);
    make_and_run(device, 100, 0x5A5);
    make_and_run(device, 120, 0xFFF);
    gpu_test_close(&device, &messages);
    /* The device goes with everything still to be done. */
    device = gpu_test_open(&messages);
    hewn_program *programs[PROGRAMS];
    for (uint32_t i = 0; i < PROGRAMS; i++)
        programs[i] = make(device, 140 + i, true);
    for (uint32_t i = 0; i < PROGRAMS; i++)
        hewn_program_destroy(device, &programs[i]);
    gpu_test_close(&device, &messages);
}

/* A second process, or a second device, has nothing left to do: no thread comes up. */
static void test_known_are_not_done_again(void **state)
{
    (void)state;
    unsigned messages;
    hewn_device *device = gpu_test_open(&messages);
    make_and_run(device, 160, 0);
    gpu_test_close(&device, &messages);
    device = gpu_test_open(&messages);
    if (!hewn_ahead_pays(device)) {
        gpu_test_close(&device, &messages);
        skip();
    }
    size_t before = count_known(device);
    make_and_run(device, 160, 0);
    assert_int_equal(hewn_ahead_taken(device), 0);
    assert_int_equal(count_known(device), before);
    make_and_run(device, 180, 0);
    assert_int_equal(hewn_ahead_taken(device), PROGRAMS);
    assert_int_equal(count_known(device), before + PROGRAMS);
    assert_int_equal(count_files("known"), 1);
    gpu_test_close(&device, &messages);
}

/* What is not sure to be used is never made ahead. */
static void test_only_what_is_near(void **state)
{
    (void)state;
    unsigned messages;
    hewn_device *device = gpu_test_open(&messages);
    hewn_program *program = make(device, 200, false);
    assert_int_equal(hewn_ahead_taken(device), 0);
    hewn_program_destroy(device, &program);
    gpu_test_close(&device, &messages);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_runs_right),
        cmocka_unit_test(test_destroyed_before_their_turn),
        cmocka_unit_test(test_known_are_not_done_again),
        cmocka_unit_test(test_only_what_is_near),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
