#include <chrono>

#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Subdivider/Uniform/CatmullClarkT.hh>
#include <OpenMesh/Tools/Subdivider/Uniform/LoopT.hh>

#include "subdivide_peers.h"

namespace
{
struct Traits : OpenMesh::DefaultTraits {
    using Point = OpenMesh::Vec3d;
    using Normal = OpenMesh::Vec3d;
};

template <typename Mesh, typename Refiner>
double run(const cage *input, int levels, uint64_t *faces)
{
    Mesh mesh;
    for (uint64_t v = 0; v < input->vertex_count; v++)
        mesh.add_vertex(
            typename Mesh::Point(input->positions[3 * v], input->positions[3 * v + 1], input->positions[3 * v + 2]));
    std::vector<typename Mesh::VertexHandle> corners(input->sides);
    for (uint64_t f = 0; f < input->face_count; f++) {
        for (uint32_t k = 0; k < input->sides; k++)
            corners[k] = typename Mesh::VertexHandle(static_cast<int>(input->corners[input->sides * f + k]));
        mesh.add_face(corners);
    }
    Refiner refine;
    auto begin = std::chrono::steady_clock::now();
    refine.attach(mesh);
    refine(static_cast<size_t>(levels));
    refine.detach();
    double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    *faces = mesh.n_faces();
    return seconds;
}
} // namespace

double openmesh_subdivide(const cage *input, int levels, uint64_t *faces)
{
    using Triangles = OpenMesh::TriMesh_ArrayKernelT<Traits>;
    using Polygons = OpenMesh::PolyMesh_ArrayKernelT<Traits>;
    if (input->sides == 3)
        return run<Triangles, OpenMesh::Subdivider::Uniform::LoopT<Triangles, double>>(input, levels, faces);
    return run<Polygons, OpenMesh::Subdivider::Uniform::CatmullClarkT<Polygons, double>>(input, levels, faces);
}
