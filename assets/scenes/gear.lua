-- A spur gear with involute teeth, its hub, bore and keyway, and holes that save weight. Millimetres, +Z up.
units("mm")
up("+Z")

local teeth = param("teeth", 18, {min = 8, max = 60, integer = true, help = "how many"})
local module = param("module", 3, {min = 1, max = 10, help = "pitch diameter over the number of teeth"})
local pressure = math.rad(param("pressure", 20, {min = 14, max = 30, help = "angle of pressure, degrees"}))
local width = param("width", 12, {min = 4, max = 60, help = "along the axis"})

local pitch = teeth * module / 2
local base, tip, root = pitch * math.cos(pressure), pitch + module, pitch - 1.25 * module

-- The involute of the base circle at a radius: how far the thread that unwinds has turned.
local function unwound(radius)
    local angle = math.acos(math.min(base / radius, 1))
    return math.tan(angle) - angle
end

-- Half of the angle that a tooth takes at a radius; half the pitch on the pitch circle.
local function half_angle(radius)
    return math.pi / (2 * teeth) + unwound(pitch) - unwound(math.max(radius, base))
end

local points = {}
local function add(radius, angle)
    points[#points + 1] = {radius * math.cos(angle), radius * math.sin(angle)}
end
local steps = 4
for tooth = 0, teeth - 1 do
    local middle = 2 * math.pi * tooth / teeth
    add(root, middle - half_angle(base))
    for i = 0, steps do
        local radius = math.max(root, base) + (tip - math.max(root, base)) * i / steps
        add(radius, middle - half_angle(radius))
    end
    for i = steps, 0, -1 do
        local radius = math.max(root, base) + (tip - math.max(root, base)) * i / steps
        add(radius, middle + half_angle(radius))
    end
    add(root, middle + half_angle(base))
end

local hub, bore = 0.45 * root, 0.25 * root
local hole = 0.16 * root
local holes = circle(hole):move(0.72 * root, 0, 0):radial(6, "z")
local wheel = polygon(points):extrude(width) & ~holes
local boss = circle(hub):extrude(1.6 * width)
local keyway = rectangle(0.3 * bore, bore):move(0, bore, 0)
return round_union(wheel, boss, 0.15 * width) & ~circle(bore) & ~keyway
