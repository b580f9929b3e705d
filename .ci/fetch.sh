#!/usr/bin/env bash
# fetch.sh validator|swiftshader: makes sure that a tool from npm lies in the cache and prints its path. Where it
# cannot be had (no npm, no network) it prints why on stderr and exits with 77, which callers show as a skip.
set -euo pipefail

validator_package=gltf-validator@2.0.0-dev.3.10
swiftshader_package=@sparticuz/chromium@153.0.0
cache=${HEWN_DEV_CACHE:?is set by ./dev}

skip() {
    printf '%s\n' "$1" >&2
    exit 77
}

unpack_package() { # NPM-PACKAGE FOLDER [MEMBER...]: the package's files in FOLDER/package
    local tarball
    if ! command -v node >/dev/null || ! command -v npm >/dev/null; then skip 'npm is not installed'; fi
    tarball=$(cd "$2" && timeout 300 npm pack --silent "$1" 2>/dev/null | tail -n 1) || skip "npm cannot fetch $1"
    tar -xzf "$2/$tarball" -C "$2" "${@:3}"
    rm -f "$2/$tarball"
}

publish() { # FOLDER NAME: moves a finished folder to its place, unless another process was faster
    mv -T -- "$1" "$cache/$2" 2>/dev/null || [ -d "$cache/$2" ]
}

fetch_validator() {
    local folder=${validator_package//[@\/]/_}
    if [ ! -d "$cache/$folder" ]; then
        unpack_package "$validator_package" "$work"
        publish "$work/package" "$folder"
    fi
    printf '%s\n' "$cache/$folder"
}

fetch_swiftshader() {
    local folder=swiftshader_${swiftshader_package//[@\/]/_}
    if [ ! -d "$cache/$folder" ]; then
        unpack_package "$swiftshader_package" "$work" package/bin/swiftshader.tar.br
        mkdir "$work/swiftshader"
        node -e 'const fs = require("fs"); fs.writeFileSync(process.argv[2],
            require("zlib").brotliDecompressSync(fs.readFileSync(process.argv[1])))' \
            "$work/package/bin/swiftshader.tar.br" "$work/swiftshader.tar"
        # Its libvulkan.so.1 stays packed: the loader is the system's.
        tar -xf "$work/swiftshader.tar" -C "$work/swiftshader" libvk_swiftshader.so vk_swiftshader_icd.json
        publish "$work/swiftshader" "$folder"
    fi
    printf '%s\n' "$cache/$folder/vk_swiftshader_icd.json"
}

mkdir -p "$cache"
work=$(mktemp -d "$cache/fetch.XXXXXX")
trap 'rm -rf "$work"' EXIT
case ${1:-} in
validator) fetch_validator ;;
swiftshader) fetch_swiftshader ;;
*) printf 'usage: fetch.sh validator|swiftshader\n' >&2; exit 2 ;;
esac
