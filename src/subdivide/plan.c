#include "subdivide/plan.h"

#include <unistd.h>

typedef struct counts {
    uint64_t verts, edges, faces, corners;
} counts;

static counts next_counts(counts from, bool triangles)
{
    const uint64_t faces = triangles ? 4 * from.faces : from.corners;
    return (counts){.verts = from.verts + from.edges + (triangles ? 0 : from.faces),
                    .edges = 2 * from.edges + from.corners,
                    .faces = faces,
                    .corners = faces * (triangles ? 3 : 4)};
}

static bool can_be_numbered(counts level)
{
    return level.corners <= SUB_MOST_NUMBERS && 2 * level.edges <= SUB_MOST_NUMBERS;
}

/* Of what hewn_sub_level_refine() makes. */
static uint64_t level_bytes(counts level, bool edges, bool sharp)
{
    const uint64_t around = level.corners + 6 * level.edges + level.verts, tags = level.edges + level.verts;
    return 4 * (level.corners + (edges ? around : 0) + (sharp ? tags : 0));
}

static uint64_t point_bytes(counts last, counts before)
{
    return 3 * sizeof(double) * (last.verts + before.verts) + sizeof(uint64_t) * last.faces;
}

static uint64_t machine_bytes(void)
{
    const long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGESIZE);
    return pages > 0 && size > 0 ? (uint64_t)pages * (uint64_t)size : UINT64_MAX;
}

hewn_result hewn_sub_plan(const hewn_subdivision *sub, uint64_t most, hewn_error *error)
{
    const sub_level *base = &sub->levels[0];
    const bool triangles = sub->masks.scheme == HEWN_SCHEME_LOOP, sharp = base->edge_sharp != NULL;
    const double mebi = 1 << 20;
    counts at = {base->verts, base->edges, base->faces, base->corners};
    uint64_t held = 0;
    most = most > 0 ? most : machine_bytes();
    for (uint32_t i = 1; i <= sub->count; i++) {
        const counts before = at;
        at = next_counts(before, triangles);
        if (!can_be_numbered(at))
            return hewn_fail(error, HEWN_LIMIT,
                             "level %u has %llu faces, whose corners or edges are more than there are numbers; "
                             "%u would do",
                             i, (unsigned long long)at.faces, i - 1);
        const uint64_t last = held + level_bytes(at, sub->limit, sharp) + point_bytes(at, before);
        if (last > most)
            return hewn_fail(error, HEWN_OUT_OF_MEMORY,
                             "level %u has %llu faces, which take %.0f MiB at least, more than the %.0f MiB that may "
                             "be used; %u would do",
                             i, (unsigned long long)at.faces, (double)last / mebi, (double)most / mebi, i - 1);
        held += level_bytes(at, true, sharp);
    }
    return HEWN_OK;
}
