/* What the host asks while it places the vertices of a dual method, see iso/host_place.h: the surface as seen from
 * places. One invocation a question. */
#include "iso/brick.h"
#include "iso/grid.h"
#include "iso/whole_loops.h"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push
{
    hewn_dual_asked_push push;
};

#include "iso/dual_seen.h"

#include "iso/dual_ask.h"

void main()
{
    /* Nobody leaves, see iso/dual_ask.h: those past the end ask nothing. */
    uint question = invocation(), slot = 0u;
    bool there = question < push.count;
    vec3 place = vec3(0.0);
    if (there) {
        place = vec3(push.questions.at[4u * question], push.questions.at[4u * question + 1u],
                     push.questions.at[4u * question + 2u]);
        slot = floatBitsToUint(push.questions.at[4u * question + 3u]);
    }
    vec4 seen = surface_asked(slot, place, there);
    if (!there)
        return;
    for (uint i = 0u; i < 4u; i++)
        push.answers.at[4u * question + i] = seen[i];
    if (loops_were_cut(push.count))
        atomicMax(push.summary.at[HEWN_SUMMARY_CUT], 1u);
}
