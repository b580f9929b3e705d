/* GLSL only: how a dual method's vertices ask the field, which may be in lists. Included after iso/dual_seen.h.
 *
 * Where subgroups read lists together, neighbours want different ones: then they go through them all, least number
 * first, and each takes what it wanted. So all of a subgroup must come here together. */
#include "iso/together.h"

#ifdef FIELD_LISTED
vec3 sample_place(uvec3 at)
{
    return vec3(sample_coordinate(push.grid, 0u, at.x), sample_coordinate(push.grid, 1u, at.y),
                sample_coordinate(push.grid, 2u, at.z));
}

/* Whether a place is among these samples, of which the last ones may lie beyond the grid: there is its end. */
bool encloses(uvec3 first, uvec3 last, vec3 place)
{
    return all(greaterThanEqual(place, sample_place(first))) && all(lessThanEqual(place, sample_place(last)));
}

/* The shortest list that is good for a place near the brick: what a brick's own leaves out matters nowhere in the
 * brick, but perhaps elsewhere. */
uint list_for(uint slot, vec3 place)
{
    uvec3 brick = unpack_brick(push.bricks.at[slot]), block = brick / HEWN_LEVEL_RATIO;
    uint side = 8u * HEWN_LEVEL_RATIO;
    uvec3 lowest = max(side * block, push.beyond) - push.beyond;
    bool near = encloses(lowest, side * block + side + push.beyond, place);
    uint list = near ? field_around(slot) : FIELD_WHOLE;
    return encloses(8u * brick, 8u * brick + 8u, place) ? slot : list;
}
#else
uint list_for(uint slot, vec3 place)
{
    return slot;
}
#endif

#ifdef FIELD_TOGETHER
uint list_selected;
bool list_is_selected = false;

uint least_of_all(uint number)
{
    for (uint far = 1u; far < gl_SubgroupSize; far *= 2u)
        number = min(number, subgroupShuffle(number, gl_SubgroupInvocationID ^ far));
    return number;
}

vec4 surface_asked(uint slot, vec3 place, bool asks)
{
    vec4 seen = vec4(0.0);
    uint wanted = asks ? list_for(slot, place) : FIELD_WHOLE;
    bool waits = asks;
    do {
        uint list = least_of_all(waits ? wanted : FIELD_WHOLE);
        if (!list_is_selected || list != list_selected) /* what has been read is kept */
            field_select(list);
        list_selected = list;
        list_is_selected = true;
        vec4 found = surface_from(place);
        bool served = waits && list == wanted;
        seen = served ? found : seen;
        waits = waits && !served;
    } while (subgroupAny(waits));
    return seen;
}
#else
vec4 surface_asked(uint slot, vec3 place, bool asks)
{
    field_select(list_for(slot, place));
    return surface_from(place);
}
#endif
