-- The Menger sponge of level L: from the cube of +-1, square holes of three directions are cut at every level. Its
-- volume is 8 * (20/27)^L.
bounds(-1.2, -1.2, -1.2, 1.2, 1.2, 1.2)

local L = param("L", 3, {min = 1, max = 5, integer = true, help = "how many times holes are cut"})

local holes
for level = 1, L do
    local n = 3 ^ (level - 1)
    -- The distance of t from the middle line of the nearest of n holes across.
    local function d(t)
        local nearest
        for i = 0, n - 1 do
            local distance = abs(t - (-1 + (2 * i + 1) / n))
            nearest = nearest and min(nearest, distance) or distance
        end
        return nearest
    end
    local dx, dy, dz = d(x), d(y), d(z)
    for _, pair in ipairs({{dx, dy}, {dy, dz}, {dz, dx}}) do
        local hole = max(pair[1], pair[2]) - 1 / (3 * n)
        holes = holes and min(holes, hole) or hole
    end
end

return max(max(abs(x), abs(y), abs(z)) - 1, -holes)
