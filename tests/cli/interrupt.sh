#!/usr/bin/env bash
# SIGINT and SIGTERM: exit code 130 and 143, one line, no .part, and what was finished stays.
source "$(dirname "$0")/lib.bash"

for signal in INT:130 TERM:143; do
    name=${signal%:*} code=${signal#*:}
    checks=$((checks + 1))
    rm -f f.*
    # One quick frame is there; the others would take minutes.
    succeeds render builtin:cubes -o f.0.png -r 64x36 -s 1 -q
    "$PENTAPRISM" render builtin:cubes -o 'f.#.png' -f 0-9 --skip-existing -r 4096x4096 -s 1024 --progress none 2>err &
    process=$!
    for _ in $(seq 200); do
        [[ -e f.1.png.part ]] && break
        sleep 0.05
    done
    [[ -e f.1.png.part ]] || fail "no frame was begun"
    sleep 0.3
    kill -"$name" "$process"
    status=0
    wait "$process" || status=$?
    [[ $status == "$code" ]] || fail "SIG$name: exit code $status instead of $code"
    [[ $(wc -l <err) == 1 ]] && grep -q '^pentaprism: error: interrupted' err || fail "SIG$name: $(cat err)"
    check "the finished frame stays, nothing half-written does" test "$(ls f.*)" = f.0.png
done
finish
