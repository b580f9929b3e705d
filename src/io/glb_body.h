/* The parts of a GLB file, for those that hold more than one mesh. */
#ifndef HEWN_SRC_IO_GLB_BODY_H
#define HEWN_SRC_IO_GLB_BODY_H

#include "base/text.h"
#include "io/formats.h"

/* Plans a job, whose `own` is then there until hewn_glb_writer.release(), also after an error: the JSON of a file with
 * it alone, and the bytes that it needs in the binary chunk, a multiple of 4. HEWN_LIMIT, HEWN_CANCELLED,
 * HEWN_OUT_OF_MEMORY. */
hewn_result hewn_glb_compose(hewn_writing *job, hewn_text *json, uint64_t *binary, hewn_error *error);

/* The file's header, the JSON chunk and the head of a binary chunk of that many bytes (0: none); `*out` is the
 * caller's (hewn_free). HEWN_LIMIT, HEWN_OUT_OF_MEMORY. */
hewn_result hewn_glb_head(const hewn_text *json, uint64_t binary, char **out, size_t *length, hewn_error *error);

/* Writes what the job has in the binary chunk. HEWN_IO, HEWN_CANCELLED, HEWN_OUT_OF_MEMORY. */
hewn_result hewn_glb_write_body(const hewn_writing *job, hewn_output *output, hewn_error *error);

#endif
