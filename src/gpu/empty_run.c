#include "gpu/empty_run.h"

#include "base/error.h"

/* As many as devices let a shader see, or less: no shader of Hewn's reads more. */
enum { UNIFORM_BYTES = 65536 };

static hewn_result take_memory(hewn_device *device, hewn_empty_run *run, hewn_error *error)
{
    VkMemoryRequirements needs;
    device->vk.GetBufferMemoryRequirements(device->handle, run->uniforms, &needs);
    uint32_t type = 0;
    while (type < device->memory.memoryTypeCount && !(needs.memoryTypeBits >> type & 1))
        type++;
    const VkMemoryAllocateInfo info = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = needs.size, .memoryTypeIndex = type};
    HEWN_TRY(hewn_vulkan_check(device->vk.AllocateMemory(device->handle, &info, NULL, &run->memory),
                               "making room for empty uniforms", error));
    return hewn_vulkan_check(device->vk.BindBufferMemory(device->handle, run->uniforms, run->memory, 0),
                             "making room for empty uniforms", error);
}

static hewn_result make_uniforms(hewn_device *device, hewn_empty_run *run, hewn_error *error)
{
    const VkBufferCreateInfo info = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                     .size = device->max_uniform_range < UNIFORM_BYTES ? device->max_uniform_range
                                                                                       : UNIFORM_BYTES,
                                     .usage = VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT};
    HEWN_TRY(hewn_vulkan_check(device->vk.CreateBuffer(device->handle, &info, NULL, &run->uniforms),
                               "making empty uniforms", error));
    HEWN_TRY(take_memory(device, run, error));
    const VkDescriptorPoolSize size = {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 1};
    const VkDescriptorPoolCreateInfo pool = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO, .maxSets = 1, .poolSizeCount = 1, .pPoolSizes = &size};
    HEWN_TRY(hewn_vulkan_check(device->vk.CreateDescriptorPool(device->handle, &pool, NULL, &run->sets),
                               "making empty uniforms", error));
    const VkDescriptorSetAllocateInfo set = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                             .descriptorPool = run->sets,
                                             .descriptorSetCount = 1,
                                             .pSetLayouts = &device->uniform_layout};
    HEWN_TRY(hewn_vulkan_check(device->vk.AllocateDescriptorSets(device->handle, &set, &run->set),
                               "making empty uniforms", error));
    const VkDescriptorBufferInfo target = {.buffer = run->uniforms, .range = VK_WHOLE_SIZE};
    const VkWriteDescriptorSet write = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                        .dstSet = run->set,
                                        .descriptorCount = 1,
                                        .descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER,
                                        .pBufferInfo = &target};
    device->vk.UpdateDescriptorSets(device->handle, 1, &write, 0, NULL);
    return HEWN_OK;
}

hewn_result hewn_empty_run_open(hewn_device *device, hewn_empty_run *out, hewn_error *error)
{
    *out = (hewn_empty_run){0};
    const VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                          .flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT,
                                          .queueFamilyIndex = device->queue_family};
    HEWN_TRY(hewn_vulkan_check(device->vk.CreateCommandPool(device->handle, &pool, NULL, &out->pool),
                               "creating a command pool", error));
    const VkCommandBufferAllocateInfo buffer = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                                .commandPool = out->pool,
                                                .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                                .commandBufferCount = 1};
    HEWN_TRY(hewn_vulkan_check(device->vk.AllocateCommandBuffers(device->handle, &buffer, &out->buffer),
                               "creating a command buffer", error));
    const VkFenceCreateInfo fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    HEWN_TRY(hewn_vulkan_check(device->vk.CreateFence(device->handle, &fence, NULL, &out->fence), "creating a fence",
                               error));
    return make_uniforms(device, out, error);
}

void hewn_empty_run_close(hewn_device *device, hewn_empty_run *run)
{
    if (run->sets)
        device->vk.DestroyDescriptorPool(device->handle, run->sets, NULL);
    if (run->uniforms)
        device->vk.DestroyBuffer(device->handle, run->uniforms, NULL);
    if (run->memory)
        device->vk.FreeMemory(device->handle, run->memory, NULL);
    if (run->fence)
        device->vk.DestroyFence(device->handle, run->fence, NULL);
    if (run->pool)
        device->vk.DestroyCommandPool(device->handle, run->pool, NULL);
    *run = (hewn_empty_run){0};
}

static void record(hewn_device *device, hewn_empty_run *run, const hewn_program *program)
{
    static const char nothing[HEWN_PUSH_MAX];
    if (program->uniforms)
        device->vk.CmdBindDescriptorSets(run->buffer, VK_PIPELINE_BIND_POINT_COMPUTE, program->layout, 0, 1, &run->set,
                                         0, NULL);
    device->vk.CmdBindPipeline(run->buffer, VK_PIPELINE_BIND_POINT_COMPUTE, program->pipeline);
    if (program->push_bytes)
        device->vk.CmdPushConstants(run->buffer, program->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, program->push_bytes,
                                    nothing);
    device->vk.CmdDispatch(run->buffer, 0, 1, 1);
}

hewn_result hewn_empty_run_do(hewn_device *device, hewn_empty_run *run, const hewn_program *program, hewn_error *error)
{
    static const char doing[] = "making machine code";
    HEWN_TRY(hewn_vulkan_check(device->vk.ResetCommandPool(device->handle, run->pool, 0), doing, error));
    const VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                            .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    HEWN_TRY(hewn_vulkan_check(device->vk.BeginCommandBuffer(run->buffer, &begin), doing, error));
    record(device, run, program);
    HEWN_TRY(hewn_vulkan_check(device->vk.EndCommandBuffer(run->buffer), doing, error));
    HEWN_TRY(hewn_vulkan_check(device->vk.ResetFences(device->handle, 1, &run->fence), doing, error));
    const VkSubmitInfo submit = {
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1, .pCommandBuffers = &run->buffer};
    HEWN_TRY(hewn_vulkan_check(device->vk.QueueSubmit(device->queue, 1, &submit, run->fence), doing, error));
    return hewn_vulkan_check(device->vk.WaitForFences(device->handle, 1, &run->fence, VK_TRUE, UINT64_MAX), doing,
                             error);
}
