#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Bounded_normal_change_filter.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_stop_predicate.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_plane_policies.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>

#include <chrono>
#include <cstdlib>

#include "samples.h"
#include "simplify_peers.h"

namespace simplification = CGAL::Surface_mesh_simplification;
using Kernel = CGAL::Simple_cartesian<double>;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

static Mesh make(const peer_input *input)
{
    Mesh mesh;
    for (uint64_t v = 0; v < input->vertex_count; v++)
        mesh.add_vertex({input->positions[3 * v], input->positions[3 * v + 1], input->positions[3 * v + 2]});
    for (uint64_t t = 0; t < input->triangle_count; t++) {
        const uint32_t *at = input->indices + 3 * t;
        mesh.add_face(Mesh::Vertex_index(at[0]), Mesh::Vertex_index(at[1]), Mesh::Vertex_index(at[2]));
    }
    return mesh;
}

static simplified finish(Mesh &mesh, std::chrono::steady_clock::time_point begin, double processor)
{
    simplified out = {};
    out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    out.processor_seconds = bench_processor_now() - processor;
    mesh.collect_garbage();
    out.vertex_count = mesh.number_of_vertices();
    out.triangle_count = mesh.number_of_faces();
    out.positions = static_cast<double *>(malloc(out.vertex_count * 3 * sizeof(double)));
    out.indices = static_cast<uint32_t *>(malloc(out.triangle_count * 3 * sizeof(uint32_t)));
    for (auto v : mesh.vertices())
        for (int axis = 0; axis < 3; axis++)
            out.positions[3 * static_cast<uint32_t>(v) + static_cast<uint32_t>(axis)] = mesh.point(v)[axis];
    uint64_t corner = 0;
    for (auto f : mesh.faces())
        for (auto v : mesh.vertices_around_face(mesh.halfedge(f)))
            out.indices[corner++] = static_cast<uint32_t>(v);
    return out;
}

/* Faces of a closed mesh are two thirds of its edges. */
simplified cgal_garland_heckbert(const peer_input *input, uint64_t target)
{
    Mesh mesh = make(input);
    auto begin = std::chrono::steady_clock::now();
    double processor = bench_processor_now();
    simplification::Count_stop_predicate<Mesh> stop(target * 3 / 2);
    simplification::GarlandHeckbert_plane_policies<Mesh, Kernel> policies(mesh);
    simplification::Bounded_normal_change_filter<> filter;
    simplification::edge_collapse(
        mesh, stop,
        CGAL::parameters::get_cost(policies.get_cost()).get_placement(policies.get_placement()).filter(filter));
    return finish(mesh, begin, processor);
}

simplified cgal_lindstrom_turk(const peer_input *input, uint64_t target)
{
    Mesh mesh = make(input);
    auto begin = std::chrono::steady_clock::now();
    double processor = bench_processor_now();
    simplification::Count_stop_predicate<Mesh> stop(target * 3 / 2);
    simplification::edge_collapse(mesh, stop);
    return finish(mesh, begin, processor);
}
