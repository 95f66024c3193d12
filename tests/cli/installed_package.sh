#!/usr/bin/env bash
# An installed Pentaprism can be found with find_package, and a program of another project builds with it and renders.
set -euo pipefail
build=$(dirname "$PENTAPRISM")
source_dir=$(cd "$(dirname "$0")/../.." && pwd)

skip() {
    echo "skipped: $*"
    exit 77
}
command -v cmake >/dev/null || skip "cmake is not on the path"
if grep -qE '^PENTAPRISM_(SANITIZE:[A-Z]+=.|COVERAGE:[A-Z]+=ON)' "$build/CMakeCache.txt"; then
    skip "an instrumented library is not for installing"
fi

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake --install "$build" --prefix "$work/prefix" >"$work/install.log" || { cat "$work/install.log"; exit 1; }
if grep -R pentaprism_options "$work"/prefix/lib*; then
    echo "the compile options of this project leak into the installed package"
    exit 1
fi

cmake -S "$source_dir/examples/render_builtin" -B "$work/build" -G Ninja -DCMAKE_PREFIX_PATH="$work/prefix" \
    -DCMAKE_CXX_COMPILER="$(sed -n 's/^CMAKE_CXX_COMPILER:[A-Z]*=//p' "$build/CMakeCache.txt")" >"$work/log" 2>&1 &&
    cmake --build "$work/build" >>"$work/log" 2>&1 || { cat "$work/log"; exit 1; }

output=$("$work/build/render_builtin")
echo "$output"
[[ $output =~ ^mean\ ([0-9.]+)\ ([0-9.]+)\ ([0-9.]+)\ of\ 64\ x\ 36\ pixels,\ ([1-9][0-9]*)\ triangles$ ]]
# A black picture would mean that nothing was rendered.
[[ ${BASH_REMATCH[1]}${BASH_REMATCH[2]}${BASH_REMATCH[3]} =~ [1-9] ]]
