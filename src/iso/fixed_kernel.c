#include "iso/fixed_kernel.h"

#include "base/error.h"

hewn_result hewn_fixed_kernels_create(hewn_device *device, const hewn_fixed_kernel *kernels, size_t count,
                                      hewn_error *error)
{
    for (size_t i = 0; i < count; i++) {
        hewn_program_desc desc = {.name = kernels[i].name,
                                  .spirv = (const uint32_t *)(const void *)kernels[i].spirv,
                                  .spirv_bytes = kernels[i].bytes,
                                  .push_bytes = (uint32_t)kernels[i].push_bytes,
                                  .uniforms = kernels[i].uniforms,
                                  .soon = kernels[i].soon};
        HEWN_TRY(hewn_program_create(device, &desc, kernels[i].place, error));
    }
    return HEWN_OK;
}
