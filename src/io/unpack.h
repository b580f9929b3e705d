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

/* How bytes may be packed. */
typedef enum hewn_packing {
    HEWN_PACKING_ZLIB, /* zlib's own (RFC 1950) or gzip, by how they begin */
    HEWN_PACKING_BZIP2
} hewn_packing;

/* One packed stream of at most `wanted` bytes unpacked; what follows it is not looked at. `*out` is the caller's
 * (hewn_free); its memory grows with what comes out, in doublings, never past `wanted`. HEWN_BAD_INPUT for data that
 * are damaged, end in the middle or hold more; HEWN_OUT_OF_MEMORY; HEWN_CANCELLED. */
hewn_result hewn_unpack_some(const char *bytes, size_t length, hewn_packing packing, size_t wanted, const char *name,
                             const hewn_progress *progress, char **out, size_t *out_length, hewn_error *error);

#endif
