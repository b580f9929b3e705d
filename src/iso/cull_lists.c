/* Culling of a field in lists: each level's interval arithmetic walks the lists of the level above, and shorter ones
 * are made for the blocks it keeps; on CPU devices by the host, since a kernel reads memory there lane by lane. Counts
 * come home between levels, since only they tell how large the lists are. */
#include <string.h>

#include "base/error.h"
#include "eval/lists.h"
#include "iso/extractor.h"
#include "iso/host_lists.h"
#include "shared/lists.h"

enum { BRICK = 8 }; /* cells along a side */

typedef struct list_level {
    uint32_t number, tested, kept; /* 0 is the coarsest */
    uint32_t size;                 /* cells along a block's side */
    uint64_t choice_words;
    hewn_buffer *states, *flags, *lengths, *choices;
    hewn_buffer *list, *origins, *ranges, *instructions;
} list_level;

typedef struct list_run {
    const hewn_extractor *extractor;
    const struct hewn_grid *grid;
    const hewn_region *region; /* NULL: all of the grid */
    hewn_workspace *workspace;
    hewn_buffer *totals, *results;
    uint32_t top[3];
    bool at_top;
    uint32_t beyond; /* see hewn_bricks */
    list_level level, above;
} list_run;

static hewn_result take(list_run *run, const char *what, uint64_t bytes, hewn_buffer **out, hewn_error *error)
{
    return hewn_workspace_take(run->workspace, what, bytes, HEWN_BUFFER_DEVICE, out, error);
}

static hewn_result take_tested(list_run *run, hewn_buffer **scratch, hewn_error *error)
{
    list_level *level = &run->level;
    uint64_t tested = level->tested;
    HEWN_TRY(take(run, "culling states", 4 * tested, &level->states, error));
    HEWN_TRY(take(run, "culling flags", 4 * tested, &level->flags, error));
    HEWN_TRY(take(run, "culling lists", 4 * tested, &level->list, error));
    HEWN_TRY(take(run, "culling origins", 4 * tested, &level->origins, error));
    HEWN_TRY(take(run, "lengths of lists", 4 * (tested + 1), &level->lengths, error));
    HEWN_TRY(take(run, "choices of lists", 4 * level->choice_words, &level->choices, error));
    return take(run, "culling scratch", hewn_scan_scratch_bytes(tested + 1), scratch, error);
}

static uint64_t address_of(const hewn_buffer *buffer)
{
    return buffer ? buffer->address : 0;
}

static void record_clip(const list_run *run, hewn_commands *commands)
{
    const list_level *level = &run->level;
    hewn_region_level tested = {.level = level->number,
                                .tested = level->tested,
                                .parents = address_of(run->above.list),
                                .states = level->states->address,
                                .flags = level->flags->address};
    if (run->region)
        hewn_region_record(run->region, run->extractor->clip, &tested, commands);
}

static void record_choose(const list_run *run, hewn_commands *commands)
{
    const list_level *level = &run->level;
    struct hewn_choose_push push = {.grid = *run->grid,
                                    .size = level->size,
                                    .tested = level->tested,
                                    .beyond = level->size > BRICK ? run->beyond : 0,
                                    .parents = address_of(run->above.list),
                                    .parent_ranges = address_of(run->above.ranges),
                                    .states = level->states->address,
                                    .flags = level->flags->address,
                                    .choices = level->choices->address};
    if (run->at_top)
        memcpy(push.dense, run->top, sizeof push.dense);
    enum { BLOCKS = 4, GROUP = 16 };
    hewn_commands_dispatch(commands, run->extractor->choose, &push, hewn_code_uniforms(run->extractor->code),
                           hewn_groups_for(((uint64_t)level->tested + BLOCKS - 1) / BLOCKS, GROUP));
}

static void record_gather(const list_run *run, hewn_commands *commands)
{
    const list_level *level = &run->level;
    struct hewn_gather_push push = {.tested = level->tested,
                                    .parents = address_of(run->above.list),
                                    .states = level->states->address,
                                    .ranks = level->flags->address,
                                    .kept = level->list->address,
                                    .origins = level->origins->address};
    if (run->at_top)
        memcpy(push.dense, run->top, sizeof push.dense);
    hewn_commands_dispatch(commands, run->extractor->gather, &push, NULL, hewn_groups_for(level->tested, 64));
}

/* Counts the lists' instructions, or with buffers for them writes the lists. */
static void record_keep(const list_run *run, uint64_t blocks, hewn_commands *commands)
{
    const list_level *level = &run->level;
    const struct hewn_keep_push push = {.dense = run->at_top,
                                        .write = level->instructions != NULL,
                                        .kept = run->totals->address,
                                        .parent_ranges = address_of(run->above.ranges),
                                        .origins = level->origins->address,
                                        .places = level->lengths->address,
                                        .choices = level->choices->address,
                                        .lists = address_of(level->instructions),
                                        .ranges = address_of(level->ranges)};
    hewn_commands_dispatch(commands, run->extractor->keep_lists, &push, hewn_code_uniforms(run->extractor->code),
                           hewn_groups_for(blocks, 64));
}

static hewn_host_lists view_on_host(const list_run *run)
{
    const list_level *level = &run->level, *above = &run->above;
    hewn_host_lists view = {.tested = level->tested,
                            .parent_entries = hewn_code_whole_list(run->extractor->code),
                            .whole_count = hewn_code_instruction_count(run->extractor->code),
                            .choices = level->choices->mapped,
                            .states = level->states->mapped,
                            .kept = level->list->mapped,
                            .origins = level->origins->mapped,
                            .places = level->lengths->mapped};
    if (run->at_top) {
        memcpy(view.dense, run->top, sizeof view.dense);
    } else {
        view.parents = above->list->mapped;
        view.parent_entries = above->instructions->mapped;
        view.parent_ranges = above->ranges->mapped;
    }
    return view;
}

/* Lists the blocks that are kept, and counts their instructions. */
static void record_count(const list_run *run, const hewn_buffer *scratch, hewn_commands *commands)
{
    const list_level *level = &run->level;
    hewn_scan_record(run->extractor->scan, commands, level->flags->address, level->tested, run->totals->address,
                     scratch->address);
    record_gather(run, commands);
    record_keep(run, level->tested, commands);
    hewn_scan_record(run->extractor->scan, commands, level->lengths->address, (uint64_t)level->tested + 1,
                     run->totals->address + 8, scratch->address);
    hewn_commands_copy(commands, run->totals, 0, run->results, 0, 16);
}

/* Tests the level's blocks, and learns how many are kept and how many instructions their lists have. */
static hewn_result choose(list_run *run, uint32_t totals[4], hewn_error *error)
{
    list_level *level = &run->level;
    hewn_buffer *scratch;
    HEWN_TRY(take_tested(run, &scratch, error));
    hewn_commands *commands;
    HEWN_TRY(hewn_commands_begin(run->extractor->device, &commands, error));
    hewn_commands_fill(commands, level->lengths, 0, level->lengths->size, 0);
    record_choose(run, commands);
    record_clip(run, commands);
    if (!run->extractor->on_host)
        record_count(run, scratch, commands);
    HEWN_TRY(hewn_commands_submit(&commands, NULL, error));
    if (run->extractor->on_host) {
        const hewn_host_lists view = view_on_host(run);
        uint64_t instructions;
        totals[0] = hewn_host_lists_count(&view, &instructions);
        totals[2] = (uint32_t)instructions;
        totals[3] = (uint32_t)(instructions >> 32);
    } else {
        memcpy(totals, run->results->mapped, 16);
    }
    return hewn_scan_check(totals + 2, "instructions of lists", error);
}

static hewn_result make_lists(list_run *run, uint64_t instructions, hewn_error *error)
{
    list_level *level = &run->level;
    HEWN_TRY(take(run, "ranges of lists", (uint64_t)8 * level->kept, &level->ranges, error));
    HEWN_TRY(take(run, "instructions", HEWN_LIST_ENTRY * instructions + HEWN_LIST_SLACK, &level->instructions, error));
    if (run->extractor->on_host) {
        const hewn_host_lists view = view_on_host(run);
        hewn_host_lists_write(&view, level->kept, level->instructions->mapped, level->ranges->mapped);
    } else {
        hewn_commands *commands;
        HEWN_TRY(hewn_commands_begin(run->extractor->device, &commands, error));
        record_keep(run, level->kept, commands);
        HEWN_TRY(hewn_commands_submit(&commands, NULL, error));
    }
    hewn_code_lists lists = {.lists = level->instructions, .ranges = level->ranges, .origins = level->origins};
    if (!run->at_top) {
        lists.around = run->above.instructions;
        lists.around_ranges = run->above.ranges;
    }
    hewn_code_use_lists(run->extractor->code, &lists);
    return HEWN_OK;
}

/* Signs walk a list about four times, and choices once: what is longer would not be walked to its end. */
enum { LONGEST = 16000, MOST_INSTRUCTIONS = 60000 };

static hewn_result check_length(uint64_t length, uint64_t most, hewn_error *error)
{
    return length <= most
               ? HEWN_OK
               : hewn_fail(error, HEWN_LIMIT,
                           "%llu shapes matter in one place, more than the %llu that this device can look at",
                           (unsigned long long)length, (unsigned long long)most);
}

static uint32_t longest_list(const list_level *level)
{
    const uint32_t *ranges = level->ranges->mapped;
    uint32_t longest = 0;
    for (uint64_t i = 0; i < level->kept; i++)
        longest = ranges[2 * i + 1] > longest ? ranges[2 * i + 1] : longest;
    return longest;
}

hewn_result hewn_bricks_cull_lists(const hewn_extractor *extractor, const struct hewn_grid *grid,
                                   const hewn_region *region, hewn_workspace *workspace, hewn_bricks *out,
                                   hewn_error *error)
{
    list_run run = {.extractor = extractor, .grid = grid, .region = region, .workspace = workspace, .at_top = true};
    run.beyond = out->beyond;
    uint32_t size = hewn_grid_levels(grid, &out->levels, run.top);
    uint64_t count = (uint64_t)run.top[0] * run.top[1] * run.top[2];
    uint64_t words = (hewn_code_instruction_count(extractor->code) + 15) / 16 * count;
    memcpy(out->top, run.top, sizeof out->top);
    if (extractor->on_host)
        HEWN_TRY(check_length(hewn_code_instruction_count(extractor->code), MOST_INSTRUCTIONS, error));
    HEWN_TRY(hewn_workspace_take(workspace, "totals", 16, HEWN_BUFFER_DEVICE, &run.totals, error));
    HEWN_TRY(hewn_workspace_take(workspace, "totals", 16, HEWN_BUFFER_READBACK, &run.results, error));
    for (uint32_t i = 0; i < out->levels; i++, size /= HEWN_LEVEL_RATIO) {
        uint32_t totals[4] = {0};
        if (count > UINT32_MAX / 4)
            return hewn_fail(error, HEWN_LIMIT, "%llu blocks are too many to cull at once", (unsigned long long)count);
        run.level = (list_level){.number = i, .tested = (uint32_t)count, .size = size, .choice_words = words};
        HEWN_TRY(choose(&run, totals, error));
        run.level.kept = totals[0];
        if (totals[0] == 0)
            return HEWN_OK;
        HEWN_TRY(make_lists(&run, totals[2], error));
        out->states[i] = run.level.states;
        run.above = run.level;
        run.at_top = false;
        count = (uint64_t)64 * totals[0];
        words = (uint64_t)4 * totals[2] + count;
    }
    out->longest = extractor->on_host ? longest_list(&run.level) : 0;
    HEWN_TRY(check_length(out->longest, LONGEST, error));
    out->count = run.level.kept;
    out->list = run.level.list;
    return HEWN_OK;
}
