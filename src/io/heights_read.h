/* The reader of PNG behind hewn_heightmap_read(), of a file in memory. */
#ifndef HEWN_SRC_IO_HEIGHTS_READ_H
#define HEWN_SRC_IO_HEIGHTS_READ_H

#include "hewn/heights.h"

/* More values than this are refused. */
#define HEWN_HEIGHTS_MOST ((uint64_t)1 << 28)

/* Values as shares, the first row of the file first. `name` is for messages. */
hewn_result hewn_png_read(const char *bytes, size_t length, const char *name, hewn_heightmap *out, hewn_error *error);

/* Any file in memory that is read as heights, all but turning rows over; for tests and fuzzing. */
hewn_result hewn_heightmap_check(const hewn_heightmap *map, const char *name, hewn_error *error);

#endif
