/* Device memory that shaders reach by address. */
#ifndef HEWN_SRC_GPU_BUFFER_H
#define HEWN_SRC_GPU_BUFFER_H

#include "hewn/device.h"

typedef enum hewn_buffer_use {
    HEWN_BUFFER_DEVICE,  /* fastest for shaders; mapped too where the device shares the host's memory */
    HEWN_BUFFER_UPLOAD,  /* mapped, written by the host */
    HEWN_BUFFER_READBACK /* mapped, cached, read by the host */
} hewn_buffer_use;

/* Storage, transfer and indirect buffer in one; also uniform where it is small enough. Zero is "none". A buffer owns
 * its memory. */
typedef struct hewn_buffer {
    uint64_t address;   /* for shaders */
    uint64_t size;      /* bytes asked for */
    void *mapped;       /* host pointer (coherent), or NULL */
    void *handle;       /* VkBuffer */
    void *memory;       /* VkDeviceMemory */
    uint64_t allocated; /* bytes taken from the device, for the books */
} hewn_buffer;

/* A buffer of `size` bytes (0 gives a valid buffer of 4), contents undefined. HEWN_OUT_OF_DEVICE_MEMORY names how much
 * was asked for and `what` it was for; HEWN_LIMIT past the device's largest allocation. */
hewn_result hewn_buffer_create(hewn_device *device, const char *what, uint64_t size, hewn_buffer_use use,
                               hewn_buffer *out, hewn_error *error);

/* Frees it and zeroes the struct; on a zero struct does nothing. No submitted work may still use it. */
void hewn_buffer_destroy(hewn_device *device, hewn_buffer *buffer);

#endif
