-- A scanned bust on a turned plinth. The scan is open below: what is inside is told by winding numbers, and the hole
-- closes by itself. README.md says whose it is.
local scan = mesh_field("meshes/demosthenes.ply", {cell = 0.03})
local plinth = revolve(outline{
    {0.7, 0}, {0.7, 0.12}, {0.62, 0.14, 0.6, 0.2}, {0.5, 0.28, 0.5, 0.42}, {0.58, 0.46}, {0.58, 0.54}, {0, 0.54}, {0, 0}})
return smooth_union(scan, plinth:move(0.1, -0.85, 0.1), 0.06)
