#include "base/hash.h"

#include <stdio.h>
#include <string.h>

static uint64_t mix(uint64_t value)
{
    value ^= value >> 32;
    value *= 0xd6e8feb86659fd93u;
    value ^= value >> 32;
    value *= 0xd6e8feb86659fd93u;
    value ^= value >> 32;
    return value;
}

hewn_hash hewn_hash_begin(void)
{
    return (hewn_hash){0x9ae16a3b2f90404fu, 0xc3a5c85c97cb3127u};
}

hewn_hash hewn_hash_bytes(hewn_hash hash, const void *bytes, size_t length)
{
    const unsigned char *at = bytes;
    uint64_t total = length;
    while (length > 0) {
        uint64_t word = 0;
        size_t taken = length < 8 ? length : 8;
        memcpy(&word, at, taken);
        hash.a = mix(hash.a ^ word) + 0x632be59bd9b4e019u;
        hash.b = mix(hash.b + word) ^ (hash.a << 23 | hash.a >> 41);
        at += taken;
        length -= taken;
    }
    hash.a = mix(hash.a ^ total);
    hash.b = mix(hash.b + total);
    return hash;
}

void hewn_hash_print(hewn_hash hash, char out[33])
{
    snprintf(out, 33, "%016llx%016llx", (unsigned long long)hash.a, (unsigned long long)hash.b);
}
