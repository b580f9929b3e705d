/* Culling in levels: interval arithmetic drops blocks that cannot hold surface, and what is left is asked again in
 * parts, down to bricks. */
#include <string.h>

#include "base/error.h"
#include "eval/lists.h"
#include "iso/extractor.h"

typedef struct cull_level {
    uint32_t size;      /* cells along a block's side */
    uint64_t capacity;  /* blocks that may be tested */
    uint64_t kept_most; /* blocks that may be kept */
    hewn_buffer *states, *flags, *kept;
} cull_level;

typedef struct cull_plan {
    uint32_t levels;
    uint32_t top[3];
    cull_level level[HEWN_MAX_LEVELS]; /* coarsest first */
    hewn_buffer *control, *scratch, *results;
} cull_plan;

static void lay_levels(const struct hewn_grid *grid, cull_plan *plan)
{
    uint32_t blocks[3], shrink = hewn_grid_levels(grid, &plan->levels, plan->top) / 8;
    for (uint32_t i = 0; i < plan->levels; i++, shrink /= HEWN_LEVEL_RATIO) {
        cull_level *level = &plan->level[i];
        level->size = 8 * shrink;
        level->kept_most = hewn_grid_blocks(grid, shrink, blocks);
        level->capacity = i == 0 ? level->kept_most : 64 * plan->level[i - 1].kept_most;
    }
}

static hewn_result take_buffers(cull_plan *plan, hewn_workspace *workspace, hewn_error *error)
{
    uint64_t scratch = 0;
    for (uint32_t i = 0; i < plan->levels; i++) {
        cull_level *level = &plan->level[i];
        HEWN_TRY(hewn_workspace_take(workspace, "culling states", 4 * level->capacity, HEWN_BUFFER_DEVICE,
                                     &level->states, error));
        HEWN_TRY(hewn_workspace_take(workspace, "culling flags", 4 * level->capacity, HEWN_BUFFER_DEVICE, &level->flags,
                                     error));
        HEWN_TRY(hewn_workspace_take(workspace, "culling lists", 4 * level->kept_most, HEWN_BUFFER_DEVICE, &level->kept,
                                     error));
        uint64_t bytes = hewn_scan_scratch_bytes(level->capacity);
        scratch = bytes > scratch ? bytes : scratch;
    }
    HEWN_TRY(hewn_workspace_take(workspace, "culling scratch", scratch, HEWN_BUFFER_DEVICE, &plan->scratch, error));
    uint64_t control = 4 * HEWN_CONTROL_WORDS * (HEWN_MAX_LEVELS + 1);
    HEWN_TRY(hewn_workspace_take(workspace, "culling control", control, HEWN_BUFFER_DEVICE, &plan->control, error));
    return hewn_workspace_take(workspace, "culling results", control, HEWN_BUFFER_READBACK, &plan->results, error);
}

static void record_level(const hewn_extractor *extractor, const struct hewn_grid *grid, const cull_plan *plan,
                         uint32_t i, hewn_commands *commands)
{
    const cull_level *level = &plan->level[i];
    uint64_t offset = 4 * HEWN_CONTROL_WORDS * i, control = plan->control->address + offset;
    uint64_t parents = i == 0 ? 0 : plan->level[i - 1].kept->address;
    struct hewn_cull_push cull = {.grid = *grid,
                                  .size = level->size,
                                  .parents = parents,
                                  .tested = control + 4 * HEWN_CONTROL_TESTED,
                                  .states = level->states->address,
                                  .flags = level->flags->address};
    struct hewn_compact_push compact = {.parents = parents,
                                        .states = level->states->address,
                                        .ranks = level->flags->address,
                                        .control = control,
                                        .kept = level->kept->address};
    const hewn_buffer *uniforms = hewn_code_uniforms(extractor->code);
    uint64_t dispatch = offset + 4 * HEWN_CONTROL_DISPATCH;
    if (i == 0) {
        memcpy(cull.dense, plan->top, sizeof cull.dense);
        memcpy(compact.dense, plan->top, sizeof compact.dense);
        hewn_dispatch_size groups = hewn_groups_for(level->capacity, 64);
        hewn_commands_fill(commands, plan->control, 4 * HEWN_CONTROL_TESTED, 4, (uint32_t)level->capacity);
        hewn_commands_dispatch(commands, extractor->cull, &cull, uniforms, groups);
        hewn_scan_record(extractor->scan, commands, level->flags->address, level->capacity,
                         control + 4 * HEWN_CONTROL_KEPT, plan->scratch->address);
        hewn_commands_dispatch(commands, extractor->compact, &compact, NULL, groups);
    } else {
        hewn_commands_dispatch_indirect(commands, extractor->cull, &cull, uniforms, plan->control, dispatch);
        hewn_scan_record_indirect(extractor->scan, commands, level->flags->address, cull.tested, level->capacity,
                                  control + 4 * HEWN_CONTROL_KEPT, plan->scratch->address);
        hewn_commands_dispatch_indirect(commands, extractor->compact, &compact, NULL, plan->control, dispatch);
    }
}

hewn_result hewn_bricks_cull(const hewn_extractor *extractor, const struct hewn_grid *grid, hewn_workspace *workspace,
                             hewn_bricks *out, hewn_error *error)
{
    if (hewn_code_is_listed(extractor->code))
        return hewn_bricks_cull_lists(extractor, grid, NULL, workspace, out, error);
    cull_plan plan = {0};
    lay_levels(grid, &plan);
    HEWN_TRY(take_buffers(&plan, workspace, error));
    hewn_commands *commands;
    HEWN_TRY(hewn_commands_begin(extractor->device, &commands, error));
    for (uint32_t i = 0; i < plan.levels; i++)
        record_level(extractor, grid, &plan, i, commands);
    hewn_commands_copy(commands, plan.control, 0, plan.results, 0, plan.control->size);
    HEWN_TRY(hewn_commands_submit(&commands, NULL, error));
    const uint32_t *control = (const uint32_t *)plan.results->mapped + (uint64_t)HEWN_CONTROL_WORDS * (plan.levels - 1);
    out->count = control[HEWN_CONTROL_KEPT];
    out->levels = plan.levels;
    memcpy(out->top, plan.top, sizeof out->top);
    out->list = plan.level[plan.levels - 1].kept;
    for (uint32_t i = 0; i < plan.levels; i++)
        out->states[i] = plan.level[i].states;
    return HEWN_OK;
}
