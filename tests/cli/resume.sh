#!/usr/bin/env bash
# --resume: goes on where a run was killed, at whatever moment, and refuses what was made with other settings.
source "$(dirname "$0")/lib.bash"
small=(-r 96x54 -s 8 --fstop 2)

# Killed again and again until nothing is left to do: a run loses the frame under way and nothing else.
# kill_until_done FOLDER ARGUMENTS...
kill_until_done() {
    local folder=$1 round process files before=0
    shift
    for round in $(seq 200); do
        "$PENTAPRISM" render builtin:cubes "$@" --resume -q &
        process=$!
        sleep "$(printf '%d.%03d' $((round / 20)) $((50 + RANDOM % (50 * (round % 20 + 1) - 49))))"  # longer and longer
        if ! kill -9 "$process" 2>/dev/null; then
            wait "$process" || fail "round $round: exit code $?"
            break
        fi
        wait "$process" 2>/dev/null
        files=$(find "$folder" -type f ! -name '*.part' | wc -l)
        [[ $files -ge $before ]] || fail "round $round: $files files where $before were"
        before=$files
        find "$folder" -type f ! -name '*.part' ! -name '*.json' -printf '%P\n' | while read -r file; do
            cmp -s "$folder/$file" "whole-$folder/$file" || echo "$file"
        done >corrupt
        [[ ! -s corrupt ]] || fail "round $round: corrupt: $(tr '\n' ' ' <corrupt)"
    done
    check "$folder: it ends ($round rounds)" test "$round" -lt 200
    check "$folder: it was killed at all" test "$round" -gt 1
    check "$folder: it equals one run, and no .part is left" diff -r "$folder" "whole-$folder"
}
mkdir shots whole-shots
succeeds render builtin:cubes -o 'whole-shots/f.##.exr' -f 1-12 "${small[@]}" --sharp --aov coc
kill_until_done shots -o 'shots/f.##.exr' -f 1-12 "${small[@]}" --sharp --aov coc
succeeds render builtin:cubes --dataset whole-set -f 1-3 "${small[@]}"
mkdir set
kill_until_done set --dataset set -f 1-3 "${small[@]}"

# What is there is left alone; what is not is made; the twin counts.
touch -d '2001-01-01' shots/f.0[12].exr
rm shots/f.02.sharp.exr shots/f.03.exr
succeeds render builtin:cubes -o 'shots/f.##.exr' -f 1-4 "${small[@]}" --sharp --aov coc --resume --progress ndjson
check "two frames are skipped before the others are begun" test \
    "$(python3 -c 'import json; print([(e["event"], e["frame"]) for e in map(json.loads, open("err")) if e["event"] != "progress"])')" \
    = "[('skip', 1), ('skip', 4), ('frame', 2), ('frame', 3)]"
check "whole frames are not touched" test "$(stat -c %Y shots/f.01.exr)" -lt 1000000000
check "the result is that of one run" diff -r shots whole-shots

# Other settings are refused before anything is rendered, with the first that differs.
list=(render builtin:cubes -o 'shots/f.##.exr' -f 20,1)
refuses 2 'resume: shots/f.01.exr: .*settings: spp is 8 there and 4 now' "${list[@]}" -r 96x54 -s 4 --fstop 2 --sharp --aov coc --resume
refuses 2 'fstop is 2.0 there and not set now' "${list[@]}" -r 96x54 -s 8 --sharp --aov coc --resume
refuses 2 'aovs' "${list[@]}" "${small[@]}" --resume
refuses 2 'scene is .*cubes.* now' render builtin:hand -o 'shots/f.##.exr' -f 20,1 "${small[@]}" --sharp --aov coc --resume
check "nothing was rendered" test ! -e shots/f.20.exr
refuses 2 'set/frames/0002.json.*seed is 0 there and 1 now' render builtin:cubes --dataset set -f 2-3 "${small[@]}" --seed 1 --resume
refuses 2 'set/frames/0001.json.*seed is 0 there and 1 now' render builtin:cubes --dataset set -f 8-9 "${small[@]}" --seed 1 --resume
succeeds render builtin:cubes -o a.png "${small[@]}"
succeeds render builtin:cubes -o a.png "${small[@]}" --resume
refuses 2 'a.png: .*seed' render builtin:cubes -o a.png "${small[@]}" --seed 2 --resume
check "settings that change no pixel are none" "$PENTAPRISM" render builtin:cubes -o a.png "${small[@]}" -t 1 --resume -q

# Pictures that decide pixels count by what is in them, not by their names alone.
mkdir day night
succeeds render builtin:cubes -o day/sky.exr -r 32x16 -s 1
succeeds render builtin:cubes -o night/sky.exr -r 32x16 -s 1 --exposure -4
cp day/sky.exr day/LOUD.EXR
succeeds render builtin:cubes -o lit.png "${small[@]}" --background day/sky.exr
succeeds render builtin:cubes -o loud.PNG "${small[@]}" --background day/LOUD.EXR
succeeds compare lit.png loud.PNG --json
check "suffixes may be upper case" json out 'd["max"] == 0'
rm lit.png loud.PNG
for option in --background --aperture-image; do
    key=environment
    [[ $option == --background ]] || key=aperture_image
    succeeds render builtin:cubes -o lit.png "${small[@]}" "$option" day/sky.exr
    check "$option: the same picture elsewhere" "$PENTAPRISM" render builtin:cubes -o lit.png "${small[@]}" "$option" ./day/sky.exr --resume -q
    refuses 2 "lit.png: .*${key}_hash is .* there and .* now" render builtin:cubes -o lit.png "${small[@]}" "$option" night/sky.exr --resume
done
succeeds render builtin:cubes -o lit.exr "${small[@]}" --background day/sky.exr --shard 1/2
succeeds render builtin:cubes -o lit.exr "${small[@]}" --background night/sky.exr --shard 2/2
refuses 2 'no parts of one picture' merge lit.exr.1-of-2.shard lit.exr.2-of-2.shard -o lit.exr

# A disk that fills up in the middle: a clear error, whole frames alone, and with more room the rest.
mkdir disk
if mount -t tmpfs -o size=64k tmpfs disk 2>/dev/null; then
    trap 'umount "$work/disk"; rm -rf "$work"' EXIT
    refuses 4 'disk/f..*.exr: cannot write \(No space left on device\)' render builtin:cubes -o 'disk/f.##.exr' -f 1-12 "${small[@]}" \
        --sharp --aov coc --resume -q
    check "some frames are there, none is half-written" test -s disk/f.01.exr -a -z "$(find disk -name '*.part')"
    for file in disk/*; do check "$file is whole" cmp -s "$file" "whole-shots/${file#disk/}"; done
    mount -o remount,size=16m disk
    succeeds render builtin:cubes -o 'disk/f.##.exr' -f 1-12 "${small[@]}" --sharp --aov coc --resume -q
    check "with room it goes on to the end" diff -r disk whole-shots
else
    echo "not tested: a disk that fills up (mounting is not allowed)"
fi

# Two processes at the same file: the second one is told, and the first one's work is not spoiled.
"$PENTAPRISM" render builtin:cubes -o long.exr -r 4096x4096 -s 64 -q &
process=$!
for _ in $(seq 200); do
    [[ -e long.exr.part ]] && break
    sleep 0.05
done
refuses 4 'long.exr: cannot write \(another process is writing it\)' render builtin:cubes -o long.exr "${small[@]}" -q
check "the .part of the first stays" test -e long.exr.part
kill -9 "$process"
wait "$process" 2>/dev/null
succeeds render builtin:cubes -o long.exr "${small[@]}" -q
check "when it is dead its .part is taken over" test -s long.exr -a ! -e long.exr.part

# Files that are not ours, or broken.
echo text >b.png
refuses 2 'b.png: it is there and cannot be read' render builtin:cubes -o b.png "${small[@]}" --resume
head -c 100 shots/f.01.exr >b.exr
refuses 2 'b.exr: it is there and cannot be read' render builtin:cubes -o b.exr "${small[@]}" --resume
: >c.exr
refuses 2 'c.exr: it is there and cannot be read' render builtin:cubes -o c.exr "${small[@]}" --resume
python3 - <<'PY'
import struct, zlib
def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
start = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 1, 1, 8, 0, 0, 0, 0))
end = chunk(b"IDAT", zlib.compress(b"\0\0")) + chunk(b"IEND", b"")
open("foreign.png", "wb").write(start + end)
open("odd.png", "wb").write(start + chunk(b"tEXt", b"pentaprism\0[1, 2") + end)
PY
refuses 2 'foreign.png: it does not say how it was made' render builtin:cubes -o foreign.png "${small[@]}" --resume
refuses 2 'odd.png: it does not say how it was made' render builtin:cubes -o odd.png "${small[@]}" --resume
for other in --overwrite --skip-existing; do
    refuses 2 "--resume excludes $other|$other excludes --resume" render builtin:cubes -o a.png --resume $other
done
finish
