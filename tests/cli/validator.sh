#!/usr/bin/env bash
# Every shipped scene, meshed by the command into GLB, has 0 errors and 0 warnings in the Khronos glTF validator. TAP
# on standard output. Needs HEWN_COMMAND and HEWN_SOURCE; without node or the validator (./dev fetches it) it skips.
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

printf '1..%d\n' $((${#scenes[@]} + 2))
check 'there are scenes' test ${#scenes[@]} -gt 0
check 'the validator rejects a broken file' rejects_a_broken_file
for scene in "${scenes[@]}"; do
    check "$(basename -- "$scene")" mesh_and_validate "$scene"
done
exit "$failed"
