#!/usr/bin/env bash
# lint.sh BUILD-FOLDER: checks that need no running of Hewn. Every check runs; the last line is `1 passed, 0 failed` or
# `0 passed, 1 failed`. lint.sh --sources: lists our C and C++ files.
# shellcheck disable=SC2317  # run_check calls the checks by name
set -euo pipefail
cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.."

# Files of the checkout: those in git and new ones that git does not ignore; without git, all but build folders.
files() { # PATTERN...: names, one a line
    local pattern tests=()
    if git rev-parse --is-inside-work-tree >/dev/null 2>&1; then
        git ls-files --cached --others --exclude-standard -- "$@" | while IFS= read -r name; do
            [ ! -f "$name" ] || printf '%s\n' "$name"
        done
        return
    fi
    for pattern in "$@"; do tests+=(-o -path "./$pattern"); done
    find . -path './build*' -prune -o -path ./.git -prune -o -type f \( "${tests[@]:1}" \) -printf '%P\n'
}

sources() {
    files '*.c' '*.h' '*.cpp' '*.hpp' | sort
}

check_format() {
    sources | xargs -d '\n' clang-format --dry-run -Werror --
}

# Files of ours that the build compiles, each once.
compiled_sources() { # BUILD-FOLDER
    python3 - "$1" <<'PY' | sort -u
import json, os, sys
top = os.getcwd() + os.sep
build = os.path.realpath(sys.argv[1]) + os.sep
for entry in json.load(open(os.path.join(build, 'compile_commands.json'), encoding='utf-8')):
    path = os.path.realpath(os.path.join(entry['directory'], entry['file']))
    if path.startswith(top) and not path.startswith(build):
        print(os.path.relpath(path))
PY
}

# The analyzer follows 75,000 states of a function, as in its own shallow mode: with three times as many, which is its
# standard, nearly all the time goes to functions whose states it does not come to the end of either.
tidy() { # BUILD-FOLDER [CLANG-ARGUMENT...]: of the files on standard input
    local extra=(--extra-arg=-Wno-unknown-warning-option --extra-arg=-Wno-ignored-optimization-argument) build=$1
    extra+=(--extra-arg=-Xclang --extra-arg=-analyzer-config --extra-arg=-Xclang --extra-arg=max-nodes=75000)
    shift
    xargs -r -d '\n' -n 1 -P "$(nproc)" clang-tidy --quiet -p "$build" "${extra[@]}" "${@/#/--extra-arg=}" \
        2> >(grep -v -e 'warnings\? generated' -e 'warnings treated as errors' >&2)
}

# error.c defines what lint.h redefines.
check_tidy() { # BUILD-FOLDER
    local exception=src/base/error.c bad=0
    compiled_sources "$1" | grep -Fxv "$exception" | tidy "$1" -include "$PWD/.ci/lint.h" || bad=1
    printf '%s\n' "$exception" | tidy "$1" || bad=1
    return "$bad"
}

check_shell() {
    files '*.sh' dev .ci/run | xargs -d '\n' shellcheck
}

check_python() {
    files '*.py' | xargs -d '\n' -n 1 python3 -c \
        'import ast, sys; ast.parse(open(sys.argv[1], encoding="utf-8").read(), sys.argv[1])'
}

text_files() {
    files '*.c' '*.h' '*.cpp' '*.hpp' '*.comp' '*.glsl' '*.lua' '*.sh' '*.py' '*.md' '*.mjs' '*meson.build' dev .ci/run .ci/packages.txt
}

# Fails, showing the lines, where any file named on standard input matches.
must_not_match() { # GREP-ARGUMENT...
    ! { xargs -d '\n' grep -n "$@" -- || true; } | grep .
}

check_whitespace() {
    text_files | must_not_match -E '[[:blank:]]+$|'$'\r'
}

check_newline() {
    local name bad=0
    while IFS= read -r name; do
        [ -z "$(tail -c 1 -- "$name")" ] || { printf '%s: no newline at its end\n' "$name" && bad=1; }
    done < <(text_files)
    return "$bad"
}

check_length() {
    text_files | xargs -d '\n' awk 'FNR == 801 { print FILENAME ": more than 800 lines"; bad = 1 } END { exit bad }'
}

check_unfinished() {
    files 'src/*' 'include/*' 'shaders/*' | must_not_match -wE 'TODO|FIXME|XXX|HACK'
}

run_check() { # NAME FUNCTION [ARGUMENT...]
    local name=$1 begin=$SECONDS
    shift
    if "$@"; then
        printf 'lint: %-12s ok (%d s)\n' "$name" $((SECONDS - begin))
    else
        printf 'lint: %-12s FAILED\n' "$name"
        failed=1
    fi
}

if [ "${1:-}" = --sources ]; then
    sources
    exit
fi
failed=0
run_check format check_format
run_check clang-tidy check_tidy "${1:?usage: lint.sh BUILD-FOLDER}"
run_check shellcheck check_shell
run_check python check_python
run_check whitespace check_whitespace
run_check newline check_newline
run_check length check_length
run_check unfinished check_unfinished
printf '%d passed, %d failed\n' $((1 - failed)) "$failed"
exit "$failed"
