/* Programs from GLSL and SPIR-V: what the compiler says, constants, uniforms, and one layout for C and the device. */
#include "gpu_test.h"

#include "base/text.h"
#include "gpu/device.h"
#include "shared/scan.h"
#include "spirv_layout.h"

#define HEAD                                                                                                           \
    "#version 460\n"                                                                                                   \
    "#extension GL_EXT_buffer_reference : require\n"                                                                   \
    "#extension GL_EXT_scalar_block_layout : require\n"                                                                \
    "layout(local_size_x = 1) in;\n"                                                                                   \
    "layout(buffer_reference, scalar) buffer Words { uint at[]; };\n"

extern const unsigned char hewn_shader_scan_apply[], hewn_shader_scan_prepare[], hewn_shader_scan_reduce[];
extern const size_t hewn_shader_scan_apply_size, hewn_shader_scan_prepare_size, hewn_shader_scan_reduce_size;

typedef struct fixture {
    hewn_device *device;
    unsigned messages;
    hewn_buffer out;
} fixture;

static int open_fixture(void **state)
{
    static fixture shared;
    shared.device = gpu_test_open(&shared.messages);
    GPU_TEST_TRY(hewn_buffer_create(shared.device, "results", 4096, HEWN_BUFFER_READBACK, &shared.out, &error));
    *state = &shared;
    return 0;
}

static int close_fixture(void **state)
{
    fixture *f = *state;
    hewn_buffer_destroy(f->device, &f->out);
    gpu_test_close(&f->device, &f->messages);
    return 0;
}

static hewn_program *make(fixture *f, const char *glsl, uint32_t push_bytes, bool uniforms)
{
    const hewn_program_desc desc = {.name = "test", .glsl = glsl, .push_bytes = push_bytes, .uniforms = uniforms};
    hewn_program *program;
    GPU_TEST_TRY(hewn_program_create(f->device, &desc, &program, &error));
    return program;
}

static void expect_message(fixture *f, const char *glsl, const char *part)
{
    const hewn_program_desc desc = {.name = "broken one", .glsl = glsl, .push_bytes = 8};
    hewn_program *program = (hewn_program *)f;
    hewn_error error = {0};
    assert_int_equal(hewn_program_create(f->device, &desc, &program, &error), HEWN_INTERNAL);
    assert_null(program);
    assert_int_equal(error.code, HEWN_INTERNAL);
    if (!strstr(error.message, "broken one") || !strstr(error.message, part) || strchr(error.message, '\n'))
        fail_msg("'%s' lacks '%s'", error.message, part);
    assert_int_equal(hewn_program_create(f->device, &desc, &program, NULL), HEWN_INTERNAL);
}

static void test_compile_errors(void **state)
{
    fixture *f = *state;
    expect_message(f, HEAD "void main()\n{\n    float x = undeclared_thing;\n}\n", "undeclared_thing");
    expect_message(f, HEAD "void main()\n{\n    float x = undeclared_thing;\n}\n", "0:8");
    expect_message(f, HEAD "void main() { float x = vec2(1, 2); }\n", "cannot convert");
    expect_message(f, HEAD "void other() {}\n", "Missing entry point");
    expect_message(f, "", "does not compile");
    expect_message(f, "#version 460\n#include \"x.h\"\nvoid main() {}\n", "include");
    /* Far more complaints than a message holds: cut short, and still a text. */
    hewn_text many = {0};
    hewn_text_append(&many, HEAD "void main() {\n");
    for (int i = 0; i < 200; i++)
        hewn_text_print(&many, "    float name%d = lost_%d;\n", i, i);
    hewn_text_append(&many, "}\n");
    expect_message(f, many.bytes, "lost_0");
    hewn_text_clear(&many);
}

static void test_push_limits(void **state)
{
    fixture *f = *state;
    const uint32_t bad[] = {1, 2, 6, 130, 132, UINT32_MAX};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        const hewn_program_desc desc = {.name = "limits", .glsl = HEAD "void main() {}\n", .push_bytes = bad[i]};
        hewn_program *program = (hewn_program *)f;
        assert_int_equal(hewn_program_create(f->device, &desc, &program, NULL), HEWN_INTERNAL);
        assert_null(program);
    }
    hewn_program *none = make(f, HEAD "void main() {}\n", 0, false);
    hewn_commands *commands;
    GPU_TEST_TRY(hewn_commands_begin(f->device, &commands, &error));
    hewn_commands_dispatch(commands, none, NULL, NULL, (hewn_dispatch_size){1, 1, 1});
    GPU_TEST_TRY(hewn_commands_submit(&commands, NULL, &error));
    hewn_program_destroy(f->device, &none);
    assert_null(none);
    hewn_program_destroy(f->device, &none);
}

/* All 128 bytes arrive, and each dispatch has its own. */
static void test_push_constants(void **state)
{
    fixture *f = *state;
    hewn_program *program =
        make(f,
             HEAD "layout(push_constant, scalar) uniform P { Words out_words; uint base; uint v[29]; };\n"
                  "void main() { for (uint i = 0u; i < 29u; i++) out_words.at[base + i] = v[i]; }\n",
             128, false);
    struct {
        uint64_t address;
        uint32_t base, values[29];
    } push = {.address = f->out.address};
    _Static_assert(sizeof push == 128, "all that a device must have");
    hewn_commands *commands;
    GPU_TEST_TRY(hewn_commands_begin(f->device, &commands, &error));
    for (uint32_t round = 0; round < 10; round++) {
        push.base = round * 29;
        for (uint32_t i = 0; i < 29; i++)
            push.values[i] = 1000 * round + i;
        hewn_commands_dispatch(commands, program, &push, NULL, (hewn_dispatch_size){1, 1, 1});
    }
    memset(&push, 0, sizeof push);
    GPU_TEST_TRY(hewn_commands_submit(&commands, NULL, &error));
    const uint32_t *got = f->out.mapped;
    for (uint32_t i = 0; i < 290; i++)
        assert_int_equal(got[i], 1000 * (i / 29) + i % 29);
    hewn_program_destroy(f->device, &program);
}

/* More uniform buffers than one pool of descriptors holds, met in an order that no cache likes, in two recordings. */
static void test_uniforms(void **state)
{
    fixture *f = *state;
    enum { COUNT = 150 };
    hewn_program *program =
        make(f,
             HEAD "layout(push_constant, scalar) uniform P { Words out_words; uint index; };\n"
                  "layout(set = 0, binding = 0, scalar) uniform U { float scale; float offsets[3]; uint id; };\n"
                  "void main() { out_words.at[index] += id * uint(scale) + uint(offsets[2]); }\n",
             12, true);
    hewn_buffer buffers[COUNT];
    for (uint32_t i = 0; i < COUNT; i++) {
        GPU_TEST_TRY(hewn_buffer_create(f->device, "uniforms", 20, HEWN_BUFFER_UPLOAD, &buffers[i], &error));
        float *values = buffers[i].mapped;
        values[0] = 2;
        values[3] = (float)i;
        memcpy(values + 4, &i, 4);
    }
    for (uint32_t again = 0; again < 2; again++) {
        hewn_commands *commands;
        GPU_TEST_TRY(hewn_commands_begin(f->device, &commands, &error));
        hewn_commands_fill(commands, &f->out, 0, 4096, 0);
        for (uint32_t step = 0; step < 3 * COUNT; step++) {
            struct {
                uint64_t address;
                uint32_t index, pad;
            } push = {.address = f->out.address, .index = step * 7 % COUNT};
            hewn_commands_dispatch(commands, program, &push, &buffers[push.index], (hewn_dispatch_size){1, 1, 1});
        }
        GPU_TEST_TRY(hewn_commands_submit(&commands, NULL, &error));
        const uint32_t *got = f->out.mapped;
        for (uint32_t i = 0; i < COUNT; i++)
            assert_int_equal(got[i], 3 * (2 * i + i));
    }
    hewn_commands *commands;
    GPU_TEST_TRY(hewn_commands_begin(f->device, &commands, &error));
    const uint32_t push[4] = {0};
    hewn_commands_dispatch(commands, program, push, NULL, (hewn_dispatch_size){1, 1, 1});
    assert_int_equal(hewn_commands_submit(&commands, NULL, NULL), HEWN_INTERNAL);
    for (uint32_t i = 0; i < COUNT; i++)
        hewn_buffer_destroy(f->device, &buffers[i]);
    hewn_program_destroy(f->device, &program);
}

static VKAPI_ATTR VkResult VKAPI_CALL failing_pipeline(VkDevice device, VkPipelineCache cache, uint32_t count,
                                                       const VkComputePipelineCreateInfo *infos,
                                                       const VkAllocationCallbacks *allocator, VkPipeline *out)
{
    (void)device, (void)cache, (void)infos, (void)allocator;
    for (uint32_t i = 0; i < count; i++)
        out[i] = VK_NULL_HANDLE;
    return VK_ERROR_OUT_OF_HOST_MEMORY;
}

static void test_driver_refuses(void **state)
{
    fixture *f = *state;
    const hewn_vulkan_device_table real = f->device->vk;
    f->device->vk.CreateComputePipelines = failing_pipeline;
    const hewn_program_desc desc = {.name = "refused", .glsl = HEAD "void main() {}\n"};
    hewn_program *program = (hewn_program *)f;
    hewn_error error = {0};
    hewn_result result = hewn_program_create(f->device, &desc, &program, &error);
    f->device->vk = real;
    assert_int_equal(result, HEWN_OUT_OF_MEMORY);
    assert_non_null(strstr(error.message, "refused"));
    assert_null(program);
}

/* Text and data that the compiler must take or refuse, but never die of. */
static void test_any_text(void **state)
{
    fixture *f = *state;
    uint64_t random = 99;
    const char *words[] = {
        "void",           "main", "(", ")", "{", "}",      ";",      "float", "x",  "=",  "1.0", "for", "if",
        "#version 460\n", "uint", "[", "]", "+", "layout", "buffer", "\\\n",  "/*", "*/", "//",  "\"",  "\xff"};
    for (int i = 0; i < 60; i++) {
        hewn_text glsl = {0};
        hewn_text_append(&glsl, HEAD);
        for (int j = 0; j < 80; j++)
            hewn_text_print(&glsl, "%s ", words[gpu_test_random(&random) % (sizeof words / sizeof *words)]);
        const hewn_program_desc desc = {.name = "noise", .glsl = glsl.bytes};
        hewn_program *program;
        hewn_error error = {0};
        if (hewn_program_create(f->device, &desc, &program, &error) == HEWN_OK)
            hewn_program_destroy(f->device, &program);
        else
            assert_int_equal(error.code, HEWN_INTERNAL);
        hewn_text_clear(&glsl);
    }
}

#define CHECK(module, type, member)                                                                                    \
    do {                                                                                                               \
        int64_t offset = spirv_offset(hewn_shader_##module, hewn_shader_##module##_size, #type, #member);              \
        if (offset != (int64_t)offsetof(struct type, member))                                                          \
            fail_msg(#type "." #member " is at %lld in " #module ", at %zu in C", (long long)offset,                   \
                     offsetof(struct type, member));                                                                   \
    } while (0)

static void test_layouts(void **state)
{
    (void)state;
    CHECK(scan_reduce, hewn_scan_push, values);
    CHECK(scan_reduce, hewn_scan_push, sums);
    CHECK(scan_reduce, hewn_scan_push, counter);
    CHECK(scan_reduce, hewn_scan_push, count);
    CHECK(scan_reduce, hewn_scan_push, highs);
    CHECK(scan_reduce, hewn_scan_push, sum_highs);
    CHECK(scan_apply, hewn_scan_push, values);
    CHECK(scan_apply, hewn_scan_push, sums);
    CHECK(scan_apply, hewn_scan_push, counter);
    CHECK(scan_apply, hewn_scan_push, count);
    CHECK(scan_apply, hewn_scan_push, highs);
    CHECK(scan_apply, hewn_scan_push, sum_highs);
    CHECK(scan_prepare, hewn_scan_prepare_push, counter);
    CHECK(scan_prepare, hewn_scan_prepare_push, levels);
    CHECK(scan_prepare, hewn_scan_prepare_push, capacity);
    CHECK(scan_prepare, hewn_scan_prepare_push, pad);
    CHECK(scan_prepare, hewn_scan_level, groups);
    CHECK(scan_prepare, hewn_scan_level, count);
    /* The reader itself can say no. */
    assert_int_equal(spirv_offset(hewn_shader_scan_apply, hewn_shader_scan_apply_size, "hewn_scan_push", "nothing"),
                     -1);
    assert_int_equal(spirv_offset(hewn_shader_scan_apply, hewn_shader_scan_apply_size, "nothing", "values"), -1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_compile_errors), cmocka_unit_test(test_push_limits),
        cmocka_unit_test(test_push_constants), cmocka_unit_test(test_uniforms),
        cmocka_unit_test(test_driver_refuses), cmocka_unit_test(test_any_text),
        cmocka_unit_test(test_layouts),
    };
    return cmocka_run_group_tests_name("program", tests, open_fixture, close_fixture);
}
