#!/usr/bin/env bash
# The installed library, used as README.md says: its C program is cut out of the README, compiled with pkg-config's
# flags against an installation, and run. TAP on standard output. Needs HEWN_COMMAND (in the build folder) and
# HEWN_SOURCE.
# shellcheck disable=SC2317  # check calls the cases by name
set -uo pipefail

build=$(dirname -- "$HEWN_COMMAND")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0
number=0

check() { # NAME COMMAND...
    local name=$1
    shift
    number=$((number + 1))
    if "$@" >"$work/log" 2>&1; then
        printf 'ok %d - %s\n' "$number" "$name"
    else
        printf 'not ok %d - %s\n' "$number" "$name"
        sed 's/^/# /' "$work/log"
        failed=1
    fi
}

install_it() {
    DESTDIR=$work/root meson install -C "$build" --no-rebuild || return 1
    config=$(find "$work/root" -name hewn.pc)
    library=$(find "$work/root" -name libhewn.so)
    export PKG_CONFIG_PATH=${config%/*} PKG_CONFIG_SYSROOT_DIR=$work/root LD_LIBRARY_PATH=${library%/*}
    [ -n "$config" ] && [ -n "$library" ]
}

# A library that was built with sanitizers needs them in the program too.
sanitizers() {
    ! nm -D "$library" | grep -q __asan_ || printf '%s\n' -fsanitize=address,undefined
}

compile_readme() {
    awk '/^```c$/ { inside = 1; next } /^```$/ { inside = 0 } inside' "$HEWN_SOURCE/README.md" >"$work/program.c"
    # shellcheck disable=SC2046  # pkg-config prints words
    gcc -std=c17 -Wall -Wextra -Wpedantic -Werror "$work/program.c" -o "$work/program" $(sanitizers) \
        $(pkg-config --cflags --libs hewn)
}

run_readme() {
    (cd "$work" && ./program) | tee "$work/said" && grep -qx 'closed: 1, genus: 0, volume: 3\.6[0-9]*' "$work/said" &&
        [ -s "$work/cut.ply" ]
}

soname_is_stable() {
    readelf -d "$library" | grep -F '[libhewn.so.0]'
}

exports_only_its_own() {
    ! nm -D --defined-only "$library" | awk '{ print $3 }' | grep -v '^hewn_'
}

headers_stand_alone() {
    local header
    for header in "$HEWN_SOURCE"/include/hewn/*.h; do
        gcc -std=c17 -Wall -Wextra -Wpedantic -Werror -fsyntax-only -I"$HEWN_SOURCE/include" -x c "$header" || return 1
        g++ -std=c++17 -Wall -Wextra -Werror -fsyntax-only -I"$HEWN_SOURCE/include" -x c++ "$header" || return 1
    done
}

printf '1..6\n'
check 'it installs' install_it
check 'its soname is libhewn.so.0' soname_is_stable
check 'it exports only hewn_ names' exports_only_its_own
check 'each public header stands alone, in C and C++' headers_stand_alone
check 'the program of README.md compiles with the flags of pkg-config' compile_readme
check 'the program of README.md makes a closed mesh' run_readme
exit "$failed"
