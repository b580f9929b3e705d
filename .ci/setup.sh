#!/usr/bin/env bash
# setup.sh SECTION...: installs the Debian packages of these sections of packages.txt that are missing. Asks for nothing
# and, when all are there, does nothing but one look at dpkg's books.
set -euo pipefail
here=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)

packages_of() { # SECTION: the names in it, one a line
    awk -v section="[$1]" '{ sub(/[ \t]*#.*/, "") } /^\[/ { inside = ($0 == section); next } inside && NF { print $1 }' \
        "$here/packages.txt"
}

missing_of() { # PACKAGE...: those that are not installed, one a line
    local installed
    installed=$(dpkg-query -W -f '${Package} ${db:Status-Status}\n' -- "$@" 2>/dev/null |
        awk '$2 == "installed" { print $1 }' || true)
    printf '%s\n' "$@" | grep -Fxv -f <(printf '%s\n' "$installed") || true
}

fail_with_command() { # PACKAGE...: no right to install; says what to type
    {
        printf 'hewn: these Debian packages are missing and installing them needs root. Run, as root:\n\n'
        printf '    apt-get update && apt-get install -y --no-install-recommends %s\n\n' "$*"
    } >&2
    exit 1
}

install_packages() { # PACKAGE...
    local as_root=() log
    if [ "$(id -u)" -ne 0 ]; then
        if ! command -v sudo >/dev/null || ! sudo -n true 2>/dev/null; then fail_with_command "$@"; fi
        as_root=(sudo -n)
    fi
    log=$(mktemp)
    printf 'Installing Debian packages: %s\n' "$*"
    if ! { "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq update &&
        "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -y --no-install-recommends \
            -o Dpkg::Use-Pty=0 -o DPkg::Lock::Timeout=300 install "$@"; } >"$log" 2>&1 </dev/null; then
        tail -n 20 "$log" >&2
        rm -f "$log"
        printf 'hewn: apt-get could not install them (its last words are above).\n' >&2
        exit 1
    fi
    rm -f "$log"
}

names=()
for section in "$@"; do
    while IFS= read -r name; do names+=("$name"); done < <(packages_of "$section")
done
[ ${#names[@]} -gt 0 ] || { printf 'setup.sh: no packages in section %s\n' "$*" >&2; exit 2; }

if ! command -v dpkg-query >/dev/null; then
    printf 'hewn: not a Debian system, so nothing is installed; the build needs what these packages hold:\n  %s\n' \
        "${names[*]}" >&2
    exit 0
fi
missing=()
while IFS= read -r name; do missing+=("$name"); done < <(missing_of "${names[@]}")
[ ${#missing[@]} -eq 0 ] || install_packages "${missing[@]}"
