/* Scratch files: temporary files without names, which are gone with the process however it ends. */
#ifndef HEWN_SRC_BASE_SCRATCH_H
#define HEWN_SRC_BASE_SCRATCH_H

#include "hewn/base.h"

typedef struct hewn_scratch hewn_scratch;

/* An empty file in the folder of `output`, or where that is no file, in $TMPDIR or else /var/tmp. HEWN_IO,
 * HEWN_OUT_OF_MEMORY. */
hewn_result hewn_scratch_create(const char *output, hewn_scratch **out, hewn_error *error);
void hewn_scratch_destroy(hewn_scratch **scratch);

/* Bytes at a place; writing past the end makes the file longer. HEWN_IO, as where the disk is full, or where it is read
 * past its end. */
hewn_result hewn_scratch_write(const hewn_scratch *scratch, const void *bytes, size_t length, uint64_t place,
                               hewn_error *error);
hewn_result hewn_scratch_read(const hewn_scratch *scratch, void *bytes, size_t length, uint64_t place,
                              hewn_error *error);

/* The first `length` bytes as memory that is only read, or NULL for none; pages come as they are looked at. The
 * caller's (munmap), before the scratch file goes. HEWN_IO. */
hewn_result hewn_scratch_map(const hewn_scratch *scratch, size_t length, void **out, hewn_error *error);

#endif
