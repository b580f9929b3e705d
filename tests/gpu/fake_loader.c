/* A Vulkan loader for tests: the real one, made to tell lies. HEWN_TEST_FAKE says which, a comma-separated list:
 * "many" five devices of all kinds in an unhelpful order, "old" a device of Vulkan 1.1, "bare" one without the features
 * that Hewn needs, "none" no device at all, "aged" a loader of Vulkan 1.1. */
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define VK_NO_PROTOTYPES
#include <vulkan/vulkan.h>

__attribute__((visibility("default"))) VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL
vkGetInstanceProcAddr(VkInstance instance, const char *name);

static const VkPhysicalDeviceType kinds[] = {
    VK_PHYSICAL_DEVICE_TYPE_CPU,   VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU,    VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU,
    VK_PHYSICAL_DEVICE_TYPE_OTHER, VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU, VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU};
enum { MANY = sizeof kinds / sizeof *kinds };
static unsigned described;

static PFN_vkGetInstanceProcAddr real(void)
{
    void *library = dlopen("libvulkan.so.1", RTLD_NOW | RTLD_LOCAL);
    PFN_vkGetInstanceProcAddr entry = NULL;
    void *symbol = library ? dlsym(library, "vkGetInstanceProcAddr") : NULL;
    memcpy(&entry, &symbol, sizeof entry);
    return entry;
}

static int asked(const char *lie)
{
    const char *lies = getenv("HEWN_TEST_FAKE");
    return lies && strstr(lies, lie) != NULL;
}

/* The instance does not reach these calls, so they find the real functions through the first one created. */
static VkInstance last_instance;

static PFN_vkVoidFunction real_of(const char *name)
{
    return real()(last_instance, name);
}

static VKAPI_ATTR VkResult VKAPI_CALL create_instance(const VkInstanceCreateInfo *info,
                                                      const VkAllocationCallbacks *allocator, VkInstance *out)
{
    described = 0;
    VkResult result = ((PFN_vkCreateInstance)real()(NULL, "vkCreateInstance"))(info, allocator, out);
    last_instance = result == VK_SUCCESS ? *out : VK_NULL_HANDLE;
    return result;
}

static VKAPI_ATTR VkResult VKAPI_CALL enumerate(VkInstance instance, uint32_t *count, VkPhysicalDevice *out)
{
    PFN_vkEnumeratePhysicalDevices call = (PFN_vkEnumeratePhysicalDevices)real_of("vkEnumeratePhysicalDevices");
    uint32_t wanted = asked("none") ? 0 : asked("many") ? MANY : 1;
    if (out && wanted > 0) {
        VkPhysicalDevice all[8];
        uint32_t found = 8;
        VkResult result = call(instance, &found, all);
        if (result < 0 || found == 0)
            return result;
        for (uint32_t i = 0; i < wanted; i++)
            out[i] = all[0];
    }
    *count = wanted;
    return VK_SUCCESS;
}

static VKAPI_ATTR void VKAPI_CALL properties(VkPhysicalDevice physical, VkPhysicalDeviceProperties *out)
{
    ((PFN_vkGetPhysicalDeviceProperties)real_of("vkGetPhysicalDeviceProperties"))(physical, out);
    if (asked("old"))
        out->apiVersion = VK_API_VERSION_1_1;
    if (asked("many")) {
        out->deviceType = kinds[described % MANY];
        snprintf(out->deviceName, sizeof out->deviceName, "Fake %u", described++ % MANY);
    }
}

static VKAPI_ATTR void VKAPI_CALL features(VkPhysicalDevice physical, VkPhysicalDeviceFeatures2 *out)
{
    ((PFN_vkGetPhysicalDeviceFeatures2)real_of("vkGetPhysicalDeviceFeatures2"))(physical, out);
    if (asked("bare"))
        for (VkBaseOutStructure *at = out->pNext; at; at = at->pNext)
            if (at->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES) {
                ((VkPhysicalDeviceVulkan12Features *)at)->bufferDeviceAddress = VK_FALSE;
                ((VkPhysicalDeviceVulkan12Features *)at)->scalarBlockLayout = VK_FALSE;
            }
}

static VKAPI_ATTR VkResult VKAPI_CALL version(uint32_t *out)
{
    *out = asked("aged") ? VK_API_VERSION_1_1 : VK_API_VERSION_1_3;
    return VK_SUCCESS;
}

PFN_vkVoidFunction vkGetInstanceProcAddr(VkInstance instance, const char *name)
{
    if (strcmp(name, "vkCreateInstance") == 0)
        return (PFN_vkVoidFunction)create_instance;
    if (strcmp(name, "vkEnumeratePhysicalDevices") == 0)
        return (PFN_vkVoidFunction)enumerate;
    if (strcmp(name, "vkGetPhysicalDeviceProperties") == 0)
        return (PFN_vkVoidFunction)properties;
    if (strcmp(name, "vkGetPhysicalDeviceFeatures2") == 0)
        return (PFN_vkVoidFunction)features;
    if (strcmp(name, "vkEnumerateInstanceVersion") == 0)
        return (PFN_vkVoidFunction)version;
    PFN_vkGetInstanceProcAddr entry = real();
    return entry ? entry(instance, name) : NULL;
}
