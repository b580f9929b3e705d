/* Records of one size in a scratch file, by their numbers, through a cache of pages: memory stays what it was given,
 * however many records there are. Whoever asks for records that are near each other in the file waits little. */
#ifndef HEWN_SRC_OUTCORE_PAGES_H
#define HEWN_SRC_OUTCORE_PAGES_H

#include "base/scratch.h"

typedef struct hewn_pages hewn_pages;

/* An empty file beside `output` for records of `size` bytes, and a cache of about `memory` bytes. HEWN_IO,
 * HEWN_OUT_OF_MEMORY. */
hewn_result hewn_pages_create(const char *output, size_t size, size_t memory, hewn_pages **out, hewn_error *error);
void hewn_pages_destroy(hewn_pages **pages);

/* A copy of record `index`, which was put before, or lies before one that was: then it is zeroes. HEWN_IO. */
hewn_result hewn_pages_get(hewn_pages *pages, uint64_t index, void *record, hewn_error *error);

/* Replaces record `index`, or adds it. HEWN_IO, as where the disk is full, which may be told by a later call. */
hewn_result hewn_pages_put(hewn_pages *pages, uint64_t index, const void *record, hewn_error *error);

#endif
