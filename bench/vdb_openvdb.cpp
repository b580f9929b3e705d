#include "vdb_openvdb.h"

#include <chrono>
#include <vector>

#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <openvdb/tools/VolumeToMesh.h>
#include <tbb/global_control.h>

namespace
{
double now()
{
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}
} // namespace

void vdb_openvdb_write_sphere(const char *path, int voxels)
{
    openvdb::initialize();
    auto grid = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(1, openvdb::Vec3f(0), 2.0F / float(voxels));
    grid->setName("sphere");
    openvdb::io::File file(path);
    file.write({grid});
    file.close();
}

int vdb_openvdb_mesh(const char *path, int threads, double *read_seconds, double *mesh_seconds, uint64_t *quads)
{
    openvdb::initialize();
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, size_t(threads));
    double begin = now();
    openvdb::io::File file(path);
    file.open(false); /* all of it at once, as Hewn does */
    openvdb::FloatGrid::Ptr grid;
    auto grids = file.getGrids();
    for (const auto &one : *grids)
        if (!grid)
            grid = openvdb::gridPtrCast<openvdb::FloatGrid>(one);
    file.close();
    if (!grid)
        return 0;
    double read = now();
    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec3I> triangles;
    std::vector<openvdb::Vec4I> squares;
    openvdb::tools::volumeToMesh(*grid, points, triangles, squares, 0, 0);
    *read_seconds = read - begin;
    *mesh_seconds = now() - read;
    *quads = triangles.size() + squares.size();
    return 1;
}
