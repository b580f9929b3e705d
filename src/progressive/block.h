/* What files of progressive meshes (.hpm, docs/hpm.md) are made of: numbers, low byte first, in blocks. */
#ifndef HEWN_SRC_PROGRESSIVE_BLOCK_H
#define HEWN_SRC_PROGRESSIVE_BLOCK_H

#include <stddef.h>
#include <stdint.h>

#define PROGRESSIVE_MAGIC "\x89HPM\r\n\x1a\n"

enum { PROGRESSIVE_VERSION = 1 };

/* A file begins with the magic (8 bytes) and the version (4). A block has its type (4), the bytes of its content (8),
 * the content, and a checksum (4) of all that. */
enum { PROGRESSIVE_START = 12, PROGRESSIVE_BLOCK_HEAD = 12, PROGRESSIVE_BLOCK_TAIL = 4 };

/* The splits of one block, but for the last. */
enum { PROGRESSIVE_BLOCK_SPLITS = 512 };

enum {
    PROGRESSIVE_FLOATS = 1,   /* positions are floats */
    PROGRESSIVE_POLYGONS = 2, /* the input had others than triangles */
    PROGRESSIVE_UP_KNOWN = 4
};

/* Copies scalars of `size` bytes between this machine's order and the file's. */
static inline void progressive_copy_scalars(unsigned char *to, const unsigned char *from, size_t count, size_t size)
{
    for (size_t i = 0; i < count * size; i++)
#if __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
        to[i] = from[i - i % size + (size - 1 - i % size)];
#else
        to[i] = from[i];
#endif
}

#endif
