#include "gpu/buffer.h"

#include "base/error.h"
#include "gpu/device.h"

_Static_assert(sizeof(VkBuffer) == sizeof(void *), "Vulkan's handles fit the pointers of hewn_buffer");

/* The first memory type of `allowed` that has all `wanted` properties; UINT32_MAX for none. */
static uint32_t find_type(const hewn_device *device, uint32_t allowed, VkMemoryPropertyFlags wanted)
{
    for (uint32_t i = 0; i < device->memory.memoryTypeCount; i++)
        if ((allowed & 1u << i) && (device->memory.memoryTypes[i].propertyFlags & wanted) == wanted)
            return i;
    return UINT32_MAX;
}

/* Tries sets of properties, best first. A device that shares the host's memory lets the host reach everything. */
static uint32_t choose_type(const hewn_device *device, uint32_t allowed, hewn_buffer_use use)
{
    enum { LOCAL = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, CACHED = VK_MEMORY_PROPERTY_HOST_CACHED_BIT };
    const VkMemoryPropertyFlags host = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    const bool shared = device->info.kind == HEWN_DEVICE_CPU || device->info.kind == HEWN_DEVICE_INTEGRATED;
    const VkMemoryPropertyFlags device_sets[] = {shared ? LOCAL | host | CACHED : LOCAL, shared ? LOCAL | host : LOCAL,
                                                 LOCAL, 0};
    const VkMemoryPropertyFlags upload_sets[] = {host};
    const VkMemoryPropertyFlags readback_sets[] = {host | CACHED, host};
    const VkMemoryPropertyFlags *sets = device_sets;
    size_t count = sizeof device_sets / sizeof *device_sets;
    if (use == HEWN_BUFFER_UPLOAD) {
        sets = upload_sets;
        count = 1;
    } else if (use == HEWN_BUFFER_READBACK) {
        sets = readback_sets;
        count = 2;
    }
    for (size_t i = 0; i < count; i++) {
        uint32_t type = find_type(device, allowed, sets[i]);
        if (type != UINT32_MAX)
            return type;
    }
    return UINT32_MAX;
}

static hewn_result create_handle(hewn_device *device, uint64_t size, hewn_buffer *buffer, hewn_error *error)
{
    VkBufferUsageFlags usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
                               VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT |
                               VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT;
    const VkBufferCreateInfo info = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                     .size = size,
                                     .usage = usage,
                                     .sharingMode = VK_SHARING_MODE_EXCLUSIVE};
    VkBuffer handle = VK_NULL_HANDLE;
    HEWN_TRY(
        hewn_vulkan_check(device->vk.CreateBuffer(device->handle, &info, NULL, &handle), "creating a buffer", error));
    buffer->handle = handle;
    return HEWN_OK;
}

static hewn_result check_limit(hewn_device *device, const char *what, uint64_t size, hewn_error *error)
{
    if (device->most_bytes == 0 || device->bytes + size <= device->most_bytes)
        return HEWN_OK;
    device->refused_bytes = device->bytes + size;
    return hewn_fail(error, HEWN_OUT_OF_DEVICE_MEMORY,
                     "%llu bytes for %s, with %llu bytes in use already, are more than the %llu that are allowed",
                     (unsigned long long)size, what, (unsigned long long)device->bytes,
                     (unsigned long long)device->most_bytes);
}

static hewn_result allocate(hewn_device *device, const char *what, hewn_buffer_use use, hewn_buffer *buffer,
                            hewn_error *error)
{
    VkMemoryRequirements needs;
    device->vk.GetBufferMemoryRequirements(device->handle, buffer->handle, &needs);
    HEWN_TRY(check_limit(device, what, needs.size, error)); /* perhaps a little more than was asked for */
    if (needs.size > device->info.max_allocation)
        return hewn_fail(error, HEWN_LIMIT, "%llu bytes for %s are more than the device allocates at once (%llu)",
                         (unsigned long long)needs.size, what, (unsigned long long)device->info.max_allocation);
    uint32_t type = choose_type(device, needs.memoryTypeBits, use);
    if (type == UINT32_MAX)
        return hewn_fail(error, HEWN_OUT_OF_DEVICE_MEMORY, "the device has no kind of memory that suits %s", what);
    const VkMemoryAllocateFlagsInfo flags = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO,
                                             .flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT};
    const VkMemoryDedicatedAllocateInfo dedicated = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_DEDICATED_ALLOCATE_INFO, .pNext = &flags, .buffer = buffer->handle};
    const VkMemoryAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                       .pNext = &dedicated,
                                       .allocationSize = needs.size,
                                       .memoryTypeIndex = type};
    VkDeviceMemory memory = VK_NULL_HANDLE;
    VkResult result = device->vk.AllocateMemory(device->handle, &info, NULL, &memory);
    if (result == VK_ERROR_OUT_OF_DEVICE_MEMORY || result == VK_ERROR_TOO_MANY_OBJECTS)
        return hewn_fail(error, HEWN_OUT_OF_DEVICE_MEMORY,
                         "out of device memory: %llu bytes for %s, with %llu bytes in use already",
                         (unsigned long long)needs.size, what, (unsigned long long)device->bytes);
    HEWN_TRY(hewn_vulkan_check(result, "allocating device memory", error));
    buffer->memory = memory;
    buffer->allocated = needs.size;
    device->bytes += needs.size;
    if (device->bytes > device->peak_bytes)
        device->peak_bytes = device->bytes;
    result = device->vk.BindBufferMemory(device->handle, buffer->handle, memory, 0);
    HEWN_TRY(hewn_vulkan_check(result, "binding device memory", error));
    /* Mapped for good: unmapping costs more than it saves. */
    const VkMemoryPropertyFlags mappable = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    if (use == HEWN_BUFFER_DEVICE && device->info.kind == HEWN_DEVICE_DISCRETE)
        return HEWN_OK;
    if ((device->memory.memoryTypes[type].propertyFlags & mappable) != mappable)
        return HEWN_OK;
    result = device->vk.MapMemory(device->handle, memory, 0, VK_WHOLE_SIZE, 0, &buffer->mapped);
    return hewn_vulkan_check(result, "mapping device memory", error);
}

hewn_result hewn_buffer_create(hewn_device *device, const char *what, uint64_t size, hewn_buffer_use use,
                               hewn_buffer *out, hewn_error *error)
{
    *out = (hewn_buffer){0};
    if (size > device->info.max_allocation)
        return hewn_fail(error, HEWN_LIMIT, "%llu bytes for %s are more than the device allocates at once (%llu)",
                         (unsigned long long)size, what, (unsigned long long)device->info.max_allocation);
    /* Whole words, so that fills reach the end and shaders may read the last word. */
    uint64_t padded = size == 0 ? 4 : (size + 3) & ~(uint64_t)3;
    hewn_buffer buffer = {.size = size == 0 ? 4 : size};
    hewn_result result = create_handle(device, padded, &buffer, error);
    if (result == HEWN_OK)
        result = allocate(device, what, use, &buffer, error);
    if (result != HEWN_OK) {
        hewn_buffer_destroy(device, &buffer);
        return result;
    }
    const VkBufferDeviceAddressInfo info = {.sType = VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO,
                                            .buffer = buffer.handle};
    buffer.address = device->vk.GetBufferDeviceAddress(device->handle, &info);
    *out = buffer;
    return HEWN_OK;
}

void hewn_buffer_destroy(hewn_device *device, hewn_buffer *buffer)
{
    if (buffer->handle)
        device->vk.DestroyBuffer(device->handle, buffer->handle, NULL);
    if (buffer->memory)
        device->vk.FreeMemory(device->handle, buffer->memory, NULL);
    device->bytes -= buffer->allocated;
    *buffer = (hewn_buffer){0};
}
