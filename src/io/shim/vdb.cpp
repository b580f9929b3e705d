#include "io/shim/vdb.h"

#include <cstdio>
#include <cstring>
#include <exception>
#include <istream>
#include <memory>
#include <new>
#include <stdexcept>
#include <streambuf>
#include <string>
#include <type_traits>
#include <vector>

#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Dense.h>
#include <openvdb/tools/SignedFloodFill.h>

struct hewn_vdb {
    virtual ~hewn_vdb() = default;
    virtual void copy_box(const openvdb::CoordBBox &box, void *out) const = 0;
    virtual void leaf(uint64_t index, int32_t origin[3], void *samples) const = 0;
    virtual void tile(uint64_t index, int32_t origin[3], uint32_t *side, void *sample) const = 0;
    virtual void background(void *sample) const = 0;
    virtual void tell(hewn_vdb_facts *facts) const = 0;
};

namespace
{

/* A stream over bytes that are there already. */
class memory_buffer : public std::streambuf
{
  public:
    memory_buffer(const char *bytes, size_t length)
    {
        char *begin = const_cast<char *>(bytes); /* streambuf's type; it is only read */
        setg(begin, begin, begin + length);
    }

  protected:
    pos_type seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode) override
    {
        char *base = from == std::ios_base::beg ? eback() : from == std::ios_base::cur ? gptr() : egptr();
        if (offset < eback() - base || offset > egptr() - base)
            return pos_type(off_type(-1));
        setg(eback(), base + offset, egptr());
        return pos_type(gptr() - eback());
    }
    pos_type seekpos(pos_type position, std::ios_base::openmode mode) override
    {
        return seekoff(off_type(position), std::ios_base::beg, mode);
    }
};

template <typename Grid>
constexpr hewn_vdb_type type_of()
{
    using Value = typename Grid::ValueType;
    return std::is_same_v<Value, float>     ? HEWN_VDB_FLOAT
           : std::is_same_v<Value, double>  ? HEWN_VDB_DOUBLE
           : std::is_same_v<Value, int32_t> ? HEWN_VDB_INT32
           : std::is_same_v<Value, int64_t> ? HEWN_VDB_INT64
                                            : HEWN_VDB_BOOL;
}

std::string text_of(const openvdb::Coord &at)
{
    return "(" + std::to_string(at.x()) + ", " + std::to_string(at.y()) + ", " + std::to_string(at.z()) + ")";
}

/* OpenVDB takes some places from the file as they are, and then finds nothing there. A tree whose nodes all lie where
 * their parents have them, at multiples of their sides, has no two at one place. */
void check_place(const openvdb::GridBase &grid, const char *what, const openvdb::Coord &origin,
                 const openvdb::Coord &expected)
{
    if (origin != expected)
        throw std::runtime_error("grid '" + grid.getName() + "' has a " + what + " at " + text_of(origin) +
                                 ", which belongs at " + text_of(expected));
}

template <typename Grid, typename Lower>
void check_places(const Grid &grid, const std::vector<const Lower *> &lowers)
{
    const auto &root = grid.tree().root();
    constexpr auto side = int32_t(Grid::TreeType::RootNodeType::ChildNodeType::DIM);
    for (auto at = root.cbeginValueAll(); at; ++at)
        check_place(grid, "tile", at.getCoord(), at.getCoord() & ~(side - 1));
    for (auto at = root.cbeginChildOn(); at; ++at)
        check_place(grid, "node", at.getCoord(), at->origin());
    for (const Lower *node : lowers)
        for (auto at = node->cbeginChildOn(); at; ++at)
            check_place(grid, "leaf", at->origin(), at.getCoord());
}

template <typename Grid>
class held_grid : public hewn_vdb
{
    using Tree = typename Grid::TreeType;
    using Root = typename Tree::RootNodeType;
    using Upper = typename Root::ChildNodeType;
    using Lower = typename Upper::ChildNodeType;
    using Leaf = typename Tree::LeafNodeType;
    using Value = typename Grid::ValueType;
    static_assert(Leaf::DIM == 8 && Lower::DIM == 128 && Upper::DIM == 4096);

    struct constant_cube {
        openvdb::Coord origin;
        uint32_t side;
        Value value;
    };
    typename Grid::ConstPtr grid;
    std::vector<const Leaf *> leaves;
    std::vector<constant_cube> tiles;

    template <typename Node>
    void list_tiles(const Node &node, uint32_t side)
    {
        for (auto at = node.cbeginValueAll(); at; ++at) {
            const Value value = at.getValue();
            if (std::memcmp(&value, &grid->background(), sizeof value) != 0)
                tiles.push_back({at.getCoord(), side, value});
        }
    }

  public:
    explicit held_grid(typename Grid::ConstPtr from) : grid(std::move(from))
    {
        std::vector<const Upper *> uppers;
        std::vector<const Lower *> lowers;
        grid->tree().getNodes(leaves);
        grid->tree().getNodes(uppers);
        grid->tree().getNodes(lowers);
        check_places(*grid, lowers);
        list_tiles(grid->tree().root(), Upper::DIM);
        for (const Upper *node : uppers)
            list_tiles(*node, Lower::DIM);
        for (const Lower *node : lowers)
            list_tiles(*node, Leaf::DIM);
    }

    void copy_box(const openvdb::CoordBBox &box, void *out) const override
    {
        using Dense = openvdb::tools::Dense<typename Grid::ValueType, openvdb::tools::LayoutXYZ>;
        Dense dense(box, static_cast<typename Grid::ValueType *>(out));
        openvdb::tools::copyToDense(grid->tree(), dense);
    }

    void leaf(uint64_t index, int32_t origin[3], void *samples) const override
    {
        const Leaf *node = leaves[index];
        auto *to = static_cast<Value *>(samples);
        for (int axis = 0; axis < 3; axis++)
            origin[axis] = node->origin()[axis];
        if (!samples)
            return;
        if constexpr (std::is_same_v<Value, bool>) {
            for (openvdb::Index n = 0; n < HEWN_VDB_LEAF; n++)
                to[n] = node->getValue((n & 7) << 6 | (n & 0x38) | n >> 6);
        } else { /* OpenVDB has k fastest */
            const Value *from = node->buffer().data();
            for (unsigned y = 0; y < 8; y++)
                for (unsigned z = 0; z < 8; z++)
                    for (unsigned x = 0; x < 8; x++)
                        to[64 * z + 8 * y + x] = from[64 * x + 8 * y + z];
        }
    }

    void tile(uint64_t index, int32_t origin[3], uint32_t *side, void *sample) const override
    {
        const constant_cube &cube = tiles[index];
        for (int axis = 0; axis < 3; axis++)
            origin[axis] = cube.origin[axis];
        *side = cube.side;
        std::memcpy(sample, &cube.value, sizeof cube.value);
    }

    void background(void *sample) const override
    {
        std::memcpy(sample, &grid->background(), sizeof(Value));
    }

    void tell(hewn_vdb_facts *facts) const override
    {
        openvdb::CoordBBox box = grid->evalActiveVoxelBoundingBox();
        openvdb::Mat4d matrix = grid->transform().baseMap()->getAffineMap()->getMat4();
        std::snprintf(facts->name, sizeof facts->name, "%s", grid->getName().c_str());
        facts->type = type_of<Grid>();
        facts->level_set = grid->getGridClass() == openvdb::GRID_LEVEL_SET;
        facts->leaf_count = leaves.size();
        facts->tile_count = tiles.size();
        for (int row = 0; row < 4; row++)
            for (int column = 0; column < 4; column++)
                facts->to_world[4 * row + column] = matrix(column, row); /* OpenVDB multiplies rows from the left */
        for (int axis = 0; axis < 3; axis++) {
            facts->lo[axis] = box.min()[axis];
            facts->hi[axis] = box.max()[axis];
        }
    }
};

template <typename Grid>
bool hold(const openvdb::GridBase::Ptr &base, std::unique_ptr<hewn_vdb> *out)
{
    if (auto grid = openvdb::gridPtrCast<Grid>(base))
        *out = std::make_unique<held_grid<Grid>>(grid);
    return bool(*out);
}

/* Whether a grid is of scalars, and then held. */
bool hold_any(const openvdb::GridBase::Ptr &base, std::unique_ptr<hewn_vdb> *out)
{
    return hold<openvdb::FloatGrid>(base, out) || hold<openvdb::DoubleGrid>(base, out) ||
           hold<openvdb::Int32Grid>(base, out) || hold<openvdb::Int64Grid>(base, out) ||
           hold<openvdb::BoolGrid>(base, out);
}

std::string list(const openvdb::GridPtrVec &grids)
{
    std::string text;
    for (const auto &grid : grids)
        if (grid)
            text += (text.empty() ? "" : ", ") + grid->getName() + " (" + grid->valueType() + ")";
    return text.empty() ? "none" : text;
}

hewn_vdb_result fail(char *message, size_t room, const std::string &text)
{
    std::snprintf(message, room, "%s", text.c_str());
    for (char *at = message; *at; at++)
        if (static_cast<unsigned char>(*at) < 0x20 || static_cast<unsigned char>(*at) >= 0x7f)
            *at = '?';
    return HEWN_VDB_BAD;
}

hewn_vdb_result choose(const openvdb::GridPtrVec &grids, const char *name, std::unique_ptr<hewn_vdb> *out,
                       char *message, size_t room)
{
    for (const auto &grid : grids) {
        if (!grid || (name && grid->getName() != name) || !(hold_any(grid, out) || name))
            continue;
        if (!*out)
            return fail(message, room,
                        "grid '" + grid->getName() + "' is of " + grid->valueType() + ", not of scalars");
        if (!grid->transform().isLinear())
            return fail(message, room, "grid '" + grid->getName() + "' lies in a frustum, not in a lattice");
        if (grid->activeVoxelCount() == 0)
            return fail(message, room, "grid '" + grid->getName() + "' has no active voxel");
        return HEWN_VDB_OK;
    }
    return fail(message, room,
                (name ? "there is no grid '" + std::string(name) + "'; there are: "
                      : std::string("there is no grid of scalars; there are: ")) +
                    list(grids));
}

hewn_vdb_result open_grid(const char *bytes, size_t length, const char *name, hewn_vdb **out, hewn_vdb_facts *facts,
                          char *message, size_t room)
try {
    *out = nullptr;
    *facts = hewn_vdb_facts{};
    openvdb::initialize();
    memory_buffer buffer(bytes, length);
    std::istream stream(&buffer);
    /* OpenVDB does not look whether there was something to read, and would go through a count of billions. */
    stream.exceptions(std::ios::badbit | std::ios::failbit);
    openvdb::GridPtrVecPtr grids = openvdb::io::Stream(stream, false).getGrids();
    std::unique_ptr<hewn_vdb> held;
    hewn_vdb_result result = choose(*grids, name, &held, message, room);
    if (result == HEWN_VDB_OK) {
        held->tell(facts);
        *out = held.release();
    }
    return result;
} catch (const std::bad_alloc &) {
    std::snprintf(message, room, "out of memory for the grids");
    return HEWN_VDB_OUT_OF_MEMORY;
} catch (const std::ios::failure &) {
    return fail(message, room, "the file ends early, or is damaged");
} catch (const std::exception &failure) {
    return fail(message, room, failure.what());
} catch (...) {
    return fail(message, room, "OpenVDB cannot read it");
}

void close_grid(hewn_vdb **grid)
{
    delete *grid;
    *grid = nullptr;
}

hewn_vdb_result copy_box(const hewn_vdb *grid, const int32_t lo[3], const int32_t hi[3], void *out)
try {
    grid->copy_box(openvdb::CoordBBox(lo[0], lo[1], lo[2], hi[0], hi[1], hi[2]), out);
    return HEWN_VDB_OK;
} catch (const std::bad_alloc &) {
    return HEWN_VDB_OUT_OF_MEMORY;
} catch (...) {
    return HEWN_VDB_BAD;
}

void copy_leaf(const hewn_vdb *grid, uint64_t index, int32_t origin[3], void *samples)
{
    grid->leaf(index, origin, samples);
}

void copy_tile(const hewn_vdb *grid, uint64_t index, int32_t origin[3], uint32_t *side, void *sample)
{
    grid->tile(index, origin, side, sample);
}

void copy_background(const hewn_vdb *grid, void *sample)
{
    grid->background(sample);
}

/* A stream that hands its bytes on. */
class handing_buffer : public std::streambuf
{
    const hewn_vdb_level_set *what;

  public:
    explicit handing_buffer(const hewn_vdb_level_set *whose) : what(whose)
    {
    }

  protected:
    std::streamsize xsputn(const char *bytes, std::streamsize length) override
    {
        return what->take(what->user, bytes, size_t(length)) ? length : 0;
    }
    int_type overflow(int_type byte) override
    {
        char one = traits_type::to_char_type(byte);
        return what->take(what->user, &one, 1) ? byte : traits_type::eof();
    }
};

/* The sign spreads from the leaves to what is far inside: those tiles get the background's negative. */
openvdb::FloatGrid::Ptr build(const hewn_vdb_level_set *what)
{
    using Leaf = openvdb::FloatTree::LeafNodeType;
    auto grid = openvdb::FloatGrid::create(float(what->background));
    float values[HEWN_VDB_LEAF];
    uint8_t active[HEWN_VDB_LEAF];
    int32_t origin[3];
    while (what->next(what->user, origin, values, active)) {
        auto leaf = std::make_unique<Leaf>(openvdb::Coord(origin[0], origin[1], origin[2]), float(what->background));
        for (openvdb::Index n = 0; n < HEWN_VDB_LEAF; n++)
            if (active[n])
                leaf->setValueOn(n, values[n]);
            else
                leaf->setValueOff(n, values[n]);
        grid->tree().addLeaf(leaf.release());
    }
    openvdb::tools::signedFloodFill(grid->tree());
    return grid;
}

hewn_vdb_result write_level_set(const hewn_vdb_level_set *what, char *message, size_t room)
try {
    openvdb::initialize();
    auto grid = build(what);
    auto transform = openvdb::math::Transform::createLinearTransform(what->cell);
    transform->postTranslate({what->origin[0], what->origin[1], what->origin[2]});
    grid->setTransform(transform);
    grid->setName(what->name);
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    grid->setCreator("Hewn");
    if (what->unit)
        grid->insertMeta("unit", openvdb::StringMetadata(what->unit));
    grid->addStatsMetadata();
    handing_buffer buffer(what);
    std::ostream stream(&buffer);
    stream.exceptions(std::ios::badbit | std::ios::failbit);
    openvdb::io::Stream(stream).write(openvdb::GridPtrVec{grid});
    return HEWN_VDB_OK;
} catch (const std::bad_alloc &) {
    std::snprintf(message, room, "out of memory for a level set");
    return HEWN_VDB_OUT_OF_MEMORY;
} catch (const std::exception &failure) {
    return fail(message, room, failure.what());
} catch (...) {
    return fail(message, room, "OpenVDB cannot write it");
}

} // namespace

/* io/shim/module.h looks for this name. */
extern "C" __attribute__((visibility("default"))) const hewn_vdb_module hewn_module_table;
const hewn_vdb_module hewn_module_table = {open_grid, close_grid,      copy_box,       copy_leaf,
                                           copy_tile, copy_background, write_level_set};
