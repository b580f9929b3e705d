/* Finding and opening devices: the list, the choice, and each way in which there is none. */
#include "gpu_test.h"

#include <pthread.h>
#include <unistd.h>

#include "gpu/device.h"

#define GLSL_HEAD                                                                                                      \
    "#version 460\n"                                                                                                   \
    "#extension GL_EXT_buffer_reference : require\n"                                                                   \
    "#extension GL_EXT_scalar_block_layout : require\n"

/* Values of environment variables for the length of a test. */
static const char *const variables[] = {"HEWN_DEVICE",   "HEWN_VULKAN_LOADER", "HEWN_TEST_FAKE",
                                        "VK_LAYER_PATH", "VK_DRIVER_FILES",    "VK_ICD_FILENAMES"};
enum { VARIABLES = sizeof variables / sizeof *variables };
static char *kept[VARIABLES];

static int keep_environment(void **state)
{
    (void)state;
    for (size_t i = 0; i < VARIABLES; i++) {
        const char *value = getenv(variables[i]);
        kept[i] = value ? strdup(value) : NULL;
    }
    unsetenv("HEWN_DEVICE");
    return 0;
}

static int restore_environment(void **state)
{
    (void)state;
    for (size_t i = 0; i < VARIABLES; i++) {
        if (kept[i])
            setenv(variables[i], kept[i], 1);
        else
            unsetenv(variables[i]);
        free(kept[i]);
        kept[i] = NULL;
    }
    return 0;
}

static void expect_failure(const hewn_device_desc *desc, hewn_result expected, const char *part)
{
    hewn_error error = {0};
    hewn_device *device = (hewn_device *)&error;
    hewn_result result = hewn_device_create(desc, &device, &error);
    if (result == HEWN_OK)
        hewn_device_destroy(&device);
    if (result != expected || !strstr(error.message, part))
        fail_msg("expected %s with '%s', got %s: %s", hewn_result_name(expected), part, hewn_result_name(result),
                 error.message);
    assert_int_equal(error.code, expected);
    assert_null(device);
    device = (hewn_device *)&error;
    assert_int_equal(hewn_device_create(desc, &device, NULL), expected);
    assert_null(device);
}

static void test_list(void **state)
{
    (void)state;
    hewn_device_info *infos;
    size_t count;
    GPU_TEST_TRY(hewn_device_list(&infos, &count, &error));
    assert_true(count >= 1);
    for (size_t i = 0; i < count; i++) {
        assert_int_equal(infos[i].index, i);
        assert_true(i == 0 || infos[i - 1].kind <= infos[i].kind);
        assert_true(infos[i].name[0] != '\0');
        assert_int_equal(infos[i].usable, infos[i].missing[0] == '\0');
        if (!infos[i].usable)
            continue;
        assert_true(infos[i].driver[0] != '\0');
        assert_true(infos[i].api_version[0] > 1 || infos[i].api_version[1] >= 2);
        assert_true(infos[i].subgroup_size >= 1 && infos[i].subgroup_size <= 128);
        assert_true(infos[i].max_workgroup_count >= 65535);
        assert_true(infos[i].max_workgroup_invocations >= 128);
        assert_true(infos[i].max_shared_memory >= 16384);
        assert_true(infos[i].max_allocation >= 1u << 30);
        assert_true(infos[i].max_storage_buffer_range >= 1u << 27);
        assert_true(infos[i].memory > 0);
    }
    hewn_device_list_free(&infos);
    assert_null(infos);
    hewn_device_list_free(&infos);
}

static void test_choice(void **state)
{
    (void)state;
    hewn_device_info *infos;
    size_t count;
    GPU_TEST_TRY(hewn_device_list(&infos, &count, &error));
    if (count == 0 || !infos[0].usable) {
        hewn_device_list_free(&infos);
        skip(); /* the choice below would be another */
    }
    hewn_device *device;
    char part[8] = {0};
    for (size_t i = 0; i < 5 && infos[0].name[i]; i++)
        part[i] =
            (char)(infos[0].name[i] ^ (((infos[0].name[i] | 32) >= 'a' && (infos[0].name[i] | 32) <= 'z') ? 32 : 0));
    const char *choices[] = {"0", part, infos[0].name, "", NULL};
    for (size_t i = 0; i < sizeof choices / sizeof *choices; i++) {
        const hewn_device_desc desc = {.choice = choices[i]};
        GPU_TEST_TRY(hewn_device_create(&desc, &device, &error));
        assert_string_equal(hewn_device_get_info(device)->name, infos[0].name);
        assert_int_equal(hewn_device_peak_bytes(device), 0);
        hewn_device_destroy(&device);
        hewn_device_destroy(&device);
    }
    setenv("HEWN_DEVICE", part, 1);
    GPU_TEST_TRY(hewn_device_create(NULL, &device, &error));
    hewn_device_destroy(&device);
    setenv("HEWN_DEVICE", "no such thing", 1);
    expect_failure(NULL, HEWN_NO_DEVICE, infos[0].name);
    expect_failure(NULL, HEWN_NO_DEVICE, "no such thing");
    const hewn_device_desc first = {.choice = "0"};
    GPU_TEST_TRY(hewn_device_create(&first, &device, &error));
    hewn_device_destroy(&device);
    const char *bad[] = {"99", "-1", "0x0", "00000000000000000000000000000000000000000000000000000000000000000001",
                         " 0"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        const hewn_device_desc desc = {.choice = bad[i]};
        expect_failure(&desc, HEWN_NO_DEVICE, "0 (");
    }
    hewn_device_list_free(&infos);
}

static void test_no_loader(void **state)
{
    (void)state;
    setenv("HEWN_VULKAN_LOADER", "/nonexistent/libvulkan.so.1", 1);
    expect_failure(NULL, HEWN_NO_LOADER, "apt-get install libvulkan1");
    hewn_error error = {0};
    hewn_device_info *infos = (hewn_device_info *)&error;
    size_t count = 7;
    assert_int_equal(hewn_device_list(&infos, &count, &error), HEWN_NO_LOADER);
    assert_null(infos);
    assert_int_equal(count, 0);
    setenv("HEWN_VULKAN_LOADER", "libm.so.6", 1);
    expect_failure(NULL, HEWN_NO_LOADER, "no Vulkan loader");
}

static void test_no_driver(void **state)
{
    (void)state;
    setenv("VK_DRIVER_FILES", "/nonexistent.json", 1);
    unsetenv("VK_ICD_FILENAMES");
    expect_failure(NULL, HEWN_NO_DEVICE, "no device");
    hewn_device_info *infos;
    size_t count;
    GPU_TEST_TRY(hewn_device_list(&infos, &count, &error));
    assert_int_equal(count, 0);
    hewn_device_list_free(&infos);
}

static void test_no_layer(void **state)
{
    (void)state;
    setenv("VK_LAYER_PATH", "/nonexistent", 1);
    const hewn_device_desc desc = {.validation = true};
    expect_failure(&desc, HEWN_NO_DEVICE, "vulkan-validationlayers");
}

static void fake(const char *lies)
{
    const char *loader = getenv("HEWN_FAKE_LOADER");
    if (!loader)
        skip();
    else
        setenv("HEWN_VULKAN_LOADER", loader, 1);
    setenv("HEWN_TEST_FAKE", lies, 1);
}

static void test_order(void **state)
{
    (void)state;
    fake("many");
    hewn_device_info *infos;
    size_t count;
    GPU_TEST_TRY(hewn_device_list(&infos, &count, &error));
    const char *names[] = {"Fake 2", "Fake 5", "Fake 4", "Fake 1", "Fake 0", "Fake 3"};
    const hewn_device_kind kinds[] = {HEWN_DEVICE_DISCRETE, HEWN_DEVICE_DISCRETE, HEWN_DEVICE_INTEGRATED,
                                      HEWN_DEVICE_VIRTUAL,  HEWN_DEVICE_CPU,      HEWN_DEVICE_OTHER};
    assert_int_equal(count, 6);
    for (size_t i = 0; i < count; i++) {
        assert_string_equal(infos[i].name, names[i]);
        assert_int_equal(infos[i].kind, kinds[i]);
        assert_int_equal(infos[i].index, i);
    }
    hewn_device_list_free(&infos);
    const struct {
        const char *choice, *name;
    } choices[] = {{NULL, "Fake 2"}, {"1", "Fake 5"}, {"5", "Fake 3"}, {"fAKE", "Fake 2"}, {"KE 1", "Fake 1"}};
    for (size_t i = 0; i < sizeof choices / sizeof *choices; i++) {
        const hewn_device_desc desc = {.choice = choices[i].choice};
        hewn_device *device;
        GPU_TEST_TRY(hewn_device_create(&desc, &device, &error));
        assert_string_equal(hewn_device_get_info(device)->name, choices[i].name);
        hewn_device_destroy(&device);
    }
}

static void test_missing(void **state)
{
    (void)state;
    fake("bare");
    expect_failure(NULL, HEWN_MISSING_FEATURE, "bufferDeviceAddress, scalarBlockLayout");
    fake("old");
    expect_failure(NULL, HEWN_MISSING_FEATURE, "Vulkan 1.2");
    const hewn_device_desc chosen = {.choice = "0"};
    expect_failure(&chosen, HEWN_MISSING_FEATURE, "Vulkan 1.2");
    fake("none");
    expect_failure(NULL, HEWN_NO_DEVICE, "no device");
    fake("aged");
    expect_failure(NULL, HEWN_NO_LOADER, "older than Vulkan 1.2");
}

/* That the layer is silent means something only if it would speak. */
static void test_validation_speaks(void **state)
{
    (void)state;
    unsigned messages = 0;
    const hewn_device_desc desc = {.validation = true, .message = gpu_test_message, .user = &messages};
    hewn_device *device;
    GPU_TEST_TRY(hewn_device_create(&desc, &device, &error));
    assert_int_equal(hewn_device_message_count(device), 0);
    print_message("# one message about a buffer of size 0 is expected:\n");
    const VkBufferCreateInfo info = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                     .usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT};
    VkBuffer buffer = VK_NULL_HANDLE;
    if (device->vk.CreateBuffer(device->handle, &info, NULL, &buffer) == VK_SUCCESS)
        device->vk.DestroyBuffer(device->handle, buffer, NULL);
    assert_true(hewn_device_message_count(device) >= 1);
    assert_int_equal(hewn_device_message_count(device), messages);
    hewn_device_destroy(&device);
}

/* Drivers of absent hardware grumble easily; a person should not see it. */
static void test_no_noise(void **state)
{
    (void)state;
    FILE *noise = tmpfile();
    assert_non_null(noise);
    fflush(stderr);
    int saved = dup(STDERR_FILENO);
    assert_true(saved >= 0 && dup2(fileno(noise), STDERR_FILENO) >= 0);
    hewn_device *device = NULL;
    hewn_result result = hewn_device_create(NULL, &device, NULL);
    hewn_device_destroy(&device);
    hewn_device_info *infos;
    size_t count;
    result = result == HEWN_OK ? hewn_device_list(&infos, &count, NULL) : result;
    hewn_device_list_free(&infos);
    fflush(stderr);
    dup2(saved, STDERR_FILENO);
    close(saved);
    assert_int_equal(result, HEWN_OK);
    assert_int_equal(lseek(fileno(noise), 0, SEEK_END), 0);
    fclose(noise);
}

typedef struct worker {
    pthread_t thread;
    uint32_t seed;
    hewn_result result;
    hewn_error error;
    uint32_t got;
} worker;

static hewn_result square(hewn_device *device, worker *w, hewn_error *error)
{
    char glsl[512];
    snprintf(glsl, sizeof glsl,
             GLSL_HEAD "layout(local_size_x = 1) in;\n"
                       "layout(buffer_reference, scalar) buffer B { uint at[]; };\n"
                       "layout(push_constant, scalar) uniform P { B b; } p;\n"
                       "void main() { p.b.at[0] = %uu * %uu; }\n",
             w->seed, w->seed);
    const hewn_program_desc desc = {.name = "square", .glsl = glsl, .push_bytes = 8};
    hewn_program *program = NULL;
    hewn_buffer buffer = {0};
    hewn_commands *commands = NULL;
    hewn_result result = hewn_program_create(device, &desc, &program, error);
    if (result == HEWN_OK)
        result = hewn_buffer_create(device, "a square", 4, HEWN_BUFFER_READBACK, &buffer, error);
    if (result == HEWN_OK)
        result = hewn_commands_begin(device, &commands, error);
    if (result == HEWN_OK) {
        hewn_commands_dispatch(commands, program, &buffer.address, NULL, (hewn_dispatch_size){1, 1, 1});
        result = hewn_commands_submit(&commands, NULL, error);
        w->got = *(uint32_t *)buffer.mapped;
    }
    hewn_buffer_destroy(device, &buffer);
    hewn_program_destroy(device, &program);
    return result;
}

static void *work(void *user)
{
    worker *w = user;
    hewn_device *device = NULL;
    const hewn_device_desc desc = {.validation = true};
    w->result = hewn_device_create(&desc, &device, &w->error);
    for (int i = 0; i < 3 && w->result == HEWN_OK; i++) {
        w->result = square(device, w, &w->error);
        if (w->result == HEWN_OK && (w->got != w->seed * w->seed || hewn_device_message_count(device) != 0))
            w->result = HEWN_INTERNAL;
        w->seed += 100;
    }
    hewn_device_destroy(&device);
    return NULL;
}

static void test_threads(void **state)
{
    (void)state;
    worker workers[4] = {0};
    for (size_t i = 0; i < 4; i++) {
        workers[i].seed = (uint32_t)(3 + i);
        assert_int_equal(pthread_create(&workers[i].thread, NULL, work, &workers[i]), 0);
    }
    for (size_t i = 0; i < 4; i++)
        pthread_join(workers[i].thread, NULL);
    for (size_t i = 0; i < 4; i++)
        if (workers[i].result != HEWN_OK)
            fail_msg("%s: %s", hewn_result_name(workers[i].result), workers[i].error.message);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, keep_environment, restore_environment)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(test_list),  TEST(test_choice),  TEST(test_no_loader),         TEST(test_no_driver), TEST(test_no_layer),
        TEST(test_order), TEST(test_missing), TEST(test_validation_speaks), TEST(test_no_noise),  TEST(test_threads),
    };
    return cmocka_run_group_tests_name("device", tests, NULL, NULL);
}
