/* Machine code on two cores, for drivers that write it when work first arrives and on one core only, with every other
 * program waiting behind it: Mesa's llvmpipe. Private to this room.
 *
 * Programs that no earlier run has used are noted when they are made. A second Vulkan device, with a thread of its own,
 * runs them over no workgroups, which makes the driver write their code and keep it on disk, where it then finds it for
 * the first device too. When the first recording begins the caller's thread takes part, on the device itself, until
 * nothing is left. The largest programs go first. Which programs the driver has had is kept in Hewn's cache; where that
 * is wrong, or the driver keeps nothing, the code is written once more when it is needed: this costs time and never an
 * error. */
#ifndef HEWN_SRC_GPU_AHEAD_H
#define HEWN_SRC_GPU_AHEAD_H

#include "gpu/device.h"

/* Whether it is worth while: such a driver, a place for caches, and more than one processor. */
bool hewn_ahead_pays(const hewn_device *device);

/* Notes a program whose first use is near, with the SPIR-V that it was made of (which may go after the call).
 * HEWN_OUT_OF_MEMORY. */
hewn_result hewn_ahead_add(hewn_device *device, const hewn_program *program, const uint32_t *words, size_t bytes,
                           hewn_error *error);

/* The program is about to be destroyed. */
void hewn_ahead_forget(hewn_device *device, const hewn_program *program);

/* Returns when all that were noted have their code. Device errors. */
hewn_result hewn_ahead_finish(hewn_device *device, hewn_error *error);

/* How many programs were noted so far that the driver was not known to have had. */
size_t hewn_ahead_taken(const hewn_device *device);

/* Ends the thread, after the program that it is at, and frees everything. */
void hewn_ahead_stop(hewn_device *device);

#endif
