/* Buffers: where they lie, what the books say, and what becomes of them when memory runs out. */
#include "gpu_test.h"

#include "gpu/device.h"

typedef struct fixture {
    hewn_device *device;
    unsigned messages;
} fixture;

static int open_fixture(void **state)
{
    static fixture shared;
    shared.device = gpu_test_open(&shared.messages);
    *state = &shared;
    return 0;
}

static int close_fixture(void **state)
{
    fixture *f = *state;
    gpu_test_close(&f->device, &f->messages);
    return 0;
}

static void test_sizes(void **state)
{
    fixture *f = *state;
    const uint64_t sizes[] = {0, 1, 2, 3, 4, 5, 7, 64, 4095, 4096, 4097, 1000003, 64u << 20};
    const hewn_buffer_use uses[] = {HEWN_BUFFER_DEVICE, HEWN_BUFFER_UPLOAD, HEWN_BUFFER_READBACK};
    const hewn_device_kind kind = hewn_device_get_info(f->device)->kind;
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        for (size_t u = 0; u < 3; u++) {
            hewn_buffer buffer;
            GPU_TEST_TRY(hewn_buffer_create(f->device, "sizes", sizes[i], uses[u], &buffer, &error));
            assert_int_equal(buffer.size, sizes[i] ? sizes[i] : 4);
            assert_true(buffer.allocated >= buffer.size);
            assert_true(buffer.address != 0 && buffer.address % 16 == 0);
            if (uses[u] != HEWN_BUFFER_DEVICE || kind == HEWN_DEVICE_CPU)
                assert_non_null(buffer.mapped);
            if (kind == HEWN_DEVICE_DISCRETE && uses[u] == HEWN_BUFFER_DEVICE)
                assert_null(buffer.mapped);
            if (buffer.mapped)
                memset(buffer.mapped, 0xa5, buffer.size);
            hewn_buffer_destroy(f->device, &buffer);
            const hewn_buffer zero = {0};
            assert_memory_equal(&buffer, &zero, sizeof zero);
            hewn_buffer_destroy(f->device, &buffer);
        }
}

static void test_addresses_are_apart(void **state)
{
    fixture *f = *state;
    enum { COUNT = 64 };
    hewn_buffer buffers[COUNT];
    for (size_t i = 0; i < COUNT; i++)
        GPU_TEST_TRY(hewn_buffer_create(f->device, "many", 100 * i + 1, HEWN_BUFFER_DEVICE, &buffers[i], &error));
    for (size_t i = 0; i < COUNT; i++)
        for (size_t j = 0; j < i; j++)
            assert_true(buffers[i].address + buffers[i].size <= buffers[j].address ||
                        buffers[j].address + buffers[j].size <= buffers[i].address);
    for (size_t i = 0; i < COUNT; i++)
        hewn_buffer_destroy(f->device, &buffers[i]);
}

static void test_peak(void **state)
{
    (void)state;
    unsigned messages;
    hewn_device *device = gpu_test_open(&messages);
    hewn_buffer a, b;
    GPU_TEST_TRY(hewn_buffer_create(device, "a", 1u << 20, HEWN_BUFFER_DEVICE, &a, &error));
    GPU_TEST_TRY(hewn_buffer_create(device, "b", 2u << 20, HEWN_BUFFER_DEVICE, &b, &error));
    const uint64_t both = a.allocated + b.allocated;
    assert_int_equal(hewn_device_peak_bytes(device), both);
    hewn_buffer_destroy(device, &a);
    assert_int_equal(device->bytes, b.allocated);
    hewn_buffer_destroy(device, &b);
    assert_int_equal(device->bytes, 0);
    GPU_TEST_TRY(hewn_buffer_create(device, "a", 1u << 20, HEWN_BUFFER_DEVICE, &a, &error));
    hewn_buffer_destroy(device, &a);
    assert_int_equal(hewn_device_peak_bytes(device), both);
    gpu_test_close(&device, &messages);
}

static void expect_failure(fixture *f, uint64_t size, hewn_result expected, const char *first, const char *second)
{
    const uint64_t before = f->device->bytes;
    hewn_error error = {0};
    hewn_buffer buffer = {.address = 1, .size = 1};
    hewn_result result = hewn_buffer_create(f->device, "the grid of a test", size, HEWN_BUFFER_DEVICE, &buffer, &error);
    assert_int_equal(result, expected);
    assert_int_equal(error.code, expected);
    if (!strstr(error.message, first) || !strstr(error.message, second))
        fail_msg("'%s' lacks '%s' or '%s'", error.message, first, second);
    const hewn_buffer zero = {0};
    assert_memory_equal(&buffer, &zero, sizeof zero);
    assert_int_equal(f->device->bytes, before);
}

static void test_too_large(void **state)
{
    fixture *f = *state;
    const uint64_t most = hewn_device_get_info(f->device)->max_allocation;
    const uint64_t sizes[] = {most + 1, most * 2, UINT64_MAX - 3, UINT64_MAX};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        char number[32];
        snprintf(number, sizeof number, "%llu", (unsigned long long)sizes[i]);
        expect_failure(f, sizes[i], HEWN_LIMIT, number, "the grid of a test");
    }
}

static VkResult failure;

static VKAPI_ATTR VkResult VKAPI_CALL failing_allocate(VkDevice device, const VkMemoryAllocateInfo *info,
                                                       const VkAllocationCallbacks *allocator, VkDeviceMemory *out)
{
    (void)device, (void)info, (void)allocator, (void)out;
    return failure;
}

static VKAPI_ATTR VkResult VKAPI_CALL failing_bind(VkDevice device, VkBuffer buffer, VkDeviceMemory memory,
                                                   VkDeviceSize offset)
{
    (void)device, (void)buffer, (void)memory, (void)offset;
    return failure;
}

static VKAPI_ATTR VkResult VKAPI_CALL failing_map(VkDevice device, VkDeviceMemory memory, VkDeviceSize offset,
                                                  VkDeviceSize size, VkMemoryMapFlags flags, void **out)
{
    (void)device, (void)memory, (void)offset, (void)size, (void)flags, (void)out;
    return failure;
}

static VKAPI_ATTR VkResult VKAPI_CALL failing_create(VkDevice device, const VkBufferCreateInfo *info,
                                                     const VkAllocationCallbacks *allocator, VkBuffer *out)
{
    (void)device, (void)info, (void)allocator, (void)out;
    return failure;
}

/* A driver that refuses at each step; what was made until then is given back (or the layer would complain at the end).
 */
static void test_out_of_memory(void **state)
{
    fixture *f = *state;
    const hewn_vulkan_device_table real = f->device->vk;
    const struct {
        VkResult failure;
        hewn_result expected;
        const char *part;
    } cases[] = {{VK_ERROR_OUT_OF_DEVICE_MEMORY, HEWN_OUT_OF_DEVICE_MEMORY, "out of device memory"},
                 {VK_ERROR_OUT_OF_HOST_MEMORY, HEWN_OUT_OF_MEMORY, "out of host memory"},
                 {VK_ERROR_DEVICE_LOST, HEWN_DEVICE_LOST, "lost"},
                 {VK_ERROR_UNKNOWN, HEWN_INTERNAL, "-13"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        failure = cases[i].failure;
        f->device->vk.CreateBuffer = failing_create;
        expect_failure(f, 12345, cases[i].expected, cases[i].part, "");
        f->device->vk = real;
        f->device->vk.BindBufferMemory = failing_bind;
        expect_failure(f, 12345, cases[i].expected, cases[i].part, "");
        f->device->vk = real;
        f->device->vk.AllocateMemory = failing_allocate;
        expect_failure(f, 12345, cases[i].expected, cases[i].part, "");
        f->device->vk = real;
        if (hewn_device_get_info(f->device)->kind != HEWN_DEVICE_CPU)
            continue;
        f->device->vk.MapMemory = failing_map;
        expect_failure(f, 12345, cases[i].expected, cases[i].part, "");
        f->device->vk = real;
    }
    failure = VK_ERROR_OUT_OF_DEVICE_MEMORY;
    f->device->vk.AllocateMemory = failing_allocate;
    expect_failure(f, 40960, HEWN_OUT_OF_DEVICE_MEMORY, "40960 bytes", "the grid of a test");
    f->device->vk = real;
    failure = VK_ERROR_TOO_MANY_OBJECTS;
    f->device->vk.AllocateMemory = failing_allocate;
    expect_failure(f, 40960, HEWN_OUT_OF_DEVICE_MEMORY, "40960 bytes", "the grid of a test");
    f->device->vk = real;
}

/* A buffer of nearly the largest size that the device names is given, and its far end is reached. (Of exactly that size
 * a driver may refuse it.) */
static void test_largest(void **state)
{
    fixture *f = *state;
    if (!gpu_test_long())
        skip();
    uint64_t size = hewn_device_get_info(f->device)->max_allocation;
    size = (size > 2ull << 30 ? 2ull << 30 : size) / 16 * 15;
    hewn_buffer large, back;
    GPU_TEST_TRY(hewn_buffer_create(f->device, "the most", size, HEWN_BUFFER_DEVICE, &large, &error));
    GPU_TEST_TRY(hewn_buffer_create(f->device, "a word", 4, HEWN_BUFFER_READBACK, &back, &error));
    hewn_commands *commands;
    GPU_TEST_TRY(hewn_commands_begin(f->device, &commands, &error));
    hewn_commands_fill(commands, &large, size - 8, 8, 0x12345678);
    hewn_commands_copy(commands, &large, size - 4, &back, 0, 4);
    GPU_TEST_TRY(hewn_commands_submit(&commands, NULL, &error));
    assert_int_equal(*(uint32_t *)back.mapped, 0x12345678);
    hewn_buffer_destroy(f->device, &large);
    hewn_buffer_destroy(f->device, &back);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sizes),     cmocka_unit_test(test_addresses_are_apart), cmocka_unit_test(test_peak),
        cmocka_unit_test(test_too_large), cmocka_unit_test(test_out_of_memory),       cmocka_unit_test(test_largest),
    };
    return cmocka_run_group_tests_name("buffer", tests, open_fixture, close_fixture);
}
