-- A vase: a fluted outline, wider in the middle, twisted, hollow, and open at the top.
local twist_of = param("twist", 70, {min = -360, max = 360, help = "degrees from the bottom to the top"})
local flutes = param("flutes", 9, {min = 3, max = 24, integer = true, help = "how many"})
local height, wall = 2, 0.09

-- Wide in the middle: the radius along the height.
local belly = 0.55 + 0.16 * cos(3 * y - 0.4)
-- The cosine of so many times the angle around the axis, as the real part of a power: an angle itself would jump.
local r = sqrt(x ^ 2 + z ^ 2)
local c, s = x / max(r, 0.1), z / max(r, 0.1)
local wave, other = c, s
for _ = 2, flutes do
    wave, other = wave * c - other * s, wave * s + other * c
end
local function body(inset)
    return (r - belly - 0.05 * max(min(wave, 1), -1) + inset) * 0.7
end
local outside = body(0) & plane(0, 1, 0, height / 2) & plane(0, -1, 0, height / 2)
local hollow = body(wall) & plane(0, -1, 0, height / 2 - 0.12)
bounds(-0.85, -1.05, -0.85, 0.85, 1.05, 0.85)
return (outside & ~hollow):twist(twist_of / height)
