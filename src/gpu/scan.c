#include "gpu/scan.h"

#include "base/alloc.h"
#include "base/error.h"
#include "gpu/device.h"
#include "shared/scan.h"

extern const unsigned char hewn_shader_scan_apply[], hewn_shader_scan_prepare[], hewn_shader_scan_reduce[];
extern const size_t hewn_shader_scan_apply_size, hewn_shader_scan_prepare_size, hewn_shader_scan_reduce_size;

struct hewn_scan {
    hewn_program *reduce, *apply, *prepare;
    hewn_buffer levels; /* HEWN_SCAN_LEVELS of struct hewn_scan_level, written anew by each indirect scan */
};

/* The sizes of a sum's levels for the most values that there may be. */
typedef struct level_plan {
    uint32_t depth;                     /* levels in use */
    uint32_t counts[HEWN_SCAN_LEVELS];  /* values of each */
    uint64_t offsets[HEWN_SCAN_LEVELS]; /* bytes into the scratch; of no meaning for level 0 */
    uint64_t scratch_bytes;
} level_plan;

static uint32_t blocks_of(uint32_t count)
{
    uint32_t blocks = count / HEWN_SCAN_BLOCK + (count % HEWN_SCAN_BLOCK != 0);
    return blocks ? blocks : 1;
}

static level_plan make_plan(uint32_t count)
{
    level_plan plan = {.depth = 1, .counts = {count}};
    while (plan.counts[plan.depth - 1] > HEWN_SCAN_BLOCK) {
        plan.counts[plan.depth] = blocks_of(plan.counts[plan.depth - 1]);
        plan.offsets[plan.depth] = plan.scratch_bytes;
        plan.scratch_bytes += (uint64_t)plan.counts[plan.depth] * 8;
        plan.depth++;
    }
    return plan;
}

static hewn_result create_program(hewn_device *device, const char *name, const unsigned char *spirv, size_t bytes,
                                  uint32_t push_bytes, bool soon, hewn_program **out, hewn_error *error)
{
    /* The array is aligned for words where it is defined. */
    const hewn_program_desc desc = {
        .name = name, .spirv = (const void *)spirv, .spirv_bytes = bytes, .push_bytes = push_bytes, .soon = soon};
    return hewn_program_create(device, &desc, out, error);
}

static hewn_result create_parts(hewn_device *device, hewn_scan *scan, bool soon, hewn_error *error)
{
    HEWN_TRY(create_program(device, "scan_reduce", hewn_shader_scan_reduce, hewn_shader_scan_reduce_size,
                            sizeof(struct hewn_scan_push), soon, &scan->reduce, error));
    HEWN_TRY(create_program(device, "scan_apply", hewn_shader_scan_apply, hewn_shader_scan_apply_size,
                            sizeof(struct hewn_scan_push), soon, &scan->apply, error));
    HEWN_TRY(create_program(device, "scan_prepare", hewn_shader_scan_prepare, hewn_shader_scan_prepare_size,
                            sizeof(struct hewn_scan_prepare_push), soon, &scan->prepare, error));
    return hewn_buffer_create(device, "the levels of a prefix sum", HEWN_SCAN_LEVELS * sizeof(struct hewn_scan_level),
                              HEWN_BUFFER_DEVICE, &scan->levels, error);
}

hewn_result hewn_scan_create(hewn_device *device, bool soon, hewn_scan **out, hewn_error *error)
{
    *out = NULL;
    hewn_scan *scan = hewn_alloc_zero(1, sizeof *scan);
    if (!scan)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory creating a prefix sum");
    hewn_result result = create_parts(device, scan, soon, error);
    if (result != HEWN_OK)
        hewn_scan_destroy(device, &scan);
    *out = scan;
    return result;
}

void hewn_scan_destroy(hewn_device *device, hewn_scan **scan_pointer)
{
    hewn_scan *scan = *scan_pointer;
    if (!scan)
        return;
    hewn_program_destroy(device, &scan->reduce);
    hewn_program_destroy(device, &scan->apply);
    hewn_program_destroy(device, &scan->prepare);
    hewn_buffer_destroy(device, &scan->levels);
    hewn_free(scan);
    *scan_pointer = NULL;
}

uint64_t hewn_scan_scratch_bytes(uint64_t count)
{
    return count > UINT32_MAX ? 0 : make_plan((uint32_t)count).scratch_bytes;
}

/* One step over one level; `levels` is the scan's buffer where only the device knows the counts. */
static void record_step(hewn_commands *commands, hewn_program *program, const hewn_buffer *levels, uint32_t level,
                        uint32_t count, struct hewn_scan_push push)
{
    push.count = count;
    if (levels) {
        const uint64_t offset = level * sizeof(struct hewn_scan_level);
        push.counter = levels->address + offset + offsetof(struct hewn_scan_level, count);
        hewn_commands_dispatch_indirect(commands, program, &push, NULL, levels,
                                        offset + offsetof(struct hewn_scan_level, groups));
    } else {
        uint32_t blocks = blocks_of(count);
        const hewn_dispatch_size groups = {blocks < HEWN_SCAN_ROW ? blocks : HEWN_SCAN_ROW,
                                           (blocks + HEWN_SCAN_ROW - 1) / HEWN_SCAN_ROW, 1};
        hewn_commands_dispatch(commands, program, &push, NULL, groups);
    }
}

/* Reduce upward, the last one into the total; then apply downward. */
static void record_levels(hewn_scan *scan, hewn_commands *commands, const level_plan *plan, const hewn_buffer *levels,
                          uint64_t values, uint64_t total, uint64_t scratch)
{
    uint64_t lows[HEWN_SCAN_LEVELS + 1], highs[HEWN_SCAN_LEVELS + 1];
    lows[0] = values;
    highs[0] = 0;
    for (uint32_t i = 1; i < plan->depth; i++) {
        lows[i] = scratch + plan->offsets[i];
        highs[i] = lows[i] + (uint64_t)plan->counts[i] * 4;
    }
    lows[plan->depth] = total;
    highs[plan->depth] = total + 4;
    for (uint32_t i = 0; i < plan->depth; i++)
        record_step(commands, scan->reduce, levels, i, plan->counts[i],
                    (struct hewn_scan_push){
                        .values = lows[i], .highs = highs[i], .sums = lows[i + 1], .sum_highs = highs[i + 1]});
    for (uint32_t i = plan->depth; i-- > 0;)
        record_step(commands, scan->apply, levels, i, plan->counts[i],
                    (struct hewn_scan_push){.values = lows[i], .sums = i + 1 < plan->depth ? lows[i + 1] : 0});
}

void hewn_scan_record(hewn_scan *scan, hewn_commands *commands, uint64_t values, uint64_t count, uint64_t total,
                      uint64_t scratch)
{
    if (count > UINT32_MAX) {
        hewn_commands_fail(commands, HEWN_LIMIT, "a prefix sum of %llu values is too long", (unsigned long long)count);
        return;
    }
    level_plan plan = make_plan((uint32_t)count);
    record_levels(scan, commands, &plan, NULL, values, total, scratch);
}

void hewn_scan_record_indirect(hewn_scan *scan, hewn_commands *commands, uint64_t values, uint64_t count_address,
                               uint64_t capacity, uint64_t total, uint64_t scratch)
{
    if (capacity > UINT32_MAX) {
        hewn_commands_fail(commands, HEWN_LIMIT, "a prefix sum of %llu values is too long",
                           (unsigned long long)capacity);
        return;
    }
    level_plan plan = make_plan((uint32_t)capacity);
    const struct hewn_scan_prepare_push push = {
        .counter = count_address, .levels = scan->levels.address, .capacity = (uint32_t)capacity};
    hewn_commands_dispatch(commands, scan->prepare, &push, NULL, (hewn_dispatch_size){1, 1, 1});
    record_levels(scan, commands, &plan, &scan->levels, values, total, scratch);
}

hewn_result hewn_scan_check(const uint32_t total[2], const char *what, hewn_error *error)
{
    if (total[1] == 0)
        return HEWN_OK;
    return hewn_fail(error, HEWN_LIMIT, "%llu %s are more than 32-bit numbers count",
                     (unsigned long long)total[1] << 32 | total[0], what);
}
