#!/usr/bin/env bash
# --samples, refocus and retime as a user runs them; what the pictures show is tests/unit/stored_samples_test.cpp.
source "$(dirname "$0")/lib.bash"
small=(-r 96x54 -s 8 --fstop 0.5 --focus-distance 4)

each=(--shading sample --texture-filter pixel)  # as samples are shaded
succeeds render builtin:cubes -o one.exr "${small[@]}" "${each[@]}"
succeeds render builtin:cubes --samples a.5ds "${small[@]}" --stats stats.json
check "a sample takes 32 bytes" test "$(stat -c %s a.5ds)" -gt $((96 * 54 * 8 * 32)) -a "$(stat -c %s a.5ds)" -lt $((96 * 54 * 8 * 32 + 10000))
check "statistics name the file" json stats.json 'd["file"] == "a.5ds" and d["samples"] == 96 * 54 * 8'
succeeds render builtin:cubes --samples b.5ds "${small[@]}" -t 1
check "threads do not change a byte" cmp -s a.5ds b.5ds
succeeds refocus a.5ds -o again.exr
check "without a word" test ! -s err
succeeds compare one.exr again.exr --linear --json
check "as they were they are the picture" json out 'd["max"] < 2e-3'
succeeds refocus a.5ds -o near.exr --focus-distance 0.85
check "the border is spoken of" grep -q 'near.exr: [0-9]* pixels at the border lack' err
succeeds render builtin:cubes -o direct.exr -r 96x54 -s 8 --fstop 0.5 --focus-distance 0.85 "${each[@]}"
succeeds compare near.exr direct.exr --linear --json
mv out near.json
succeeds compare one.exr direct.exr --linear --json
check "refocused is closer to a direct render than not" python3 -c \
    'import json; assert json.load(open("near.json"))["rmse"] < 0.7 * json.load(open("out"))["rmse"]'
check "the header tells of both" bash -c 'grep -aq "\"developed\":{\"focus-distance\":0.85}" near.exr && grep -aq "\"spp\":8" near.exr'
succeeds refocus a.5ds -o small.png --fstop 2
succeeds retime a.5ds -o short.exr --shutter 0.1 --shutter-offset 0.1 --shutter-curve trapezoid:0.2,0.8
succeeds retime a.5ds -o rolling.exr --shutter 0.1 --rolling-shutter top --rolling-shutter-duration 0.3
check "other times are other pictures" bash -c '! cmp -s short.exr rolling.exr'
succeeds render builtin:cubes --samples 'f.#.5ds' -f 1-2 "${small[@]}" --resume
succeeds render builtin:cubes --samples 'f.#.5ds' -f 1-3 "${small[@]}" --resume --progress ndjson
check "sequences of samples resume" test "$(grep -c '"skip"' err)" = 2
refuses 2 'f.1.5ds: .*seed' render builtin:cubes --samples 'f.#.5ds' -f 1-3 "${small[@]}" --seed 1 --resume

refuses 2 'samples are of one frame' retime a.5ds -o 'r.####.exr' --shutter 0.1
refuses 2 '--fstop 0.4: the samples were rendered at 0.5' refocus a.5ds -o bad.exr --fstop 0.4
succeeds render builtin:cubes --samples t.5ds "${small[@]}" --tilt 5
refuses 2 'rendered with --focus-range, --max' refocus t.5ds -o bad.exr --focus-distance 2
refuses 2 '--focus-distance: 0 is not above 0' refocus a.5ds -o bad.exr --focus-distance 0
refuses 2 "--focus-distance: 'near' is not a number" refocus a.5ds -o bad.exr --focus-distance near
refuses 2 '--shutter: 0.6 frames' retime a.5ds -o bad.exr --shutter 0.6
refuses 2 '--shutter-curve: times rise' retime a.5ds -o bad.exr --shutter 0.2 --shutter-curve trapezoid:0.8,0.2
refuses 2 '--rolling-shutter-duration: nothing rolls' retime a.5ds -o bad.exr --rolling-shutter-duration 0.1
refuses 2 '--fstop: inf is not a finite number' refocus a.5ds -o bad.exr --fstop inf
refuses 2 'must end in .exr or .png' refocus a.5ds -o bad.tif
refuses 2 '--output is required' refocus a.5ds
refuses 2 'SAMPLES is required' retime -o bad.exr
refuses 4 'no/bad.exr: cannot write' refocus a.5ds -o no/bad.exr
refuses 3 'none.5ds: cannot read \(No such file' refocus none.5ds -o bad.exr
refuses 3 'one.exr: cannot read \(these are no samples' refocus one.exr -o bad.exr
refuses 2 '--samples a.exr: the name must end in .5ds' render builtin:cubes --samples a.exr "${small[@]}"
refuses 2 '--samples: instead of --output' render builtin:cubes --samples a.5ds -o a.exr "${small[@]}"
refuses 2 '--samples: samples have neither' render builtin:cubes --samples a.5ds "${small[@]}" --aov coc
refuses 2 '--samples a.5ds: 2 frames need' render builtin:cubes --samples a.5ds "${small[@]}" -f 1-2
size=$(stat -c %s a.5ds)
for length in 0 20 1000 $((size / 2)) $((size - 1)); do
    head -c "$length" a.5ds >bad.5ds
    refuses 3 'bad.5ds: cannot read' refocus bad.5ds -o bad.exr
done
for place in 30 $((size / 3)) $((size - 2)); do
    python3 -c 'import sys; d = bytearray(open("a.5ds", "rb").read()); d[int(sys.argv[1])] ^= 0x41; open("bad.5ds", "wb").write(d)' "$place"
    refuses 3 'bad.5ds: cannot read' refocus bad.5ds -o bad.exr
done
head -c "$size" /dev/urandom >bad.5ds
refuses 3 'bad.5ds: cannot read' refocus bad.5ds -o bad.exr
check "no picture was made of what is damaged" test ! -e bad.exr -a ! -e bad.exr.part
finish
