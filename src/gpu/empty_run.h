/* Running a program over no workgroups at all: what makes a driver write machine code that otherwise does so when work
 * first arrives. Private to this room.
 *
 * Works on a bare Vulkan device, takes nothing from Hewn's heap and counts no memory of the device, so that the same
 * can be done on a second device by another thread. */
#ifndef HEWN_SRC_GPU_EMPTY_RUN_H
#define HEWN_SRC_GPU_EMPTY_RUN_H

#include "gpu/device.h"

/* What it takes, made once a device. */
typedef struct hewn_empty_run {
    VkCommandPool pool;
    VkCommandBuffer buffer;
    VkFence fence;
    VkBuffer uniforms; /* nobody reads them, but they must be there */
    VkDeviceMemory memory;
    VkDescriptorPool sets;
    VkDescriptorSet set;
} hewn_empty_run;

/* Makes it for a device that is open and has its `uniform_layout`. After a failure it is to be closed too. */
hewn_result hewn_empty_run_open(hewn_device *device, hewn_empty_run *out, hewn_error *error);
void hewn_empty_run_close(hewn_device *device, hewn_empty_run *run);

/* Runs it and waits. */
hewn_result hewn_empty_run_do(hewn_device *device, hewn_empty_run *run, const hewn_program *program, hewn_error *error);

#endif
