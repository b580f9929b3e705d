/* OpenVDB's grids: the box of their active samples, with one sample more on every side, so that a surface that the
 * outermost samples are inside of is closed by the background around it. In blocks where that may be, else dense. */
#include <string.h>

#include "base/error.h"
#include "io/shim/module.h"
#include "io/shim/vdb.h"
#include "io/volume/apart.h"
#include "io/volume/formats.h"
#include "volume/blocks.h"

static hewn_voxel type_of(hewn_vdb_type type)
{
    switch (type) {
    case HEWN_VDB_FLOAT: return HEWN_VOXEL_FLOAT;
    case HEWN_VDB_DOUBLE: return HEWN_VOXEL_DOUBLE;
    case HEWN_VDB_INT32: return HEWN_VOXEL_INT32;
    case HEWN_VDB_INT64: return HEWN_VOXEL_INT64;
    case HEWN_VDB_BOOL: return HEWN_VOXEL_UINT8;
    }
    return HEWN_VOXEL_FLOAT;
}

static hewn_result set_head(const hewn_volume_source *source, const hewn_vdb_facts *facts, int32_t lo[3], int32_t hi[3],
                            hewn_volume *volume, hewn_error *error)
{
    for (int axis = 0; axis < 3; axis++) {
        int64_t begin = (int64_t)facts->lo[axis] - 1, end = (int64_t)facts->hi[axis] + 1;
        if (begin < INT32_MIN || end > INT32_MAX || begin > end)
            return hewn_fail_at(error, HEWN_BAD_INPUT, source->name, 0, "grid '%s' reaches past what can be counted",
                                facts->name);
        lo[axis] = (int32_t)begin;
        hi[axis] = (int32_t)end;
        volume->dims[axis] = (uint32_t)(end - begin + 1);
    }
    const double *m = facts->to_world;
    for (int row = 0; row < 3; row++) {
        for (int column = 0; column < 3; column++)
            volume->to_world[4 * row + column] = m[4 * row + column];
        volume->to_world[4 * row + 3] =
            m[4 * row] * lo[0] + m[4 * row + 1] * lo[1] + m[4 * row + 2] * lo[2] + m[4 * row + 3];
    }
    volume->type = type_of(facts->type);
    volume->level_set = facts->level_set;
    return HEWN_OK;
}

static hewn_result fill_box(const hewn_volume_source *source, const hewn_vdb_module *module, const hewn_vdb *grid,
                            const hewn_vdb_facts *facts, const int32_t lo[3], const int32_t hi[3], hewn_volume *volume,
                            hewn_error *error)
{
    HEWN_TRY(hewn_volume_make_room(source, volume, error));
    hewn_vdb_result result = module->copy_box(grid, lo, hi, volume->memory);
    if (result == HEWN_VDB_OUT_OF_MEMORY)
        return hewn_fail_at(error, HEWN_OUT_OF_MEMORY, source->name, 0, "out of memory for grid '%s'", facts->name);
    if (result != HEWN_VDB_OK)
        return hewn_fail_at(error, HEWN_BAD_INPUT, source->name, 0, "OpenVDB cannot copy grid '%s'", facts->name);
    return HEWN_OK;
}

static hewn_result plan_blocks(const hewn_vdb_module *module, const hewn_vdb *grid, const hewn_vdb_facts *facts,
                               hewn_blocks_plan *plan, hewn_error *error)
{
    int32_t origin[3];
    bool added;
    for (uint64_t tile = 0; tile < facts->tile_count; tile++) {
        uint32_t side;
        uint64_t sample;
        module->tile(grid, tile, origin, &side, &sample);
        HEWN_TRY(hewn_blocks_add_constant(plan, origin, side, &sample, error));
    }
    for (uint64_t leaf = 0; leaf < facts->leaf_count; leaf++) {
        module->leaf(grid, leaf, origin, NULL);
        HEWN_TRY(hewn_blocks_add_block(plan, origin, &added, error));
    }
    return HEWN_OK;
}

/* Blocks have the order of leaves, of which some may lie outside of the box. */
static void fill_blocks(const hewn_vdb_module *module, const hewn_vdb *grid, const hewn_vdb_facts *facts,
                        const hewn_blocks_plan *plan, void *samples)
{
    const size_t bytes = HEWN_BLOCK_SAMPLES * hewn_voxel_size(plan->type);
    uint64_t block = 0;
    for (uint64_t leaf = 0; leaf < facts->leaf_count; leaf++) {
        int32_t origin[3];
        module->leaf(grid, leaf, origin, NULL);
        if (hewn_blocks_hold(plan, origin))
            module->leaf(grid, leaf, origin, (char *)samples + bytes * block++);
    }
}

static hewn_result make_blocks(const hewn_volume_source *source, const hewn_vdb_module *module, const hewn_vdb *grid,
                               const hewn_vdb_facts *facts, const int32_t lo[3], hewn_volume *volume, hewn_error *error)
{
    hewn_blocks_plan plan;
    uint64_t background;
    module->background(grid, &background);
    hewn_result result = hewn_blocks_begin(volume, lo, &background, &plan, error);
    if (result == HEWN_OK)
        result = plan_blocks(module, grid, facts, &plan, error);
    if (result == HEWN_OK)
        result = hewn_volume_make_blocks_room(source, hewn_blocks_bytes(&plan), volume, error);
    if (result == HEWN_OK)
        fill_blocks(module, grid, facts, &plan, hewn_blocks_finish(&plan, volume->memory));
    hewn_blocks_clear(&plan);
    return result;
}

static hewn_result read_grid(const hewn_volume_source *source, const hewn_vdb_module *module, const hewn_vdb *grid,
                             const hewn_vdb_facts *facts, hewn_volume *volume, hewn_error *error)
{
    int32_t lo[3], hi[3];
    HEWN_TRY(set_head(source, facts, lo, hi, volume, error));
    HEWN_TRY(hewn_volume_head_check(source, volume, NULL, error));
    if (source->desc->blocks)
        return make_blocks(source, module, grid, facts, lo, volume, error);
    return fill_box(source, module, grid, facts, lo, hi, volume, error);
}

hewn_result hewn_vdb_read_here(const hewn_volume_source *source, hewn_volume *out, hewn_error *error)
{
    hewn_vdb *grid;
    hewn_vdb_facts facts;
    char message[512];
    hewn_volume volume = hewn_volume_blank();
    *out = (hewn_volume){0};
    const hewn_vdb_module *module = hewn_module_load("hewn_vdb", message, sizeof message);
    if (!module)
        return hewn_fail_at(error, HEWN_MISSING_FEATURE, source->name, 0, "%s", message);
    hewn_vdb_result opened =
        module->open(source->bytes, source->length, source->desc->grid, &grid, &facts, message, sizeof message);
    if (opened != HEWN_VDB_OK)
        return hewn_fail_at(error, opened == HEWN_VDB_OUT_OF_MEMORY ? HEWN_OUT_OF_MEMORY : HEWN_BAD_INPUT, source->name,
                            0, "%s", message);
    hewn_result result = read_grid(source, module, grid, &facts, &volume, error);
    module->close(&grid);
    if (result != HEWN_OK) {
        hewn_volume_destroy(&volume);
        return result;
    }
    volume.name = hewn_volume_text(facts.name, strlen(facts.name));
    *out = volume;
    return HEWN_OK;
}

hewn_result hewn_vdb_read(hewn_volume_source *source, hewn_volume *out, hewn_error *error)
{
    const hewn_apart job = {.reader = HEWN_APART_VDB,
                            .source = source,
                            .name = source->name,
                            .desc = source->desc,
                            .choice = source->desc->grid};
    return hewn_volume_read_apart(&job, out, error);
}
