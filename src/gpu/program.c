#include "gpu/program.h"

#include <stdio.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "gpu/ahead.h"
#include "gpu/compiler.h"
#include "gpu/device.h"

static const char spirv_folder[] = "spirv";
static const char pipeline_folder[] = "pipeline";

static size_t pipeline_bytes(hewn_device *device)
{
    size_t length = 0;
    VkResult result = device->vk.GetPipelineCacheData(device->handle, device->pipeline_cache, &length, NULL);
    return result == VK_SUCCESS ? length : 0;
}

static hewn_result create_pipeline_cache(hewn_device *device, hewn_error *error)
{
    size_t length;
    void *kept = hewn_cache_load(&device->cache, pipeline_folder, device->pipeline_key, &length);
    /* Vulkan wants to be handed back only what this very driver gave. */
    const size_t header = sizeof device->pipeline_header;
    if (kept && (length < header || memcmp(kept, &device->pipeline_header, header) != 0)) {
        hewn_free(kept);
        kept = NULL;
        length = 0;
    }
    VkPipelineCacheCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO, .initialDataSize = length, .pInitialData = kept};
    VkResult result = device->vk.CreatePipelineCache(device->handle, &info, NULL, &device->pipeline_cache);
    if (result < 0 && length > 0) {
        info.initialDataSize = 0;
        info.pInitialData = NULL;
        result = device->vk.CreatePipelineCache(device->handle, &info, NULL, &device->pipeline_cache);
    }
    hewn_free(kept);
    HEWN_TRY(hewn_vulkan_check(result, "creating a pipeline cache", error));
    device->pipeline_cache_bytes = pipeline_bytes(device);
    return HEWN_OK;
}

hewn_result hewn_programs_describe(hewn_device *device, hewn_error *error)
{
    const VkDescriptorSetLayoutBinding binding = {.binding = 0,
                                                  .descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER,
                                                  .descriptorCount = 1,
                                                  .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT};
    const VkDescriptorSetLayoutCreateInfo layout = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO, .bindingCount = 1, .pBindings = &binding};
    return hewn_vulkan_check(
        device->vk.CreateDescriptorSetLayout(device->handle, &layout, NULL, &device->uniform_layout),
        "describing uniforms", error);
}

hewn_result hewn_programs_setup(hewn_device *device, hewn_error *error)
{
    HEWN_TRY(hewn_programs_describe(device, error));
    return create_pipeline_cache(device, error);
}

/* Some drivers keep nothing here, and one wraps what it is given once more each time: only what grew is worth a file.
 */
static void save_pipelines(hewn_device *device)
{
    size_t length = pipeline_bytes(device);
    if (length <= device->pipeline_cache_bytes)
        return;
    void *bytes = hewn_alloc(length, 1);
    if (bytes && device->vk.GetPipelineCacheData(device->handle, device->pipeline_cache, &length, bytes) == VK_SUCCESS)
        hewn_cache_store(&device->cache, pipeline_folder, device->pipeline_key, bytes, length);
    hewn_free(bytes);
}

void hewn_programs_teardown(hewn_device *device)
{
    if (device->pipeline_cache) {
        save_pipelines(device);
        device->vk.DestroyPipelineCache(device->handle, device->pipeline_cache, NULL);
    }
    if (device->uniform_layout)
        device->vk.DestroyDescriptorSetLayout(device->handle, device->uniform_layout, NULL);
}

/* SPIR-V of a GLSL text, from the disk if it is there. */
static hewn_result translate(const hewn_device *device, const hewn_program_desc *desc, uint32_t **words, size_t *bytes,
                             hewn_error *error)
{
    static const uint32_t spirv_magic = 0x07230203;
    hewn_hash key = hewn_compiler_key(desc->glsl);
    *words = hewn_cache_load(&device->cache, spirv_folder, key, bytes);
    if (*words && *bytes % 4 == 0 && *bytes >= 20 && (*words)[0] == spirv_magic)
        return HEWN_OK;
    hewn_free(*words);
    HEWN_TRY(hewn_compiler_run(desc->name, desc->glsl, words, bytes, error));
    hewn_cache_store(&device->cache, spirv_folder, key, *words, *bytes);
    return HEWN_OK;
}

static hewn_result create_layout(hewn_device *device, hewn_program *program, hewn_error *error)
{
    const VkPushConstantRange push = {.stageFlags = VK_SHADER_STAGE_COMPUTE_BIT, .size = program->push_bytes};
    const VkPipelineLayoutCreateInfo info = {.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                             .setLayoutCount = program->uniforms ? 1 : 0,
                                             .pSetLayouts = &device->uniform_layout,
                                             .pushConstantRangeCount = program->push_bytes ? 1 : 0,
                                             .pPushConstantRanges = &push};
    return hewn_vulkan_check(device->vk.CreatePipelineLayout(device->handle, &info, NULL, &program->layout),
                             "creating a pipeline layout", error);
}

static hewn_result create_pipeline(hewn_device *device, const char *name, hewn_program *program, const uint32_t *words,
                                   size_t bytes, hewn_error *error)
{
    char doing[128];
    snprintf(doing, sizeof doing, "creating the pipeline of the shader %s", name);
    const VkShaderModuleCreateInfo module_info = {
        .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, .codeSize = bytes, .pCode = words};
    VkShaderModule module = VK_NULL_HANDLE;
    HEWN_TRY(
        hewn_vulkan_check(device->vk.CreateShaderModule(device->handle, &module_info, NULL, &module), doing, error));
    const VkComputePipelineCreateInfo info = {.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
                                              .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                                                        .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                                                        .module = module,
                                                        .pName = "main"},
                                              .layout = program->layout,
                                              .basePipelineIndex = -1};
    VkResult result =
        device->vk.CreateComputePipelines(device->handle, device->pipeline_cache, 1, &info, NULL, &program->pipeline);
    device->vk.DestroyShaderModule(device->handle, module, NULL);
    return hewn_vulkan_check(result, doing, error);
}

hewn_result hewn_program_make(hewn_device *device, const char *name, hewn_program *program, const uint32_t *words,
                              size_t bytes, hewn_error *error)
{
    HEWN_TRY(create_layout(device, program, error));
    return create_pipeline(device, name, program, words, bytes, error);
}

void hewn_program_unmake(hewn_device *device, hewn_program *program)
{
    if (program->pipeline)
        device->vk.DestroyPipeline(device->handle, program->pipeline, NULL);
    if (program->layout)
        device->vk.DestroyPipelineLayout(device->handle, program->layout, NULL);
}

hewn_result hewn_program_create(hewn_device *device, const hewn_program_desc *desc, hewn_program **out,
                                hewn_error *error)
{
    *out = NULL;
    if (desc->push_bytes > HEWN_PUSH_MAX || desc->push_bytes % 4 != 0)
        return hewn_fail(error, HEWN_INTERNAL, "the shader %s wants %u bytes of push constants", desc->name,
                         desc->push_bytes);
    uint32_t *translated = NULL;
    const uint32_t *words = desc->spirv;
    size_t bytes = desc->spirv_bytes;
    if (!words) {
        HEWN_TRY(translate(device, desc, &translated, &bytes, error));
        words = translated;
    }
    hewn_program *program = hewn_alloc_zero(1, sizeof *program);
    hewn_result result = HEWN_OK;
    if (!program) {
        result = hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory creating the shader %s", desc->name);
    } else {
        program->push_bytes = desc->push_bytes;
        program->uniforms = desc->uniforms;
        result = hewn_program_make(device, desc->name, program, words, bytes, error);
        if (result == HEWN_OK && desc->soon && hewn_ahead_pays(device))
            result = hewn_ahead_add(device, program, words, bytes, error);
    }
    hewn_free(translated);
    if (result != HEWN_OK)
        hewn_program_destroy(device, &program);
    *out = program;
    return result;
}

void hewn_program_destroy(hewn_device *device, hewn_program **program_pointer)
{
    hewn_program *program = *program_pointer;
    if (!program)
        return;
    hewn_ahead_forget(device, program);
    hewn_program_unmake(device, program);
    hewn_free(program);
    *program_pointer = NULL;
}
