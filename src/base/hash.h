/* A 128-bit non-cryptographic hash for cache keys and hash-consing. */
#ifndef HEWN_SRC_BASE_HASH_H
#define HEWN_SRC_BASE_HASH_H

#include "hewn/base.h"

typedef struct hewn_hash {
    uint64_t a, b;
} hewn_hash;

hewn_hash hewn_hash_begin(void);
hewn_hash hewn_hash_bytes(hewn_hash hash, const void *bytes, size_t length);

/* 32 hexadecimal digits and a NUL. */
void hewn_hash_print(hewn_hash hash, char out[33]);

#endif
