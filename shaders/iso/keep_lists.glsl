/* Counts what is in the list of each block that a level of culling kept, and once the counts are summed writes the
 * lists: one invocation a block. */
#include "iso/choices.h"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push
{
    hewn_keep_push push;
};

void main()
{
    uint rank = invocation();
    if (rank >= push.kept.at[0])
        return;
    uint at = push.origins.at[rank], words, begin = 0u, end = 0u;
    uint first_choice = select_parent(at, push.dense != 0u, push.parent_ranges, words);
    bool write = push.write != 0u;
    if (write) {
        begin = push.places.at[rank];
        end = push.places.at[rank + 1u];
        push.ranges.at[2u * rank] = begin;
        push.ranges.at[2u * rank + 1u] = end - begin;
    }
    uint count = field_keep(hewn_words(uvec2(push.choices)), first_choice, write, hewn_words(uvec2(push.lists)), end);
    if (!write)
        push.places.at[rank] = count;
}
