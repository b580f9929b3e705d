/* A mesh that is larger than the memory it may take: made in parts, certified as they come, and laid on disk until it
 * is written. A part is certified and stored at the same time. */
#ifndef HEWN_SRC_PIPELINE_MESH_PARTS_H
#define HEWN_SRC_PIPELINE_MESH_PARTS_H

#include "hewn/extract.h"
#include "hewn/volume_extract.h"
#include "pipeline/spool.h"

/* Clock times of the first part's beginning and the last part's end. */
typedef struct hewn_parts_span {
    double begin, end;
} hewn_parts_span;

typedef struct hewn_mesh_parts {
    hewn_spool *spool;
    hewn_certifier *certifier;
    const hewn_progress *caller;
    uint32_t calls;
    hewn_progress progress;
    hewn_triangles triangles; /* a view */
    hewn_parts_span certified, stored;
} hewn_mesh_parts;

/* Extracts beside `output`, and certifies. Clear it also after an error. As hewn_extract_parts(), and HEWN_IO. */
hewn_result hewn_mesh_parts_make(hewn_mesh_parts *parts, hewn_extractor *extractor, const hewn_extract_desc *desc,
                                 const char *output, hewn_extract_stats *stats, hewn_certificate *certificate,
                                 hewn_error *error);

/* The same from a volume. */
hewn_result hewn_mesh_parts_of_volume(hewn_mesh_parts *parts, const hewn_volume *volume,
                                      const hewn_volume_extract_desc *desc, const char *output,
                                      hewn_volume_extract_stats *stats, hewn_certificate *certificate,
                                      hewn_error *error);
void hewn_mesh_parts_clear(hewn_mesh_parts *parts);

/* A callback for who reads the triangles: it passes on what it is told, and lets go of the pages that were read. */
const hewn_progress *hewn_mesh_parts_progress(hewn_mesh_parts *parts, const hewn_progress *caller);

#endif
