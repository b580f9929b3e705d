/* Surface nets: places a vertex at the mean of its loop's crossings. One invocation a vertex. */
#include "iso/dual_record.h"
#include "iso/grid.h"
#include "iso/whole_loops.h"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push
{
    hewn_dual_vertex_push push;
};

#include "iso/dual_place.h"

#include "iso/dual_ask.h"

void main()
{
    /* Nobody leaves, see iso/dual_ask.h: those past the end are at an empty loop. */
    uint vertex = invocation();
    bool there = vertex < push.count;
    DualRecord record = DualRecord(0u, uvec3(0u), 0u, 1u);
    if (there)
        record = dual_record(push.positions, vertex);
    Cell cell = cell_of(record);
    vec3 sum = vec3(0.0), along = vec3(0.0);
    float count = 0.0;
    bool capped = false;
    for (uint rest = record.edges; rest != 0u; rest &= rest - 1u) {
        uint edge = uint(findLSB(rest));
        uint crossing = edge_vertex(push.links, push.edges, record.slot, record.at, edge);
        vec3 point = load_vector(push.points, crossing);
        sum += into_cell(cell, point);
        along += load_vector(push.point_normals, crossing);
        capped = capped || is_cap(point, edge >> 2);
        count += 1.0;
    }
    vec3 place = out_of_cell(cell, clamp(sum / count, cell.lo, cell.hi));
    vec4 seen = surface_asked(record.slot, place, there);
    if (!there)
        return;
    write_vertex(vertex, place, vertex_normal(seen, along, count));
    count_vertex(seen.w, capped);
    if (loops_were_cut(push.count))
        atomicMax(push.summary.at[HEWN_SUMMARY_CUT], 1u);
}
