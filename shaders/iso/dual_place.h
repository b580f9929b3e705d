/* GLSL only: a cell as the place of a dual method's vertex. Included where `push` is a hewn_dual_vertex_push. */
#include "iso/dual_seen.h"

/* A cell's coordinates are in units of cells from its lowest corner. A vertex stays strictly within its cell, so that
 * those of two cells never fall together: 2^-15 of a cell from its faces, or two spacings of floats where these are
 * coarser. On the bounds no other cell follows, and a cell without thickness has no choice. */
struct Cell {
    vec3 corner;
    vec3 lo, hi;
};

const float KEPT_OFF = 1.0 / 32768.0;

Cell cell_of(DualRecord record)
{
    Cell cell;
    bool closed = push.grid.open == 0u; /* else the rim's cells follow beyond the bounds */
    uvec3 first = 8u * unpack_brick(push.bricks.at[record.slot]) + record.at;
    for (uint i = 0u; i < 3u; i++) {
        float low = sample_coordinate(push.grid, i, first[i]), high = sample_coordinate(push.grid, i, first[i] + 1u);
        float side = (high - low) / push.grid.cell;
        float off = max(KEPT_OFF, 2.4e-7 * max(abs(low), abs(high)) / push.grid.cell);
        bool flat_one = side < 2.5 * off;
        cell.corner[i] = low;
        cell.lo[i] = flat_one || (closed && low == push.grid.origin[i]) ? 0.0 : off;
        cell.hi[i] = flat_one ? 0.0 : closed && high == push.grid.far[i] ? side : side - off;
    }
    return cell;
}

vec3 into_cell(Cell cell, vec3 place)
{
    return (place - cell.corner) / push.grid.cell;
}

vec3 out_of_cell(Cell cell, vec3 at)
{
    precise vec3 place = cell.corner + push.grid.cell * at;
    return clamp(place, vec3(push.grid.origin[0], push.grid.origin[1], push.grid.origin[2]),
                 vec3(push.grid.far[0], push.grid.far[1], push.grid.far[2]));
}

/* Whether a crossing on this axis is where the surface was cut at the bounds. */
bool is_cap(vec3 point, uint axis)
{
    return push.grid.open == 0u && (point[axis] == push.grid.origin[axis] || point[axis] == push.grid.far[axis]);
}

void write_vertex(uint vertex, vec3 place, vec3 normal)
{
    for (uint i = 0u; i < 3u; i++) {
        push.positions.at[3u * vertex + i] = place[i];
        push.normals.at[3u * vertex + i] = normal[i];
    }
}

/* A vertex's normal: that of the surface there where its crossings' normals, which sum to `along`, agree within about
 * 37 degrees, and so are those of one smooth piece; else their mean. */
vec3 vertex_normal(vec4 seen, vec3 along, float count)
{
    float usual = length(along);
    bool smooth_here = seen.xyz != vec3(0.0) && usual > 0.8 * count;
    return smooth_here ? seen.xyz : usual > 0.0 ? along / usual : vec3(0.0, 0.0, 1.0);
}

/* Adds a vertex to what both methods sum up. */
void count_vertex(float off, bool capped)
{
    if (capped)
        atomicAdd(push.summary.at[HEWN_SUMMARY_CAPS], 1u);
    else if (abs(off) <= 3.0e38)
        atomicMax(push.summary.at[HEWN_SUMMARY_RESIDUAL], floatBitsToUint(abs(off)));
}
