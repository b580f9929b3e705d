/* Surface nets: places a vertex at the mean of its loop's crossings. One invocation a vertex. */
#include "iso/dual_record.h"
#include "iso/grid.h"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push
{
    hewn_dual_vertex_push push;
};

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

void main()
{
    uint vertex = invocation();
    if (vertex >= push.count)
        return;
    DualRecord record = dual_record(push.positions, vertex);
    /* Sums of what crossings are off the first of them keep the digits that matter. */
    vec3 origin = vec3(0.0), sum = vec3(0.0), along = vec3(0.0);
    float count = 0.0;
    bool capped = false;
    for (uint rest = record.edges; rest != 0u; rest &= rest - 1u) {
        uint edge = uint(findLSB(rest));
        uint crossing = edge_vertex(push.links, push.edges, record.slot, record.at, edge);
        vec3 point = load_vector(push.points, crossing);
        origin = count == 0.0 ? point : origin;
        sum += point - origin;
        along += load_vector(push.point_normals, crossing);
        capped = capped || is_cap(point, edge >> 2);
        count += 1.0;
    }
    precise vec3 place = origin + sum / count;
    vec4 gradient = field_gradient(place.x, place.y, place.z);
    float size = length(gradient.xyz), usual = length(along);
    bool sloped = size > 0.0 && size <= 3.0e38;
    /* Normals that agree within about 37 degrees are those of one smooth piece. */
    bool smooth_here = sloped && !capped && usual > 0.8 * count;
    vec3 normal = smooth_here ? gradient.xyz / size : usual > 0.0 ? along / usual : vec3(0.0, 0.0, 1.0);
    write_vertex(vertex, place, normal);
    if (capped)
        atomicAdd(push.summary.at[HEWN_SUMMARY_CAPS], 1u);
    float residual = abs(gradient.w) / (size * push.grid.cell);
    if (sloped && !capped && residual <= 3.0e38)
        atomicMax(push.summary.at[HEWN_SUMMARY_RESIDUAL], floatBitsToUint(residual));
}
