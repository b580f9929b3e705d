-- A ball filled with a wall that follows a gyroid, the triply periodic surface g = 0: one connected shell with hundreds
-- of tunnels.
bounds(-1, -1, -1, 1, 1, 1)

local g = sin(12 * x) * cos(12 * y) + sin(12 * y) * cos(12 * z) + sin(12 * z) * cos(12 * x)
return max(abs(g) - 0.4, sqrt(x ^ 2 + y ^ 2 + z ^ 2) - 0.9)
