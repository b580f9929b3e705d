/* The whole of the GPU room for the rooms above it: device, buffers, programs, command recording, prefix sum.
 * Nothing here knows fields or meshes. No Vulkan header is needed to use it. */
#ifndef HEWN_SRC_GPU_GPU_H
#define HEWN_SRC_GPU_GPU_H

#include "hewn/device.h"

#include "gpu/buffer.h"
#include "gpu/commands.h"
#include "gpu/program.h"
#include "gpu/scan.h"

#endif
