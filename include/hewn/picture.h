/* Pictures: plain pixels, and PNG files of them. */
#ifndef HEWN_PICTURE_H
#define HEWN_PICTURE_H

#include "hewn/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What a pixel's values mean. */
typedef enum hewn_picture_kind {
    HEWN_PICTURE_COLOUR, /* red, green, blue: linear light, 0 to 1; written as 8-bit sRGB */
    HEWN_PICTURE_VECTOR, /* three numbers from -1 to 1; written as 8 bits each, 0 for -1 and 255 for 1 */
    HEWN_PICTURE_SCALAR  /* one number; written as 16-bit grey, 0 for `lo` and 65,534 for `hi`, 65,535 for NaN */
} hewn_picture_kind;

/* Rows from the top. Zero is the empty one. Owned by whoever holds the struct; leave it with hewn_picture_destroy(). */
typedef struct hewn_picture {
    uint32_t width, height;
    hewn_picture_kind kind;
    float *values; /* width × height × 3, or × 1 for a scalar */
    double lo, hi; /* of a scalar: the least and greatest number that is one; both 0 where there is none */
} hewn_picture;

HEWN_API void hewn_picture_destroy(hewn_picture *picture);

/* Writes a PNG file under a temporary name and renames it over `path` ("-" is standard output). The same bytes for the
 * same picture. A scalar picture's range stands in the file too, as text chunks "lo" and "hi". HEWN_INVALID_ARGUMENT
 * for an empty picture or more than 2^31 - 1 pixels a side, HEWN_IO, HEWN_OUT_OF_MEMORY. */
HEWN_API hewn_result hewn_picture_write(const hewn_picture *picture, const char *path, hewn_error *error);

#ifdef __cplusplus
}
#endif
#endif
