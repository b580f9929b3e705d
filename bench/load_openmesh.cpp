#include <memory>

#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/Traits.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>

#include "load_peers.h"

namespace
{
struct DoubleTraits : OpenMesh::DefaultTraits {
    using Point = OpenMesh::Vec3d;
    using Normal = OpenMesh::Vec3d;
};
using Mesh = OpenMesh::TriMesh_ArrayKernelT<DoubleTraits>;
} // namespace

peer_loaded openmesh_load(const char *path)
{
    auto mesh = std::make_unique<Mesh>();
    if (!OpenMesh::IO::read_mesh(*mesh, path))
        return {nullptr, 0, 0};
    auto vertices = mesh->n_vertices(), faces = mesh->n_faces();
    return {mesh.release(), vertices, faces};
}

void openmesh_release(void *mesh)
{
    delete static_cast<Mesh *>(mesh);
}
