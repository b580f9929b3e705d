#include <new>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>

#include "mesh_peers.h"

namespace
{
using Point = CGAL::Simple_cartesian<double>::Point_3;
using Mesh = CGAL::Surface_mesh<Point>;
} // namespace

void *surface_mesh_build(const peer_input *input)
{
    auto *mesh = new (std::nothrow) Mesh;
    if (!mesh)
        return nullptr;
    mesh->reserve(static_cast<Mesh::size_type>(input->vertex_count),
                  static_cast<Mesh::size_type>(input->triangle_count * 3 / 2),
                  static_cast<Mesh::size_type>(input->triangle_count));
    for (uint64_t v = 0; v < input->vertex_count; v++) {
        const double *at = input->positions + 3 * v;
        mesh->add_vertex(Point(at[0], at[1], at[2]));
    }
    for (uint64_t t = 0; t < input->triangle_count; t++) {
        const uint32_t *at = input->indices + 3 * t;
        if (mesh->add_face(Mesh::Vertex_index(at[0]), Mesh::Vertex_index(at[1]), Mesh::Vertex_index(at[2])) ==
            Mesh::null_face()) {
            delete mesh;
            return nullptr;
        }
    }
    return mesh;
}

void surface_mesh_free(void *mesh)
{
    delete static_cast<Mesh *>(mesh);
}
