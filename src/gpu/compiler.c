#include "gpu/compiler.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include <glslang/Include/glslang_c_interface.h>
#include <glslang/Public/resource_limits_c.h>
#include <glslang/build_info.h>

#include "base/alloc.h"
#include "base/error.h"

/* Goes up whenever the options below change. */
static const uint32_t options_version = 1;

hewn_hash hewn_compiler_key(const char *glsl)
{
    const uint32_t version[4] = {GLSLANG_VERSION_MAJOR, GLSLANG_VERSION_MINOR, GLSLANG_VERSION_PATCH, options_version};
    hewn_hash key = hewn_hash_bytes(hewn_hash_begin(), version, sizeof version);
    key = hewn_hash_bytes(key, HEWN_VERSION, strlen(HEWN_VERSION));
    return hewn_hash_bytes(key, glsl, strlen(glsl));
}

/* glslang keeps tables for the whole process, which it wants made exactly once; they are never given back, since no
 * one here can know who else in the process uses them. */
static pthread_once_t once = PTHREAD_ONCE_INIT;

static void initialize(void)
{
    (void)glslang_initialize_process();
}

/* The log in one line: its first lines, joined, without the blank ones. */
static void shorten(const char *log, char *out, size_t size)
{
    size_t length = 0;
    while (*log && length + 3 < size) {
        size_t line = strcspn(log, "\n");
        if (line > 0) {
            int printed = snprintf(out + length, size - length, "%s%.*s", length ? "; " : "", (int)line, log);
            length += printed > 0 ? (size_t)printed : 0;
        }
        log += line;
        log += *log == '\n';
    }
    if (length == 0)
        snprintf(out, size, "no reason given");
}

static hewn_result fail_compile(const char *name, const char *log, hewn_error *error)
{
    char text[640];
    shorten(log ? log : "", text, sizeof text);
    return hewn_fail(error, HEWN_INTERNAL, "the shader %s does not compile: %s", name, text);
}

static hewn_result take_words(glslang_program_t *program, uint32_t **words, size_t *bytes, hewn_error *error)
{
    /* Unoptimised: drivers optimise anyway, and compiling is on the way to the first result. */
    glslang_spv_options_t options = {.disable_optimizer = true};
    glslang_program_SPIRV_generate_with_options(program, GLSLANG_STAGE_COMPUTE, &options);
    size_t count = glslang_program_SPIRV_get_size(program);
    *words = hewn_alloc(count, sizeof **words);
    if (!*words)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory keeping %zu words of SPIR-V", count);
    memcpy(*words, glslang_program_SPIRV_get_ptr(program), count * sizeof **words);
    *bytes = count * sizeof **words;
    return HEWN_OK;
}

hewn_result hewn_compiler_run(const char *name, const char *glsl, uint32_t **words, size_t *bytes, hewn_error *error)
{
    *words = NULL;
    *bytes = 0;
    pthread_once(&once, initialize);
    const glslang_input_t input = {
        .language = GLSLANG_SOURCE_GLSL,
        .stage = GLSLANG_STAGE_COMPUTE,
        .client = GLSLANG_CLIENT_VULKAN,
        .client_version = GLSLANG_TARGET_VULKAN_1_2,
        .target_language = GLSLANG_TARGET_SPV,
        .target_language_version = GLSLANG_TARGET_SPV_1_5,
        .code = glsl,
        .default_version = 460,
        .default_profile = GLSLANG_NO_PROFILE,
        .messages = GLSLANG_MSG_SPV_RULES_BIT | GLSLANG_MSG_VULKAN_RULES_BIT,
        .resource = glslang_default_resource(),
    };
    const int messages = GLSLANG_MSG_SPV_RULES_BIT | GLSLANG_MSG_VULKAN_RULES_BIT;
    glslang_shader_t *shader = glslang_shader_create(&input);
    glslang_program_t *program = glslang_program_create();
    hewn_result result;
    if (!shader || !program)
        result = hewn_fail(error, HEWN_INTERNAL, "the shader compiler did not start");
    else if (!glslang_shader_preprocess(shader, &input) || !glslang_shader_parse(shader, &input))
        result = fail_compile(name, glslang_shader_get_info_log(shader), error);
    else {
        glslang_program_add_shader(program, shader);
        if (!glslang_program_link(program, messages))
            result = fail_compile(name, glslang_program_get_info_log(program), error);
        else
            result = take_words(program, words, bytes, error);
    }
    if (program)
        glslang_program_delete(program);
    if (shader)
        glslang_shader_delete(shader);
    return result;
}
