#!/usr/bin/env bash
# `verify` agrees with its reference on the small scene and prints the keys that scripts rely on.
source "$(dirname "$0")/lib.bash"

run verify builtin:cubes -r 320x180 -s 4 --fstop 2 --json -q
if [[ $status == 5 ]]; then
    echo "skipped: $(cat err)"
    exit 77
fi
checks=$((checks + 1))
[[ $status == 0 ]] || fail "verify: exit code $status: $(cat err)"
check "all keys are there" json out 'all(k in d for k in "scene width height spp samples reference disagreements per_million ours_wrong away_from_edge worst_margin worst_depth_error".split())'
check "every sample was looked at" json out 'd["samples"] == 320 * 180 * 4 and d["width"] == 320 and d["spp"] == 4'
check "nothing is wrong" json out 'd["ours_wrong"] == 0 and d["away_from_edge"] == 0'
succeeds verify builtin:cubes -r 320x180 -s 1 --frame 24 --no-motion-blur
check "the table tells of samples" grep -qE '^  samples +57600$' out
run verify builtin:cubes -r 64x36 -s 1 --time 1 --json -q
if [[ $status == 0 ]]; then
    check "peers are timed" json out '{"build_ms", "trace_ms", "ours_ms", "ratio"} <= set(d["peers"][0])'
elif [[ $status != 5 ]]; then
    fail "verify --time: exit code $status: $(cat err)"
fi
finish
