/* Places the vertices that lie in cells: one invocation a vertex. */
#include "iso/edge_vertex.h"
#include "iso/grid.h"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push
{
    hewn_mc33_centre_push push;
};

/* Whether an edge of the cell lies in a face of it. */
bool in_face(uint edge, uint face)
{
    uint axis = face >> 1, along = edge >> 2;
    uint place = axis == (along == 0u ? 1u : 0u) ? edge & 1u : edge >> 1 & 1u;
    return axis != along && place == (face & 1u);
}

void main()
{
    uint at = invocation();
    if (at >= push.count)
        return;
    uint vertex = push.first + at;
    uint slot = floatBitsToUint(push.positions.at[3u * vertex]);
    uint record = floatBitsToUint(push.positions.at[3u * vertex + 1u]);
    field_select(slot);
    uvec3 sample_at = uvec3(record, record >> 3, record >> 6) & 7u;
    uint face = record >> 21;
    /* Sums of what crossings are off the first of them keep the digits that matter. */
    vec3 origin = vec3(0.0), sum = vec3(0.0), near = vec3(0.0), normal = vec3(0.0);
    float count = 0.0, near_count = 0.0;
    for (uint edge = 0u; edge < 12u; edge++) {
        if ((record >> 9u + edge & 1u) == 0u)
            continue;
        uint other = 3u * edge_vertex(push.links, push.edges, slot, sample_at, edge);
        vec3 place = vec3(push.positions.at[other], push.positions.at[other + 1u], push.positions.at[other + 2u]);
        normal += vec3(push.normals.at[other], push.normals.at[other + 1u], push.normals.at[other + 2u]);
        origin = count == 0.0 ? place : origin;
        sum += place - origin;
        count += 1.0;
        if (face != 0u && in_face(edge, face - 1u)) {
            near += place - origin;
            near_count += 1.0;
        }
    }
    vec3 mean = sum / count;
    precise vec3 place = origin + (near_count > 0.0 ? 0.5 * (mean + near / near_count) : mean);
    vec4 gradient = field_gradient(place.x, place.y, place.z);
    float size = length(gradient.xyz), usual = length(normal);
    bool sloped = size > 0.0 && size <= 3.0e38;
    normal = sloped ? gradient.xyz / size : usual > 0.0 ? normal / usual : vec3(0.0, 0.0, 1.0);
    for (uint i = 0u; i < 3u; i++) {
        push.positions.at[3u * vertex + i] = place[i];
        push.normals.at[3u * vertex + i] = normal[i];
    }
    float residual = abs(gradient.w) / (size * push.grid.cell);
    if (sloped && residual <= 3.0e38)
        atomicMax(push.summary.at[HEWN_SUMMARY_RESIDUAL], floatBitsToUint(residual));
}
