#include "iso/host_remote.h"

/* Bricks that a thread takes at a time, and fewer than it pays to wake other threads for. */
enum { SHARE = 64, ALONE = 512 };

/* As find_slot() in slot.h: the brick's slot or a stand-in, also below 0 (wrapped around). */
static uint32_t find_slot(const hewn_host_remote *view, const uint32_t brick[3])
{
    uint32_t shift = 2 * (view->levels - 1), block[3];
    for (int axis = 0; axis < 3; axis++) {
        block[axis] = brick[axis] >> shift;
        if (block[axis] >= view->top[axis])
            return HEWN_ALL_OUTSIDE;
    }
    uint32_t state = view->states[0][block[0] + (uint64_t)view->top[0] * (block[1] + view->top[1] * block[2])];
    for (uint32_t level = 1; level < view->levels && state < HEWN_ALL_OUTSIDE; level++) {
        uint32_t down = shift - 2 * level;
        uint32_t child = (brick[0] >> down & 3) | (brick[1] >> down & 3) << 2 | (brick[2] >> down & 3) << 4;
        state = view->states[level][(uint64_t)64 * state + child];
    }
    return state;
}

/* Where there are no samples of both signs there is no cut. Bit x + 4 y + 16 z. */
static uint64_t cuts_of(const hewn_host_remote *view, const uint32_t brick[3])
{
    uint32_t slot = find_slot(view, brick);
    if (slot >= HEWN_ALL_OUTSIDE)
        return 0;
    return view->cuts[2 * (uint64_t)slot] | (uint64_t)view->cuts[2 * (uint64_t)slot + 1] << 32;
}

/* What blocks beside them along an axis make of a brick's neighbourhood: `side` 0 is the brick before it, 1 itself, 2
 * the one after it. */
static uint64_t spread(uint64_t cuts, uint32_t axis, uint32_t side)
{
    static const uint64_t firsts[3] = {0x1111111111111111u, 0x000F000F000F000Fu, 0x000000000000FFFFu};
    uint32_t step = 1u << 2 * axis;
    uint64_t first = firsts[axis], last = first << 3 * step;
    switch (side) {
    case 0: return cuts >> 3 * step & first;
    case 1: return cuts | (cuts << step & ~first) | (cuts >> step & ~last);
    default: return cuts << 3 * step & last;
    }
}

static uint64_t neighbourhood(const hewn_host_remote *view, uint32_t packed)
{
    uint64_t near = 0;
    for (uint32_t z = 0; z < 3; z++) {
        uint64_t near_xy = 0;
        for (uint32_t y = 0; y < 3; y++) {
            uint64_t near_x = 0;
            for (uint32_t x = 0; x < 3; x++) {
                const uint32_t brick[3] = {(packed & 1023u) + x - 1, (packed >> 10 & 1023u) + y - 1,
                                           (packed >> 20 & 1023u) + z - 1};
                near_x |= spread(cuts_of(view, brick), 0, x);
            }
            near_xy |= spread(near_x, 1, y);
        }
        near |= spread(near_xy, 2, z);
    }
    return near;
}

void hewn_host_remote_find(const hewn_host_remote *view, uint32_t *remote)
{
#pragma omp parallel for schedule(dynamic, SHARE) if (view->count >= ALONE)
    for (uint32_t slot = 0; slot < view->count; slot++) {
        uint64_t near = neighbourhood(view, view->bricks[slot]);
        remote[2 * (uint64_t)slot] = (uint32_t)~near;
        remote[2 * (uint64_t)slot + 1] = (uint32_t)(~near >> 32);
    }
}
