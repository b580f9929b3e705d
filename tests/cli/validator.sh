#!/usr/bin/env bash
# Every shipped scene, meshed by the command into GLB, and what `hewn convert` and `hewn lod` write have 0 errors and 0
# warnings in the Khronos glTF validator. TAP on standard output. Needs HEWN_COMMAND and HEWN_SOURCE; without node or
# the validator (./dev fetches it) it skips.
# shellcheck disable=SC2317  # check calls the cases by name
set -uo pipefail

shopt -s nullglob
scenes=("$HEWN_SOURCE"/assets/scenes/*.lua)
validators=("${HEWN_DEV_CACHE:-${HOME:-/nonexistent}/.cache/hewn-dev}"/gltf-validator_*)

skip_all() {
    printf '1..0 # SKIP %s\n' "$1"
    exit 0
}

command -v node >/dev/null || skip_all 'node is not installed'
[ ${#validators[@]} -gt 0 ] || skip_all 'the npm package gltf-validator is not in the cache; ./dev test fetches it'

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0
number=0

check() { # NAME COMMAND...: one case; the first failing command's output becomes comments
    local name=$1
    shift
    number=$((number + 1))
    if "$@" >"$work/log" 2>&1; then
        printf 'ok %d - %s\n' "$number" "$name"
    else
        printf 'not ok %d - %s\n' "$number" "$name"
        sed 's/^#* */# /' "$work/log"
        failed=1
    fi
}

mesh_and_validate() { # SCENE
    "$HEWN_COMMAND" mesh "$1" -o "$work/scene.glb" --res 64 --quiet &&
        node "$HEWN_SOURCE/tests/cli/validate_gltf.cjs" "${validators[-1]}" "$work/scene.glb"
}

# A validator that finds nothing anywhere would prove nothing.
rejects_a_broken_file() {
    printf 'glTF\002\000\000\000\014\000\000\000' >"$work/broken.glb"
    ! node "$HEWN_SOURCE/tests/cli/validate_gltf.cjs" "${validators[-1]}" "$work/broken.glb"
}

# A cube with an own piece of texture for each side, normals and materials; MORE is another face or nothing.
textured_cube() { # MORE
    cat <<'OBJ'
v 0 0 0
v 1 0 0
v 0 1 0
v 1 1 0
v 0 0 1
v 1 0 1
v 0 1 1
v 1 1 1
vt 0 0
vt 0.3 0
vt 0.3 0.7
vt 0 0.7
vn 0 0 -1
vn 0 0 1
vn 0 -1 0
vn 0 1 0
vn -1 0 0
vn 1 0 0
usemtl red
f 1/1/1 3/2/1 4/3/1 2/4/1
f 5/1/2 6/2/2 8/3/2 7/4/2
usemtl "blue"
f 1/1/3 2/2/3 6/3/3 5/4/3
f 3/1/4 7/2/4 8/3/4 4/4/4
f 1/1/5 5/2/5 7/3/5 3/4/5
OBJ
    printf '%s\n' "$1"
}

# Colours beyond 1, bytes, and numbers that are nobody's but the user's.
coloured_points() {
    cat <<'PLY'
ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
property uchar red
property uchar green
property uchar blue
property int label
property double heat
element face 4
property list uchar int vertex_indices
end_header
0 0 0 255 0 0 -1 1e300
1 0 0 0 255 0 70000 0.1
0 1 0 0 0 255 2 0.2
0 0 1 7 8 9 3 0.3
3 0 2 1
3 0 1 3
3 1 2 3
3 2 0 3
PLY
}

convert_and_validate() { # FILE TEXT-THAT-THE-RESULT-MUST-HAVE
    "$HEWN_COMMAND" convert "$1" -o "$work/converted.glb" --quiet &&
        grep -qaF -- "$2" "$work/converted.glb" &&
        node "$HEWN_SOURCE/tests/cli/validate_gltf.cjs" "${validators[-1]}" "$work/converted.glb"
}

lod_and_validate() { # FILE TEXT-THAT-THE-RESULT-MUST-HAVE OPTION...
    local file=$1 text=$2
    shift 2
    "$HEWN_COMMAND" lod "$file" -o "$work/lod.glb" "$@" --quiet && grep -qaF -- "$text" "$work/lod.glb" &&
        node "$HEWN_SOURCE/tests/cli/validate_gltf.cjs" "${validators[-1]}" "$work/lod.glb"
}

textured_cube 'f 2/1/6 4/2/6 8/3/6 6/4/6' >"$work/closed.obj"
textured_cube '' >"$work/open.obj"
coloured_points >"$work/coloured.ply"

printf '1..%d\n' $((${#scenes[@]} + 8))
check 'there are scenes' test ${#scenes[@]} -gt 0
check 'the validator rejects a broken file' rejects_a_broken_file
check 'seams of a closed surface' convert_and_validate "$work/closed.obj" EXT_mesh_manifold
check 'seams of an open surface' convert_and_validate "$work/open.obj" hewn_topology
check 'colours and users attributes' convert_and_validate "$work/coloured.ply" COLOR_0
bust=$HEWN_SOURCE/assets/scenes/meshes/demosthenes.ply
check 'levels of detail' lod_and_validate "$bust" MSFT_lod --levels 1,0.3,0.1
check 'levels of detail with seams' lod_and_validate "$work/closed.obj" MSFT_lod --levels 1,0.5
check 'clusters' lod_and_validate "$bust" hewn_clusters --clusters
for scene in "${scenes[@]}"; do
    check "$(basename -- "$scene")" mesh_and_validate "$scene"
done
exit "$failed"
