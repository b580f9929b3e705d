#!/usr/bin/env bash
# draw_pictures.sh BUILD-FOLDER [NAME...]: draws the pictures of docs/scene.md, one for each function that the catalogue
# has, from the scenes in docs/pictures/examples.txt; fails where a function has none.
set -euo pipefail
cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.."
build=$1
shift
names=("$@")
[ ${#names[@]} -gt 0 ] || mapfile -t names < <("$build/docs/write_tables" --names)
scene=$(mktemp --suffix=.lua assets/scenes/picture-XXXXXX) # beside the files that scenes may read
trap 'rm -f -- "$scene"' EXIT
for name in "${names[@]}"; do
    example=$(sed -n "s/^$name: //p" docs/pictures/examples.txt)
    if [ -z "$example" ]; then
        printf 'draw_pictures.sh: docs/pictures/examples.txt has no line for %s\n' "$name" >&2
        exit 1
    fi
    cat >"$scene" <<LUA
up("+Y")
local a, b = box(1.2, 0.9, 0.9):move(-0.25, -0.15, 0), sphere(0.55):move(0.4, 0.3, 0.2)
local tall = box(0.7, 1.5, 0.7)
local knob = union(box(0.9, 0.6, 0.5), cylinder(0.15, 0.9):move(0.25, 0.3, 0), box(0.3, 0.2, 0.9):move(-0.3, -0.2, 0.3))
bounds(-1.05, -1.05, -1.05, 1.05, 1.05, 1.05)
return $example
LUA
    "$build/hewn" render "$scene" -o "docs/pictures/$name.png" --device host --size 160x120 --samples 16 --quiet \
        --camera 1.9,2.1,3.9:0,-0.03,0/26
done
