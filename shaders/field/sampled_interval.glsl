/* Bounds of samples: between the least and the greatest around the box, and about the value in the middle by how steep
 * they are there. */
//: sampled
/* Least, greatest and steepest of the entry that holds cells. */
vec3 f_sample_extent(const uvec2 s, const uvec3 from, const uvec3 to, const uvec3 bricks)
{
    uvec3 first = from >> 3u, apart = (to >> 3u) - first;
    uint longest = max(apart.x, max(apart.y, apart.z));
    uint size = longest <= 1u ? 0u : uint(findMSB(longest - 1u)) + 1u;
    uvec3 entries = (bricks + (1u << size) - 1u) >> size;
    first >>= size;
    uint level = longest == 0u ? 0u : size + 1u;
    uint at = f_samples(s).at[level] + 3u * (first.x + entries.x * (first.y + entries.y * first.z));
    return uintBitsToFloat(f_three_samples(f_word_of(s, at)).at);
}

precise vec2 f_sampled(const vec2 a, const vec2 b, const vec2 c, const F_SAMPLED)
{
    uvec2 s = f_samples_of(low, middle, high);
    vec3 n = vec3(nx, ny, nz), half_n = n * 0.5;
    vec3 lo = f_numbers(a.x, b.x, c.x), hi = f_numbers(a.y, b.y, c.y);
    vec3 size = max(abs(lo), abs(hi)) + half_n, slack = size * (2.0 * F_U);
    vec3 begins = clamp(lo + half_n - slack, vec3(0.0), n), ends = clamp(hi + half_n + slack, vec3(0.0), n);
    uvec3 last = max(uvec3(n), uvec3(1u)) - 1u;
    uvec3 from = min(uvec3(begins), last), to = min(uvec3(ends), last);
    vec3 all = f_sample_extent(s, from, to, max((uvec3(n) + 7u) >> 3u, uvec3(1u)));
    /* how far past the lattice the box begins and ends */
    vec3 near_gap = max(max(lo - half_n, -half_n - hi), vec3(0.0)), far_gap = max(max(-half_n - lo, hi - half_n), vec3(0.0));
    float near = sqrt(dot(near_gap, near_gap) * grows), far = sqrt(dot(far_gap, far_gap) * grows);
    float away = max(all.x, 0.0), farthest = max(all.y, 0.0);
    vec2 by_extent = vec2(f_pick(near > 0.0, sqrt(near * near + away * away), all.x),
                          f_pick(far > 0.0, sqrt(far * far + farthest * farthest), all.y));
    vec3 counts = mix(vec3(1.0), vec3(0.0), equal(n, vec3(0.0)));
    vec3 m = f_middle(a, b, c), side = max(m - lo, hi - m) * counts;
    float steepest = f_pick(grows > 0.0 && all.z < 1.0, 1.0, all.z);
    float room = sqrt(dot(side, side)) * (steepest * 1.00001);
    float value = f_sampled(m.x, m.y, m.z, low, middle, high, nx, ny, nz, grows, most);
    float error = (8.0 * F_U) * (most + far + (1.0 + steepest) * dot(size, counts)) + F_TINY;
    vec2 about = vec2(value - room, value + room);
    vec2 tighter = vec2(f_pick(about.x > by_extent.x, about.x, by_extent.x),
                        f_pick(about.y < by_extent.y, about.y, by_extent.y));
    return f_apart(tighter, vec2(error));
}
