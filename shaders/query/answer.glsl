/* Answers questions about where the surface is, one an invocation: an octree of the box is walked through, what is near
 * first, and what interval bounds show to be free, or cannot be better than the best place so far, is left out. */
#include "query/question.h"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push
{
    hewn_query_push push;
};

vec3 box_lo = vec3(push.lo[0], push.lo[1], push.lo[2]), box_hi = vec3(push.hi[0], push.hi[1], push.hi[2]);

/* What is known so far. */
float low = FAR_AWAY, high = FAR_AWAY;
vec3 point = vec3(0.0), normal = vec3(0.0);
uint steps = 0u;

bool holds(vec3 p)
{
    return all(greaterThanEqual(p, box_lo)) && all(lessThanEqual(p, box_hi));
}

/* Slopes are bounded only so far around: past that the field's value says nothing about lengths. */
bool in_wide_box(vec3 p)
{
    vec3 lo = vec3(push.wide_lo[0], push.wide_lo[1], push.wide_lo[2]);
    vec3 hi = vec3(push.wide_hi[0], push.wide_hi[1], push.wide_hi[2]);
    return all(greaterThanEqual(p, lo)) && all(lessThanEqual(p, hi));
}

/* The first of eight places along a ray's part where the field is 0 or below, then halved; FAR_AWAY for none. */
float find_entry(Question q, float enter, float leave)
{
    float outside = enter, inside = FAR_AWAY, t = enter;
    for (uint i = 0u; i < 40u; i++) {
        vec3 p = q.from + t * q.along;
        bool solid = field_point(p.x, p.y, p.z) <= 0.0;
        steps++;
        if (solid)
            inside = t;
        else
            outside = t;
        if (inside < FAR_AWAY && (inside <= enter || inside - outside < 0.25 * push.fine))
            break;
        if (inside == FAR_AWAY && i >= 7u)
            break;
        t = inside < FAR_AWAY ? 0.5 * (outside + inside) : mix(enter, leave, float(i + 1u) / 7.0);
    }
    return inside;
}

/* Onto the surface by Newton's steps, from the middle of a box; whether the field changes its sign there. */
bool find_surface(inout vec3 p, float most, float reach, Question q, out vec3 out_normal)
{
    bool reached = false;
    out_normal = vec3(0.0);
    for (uint i = 0u; i < 10u; i++) {
        vec4 g = field_gradient(p.x, p.y, p.z);
        float square = dot(g.xyz, g.xyz), move = abs(g.w) * inversesqrt(square);
        steps++;
        if (!(square > 0.0) || !(square < FAR_AWAY) || !(move <= most))
            break;
        most -= move;
        out_normal = g.xyz * inversesqrt(square);
        p -= g.w / square * g.xyz;
        reached = move < 0.1 * push.fine;
        if (reached)
            break;
    }
    vec3 little = 0.5 * push.fine * out_normal;
    if (!reached || !holds(p + little) || !holds(p - little) || !(place_length(q, p, 0.5 * push.fine) < reach))
        return false;
    bool changes = true;
    for (uint i = 0u; i < 2u; i++) {
        vec3 at = i == 0u ? p + little : p - little;
        float value = field_point(at.x, at.y, at.z);
        steps++;
        changes = changes && (i == 0u ? value > 0.0 : value <= 0.0);
    }
    return changes;
}

void take(float t, vec3 p, vec3 n)
{
    if (!(t < high))
        return;
    high = t;
    point = p;
    normal = n;
}

/* Looks for a place in a box that is better than all so far. What is found need not be the best there. */
void look(Question q, vec3 lo, vec3 hi)
{
    if (q.kind == HEWN_QUERY_RAY) {
        float leave, enter = box_enter(q, lo, hi, 0.0, leave);
        float t = enter < high ? find_entry(q, enter, leave) : FAR_AWAY;
        take(t, q.from + t * q.along, vec3(0.0));
    } else {
        vec3 p = 0.5 * (lo + hi), n;
        float most = length(hi - lo);
        for (uint i = 0u; i < 6u; i++) {
            if (most < push.fine || !find_surface(p, most, high, q, n))
                break;
            take(place_length(q, p, 0.5 * push.fine), p, n);
            /* Along the surface towards where the question is asked from. */
            vec3 to = (q.kind == HEWN_QUERY_NEAREST ? q.from : q.from + high * q.along) - p, aside = to - dot(to, n) * n;
            p += aside;
            most = 2.0 * length(aside);
        }
    }
}

/* Walks through the octree down to a level. What is not looked into because it cannot be better counts for `low` all
 * the same. True where the steps did not suffice. */
bool search(Question q, float known, uint levels)
{
    low = FAR_AWAY;
    uint turn[HEWN_QUERY_LEVELS + 1u], level = 0u;
    uvec3 at = uvec3(0u);
    turn[0] = 0u;
    while (true) {
        if (turn[level] == 8u) {
            if (level == 0u)
                break;
            level--;
            at >>= 1u;
            continue;
        }
        steps++;
        vec3 size = (box_hi - box_lo) * uintBitsToFloat((126u - level) << 23u), middle = box_lo + vec3(2u * at + 1u) * size;
        bvec3 near = q.kind == HEWN_QUERY_NEAREST ? greaterThan(q.from, middle) : lessThan(q.along, vec3(0.0));
        uint which = turn[level]++ ^ (uint(near.x) | uint(near.y) << 1u | uint(near.z) << 2u);
        uvec3 part = 2u * at + uvec3(which & 1u, which >> 1u & 1u, which >> 2u);
        vec3 lo = box_lo + vec3(part) * size, hi = box_lo + vec3(part + 1u) * size;
        float lower = max(known, question_lower(q, lo, hi));
        if (!(lower < FAR_AWAY))
            continue;
        bool best = !(lower < high - push.tolerance), ran_out = steps > push.most_steps;
        if (best || ran_out) {
            low = min(low, lower);
            continue;
        }
        vec2 range = field_interval(vec2(lo.x, hi.x), vec2(lo.y, hi.y), vec2(lo.z, hi.z));
        if (range.x > 0.0 || (range.y < 0.0 && q.kind != HEWN_QUERY_RAY))
            continue;
        bool last = level + 1u >= levels;
        if (last || high - lower > 0.5 * length(size))
            look(q, lo, hi);
        if (last) {
            low = min(low, lower);
            continue;
        }
        level++;
        at = part;
        turn[level] = 0u;
    }
    return steps > push.most_steps;
}

void main()
{
    uint i = invocation();
    if (i >= push.count)
        return;
    Question q = read_question(push.questions, i * HEWN_QUESTION_WORDS);
    vec3 start = q.from + (q.kind == HEWN_QUERY_NEAREST ? 0.0 : q.begin) * q.along;
    float value = field_point(start.x, start.y, start.z);
    uint flags = value <= 0.0 && holds(start) ? HEWN_ANSWER_INSIDE : 0u;
    float known = 0.0, far = 0.0;
    for (uint axis = 0u; axis < 3u; axis++)
        far = max(far, max(abs(start[axis]), max(abs(push.lo[axis]), abs(push.hi[axis]))));
    float steepness = holds(start) ? push.steepness : in_wide_box(start) ? push.wide_steepness : 0.0;
    if (steepness > 0.0 && abs(value) < FAR_AWAY)
        known = max(0.0, ((abs(value) - 3.9e-6 * far) / steepness - q.radius) * 0.999999);
    if (q.kind != HEWN_QUERY_NEAREST) {
        known += q.begin;
        if (flags != 0u)
            take(q.begin, start, vec3(0.0));
    }
    if (q.kind == HEWN_QUERY_NEAREST || flags == 0u) {
        /* First a coarse round, so that the fine one has a good place to compare with. */
        bool ran_out = false;
        for (uint levels = min(5u, push.levels); !ran_out; levels = push.levels) {
            ran_out = search(q, known, levels);
            if (levels == push.levels)
                break;
        }
        flags |= ran_out ? HEWN_ANSWER_RAN_OUT : 0u;
    }
    write_answer(push.answers, i * HEWN_ANSWER_WORDS, min(low, high), high, point, normal, flags);
}
