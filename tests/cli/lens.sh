#!/usr/bin/env bash
# Lenses and sample patterns: each option changes the picture, and nothing of the machine does.
source "$(dirname "$0")/lib.bash"

export PENTAPRISM
small=(builtin:cubes -r 96x54 -s 4 --fstop 0.5 --frame 5 -q)
differ() { # by how much in linear values, or not at all
    python3 - "$1" "$2" "$3" <<'END'
import json, subprocess, sys, os
out = subprocess.run([os.environ["PENTAPRISM"], "compare", sys.argv[1], sys.argv[2], "--linear", "--json"], capture_output=True)
rmse = json.loads(out.stdout)["rmse"]
sys.exit(0 if (rmse > float(sys.argv[3]) if float(sys.argv[3]) > 0 else json.loads(out.stdout)["max"] == 0) else 1)
END
}
succeeds render builtin:hand -o aperture.png -r 32x32 -s 4 -q
succeeds render "${small[@]}" -o plain.exr
for options in '--focus-range 0.6,1.5' '--max-foreground-blur 0.5' '--tilt 60' '--swing -60' '--aperture-image aperture.png' '--cats-eye 1.3' \
    '--sampler sobol' '--sampler blue-noise' '--sampler independent'; do
    succeeds render "${small[@]}" -o one.exr -t 1 $options
    succeeds render "${small[@]}" -o two.exr -t 2 $options
    check "$options: threads do not change a bit" differ one.exr two.exr 0
    PENTAPRISM_ISA=scalar run render "${small[@]}" -o scalar.exr $options
    checks=$((checks + 1))
    [[ $status == 0 ]] || fail "$options, scalar: exit code $status"
    check "$options: the processor does not change a bit" differ one.exr scalar.exr 0
    check "$options: it is seen" differ one.exr plain.exr 0.003
done

# A scene says the same things in its extras, and the command line counts more.
succeeds scene cubes -o cubes.glb
python3 - <<'END'
import json, struct
data = open("cubes.glb", "rb").read()
length = struct.unpack("<I", data[12:16])[0]
scene = json.loads(data[20:20 + length])
scene["cameras"][0]["extras"].update({"focusRange": [0.6, 1.5], "catsEye": 0.7})
text = json.dumps(scene).encode()
text += b" " * (-len(text) % 4)
rest = data[20 + length:]
open("lens.glb", "wb").write(data[:8] + struct.pack("<III", 20 + len(text) + len(rest), len(text), 0x4E4F534A) + text + rest)
END
from_file=(lens.glb -r 96x54 -s 4 --fstop 0.5 --frame 5 -q --focus-distance 1)
succeeds render "${from_file[@]}" -o extras.exr
succeeds render "${from_file[@]/lens.glb/cubes.glb}" -o options.exr --focus-range 0.6,1.5 --cats-eye 0.7
check 'extras and options are one' differ extras.exr options.exr 0
succeeds info lens.glb --json
check 'info tells of them' json out 'd["cameras"][0]["lens"]["focus_range"] == [0.6, 1.5] and d["cameras"][0]["lens"]["cats_eye"] == 0.7'
succeeds info lens.glb
check 'also in words' grep -q 'focus_range 0.6 to 1.5' out
refuses 2 '--focus-range 0.6,1.5: the focus lies outside, at 9 m' render lens.glb -o no.exr -r 32x18 --focus-distance 9
refuses 2 'cat.s eye.*give --cats-eye 0' render lens.glb -o no.exr -r 32x18 --focus-distance 1 --visibility accumulation
refuses 2 '--focus-range: rays are straight' render builtin:cubes -o no.exr --focus-range 1,2 --visibility raytrace
refuses 2 '--max-foreground-blur: rays are straight' render builtin:cubes -o no.exr --max-foreground-blur 2 --visibility raytrace
refuses 2 '--focus-range: a plane of focus that leans' render builtin:cubes -o no.exr -r 32x18 --focus-range 1,2 --tilt 30
refuses 2 '--cats-eye: a plane of focus that leans' render builtin:cubes -o no.exr -r 32x18 --cats-eye 1 --swing 30
refuses 2 'the plane of focus cuts the lens' render builtin:cubes -o no.exr -r 32x18 --lens-radius 1 --tilt 80
refuses 2 '--cats-eye: with --visibility interleaved' render builtin:cubes -o no.exr --cats-eye 1 --visibility interleaved
refuses 2 '--sampler: with --visibility accumulation' render builtin:cubes -o no.exr --sampler sobol --visibility accumulation
refuses 2 '--aperture-image and --aperture-blades exclude each other' render builtin:cubes -o no.exr --aperture-image aperture.png --aperture-blades 5
check 'no file was made' test ! -e no.exr

succeeds verify builtin:cubes -r 96x54 -s 4 --fstop 0.5 --frame 5 --tilt 50 -q --json
check 'verify agrees about a plane that leans' json out 'd["away_from_edge"] == 0'
succeeds verify builtin:cubes -r 96x54 -s 4 --fstop 0.5 --frame 5 --focus-range 0.6,1.5 --max-foreground-blur 1 -q --json
check 'verify takes brute force where rays are not straight' json out 'd["away_from_edge"] == 0 and d["reference"] == "brute force"'
finish
