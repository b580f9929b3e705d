/* A mesh on its way to a file: its parts lie in nameless files on disk until all are there and a writer reads them. */
#ifndef HEWN_SRC_PIPELINE_SPOOL_H
#define HEWN_SRC_PIPELINE_SPOOL_H

#include "hewn/triangles.h"

typedef struct hewn_spool hewn_spool;

/* Files in the folder of `output`, or where that is no file, in $TMPDIR or else /var/tmp. They have no names and are
 * gone with the process. HEWN_IO, HEWN_OUT_OF_MEMORY. */
hewn_result hewn_spool_create(const char *output, hewn_spool **out, hewn_error *error);
void hewn_spool_destroy(hewn_spool **spool);

/* Takes a part as a sink does; it keeps no memory. HEWN_IO, as where the disk is full. */
hewn_result hewn_spool_take(hewn_spool *spool, const hewn_mesh_part *part, hewn_error *error);

/* The whole mesh as a view of the files, whose pages come to memory as they are read: gone with the spool, and not to
 * be destroyed. HEWN_IO. */
hewn_result hewn_spool_view(hewn_spool *spool, uint64_t vertices, uint64_t triangles, hewn_triangles *out,
                            hewn_error *error);

/* Lets go of the pages that were read. */
void hewn_spool_relax(hewn_spool *spool);

#endif
