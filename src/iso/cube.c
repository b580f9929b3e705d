#include "iso/cube.h"

uint32_t hewn_cube_edge_start(uint32_t edge)
{
    uint32_t axis = edge / 4, place = edge % 4;
    uint32_t low = axis == 0 ? 1 : 0, high = axis == 2 ? 1 : 2;
    return (place & 1) << low | (place >> 1) << high;
}

uint32_t hewn_cube_edge_between(uint32_t corner, uint32_t other)
{
    uint32_t bit = corner ^ other;
    uint32_t axis = bit >> 1; /* 1, 2, 4 to 0, 1, 2 */
    uint32_t low = axis == 0 ? 1 : 0, high = axis == 2 ? 1 : 2;
    return 4 * axis + ((corner >> low & 1) | (corner >> high & 1) << 1);
}

void hewn_cube_face_corners(uint32_t face, uint32_t corners[4])
{
    uint32_t axis = face / 2, side = face & 1;
    uint32_t u = 1u << (axis + 1) % 3, v = 1u << (axis + 2) % 3;
    uint32_t start = side << axis;
    /* (axis, u, v) is right-handed: u before v turns counter-clockwise as seen from the far side of the axis. */
    uint32_t first = side ? u : v, last = side ? v : u;
    corners[0] = start;
    corners[1] = start | first;
    corners[2] = start | u | v;
    corners[3] = start | last;
}

bool hewn_cube_edge_in_face(uint32_t edge, uint32_t face)
{
    uint32_t axis = face / 2, side = face & 1;
    return edge / 4 != axis && (hewn_cube_edge_start(edge) >> axis & 1) == side;
}

bool hewn_cube_edges_share_face(uint32_t edge, uint32_t other)
{
    uint32_t all_on = 7, all_off = 7;
    uint32_t starts[2] = {hewn_cube_edge_start(edge), hewn_cube_edge_start(other)};
    uint32_t axes[2] = {1u << edge / 4, 1u << other / 4};
    for (int i = 0; i < 2; i++) {
        all_on &= starts[i] & ~axes[i];
        all_off &= ~(starts[i] | axes[i]);
    }
    return (all_on | all_off) != 0;
}
