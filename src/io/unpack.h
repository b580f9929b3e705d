/* Files that gzip compressed. */
#ifndef HEWN_SRC_IO_UNPACK_H
#define HEWN_SRC_IO_UNPACK_H

#include "hewn/base.h"

/* Whether bytes begin as gzip's do. */
bool hewn_is_packed(const char *bytes, size_t length);

/* What gzip compressed (RFC 1952), of one member or several in a row; zeros may trail, as tapes leave them. `*out` is
 * owned by the caller (hewn_free) and has a NUL after its `*out_length` bytes; its memory grows with what comes out, in
 * doublings. `name` is for messages. HEWN_LIMIT for more than `limit` bytes; HEWN_BAD_INPUT for data that are damaged,
 * end early or are followed by something else; HEWN_OUT_OF_MEMORY; HEWN_CANCELLED. */
hewn_result hewn_unpack(const char *bytes, size_t length, uint64_t limit, const char *name,
                        const hewn_progress *progress, char **out, size_t *out_length, hewn_error *error);

#endif
