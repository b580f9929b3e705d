-- A hand grip filled with a gyroid: a closed skin around an inside of thin walls, cut open to show it.
units("mm")

local cell = param("cell", 20, {min = 6, max = 40, help = "period of the gyroid"})
local wall = param("wall", 2.4, {min = 0.4, max = 4, help = "thickness of its walls"})
local skin = param("skin", 3, {min = 0.8, max = 6, help = "thickness of the skin"})

local grip = smooth_union(ellipsoid(30, 22, 22), ellipsoid(18, 20, 20):move(28, 4, 0), 8)
local inside = grip + skin
local filled = (grip & ~inside) | (gyroid(cell, wall) & grip)
return filled & ~box(80, 50, 50):move(0, 25, 20)
