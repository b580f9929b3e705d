#include "vdb_look.h"

#include <cstdio>
#include <exception>

#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Diagnostics.h>

namespace
{

openvdb::GridPtrVecPtr read(const char *path)
{
    openvdb::initialize();
    openvdb::io::File file(path);
    file.open();
    auto grids = file.getGrids();
    file.close();
    return grids;
}

} // namespace

bool vdb_look(const char *path, vdb_facts *out)
try {
    auto grids = read(path);
    *out = vdb_facts{};
    out->grids = int(grids->size());
    auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(grids->at(0));
    out->floats = bool(grid);
    if (!grid)
        return true;
    std::snprintf(out->name, sizeof out->name, "%s", grid->getName().c_str());
    if (auto unit = grid->getMetadata<openvdb::StringMetadata>("unit"))
        std::snprintf(out->unit, sizeof out->unit, "%s", unit->value().c_str());
    out->level_set = grid->getGridClass() == openvdb::GRID_LEVEL_SET;
    out->background = double(grid->background());
    out->voxel = grid->voxelSize()[0];
    for (int i = 0; i < 3; i++)
        out->origin[i] = grid->indexToWorld(openvdb::Vec3d(0, 0, 0))[i];
    out->active = grid->activeVoxelCount();
    openvdb::tools::CheckLevelSet<openvdb::FloatGrid> check(*grid);
    std::snprintf(out->complaint, sizeof out->complaint, "%s", check.check(8).c_str()); /* all but norms of gradients */
    return true;
} catch (const std::exception &failure) {
    std::fprintf(stderr, "OpenVDB: %s\n", failure.what());
    return false;
}

bool vdb_values(const char *path, const int32_t *at, int count, float *out)
try {
    auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(read(path)->at(0));
    auto accessor = grid->getConstAccessor();
    for (int n = 0; n < count; n++)
        out[n] = accessor.getValue({at[3 * n], at[3 * n + 1], at[3 * n + 2]});
    return true;
} catch (const std::exception &failure) {
    std::fprintf(stderr, "OpenVDB: %s\n", failure.what());
    return false;
}
