#include "iso/host_quad.h"

#include "iso/host_vector.h"

/* What leaving the envelope weighs: more than any distance along an edge. */
static const float LEAVES = 1.0e18f;

static float cross2(vec a, vec b)
{
    return a[0] * b[1] - a[1] * b[0];
}

/* How far off corners a, b, c, d cut along a and c are, seen from where the edge stands upright at the origin; LEAVES
 * or more where they leave the envelope. */
static float misfit(vec a, vec b, vec c, vec d, float end, float surface)
{
    float turn = cross2(a, b) + cross2(b, c) + cross2(c, d) + cross2(d, a);
    /* Which side of the diagonal the edge is on: that of b, or that of d. */
    bool beside_b = cross2(c - a, -a) * turn <= 0;
    vec near = beside_b ? b : d, far = beside_b ? d : b;
    vec weights = vec3(cross2(near, c), cross2(c, a), cross2(a, near));
    float sum = weights[0] + weights[1] + weights[2];
    float pierced = dot3(weights, vec3(a[2], near[2], c[2])) / sum;
    /* The diagonal at a + t (c - a) passes over the line from the edge to the far corner, a share s of the way. */
    float t = cross2(a, far) / cross2(a - c, far);
    vec over = a + t * (c - a);
    float s = (over[0] * far[0] + over[1] * far[1]) / (far[0] * far[0] + far[1] * far[1]);
    float floor_there = far[2] * s, roof_there = end * (1 - s) + far[2] * s;
    float slack = 1.0e-5f * end, off = fabsf(pierced - surface);
    bool within = pierced > slack && pierced < end - slack && over[2] >= floor_there && over[2] <= roof_there && s <= 1;
    float found = within ? off : LEAVES * (1 + off);
    return found < 1.0e30f ? found : 1.0e30f; /* also where corners coincide, and nothing is a number */
}

hewn_quad_cut hewn_quad_cut_find(const float corners[4][3], const float low[3], float high, float surface,
                                 uint32_t axis)
{
    uint32_t u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
    vec seen[4];
    bool at_rim = false; /* cells without thickness: the edge lies on the quad's border, and there is no envelope */
    for (int i = 0; i < 4; i++) {
        seen[i] = vec3(corners[i][u] - low[u], corners[i][v] - low[v], corners[i][axis] - low[axis]);
        at_rim = at_rim || seen[i][0] == 0 || seen[i][1] == 0;
    }
    float end = high - low[axis], height = surface - low[axis];
    float one = misfit(seen[0], seen[1], seen[2], seen[3], end, height);
    float other = misfit(seen[1], seen[2], seen[3], seen[0], end, height);
    return (hewn_quad_cut){other < one, !at_rim && least(one, other) >= LEAVES};
}

float hewn_quad_fan_height(float low, float high, float surface)
{
    float off = 1.25f / 4096 * (high - low);
    return surface == low || surface == high ? surface : clamp1(surface, low + off, high - off);
}
