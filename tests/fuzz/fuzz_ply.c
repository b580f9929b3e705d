/* PLY from memory: whatever the bytes are, reading them gives a mesh that can be certified, or an error and nothing. */
#include <stdlib.h>

#include "io/formats.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    hewn_triangles mesh;
    if (hewn_ply_read((const char *)data, size, "fuzz", &mesh, NULL) == HEWN_OK) {
        hewn_certificate certificate;
        if (hewn_certify(&mesh, NULL, &certificate, NULL) != HEWN_OK)
            abort();
        hewn_triangles_destroy(&mesh);
    }
    if (mesh.positions || mesh.normals || mesh.indices || mesh.vertex_count || mesh.triangle_count)
        abort();
    return 0;
}
