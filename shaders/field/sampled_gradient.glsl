/* Samples with their gradients. */
//: sampled
precise vec3 f_sample_slopes(const f_cell_of_samples c)
{
    vec4 plane = c.low + c.t.z * (c.high - c.low), rise = c.high - c.low;
    vec2 line = plane.xy + c.t.y * (plane.zw - plane.xy), along = plane.zw - plane.xy;
    vec2 up = rise.xy + c.t.y * (rise.zw - rise.xy);
    return vec3(line.y - line.x, along.x + c.t.x * (along.y - along.x), up.x + c.t.x * (up.y - up.x)) * c.scale;
}

precise vec4 f_sampled(const vec4 a, const vec4 b, const vec4 c, const F_SAMPLED)
{
    uvec2 s = f_samples_of(low, middle, high);
    f_cell_of_samples cell = f_find_samples(s, f_numbers(a.w, b.w, c.w), vec3(nx, ny, nz));
    float between = f_between_samples(cell), value = f_past_samples(cell, between, grows);
    vec3 slope = mix(f_sample_slopes(cell), vec3(0.0), notEqual(cell.beyond, vec3(0.0)));
    float beyond = dot(cell.beyond, cell.beyond) * grows;
    vec3 past = (cell.beyond + between * slope) / f_pick(value > 0.0, value, 1.0);
    slope = mix(slope, past, bvec3(beyond > 0.0));
    bool first = f_is_nan(a.w, b.w), second = f_is_nan(c.w);
    return vec4(slope.x * a.xyz + slope.y * b.xyz + slope.z * c.xyz, f_pick(first || second, F_NAN, value));
}
