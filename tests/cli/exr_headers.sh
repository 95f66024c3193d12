#!/usr/bin/env bash
# What OpenEXR's own `exrheader` finds in each kind of EXR that is written: parts, channels, types.
source "$(dirname "$0")/lib.bash"
command -v exrheader >/dev/null || { echo "skipped: exrheader is not installed (packaging/apt-readers.txt)"; exit 77; }
small=(-r 64x36 -s 4 --fstop 2)

# list FILE: a line for each part, such as "coc: coc=f"; h is half, f float, u unsigned; the only part of a file has no name.
list() {
    exrheader "$1" >listing 2>err || { echo "exrheader fails: $(cat err)"; return; }
    python3 - <<'PY'
import re
parts = re.split(r"^ part \d+:$", open("listing").read(), flags=re.M)
for part in parts[1:] or parts:
    name = re.search(r'^name \(type string\): "(.*)"$', part, re.M)
    kinds = {"16-bit floating-point": "h", "32-bit floating-point": "f", "32-bit unsigned integer": "u"}
    channels = re.findall(r"^    (\S+), (.*), sampling 1 1$", part, re.M)
    assert '(type string): "scanlineimage"' in part and "zip, multi-scanline blocks" in part
    print((name[1] + ": " if name else "") + " ".join(f"{channel}={kinds[kind]}" for channel, kind in channels))
PY
}
# lists FILE LINES...
lists() {
    local file=$1
    shift
    check "$file: $(list "$file")" test "$(list "$file")" = "$(printf '%s\n' "$@")"
}

colour="A=h B=h G=h R=h Z=f"
succeeds render builtin:cubes -o plain.exr "${small[@]}" --sharp --crop 10,50,3,30
lists plain.exr "$colour"
lists plain.sharp.exr "$colour"
check "a crop is a data window in the display window" bash -c 'exrheader plain.exr | grep -q "dataWindow (type box2i): (10 3) - (49 29)" &&
    exrheader plain.exr | grep -q "displayWindow (type box2i): (0 0) - (63 35)"'

all=depth,normal,position,uv,motion,coc,time,object-id,material-id,cryptomatte,coverage,albedo,occlusion,ste,variance
layer() { for level in 00 01 02; do printf '%s=f ' "$1$level".{a,b,g,r}; done; }
crypto="$(layer CryptoMaterial)$(layer CryptoObject)"
parts=("rgba: $colour" "depth: depth.mean=f" "normal: N.X=f N.Y=f N.Z=f" "position: P.X=f P.Y=f P.Z=f" "uv: uv.u=f uv.v=f"
    "motion: backward.u=f backward.v=f forward.u=f forward.v=f" "coc: coc=f" "time: time.blend=f time.first=f time.last=f"
    "object-id: id.object=u" "material-id: id.material=u" "cryptomatte: ${crypto% }" "coverage: coverage=f"
    "albedo: Albedo.B=f Albedo.G=f Albedo.R=f"
    "occlusion: backward.hidden=f backward.outside=f forward.hidden=f forward.outside=f" "ste: ste=f ste.tested=f"
    "variance: variance.B=f variance.G=f variance.R=f")
succeeds render builtin:cubes -o all.exr "${small[@]}" --culling hull --aov $all
lists all.exr "${parts[@]}"
for i in 1 2; do succeeds render builtin:cubes -o half.exr "${small[@]}" --culling hull --aov $all --shard $i/2; done
succeeds merge half.exr.*-of-2.shard -o merged.exr
lists merged.exr "${parts[@]}"

succeeds render builtin:cubes --samples a.5ds "${small[@]}"
succeeds refocus a.5ds -o near.exr --focus-distance 0.7
lists near.exr "$colour"

succeeds render builtin:cubes --dataset set --frame 1 "${small[@]}"
for kind in blur sharp sharp-open sharp-close; do lists set/$kind/0001.exr "$colour"; done
for kind in flow flow-shutter; do lists set/$kind/0001.exr "backward.u=f backward.v=f forward.u=f forward.v=f"; done
lists set/depth/0001.exr "Z=f coverage=f depth.mean=f"
lists set/coc/0001.exr "coc=f"
lists set/ids/0001.exr "id.material=u id.object=u"
check "no kind of a data set's EXR is left out" test "$(find set -name '*.exr' | wc -l)" = 9
finish
