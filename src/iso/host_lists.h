/* The work of gather.comp and keep_lists.glsl on the host, for devices that share its memory: the same bytes. */
#ifndef HEWN_SRC_ISO_HOST_LISTS_H
#define HEWN_SRC_ISO_HOST_LISTS_H

#include "hewn/base.h"
#include "shared/lists.h"

/* Views of a level's buffers, as in the pushes of those kernels. */
typedef struct hewn_host_lists {
    uint32_t dense[3]; /* of the top level, else 0 */
    uint32_t tested;
    const uint32_t *parents;
    const uint32_t *parent_entries; /* the lists of the level above; on the top level the whole field's, */
    const uint32_t *parent_ranges;  /* which has no ranges */
    uint32_t whole_count;           /* but so many instructions */
    const uint32_t *choices;
    uint32_t *states, *kept, *origins;
    uint32_t *places; /* a kept block, and one more */
} hewn_host_lists;

/* Lists the blocks that are kept, counts their lists' instructions and sums the counts up. Returns how many blocks are
 * kept, and the sum in `*instructions`. */
uint32_t hewn_host_lists_count(const hewn_host_lists *view, uint64_t *instructions);

/* Writes the lists, and where each begins and how long it is. Both functions use all threads of OpenMP. */
void hewn_host_lists_write(const hewn_host_lists *view, uint32_t kept, uint32_t *entries, uint32_t *ranges);

#endif
