-- A block of rocky ground: hills with ridges, and winding caves that open in the slopes and the cut sides.
local seed = param("seed", 3, {min = 0, max = 65535, integer = true, help = "another landscape for each"})
local caves = param("caves", 0.16, {min = 0, max = 0.3, help = "how wide the caves are"})
local size = 4

local hills = 0.55 * fbm(2.6, 2, seed) + 0.28 * ridged(1.5, 3, seed + 100, "gradient", 0.4)
-- Where two noises are both about 0 they leave winding tunnels, which end above the floor.
local narrowing = max(-0.2 - y, 0)
local tunnel = sqrt(noise(1.5, seed + 50) ^ 2 + noise(1.5, seed + 70) ^ 2) - caves + narrowing
-- Of slopes of at most about 2; neither is a distance.
local ground = 0.5 * (y - hills)
local rock = smooth_difference(ground, 0.5 * tunnel, 0.03)
bounds(-size / 2 - 0.1, -0.8, -size / 2 - 0.1, size / 2 + 0.1, 0.9, size / 2 + 0.1)
return rock & box(size, 1.4, size)
