#!/usr/bin/env bash
# --shard and merge: the parts of a frame, in any split and order and from any machine, are the bytes of one run.
source "$(dirname "$0")/lib.bash"
small=(-r 200x120 -s 4 --fstop 2 --frame 3)

# split N OUT ARGUMENTS...: all shards of OUT.
split() {
    local n=$1 out=$2 i
    shift 2
    for i in $(seq "$n"); do succeeds render builtin:cubes -o "$out" "$@" --shard "$i/$n"; done
}
# is_one_run TEXT N SUFFIX ARGUMENTS...: N shards, joined in a shuffled order, against one run.
is_one_run() {
    local text=$1 n=$2 suffix=$3
    shift 3
    rm -f one* part*
    succeeds render builtin:cubes -o "one$suffix" "$@"
    split "$n" "part$suffix" "$@"
    succeeds merge $(printf '%s\n' part"$suffix".*-of-"$n".shard | shuf) -o "joined$suffix"
    check "$text: equal to one run" cmp -s "joined$suffix" "one$suffix"
    check "$text: a shard has no picture's name" test ! -e "part$suffix"
}
all=depth,normal,position,uv,motion,coc,time,object-id,material-id,cryptomatte,coverage,variance
is_one_run "the whole as one shard" 1 .exr "${small[@]}"
is_one_run "two shards with output variables" 2 .exr "${small[@]}" --aov $all
is_one_run "three shards, a picture for eyes" 3 .png "${small[@]}" --tonemap filmic --exposure 1
is_one_run "more shards than tiles" 30 .exr "${small[@]}" --filter tent
is_one_run "a crop, a filter without reach" 3 .exr "${small[@]}" --crop 37,190,3,101 --filter box --aov coc
is_one_run "samples shared by the picture, a rolling background" 4 .exr "${small[@]}" --visibility interleaved --background sky
is_one_run "cells of the blur" 5 .exr "${small[@]}" --shading decoupled --filter gaussian
is_one_run "a rolling shutter" 2 .exr "${small[@]}" --rolling-shutter top

# From different machines.
succeeds render builtin:cubes -o one.exr "${small[@]}" --aov coc
succeeds render builtin:cubes -o part.exr "${small[@]}" --aov coc --shard 1/3 -t 1
PENTAPRISM_ISA=scalar succeeds render builtin:cubes -o part.exr "${small[@]}" --aov coc --shard 2/3 -t 2
succeeds render builtin:cubes -o part.exr "${small[@]}" --aov coc --shard 3/3 --culling hull --stats stats.json
cp part.exr.1-of-3.shard again.shard
succeeds render builtin:cubes -o part.exr "${small[@]}" --aov coc --shard 1/3 -t 2
check "threads do not change a shard" cmp -s part.exr.1-of-3.shard again.shard
succeeds merge part.exr.*-of-3.shard -o joined.exr
check "threads, CPU target and culling do not matter" cmp -s joined.exr one.exr
check "statistics are those of the shard" json stats.json '0 < d["samples"] < 200 * 120 * 4 / 2'
succeeds merge part.exr.*-of-3.shard -o joined.exr
check "merging again writes over" cmp -s joined.exr one.exr

# A sequence is dealt out by frames, to pictures.
mkdir whole dealt
succeeds render builtin:cubes -o 'whole/f.#.png' -f 1-5 -r 64x36 -s 1
for i in 3 1 2; do succeeds render builtin:cubes -o 'dealt/f.#.png' -f 1-5 -r 64x36 -s 1 --shard $i/3; done
check "the frames of all shards are those of one run" diff -r whole dealt
succeeds render builtin:cubes --dataset set -f 1-6 -r 64x36 -s 2
for i in 1 2 3; do
    "$PENTAPRISM" render builtin:cubes --dataset shared -f 1-6 -r 64x36 -s 2 --shard $i/3 -q &
done
wait
check "shards of a data set, at the same time, into one folder" diff -r set shared

# Resuming.
touch -d '2001-01-01' part.exr.1-of-3.shard
succeeds render builtin:cubes -o part.exr "${small[@]}" --aov coc --shard 1/3 --resume
check "a shard that is there is left alone" test "$(stat -c %Y part.exr.1-of-3.shard)" -lt 1000000000
refuses 2 'shard: .*spp is 4 there and 8 now' render builtin:cubes -o part.exr -r 200x120 -s 8 --fstop 2 --frame 3 --aov coc \
    --shard 1/3 --resume

# What does not fit together.
merge=(merge -o bad.exr)
refuses 2 'shard 2 of 3 is missing' "${merge[@]}" part.exr.{1,3}-of-3.shard
refuses 2 'shard 3 of 3 is missing' "${merge[@]}" part.exr.{1,2}-of-3.shard
refuses 2 'shard 1 of 3 is given twice: .*again.shard' "${merge[@]}" part.exr.{1,2,3}-of-3.shard again.shard
split 2 other.exr "${small[@]}" --aov coc
refuses 2 'no parts of one picture: of 3 and of 2 shards' "${merge[@]}" part.exr.1-of-3.shard other.exr.2-of-2.shard
succeeds render builtin:cubes -o other.exr "${small[@]}" --aov coc --seed 1 --shard 2/3
refuses 2 'no parts of one picture: made with different settings' "${merge[@]}" part.exr.1-of-3.shard other.exr.2-of-3.shard
succeeds render builtin:cubes -o other.exr -r 200x120 -s 4 --fstop 2 --frame 4 --aov coc --shard 2/3
refuses 2 'no parts of one picture: of frame 3 and of frame 4' "${merge[@]}" part.exr.1-of-3.shard other.exr.2-of-3.shard
refuses 2 'only .exr files hold more' merge -o bad.png part.exr.*-of-3.shard
refuses 2 'must end in .exr or .png' merge -o bad.tif part.exr.*-of-3.shard
refuses 2 '--output is required' merge part.exr.*-of-3.shard
refuses 2 'SHARD is required' merge -o bad.exr
refuses 4 'no/bad.exr: cannot write' merge -o no/bad.exr part.exr.*-of-3.shard
refuses 2 '--sharp: a part of a frame has no twin' render builtin:cubes -o a.exr "${small[@]}" --sharp --shard 1/2
refuses 2 '--shard: a --dataset is shared out by its frames' render builtin:cubes --dataset set "${small[@]}" --shard 1/2
for text in 0/2 3/2 1 a/b 1/0 1/1000001 -1/2 1/2/3 / 1/ /2 '1 /2'; do
    refuses 2 "--shard: '.*' is not" render builtin:cubes -o a.exr "${small[@]}" "--shard=$text"
done

# Files that are damaged, at whatever place, are said to be so, and no picture is made of them.
cp part.exr.2-of-3.shard good.shard
size=$(stat -c %s good.shard)
for length in 0 5 16 23 24 100 $((size / 2)) $((size - 17)) $((size - 1)); do
    head -c "$length" good.shard >bad.shard
    refuses 3 'bad.shard: cannot read \((it ends too early|it is)' "${merge[@]}" part.exr.{1,3}-of-3.shard bad.shard
done
for place in 3 17 20 30 60 200 1000 $((size / 2)) $((size - 20)) $((size - 3)); do
    python3 - "$place" <<'PY'
import sys
data, at = bytearray(open("good.shard", "rb").read()), int(sys.argv[1])
data[at] ^= 0x41
open("bad.shard", "wb").write(data)
PY
    run "${merge[@]}" part.exr.{1,3}-of-3.shard bad.shard
    check "a byte turned at $place is found: $(cat err)" test "$status" = 3 -o "$status" = 2
    check "a byte turned at $place is one line" grep -qE '^pentaprism: error: ' err
done
(cat good.shard; echo) >bad.shard
refuses 3 'bad.shard: cannot read \(it is damaged' "${merge[@]}" part.exr.{1,3}-of-3.shard bad.shard
refuses 3 'one.exr: cannot read \(it is no shard' "${merge[@]}" one.exr
refuses 3 'none.shard: cannot read \(No such file' "${merge[@]}" none.shard
refuses 3 'set: cannot read \(Is a directory' "${merge[@]}" set
check "no picture was made of them" test ! -e bad.exr -a ! -e bad.exr.part

# A full disk, for the shard and for the picture.
if [[ -c /dev/full ]]; then
    ln -s /dev/full full.exr.1-of-2.shard.part
    refuses 4 'full.exr.1-of-2.shard: cannot write \(No space left' render builtin:cubes -o full.exr "${small[@]}" --shard 1/2 -q
    ln -s /dev/full bad.exr.part
    refuses 4 'bad.exr: cannot write \(No space left' "${merge[@]}" part.exr.*-of-3.shard
    check "nothing is left" test ! -e bad.exr -a ! -L bad.exr.part -a ! -L full.exr.1-of-2.shard.part
fi
finish
