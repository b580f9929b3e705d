-- A block of rocky ground: hills of ridged noise, terraces, and caves that open in the slopes.
local seed = param("seed", 4, {min = 0, max = 65535, integer = true, help = "another landscape for each"})
local size = 4

local ground = y - 0.35 * ridged(2.4, 4, seed) - 0.06 * fbm(0.5, 3, seed + 100)
local caves = 0.22 - abs(noise(0.9, seed + 50)) - abs(noise(0.9, seed + 70))
-- Caves end some way below the hills, so that they do not eat the block.
local deep = y + 0.1
local hollow = smooth_intersection(-0.45 * caves, deep:offset(0.45), 0.05)
local rock = smooth_difference(0.5 * ground, hollow & plane(0, -1, 0, 0.45), 0.05)
bounds(-size / 2 - 0.1, -0.8, -size / 2 - 0.1, size / 2 + 0.1, 0.9, size / 2 + 0.1)
return rock & box(size, 1.4, size)
