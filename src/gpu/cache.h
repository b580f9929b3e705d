/* Files that only save time: kept under $XDG_CACHE_HOME/hewn (else ~/.cache/hewn), shared by any number of processes.
 * Nothing here ever fails for a reason on the disk: what cannot be read or is damaged counts as absent, what cannot be
 * written is not kept. Private to this room. */
#ifndef HEWN_SRC_GPU_CACHE_H
#define HEWN_SRC_GPU_CACHE_H

#include "base/hash.h"

typedef struct hewn_cache {
    char *root;     /* NULL: there is no place to keep anything */
    uint64_t limit; /* bytes that a folder may hold; the files unused for longest go first */
} hewn_cache;

/* Finds the place; creates nothing yet. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_cache_open(hewn_cache *cache, hewn_error *error);
void hewn_cache_close(hewn_cache *cache);

/* The bytes kept under `key` in a folder, unchanged since they were stored, or NULL. Owned by the caller. */
void *hewn_cache_load(const hewn_cache *cache, const char *folder, hewn_hash key, size_t *length);

/* Keeps bytes under `key`: readers see the old file, or none, until the new one is whole. */
void hewn_cache_store(const hewn_cache *cache, const char *folder, hewn_hash key, const void *bytes, size_t length);

#endif
