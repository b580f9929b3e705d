/* Kernels that are the same for every field: compiled with the library and embedded in it. */
#ifndef HEWN_SRC_ISO_FIXED_KERNEL_H
#define HEWN_SRC_ISO_FIXED_KERNEL_H

#include "gpu/gpu.h"

/* Declares the embedded shader of that name. */
#define HEWN_SHADER(name)                                                                                              \
    extern const unsigned char hewn_shader_##name[];                                                                   \
    extern const size_t hewn_shader_##name##_size

/* A row of a list of kernels: the shader, whether it reads a table as uniforms, whether it is sure to be used soon, and
 * where its program goes. Its push constants are a struct hewn_PUSH. */
#define HEWN_FIXED_KERNEL(shader, push, uniforms, soon, place)                                                         \
    {                                                                                                                  \
#shader, hewn_shader_##shader, hewn_shader_##shader##_size, sizeof(struct hewn_##push), uniforms, soon, place  \
    }

typedef struct hewn_fixed_kernel {
    const char *name;
    const unsigned char *spirv;
    size_t bytes;
    size_t push_bytes;
    bool uniforms;
    bool soon;
    hewn_program **place;
} hewn_fixed_kernel;

/* Makes their programs; after a failure the places hold those that were made. Device errors. */
hewn_result hewn_fixed_kernels_create(hewn_device *device, const hewn_fixed_kernel *kernels, size_t count,
                                      hewn_error *error);

#endif
