/* PNG of bytes that are not colours. */
#ifndef HEWN_SRC_IO_PNG_WRITE_H
#define HEWN_SRC_IO_PNG_WRITE_H

#include "base/file.h"

/* Writes rows of width x channels bytes (1: grey, 3: red, green, blue, 4: opacity too) from the top, without any word
 * about what colours they are; the output is not finished. Sides are 1 to 2^31 - 1. HEWN_IO, HEWN_OUT_OF_MEMORY. */
hewn_result hewn_png_write_bytes(hewn_output *output, const uint8_t *bytes, uint32_t width, uint32_t height,
                                 uint32_t channels, hewn_error *error);

#endif
