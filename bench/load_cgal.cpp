#include <memory>
#include <string>

#include <CGAL/Polygon_mesh_processing/IO/polygon_mesh_io.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh/IO.h>

#include "load_peers.h"

namespace
{
using Mesh = CGAL::Surface_mesh<CGAL::Simple_cartesian<double>::Point_3>;
} // namespace

peer_loaded surface_mesh_load(const char *path)
{
    auto mesh = std::make_unique<Mesh>();
    if (!CGAL::IO::read_polygon_mesh(std::string(path), *mesh))
        return {nullptr, 0, 0};
    auto vertices = mesh->number_of_vertices(), faces = mesh->number_of_faces();
    return {mesh.release(), vertices, faces};
}

void surface_mesh_release(void *mesh)
{
    delete static_cast<Mesh *>(mesh);
}
