/* Culling of a part of the grid: level by level, and after each the host learns how many blocks are left, so that
 * memory is taken for those and no more. */
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "iso/extractor.h"

typedef struct part_level {
    uint32_t number, tested, size; /* 0 is the coarsest; blocks; cells along a side */
    hewn_buffer *states, *flags, *kept;
} part_level;

typedef struct part_cull {
    const hewn_extractor *extractor;
    const struct hewn_grid *grid;
    const hewn_region *region;
    hewn_workspace *workspace;
    hewn_buffer *control, *results; /* two levels' words: compaction sets up the next one */
    part_level level, above;
} part_cull;

static hewn_result take(const part_cull *run, const char *what, uint64_t words, hewn_buffer **out, hewn_error *error)
{
    return hewn_workspace_take(run->workspace, what, 4 * words, HEWN_BUFFER_DEVICE, out, error);
}

static uint64_t parents_of(const part_cull *run)
{
    return run->level.number == 0 ? 0 : run->above.kept->address;
}

/* Tests the level's blocks, takes back those that the part does not need, and counts the others. */
static hewn_result test_blocks(part_cull *run, uint32_t *kept, hewn_error *error)
{
    part_level *level = &run->level;
    hewn_buffer *scratch;
    HEWN_TRY(take(run, "culling states", level->tested, &level->states, error));
    HEWN_TRY(take(run, "culling flags", level->tested, &level->flags, error));
    HEWN_TRY(hewn_workspace_take(run->workspace, "culling scratch", hewn_scan_scratch_bytes(level->tested),
                                 HEWN_BUFFER_DEVICE, &scratch, error));
    struct hewn_cull_push cull = {.grid = *run->grid,
                                  .size = level->size,
                                  .parents = parents_of(run),
                                  .tested = run->control->address + 4 * HEWN_CONTROL_TESTED,
                                  .states = level->states->address,
                                  .flags = level->flags->address};
    if (level->number == 0)
        memcpy(cull.dense, run->region->top, sizeof cull.dense);
    hewn_region_level tested = {.level = level->number,
                                .tested = level->tested,
                                .parents = parents_of(run),
                                .states = level->states->address,
                                .flags = level->flags->address};
    const hewn_extractor *extractor = run->extractor;
    hewn_commands *commands;
    HEWN_TRY(hewn_commands_begin(extractor->device, &commands, error));
    hewn_commands_fill(commands, run->control, 4 * HEWN_CONTROL_TESTED, 4, level->tested);
    hewn_commands_dispatch(commands, extractor->cull, &cull, hewn_code_uniforms(extractor->code),
                           hewn_groups_for(level->tested, 64));
    hewn_region_record(run->region, extractor->clip, &tested, commands);
    hewn_scan_record(extractor->scan, commands, level->flags->address, level->tested,
                     run->control->address + 4 * HEWN_CONTROL_KEPT, scratch->address);
    hewn_commands_copy(commands, run->control, 4 * HEWN_CONTROL_KEPT, run->results, 0, 8);
    HEWN_TRY(hewn_commands_submit(&commands, NULL, error));
    *kept = *(const uint32_t *)run->results->mapped;
    return HEWN_OK;
}

static hewn_result list_kept(part_cull *run, uint32_t kept, hewn_error *error)
{
    part_level *level = &run->level;
    HEWN_TRY(take(run, "culling lists", kept, &level->kept, error));
    struct hewn_compact_push compact = {.parents = parents_of(run),
                                        .states = level->states->address,
                                        .ranks = level->flags->address,
                                        .control = run->control->address,
                                        .kept = level->kept->address};
    if (level->number == 0)
        memcpy(compact.dense, run->region->top, sizeof compact.dense);
    hewn_commands *commands;
    HEWN_TRY(hewn_commands_begin(run->extractor->device, &commands, error));
    hewn_commands_dispatch(commands, run->extractor->compact, &compact, NULL, hewn_groups_for(level->tested, 64));
    return hewn_commands_submit(&commands, NULL, error);
}

static hewn_result cull_straight(part_cull *run, hewn_bricks *out, hewn_error *error)
{
    uint64_t tested = (uint64_t)run->region->top[0] * run->region->top[1] * run->region->top[2];
    uint32_t top[3], size = hewn_grid_levels(run->grid, &out->levels, top);
    uint64_t control = 4 * HEWN_CONTROL_WORDS * 2;
    memcpy(out->top, run->region->top, sizeof out->top);
    HEWN_TRY(hewn_workspace_take(run->workspace, "culling control", control, HEWN_BUFFER_DEVICE, &run->control, error));
    HEWN_TRY(hewn_workspace_take(run->workspace, "culling results", 8, HEWN_BUFFER_READBACK, &run->results, error));
    for (uint32_t i = 0; i < out->levels; i++, size /= HEWN_LEVEL_RATIO) {
        uint32_t kept = 0;
        if (tested > UINT32_MAX / 4)
            return hewn_fail(error, HEWN_LIMIT, "%llu blocks are too many to cull at once", (unsigned long long)tested);
        run->level = (part_level){.number = i, .tested = (uint32_t)tested, .size = size};
        HEWN_TRY(test_blocks(run, &kept, error));
        if (kept == 0)
            return HEWN_OK;
        HEWN_TRY(list_kept(run, kept, error));
        out->states[i] = run->level.states;
        run->above = run->level;
        tested = (uint64_t)64 * kept;
        out->count = kept;
    }
    out->list = run->level.kept;
    return HEWN_OK;
}

hewn_result hewn_bricks_cull_part(const hewn_extractor *extractor, const struct hewn_grid *grid,
                                  const hewn_region *region, hewn_workspace *workspace, hewn_bricks *out,
                                  hewn_error *error)
{
    hewn_result result;
    *out = (hewn_bricks){0};
    if (hewn_code_is_listed(extractor->code)) {
        result = hewn_bricks_cull_lists(extractor, grid, region, workspace, out, error);
    } else {
        part_cull run = {.extractor = extractor, .grid = grid, .region = region, .workspace = workspace};
        result = cull_straight(&run, out, error);
    }
    if (!out->list)
        out->count = 0; /* none was left on the way */
    return result;
}
