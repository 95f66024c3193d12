#!/usr/bin/env bash
# `compare` prints the keys that scripts rely on, fails when asked to, and writes what differs.
source "$(dirname "$0")/lib.bash"

succeeds render builtin:cubes -r 64x36 -s 4 -q -o a.exr
succeeds render builtin:cubes -r 64x36 -s 4 -q -o b.png --exposure 1
succeeds render builtin:cubes -r 32x36 -s 1 -q -o small.exr
succeeds compare a.exr a.exr --json --fail-above 0
check "equal pictures: all keys" json out 'd["rmse"] == 0 and d["psnr"] is None and abs(d["ssim"] - 1) < 1e-9 and d["flip"] == 0 and d["max"] == 0'
succeeds compare a.exr b.png --json -o difference.png
check "different pictures" json out '0.01 < d["rmse"] < 1 and 0 < d["psnr"] < 40 and d["ssim"] < 1 and 0 < d["flip"] < 1 and d["max"] > d["rmse"]'
check "the difference picture is there" test -s difference.png
succeeds compare a.exr b.png --linear
check "the table tells of PSNR" grep -qE '^  psnr +[0-9.]+ dB' out
run compare a.exr b.png --fail-above 0.001
checks=$((checks + 1))
[[ $status == 1 ]] || fail "--fail-above: exit code $status"
check "it says by how much" grep -qE '^pentaprism: error: .*rmse is 0\.[0-9]+, at most 0.001 is allowed' err
refuses 2 "differ in size: 64x36 and 32x36" compare a.exr small.exr
refuses 3 "nothing.exr" compare a.exr nothing.exr
refuses 2 "the name must end in" compare a.exr a.exr -o difference.txt
for wrong in much nan -1; do refuses 2 "--fail-above" compare a.exr a.exr --fail-above $wrong; done
refuses 2 "B" compare a.exr
refuses 4 "no/folder" compare a.exr b.png -o no/folder.png
finish
