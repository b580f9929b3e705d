#include <CGAL/Polygon_mesh_processing/smooth_shape.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>

#include <chrono>

#include "smooth_peers.h"

using Kernel = CGAL::Simple_cartesian<double>;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

double cgal_smooth_shape(const peer_input *input, double time, int iterations, double *positions)
{
    Mesh mesh;
    for (uint64_t v = 0; v < input->vertex_count; v++)
        mesh.add_vertex({input->positions[3 * v], input->positions[3 * v + 1], input->positions[3 * v + 2]});
    for (uint64_t t = 0; t < input->triangle_count; t++) {
        const uint32_t *at = input->indices + 3 * t;
        mesh.add_face(Mesh::Vertex_index(at[0]), Mesh::Vertex_index(at[1]), Mesh::Vertex_index(at[2]));
    }
    auto begin = std::chrono::steady_clock::now();
    CGAL::Polygon_mesh_processing::smooth_shape(
        mesh, time, CGAL::parameters::number_of_iterations(static_cast<unsigned>(iterations)));
    double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    for (auto v : mesh.vertices())
        for (int axis = 0; axis < 3; axis++)
            positions[3 * static_cast<uint32_t>(v) + static_cast<uint32_t>(axis)] = mesh.point(v)[axis];
    return seconds;
}
