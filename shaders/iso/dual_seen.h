/* GLSL only: the surface as a field tells of it at a place. Included where `push` has the grid. */

/* The surface as seen from a place in the cell: unit normal and how far off it is, in cells, to first order. Where the
 * bounds cut it, it is that of max(f, bounds). The distance is negative inside, and the normal 0 where the field has no
 * direction. */
vec4 surface_from(vec3 place)
{
    vec4 gradient = field_gradient(place.x, place.y, place.z);
    float size = length(gradient.xyz);
    bool sloped = size > 0.0 && size <= 3.0e38 && abs(gradient.w) <= 3.0e38;
    vec4 seen = sloped ? gradient / size : vec4(0.0);
    seen.w /= push.grid.cell;
    for (uint i = 0u; i < 3u; i++) {
        float below = (push.grid.origin[i] - place[i]) / push.grid.cell;
        float above = (place[i] - push.grid.far[i]) / push.grid.cell;
        if (push.grid.open == 0u && sloped && max(below, above) > seen.w) {
            seen = vec4(0.0, 0.0, 0.0, max(below, above));
            seen[i] = below > above ? -1.0 : 1.0;
        }
    }
    return seen;
}
