/* Reading the PNG files that the command writes. */
#ifndef HEWN_TESTS_CLI_PNG_READ_H
#define HEWN_TESTS_CLI_PNG_READ_H

#include <math.h>
#include <zlib.h>

#include "run.h"

typedef struct png {
    uint32_t width, height, channels, depth; /* bits */
    unsigned char *rows;                     /* without filters; 16 bits have the high byte first */
    double lo, hi;                           /* of the text chunks; NaN: none */
} png;

static inline uint32_t number_at(const unsigned char *at)
{
    return (uint32_t)at[0] << 24 | (uint32_t)at[1] << 16 | (uint32_t)at[2] << 8 | at[3];
}

static inline int paeth(int a, int b, int c)
{
    int p = a + b - c, pa = abs(p - a), pb = abs(p - b), pc = abs(p - c);
    return pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
}

static inline void unfilter(png *picture, const unsigned char *raw)
{
    size_t step = picture->channels * picture->depth / 8, stride = step * picture->width;
    for (size_t y = 0; y < picture->height; y++) {
        const unsigned char *from = raw + y * (stride + 1) + 1;
        unsigned char *to = picture->rows + y * stride;
        for (size_t i = 0; i < stride; i++) {
            int left = i >= step ? to[i - step] : 0, up = y > 0 ? to[i - stride] : 0;
            int corner = i >= step && y > 0 ? to[i - stride - step] : 0;
            const int add[5] = {0, left, up, (left + up) / 2, paeth(left, up, corner)};
            assert_true(raw[y * (stride + 1)] < 5);
            to[i] = (unsigned char)(from[i] + add[raw[y * (stride + 1)]]);
        }
    }
}

/* The chunks IHDR, tEXt and IDAT; checksums are zlib's. */
static inline png read_png(const char *path)
{
    size_t length, packed_length = 0;
    unsigned char *bytes = (unsigned char *)run_read_file(path, &length), *packed = malloc(length);
    png out = {.lo = (double)NAN, .hi = (double)NAN};
    assert_memory_equal(bytes, "\x89PNG\r\n\x1a\n", 8);
    for (size_t at = 8; at < length;) {
        uint32_t size = number_at(bytes + at);
        const unsigned char *data = bytes + at + 8;
        assert_true(at + 12 + size <= length);
        assert_int_equal(number_at(data + size), crc32(0, bytes + at + 4, size + 4));
        if (memcmp(bytes + at + 4, "IHDR", 4) == 0) {
            out.width = number_at(data);
            out.height = number_at(data + 4);
            out.depth = data[8];
            out.channels = data[9] == 2 ? 3 : data[9] == 6 ? 4 : 1;
        } else if (memcmp(bytes + at + 4, "tEXt", 4) == 0) {
            double value = strtod((const char *)data + 3, NULL);
            *(memcmp(data, "lo", 3) == 0 ? &out.lo : &out.hi) = value;
        } else if (memcmp(bytes + at + 4, "IDAT", 4) == 0) {
            memcpy(packed + packed_length, data, size);
            packed_length += size;
        }
        at += 12 + size;
    }
    uLongf raw_length = ((uLongf)out.width * out.channels * out.depth / 8 + 1) * out.height;
    unsigned char *raw = malloc(raw_length);
    out.rows = malloc(raw_length);
    assert_non_null(raw);
    assert_non_null(out.rows);
    assert_int_equal(uncompress(raw, &raw_length, packed, packed_length), Z_OK);
    unfilter(&out, raw);
    free(raw);
    free(packed);
    free(bytes);
    return out;
}

/* One number of a pixel. */
static inline unsigned value_of(const png *picture, uint32_t x, uint32_t y, uint32_t channel)
{
    size_t at = ((size_t)y * picture->width + x) * picture->channels + channel;
    return picture->depth == 16 ? picture->rows[2 * at] * 256U + picture->rows[2 * at + 1] : picture->rows[at];
}

#endif
