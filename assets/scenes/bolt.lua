-- A hexagon-head bolt with a metric thread, cut as one helix, with a chamfered end. Millimetres, +Y up the shaft.
units("mm")

local diameter = param("diameter", 12, {min = 4, max = 40, help = "of the thread, outside"})
local pitch = param("pitch", 3, {min = 0.5, max = 8, help = "from turn to turn"})
local length = param("length", 36, {min = 10, max = 200, help = "of the shaft"})

local radius = diameter / 2
local depth = 0.6 * pitch

-- Turned back by its height, a point sees the thread as a profile around the axis: `part` is the angle from the crest, from
-- 0 to 1 for half a turn.
local turn = 2 * math.pi / pitch * y
local r = sqrt(x ^ 2 + z ^ 2)
local along = (x * cos(turn) + z * sin(turn)) / max(r, 0.1 * radius)
local part = acos(max(min(along, 1), -1)) / math.pi
local flank = max(min(depth * (part * 1.25 - 0.125), depth), 0)
-- As steep as the flanks are, the value is scaled to stay within the distance.
local thread = (r - radius + flank) * 0.7

local shaft = thread & plane(0, -1, 0, 0) & plane(0, 1, 0, length)
local tip = cone(radius - depth, radius + 2 * length - depth, 2 * length):move(0, length, 0)
shaft = shaft & tip:rotate_x(180):move(0, length, 0) & cylinder(radius, 2 * length):move(0, 0, 0)

local head_height = 0.65 * diameter
local head = prism(6, diameter, head_height) & sphere(1.35 * diameter):move(0, 0.82 * diameter, 0)
local collar = cylinder(radius, 4):move(0, 1, 0)
bounds(-1.1 * diameter, -head_height - 1, -1.1 * diameter, 1.1 * diameter, length + 1, 1.1 * diameter)
return shaft | collar | head:move(0, -head_height / 2, 0)
