/* GLSL to SPIR-V through glslang. Private to this room. */
#ifndef HEWN_SRC_GPU_COMPILER_H
#define HEWN_SRC_GPU_COMPILER_H

#include "base/hash.h"

/* Identifies what the compiler makes of a text: the text, the compiler's version and our options. */
hewn_hash hewn_compiler_key(const char *glsl);

/* Compiles a compute shader (Vulkan 1.2, SPIR-V 1.5). `*words` is owned by the caller. HEWN_INTERNAL with the
 * compiler's own words, shortened, where the text is not right. Safe from any thread. */
hewn_result hewn_compiler_run(const char *name, const char *glsl, uint32_t **words, size_t *bytes, hewn_error *error);

#endif
