/* GLSL only: how to cut the quad around a grid edge. */
#ifndef HEWN_SHADERS_ISO_QUAD_H
#define HEWN_SHADERS_ISO_QUAD_H

/* Each quad has a region of its own (its envelope, Ju and Udeshi 2006): the tetrahedra between its grid edge and the
 * lines from vertex to next vertex. Those of all grid edges do not overlap where each cell has one vertex, because the
 * pyramids from a cell's vertex over its faces do not. So triangles that stay in there meet no others.
 *
 * Two triangles stay in there if the one that the grid edge pierces is pierced between the edge's ends, and the
 * diagonal passes through the triangle between the edge and the corner of the other one. Of two diagonals that do, the
 * better one is that whose triangle is pierced nearest to where the surface crosses the edge: so a diagonal follows a
 * sharp edge. */

/* Set where neither cut stays in the envelope, but only a fan around a point of the edge. */
#define QUAD_FAN 2u

/* What leaving the envelope weighs: more than any distance along an edge. */
const float QUAD_LEAVES = 1.0e18;

float quad_cross(vec2 a, vec2 b)
{
    precise float product = a.x * b.y - a.y * b.x;
    return product;
}

/* `p` are the corners around the edge, seen from where it stands upright at the origin: across, across, height. `ends`
 * is where it ends and `surface` where the surface crosses it. How far off that corners a, b, c, d cut along a and c
 * are; QUAD_LEAVES or more where they leave the envelope. */
float quad_misfit(vec3 a, vec3 b, vec3 c, vec3 d, vec2 ends, float surface)
{
    float turn = quad_cross(a.xy, b.xy) + quad_cross(b.xy, c.xy) + quad_cross(c.xy, d.xy) + quad_cross(d.xy, a.xy);
    /* Which side of the diagonal the edge is on: that of b, or that of d. */
    bool beside_b = quad_cross(c.xy - a.xy, -a.xy) * turn <= 0.0;
    vec3 near = beside_b ? b : d, far = beside_b ? d : b;
    vec3 weights = vec3(quad_cross(near.xy, c.xy), quad_cross(c.xy, a.xy), quad_cross(a.xy, near.xy));
    float sum = weights.x + weights.y + weights.z;
    float pierced = dot(weights, vec3(a.z, near.z, c.z)) / sum;
    /* The diagonal at a + t (c - a) passes over the line from the edge to the far corner, a share s of the way. */
    float t = quad_cross(a.xy, far.xy) / quad_cross(a.xy - c.xy, far.xy);
    vec3 over = a + t * (c - a);
    float s = dot(over.xy, far.xy) / dot(far.xy, far.xy);
    vec2 room = mix(ends, vec2(far.z), s);
    float slack = 1.0e-5 * (ends.y - ends.x);
    bool within =
        pierced > ends.x + slack && pierced < ends.y - slack && over.z >= room.x && over.z <= room.y && s <= 1.0;
    float misfit = within ? abs(pierced - surface) : QUAD_LEAVES * (1.0 + abs(pierced - surface));
    return misfit < 1.0e30 ? misfit : 1.0e30; /* also where corners coincide, and nothing is a number */
}

/* 0: cut along corners 0 and 2; 1: along 1 and 3; and QUAD_FAN. `low` and `high` are the grid edge's ends, `surface`
 * where the surface crosses it, along `axis`. */
uint quad_cut(vec3 corners[4], vec3 low, float high, float surface, uint axis)
{
    uint u = axis == 0u ? 1u : 0u, v = axis == 2u ? 1u : 2u;
    vec3 seen[4];
    bool at_rim = false; /* cells without thickness: the edge lies on the quad's border, and there is no envelope */
    for (uint i = 0u; i < 4u; i++) {
        vec3 off = corners[i] - low;
        seen[i] = vec3(off[u], off[v], off[axis]);
        at_rim = at_rim || off[u] == 0.0 || off[v] == 0.0;
    }
    vec2 ends = vec2(0.0, high - low[axis]);
    surface -= low[axis];
    float one = quad_misfit(seen[0], seen[1], seen[2], seen[3], ends, surface);
    float other = quad_misfit(seen[1], seen[2], seen[3], seen[0], ends, surface);
    return (other < one ? 1u : 0u) | (!at_rim && min(one, other) >= QUAD_LEAVES ? QUAD_FAN : 0u);
}

/* Where on the edge a fan has its middle: where the surface crosses it, but no nearer to the ends than vertices on
 * edges come. Where the surface is cut at the bounds the middle is an end, and no other edge has that. */
float fan_height(float low, float high, float surface)
{
    float off = 1.25 / 4096.0 * (high - low);
    return surface == low || surface == high ? surface : clamp(surface, low + off, high - off);
}

#endif
