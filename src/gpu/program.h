/* Compute shaders: from embedded SPIR-V or from GLSL at run time, with caches on disk. */
#ifndef HEWN_SRC_GPU_PROGRAM_H
#define HEWN_SRC_GPU_PROGRAM_H

#include "gpu/buffer.h"

typedef struct hewn_program hewn_program;

typedef struct hewn_program_desc {
    const char *name;      /* for messages */
    const uint32_t *spirv; /* either this, `spirv_bytes` long, */
    size_t spirv_bytes;
    const char *glsl; /* or this: the complete text of a compute shader (`#version` first); includes are not resolved */
    uint32_t push_bytes; /* size of the push constants, 0 to 128 */
    bool uniforms;       /* the shader reads a uniform buffer at set 0, binding 0 */
    bool soon;           /* it is sure to be used soon: its machine code may be made before that */
} hewn_program_desc;

/* Compiles (glslang's C interface, Vulkan 1.2 rules, SPIR-V 1.5) and makes the pipeline. SPIR-V of GLSL is kept on disk
 * under $XDG_CACHE_HOME/hewn (else
 * ~/.cache/hewn), as is the driver's pipeline cache; a damaged, stale or unwritable cache costs time and never an
 * error. The desc's memory may go after the call. HEWN_INTERNAL with glslang's own message where the GLSL does not
 * compile. */
hewn_result hewn_program_create(hewn_device *device, const hewn_program_desc *desc, hewn_program **out,
                                hewn_error *error);
void hewn_program_destroy(hewn_device *device, hewn_program **program);

#endif
