/* GLSL only: what dual contouring looks for beyond the planes that the crossings of a cell have. Included after
 * iso/qef.h and iso/dual_place.h. */

/* Up to here a place is on the surface, in cells. */
const float ON_SURFACE = 5.0e-5;
/* Along a sharp edge the field is asked where the edge leaves the cell: a surface that is off it there, and meets it at
 * no less than 6 degrees, is a plane that no crossing saw. */
const float MEETS = 0.1;
/* Planes whose normals are nearer than about 11 degrees are one surface. */
const float SAME = 0.98;
/* A vertex where a surface is not smooth, and that is farther off it than this, has lost something. */
const float LOST = 0.05;
/* So far on both sides of an edge the normals are still those of its two surfaces. */
const float ASIDE = 0.02;

/* Questions to the field are asked in one place, since its code is long: up to nine at once. */
vec3 asked[9];
vec4 told[9];

/* Where the line through `at` leaves the cell, as distances along it: backward, forward. */
vec2 line_ends(Cell cell, vec3 at, vec3 along)
{
    vec2 ends = vec2(-4.0, 4.0);
    for (uint i = 0u; i < 3u; i++) {
        if (abs(along[i]) > 1.0e-6) {
            vec2 sides = (vec2(cell.lo[i], cell.hi[i]) - at[i]) / along[i];
            ends = vec2(max(ends.x, min(sides.x, sides.y)), min(ends.y, max(sides.x, sides.y)));
        }
    }
    return vec2(min(ends.x, 0.0), max(ends.y, 0.0));
}

/* Planes sorted by surface: bits of those of the first three. */
uvec3 surfaces_of_planes()
{
    uvec3 sets = uvec3(0u);
    for (uint i = 0u; i < qef_count; i++) {
        for (uint k = 0u; k < 3u; k++) {
            bool same = sets[k] == 0u || dot(qef_planes[findLSB(sets[k])].xyz, qef_planes[i].xyz) > SAME;
            if (same) {
                sets[k] |= 1u << i;
                break;
            }
        }
    }
    return sets;
}

/* The axis along which a corner lies beyond the cell, in the next one, with all three edges that end there leading back
 * through the face between: so no other cell sees it. 3 where that is not so. */
uint beyond_face(Cell cell, vec3 at, uvec3 sets)
{
    vec3 low = step(at, cell.lo) * step(vec3(1.0e-7), cell.lo - at),
         high = step(cell.hi, at) * step(vec3(1.0e-7), at - cell.hi);
    vec3 out_of = low + high;
    uint axis = out_of.x > 0.0 ? 0u : out_of.y > 0.0 ? 1u : 2u;
    float face = low[axis] > 0.0 ? cell.lo[axis] : cell.hi[axis];
    bool so = dot(out_of, vec3(1.0)) == 1.0 && abs(at[axis] - face) < 0.99 && all(notEqual(sets, uvec3(0u)));
    so = so && face != 0.0 && cell.lo[axis] > 0.0 && cell.hi[axis] < 1.0 - 0.5 * KEPT_OFF;
    for (uint k = 0u; k < 3u; k++) {
        vec3 one = qef_planes[findLSB(sets[k]) & 15].xyz, other = qef_planes[findLSB(sets[(k + 1u) % 3u]) & 15].xyz;
        vec3 along = cross(one, other);
        vec3 through = at + along * ((face - at[axis]) / along[axis]);
        through[axis] = 0.5 * (cell.lo[axis] + cell.hi[axis]);
        so = so && all(greaterThan(through, cell.lo)) && all(lessThan(through, cell.hi));
    }
    return so ? axis : 3u;
}

/* The corners of the next cell along an axis. */
void ask_beyond(Cell cell, vec3 at, uint axis)
{
    for (uint i = 0u; i < 8u; i++) {
        uint u = axis == 0u ? 1u : 0u, v = axis == 2u ? 1u : 2u;
        vec3 corner;
        corner[axis] = at[axis] < 0.5 ? -float(i & 1u) : 1.0 + float(i & 1u);
        corner[u] = float(i >> 1 & 1u);
        corner[v] = float(i >> 2);
        asked[1u + i] = corner;
    }
}

/* Where the plane that bends away most from the usual normal leans to. */
vec3 plane_aside(vec3 usual)
{
    vec3 aside = vec3(0.0);
    for (uint i = 0u; i < qef_count; i++) {
        vec3 away = qef_planes[i].xyz - usual;
        aside = dot(away, away) > dot(aside, aside) ? away : aside;
    }
    return aside;
}
