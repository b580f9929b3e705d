#include "vdb_write.h"

#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Composite.h>
#include <openvdb/tools/LevelSetSphere.h>

#include <atomic>
#include <random>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <thread>

namespace
{

template <typename Grid>
openvdb::GridBase::Ptr make(const char *name, const int32_t dims[3], const double *values, const int32_t first[3],
                            const openvdb::math::Transform::Ptr &transform)
{
    auto grid = Grid::create();
    auto accessor = grid->getAccessor();
    grid->setName(name);
    grid->setTransform(transform);
    for (int z = 0; z < dims[2]; z++)
        for (int y = 0; y < dims[1]; y++)
            for (int x = 0; x < dims[0]; x++)
                if (double value = values[x + dims[0] * (y + dims[1] * z)]; value != 0)
                    accessor.setValue({x + first[0], y + first[1], z + first[2]}, typename Grid::ValueType(value));
    return grid;
}

} // namespace

void vdb_write(const char *path, const int32_t dims[3], const double *values, const int32_t first[3],
               const double to_world[16])
{
    openvdb::initialize();
    openvdb::Mat4d matrix;
    for (int row = 0; row < 4; row++)
        for (int column = 0; column < 4; column++)
            matrix(column, row) = to_world[4 * row + column];
    auto affine = openvdb::math::Transform::createLinearTransform(matrix);
    auto frustum = openvdb::math::Transform::createFrustumTransform(openvdb::BBoxd({0, 0, 0}, {10, 10, 10}), 0.5, 5);
    openvdb::GridPtrVec grids = {make<openvdb::Vec3SGrid>("velocity", dims, values, first, affine),
                                 make<openvdb::FloatGrid>("fog", dims, values, first, affine),
                                 make<openvdb::FloatGrid>("half", dims, values, first, affine),
                                 make<openvdb::DoubleGrid>("wide", dims, values, first, affine),
                                 make<openvdb::Int32Grid>("count", dims, values, first, affine),
                                 make<openvdb::BoolGrid>("mask", dims, values, first, affine),
                                 make<openvdb::FloatGrid>("frustum", dims, values, first, frustum),
                                 openvdb::FloatGrid::create()};
    grids[2]->setSaveFloatAsHalf(true);
    grids[7]->setName("empty");
    openvdb::io::File file(path);
    file.write(grids);
    file.close();
}

void vdb_write_spheres(const char *path, int count, const double centres[][3], double radius, bool half)
{
    openvdb::initialize();
    openvdb::FloatGrid::Ptr all;
    for (int n = 0; n < count; n++) {
        const openvdb::Vec3f centre{openvdb::Vec3d(centres[n])};
        auto one = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(float(radius), centre, 1.0F);
        if (all)
            openvdb::tools::csgUnion(*all, *one);
        else
            all = one;
    }
    all->setName("spheres");
    all->setSaveFloatAsHalf(half);
    openvdb::io::File file(path);
    file.write({all});
    file.close();
}

namespace
{

template <typename Grid>
openvdb::GridBase::Ptr make_tree(uint64_t seed)
{
    std::mt19937_64 random(seed);
    using Value = typename Grid::ValueType;
    auto value = [&] { return Value(int64_t(random() % 2001) - 1000) / 1000; };
    auto place = [&](int from, int to) { return from + int(random() % uint64_t(to - from)); };
    auto grid = Grid::create(value());
    auto &tree = grid->tree();
    if (seed % 3 == 0)
        tree.addTile(3, openvdb::Coord(place(-1, 1) * 4096, place(-1, 1) * 4096, 0), value(), false);
    for (int n = 0; n < int(seed % 5); n++)
        tree.addTile(2, openvdb::Coord(place(-2, 2) * 128, place(-2, 2) * 128, place(-1, 1) * 128), value(), false);
    for (int n = 0; n < 40; n++)
        tree.addTile(1, openvdb::Coord(place(-6, 6) * 8, place(-4, 4) * 8, place(-3, 3) * 8), value(),
                     random() % 2 == 0);
    for (int leaf = 0; leaf < 12; leaf++) {
        const openvdb::Coord origin(place(-6, 6) * 8, place(-4, 4) * 8, place(-3, 3) * 8);
        for (int n = 0; n < 512; n++)
            if (random() % 3 > 0) {
                const openvdb::Coord at = origin.offsetBy(n & 7, n >> 3 & 7, n >> 6);
                if (random() % 2)
                    tree.setValueOn(at, value());
                else
                    tree.setValueOff(at, value());
            }
    }
    tree.setValueOn(openvdb::Coord(place(-60, -40), place(-40, 0), 3), value());
    tree.setValueOn(openvdb::Coord(place(40, 60), place(0, 40), -3), value());
    grid->setName("tree");
    return grid;
}

} // namespace

void vdb_write_tree(const char *path, uint64_t seed, bool doubles)
{
    openvdb::initialize();
    openvdb::io::File file(path);
    file.write({doubles ? make_tree<openvdb::DoubleGrid>(seed) : make_tree<openvdb::FloatGrid>(seed)});
    file.close();
}

void vdb_write_mask(const char *path, const int32_t active[3], const int32_t passive[3], const int32_t tile[3])
{
    openvdb::initialize();
    auto grid = openvdb::BoolGrid::create(false);
    auto &tree = grid->tree();
    for (int n = 0; n < 512; n++)
        if ((n & 7) >= 2) {
            tree.setValueOn(openvdb::Coord(active).offsetBy(n & 7, n >> 3 & 7, n >> 6), true);
            tree.setValueOff(openvdb::Coord(passive).offsetBy(n & 7, n >> 3 & 7, n >> 6), true);
        }
    tree.addTile(3, openvdb::Coord(tile), true, false);
    grid->setName("mask");
    openvdb::io::File file(path);
    file.setCompression(openvdb::io::COMPRESS_NONE);
    file.write({grid});
    file.close();
}

void vdb_write_busy(bool on)
{
    static std::atomic<bool> busy;
    static std::thread thread;
    busy = on;
    if (!on)
        return thread.join();
    thread = std::thread([] {
        std::atomic<int> sum{0};
        while (busy) { /* arenas come and go under the locks that all of TBB shares */
            tbb::task_arena arena(2);
            arena.execute([&sum] { tbb::parallel_for(0, 64, [&sum](int n) { sum += n; }); });
        }
    });
}
