/* Recordings: order, copies, fills, indirect dispatch, marks, and what is told when the device is gone. */
#include "gpu_test.h"

#include "base/clock.h"
#include "gpu/device.h"

#define HEAD                                                                                                           \
    "#version 460\n"                                                                                                   \
    "#extension GL_EXT_buffer_reference : require\n"                                                                   \
    "#extension GL_EXT_scalar_block_layout : require\n"                                                                \
    "layout(local_size_x = 64) in;\n"                                                                                  \
    "layout(buffer_reference, scalar) buffer Words { uint at[]; };\n"

enum { WORDS = 10000 };

typedef struct fixture {
    hewn_device *device;
    unsigned messages;
    hewn_program *step, *count, *sizes;
    hewn_buffer data, other, back;
} fixture;

/* x becomes 3 x + add; reads one array and writes another, shifted, so that order shows. */
static const char step_glsl[] =
    HEAD "layout(push_constant, scalar) uniform P { Words from; Words to; uint count; uint add; uint shift; };\n"
         "void main() {\n"
         "    uint i = gl_GlobalInvocationID.x;\n"
         "    if (i < count) to.at[(i + shift) % count] = from.at[i] * 3u + add;\n"
         "}\n";

/* Each workgroup marks itself. */
static const char count_glsl[] = HEAD
    "layout(push_constant, scalar) uniform P { Words to; uint limit; };\n"
    "void main() {\n"
    "    uvec3 n = gl_NumWorkGroups, g = gl_WorkGroupID;\n"
    "    uint i = (g.z * n.y + g.y) * n.x + g.x;\n"
    "    if (gl_LocalInvocationID.x == 0u && i < limit) to.at[i] += 1u + n.x * 256u + n.y * 65536u + n.z * 16777216u;\n"
    "}\n";

/* Writes the size of a dispatch. */
static const char sizes_glsl[] =
    HEAD "layout(push_constant, scalar) uniform P { Words to; uint size[3]; };\n"
         "void main() { uint i = gl_GlobalInvocationID.x; if (i < 3u) to.at[i] = size[i]; }\n";

typedef struct step_push {
    uint64_t from, to;
    uint32_t count, add, shift, pad;
} step_push;

static hewn_program *make(hewn_device *device, const char *glsl, uint32_t push_bytes)
{
    const hewn_program_desc desc = {.name = "test", .glsl = glsl, .push_bytes = push_bytes};
    hewn_program *program;
    GPU_TEST_TRY(hewn_program_create(device, &desc, &program, &error));
    return program;
}

static int open_fixture(void **state)
{
    static fixture f;
    f.device = gpu_test_open(&f.messages);
    f.step = make(f.device, step_glsl, 28);
    f.count = make(f.device, count_glsl, 12);
    f.sizes = make(f.device, sizes_glsl, 20);
    GPU_TEST_TRY(hewn_buffer_create(f.device, "data", WORDS * 4, HEWN_BUFFER_DEVICE, &f.data, &error));
    GPU_TEST_TRY(hewn_buffer_create(f.device, "other", WORDS * 4, HEWN_BUFFER_DEVICE, &f.other, &error));
    GPU_TEST_TRY(hewn_buffer_create(f.device, "back", WORDS * 4, HEWN_BUFFER_READBACK, &f.back, &error));
    *state = &f;
    return 0;
}

static int close_fixture(void **state)
{
    fixture *f = *state;
    hewn_program_destroy(f->device, &f->step);
    hewn_program_destroy(f->device, &f->count);
    hewn_program_destroy(f->device, &f->sizes);
    hewn_buffer_destroy(f->device, &f->data);
    hewn_buffer_destroy(f->device, &f->other);
    hewn_buffer_destroy(f->device, &f->back);
    gpu_test_close(&f->device, &f->messages);
    return 0;
}

static hewn_commands *begin(fixture *f)
{
    hewn_commands *commands;
    GPU_TEST_TRY(hewn_commands_begin(f->device, &commands, &error));
    return commands;
}

static void submit(hewn_commands *commands)
{
    GPU_TEST_TRY(hewn_commands_submit(&commands, NULL, &error));
    assert_null(commands);
}

/* What is empty is recorded without a complaint and writes nothing, here or beside it. */
static void test_empty(void **state)
{
    fixture *f = *state;
    submit(begin(f));
    hewn_commands *commands = begin(f);
    hewn_commands_fill(commands, &f->data, 0, WORDS * 4, 5);
    hewn_commands_fill(commands, &f->other, 0, WORDS * 4, 6);
    const struct {
        uint64_t to;
        uint32_t limit, pad;
    } push = {.to = f->other.address, .limit = WORDS};
    hewn_commands_dispatch(commands, f->count, &push, NULL, (hewn_dispatch_size){0, 1, 1});
    hewn_commands_dispatch(commands, f->count, &push, NULL, (hewn_dispatch_size){1, 0, 9});
    hewn_commands_copy(commands, &f->data, 0, &f->other, 0, 0);
    hewn_commands_fill(commands, &f->other, 0, 0, 7);
    hewn_commands_copy(commands, &f->other, 0, &f->back, 0, WORDS * 4);
    submit(commands);
    for (uint32_t i = 0; i < WORDS; i++)
        assert_int_equal(((const uint32_t *)f->back.mapped)[i], 6);
    commands = NULL;
    hewn_commands_destroy(&commands);
}

/* Hundreds of dispatches that each need all of the one before, with copies and fills between. */
static void test_order(void **state)
{
    fixture *f = *state;
    static uint32_t twin[2][WORDS];
    hewn_commands *commands = begin(f);
    hewn_commands_fill(commands, &f->data, 0, WORDS * 4, 5);
    hewn_commands_fill(commands, &f->data, 400, 400, 6);
    for (uint32_t i = 0; i < WORDS; i++)
        twin[0][i] = i >= 100 && i < 200 ? 6 : 5;
    for (uint32_t round = 0; round < 150; round++) {
        const step_push push = {
            .from = f->data.address, .to = f->other.address, .count = WORDS, .add = round, .shift = round * 37};
        hewn_commands_dispatch(commands, f->step, &push, NULL, (hewn_dispatch_size){(WORDS + 63) / 64, 1, 1});
        for (uint32_t i = 0; i < WORDS; i++)
            twin[1][(i + push.shift) % WORDS] = twin[0][i] * 3 + round;
        hewn_commands_copy(commands, &f->other, 4, &f->data, 0, (WORDS - 1) * 4);
        memcpy(twin[0], twin[1] + 1, (WORDS - 1) * 4);
        if (round % 10 == 0) {
            hewn_commands_fill(commands, &f->data, round * 4, 40, round);
            for (uint32_t i = 0; i < 10; i++)
                twin[0][round + i] = round;
        }
    }
    hewn_commands_copy(commands, &f->data, 0, &f->back, 0, WORDS * 4);
    submit(commands);
    assert_memory_equal(f->back.mapped, twin[0], WORDS * 4);
}

/* Sizes written on the device by the dispatch before, at several offsets, in one to three dimensions, and none. */
static void test_indirect(void **state)
{
    fixture *f = *state;
    const uint32_t sizes[][3] = {{1, 1, 1}, {7, 1, 1}, {3, 4, 5}, {0, 1, 1}, {1, 0, 9}, {200, 1, 1}, {1, 100, 2}};
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
        const uint64_t offset = s * 12 + 4;
        hewn_commands *commands = begin(f);
        hewn_commands_fill(commands, &f->other, 0, WORDS * 4, 0);
        struct {
            uint64_t to;
            uint32_t size[3], pad;
        } write = {.to = f->data.address + offset, .size = {sizes[s][0], sizes[s][1], sizes[s][2]}};
        hewn_commands_dispatch(commands, f->sizes, &write, NULL, (hewn_dispatch_size){1, 1, 1});
        const struct {
            uint64_t to;
            uint32_t limit, pad;
        } push = {.to = f->other.address, .limit = WORDS};
        hewn_commands_dispatch_indirect(commands, f->count, &push, NULL, &f->data, offset);
        hewn_commands_copy(commands, &f->other, 0, &f->back, 0, WORDS * 4);
        submit(commands);
        const uint32_t all = sizes[s][0] * sizes[s][1] * sizes[s][2], *got = f->back.mapped;
        for (uint32_t i = 0; i < WORDS; i++)
            assert_int_equal(got[i],
                             i < all ? 1 + sizes[s][0] * 256 + sizes[s][1] * 65536 + sizes[s][2] * 16777216 : 0);
    }
}

static void expect(hewn_commands *commands, hewn_result expected, const char *part)
{
    hewn_error error = {0};
    assert_int_equal(hewn_commands_submit(&commands, NULL, &error), expected);
    assert_null(commands);
    assert_int_equal(error.code, expected);
    if (!strstr(error.message, part))
        fail_msg("'%s' lacks '%s'", error.message, part);
}

static void test_recording_failures(void **state)
{
    fixture *f = *state;
    const step_push push = {0};
    hewn_commands *commands = begin(f);
    hewn_commands_dispatch(commands, f->step, &push, NULL, (hewn_dispatch_size){UINT32_MAX, 1, 1});
    /* The first failure stays, and nothing recorded later runs or hides it. */
    hewn_commands_copy(commands, &f->data, 1u << 30, &f->other, 0, 4);
    hewn_commands_fill(commands, &f->data, 0, 4, 0);
    hewn_commands_dispatch(commands, f->step, &push, NULL, (hewn_dispatch_size){1, 1, 1});
    expect(commands, HEWN_LIMIT, "4294967295");
    commands = begin(f);
    hewn_commands_copy(commands, &f->data, 4, &f->other, 0, WORDS * 4);
    expect(commands, HEWN_INTERNAL, "outside");
    commands = begin(f);
    hewn_commands_copy(commands, &f->data, 0, &f->other, UINT64_MAX - 3, 8);
    expect(commands, HEWN_INTERNAL, "outside");
    commands = begin(f);
    hewn_commands_fill(commands, &f->data, 4, WORDS * 4, 0);
    expect(commands, HEWN_INTERNAL, "outside");
    commands = begin(f);
    hewn_commands_fill(commands, &f->data, 2, 4, 0);
    expect(commands, HEWN_INTERNAL, "aligned");
    commands = begin(f);
    hewn_commands_dispatch_indirect(commands, f->step, &push, NULL, &f->data, WORDS * 4 - 8);
    expect(commands, HEWN_INTERNAL, "outside");
    commands = begin(f);
    hewn_commands_dispatch_indirect(commands, f->step, &push, NULL, &f->data, 3);
    expect(commands, HEWN_INTERNAL, "aligned");
    const hewn_buffer none = {0};
    commands = begin(f);
    hewn_commands_copy(commands, &none, 0, &f->data, 0, 4);
    expect(commands, HEWN_INTERNAL, "outside");
    commands = begin(f);
    hewn_commands *second = commands;
    hewn_error error = {0};
    assert_int_equal(hewn_commands_begin(f->device, &second, &error), HEWN_INTERNAL);
    assert_null(second);
    hewn_commands_fill(commands, &f->data, 0, 4, 77);
    hewn_commands_destroy(&commands);
    assert_null(commands);
    commands = begin(f);
    hewn_commands_copy(commands, &f->data, 0, &f->back, 0, 4);
    submit(commands);
    assert_int_not_equal(*(uint32_t *)f->back.mapped, 77);
}

/* Times rise, the gap around work is longer than the one around none, and all fit into what the clock saw. */
static void test_marks(void **state)
{
    fixture *f = *state;
    hewn_commands *commands = begin(f);
    const step_push push = {.from = f->data.address, .to = f->other.address, .count = WORDS, .add = 1};
    double times[HEWN_MARKS_MAX];
    const double start = hewn_clock_now();
    for (uint32_t i = 0; i < HEWN_MARKS_MAX; i++) {
        assert_int_equal(hewn_commands_mark(commands), i);
        for (uint32_t k = 0; k < (i == 10 ? 400u : 0u); k++)
            hewn_commands_dispatch(commands, f->step, &push, NULL, (hewn_dispatch_size){(WORDS + 63) / 64, 1, 1});
    }
    GPU_TEST_TRY(hewn_commands_submit(&commands, times, &error));
    const double wall = hewn_clock_now() - start;
    assert_true(times[0] == 0);
    for (uint32_t i = 1; i < HEWN_MARKS_MAX; i++)
        assert_true(times[i] >= times[i - 1]);
    assert_true(times[HEWN_MARKS_MAX - 1] <= wall * 1.01);
    print_message("# 400 dispatches: %.6f s by marks, %.6f s by the clock, %s\n", times[11] - times[10], wall,
                  f->device->timestamp_bits ? "time stamps" : "no time stamps");
    if (f->device->timestamp_bits)
        assert_true(times[11] - times[10] > times[10] - times[9]);
    commands = begin(f);
    for (uint32_t i = 0; i <= HEWN_MARKS_MAX; i++)
        assert_true(hewn_commands_mark(commands) < HEWN_MARKS_MAX);
    expect(commands, HEWN_INTERNAL, "marks");
}

/* A device without time stamps: all times are 0. */
static void test_no_timestamps(void **state)
{
    fixture *f = *state;
    VkQueryPool queries = f->device->commands.queries;
    f->device->commands.queries = VK_NULL_HANDLE;
    hewn_commands *commands = begin(f);
    hewn_commands_mark(commands);
    hewn_commands_fill(commands, &f->data, 0, 4, 0);
    hewn_commands_mark(commands);
    double times[2] = {1, 1};
    GPU_TEST_TRY(hewn_commands_submit(&commands, times, &error));
    assert_true(times[0] == 0 && times[1] == 0);
    f->device->commands.queries = queries;
}

static VkResult failure;

static VKAPI_ATTR VkResult VKAPI_CALL failing_submit(VkQueue queue, uint32_t count, const VkSubmitInfo *infos,
                                                     VkFence fence)
{
    (void)queue, (void)count, (void)infos, (void)fence;
    return failure;
}

static PFN_vkWaitForFences real_wait;

static VKAPI_ATTR VkResult VKAPI_CALL failing_wait(VkDevice device, uint32_t count, const VkFence *fences, VkBool32 all,
                                                   uint64_t timeout)
{
    real_wait(device, count, fences, all, timeout);
    return failure;
}

static void test_device_lost(void **state)
{
    fixture *f = *state;
    const hewn_vulkan_device_table real = f->device->vk;
    real_wait = real.WaitForFences;
    const struct {
        VkResult failure;
        hewn_result expected;
        const char *part;
    } cases[] = {{VK_ERROR_DEVICE_LOST, HEWN_DEVICE_LOST, "the device was lost"},
                 {VK_ERROR_OUT_OF_DEVICE_MEMORY, HEWN_OUT_OF_DEVICE_MEMORY, "out of device memory"},
                 {VK_ERROR_OUT_OF_HOST_MEMORY, HEWN_OUT_OF_MEMORY, "out of host memory"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        for (int waiting = 0; waiting < 2; waiting++) {
            failure = cases[i].failure;
            hewn_commands *commands = begin(f);
            hewn_commands_fill(commands, &f->data, 0, 4, 0);
            if (waiting)
                f->device->vk.WaitForFences = failing_wait;
            else
                f->device->vk.QueueSubmit = failing_submit;
            expect(commands, cases[i].expected, cases[i].part);
            f->device->vk = real;
        }
    /* The next recording is unharmed. */
    submit(begin(f));
}

/* What a submit costs; printed, and bounded far above what was measured. */
static void test_submit_cost(void **state)
{
    fixture *f = *state;
    enum { TIMES = 300 };
    const double start = hewn_clock_now();
    for (int i = 0; i < TIMES; i++) {
        hewn_commands *commands = begin(f);
        hewn_commands_fill(commands, &f->data, 0, 4, 0);
        submit(commands);
    }
    const double each = (hewn_clock_now() - start) / TIMES;
    print_message("# a submit takes %.1f us (validation on)\n", each * 1e6);
    assert_true(each < 0.02);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_empty),       cmocka_unit_test(test_order),
        cmocka_unit_test(test_indirect),    cmocka_unit_test(test_recording_failures),
        cmocka_unit_test(test_marks),       cmocka_unit_test(test_no_timestamps),
        cmocka_unit_test(test_device_lost), cmocka_unit_test(test_submit_cost),
    };
    return cmocka_run_group_tests_name("commands", tests, open_fixture, close_fixture);
}
