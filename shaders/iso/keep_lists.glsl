/* Writes the list of each block that a level of culling kept: one invocation a block. */
#include "iso/choices.h"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push
{
    hewn_keep_push push;
};

void main()
{
    uint rank = invocation();
    if (rank >= push.count)
        return;
    uint at = push.origins.at[rank];
    uint first_choice = select_parent(at, push.dense != 0u, push.parent_ranges);
    uint begin = push.places.at[at], end = push.places.at[at + 1u];
    push.ranges.at[2u * rank] = begin;
    push.ranges.at[2u * rank + 1u] = end - begin;
    field_keep(hewn_words(uvec2(push.choices)), first_choice, true, hewn_words(uvec2(push.lists)), end);
}
