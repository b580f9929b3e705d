-- A chess queen: an outline of curves turned around its axis, a crown of points, and a ball.
local outline_of_body = outline{
    {0.42, 0}, {0.42, 0.08}, {0.4, 0.14, 0.34, 0.14}, {0.36, 0.22, 0.3, 0.26}, {0.18, 0.32, 0.15, 0.6, 0.11, 1.15},
    {0.2, 1.16}, {0.23, 1.2, 0.2, 1.24}, {0.12, 1.25}, {0.12, 1.3, 0.16, 1.4, 0.24, 1.52}, {0, 1.52}, {0, 0}}
local body = revolve(outline_of_body)
local notches = sphere(0.075):move(0, 1.54, 0.25):radial(8)
local cup = cone(0.05, 0.19, 0.12):move(0, 1.5, 0)
local crown = sphere(0.13):move(0, 1.5, 0)
local ball = sphere(0.06):move(0, 1.66, 0)
body = smooth_difference(body, notches, 0.02) & ~cup
return smooth_union(smooth_union(body, crown, 0.03), ball, 0.04)
