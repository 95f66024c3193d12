#!/usr/bin/env bash
# What cannot be written is exit code 4, before rendering where that can be known, and leaves neither name nor .part.
source "$(dirname "$0")/lib.bash"
small=(-r 64x36 -s 1 --progress none)

refuses 4 'no/such/a.exr: cannot write .*no/such does not exist' render builtin:cubes -o no/such/a.exr -r 16384x16384 -s 4096
refuses 4 'stats no/s.json.*does not exist' render builtin:cubes -o a.exr --stats no/s.json
mkdir folder.exr
refuses 4 'folder.exr: cannot write' render builtin:cubes -o folder.exr "${small[@]}"
mkfifo pipe.exr pipe.json
refuses 4 'output pipe.exr: cannot write \(it is no ordinary file\)' render builtin:cubes -o pipe.exr -r 16384x16384 -s 4096
refuses 4 'stats pipe.json: cannot write \(it is no ordinary file\)' render builtin:cubes -o a.exr --stats pipe.json "${small[@]}"
run render builtin:cubes -o picture.exr "${small[@]}"
refuses 4 'pipe.exr: cannot write \(it is no ordinary file\)' compare picture.exr picture.exr -o pipe.exr
check "a pipe stays a pipe" test -p pipe.exr -a -p pipe.json
mkdir elsewhere
echo text >elsewhere/real.exr
ln -s elsewhere/real.exr link.exr
succeeds render builtin:cubes -o link.exr "${small[@]}"
check "a link stays a link, and its file is the picture" test -L link.exr -a "$(cmp elsewhere/real.exr picture.exr && echo same)" = same
echo text >file
refuses 4 'file is not a folder' render builtin:cubes -o file/a.exr "${small[@]}"
refuses 4 'no/a.glb: cannot write|no/a.glb' scene cubes -o no/a.glb

# A full disk: the .part leads to /dev/full.
if [[ -c /dev/full ]]; then
    for name in a.exr a.png; do
        ln -s /dev/full "$name.part"
        refuses 4 "$name: cannot write \(No space left on device\)" render builtin:cubes -o "$name" "${small[@]}"
        check "neither name nor .part is left" test ! -e "$name" -a ! -L "$name.part"
    done
    checks=$((checks + 1))
    status=0
    "$PENTAPRISM" info builtin:cubes --json >/dev/full 2>err || status=$?
    [[ $status == 4 ]] && grep -q '^pentaprism: error: standard output: cannot write (No space' err || fail "a full stdout: $status, $(cat err)"
fi

# A file-size limit.
checks=$((checks + 1))
status=0
(ulimit -f 8 && "$PENTAPRISM" render builtin:cubes -o big.exr -r 256x256 -s 1 --progress none) 2>err || status=$?
[[ $status == 4 ]] && grep -q 'big.exr: cannot write (File too large)' err || fail "a file-size limit: $status, $(cat err)"
check "no .part is left" test ! -e big.exr.part

# A real full file system, where a small one can be mounted.
mkdir disk
if mount -t tmpfs -o size=16k tmpfs disk 2>/dev/null; then
    trap 'umount "$work/disk"; rm -rf "$work"' EXIT
    refuses 4 'disk/a.exr: cannot write \(No space left on device\)' render builtin:cubes -o disk/a.exr -r 256x256 -s 1 --progress none
    check "the full disk is empty again" test -z "$(ls -A disk)"
    succeeds render builtin:cubes -o disk/small.png "${small[@]}"
fi

# Permissions count only for those whom they bind.
if [[ $(id -u) != 0 ]]; then
    mkdir locked
    chmod 555 locked
    refuses 4 'locked' render builtin:cubes -o locked/a.exr "${small[@]}"
fi
finish
