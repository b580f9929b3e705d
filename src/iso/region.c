#include "iso/region.h"

#include <string.h>

#include "iso/extractor.h"

_Static_assert(HEWN_MAX_RESOLUTION <= 8 * 16 * 64, "three levels below at most 16 blocks a side: 30 bits");

static uint32_t top_count(const hewn_region *region)
{
    return region->top[0] * region->top[1] * region->top[2];
}

hewn_region hewn_region_whole(const struct hewn_grid *grid)
{
    hewn_region region = {0};
    hewn_grid_levels(grid, &region.levels, region.top);
    region.end = top_count(&region) << 6 * (region.levels - 1);
    return region;
}

uint32_t hewn_region_number(const hewn_region *region, uint32_t packed)
{
    uint32_t brick[3] = {packed & 1023, packed >> 10 & 1023, packed >> 20 & 1023};
    uint32_t shift = 2 * (region->levels - 1);
    uint32_t number =
        (brick[0] >> shift) + region->top[0] * ((brick[1] >> shift) + region->top[1] * (brick[2] >> shift));
    while (shift > 0) {
        shift -= 2;
        number = 64 * number + (brick[0] >> shift & 3) + 4 * (brick[1] >> shift & 3) + 16 * (brick[2] >> shift & 3);
    }
    return number;
}

uint32_t hewn_region_end(const hewn_region *whole, uint32_t begin, uint32_t length)
{
    uint32_t all = whole->end, block = 1u << 6 * (whole->levels - 1), unit = 1;
    length = length < 1 ? 1 : length;
    if (length >= all - begin)
        return all;
    const uint32_t units[] = {block, block * whole->top[0], block * whole->top[0] * whole->top[1]};
    for (uint32_t side = 4; side <= block && side <= length; side *= 4)
        unit = side;
    for (int i = 0; i < 3; i++)
        unit = units[i] <= length && units[i] > unit ? units[i] : unit;
    uint32_t end = (begin + length) / unit * unit;
    return end > begin ? end : begin + length;
}

void hewn_region_record(const hewn_region *region, hewn_program *clip, const hewn_region_level *level,
                        hewn_commands *commands)
{
    struct hewn_clip_push push = {.tested = level->tested,
                                  .level = level->level,
                                  .below = region->levels - 1 - level->level,
                                  .begin = region->begin,
                                  .end = region->end,
                                  .parents = level->parents,
                                  .states = level->states,
                                  .flags = level->flags};
    memcpy(push.top, region->top, sizeof push.top);
    if (level->level == 0)
        memcpy(push.dense, region->top, sizeof push.dense);
    hewn_commands_dispatch(commands, clip, &push, NULL, hewn_groups_for(level->tested, 64));
}
