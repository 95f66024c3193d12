#!/usr/bin/env bash
# Sharp twins and data sets: what is in the folder, and that its parts agree with one another and with plain rendering.
support=$(cd "$(dirname "$0")/../support" && pwd)
source "$(dirname "$0")/lib.bash"
small=(-r 64x36 -s 4 --fstop 2)

succeeds render builtin:cubes -o plain.exr --frame 3 "${small[@]}"
succeeds render builtin:cubes -o a.exr --frame 3 "${small[@]}" --sharp
check "the twin is beside the picture" test -s a.sharp.exr
check "a twin does not change the picture" cmp -s a.exr plain.exr
succeeds render builtin:cubes -o still.exr --frame 3 "${small[@]}" --no-motion-blur --no-defocus

succeeds render builtin:cubes --dataset set -f 3-4 "${small[@]}"
for kind in blur sharp sharp-open sharp-close; do
    check "$kind has pictures of both kinds" test -s set/$kind/0003.exr -a -s set/$kind/0003.png -a -s set/$kind/0004.exr
done
check "no .part is left" test -z "$(find . -name '*.part' -print -quit)"
check "the parts of the data set agree" python3 - "$support" <<'PY'
import json, struct, sys
sys.path.insert(0, sys.argv[1])
import read_exr

def pixels(name, part=0):
    return read_exr.read(name)[part]["channels"]

blur, plain = pixels("set/blur/0003.exr"), pixels("plain.exr")
assert all(blur[c] == plain[c] for c in "RGBAZ")
still, twin = pixels("still.exr"), pixels("a.sharp.exr")
sharp = pixels("set/sharp/0003.exr")
assert all(sharp[c] == still[c] == twin[c] for c in "RGBAZ")
assert sharp["R"] != blur["R"]
opened, closed = pixels("set/sharp-open/0003.exr"), pixels("set/sharp-close/0003.exr")
assert opened["R"] != sharp["R"] != closed["R"] != opened["R"]
assert pixels("set/depth/0003.exr")["Z"] == blur["Z"]

npy = open("set/depth/0003.npy", "rb").read()
assert npy[:8] == b"\x93NUMPY\x01\x00"
(length,) = struct.unpack_from("<H", npy, 8)
assert (10 + length) % 64 == 0 and b"(36, 64)" in npy[10:10 + length]
assert list(struct.unpack_from("<%df" % (64 * 36), npy, 10 + length)) == list(blur["Z"])
flow = pixels("set/flow/0003.exr")
flo = open("set/flow/0003.flo", "rb").read()
assert struct.unpack_from("<fii", flo) == (202021.25, 64, 36)
assert list(struct.unpack_from("<%df" % (2 * 64 * 36), flo, 12))[0::2] == list(flow["forward.u"])
assert any(abs(u) > 0.1 for u in flow["forward.u"])

manifest, camera = json.load(open("set/manifest.json")), json.load(open("set/camera.json"))
assert manifest["frames"] == 2 == len(camera["frames"])
frame = camera["frames"][0]
assert frame["frame"] == 3 and isinstance(frame["frame"], int) and frame["intrinsics"]["cx"] == 32
assert frame["projection"] == "perspective"
assert abs(frame["exposure_s"] - 0.5 / 24) < 1e-12 or frame["exposure_s"] > 0
assert frame["knots"][0]["time_s"] == frame["shutter_open_s"] and frame["knots"][-1]["time_s"] == frame["shutter_close_s"]
assert all(knot["fx"] == frame["intrinsics"]["fx"] for knot in frame["knots"]), "nothing zooms"
assert frame["knots"][0]["world_to_camera_column_major"] != frame["knots"][-1]["world_to_camera_column_major"]
assert frame["rolling_shutter"] == "none" and frame["readout_lines"] == 0 == frame["readout_s"] and frame["exposure_lines"] is None
assert "blur/0004.png" in manifest["files"] and len(manifest["files"]["flow/0003.flo"]) == 32
PY

# Flow between the shutter's ends: there and back again; as a file of its own it is the sharp frames' `motion`.
succeeds render builtin:cubes --dataset ends --frame 3 -r 96x54 -s 4 --shutter 1 --rolling-shutter left --rolling-shutter-duration 0.5 --fstop 2
check "flow between the shutter's ends goes there and back; lines are counted" python3 - "$support" <<'PY'
import json, struct, sys
sys.path.insert(0, sys.argv[1])
import read_exr

flow = read_exr.read("ends/flow-shutter/0003.exr")[0]["channels"]
flo = open("ends/flow-shutter/0003.flo", "rb").read()
assert struct.unpack_from("<fii", flo) == (202021.25, 96, 54)
assert list(struct.unpack_from("<%df" % (2 * 96 * 54), flo, 12))[0::2] == list(flow["forward.u"])
opened, closed = (read_exr.read(f"ends/sharp-{end}/0003.exr")[0]["channels"]["Z"] for end in ("open", "close"))
there_and_back = longest = 0
for y in range(54):
    for x in range(96):
        u, v = flow["forward.u"][y * 96 + x], flow["forward.v"][y * 96 + x]
        to_x, to_y = int(x + 0.5 + u), int(y + 0.5 + v)
        if opened[y * 96 + x] > 1e30 or not (0 <= to_x < 96 and 0 <= to_y < 54):
            continue
        i = to_y * 96 + to_x
        off = abs(u + flow["backward.u"][i]) + abs(v + flow["backward.v"][i])
        there_and_back += off < 0.5
        longest = max(longest, abs(u) + abs(v))
assert longest > 2, longest
assert there_and_back > 0.7 * 96 * 54, there_and_back
frame = json.load(open("ends/camera.json"))["frames"][0]
assert frame["rolling_shutter"] == "left" and frame["readout_lines"] == 96
assert abs(frame["readout_s"] - 0.5 / 24) < 1e-9 and abs(frame["exposure_s"] - 1 / 24) < 1e-9
assert abs(frame["line_s"] * 96 - frame["readout_s"]) < 1e-12 and abs(frame["exposure_lines"] - 192) < 1e-6
PY

# A second run makes what is missing; the manifest covers both.
before=$(cksum set/blur/0003.exr)
rm set/frames/0004.json
succeeds render builtin:cubes --dataset set -f 3-5 "${small[@]}" --skip-existing
check "whole frames are left alone" test "$before" = "$(cksum set/blur/0003.exr)"
check "missing ones are made" json set/manifest.json 'd["frames"] == 3'

# Frames are listed by their number, also where it outgrows its four digits.
succeeds render builtin:cubes --dataset long -f 9999-10001 -r 8x8 -s 1
check "camera.json lists frames in order" json long/camera.json '[f["frame"] for f in d["frames"]] == [9999, 10000, 10001]'

# Shards into one folder: each reads its own frames alone, and the last one to end sums up.
part() { local i=$1; shift; run render builtin:cubes --dataset parts -f 1-6 "${small[@]}" --shard "$i/3" "$@"; }
succeeds render builtin:cubes --dataset whole -f 1-6 "${small[@]}"
part 1 --resume
check "a shard that is not the last one sums nothing up" test "$status" = 0 -a ! -e parts/manifest.json -a ! -e parts/camera.json
part 2 --resume
mv parts/frames/0001.json kept.json
echo '{}' >parts/frames/0001.json
part 3 --resume
check "it does not read another's frames before its own are done: $(cat err)" test -s parts/frames/0006.json
check "the last one reads all, and refuses what is none: $status" test "$status" = 2 -a ! -e parts/manifest.json
mv kept.json parts/frames/0001.json
part 2 --resume
check "whoever has nothing to do sums up what nobody has: $(cat err)" diff -r parts whole
touch -d 2001-01-01 parts/manifest.json
part 2 --resume
check "and leaves it alone when it is there" test "$(stat -c %Y parts/manifest.json)" -lt 1000000000
rm parts/frames/0004.json
part 3 --resume
check "nothing is summed up while a frame is missing" test "$(stat -c %Y parts/manifest.json)" -lt 1000000000
part 1 --resume
check "and then it is" test "$(stat -c %Y parts/manifest.json)" -gt 1000000000 -a "$(diff -r parts whole)" = ""
succeeds render builtin:cubes --dataset parts --frame 9 "${small[@]}" --seed 1
part 2 --resume
check "a frame of others is the first shard's to read: $(cat err)" test "$status" = 0
part 1 --resume
check "which refuses it" grep -q 'parts/frames/0009.json: .*seed is 1 there and 0 now' err
rm parts/frames/0002.json
part 2 --resume
check "nobody sums up frames of two settings" bash -c 'test "$1" = 2 -a ! -e parts/manifest.json && grep -q 0009.json err' - "$status"

refuses 2 '--dataset' render builtin:cubes --dataset set -o a.png "${small[@]}"
refuses 2 '--output' render builtin:cubes "${small[@]}"
refuses 2 '--aov' render builtin:cubes --dataset set --aov coc "${small[@]}"
touch file
refuses 4 '--dataset file' render builtin:cubes --dataset file "${small[@]}"
# An orthographic camera says so.
python3 - <<'PY'
import base64, json, struct
data = struct.pack("<9f", -1, -1, -3, 1, -1, -3, 0, 1, -3)
json.dump({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}], "nodes": [{"mesh": 0}, {"camera": 0}],
    "cameras": [{"type": "orthographic", "orthographic": {"xmag": 2, "ymag": 2, "znear": 0.1, "zfar": 10}}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [-1, -1, -3], "max": [1, 1, -3]}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}],
    "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}]},
    open("flat.gltf", "w"))
PY
succeeds render flat.gltf --dataset flat -r 32x32 -s 4
check "an orthographic camera: pixels a metre" python3 -c '
import json
frame = json.load(open("flat/camera.json"))["frames"][0]
assert frame["projection"] == "orthographic" and frame["intrinsics"]["fx"] == 8 and frame["focal_length_mm"] == 0, frame'

finish
