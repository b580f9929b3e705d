-- A flanged bearing bracket: a base plate with a hole in each corner, an upright web that carries a bored boss with a
-- bolt circle, and two ribs in front and behind. Fillets are smooth unions. Millimetres, +Z up, the base stands on
-- z = 0; the shaft runs along y.
units("mm")
up("+Z")

local width = param("width", 120, {min = 90, max = 240, help = "base plate along x"})
local depth = param("depth", 80, {min = 60, max = 160, help = "base plate along y"})
local thickness = param("thickness", 12, {min = 6, max = 18, help = "of the base plate and the web"})
local height = param("height", 80, {min = 75, max = 200, help = "from the floor to the middle of the shaft"})
local bore = param("bore", 30, {min = 10, max = 40, help = "diameter of the shaft's hole"})
local bolts = param("bolts", 6, {min = 3, max = 12, integer = true, help = "holes of the flange"})
local fillet = param("fillet", 8, {min = 1, max = 12, help = "radius of the fillets"})

-- Bodies that lie along the axis of the shaft, or stand.
local function along_y(radius, length)
    return cylinder(radius, length)
end
local function standing(radius, length)
    return cylinder(radius, length):rotate_x(90)
end

-- The flange of the boss has room for the bolt circle around the bore.
local bolt_radius = 3.3
local circle = bore / 2 + 10
local flange = circle + 9
local boss_length = thickness + 24

-- Base plate with rounded upright edges.
local corner = 10
local plate = (box(width - 2 * corner, depth, thickness) | box(width, depth - 2 * corner, thickness))
for _, sx in ipairs({-1, 1}) do
    for _, sy in ipairs({-1, 1}) do
        local post = standing(corner, thickness)
        plate = plate | post:move(sx * (width / 2 - corner), sy * (depth / 2 - corner), 0)
    end
end
plate = plate:move(0, 0, thickness / 2)

-- The side of a plane that the normal points away from, of the plane through a point with that normal.
local function below(nx, ny, nz, px, py, pz)
    return plane(nx, ny, nz, (nx * px + ny * py + nz * pz) / sqrt(nx ^ 2 + ny ^ 2 + nz ^ 2))
end

-- The web narrows from the plate to the boss: a wide box between two leaning planes.
local web_top = flange * 0.95
local web_bottom = math.min(width / 2 - 26, flange * 1.25)
local lean = (web_bottom - web_top) / height
local web = box(4 * flange, thickness, height):move(0, 0, height / 2)
    & below(1, 0, lean, web_bottom, 0, 0)
    & below(-1, 0, lean, -web_bottom, 0, 0)

local boss = along_y(flange, boss_length):move(0, 0, height)

-- A rib in front and one behind, from the plate's edge up to under the boss.
local rib_top = height - flange * 0.6
local rib_reach = depth / 2 - 6
local foot = thickness + 3
local rise, run = height - flange - foot, rib_reach - boss_length / 2
local rib = box(thickness * 0.8, depth, rib_top):move(0, 0, rib_top / 2)
    & below(0, rise, run, 0, rib_reach, foot)
    & below(0, -rise, run, 0, -rib_reach, foot)
    & box(thickness, 2 * rib_reach, 2 * rib_top)

local body = smooth_union(web, boss, fillet, "circular")
body = smooth_union(body, rib, fillet * 0.6, "circular")
body = smooth_union(plate, body, fillet, "circular")

-- Holes: the shaft's with a chamfer at both ends, the bolt circle, and the base plate's, countersunk from above.
local holes = along_y(bore / 2, 2 * boss_length):move(0, 0, height)
for _, side in ipairs({-1, 1}) do
    local chamfer = cone(bore / 2 - 1, bore / 2 + 2, 3):rotate_x(side < 0 and 180 or 0)
    holes = holes | chamfer:move(0, side * (boss_length / 2 - 0.5), height)
end
for i = 0, bolts - 1 do
    local angle = 2 * math.pi * (i + 0.5) / bolts
    holes = holes | along_y(bolt_radius, 2 * boss_length):move(circle * cos(angle), 0, height + circle * sin(angle))
end
for _, sx in ipairs({-1, 1}) do
    for _, sy in ipairs({-1, 1}) do
        local hole = standing(4.5, 4 * thickness) | standing(8, 6):move(0, 0, thickness + 1)
        holes = holes | hole:move(sx * (width / 2 - 14), sy * (depth / 2 - 14), 0)
    end
end

-- What the fillet of the plate adds below the floor is cut flat.
local floor_cut = plane(0, 0, -1, 0)
bounds(-width / 2 - 2, -depth / 2 - 2, -2, width / 2 + 2, depth / 2 + 2, height + flange + 2)
return body & floor_cut & ~holes
