/* Heights from image files. */
#ifndef HEWN_HEIGHTS_H
#define HEWN_HEIGHTS_H

#include "hewn/volume_io.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Zero is the empty one; what it owns it frees in hewn_heightmap_destroy(). */
typedef struct hewn_heightmap {
    uint32_t columns, rows;
    float
        *values; /* row by row, the last row of the file first: y grows with the index, and a picture is seen from above
                  */
} hewn_heightmap;

/* Reads a .png of one grey channel (8 or 16 bits, or fewer; with an alpha channel, which is dropped), or a single slice
 * of any volume file: TIFF, NumPy, NRRD and, with `raw` saying what it holds, raw samples; its third dimension is then
 * 0 or 1. Values of 8 or 16 bits without a sign become shares of the greatest there is, 0 to 1; all others stay what
 * they are. `raw` may be NULL.
 *
 * HEWN_BAD_INPUT for a file that is damaged or of something else, which has colours or more than one slice, or a value
 * that is no finite number, naming row and column; HEWN_LIMIT past 2^28 values; HEWN_IO, HEWN_OUT_OF_MEMORY. Safe from
 * several threads at once. */
HEWN_API hewn_result hewn_heightmap_read(const char *path, const hewn_raw_desc *raw, hewn_heightmap *out,
                                         hewn_error *error);
HEWN_API void hewn_heightmap_destroy(hewn_heightmap *map);

#ifdef __cplusplus
}
#endif
#endif
