#include "vdb_write.h"

#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>

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
