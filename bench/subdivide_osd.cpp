#include <chrono>
#include <memory>
#include <vector>

#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyDescriptor.h>

#include "subdivide_peers.h"

namespace
{
struct Point {
    double at[3];
    void Clear()
    {
        at[0] = at[1] = at[2] = 0;
    }
    void AddWithWeight(const Point &other, double weight)
    {
        for (int i = 0; i < 3; i++)
            at[i] += weight * other.at[i];
    }
};

double since(std::chrono::steady_clock::time_point begin)
{
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}
} // namespace

double osd_subdivide(const cage *input, int levels, double *topology, double *interpolation, uint64_t *faces)
{
    using namespace OpenSubdiv;
    std::vector<int> sides(input->face_count, static_cast<int>(input->sides));
    std::vector<int> corners(input->corners, input->corners + input->face_count * input->sides);
    std::vector<Point> from(input->vertex_count), to;
    for (size_t i = 0; i < 3 * from.size(); i++)
        from[i / 3].at[i % 3] = input->positions[i];
    Far::TopologyDescriptor descriptor;
    descriptor.numVertices = static_cast<int>(input->vertex_count);
    descriptor.numFaces = static_cast<int>(input->face_count);
    descriptor.numVertsPerFace = sides.data();
    descriptor.vertIndicesPerFace = corners.data();
    auto begin = std::chrono::steady_clock::now();
    using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
    std::unique_ptr<Far::TopologyRefiner> refiner(Factory::Create(
        descriptor, Factory::Options(input->sides == 3 ? Sdc::SCHEME_LOOP : Sdc::SCHEME_CATMARK, Sdc::Options())));
    refiner->RefineUniform(Far::TopologyRefiner::UniformOptions(levels));
    *topology = since(begin);
    begin = std::chrono::steady_clock::now();
    Far::PrimvarRefinerReal<double> primvars(*refiner);
    for (int i = 1; i <= levels; i++) {
        to.resize(static_cast<size_t>(refiner->GetLevel(i).GetNumVertices()));
        Point *target = to.data();
        primvars.Interpolate(i, from.data(), target);
        from.swap(to);
    }
    *interpolation = since(begin);
    *faces = static_cast<uint64_t>(refiner->GetLevel(levels).GetNumFaces());
    return *topology + *interpolation;
}
