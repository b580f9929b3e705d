/* The Vulkan loader, opened at run time, and one instance of it. Private to this room. */
#ifndef HEWN_SRC_GPU_INSTANCE_H
#define HEWN_SRC_GPU_INSTANCE_H

#include <stdatomic.h>

#include "gpu/vulkan.h"
#include "hewn/device.h"

/* Where messages of the validation layer go. Must not move while the instance lives. */
typedef struct hewn_messages {
    atomic_uint_fast64_t count;
    void (*report)(void *user, const char *text);
    void *user;
} hewn_messages;

typedef struct hewn_instance {
    void *library; /* from dlopen */
    VkInstance handle;
    VkDebugUtilsMessengerEXT messenger;
    hewn_vulkan_instance_table vk;
    bool driverless; /* the loader found no driver at all; there is no instance then */
} hewn_instance;

/* Opens the loader ("libvulkan.so.1", or what the environment variable HEWN_VULKAN_LOADER names) and creates a Vulkan
 * 1.2 instance, with the Khronos validation layer where `messages` is not NULL. HEWN_NO_LOADER, HEWN_NO_DEVICE (the
 * layer is not installed). A loader without any driver is HEWN_OK with `driverless` set. */
hewn_result hewn_instance_open(hewn_messages *messages, hewn_instance *out, hewn_error *error);

/* Closes what is open and zeroes the struct. */
void hewn_instance_close(hewn_instance *instance);

#endif
