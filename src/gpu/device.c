#include "gpu/device.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "gpu/ahead.h"

hewn_result hewn_device_list(hewn_device_info **infos, size_t *count, hewn_error *error)
{
    *infos = NULL;
    *count = 0;
    hewn_instance instance;
    HEWN_TRY(hewn_instance_open(NULL, &instance, error));
    VkPhysicalDevice *handles;
    hewn_result result = hewn_physical_list(&instance, &handles, infos, count, error);
    hewn_free(handles);
    hewn_instance_close(&instance);
    return result;
}

void hewn_device_list_free(hewn_device_info **infos)
{
    hewn_free(*infos);
    *infos = NULL;
}

static bool contains(const char *text, const char *part)
{
    size_t length = strlen(part);
    for (; *text; text++)
        if (strncasecmp(text, part, length) == 0)
            return true;
    return false;
}

/* "0 (llvmpipe), 1 (...)": what an error says that there is. */
static void print_names(const hewn_device_info *infos, size_t count, char *out, size_t size)
{
    size_t length = 0;
    out[0] = '\0';
    for (size_t i = 0; i < count && length + 1 < size; i++) {
        int printed = snprintf(out + length, size - length, "%s%u (%s)", i ? ", " : "", infos[i].index, infos[i].name);
        length += printed > 0 ? (size_t)printed : 0;
    }
}

static hewn_result find_choice(const char *choice, const hewn_device_info *infos, size_t count, size_t *out,
                               hewn_error *error)
{
    char *end;
    unsigned long index = strtoul(choice, &end, 10);
    if (isdigit((unsigned char)choice[0]) && *end == '\0' && index < count) {
        *out = index;
        return HEWN_OK;
    }
    for (size_t i = 0; i < count; i++)
        if (contains(infos[i].name, choice)) {
            *out = i;
            return HEWN_OK;
        }
    char names[512];
    print_names(infos, count, names, sizeof names);
    return hewn_fail(error, HEWN_NO_DEVICE, "no Vulkan device matches '%.64s'; there is %s", choice, names);
}

static hewn_result choose(const char *choice, const hewn_device_info *infos, size_t count, size_t *out,
                          hewn_error *error)
{
    if (count == 0)
        return hewn_fail(error, HEWN_NO_DEVICE,
                         "there is a Vulkan loader but no device; on Debian a software device comes with: apt-get "
                         "install mesa-vulkan-drivers");
    if (!choice || !*choice)
        choice = getenv("HEWN_DEVICE");
    if (choice && *choice) {
        HEWN_TRY(find_choice(choice, infos, count, out, error));
    } else {
        *out = 0;
        while (*out < count && !infos[*out].usable)
            ++*out;
        if (*out == count)
            *out = 0;
    }
    if (!infos[*out].usable)
        return hewn_fail(error, HEWN_MISSING_FEATURE, "device %zu (%s) lacks %s", *out, infos[*out].name,
                         infos[*out].missing);
    return HEWN_OK;
}

static void find_queue(hewn_device *device)
{
    VkQueueFamilyProperties families[32];
    uint32_t count = 32;
    device->instance.vk.GetPhysicalDeviceQueueFamilyProperties(device->physical, &count, families);
    for (uint32_t i = count; i-- > 0;)
        if (families[i].queueFlags & VK_QUEUE_COMPUTE_BIT) {
            device->queue_family = i;
            device->timestamp_bits = families[i].timestampValidBits;
        }
}

static void read_limits(hewn_device *device)
{
    VkPhysicalDeviceIDProperties id = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ID_PROPERTIES};
    VkPhysicalDeviceDriverProperties driver = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES,
                                               .pNext = &id};
    VkPhysicalDeviceSubgroupProperties subgroup = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES,
                                                   .pNext = &driver};
    VkPhysicalDeviceProperties2 all = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &subgroup};
    device->instance.vk.GetPhysicalDeviceProperties2(device->physical, &all);
    const VkPhysicalDeviceLimits *limits = &all.properties.limits;
    memcpy(device->max_group_count, limits->maxComputeWorkGroupCount, sizeof device->max_group_count);
    device->max_uniform_range = limits->maxUniformBufferRange;
    const VkSubgroupFeatureFlags wanted = VK_SUBGROUP_FEATURE_VOTE_BIT | VK_SUBGROUP_FEATURE_SHUFFLE_BIT;
    if ((subgroup.supportedStages & VK_SHADER_STAGE_COMPUTE_BIT) && (subgroup.supportedOperations & wanted) == wanted)
        device->subgroup_size = subgroup.subgroupSize;
    device->compiles_late = driver.driverID == VK_DRIVER_ID_MESA_LLVMPIPE;
    device->timestamp_seconds = (double)limits->timestampPeriod * 1e-9;
    device->instance.vk.GetPhysicalDeviceMemoryProperties(device->physical, &device->memory);
    hewn_hash key = hewn_hash_begin();
    key = hewn_hash_bytes(key, id.deviceUUID, sizeof id.deviceUUID);
    key = hewn_hash_bytes(key, id.driverUUID, sizeof id.driverUUID);
    key = hewn_hash_bytes(key, all.properties.pipelineCacheUUID, sizeof all.properties.pipelineCacheUUID);
    key = hewn_hash_bytes(key, &all.properties.driverVersion, sizeof all.properties.driverVersion);
    device->pipeline_key = hewn_hash_bytes(key, &all.properties.deviceID, sizeof all.properties.deviceID);
    VkPipelineCacheHeaderVersionOne *header = &device->pipeline_header;
    header->headerSize = sizeof *header;
    header->headerVersion = VK_PIPELINE_CACHE_HEADER_VERSION_ONE;
    header->vendorID = all.properties.vendorID;
    header->deviceID = all.properties.deviceID;
    memcpy(header->pipelineCacheUUID, all.properties.pipelineCacheUUID, sizeof header->pipelineCacheUUID);
}

static hewn_result fill_table(hewn_device *device, hewn_error *error)
{
    PFN_vkGetDeviceProcAddr find = device->instance.vk.GetDeviceProcAddr;
#define LOAD(entry_name)                                                                                               \
    device->vk.entry_name = (PFN_vk##entry_name)find(device->handle, "vk" #entry_name);                                \
    if (!device->vk.entry_name)                                                                                        \
        return hewn_fail(error, HEWN_MISSING_FEATURE, "device %s lacks vk" #entry_name, device->info.name);
    HEWN_VULKAN_DEVICE_FUNCTIONS(LOAD)
#undef LOAD
    return HEWN_OK;
}

static hewn_result create_handle(hewn_device *device, hewn_error *error)
{
    const float priority = 1.0f;
    const VkDeviceQueueCreateInfo queue = {.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                           .queueFamilyIndex = device->queue_family,
                                           .queueCount = 1,
                                           .pQueuePriorities = &priority};
    VkPhysicalDeviceVulkan12Features features = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES,
                                                 .bufferDeviceAddress = VK_TRUE,
                                                 .scalarBlockLayout = VK_TRUE};
    const VkDeviceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                     .pNext = &features,
                                     .queueCreateInfoCount = 1,
                                     .pQueueCreateInfos = &queue};
    VkResult result = device->instance.vk.CreateDevice(device->physical, &info, NULL, &device->handle);
    HEWN_TRY(hewn_vulkan_check(result, "opening the device", error));
    HEWN_TRY(fill_table(device, error));
    device->opened = true;
    device->vk.GetDeviceQueue(device->handle, device->queue_family, 0, &device->queue);
    return HEWN_OK;
}

hewn_result hewn_device_open_second(const hewn_device *device, hewn_device *out, hewn_error *error)
{
    *out = (hewn_device){.instance = device->instance,
                         .info = device->info,
                         .physical = device->physical,
                         .queue_family = device->queue_family,
                         .max_uniform_range = device->max_uniform_range,
                         .memory = device->memory};
    HEWN_TRY(create_handle(out, error));
    return hewn_programs_describe(out, error);
}

void hewn_device_close_second(hewn_device *second)
{
    if (second->uniform_layout)
        second->vk.DestroyDescriptorSetLayout(second->handle, second->uniform_layout, NULL);
    if (second->handle && second->vk.DestroyDevice)
        second->vk.DestroyDevice(second->handle, NULL);
}

static hewn_result open_physical(hewn_device *device, const char *choice, hewn_error *error)
{
    VkPhysicalDevice *handles;
    hewn_device_info *infos;
    size_t count, chosen = 0;
    HEWN_TRY(hewn_physical_list(&device->instance, &handles, &infos, &count, error));
    hewn_result result = choose(choice, infos, count, &chosen, error);
    if (result == HEWN_OK) {
        device->physical = handles[chosen];
        device->info = infos[chosen];
    }
    hewn_free(handles);
    hewn_free(infos);
    return result;
}

static hewn_result open_all(hewn_device *device, const hewn_device_desc *desc, hewn_error *error)
{
    HEWN_TRY(hewn_instance_open(desc->validation ? &device->messages : NULL, &device->instance, error));
    HEWN_TRY(open_physical(device, desc->choice, error));
    find_queue(device);
    read_limits(device);
    HEWN_TRY(create_handle(device, error));
    HEWN_TRY(hewn_cache_open(&device->cache, error));
    HEWN_TRY(hewn_programs_setup(device, error));
    return hewn_commands_setup(device, error);
}

hewn_result hewn_device_create(const hewn_device_desc *desc, hewn_device **out, hewn_error *error)
{
    *out = NULL;
    const hewn_device_desc defaults = {0};
    if (!desc)
        desc = &defaults;
    hewn_device *device = hewn_alloc_zero(1, sizeof *device);
    if (!device)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory opening a device");
    atomic_init(&device->messages.count, 0);
    device->messages.report = desc->message;
    device->messages.user = desc->user;
    hewn_result result = open_all(device, desc, error);
    if (result != HEWN_OK)
        hewn_device_destroy(&device);
    *out = device;
    return result;
}

void hewn_device_destroy(hewn_device **device_pointer)
{
    hewn_device *device = *device_pointer;
    if (!device)
        return;
    if (device->opened) {
        device->vk.DeviceWaitIdle(device->handle);
        hewn_ahead_stop(device);
        hewn_commands_teardown(device);
        hewn_programs_teardown(device);
    }
    if (device->handle && device->vk.DestroyDevice)
        device->vk.DestroyDevice(device->handle, NULL);
    hewn_cache_close(&device->cache);
    hewn_instance_close(&device->instance);
    hewn_free(device);
    *device_pointer = NULL;
}

const hewn_device_info *hewn_device_get_info(const hewn_device *device)
{
    return &device->info;
}

uint64_t hewn_device_message_count(const hewn_device *device)
{
    return atomic_load(&device->messages.count);
}

uint64_t hewn_device_peak_bytes(const hewn_device *device)
{
    return device->peak_bytes;
}
