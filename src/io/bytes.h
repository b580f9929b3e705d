/* Numbers in files, little-endian as GLB, PLY and STL want them, whatever this machine's order. */
#ifndef HEWN_SRC_IO_BYTES_H
#define HEWN_SRC_IO_BYTES_H

#include <stdint.h>

/* Each writes a value and returns what follows it. */
static inline char *hewn_put_u16(char *to, uint32_t value)
{
    to[0] = (char)(value & 0xff);
    to[1] = (char)(value >> 8 & 0xff);
    return to + 2;
}

static inline char *hewn_put_u32(char *to, uint32_t value)
{
    return hewn_put_u16(hewn_put_u16(to, value), value >> 16);
}

static inline char *hewn_put_float(char *to, float value)
{
    union {
        float real;
        uint32_t bits;
    } both = {value};
    return hewn_put_u32(to, both.bits);
}

static inline uint32_t hewn_get_u32(const char *at)
{
    const unsigned char *byte = (const unsigned char *)at;
    return (uint32_t)byte[0] | (uint32_t)byte[1] << 8 | (uint32_t)byte[2] << 16 | (uint32_t)byte[3] << 24;
}

#endif
