#include <new>

#include <OpenMesh/Core/Mesh/Traits.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>

#include "mesh_peers.h"

namespace
{
struct DoubleTraits : OpenMesh::DefaultTraits {
    using Point = OpenMesh::Vec3d;
    using Normal = OpenMesh::Vec3d;
};
using Mesh = OpenMesh::TriMesh_ArrayKernelT<DoubleTraits>;
} // namespace

void *openmesh_build(const peer_input *input)
{
    auto *mesh = new (std::nothrow) Mesh;
    if (!mesh)
        return nullptr;
    mesh->reserve(input->vertex_count, input->triangle_count * 3 / 2, input->triangle_count);
    for (uint64_t v = 0; v < input->vertex_count; v++) {
        const double *at = input->positions + 3 * v;
        mesh->add_vertex(Mesh::Point(at[0], at[1], at[2]));
    }
    for (uint64_t t = 0; t < input->triangle_count; t++) {
        const uint32_t *at = input->indices + 3 * t;
        if (!mesh->add_face(Mesh::VertexHandle(static_cast<int>(at[0])), Mesh::VertexHandle(static_cast<int>(at[1])),
                            Mesh::VertexHandle(static_cast<int>(at[2])))
                 .is_valid()) {
            delete mesh;
            return nullptr;
        }
    }
    return mesh;
}

void openmesh_free(void *mesh)
{
    delete static_cast<Mesh *>(mesh);
}
