-- A house sign: a plate with a raised rim and holes for screws, letters cut into it and filled with paint.
local words = "Hewn"
local width = param("width", 160, {min = 120, max = 300, help = "of the plate"})
local depth = param("depth", 1.5, {min = 0.5, max = 3, help = "of the letters"})
local height, thickness, rim = 70, 6, 3

units "mm"
local font = "fonts/DejaVuSerif-Bold.ttf"
local function outline(inset)
    return rectangle(width - 24 - 2 * inset, height - 24 - 2 * inset):offset(12)
end

local plate = outline(0):extrude(thickness):color("#3a5a40")
local frame = (outline(2.5) & ~outline(2.5 + rim)):extrude(2):move(0, 0, thickness / 2 + 0.4):color("#d9c58b")
local body = smooth_union(plate, frame, 1)

-- What is cut paints the cut, so the letters are gold down to their ground.
local letters = text(words, font, 40, {align = "center", anchor = "middle", spacing = 1}):extrude(2 * depth):move(0, 0, thickness / 2):color("#d9c58b")

local screws = (cylinder(2, 3 * thickness) | cone(1, 4, 4):move(0, thickness / 2 - 1, 0)):rotate_x(90)
screws = screws:move(width / 2 - 11, 0, 0):symmetric("x")
return body & ~letters & ~screws
