#include "gpu/commands.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "gpu/ahead.h"
#include "gpu/device.h"

enum { SETS_A_POOL = 64 };

hewn_result hewn_commands_setup(hewn_device *device, hewn_error *error)
{
    hewn_commands *commands = &device->commands;
    commands->device = device;
    const VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                          .flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT,
                                          .queueFamilyIndex = device->queue_family};
    HEWN_TRY(hewn_vulkan_check(device->vk.CreateCommandPool(device->handle, &pool, NULL, &commands->pool),
                               "creating a command pool", error));
    const VkCommandBufferAllocateInfo buffer = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                                .commandPool = commands->pool,
                                                .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                                .commandBufferCount = 1};
    HEWN_TRY(hewn_vulkan_check(device->vk.AllocateCommandBuffers(device->handle, &buffer, &commands->buffer),
                               "creating a command buffer", error));
    const VkFenceCreateInfo fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    HEWN_TRY(hewn_vulkan_check(device->vk.CreateFence(device->handle, &fence, NULL, &commands->fence),
                               "creating a fence", error));
    if (device->timestamp_bits == 0)
        return HEWN_OK;
    const VkQueryPoolCreateInfo queries = {.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                           .queryType = VK_QUERY_TYPE_TIMESTAMP,
                                           .queryCount = HEWN_MARKS_MAX};
    return hewn_vulkan_check(device->vk.CreateQueryPool(device->handle, &queries, NULL, &commands->queries),
                             "creating time stamps", error);
}

void hewn_commands_teardown(hewn_device *device)
{
    hewn_commands *commands = &device->commands;
    for (size_t i = 0; i < commands->pool_count; i++)
        device->vk.DestroyDescriptorPool(device->handle, commands->pools[i], NULL);
    hewn_free(commands->pools);
    hewn_free(commands->sets);
    if (commands->queries)
        device->vk.DestroyQueryPool(device->handle, commands->queries, NULL);
    if (commands->fence)
        device->vk.DestroyFence(device->handle, commands->fence, NULL);
    if (commands->pool)
        device->vk.DestroyCommandPool(device->handle, commands->pool, NULL);
    *commands = (hewn_commands){0};
}

void hewn_commands_fail(hewn_commands *commands, hewn_result code, const char *format, ...)
{
    if (commands->failure != HEWN_OK)
        return;
    char message[sizeof commands->reason.message];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    commands->failure = hewn_fail(&commands->reason, code, "%s", message);
}

hewn_result hewn_commands_begin(hewn_device *device, hewn_commands **out, hewn_error *error)
{
    *out = NULL;
    hewn_commands *commands = &device->commands;
    if (commands->open)
        return hewn_fail(error, HEWN_INTERNAL, "a recording is open on the device already");
    HEWN_TRY(hewn_ahead_finish(device, error));
    HEWN_TRY(hewn_vulkan_check(device->vk.ResetCommandPool(device->handle, commands->pool, 0),
                               "emptying the command pool", error));
    const VkCommandBufferBeginInfo info = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                           .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    HEWN_TRY(hewn_vulkan_check(device->vk.BeginCommandBuffer(commands->buffer, &info), "starting a recording", error));
    commands->open = true;
    commands->wrote = false;
    commands->marks = 0;
    commands->sets_used = 0;
    commands->failure = HEWN_OK;
    commands->reason = (hewn_error){0};
    if (commands->queries)
        device->vk.CmdResetQueryPool(commands->buffer, commands->queries, 0, HEWN_MARKS_MAX);
    *out = commands;
    return HEWN_OK;
}

/* Everything waits for everything: pipelines here are chains, where finer barriers buy nothing. */
static void wait_for_earlier(hewn_commands *commands)
{
    const VkPipelineStageFlags work = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT;
    const VkMemoryBarrier barrier = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                                     .srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT,
                                     .dstAccessMask = VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT |
                                                      VK_ACCESS_UNIFORM_READ_BIT | VK_ACCESS_TRANSFER_READ_BIT |
                                                      VK_ACCESS_TRANSFER_WRITE_BIT |
                                                      VK_ACCESS_INDIRECT_COMMAND_READ_BIT};
    if (commands->wrote)
        commands->device->vk.CmdPipelineBarrier(commands->buffer, work, work | VK_PIPELINE_STAGE_DRAW_INDIRECT_BIT, 0,
                                                1, &barrier, 0, NULL, 0, NULL);
    commands->wrote = true;
}

/* One more pool with its sets. They live as long as the device; each recording points them anew. */
static bool grow_sets(hewn_commands *commands)
{
    hewn_device *device = commands->device;
    void *pools = commands->pools, *sets = commands->sets;
    hewn_result room = hewn_reserve(&pools, &commands->pool_capacity, commands->pool_count + 1,
                                    sizeof(VkDescriptorPool), &commands->reason);
    commands->pools = pools;
    if (room == HEWN_OK)
        room = hewn_reserve(&sets, &commands->set_capacity, commands->set_count + SETS_A_POOL, sizeof *commands->sets,
                            &commands->reason);
    commands->sets = sets;
    if (room != HEWN_OK) {
        commands->failure = room;
        return false;
    }
    const VkDescriptorPoolSize size = {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, SETS_A_POOL};
    const VkDescriptorPoolCreateInfo pool_info = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                                  .maxSets = SETS_A_POOL,
                                                  .poolSizeCount = 1,
                                                  .pPoolSizes = &size};
    VkDescriptorPool pool = VK_NULL_HANDLE;
    VkResult result = device->vk.CreateDescriptorPool(device->handle, &pool_info, NULL, &pool);
    VkDescriptorSet handles[SETS_A_POOL];
    if (result == VK_SUCCESS) {
        commands->pools[commands->pool_count++] = pool;
        VkDescriptorSetLayout layouts[SETS_A_POOL];
        for (size_t i = 0; i < SETS_A_POOL; i++)
            layouts[i] = device->uniform_layout;
        const VkDescriptorSetAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                                  .descriptorPool = pool,
                                                  .descriptorSetCount = SETS_A_POOL,
                                                  .pSetLayouts = layouts};
        result = device->vk.AllocateDescriptorSets(device->handle, &info, handles);
    }
    if (result != VK_SUCCESS) {
        commands->failure = hewn_vulkan_check(result, "making room for uniforms", &commands->reason);
        return false;
    }
    for (size_t i = 0; i < SETS_A_POOL; i++)
        commands->sets[commands->set_count++] = (hewn_uniform_set){.handle = handles[i]};
    return true;
}

/* The set that points to a uniform buffer; VK_NULL_HANDLE after a failure. */
static VkDescriptorSet uniform_set(hewn_commands *commands, const hewn_buffer *uniforms)
{
    hewn_device *device = commands->device;
    /* A pipeline mostly keeps to a few buffers, so the last sets are worth a look. */
    size_t used = commands->sets_used;
    for (size_t i = used; i > 0 && i + 8 > used; i--)
        if (commands->sets[i - 1].buffer == (VkBuffer)uniforms->handle)
            return commands->sets[i - 1].handle;
    if (used == commands->set_count && !grow_sets(commands))
        return VK_NULL_HANDLE;
    hewn_uniform_set *set = &commands->sets[commands->sets_used++];
    set->buffer = uniforms->handle;
    const uint64_t range = uniforms->size < device->max_uniform_range ? uniforms->size : device->max_uniform_range;
    const VkDescriptorBufferInfo target = {.buffer = set->buffer, .range = range};
    const VkWriteDescriptorSet write = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                        .dstSet = set->handle,
                                        .descriptorCount = 1,
                                        .descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER,
                                        .pBufferInfo = &target};
    device->vk.UpdateDescriptorSets(device->handle, 1, &write, 0, NULL);
    return set->handle;
}

/* Everything of a dispatch but the dispatch; false after a failure. */
static bool prepare(hewn_commands *commands, hewn_program *program, const void *push, const hewn_buffer *uniforms)
{
    hewn_device *device = commands->device;
    if (commands->failure != HEWN_OK)
        return false;
    if (program->uniforms) {
        if (!uniforms || !uniforms->handle) {
            hewn_commands_fail(commands, HEWN_INTERNAL, "a shader that reads uniforms was dispatched without any");
            return false;
        }
        VkDescriptorSet set = uniform_set(commands, uniforms);
        if (set == VK_NULL_HANDLE)
            return false;
        device->vk.CmdBindDescriptorSets(commands->buffer, VK_PIPELINE_BIND_POINT_COMPUTE, program->layout, 0, 1, &set,
                                         0, NULL);
    }
    device->vk.CmdBindPipeline(commands->buffer, VK_PIPELINE_BIND_POINT_COMPUTE, program->pipeline);
    if (program->push_bytes)
        device->vk.CmdPushConstants(commands->buffer, program->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0,
                                    program->push_bytes, push);
    wait_for_earlier(commands);
    return true;
}

void hewn_commands_dispatch(hewn_commands *commands, hewn_program *program, const void *push,
                            const hewn_buffer *uniforms, hewn_dispatch_size groups)
{
    const uint32_t *most = commands->device->max_group_count;
    if (groups.x > most[0] || groups.y > most[1] || groups.z > most[2])
        hewn_commands_fail(commands, HEWN_LIMIT,
                           "%u x %u x %u workgroups are more than the device takes at once (%u x %u x %u)", groups.x,
                           groups.y, groups.z, most[0], most[1], most[2]);
    if (groups.x == 0 || groups.y == 0 || groups.z == 0 || !prepare(commands, program, push, uniforms))
        return;
    commands->device->vk.CmdDispatch(commands->buffer, groups.x, groups.y, groups.z);
}

/* Whether a range lies within a buffer, counted in whole words as its memory is. */
static bool check_range(hewn_commands *commands, const hewn_buffer *buffer, uint64_t offset, uint64_t bytes)
{
    uint64_t room = (buffer->size + 3) & ~(uint64_t)3;
    if (commands->failure != HEWN_OK)
        return false;
    if (buffer->handle && offset <= room && bytes <= room - offset)
        return true;
    hewn_commands_fail(commands, HEWN_INTERNAL, "%llu bytes at %llu lie outside a buffer of %llu",
                       (unsigned long long)bytes, (unsigned long long)offset, (unsigned long long)buffer->size);
    return false;
}

void hewn_commands_dispatch_indirect(hewn_commands *commands, hewn_program *program, const void *push,
                                     const hewn_buffer *uniforms, const hewn_buffer *sizes, uint64_t offset)
{
    if (offset % 4 != 0)
        hewn_commands_fail(commands, HEWN_INTERNAL, "dispatch sizes at byte %llu are not aligned",
                           (unsigned long long)offset);
    if (!check_range(commands, sizes, offset, sizeof(hewn_dispatch_size)) ||
        !prepare(commands, program, push, uniforms))
        return;
    commands->device->vk.CmdDispatchIndirect(commands->buffer, sizes->handle, offset);
}

void hewn_commands_copy(hewn_commands *commands, const hewn_buffer *from, uint64_t from_offset, const hewn_buffer *to,
                        uint64_t to_offset, uint64_t bytes)
{
    if (!check_range(commands, from, from_offset, bytes) || !check_range(commands, to, to_offset, bytes) || bytes == 0)
        return;
    const VkBufferCopy region = {.srcOffset = from_offset, .dstOffset = to_offset, .size = bytes};
    wait_for_earlier(commands);
    commands->device->vk.CmdCopyBuffer(commands->buffer, from->handle, to->handle, 1, &region);
}

void hewn_commands_fill(hewn_commands *commands, const hewn_buffer *buffer, uint64_t offset, uint64_t bytes,
                        uint32_t value)
{
    bytes = (bytes + 3) & ~(uint64_t)3;
    if (offset % 4 != 0)
        hewn_commands_fail(commands, HEWN_INTERNAL, "a fill at byte %llu is not aligned", (unsigned long long)offset);
    if (!check_range(commands, buffer, offset, bytes) || bytes == 0)
        return;
    wait_for_earlier(commands);
    commands->device->vk.CmdFillBuffer(commands->buffer, buffer->handle, offset, bytes, value);
}

uint32_t hewn_commands_mark(hewn_commands *commands)
{
    if (commands->marks == HEWN_MARKS_MAX) {
        hewn_commands_fail(commands, HEWN_INTERNAL, "more than %d marks in one recording", HEWN_MARKS_MAX);
        return HEWN_MARKS_MAX - 1;
    }
    if (commands->queries)
        commands->device->vk.CmdWriteTimestamp(commands->buffer, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT,
                                               commands->queries, commands->marks);
    return commands->marks++;
}

static hewn_result read_times(hewn_commands *commands, double *times, hewn_error *error)
{
    hewn_device *device = commands->device;
    uint64_t ticks[HEWN_MARKS_MAX] = {0};
    if (commands->queries && commands->marks > 0) {
        VkResult result =
            device->vk.GetQueryPoolResults(device->handle, commands->queries, 0, commands->marks, sizeof ticks, ticks,
                                           sizeof *ticks, VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT);
        HEWN_TRY(hewn_vulkan_check(result, "reading time stamps", error));
    }
    const uint64_t mask = device->timestamp_bits >= 64 ? UINT64_MAX : ((uint64_t)1 << device->timestamp_bits) - 1;
    for (uint32_t i = 0; i < commands->marks; i++)
        times[i] = (double)((ticks[i] - ticks[0]) & mask) * device->timestamp_seconds;
    return HEWN_OK;
}

static hewn_result run(hewn_commands *commands, hewn_error *error)
{
    hewn_device *device = commands->device;
    const VkMemoryBarrier to_host = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                                     .srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT,
                                     .dstAccessMask = VK_ACCESS_HOST_READ_BIT};
    if (commands->wrote)
        device->vk.CmdPipelineBarrier(commands->buffer,
                                      VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT,
                                      VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &to_host, 0, NULL, 0, NULL);
    HEWN_TRY(hewn_vulkan_check(device->vk.EndCommandBuffer(commands->buffer), "ending a recording", error));
    HEWN_TRY(
        hewn_vulkan_check(device->vk.ResetFences(device->handle, 1, &commands->fence), "resetting a fence", error));
    const VkSubmitInfo info = {
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1, .pCommandBuffers = &commands->buffer};
    HEWN_TRY(
        hewn_vulkan_check(device->vk.QueueSubmit(device->queue, 1, &info, commands->fence), "submitting work", error));
    VkResult result = device->vk.WaitForFences(device->handle, 1, &commands->fence, VK_TRUE, UINT64_MAX);
    return hewn_vulkan_check(result, "waiting for work", error);
}

hewn_result hewn_commands_submit(hewn_commands **commands_pointer, double *times, hewn_error *error)
{
    hewn_commands *commands = *commands_pointer;
    hewn_result result = commands->failure;
    if (result != HEWN_OK) {
        if (error)
            *error = commands->reason;
    } else {
        result = run(commands, error);
        if (result == HEWN_OK && times)
            result = read_times(commands, times, error);
    }
    hewn_commands_destroy(commands_pointer);
    return result;
}

void hewn_commands_destroy(hewn_commands **commands_pointer)
{
    if (!*commands_pointer)
        return;
    /* The pool is emptied by the next recording, or goes with the device. */
    (*commands_pointer)->open = false;
    *commands_pointer = NULL;
}
