#include <chrono>
#include <vector>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/subdivision_method_3.h>

#include "subdivide_peers.h"

double cgal_subdivide(const cage *input, int levels, uint64_t *faces)
{
    using Mesh = CGAL::Surface_mesh<CGAL::Simple_cartesian<double>::Point_3>;
    Mesh mesh;
    for (uint64_t v = 0; v < input->vertex_count; v++)
        mesh.add_vertex({input->positions[3 * v], input->positions[3 * v + 1], input->positions[3 * v + 2]});
    std::vector<Mesh::Vertex_index> corners(input->sides);
    for (uint64_t f = 0; f < input->face_count; f++) {
        for (uint32_t k = 0; k < input->sides; k++)
            corners[k] = Mesh::Vertex_index(input->corners[input->sides * f + k]);
        mesh.add_face(corners);
    }
    auto begin = std::chrono::steady_clock::now();
    auto parameters = CGAL::parameters::number_of_iterations(static_cast<unsigned>(levels));
    if (input->sides == 3)
        CGAL::Subdivision_method_3::Loop_subdivision(mesh, parameters);
    else
        CGAL::Subdivision_method_3::CatmullClark_subdivision(mesh, parameters);
    double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    *faces = mesh.number_of_faces();
    return seconds;
}
