/* Several documents of one mesh each made one, whose meshes are levels of detail of one node. */
#ifndef HEWN_SRC_IO_SHIM_GLTF_LEVELS_H
#define HEWN_SRC_IO_SHIM_GLTF_LEVELS_H

#include "hewn/base.h"

#ifdef __cplusplus
extern "C" {
#endif

#include "base/text.h"

/* `documents` are what hewn_gltf_compose() made, from fine to coarse, and `binaries` the bytes that each has in the
 * shared buffer, one after the other. `coverages`, as many, go to the extras of the first node (MSFT_screencoverage).
 * Appends to `out`. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_gltf_join_levels(const hewn_text *documents, const uint64_t *binaries, const double *coverages,
                                  size_t count, hewn_text *out, hewn_error *error);

/* What stands in the binary chunk behind a mesh: clusters, then lists of vertices, then corners, each of so many bytes;
 * only the last may be no multiple of 4. */
typedef struct hewn_gltf_clusters {
    uint64_t begin; /* of the first, in the chunk */
    uint64_t cluster_bytes, vertex_bytes, corner_bytes;
    uint32_t count, level_count;
} hewn_gltf_clusters;

/* `document` with views of that, and their numbers in the extras of its mesh ("hewn_clusters"). Appends to `out`.
 * HEWN_OUT_OF_MEMORY. */
hewn_result hewn_gltf_add_clusters(const hewn_text *document, const hewn_gltf_clusters *clusters, hewn_text *out,
                                   hewn_error *error);

#ifdef __cplusplus
}
#endif
#endif
