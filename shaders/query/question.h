/* GLSL only: a question, and the least and exact answers that boxes and places give to it. As src/query/lengths.c. */
#ifndef HEWN_SHADERS_QUERY_QUESTION_H
#define HEWN_SHADERS_QUERY_QUESTION_H

#define FAR_AWAY 3.0e38

struct Question {
    uint kind;
    vec3 from, along; /* unit, no component 0 */
    float begin, end, radius;
};

Question read_question(Floats at, uint first)
{
    Question q;
    q.from = vec3(at.at[first], at.at[first + 1u], at.at[first + 2u]);
    q.begin = at.at[first + 3u];
    q.along = vec3(at.at[first + 4u], at.at[first + 5u], at.at[first + 6u]);
    q.end = at.at[first + 7u];
    q.radius = at.at[first + 8u];
    q.kind = floatBitsToUint(at.at[first + 9u]);
    return q;
}

void write_answer(Floats to, uint first, float low, float high, vec3 point, vec3 normal, uint flags)
{
    to.at[first] = low;
    to.at[first + 1u] = high;
    for (uint axis = 0u; axis < 3u; axis++) {
        to.at[first + 2u + axis] = point[axis];
        to.at[first + 5u + axis] = normal[axis];
    }
    to.at[first + 8u] = uintBitsToFloat(flags);
}

float box_enter(Question q, vec3 lo, vec3 hi, float more, out float leave)
{
    vec3 a = (lo - more - q.from) / q.along, b = (hi + more - q.from) / q.along;
    vec3 error = 2.4e-7 * (abs(q.from) + abs(lo) + abs(hi)) / abs(q.along);
    vec3 first = min(a, b) - error, last = max(a, b) + error;
    float enter = max(q.begin, max(first.x, max(first.y, first.z)));
    leave = min(q.end, min(last.x, min(last.y, last.z)));
    return enter <= leave ? enter : FAR_AWAY;
}

/* Where the ball's centre is when it first touches a ball of `more` about a place. */
float ball_meet(Question q, vec3 middle, float more)
{
    vec3 to = middle - q.from;
    float along = dot(to, q.along), radius = q.radius + more;
    vec3 aside = to - along * q.along;
    float rest = radius * radius - dot(aside, aside);
    if (!(rest >= 0.0))
        return FAR_AWAY;
    float way = sqrt(rest);
    return along + way < q.begin || along - way > q.end ? FAR_AWAY : max(q.begin, along - way);
}

float question_lower(Question q, vec3 lo, vec3 hi)
{
    vec3 gap = max(max(lo - q.from, q.from - hi), vec3(0.0));
    if (q.kind == HEWN_QUERY_NEAREST)
        return 0.999999 * length(gap);
    float leave, enter = box_enter(q, lo, hi, q.radius, leave);
    if (q.kind == HEWN_QUERY_RAY || enter == FAR_AWAY)
        return enter;
    vec3 middle = 0.5 * (lo + hi), size = abs(middle) + abs(q.from);
    float more = 0.5 * length(hi - lo) * 1.000001 + 2e-6 * (size.x + size.y + size.z + q.radius);
    float meet = ball_meet(q, middle, more);
    return meet == FAR_AWAY ? FAR_AWAY : max(enter, meet - 2e-6 * (size.x + size.y + size.z));
}

/* The answer where the surface is this near to a place. */
float place_length(Question q, vec3 p, float doubt)
{
    return q.kind == HEWN_QUERY_NEAREST ? distance(q.from, p) + doubt : ball_meet(q, p, -min(doubt, q.radius));
}

#endif
