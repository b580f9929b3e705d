/* Decides how the values at its corners cut a cell: one invocation a cell that is asked. */
#include "iso/exact.h"
#include "iso/grid.h"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push
{
    hewn_mc33_decide_push push;
};

/* The field where the sign is its own; else, past the bounds of a closed grid and where it is not a number, 0. */
float corner_value(uvec3 at, bool inside)
{
    float value = field_point(sample_coordinate(push.grid, 0u, at.x), sample_coordinate(push.grid, 1u, at.y),
                              sample_coordinate(push.grid, 2u, at.z));
    bool number = (floatBitsToUint(value) & 0x7fffffffu) <= 0x7f800000u;
    float limited = clamp(value, -1.0e30, 1.0e30);
    return number && (value < 0.0) == inside ? limited : 0.0;
}

/* Whether the inside is joined across a face whose corners have these values, in an order that both its cells use: the
 * product of the inside values is the greater. Rounding keeps order, so only equal products need their low parts. */
bool face_joined(vec4 value)
{
    vec4 size = abs(value);
    precise vec4 scaled = value * power_to_one(max(max(size.x, size.y), max(size.z, size.w)));
    vec2 one = exact_product(scaled.x, scaled.w), other = exact_product(scaled.y, scaled.z);
    float more = one.x != other.x ? sign(one.x - other.x) : sign(one.y - other.y);
    return value.x < 0.0 ? more > 0.0 : more < 0.0;
}

/* The decisions of the ambiguous faces, lowest first. */
uint faces_joined(float values[8], uint ambiguous)
{
    uint joined = 0u, bit = 0u;
    for (uint face = 0u; face < 6u; face++) {
        if ((ambiguous >> face & 1u) == 0u)
            continue;
        uint axis = face >> 1, corner = (face & 1u) << axis;
        uint u = axis == 0u ? 2u : 1u, v = axis == 2u ? 2u : 4u;
        vec4 value = vec4(values[corner], values[corner + u], values[corner + v], values[corner + u + v]);
        joined |= face_joined(value) ? 1u << bit : 0u;
        bit++;
    }
    return joined;
}

/* How level slices join their corners at the extremum of a c - b d = q2 z^2 + q1 z + q0, where a, b, c, d change
 * linearly along the upright edges around the cell: a hewn_mc33_join. */
uint join_within(float values[8])
{
    float most = 0.0;
    for (uint i = 0u; i < 8u; i++)
        most = max(most, abs(values[i]));
    float scale = power_to_one(most);
    vec2 low[4], rise[4];
    for (uint i = 0u; i < 4u; i++) {
        uint column = i ^ i >> 1; /* around the cell */
        precise float bottom = values[column] * scale, top = values[column + 4u] * scale;
        low[i] = vec2(bottom, 0.0);
        rise[i] = exact_sum(top, -bottom);
    }
    vec2 q0 = pair_minor(low[0], low[2], low[1], low[3]), q2 = pair_minor(rise[0], rise[2], rise[1], rise[3]);
    vec2 q1 = pair_sum(pair_minor(low[0], rise[2], low[1], rise[3]), pair_minor(rise[0], low[2], rise[1], low[3]));
    float turn = pair_sign(q2);
    vec2 twice = 2.0 * q2;
    if (turn == 0.0 || pair_sign(q1) * turn >= 0.0 || pair_sign(pair_sum(twice, q1)) * turn <= 0.0)
        return 0u;
    bool inside[4];
    for (uint i = 0u; i < 4u; i++)
        inside[i] = pair_sign(pair_minor(twice, low[i], q1, rise[i])) * turn < 0.0;
    if (inside[0] == inside[1] || inside[0] != inside[2] || inside[1] != inside[3])
        return 0u;
    float extremum = pair_sign(pair_minor(2.0 * twice, q0, q1, q1)) * turn;
    bool joined = inside[0] ? extremum > 0.0 : extremum < 0.0; /* the inside is, else the outside */
    bool first = inside[0] == joined;                          /* it is a and c that are joined */
    if (turn < 0.0 ? !first : first)
        return 0u;
    return (first ? 1u : 3u) + (joined ? 1u : 0u);
}

void main()
{
    uint at = invocation();
    if (at >= push.count)
        return;
    uint slot = push.asked.at[2u * at], record = push.asked.at[2u * at + 1u];
    uint pattern = record >> 9;
    field_select(slot);
    uvec3 first = 8u * unpack_brick(push.bricks.at[slot]) + (uvec3(record, record >> 3, record >> 6) & 7u);
    float values[8];
    for (uint i = 0u; i < 8u; i++)
        values[i] = corner_value(first + (uvec3(i, i >> 1, i >> 2) & 1u), (pattern >> i & 1u) != 0u);
    uint head = push.table.at[pattern];
    uint number = faces_joined(values, head >> 16 & 63u);
    push.asked.at[2u * at] = push.table.at[(head & 0xFFFFu) + 5u * number + join_within(values)];
}
