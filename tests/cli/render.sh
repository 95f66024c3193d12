#!/usr/bin/env bash
# Rendering as a user does it: names of files, sequences, statistics, messages, and the same bytes whatever the order or threads.
source "$(dirname "$0")/lib.bash"
small=(-r 64x36 -s 1)

succeeds render builtin:cubes -o a.exr "${small[@]}"
check "an .exr has its magic number" test "$(head -c 4 a.exr | od -An -tx1 | tr -d ' ')" = 762f3101
check "stdout stays empty" test ! -s out
succeeds render "${small[@]}" --output=b.exr builtin:cubes
check "argument order never matters" cmp -s a.exr b.exr
succeeds render builtin:cubes -o c.exr "${small[@]}" -t 1
check "one thread gives the same bytes" cmp -s a.exr c.exr
PENTAPRISM_THREADS=2 succeeds render builtin:cubes -o d.exr "${small[@]}"
check "two threads give the same bytes" cmp -s a.exr d.exr
succeeds render builtin:cubes -o e.exr "${small[@]}" --seed 1
check "another seed gives other bytes" test "$(cksum <a.exr)" != "$(cksum <e.exr)"
succeeds render builtin:cubes -o A.PNG "${small[@]}"
check "a .png has its magic number" test "$(head -c 4 A.PNG | od -An -tx1 | tr -d ' ')" = 89504e47
check "no path stands in a file" bash -c '! grep -aqF "$1" a.exr A.PNG' - "$work"
check "the settings stand in the header" grep -aq '"scene":"builtin:cubes"' a.exr

# Sequences.
mkdir shots
succeeds render builtin:cubes -o 'shots/f.####.png' -f 1-2,10-30x10 "${small[@]}" --fps 25
check "frames are named by their padded number" \
    test "$(ls shots | tr '\n' ' ')" = "f.0001.png f.0002.png f.0010.png f.0020.png f.0030.png "
succeeds render builtin:cubes -o 'one.##.png' --frame 7 "${small[@]}"
check "a single frame has its number" test -s one.07.png
touch -d '2001-01-01' shots/f.0001.png
rm shots/f.0002.png
succeeds render builtin:cubes -o 'shots/f.####.png' -f 1-2 "${small[@]}" --skip-existing
check "--skip-existing leaves what is there" test "$(stat -c %Y shots/f.0001.png)" -lt 1000000000
check "--skip-existing makes what is not" test -s shots/f.0002.png
succeeds render builtin:cubes -o 'shots/f.####.png' -f 1 "${small[@]}"
check "the default writes over" test "$(stat -c %Y shots/f.0001.png)" -gt 1000000000

# Statistics.
succeeds render builtin:cubes -o a.png "${small[@]}" --stats stats.json
check "one frame: one object" json stats.json \
    'all(k in d for k in "times_ms cpu_ms triangles samples tested covered ste shaded peak_mb threads isa".split())'
check "samples are pixels times spp" json stats.json 'd["samples"] == 64 * 36 and d["triangles"] == 50'
check "covered samples are among the tested" json stats.json '0 < d["covered"] <= d["tested"] and 0 < d["ste"] <= 1'
succeeds render builtin:cubes -o 'f.#.png' -f 0-2 "${small[@]}" --stats all.json
check "several frames: an array" json all.json '[s["frame"] for s in d] == [0, 1, 2]'
succeeds render builtin:cubes -o 'f.#.png' -f 0-1 "${small[@]}" --stats 's.#.json'
check "#### in FILE: one document for each" json s.1.json 'd["frame"] == 1'

# Messages.
succeeds render builtin:cubes -o a.png "${small[@]}" -q
check "--quiet says nothing" test ! -s err
succeeds render builtin:cubes -o a.png "${small[@]}" --progress none
check "--progress none says nothing" test ! -s err
succeeds render builtin:cubes -o 'f.#.png' -f 0-1 "${small[@]}" --progress plain
check "plain: a line for each frame" test "$(grep -c '^frame ' err)" = 2
succeeds render builtin:cubes -o 'f.#.png' -f 0-1 "${small[@]}" --progress ndjson
check "ndjson: every line is a document" python3 -c \
    'import json; e = [json.loads(l) for l in open("err")]; assert [x["frame"] for x in e if x["event"] == "frame"] == [0, 1]'
succeeds render builtin:cubes -o a.png "${small[@]}" --log-level debug
check "debug tells of stages" grep -q '^pentaprism: debug: frame 0: write ' err

# Every kind of option once, together.
succeeds render builtin:cubes -o all.exr "${small[@]}" --filter tent --crop 8,40,4,30 --exposure -1 --background 0.1,0.2,0.3 \
    --sensor-width 36 --focal-length 50 --fstop 2 --focus-distance 5 --aperture-blades 6 --aperture-rotation 15 \
    --aperture-ratio 0.8 --shutter 1 --shutter-position start --motion-segments 2 --fps 30 --animation all --culling auto \
    --visibility stochastic --backend cpu --shading pixel --seed 3 --shutter-curve box --rolling-shutter none --aperture-roundness 0.5
succeeds render builtin:cubes -o none.exr "${small[@]}" --no-defocus --no-motion-blur
refuses 2 'animation' render builtin:cubes -o a.png "${small[@]}" --animation nosuchclip
refuses 2 'camera' render builtin:cubes -o a.png "${small[@]}" --camera nosuchcamera
check "no .part is left" test -z "$(find . -name '*.part' -print -quit)"
finish
