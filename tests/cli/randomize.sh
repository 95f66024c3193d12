#!/usr/bin/env bash
# --randomize: each frame has settings of its own, its files say which, and rendering with those by hand gives the same bytes.
support=$(cd "$(dirname "$0")/../support" && pwd)
source "$(dirname "$0")/lib.bash"
small=(-r 64x36 -s 2)
echo '{"seed": 3, "fstop": [1.4, 8], "focus_distance": [2, 10], "shutter": [0.2, 1], "exposure": [-1, 1]}' >lens.json
echo '{"seed": 3, "fstop": [1.4, 8], "camera_shift": 0.2, "camera_turn": 3}' >camera.json

mkdir all some
succeeds render builtin:cubes -o 'all/f.#.exr' -f 1-4 "${small[@]}" --randomize lens.json
for i in 2 1; do succeeds render builtin:cubes -o 'some/f.#.exr' -f 1-4 "${small[@]}" --randomize lens.json --shard $i/2; done
check "what a frame gets does not depend on the others" diff -r all some
check "frames differ in their lens, and by hand it is the same picture" python3 - "$support" "$PENTAPRISM" <<'PY'
import json, subprocess, sys
sys.path.insert(0, sys.argv[1])
import read_exr
settings = {}
for frame in range(1, 5):
    (part,) = read_exr.read(f"all/f.{frame}.exr")
    s = settings[frame] = json.loads(part["attributes"]["pentaprism"])
    assert 1.4 <= s["fstop"] <= 8 and 2 <= s["focus_distance"] <= 10 and 0.2 <= s["shutter"] <= 1 and -1 <= s["exposure"] <= 1
assert len({s["fstop"] for s in settings.values()}) == 4
s = settings[3]
subprocess.run([sys.argv[2], "render", "builtin:cubes", "-o", "hand.exr", "-r", "64x36", "-s", "2", "--frame", "3", "-q",
                f"--fstop={s['fstop']!r}", f"--focus-distance={s['focus_distance']!r}", f"--shutter={s['shutter']!r}",
                f"--exposure={s['exposure']!r}"], check=True)
assert open("hand.exr", "rb").read() == open("all/f.3.exr", "rb").read()
PY

succeeds render builtin:cubes --dataset set -f 1-2 "${small[@]}" --randomize camera.json
check "the data set records ranges, settings and poses" python3 - <<'PY'
import json
manifest, camera = json.load(open("set/manifest.json")), json.load(open("set/camera.json"))
assert manifest["randomize"] == {"seed": 3, "fstop": [1.4, 8.0], "camera_shift": 0.2, "camera_turn": 3.0}
one, two = camera["frames"]
a, b = one["settings"]["camera_offset"], two["settings"]["camera_offset"]
assert a != b and two["settings"]["camera_offset_before"] == a and one["settings"]["camera_offset_after"] == b
assert all(abs(x) <= 0.2 for x in a["shift_m"]) and all(abs(x) <= 3 for x in a["turn_deg"])
assert one["fstop"] == one["settings"]["fstop"] != two["fstop"]
PY
succeeds render builtin:cubes --dataset set -f 1-3 "${small[@]}" --randomize camera.json --resume --progress ndjson
check "a frame's own settings are no others" test "$(grep -c '"skip"' err)" = 2
sed -i 's/3,/4,/' camera.json
refuses 2 'set/frames/0001.json: .*other settings: fstop is' render builtin:cubes --dataset set -f 1-3 "${small[@]}" \
    --randomize camera.json --resume
succeeds render builtin:cubes -o plain.exr "${small[@]}" --sharp --randomize camera.json
check "the sharp twin stands where the blurred picture does" python3 - "$support" <<'PY'
import sys
sys.path.insert(0, sys.argv[1])
import read_exr
a, b = (read_exr.read(f"plain{x}.exr")[0]["attributes"] for x in ("", ".sharp"))
assert a["worldToCamera"] == b["worldToCamera"]
PY

refuses 2 '--randomize none.json: cannot be read' render builtin:cubes -o a.exr "${small[@]}" --randomize none.json
refuses 2 '--randomize .: cannot be read' render builtin:cubes -o a.exr "${small[@]}" --randomize .
refuses 2 '--randomize: fstop has a range, and --fstop is given' render builtin:cubes -o a.exr "${small[@]}" --fstop 2 --randomize lens.json
refuses 2 '--randomize: shutter has a range, and --shutter-position' render builtin:cubes -o a.exr "${small[@]}" \
    --shutter-position start --randomize lens.json
echo '{"iso": [100, 200]}' >odd.json
refuses 2 "--randomize odd.json: 'iso' is not one of seed, fstop" render builtin:cubes -o a.exr "${small[@]}" --randomize odd.json
echo '{"shutter": [-1, 1]}' >odd.json
refuses 2 '--randomize: the ends of a range: --shutter' render builtin:cubes -o a.exr "${small[@]}" --randomize odd.json
check "no file was made" test ! -e a.exr
finish
