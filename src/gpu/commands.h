/* Recording compute work into one command buffer and running it. */
#ifndef HEWN_SRC_GPU_COMMANDS_H
#define HEWN_SRC_GPU_COMMANDS_H

#include "gpu/program.h"

/* What an indirect dispatch reads: workgroup counts. */
typedef struct hewn_dispatch_size {
    uint32_t x, y, z;
} hewn_dispatch_size;

typedef struct hewn_commands hewn_commands;

/* An empty recording. One may be open on a device at a time. Records until submitted; a failure while recording is
 * remembered and returned by the submit. */
hewn_result hewn_commands_begin(hewn_device *device, hewn_commands **out, hewn_error *error);

/* One dispatch. `push` holds the program's push_bytes. `uniforms` is the uniform buffer or NULL. Each dispatch, copy
 * and fill sees all that those recorded before it wrote (a global memory barrier stands between any two). */
void hewn_commands_dispatch(hewn_commands *commands, hewn_program *program, const void *push,
                            const hewn_buffer *uniforms, hewn_dispatch_size groups);
void hewn_commands_dispatch_indirect(hewn_commands *commands, hewn_program *program, const void *push,
                                     const hewn_buffer *uniforms, const hewn_buffer *sizes, uint64_t offset);
void hewn_commands_copy(hewn_commands *commands, const hewn_buffer *from, uint64_t from_offset, const hewn_buffer *to,
                        uint64_t to_offset, uint64_t bytes);
void hewn_commands_fill(hewn_commands *commands, const hewn_buffer *buffer, uint64_t offset, uint64_t bytes,
                        uint32_t value);

/* Marks a moment (at most 64 of them) and returns its index in the `times` of hewn_commands_submit(). */
uint32_t hewn_commands_mark(hewn_commands *commands);

/* Runs everything recorded, waits for it, and destroys the recording. HEWN_DEVICE_LOST, HEWN_OUT_OF_DEVICE_MEMORY, or
 * what failed in recording. `times` (or NULL) receives the seconds of each mark since the first. */
hewn_result hewn_commands_submit(hewn_commands **commands, double *times, hewn_error *error);

/* Throws a recording away; on &NULL does nothing. */
void hewn_commands_destroy(hewn_commands **commands);

#endif
