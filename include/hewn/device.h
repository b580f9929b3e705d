/* Vulkan devices. */
#ifndef HEWN_DEVICE_H
#define HEWN_DEVICE_H

#include "hewn/base.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct hewn_device hewn_device;

typedef enum hewn_device_kind {
    HEWN_DEVICE_DISCRETE,
    HEWN_DEVICE_INTEGRATED,
    HEWN_DEVICE_VIRTUAL,
    HEWN_DEVICE_CPU,
    HEWN_DEVICE_OTHER
} hewn_device_kind;

/* What a device says of itself. Plain data. */
typedef struct hewn_device_info {
    char name[256];
    char driver[256]; /* the driver's name and version */
    hewn_device_kind kind;
    uint32_t index; /* in the order of hewn_device_list; what `--device N` takes */
    uint32_t api_version[3];
    uint32_t subgroup_size;
    uint32_t max_workgroup_count; /* along x */
    uint32_t max_workgroup_invocations;
    uint32_t max_shared_memory;        /* bytes a workgroup */
    uint64_t max_allocation;           /* bytes in one allocation */
    uint64_t max_storage_buffer_range; /* bytes */
    uint64_t memory;                   /* bytes of the largest device-local heap */
    bool usable;                       /* has every feature that Hewn needs */
    char missing[256];                 /* names of those it lacks, comma separated */
} hewn_device_info;

typedef struct hewn_device_desc {
    const char
        *choice; /* an index, or a part of a name in any case; NULL: HEWN_DEVICE from the environment, else the best */
    bool validation; /* turn the Khronos validation layer on (HEWN_NO_DEVICE where it is not installed) */
    void (*message)(void *user,
                    const char *text); /* a message of the validation layer; may come from any thread. NULL: stderr */
    void *user;
} hewn_device_desc;

/* Lists devices, best first: discrete, integrated, virtual, CPU; ties by the loader's order. `*infos` is owned by the
 * caller (hewn_device_list_free). HEWN_NO_LOADER where no Vulkan loader is installed (libvulkan.so.1, or what the
 * environment variable HEWN_VULKAN_LOADER names); no device at all is HEWN_OK with a count of 0. */
HEWN_API hewn_result hewn_device_list(hewn_device_info **infos, size_t *count, hewn_error *error);
HEWN_API void hewn_device_list_free(hewn_device_info **infos);

/* Opens a device. `desc` may be NULL. A device serves one thread at a time; several devices may serve several threads.
 * HEWN_NO_LOADER, HEWN_NO_DEVICE (also: no device matches the choice; the message lists what there is),
 * HEWN_MISSING_FEATURE. */
HEWN_API hewn_result hewn_device_create(const hewn_device_desc *desc, hewn_device **out, hewn_error *error);
HEWN_API void hewn_device_destroy(hewn_device **device);

HEWN_API const hewn_device_info *hewn_device_get_info(const hewn_device *device);

/* How many messages the validation layer has given so far. */
HEWN_API uint64_t hewn_device_message_count(const hewn_device *device);

/* The most bytes of device memory that were in use at once so far. */
HEWN_API uint64_t hewn_device_peak_bytes(const hewn_device *device);

#ifdef __cplusplus
}
#endif
#endif
