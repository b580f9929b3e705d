-- A cube of body-centred struts, melted together at the nodes, between two plates.
local cells = param("cells", 4, {min = 1, max = 12, integer = true, help = "along each side"})
local strut = param("strut", 0.07, {min = 0.02, max = 0.15, help = "radius of the struts, in cells"})

-- One eighth of a cell, mirrored into the others: from the centre to a corner, and half of the upright edge.
local diagonal = tube({{0, 0, 0}, {0.5, 0.5, 0.5}}, strut)
local edge = tube({{0.5, 0, 0.5}, {0.5, 0.5, 0.5}}, strut)
local cell = smooth_union(diagonal, edge, 0.1):symmetric("x"):symmetric("y"):symmetric("z")
local half = cells / 2
local shift = cells % 2 == 0 and 0.5 or 0
local lattice = cell:mirror_tile(1, 1, 1):move(shift, shift, shift)
local plate = rounded_box(cells + 0.2, 0.2, cells + 0.2, 0.05)
local plates = plate:move(0, half, 0) | plate:move(0, -half, 0)
return smooth_union(lattice & box(cells), plates, 0.1)
