/* Numbers in files, little-endian as GLB, PLY and STL want them or big-endian, whatever this machine's order. */
#ifndef HEWN_SRC_IO_BYTES_H
#define HEWN_SRC_IO_BYTES_H

#include <stdint.h>
#include <string.h>

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

static inline char *hewn_put_u64(char *to, uint64_t value)
{
    return hewn_put_u32(hewn_put_u32(to, (uint32_t)(value & 0xffffffff)), (uint32_t)(value >> 32));
}

static inline char *hewn_put_float(char *to, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return hewn_put_u32(to, bits);
}

static inline char *hewn_put_double(char *to, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return hewn_put_u32(hewn_put_u32(to, (uint32_t)bits), (uint32_t)(bits >> 32));
}

static inline uint32_t hewn_get_u16(const char *at)
{
    const unsigned char *byte = (const unsigned char *)at;
    return (uint32_t)byte[0] | (uint32_t)byte[1] << 8;
}

static inline uint32_t hewn_get_u32(const char *at)
{
    const unsigned char *byte = (const unsigned char *)at;
    return (uint32_t)byte[0] | (uint32_t)byte[1] << 8 | (uint32_t)byte[2] << 16 | (uint32_t)byte[3] << 24;
}

static inline uint64_t hewn_get_u64(const char *at)
{
    const unsigned char *byte = (const unsigned char *)at;
    return (uint64_t)byte[0] | (uint64_t)byte[1] << 8 | (uint64_t)byte[2] << 16 | (uint64_t)byte[3] << 24 |
           (uint64_t)byte[4] << 32 | (uint64_t)byte[5] << 40 | (uint64_t)byte[6] << 48 | (uint64_t)byte[7] << 56;
}

static inline float hewn_float_of_bits(uint32_t bits)
{
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static inline double hewn_double_of_bits(uint64_t bits)
{
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static inline float hewn_get_float(const char *at)
{
    return hewn_float_of_bits(hewn_get_u32(at));
}

static inline double hewn_get_double(const char *at)
{
    return hewn_double_of_bits(hewn_get_u64(at));
}

/* The same in the other order: the highest byte comes first. */
static inline uint32_t hewn_get_u16_big(const char *at)
{
    const unsigned char *byte = (const unsigned char *)at;
    return (uint32_t)byte[1] | (uint32_t)byte[0] << 8;
}

static inline uint32_t hewn_get_u32_big(const char *at)
{
    const unsigned char *byte = (const unsigned char *)at;
    return (uint32_t)byte[3] | (uint32_t)byte[2] << 8 | (uint32_t)byte[1] << 16 | (uint32_t)byte[0] << 24;
}

static inline uint64_t hewn_get_u64_big(const char *at)
{
    const unsigned char *byte = (const unsigned char *)at;
    return (uint64_t)byte[7] | (uint64_t)byte[6] << 8 | (uint64_t)byte[5] << 16 | (uint64_t)byte[4] << 24 |
           (uint64_t)byte[3] << 32 | (uint64_t)byte[2] << 40 | (uint64_t)byte[1] << 48 | (uint64_t)byte[0] << 56;
}

static inline float hewn_get_float_big(const char *at)
{
    return hewn_float_of_bits(hewn_get_u32_big(at));
}

static inline double hewn_get_double_big(const char *at)
{
    return hewn_double_of_bits(hewn_get_u64_big(at));
}

#endif
