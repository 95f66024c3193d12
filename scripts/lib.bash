# What the scripts share. Sourced, never run: `source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"`.
set -euo pipefail
export LC_ALL=C.UTF-8
project=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
script=scripts/$(basename "$0")
cd "$project"

say() { printf '%s: %s\n' "$script" "$*"; }
fail() {
    printf '%s: error: %s\n' "$script" "$*" >&2
    exit 1
}

# The packages named in lists such as packaging/apt-core.txt.
listed_packages() { sed 's/#.*//' "$@" | tr -s '[:space:]' '\n' | sed '/^$/d'; }

# Which of the given packages are not installed, one a line.
missing_packages() {
    local installed
    installed=$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' 2>/dev/null | sed -n 's/^installed //p')
    printf '%s\n' "$@" | grep -vxF -f <(printf '%s\n' "$installed") || true
}

# Runs a command as root: as it is, or through sudo (which may ask for a password only where someone can answer).
as_root() {
    if [[ $(id -u) == 0 ]]; then
        "$@"
    elif [[ -t 0 && -z ${CI:-} ]]; then
        sudo "$@"
    else
        sudo -n "$@"
    fi
}

# Installs what is missing of the packages in the given lists. Needs neither root nor network when nothing is.
require_packages() {
    if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
        say "not a Debian system: taking it that the libraries in $* are installed"
        return
    fi
    local wanted missing
    mapfile -t wanted < <(listed_packages "$@")
    mapfile -t missing < <(missing_packages "${wanted[@]}")
    [[ ${#missing[@]} == 0 ]] && return

    local by_hand="apt-get install --no-install-recommends ${missing[*]}"
    if [[ $(id -u) != 0 ]] && ! command -v sudo >/dev/null; then
        fail "packages are missing that only root can install; as root, run: $by_hand"
    fi
    mkdir -p build
    local log=build/apt.log
    say "installing ${#missing[@]} missing packages: ${missing[*]}"
    local options=(-q -o Acquire::Retries=3 -o DPkg::Lock::Timeout=300)
    as_root apt-get "${options[@]}" update >"$log" 2>&1 || true  # a stale list may still do; the next step tells
    if ! as_root env DEBIAN_FRONTEND=noninteractive apt-get "${options[@]}" install -y --no-install-recommends \
            "${missing[@]}" >>"$log" 2>&1; then
        local reason
        reason=$(grep -E '^(E:|sudo:)' "$log" | tail -n 1 || true)
        fail "apt-get could not install the missing packages (${reason:-see $log}); by hand: $by_hand"
    fi
}

# Configures a preset unless that has been done (the build itself notices changes), then builds the given targets or all.
# Quiet unless something goes wrong: the full output is in build/PRESET.log.
build_preset() {
    local preset=$1 log=build/$1.log
    shift
    if [[ -z ${CMAKE_CXX_COMPILER_LAUNCHER:-} ]] && command -v ccache >/dev/null; then
        # The second pair lets a fresh checkout elsewhere use what an earlier one compiled.
        export CMAKE_CXX_COMPILER_LAUNCHER=ccache CCACHE_BASEDIR=$project CCACHE_NOHASHDIR=1
    fi
    mkdir -p build
    : >"$log"
    if [[ ! -f build/$preset/build.ninja ]]; then
        cmake --preset "$preset" >>"$log" 2>&1 || {
            tail -n 30 "$log" >&2
            fail "cmake cannot configure preset $preset (above: the end of $log)"
        }
    fi
    local targets=()
    [[ $# == 0 ]] || targets=(--target "$@")
    cmake --build --preset "$preset" "${targets[@]}" >>"$log" 2>&1 || {
        grep -E -A 12 'error:|FAILED:|undefined reference' "$log" | head -n 80 >&2 || tail -n 30 "$log" >&2
        fail "preset $preset does not build (above: the first errors in $log)"
    }
}
