#include "gpu/vulkan.h"

#include "base/error.h"

const char *hewn_vulkan_result_name(VkResult result)
{
#define CASE(name)                                                                                                     \
    case name: return #name
    switch ((int)result) {
        CASE(VK_SUCCESS);
        CASE(VK_NOT_READY);
        CASE(VK_TIMEOUT);
        CASE(VK_INCOMPLETE);
        CASE(VK_ERROR_OUT_OF_HOST_MEMORY);
        CASE(VK_ERROR_OUT_OF_DEVICE_MEMORY);
        CASE(VK_ERROR_INITIALIZATION_FAILED);
        CASE(VK_ERROR_DEVICE_LOST);
        CASE(VK_ERROR_MEMORY_MAP_FAILED);
        CASE(VK_ERROR_LAYER_NOT_PRESENT);
        CASE(VK_ERROR_EXTENSION_NOT_PRESENT);
        CASE(VK_ERROR_FEATURE_NOT_PRESENT);
        CASE(VK_ERROR_INCOMPATIBLE_DRIVER);
        CASE(VK_ERROR_TOO_MANY_OBJECTS);
        CASE(VK_ERROR_FRAGMENTED_POOL);
        CASE(VK_ERROR_OUT_OF_POOL_MEMORY);
        CASE(VK_ERROR_INVALID_OPAQUE_CAPTURE_ADDRESS);
        CASE(VK_ERROR_INVALID_SHADER_NV);
    default: return "an unknown VkResult";
    }
#undef CASE
}

hewn_result hewn_vulkan_check(VkResult result, const char *doing, hewn_error *error)
{
    if (result >= 0)
        return HEWN_OK;
    const char *name = hewn_vulkan_result_name(result);
    switch ((int)result) {
    case VK_ERROR_DEVICE_LOST: return hewn_fail(error, HEWN_DEVICE_LOST, "the device was lost while %s", doing);
    case VK_ERROR_OUT_OF_HOST_MEMORY: return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of host memory while %s", doing);
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
    case VK_ERROR_TOO_MANY_OBJECTS:
    case VK_ERROR_FRAGMENTED_POOL:
    case VK_ERROR_OUT_OF_POOL_MEMORY:
    case VK_ERROR_MEMORY_MAP_FAILED:
        return hewn_fail(error, HEWN_OUT_OF_DEVICE_MEMORY, "out of device memory while %s (%s)", doing, name);
    default: return hewn_fail(error, HEWN_INTERNAL, "the driver refused while %s: %s (%d)", doing, name, (int)result);
    }
}
