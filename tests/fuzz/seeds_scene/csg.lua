-- A ball with a cube cut out of its corner, melted together with a ring below it: the smallest scene with every kind
-- of edge, sharp, cut and blended. Plain arithmetic, so that it can be compared with other programs exactly.
bounds(-1, -1, -1, 1, 1, 1)

local ball = sqrt(x ^ 2 + y ^ 2 + z ^ 2) - 0.8
local cube = max(abs(x - 0.5), abs(y - 0.5), abs(z - 0.5)) - 0.45
local cut = max(ball, -cube)
local ring = sqrt((sqrt(x ^ 2 + y ^ 2) - 0.7) ^ 2 + (z + 0.35) ^ 2) - 0.15

-- The quadratic smooth minimum of size 0.2.
return min(cut, ring) - max(0.2 - abs(cut - ring), 0) ^ 2 / 0.8
