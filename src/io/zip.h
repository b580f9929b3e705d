/* ZIP archives, written from front to end: each part's length follows it, so nothing is kept or gone back to. */
#ifndef HEWN_SRC_IO_ZIP_H
#define HEWN_SRC_IO_ZIP_H

#include "base/file.h"

typedef struct hewn_zip hewn_zip;

/* An archive that is written to `output`, which stays the caller's. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_zip_create(hewn_output *output, hewn_zip **out, hewn_error *error);

/* Begins a part, compressed with deflate (RFC 1951); all times are 1980-01-01, so that the same parts give the same
 * bytes. `large`: it may need 4 GiB and more; for others that is HEWN_LIMIT. At most 8 parts. HEWN_IO. */
hewn_result hewn_zip_begin(hewn_zip *zip, const char *name, bool large, hewn_error *error);
hewn_result hewn_zip_write(hewn_zip *zip, const void *bytes, size_t length, hewn_error *error);
hewn_result hewn_zip_end(hewn_zip *zip, hewn_error *error);

/* Writes the directory, after the last part. */
hewn_result hewn_zip_finish(hewn_zip *zip, hewn_error *error);

/* On &NULL does nothing. */
void hewn_zip_destroy(hewn_zip **zip);

#endif
