/* GLSL only: where a field changes sign along an edge, as a share of it. A bracket always holds an inside end and an
 * outside end. The first guess and mostly the second is where the chord between the ends passes zero. Later ones follow
 * the line through the two newest places on one side of the root (secants in a bracket, after Dekker 1969): for a field
 * of flat pieces that is exact once both lie on the root's piece. Halving where the values give no better guess: a
 * chord from a plateau would only creep. */
#ifndef HEWN_SHADERS_ISO_ROOT_SEARCH_H
#define HEWN_SHADERS_ISO_ROOT_SEARCH_H

/* A value that the edge's mean slope takes back in this share of a cell ends the search. */
const float NEAR_ENOUGH = 1.0e-5;
const uint MOST_TRIALS = 24u;
/* No vertex comes nearer to a grid point than this share of a cell, so that no two of them fall together. */
const float NEAREST = 1.25 / 4096.0;
const float CORRECTED = 1.0e-3; /* of a cell: a place that is farther off than this lies on no surface */

bool finite(float value)
{
    return abs(value) <= 3.0e38;
}

/* A direction with no zero of negative sign: which sign zeros get differs with the way that a gradient is computed. */
vec3 plain_zeros(vec3 direction)
{
    uvec3 bits = floatBitsToUint(direction); /* sums with 0 are left out by drivers */
    return uintBitsToFloat(mix(bits, uvec3(0u), equal(bits, uvec3(0x80000000u))));
}

struct Search {
    float a, b, fa, fb;    /* the bracket */
    float guess, value;    /* the last place asked, */
    float other, at_other; /* and the end of the bracket that it took the place of */
    float enough, grain;   /* what ends the search: a value, and steps so small that floats hardly follow */
    bool start_inside, settled;
};

/* Along an edge from `start` to `end`; one that is `settled` before it began stays at the middle. */
Search search_begin(float start, float end, float at_start, float at_end, bool settled)
{
    precise float grain = max(abs(start), abs(end)) * 1.1920929e-7 / (end - start);
    precise float enough = max(NEAR_ENOUGH, grain) * abs(at_end - at_start);
    return Search(0.0, 1.0, at_start, at_end, 0.5, 0.0, 0.0, 0.0, enough, grain, at_start < 0.0, settled);
}

void next_guess(inout Search s, uint trial)
{
    bool chord = trial < 2u;
    precise float x = chord ? s.a : s.guess, fx = chord ? s.fa : s.value;
    precise float y = chord ? s.b : s.other, fy = chord ? s.fb : s.at_other;
    precise float slope = fy - fx;
    precise float guess = x - fx * (y - x) / slope;
    bool creeps = trial == 1u && abs(s.value) > 0.5 * abs(s.at_other);
    bool useful = finite(slope) && guess > s.a && guess < s.b && !creeps && trial <= 8u;
    precise float middle = 0.5 * (s.a + s.b);
    guess = useful ? guess : middle;
    s.settled = s.settled || (trial > 0u && abs(guess - s.guess) <= s.grain);
    s.guess = s.settled ? s.guess : guess;
}

/* What is settled stays. */
void take_value(inout Search s, float value)
{
    s.settled = s.settled || abs(value) <= s.enough || s.b - s.a < max(2.0e-6, 2.0 * s.grain);
    bool low = (value < 0.0) == s.start_inside, on = !s.settled;
    s.other = on ? (low ? s.a : s.b) : s.other;
    s.at_other = on ? (low ? s.fa : s.fb) : s.at_other;
    s.value = on ? value : s.value;
    s.a = on && low ? s.guess : s.a;
    s.fa = on && low ? value : s.fa;
    s.b = on && !low ? s.guess : s.b;
    s.fb = on && !low ? value : s.fb;
}

#endif
