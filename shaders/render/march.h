/* GLSL only: how a ray gets on to the surface. `push` must be declared before. */
#ifndef HEWN_SHADERS_RENDER_MARCH_H
#define HEWN_SHADERS_RENDER_MARCH_H

const float FAR_AWAY = 3.0e38;

vec3 vector(const float a[3])
{
    return vec3(a[0], a[1], a[2]);
}

/* Where cells that hold no surface end along the ray; boxes of cells overlap by more than the push beyond. */
float pass_empty(vec3 from, vec3 along, float t, float end)
{
    vec3 lo = vector(push.lo), cell = (vector(push.hi) - lo) / float(push.cells_across);
    vec3 turned = 1.0 / along;
    float over = 0.002 * min(cell.x, min(cell.y, cell.z));
    for (uint i = 0u; i < HEWN_SKIP_STEPS && t < end; i++) {
        vec3 at = clamp(floor((from + t * along - lo) / cell), vec3(0.0), vec3(float(push.cells_across) - 1.0));
        uint index = uint(at.x) + push.cells_across * (uint(at.y) + push.cells_across * uint(at.z));
        float away = float(push.cells.at[index >> 2u] >> 8u * (index & 3u) & 255u);
        if (away == 0.0)
            return t;
        vec3 ends = max((lo + (at - (away - 1.0)) * cell - from) * turned, (lo + (at + away) * cell - from) * turned);
        t = max(t, min(ends.x, min(ends.y, ends.z))) + over;
    }
    return t;
}

vec2 side(float from, float along, float a, float b)
{
    float p = from + along * a, q = from + along * b;
    float error = 5.0e-7 * max(abs(p), abs(q));
    return vec2(min(p, q) - error, max(p, q) + error);
}

/* How a march goes on from t. Of the last step `sure` is known to be free whatever is at t; `free` is how much the
 * sphere says that it began in, and `lean` how fast values changed along it, over the greatest slope. */
struct March {
    float t, stride, sure, free, lean;
    bool met;
};

/* Which of the two ways it is stands in the code: CPU drivers run both arms of a condition. */
#ifdef HEWN_BY_SPHERES
/* Back to where the last sphere ends, or what is on the surface. */
void step_back(inout March m)
{
    m.t += m.sure - m.stride;
    m.stride = m.sure;
    m.lean = -1.0;
}

/* As take_sphere() of the host's tracer. */
void take_step(inout March m, vec3 from, vec3 along, float near_enough, float end)
{
    vec3 p = from + m.t * along;
    float value = field_point(p.x, p.y, p.z);
    float radius = (value - push.slack) / push.steepness;
    if (m.stride > m.sure && (value <= 0.0 || m.stride > m.free + radius)) {
        step_back(m);
        return;
    }
    m.met = value <= 0.0; /* and not where it is small: past a sharp edge it may be so without surface */
    float lean = mix(m.lean, (radius - m.free) / m.stride, 0.3);
    m.lean = m.stride > 0.0 ? lean : m.lean;
    m.free = radius > 0.0 && radius < FAR_AWAY ? radius : 0.0;
    m.sure = max(m.free, near_enough);
    m.stride = max(2.0 * m.free / (1.0 - min(m.lean, 0.8)), m.sure);
    m.t += m.met ? 0.0 : m.stride;
}

/* Passes empty cells; a step that led into one, or past the end, is taken back where it is not sure. */
bool passes(inout March m, vec3 from, vec3 along, float end)
{
    float next = pass_empty(from, along, m.t, end);
    if (next == m.t && m.t < end)
        return true;
    if (m.stride > m.sure) {
        step_back(m);
        return false;
    }
    m = March(next, 0.0, 0.0, 0.0, -1.0, false);
    return next < end;
}
#else
void take_step(inout March m, vec3 from, vec3 along, float near_enough, float end)
{
    float stride = min(m.stride, end - m.t), after = m.t + stride;
    vec2 range = field_interval(side(from.x, along.x, m.t, after), side(from.y, along.y, m.t, after),
                                side(from.z, along.z, m.t, after));
    if (range.x > 0.0) {
        m.t = after;
        m.stride = 2.0 * stride;
        return;
    }
    if (stride > near_enough) {
        m.stride = max(0.4 * stride, 0.9 * near_enough);
        return;
    }
    vec3 p = from + after * along;
    float value = field_point(p.x, p.y, p.z);
    m.met = value <= 0.0; /* else nothing is proven of so short a way but that its end is outside */
    m.t = m.met ? m.t : after;
}

bool passes(inout March m, vec3 from, vec3 along, float end)
{
    m.t = pass_empty(from, along, m.t, end);
    return m.t < end;
}
#endif

/* Where a ray meets the surface; FAR_AWAY: nowhere. */
float march(vec3 from, vec3 along, float begin, float end, uint most, out bool ran_out)
{
#ifdef HEWN_BY_SPHERES
    March m = March(begin, 0.0, 0.0, 0.0, -1.0, false);
#else
    March m = March(begin, 0.02 * (push.hi[0] - push.lo[0]), FAR_AWAY, 0.0, 0.0, false);
#endif
    bool ended = false;
    for (uint i = 0u; i < most && !m.met && !ended; i++) {
        if (passes(m, from, along, end))
            take_step(m, from, along, push.nearness + push.spread * m.t, end);
        ended = m.t >= end && m.stride <= m.sure;
    }
    ran_out = !m.met && !ended;
    return m.met || ran_out ? m.t : FAR_AWAY;
}

#endif
