#!/usr/bin/env bash
# What a frame of 1280x720 needs beside its scene, however many samples a pixel gets: bench/resources.py measures whole
# frames, which take minutes at 4096 samples. Here a part of one, which needs the same table of samples and the same
# rooms of two threads; of the rest of the 300 MB a whole frame's film and shadow maps have their share. Shadow maps are
# held by a frame of many lights, which is 300 MB with its scene.
source "$(dirname "$0")/lib.bash"

if grep -qsE '^PENTAPRISM_SANITIZE:[A-Z]+=.' "$(dirname "$PENTAPRISM")/CMakeCache.txt"; then
    echo "skipped: sanitizers need memory of their own"
    exit 77
fi

size=(-r 1280x720 -q)
succeeds render builtin:hand "${size[@]}" -s 1 --crop 640,641,360,361 --shadows off -t 1 -o one.exr --stats scene.json
for spp in 256 4096; do
    succeeds render builtin:hand "${size[@]}" -s $spp --crop 608,672,344,360 -t 2 -o part.exr --stats part.json
    check "$spp samples: below 180 MB beside the scene" python3 -c '
import json, sys
scene, part = (json.load(open(name))["peak_mb"] for name in ("scene.json", "part.json"))
print(f"{sys.argv[1]} samples: {part - scene:.0f} MB beside the scene")
assert 0 < part - scene < 180' $spp
done
succeeds render builtin:fairy-forest "${size[@]}" -s 4 --frame 24 -t 2 -o lights.exr --stats lights.json
check "21 shadow maps: below 300 MB in all" python3 -c '
import json
peak = json.load(open("lights.json"))["peak_mb"]
print(f"21 shadow maps: {peak:.0f} MB in all")
assert 0 < peak < 300'
succeeds render builtin:hand -r 3840x2160 -q -s 1 --shadows off -t 2 -o large.exr --stats large.json
check "3840x2160: the film of a few rows of tiles, below 150 MB in all" python3 -c '
import json
peak = json.load(open("large.json"))["peak_mb"]
print(f"3840x2160: {peak:.0f} MB in all")
assert 0 < peak < 150'
finish
