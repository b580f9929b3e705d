/* Follows rays to the field's surface, one an invocation. Cells that interval bounds found empty are passed at once.
 * Elsewhere, where the field's slope is bounded, spheres are traced (Hart 1996) with automatic relaxation (Ban and
 * Valasek 2023); where it is not, steps are as long as interval bounds prove free of surface (Mitchell 1990). Either way no
 * surface is stepped over. Soft shadows are estimated from how near the way to the light passes, openness from values
 * along the normal (Evans 2006). */
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push
{
    hewn_trace_push push;
};

#include "render/march.h"

/* The part of a ray that is in the box. */
vec2 clip(vec3 from, vec3 along, float begin, float end)
{
    vec3 turned = 1.0 / along;
    vec3 a = (vector(push.lo) - from) * turned, b = (vector(push.hi) - from) * turned;
    vec3 first = min(a, b), last = max(a, b);
    return vec2(max(begin, max(first.x, max(first.y, first.z))), min(end, min(last.x, min(last.y, last.z))));
}

/* How much of the light is seen past edges that the way to it does not meet: an estimate from values along it, by steps
 * of its own, since those of a march jump. */
float edge_light(vec3 p, vec3 light, vec2 part)
{
    float shortest = 0.004 * (push.hi[0] - push.lo[0]), nearest = push.softness, t = part.x + shortest;
    for (uint i = 0u; i < HEWN_LIGHT_STEPS && t < part.y; i++) {
        vec3 q = p + t * light;
        float free = field_point(q.x, q.y, q.z) / push.slope;
        nearest = min(nearest, free / t);
        t += max(0.5 * free, shortest + 0.03 * t);
    }
    float share = clamp(nearest / push.softness, 0.0, 1.0);
    return share * share * (3.0 - 2.0 * share);
}

float light_at(vec3 p, vec3 normal)
{
    vec3 light = vector(push.light);
    bool ran_out;
    if (dot(normal, light) <= 0.0)
        return 0.0;
    vec2 part = clip(p, light, 0.0, FAR_AWAY);
    if (part.x >= part.y)
        return 1.0;
    if (march(p, light, part.x, part.y, HEWN_SHADOW_STEPS, ran_out) < FAR_AWAY)
        return 0.0;
    return edge_light(p, light, part);
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
    float t = FAR_AWAY;
    bool ran_out = false;
    uint met = HEWN_MET_NOTHING;
    vec3 normal = vec3(0.0);
    if (part.x < part.y) {
        vec3 p = from + part.x * along;
        if (field_point(p.x, p.y, p.z) < 0.0) {
            t = part.x;
            normal = face_normal(p, along);
        } else {
            t = march(from, along, part.x, part.y, HEWN_RAY_STEPS, ran_out);
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
