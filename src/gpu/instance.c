#include "gpu/instance.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"

static const char validation_layer[] = "VK_LAYER_KHRONOS_validation";

/* dlsym gives an object pointer; POSIX promises that its bits are those of the function pointer. */
static PFN_vkGetInstanceProcAddr find_entry(void *library)
{
    void *symbol = dlsym(library, "vkGetInstanceProcAddr");
    PFN_vkGetInstanceProcAddr entry;
    _Static_assert(sizeof entry == sizeof symbol, "function pointers are as wide as object pointers");
    memcpy(&entry, &symbol, sizeof entry);
    return entry;
}

/* NULL after a failure, which is HEWN_NO_LOADER. */
static PFN_vkGetInstanceProcAddr open_library(hewn_instance *instance, hewn_error *error)
{
    const char *named = secure_getenv("HEWN_VULKAN_LOADER");
    const char *name = named && *named ? named : "libvulkan.so.1";
    instance->library = dlopen(name, RTLD_NOW | RTLD_LOCAL);
    if (!instance->library) {
        hewn_fail(error, HEWN_NO_LOADER,
                  "no Vulkan loader on this machine (%s could not be opened); on Debian: apt-get install "
                  "libvulkan1 mesa-vulkan-drivers",
                  name);
        return NULL;
    }
    PFN_vkGetInstanceProcAddr entry = find_entry(instance->library);
    if (!entry) {
        hewn_fail(error, HEWN_NO_LOADER, "%s is no Vulkan loader (it lacks vkGetInstanceProcAddr)", name);
        return NULL;
    }
    /* A loader of Vulkan 1.0 has no vkEnumerateInstanceVersion and refuses every later apiVersion. */
    PFN_vkEnumerateInstanceVersion version_of =
        (PFN_vkEnumerateInstanceVersion)entry(NULL, "vkEnumerateInstanceVersion");
    uint32_t version = 0;
    if (!version_of || version_of(&version) != VK_SUCCESS || version < VK_API_VERSION_1_2) {
        hewn_fail(error, HEWN_NO_LOADER, "the Vulkan loader %s is older than Vulkan 1.2", name);
        return NULL;
    }
    return entry;
}

static bool has_layer(PFN_vkGetInstanceProcAddr entry)
{
    PFN_vkEnumerateInstanceLayerProperties enumerate =
        (PFN_vkEnumerateInstanceLayerProperties)entry(NULL, "vkEnumerateInstanceLayerProperties");
    uint32_t count = 0;
    if (!enumerate || enumerate(&count, NULL) < 0)
        return false;
    VkLayerProperties *layers = hewn_alloc_zero(count, sizeof *layers);
    bool found = false;
    if (layers && enumerate(&count, layers) >= 0)
        for (uint32_t i = 0; i < count; i++)
            found |= strcmp(layers[i].layerName, validation_layer) == 0;
    hewn_free(layers);
    return found;
}

static VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                                 VkDebugUtilsMessageTypeFlagsEXT types,
                                                 const VkDebugUtilsMessengerCallbackDataEXT *data, void *user)
{
    (void)severity;
    (void)types;
    hewn_messages *messages = user;
    atomic_fetch_add(&messages->count, 1);
    const char *text = data->pMessage ? data->pMessage : "(a message without text)";
    if (messages->report)
        messages->report(messages->user, text);
    else
        fprintf(stderr, "Vulkan validation: %s\n", text);
    return VK_FALSE;
}

/* General messages are the loader's own, mostly about drivers of hardware that is not there: they say nothing about
 * what Hewn does. */
static VkDebugUtilsMessengerCreateInfoEXT messenger_info(hewn_messages *messages)
{
    return (VkDebugUtilsMessengerCreateInfoEXT){
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
        .messageSeverity =
            VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
        .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT,
        .pfnUserCallback = on_message,
        .pUserData = messages,
    };
}

static VkResult create_handle(PFN_vkGetInstanceProcAddr entry, hewn_messages *messages, VkInstance *out)
{
    PFN_vkCreateInstance create = (PFN_vkCreateInstance)entry(NULL, "vkCreateInstance");
    if (!create)
        return VK_ERROR_INITIALIZATION_FAILED;
    const VkApplicationInfo application = {.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                           .pApplicationName = "hewn",
                                           .pEngineName = "hewn",
                                           .apiVersion = VK_API_VERSION_1_2};
    const char *layers[] = {validation_layer};
    const char *extensions[] = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME, VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME};
    /* Missing barriers rarely show on the machine at hand, so the layer looks for them. */
    const VkValidationFeatureEnableEXT enables[] = {VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
    const VkValidationFeaturesEXT features = {.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
                                              .enabledValidationFeatureCount = 1,
                                              .pEnabledValidationFeatures = enables};
    VkDebugUtilsMessengerCreateInfoEXT messenger = messenger_info(messages);
    VkInstanceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO, .pApplicationInfo = &application};
    if (messages) {
        messenger.pNext = &features;
        info.pNext = &messenger;
        info.enabledLayerCount = 1;
        info.ppEnabledLayerNames = layers;
        info.enabledExtensionCount = 2;
        info.ppEnabledExtensionNames = extensions;
    }
    return create(&info, NULL, out);
}

static hewn_result fill_table(hewn_instance *instance, PFN_vkGetInstanceProcAddr entry, hewn_error *error)
{
#define LOAD(name)                                                                                                     \
    instance->vk.name = (PFN_vk##name)entry(instance->handle, "vk" #name);                                             \
    if (!instance->vk.name)                                                                                            \
        return hewn_fail(error, HEWN_NO_LOADER, "the Vulkan loader lacks vk" #name);
    HEWN_VULKAN_INSTANCE_FUNCTIONS(LOAD)
#undef LOAD
    return HEWN_OK;
}

static hewn_result create_messenger(hewn_instance *instance, PFN_vkGetInstanceProcAddr entry, hewn_messages *messages,
                                    hewn_error *error)
{
    instance->vk.CreateDebugUtilsMessengerEXT =
        (PFN_vkCreateDebugUtilsMessengerEXT)entry(instance->handle, "vkCreateDebugUtilsMessengerEXT");
    instance->vk.DestroyDebugUtilsMessengerEXT =
        (PFN_vkDestroyDebugUtilsMessengerEXT)entry(instance->handle, "vkDestroyDebugUtilsMessengerEXT");
    if (!instance->vk.CreateDebugUtilsMessengerEXT || !instance->vk.DestroyDebugUtilsMessengerEXT)
        return hewn_fail(error, HEWN_NO_DEVICE, "the validation layer lacks VK_EXT_debug_utils");
    VkDebugUtilsMessengerCreateInfoEXT info = messenger_info(messages);
    return hewn_vulkan_check(
        instance->vk.CreateDebugUtilsMessengerEXT(instance->handle, &info, NULL, &instance->messenger),
        "listening to the validation layer", error);
}

static hewn_result open_all(hewn_instance *instance, hewn_messages *messages, hewn_error *error)
{
    PFN_vkGetInstanceProcAddr entry = open_library(instance, error);
    if (!entry)
        return HEWN_NO_LOADER;
    if (messages && !has_layer(entry))
        return hewn_fail(error, HEWN_NO_DEVICE,
                         "the validation layer %s is not installed; on Debian: apt-get install "
                         "vulkan-validationlayers",
                         validation_layer);
    VkResult result = create_handle(entry, messages, &instance->handle);
    if (result == VK_ERROR_INCOMPATIBLE_DRIVER) {
        instance->driverless = true;
        instance->handle = VK_NULL_HANDLE;
        return HEWN_OK;
    }
    HEWN_TRY(hewn_vulkan_check(result, "creating a Vulkan instance", error));
    HEWN_TRY(fill_table(instance, entry, error));
    return messages ? create_messenger(instance, entry, messages, error) : HEWN_OK;
}

hewn_result hewn_instance_open(hewn_messages *messages, hewn_instance *out, hewn_error *error)
{
    *out = (hewn_instance){0};
    hewn_result result = open_all(out, messages, error);
    if (result != HEWN_OK)
        hewn_instance_close(out);
    return result;
}

void hewn_instance_close(hewn_instance *instance)
{
    if (instance->messenger)
        instance->vk.DestroyDebugUtilsMessengerEXT(instance->handle, instance->messenger, NULL);
    if (instance->handle && instance->vk.DestroyInstance)
        instance->vk.DestroyInstance(instance->handle, NULL);
    if (instance->library)
        dlclose(instance->library);
    *instance = (hewn_instance){0};
}
