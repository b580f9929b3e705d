/* Looks for surface between the samples: asks remote cells for their intervals. One invocation a block of 4 x 4 x 4
 * cells, which walks down a tree of boxes: the block, its halves, cells, and the parts of cells. A box that excludes
 * surface is left with all that is in it; a cell of which a smallest part does not is a suspect. */
#include "iso/grid.h"
#include "iso/together.h"
#include "iso/whole_loops.h"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push
{
    hewn_suspect_push push;
};

/* Levels of the tree, and how many boxes a smallest one stands for along an axis of the block. */
const uint HALVES = 1u;
const uint CELLS = 2u;
const uint PARTS = 4u;
const uint PARTS_A_CELL = 1u << (PARTS - CELLS);
/* Boxes stand in Morton's order (1966), numbered by their first smallest part. */
const uint END = 1u << 3u * PARTS;
/* A block that has asked for so many boxes no longer looks into its cells. */
const uint MOST_ASKED = 2048u;

/* Every third bit of a Morton number, pulled together. */
uint third_bits(uint number)
{
    number &= 0x1249u;
    number = (number | number >> 2) & 0x10C3u;
    number = (number | number >> 4) & 0x010Fu;
    return (number | number >> 4) & 0x001Fu;
}

uvec3 part_place(uint number)
{
    return uvec3(third_bits(number), third_bits(number >> 1), third_bits(number >> 2));
}

/* Where part i of an axis begins, counted from the grid's origin. */
float part_coordinate(uint axis, uint i)
{
    uint cell = i / PARTS_A_CELL;
    float start = sample_coordinate(push.grid, axis, cell);
    float end = sample_coordinate(push.grid, axis, cell + 1u);
    precise float at = start + (end - start) * (float(i % PARTS_A_CELL) / float(PARTS_A_CELL));
    return at;
}

/* A box is its level and its number. Cells are bits of two words in Morton's order too. */
uvec2 box_cells(uvec2 box)
{
    uint cell = box.y >> 3u * (PARTS - CELLS);
    uint bits = (box.x == HALVES ? 0xFFu : 1u) << (cell & 31u);
    return box.x == 0u ? uvec2(0xFFFFFFFFu) : cell < 32u ? uvec2(bits, 0u) : uvec2(0u, bits);
}

/* The first box of those that hold cells which are left: all or none of a half are, but for those past the grid. */
uvec2 first_box(uvec2 left)
{
    uint cell = left.x != 0u ? uint(findLSB(left.x)) : 32u + uint(findLSB(left.y));
    cell = left == uvec2(0u) ? 64u : cell;
    return uvec2((cell & 7u) == 0u ? HALVES : CELLS, cell << 3u * (PARTS - CELLS));
}

/* What follows a box in the order. */
uvec2 next_box(uvec2 box)
{
    uint number = box.y + (1u << 3u * (PARTS - box.x));
    return uvec2(PARTS - uint(findLSB(number)) / 3u, number);
}

/* The field's interval on a box; on a whole block, on the least box of halves around the cells that are left. In
 * Morton's order a half is a byte of the two words, and its place the byte's number. */
vec2 ask(uvec2 box, uvec2 left, uvec3 origin, uvec3 limit)
{
    uint all = left.x | left.y;
    bvec3 low_empty = equal(uvec3(all & 0x00FF00FFu, all & 0x0000FFFFu, left.x), uvec3(0u));
    bvec3 high_empty = equal(uvec3(all & 0xFF00FF00u, all & 0xFFFF0000u, left.y), uvec3(0u));
    uint side = 1u << (PARTS - box.x), middle = box.x == 0u ? 1u << (PARTS - HALVES) : 0u;
    uvec3 lo = part_place(box.y), hi = lo + side;
    lo += middle * uvec3(low_empty);
    hi -= middle * uvec3(high_empty);
    vec2 sides[3];
    for (uint axis = 0u; axis < 3u; axis++)
        sides[axis] = vec2(part_coordinate(axis, min(origin[axis] + lo[axis], limit[axis])),
                           part_coordinate(axis, min(origin[axis] + hi[axis], limit[axis])));
    return field_interval(sides[0], sides[1], sides[2]);
}

/* The bits of the cells whose place along an axis is less than `room`, where `low` and `high` tell the bits of the place. */
uvec2 cells_below(uint room, uvec2 low, uvec2 high)
{
    uvec2 cells = room > 1u ? ~high : ~(high | low);
    cells = room > 2u ? ~(high & low) : cells;
    return room > 3u ? uvec2(~0u) : room > 0u ? cells : uvec2(0u);
}

/* The block's remote cells. `corner` is its place in the brick, `room` the number of the grid's cells from there on, of
 * which the first `rim` have no thickness. */
uvec2 remote_cells(uint slot, uvec3 corner, uvec3 rim, uvec3 room)
{
    uvec3 half_at = corner / 2u;
    uint halves = push.remote.at[2u * slot + half_at.z / 2u] >> (half_at.x + 4u * half_at.y);
    uvec2 layers = uvec2(halves, halves >> 16);
    layers = layers & 3u | layers >> 2u & 12u;
    uvec2 cells = 0xFFu * (layers * 0x00204081u & 0x01010101u); /* a byte for each bit */
    const uvec2 low[3] = uvec2[3](uvec2(0xAAAAAAAAu), uvec2(0xCCCCCCCCu), uvec2(0xF0F0F0F0u));
    const uvec2 high[3] = uvec2[3](uvec2(0xFF00FF00u), uvec2(0xFFFF0000u), uvec2(0u, ~0u));
    for (uint axis = 0u; axis < 3u; axis++)
        cells &= cells_below(room[axis], low[axis], high[axis]) & ~cells_below(rim[axis], low[axis], high[axis]);
    return cells;
}

/* Whether a block's remote cells are inside: those of one block have one sign, since none of its halves is farther from
 * another than the neighbourhood reaches. */
bool are_inside(uvec2 remote, uint slot, uvec3 corner)
{
    uvec3 at = corner + part_place(first_box(remote).y) / PARTS_A_CELL;
    uint word = push.signs.at[slot * HEWN_BRICK_WORDS + 2u * at.z + (at.y >> 2)];
    return (word >> (at.x + 8u * (at.y & 3u)) & 1u) != 0u;
}

/* Two words count on where one overflows. */
void add_to(uint which, uint count)
{
    uint before = atomicAdd(push.counts.at[which], count);
    if (before + count < before)
        atomicAdd(push.counts.at[which + 1u], 1u);
}

void main()
{
    uint block = invocation();
    if (block >= 8u * push.count)
        return;
    uvec2 suspects = uvec2(0u);
    uint undefined = 0u, asked = 0u;
    uint slot = block >> 3;
    uvec3 corner = 4u * (uvec3(block, block >> 1, block >> 2) & 1u);
    field_select(slot);
    uvec3 first = 8u * unpack_brick(push.bricks.at[slot]) + corner;
    uvec3 cells = uvec3(push.grid.cells[0], push.grid.cells[1], push.grid.cells[2]);
    uvec3 room = max(cells - push.grid.rim, first) - first;
    uvec2 left = remote_cells(slot, corner, max(uvec3(push.grid.rim), first) - first, room);
    bool inside = are_inside(left, slot, corner);
    uvec3 origin = first * PARTS_A_CELL, limit = cells * PARTS_A_CELL;
    uvec2 box = left == uvec2(0u) ? uvec2(0u, END) : uvec2(0u);
    uvec2 before = left;
    while (somebody(box.y < END)) {
        before = left;
        bool on = box.y < END;
        vec2 range = ask(box, left, origin, limit);
        asked++;
        bool clear = inside ? range.y < 0.0 : range.x >= 0.0;
        bool smallest = box.x >= (asked < MOST_ASKED ? PARTS : CELLS);
        bool found = on && !clear && smallest, endless = f_is_endless(range);
        uvec2 cells = box_cells(box);
        suspects |= found && !endless ? cells : uvec2(0u);
        undefined += found && endless ? 1u : 0u;
        uvec2 next = next_box(box);
        bool over = found || (clear && next.x <= CELLS); /* with all its cells */
        left &= on && over ? ~cells : uvec2(~0u);
        uvec2 child = box.x == 0u ? first_box(left) : uvec2(box.x + 1u, box.y);
        uvec2 other = over ? first_box(left) : clear ? next : child;
        box = on ? other : box;
    }
    /* What was left before the last box, which may have got a wrong answer, is not known to be clear. */
    suspects |= loops_were_cut(push.count) ? before : uvec2(0u);
    push.marks.at[2u * block] = suspects.x;
    push.marks.at[2u * block + 1u] = suspects.y;
    uint count = uint(bitCount(suspects.x) + bitCount(suspects.y));
    if (count != 0u)
        add_to(HEWN_SUSPECT_CELLS, count);
    if (undefined != 0u)
        add_to(HEWN_SUSPECT_UNDEFINED, undefined);
}
