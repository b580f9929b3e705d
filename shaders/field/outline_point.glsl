/* Polygons as chains of edges (src/field/graph.h), and zigzags, at points. */
//: edge length
struct f_side {
    vec2 away;
    float square, t, turn;
    bool crossed;
};

/* The same comparison of a corner's height serves both edges that meet there, so a ray crosses one of them or none. */
precise f_side f_side_of(const float x, const float y, const float ax, const float ay, const float bx, const float by,
                         const float inverse)
{
    f_side side;
    precise vec2 d = vec2(x - ax, y - ay), e = vec2(bx - ax, by - ay);
    precise float t = (d.x * e.x + d.y * e.y) * inverse;
    side.t = f_pick(t > 1.0, 1.0, f_pick(t < 0.0, 0.0, t));
    precise vec2 away = d - e * side.t;
    precise float square = away.x * away.x + away.y * away.y, turn = e.x * d.y - e.y * d.x;
    side.away = away;
    side.square = square;
    side.turn = turn;
    bool up = ay <= y, next = by <= y, left = turn > 0.0;
    side.crossed = up != next && left == up;
    return side;
}

float f_edge(const float chain, const float x, const float y, const float ax, const float ay, const float bx,
             const float by, const float inverse)
{
    f_side side = f_side_of(x, y, ax, ay, bx, by, inverse);
    bool nearer = side.square < abs(chain), unknown = f_is_nan(side.square);
    float least = f_pick(nearer || unknown, side.square, abs(chain));
    return f_copy_sign(least, f_pick(side.crossed, -chain, chain));
}

//: outline
float f_outline(const float chain, const float x, const float y, const float size)
{
    float r = f_copy_sign(sqrt(abs(chain)), chain);
    return f_pick(f_is_nan(x, y), F_NAN, r);
}

//: zigzag
precise float f_zigzag(const float a, const float period, const float inverse)
{
    precise float whole = floor(a * inverse + 0.5), half_period = 0.5 * period;
    precise float rest = abs(a - whole * period);
    rest = f_pick(rest > half_period, half_period, rest);
    bool unknown = f_is_nan(a) || abs(a) > 3.40282347e38;
    return f_pick(unknown, F_NAN, rest);
}
