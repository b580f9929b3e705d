-- A heap of balls, boxes and rings at random, melted together one after the other. What a point of it costs should
-- depend on what is near, not on n.
local n = param("n", 1000, {min = 1, max = 100000, integer = true, help = "how many shapes"})
local melt = param("melt", 0.2, {min = 0, max = 1, help = "how far they melt together, in mean distances of shapes"})
local seed = param("seed", 1, {min = 0, integer = true, help = "another heap for each"})
math.randomseed(seed)

local function between(lo, hi)
    return lo + (hi - lo) * math.random()
end

-- The edge of a cube that holds one shape on average.
local room = 2 / n ^ (1 / 3)
local far = 1 + 0.6 * room
bounds(-far, -far, -far, far, far, far)
local shapes = {
    function(size) return sphere(0.6 * size) end,
    function(size) return box(size, between(0.5, 1) * size, between(0.5, 1) * size) end,
    function(size) return torus(0.5 * size, 0.2 * size) end,
}

local heap
for i = 1, n do
    local size = room * between(0.3, 0.6)
    local shape = shapes[math.random(#shapes)](size)
        :rotate(between(-1, 1), between(-1, 1), between(-1, 1), between(0, 360))
        :move(between(-1, 1), between(-1, 1), between(-1, 1))
    heap = heap and smooth_union(heap, shape, melt * room) or shape
end
return heap
