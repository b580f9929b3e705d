/* Follows rays to the field's surface, one an invocation. Cells that interval bounds found empty are passed at once.
 * Elsewhere, where the field's slope is bounded, spheres are traced (Hart 1996) with over-relaxation (Keinert and others
 * 2014); where it is not, steps are as long as interval bounds prove free of surface (Mitchell 1990). Either way no
 * surface is stepped over. Soft shadows are estimated from how near the way to the light passes, openness from values
 * along the normal (Evans 2006). */
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push
{
    hewn_trace_push push;
};

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

/* How a march goes on from t: by a step that is proven to be free, or `met`. */
struct March {
    float t, stride, last, free, relaxation;
    bool met;
};

void step_by_spheres(inout March m, vec3 from, vec3 along, float near_enough, out float value)
{
    vec3 p = from + m.t * along;
    value = field_point(p.x, p.y, p.z);
    float radius = (value - push.slack) / push.steepness;
    if (m.relaxation > 1.0 && radius + m.free < m.last) { /* the spheres do not touch: back to the end of the last one */
        m.t += m.free - m.last;
        m.relaxation = 1.0;
        m.free = m.last = 0.0;
        value = FAR_AWAY;
        return;
    }
    m.met = radius < near_enough;
    m.free = max(radius, near_enough);
    m.last = m.relaxation * m.free;
    m.t += m.met ? 0.0 : m.last;
}

void step_by_intervals(inout March m, vec3 from, vec3 along, float near_enough, float end, out float value)
{
    float stride = min(m.stride, end - m.t), after = m.t + stride;
    vec2 range = field_interval(side(from.x, along.x, m.t, after), side(from.y, along.y, m.t, after),
                                side(from.z, along.z, m.t, after));
    vec3 p = from + after * along;
    value = field_point(p.x, p.y, p.z);
    if (range.x > 0.0) {
        m.t = after;
        m.stride = 2.0 * stride;
    } else if (stride > near_enough) {
        m.stride = max(0.4 * stride, 0.9 * near_enough);
        value = FAR_AWAY;
    } else if (value > 0.0) { /* nothing is proven of so short a way but that both its ends are outside */
        m.t = after;
        m.stride = stride;
    } else {
        m.met = !f_is_nan(value);
        m.t = m.met ? m.t : after;
    }
}

/* Where a ray meets the surface; FAR_AWAY: nowhere. `nearest` is the least angle (as a tangent) by which it passes. */
float march(vec3 from, vec3 along, float begin, float end, uint most, out float nearest, out bool ran_out)
{
    March m = March(begin, 0.02 * (push.hi[0] - push.lo[0]), 0.0, 0.0, 1.6, false);
    nearest = FAR_AWAY;
    for (uint i = 0u; i < most; i++) {
        float next = pass_empty(from, along, m.t, end);
        if (next > m.t) {
            m.t = next;
            m.free = m.last = 0.0;
        }
        if (m.t >= end)
            break;
        float near_enough = push.nearness + push.spread * m.t, value;
        if (push.steepness > 0.0)
            step_by_spheres(m, from, along, near_enough, value);
        else
            step_by_intervals(m, from, along, near_enough, end, value);
        nearest = min(nearest, value / (push.slope * max(m.t, near_enough)));
        if (m.met)
            break;
    }
    ran_out = !m.met && m.t < end;
    return m.met || ran_out ? m.t : FAR_AWAY;
}

/* The part of a ray that is in the box. */
vec2 clip(vec3 from, vec3 along, float begin, float end)
{
    vec3 turned = 1.0 / along;
    vec3 a = (vector(push.lo) - from) * turned, b = (vector(push.hi) - from) * turned;
    vec3 first = min(a, b), last = max(a, b);
    return vec2(max(begin, max(first.x, max(first.y, first.z))), min(end, min(last.x, min(last.y, last.z))));
}

float light_at(vec3 p, vec3 normal)
{
    vec3 light = vector(push.light);
    float facing = dot(normal, light), nearest;
    bool ran_out;
    if (facing <= 0.0)
        return 0.0;
    vec2 part = clip(p, light, 0.0, FAR_AWAY);
    if (part.x >= part.y)
        return 1.0;
    if (march(p, light, part.x, part.y, HEWN_SHADOW_STEPS, nearest, ran_out) < FAR_AWAY)
        return 0.0;
    float share = clamp(nearest / push.softness, 0.0, 1.0);
    return share * share * (3.0 - 2.0 * share);
}

float openness_at(vec3 p, vec3 normal)
{
    float taken = 0.0, all = 0.0, weight = 1.0;
    for (uint i = 1u; i <= 5u; i++) {
        float height = push.reach * float(i * i) / 25.0;
        vec3 q = p + height * normal, past = max(vector(push.lo) - q, q - vector(push.hi));
        float outside = length(max(past, vec3(0.0)));
        float free = max(outside, field_point(q.x, q.y, q.z) / push.slope);
        free = f_is_nan(free) ? height : clamp(free, 0.0, height);
        taken += weight * (height - free);
        all += weight * height;
        weight *= 0.7;
    }
    return 1.0 - taken / all;
}

/* The normal of the box's face that p is on. */
vec3 face_normal(vec3 p, vec3 along)
{
    vec3 middle = 0.5 * (vector(push.lo) + vector(push.hi)), half_size = 0.5 * (vector(push.hi) - vector(push.lo));
    vec3 q = (p - middle) / half_size, size = abs(q);
    float most = max(size.x, max(size.y, size.z));
    if (most < 0.999)
        return -along;
    return size.x == most ? vec3(sign(q.x), 0.0, 0.0) : size.y == most ? vec3(0.0, sign(q.y), 0.0) : vec3(0.0, 0.0, sign(q.z));
}

void main()
{
    uint i = invocation();
    if (i >= push.count)
        return;
    uint at = HEWN_RAY_WORDS * i;
    vec3 from = vec3(push.rays.at[at], push.rays.at[at + 1u], push.rays.at[at + 2u]);
    vec3 along = vec3(push.rays.at[at + 4u], push.rays.at[at + 5u], push.rays.at[at + 6u]);
    vec2 part = clip(from, along, push.rays.at[at + 3u], push.rays.at[at + 7u]);
    float t = FAR_AWAY, unused;
    bool ran_out = false;
    uint met = HEWN_MET_NOTHING;
    vec3 normal = vec3(0.0);
    if (part.x < part.y) {
        vec3 p = from + part.x * along;
        if (field_point(p.x, p.y, p.z) < 0.0) {
            t = part.x;
            normal = face_normal(p, along);
        } else {
            t = march(from, along, part.x, part.y, HEWN_RAY_STEPS, unused, ran_out);
        }
        met = t < FAR_AWAY ? HEWN_MET_SURFACE : HEWN_MET_NOTHING;
    }
    float height = (push.ground - from[push.up]) / along[push.up];
    if ((push.flags & HEWN_TRACE_GROUND) != 0u && height > push.rays.at[at + 3u] && height < min(t, push.rays.at[at + 7u])) {
        t = height;
        met = HEWN_MET_GROUND;
        ran_out = false;
        normal = vec3(0.0);
        normal[push.up] = from[push.up] > push.ground ? 1.0 : -1.0;
    }
    if (met == HEWN_MET_SURFACE && normal == vec3(0.0)) {
        vec3 p = from + t * along;
        vec4 slope = field_gradient(p.x, p.y, p.z);
        float steep = length(slope.xyz);
        normal = steep > 0.0 && steep < FAR_AWAY ? slope.xyz / steep : -along;
        /* What is left of the way, as straight as the gradient tells. */
        float rest = slope.w / (steep * max(-dot(normal, along), 0.1));
        t += abs(rest) < 2.0 * (push.nearness + push.spread * t) ? rest : 0.0;
    }
    vec2 seen = vec2(1.0);
    if (met != HEWN_MET_NOTHING && (push.flags & HEWN_TRACE_SHADE) != 0u) {
        vec3 p = from + t * along + 3.0 * (push.nearness + push.spread * t) * normal;
        seen = vec2(light_at(p, normal), openness_at(p, normal));
    }
    float words[8] = float[](t, normal.x, normal.y, normal.z, seen.x, seen.y, uintBitsToFloat(met), ran_out ? uintBitsToFloat(1u) : 0.0);
    for (uint k = 0u; k < HEWN_RAY_WORDS; k++)
        push.hits.at[at + k] = words[k];
}
