/* What the machine's physical devices say of themselves, and their order. */
#include <stdio.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "gpu/device.h"

static hewn_device_kind kind_of(VkPhysicalDeviceType type)
{
    switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU: return HEWN_DEVICE_DISCRETE;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU: return HEWN_DEVICE_INTEGRATED;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU: return HEWN_DEVICE_VIRTUAL;
    case VK_PHYSICAL_DEVICE_TYPE_CPU: return HEWN_DEVICE_CPU;
    default: return HEWN_DEVICE_OTHER;
    }
}

static void note_missing(hewn_device_info *info, const char *name)
{
    size_t length = strlen(info->missing);
    snprintf(info->missing + length, sizeof info->missing - length, "%s%s", length ? ", " : "", name);
}

static bool has_compute_queue(const hewn_instance *instance, VkPhysicalDevice physical)
{
    uint32_t count = 0;
    instance->vk.GetPhysicalDeviceQueueFamilyProperties(physical, &count, NULL);
    VkQueueFamilyProperties families[32];
    count = count < 32 ? count : 32;
    instance->vk.GetPhysicalDeviceQueueFamilyProperties(physical, &count, families);
    for (uint32_t i = 0; i < count; i++)
        if (families[i].queueFlags & VK_QUEUE_COMPUTE_BIT)
            return true;
    return false;
}

static void find_missing(const hewn_instance *instance, VkPhysicalDevice physical, hewn_device_info *info)
{
    VkPhysicalDeviceVulkan12Features wanted = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
    VkPhysicalDeviceFeatures2 features = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, .pNext = &wanted};
    instance->vk.GetPhysicalDeviceFeatures2(physical, &features);
    if (!has_compute_queue(instance, physical))
        note_missing(info, "a compute queue");
    if (!wanted.bufferDeviceAddress)
        note_missing(info, "bufferDeviceAddress");
    if (!wanted.scalarBlockLayout)
        note_missing(info, "scalarBlockLayout");
}

static void describe_fully(const hewn_instance *instance, VkPhysicalDevice physical, hewn_device_info *info)
{
    VkPhysicalDeviceDriverProperties driver = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
    VkPhysicalDeviceSubgroupProperties subgroup = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES,
                                                   .pNext = &driver};
    VkPhysicalDeviceMaintenance3Properties maintenance = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES, .pNext = &subgroup};
    VkPhysicalDeviceProperties2 all = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &maintenance};
    instance->vk.GetPhysicalDeviceProperties2(physical, &all);
    snprintf(info->driver, sizeof info->driver, "%.120s %.120s", driver.driverName, driver.driverInfo);
    info->subgroup_size = subgroup.subgroupSize;
    info->max_allocation = maintenance.maxMemoryAllocationSize;
}

static void describe(const hewn_instance *instance, VkPhysicalDevice physical, hewn_device_info *info)
{
    VkPhysicalDeviceProperties properties;
    instance->vk.GetPhysicalDeviceProperties(physical, &properties);
    snprintf(info->name, sizeof info->name, "%s", properties.deviceName);
    info->kind = kind_of(properties.deviceType);
    info->api_version[0] = VK_API_VERSION_MAJOR(properties.apiVersion);
    info->api_version[1] = VK_API_VERSION_MINOR(properties.apiVersion);
    info->api_version[2] = VK_API_VERSION_PATCH(properties.apiVersion);
    info->max_workgroup_count = properties.limits.maxComputeWorkGroupCount[0];
    info->max_workgroup_invocations = properties.limits.maxComputeWorkGroupInvocations;
    info->max_shared_memory = properties.limits.maxComputeSharedMemorySize;
    info->max_storage_buffer_range = properties.limits.maxStorageBufferRange;
    VkPhysicalDeviceMemoryProperties memory;
    instance->vk.GetPhysicalDeviceMemoryProperties(physical, &memory);
    for (uint32_t i = 0; i < memory.memoryHeapCount; i++) {
        VkMemoryHeap heap = memory.memoryHeaps[i];
        if ((heap.flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT) && heap.size > info->memory)
            info->memory = heap.size;
    }
    if (properties.apiVersion < VK_API_VERSION_1_2) {
        note_missing(info, "Vulkan 1.2");
    } else {
        describe_fully(instance, physical, info);
        find_missing(instance, physical, info);
    }
    info->usable = info->missing[0] == '\0';
}

/* Insertion keeps the loader's order among devices of one kind. */
static void sort_by_kind(VkPhysicalDevice *handles, hewn_device_info *infos, size_t count)
{
    for (size_t i = 1; i < count; i++)
        for (size_t j = i; j > 0 && infos[j].kind < infos[j - 1].kind; j--) {
            VkPhysicalDevice handle = handles[j];
            handles[j] = handles[j - 1];
            handles[j - 1] = handle;
            hewn_device_info info = infos[j];
            infos[j] = infos[j - 1];
            infos[j - 1] = info;
        }
    for (size_t i = 0; i < count; i++)
        infos[i].index = (uint32_t)i;
}

/* Some loaders report a machine without devices as a failure to initialise. */
static hewn_result count_devices(const hewn_instance *instance, uint32_t *count, hewn_error *error)
{
    *count = 0;
    if (instance->driverless)
        return HEWN_OK;
    VkResult result = instance->vk.EnumeratePhysicalDevices(instance->handle, count, NULL);
    if (result != VK_ERROR_INITIALIZATION_FAILED)
        return hewn_vulkan_check(result, "listing the devices", error);
    *count = 0;
    return HEWN_OK;
}

hewn_result hewn_physical_list(const hewn_instance *instance, VkPhysicalDevice **handles, hewn_device_info **infos,
                               size_t *count, hewn_error *error)
{
    *handles = NULL;
    *infos = NULL;
    *count = 0;
    uint32_t found;
    HEWN_TRY(count_devices(instance, &found, error));
    if (found == 0)
        return HEWN_OK;
    VkPhysicalDevice *devices = hewn_alloc_zero(found, sizeof(VkPhysicalDevice));
    hewn_device_info *described = hewn_alloc_zero(found, sizeof(hewn_device_info));
    hewn_result result = HEWN_OUT_OF_MEMORY;
    if (devices && described)
        result = hewn_vulkan_check(instance->vk.EnumeratePhysicalDevices(instance->handle, &found, devices),
                                   "listing the devices", error);
    else
        hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory listing %u devices", found);
    if (result != HEWN_OK || !devices || !described) {
        hewn_free(devices);
        hewn_free(described);
        return result;
    }
    for (uint32_t i = 0; i < found; i++)
        describe(instance, devices[i], &described[i]);
    sort_by_kind(devices, described, found);
    *handles = devices;
    *infos = described;
    *count = found;
    return HEWN_OK;
}
