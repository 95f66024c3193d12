#!/usr/bin/env bash
# `bench` measures, tells it in every format, refuses what has no meaning, and leaves nothing half-written.
source "$(dirname "$0")/lib.bash"

small=(-r 64x48 -s 2 --runs 1)
succeeds bench builtin:cubes "${small[@]}" --effects still,both-x2 --methods none,improved-dual-space@tile,auto --json
check "stdout is one JSON document with a row for each method of each effect" json out 'len(d["rows"]) == 6 and d["peers"] == []'
check "rows have the keys that scripts rely on" json out 'all(set("scene effect method backend ste tested covered false_culls setup_ms test_ms frame_ms peak_mb".split()) <= set(r) for r in d["rows"])'
check "nothing is lost" json out 'all(r["false_culls"] == 0 for r in d["rows"])'
check "culling leaves fewer tests and the same hits" json out '(lambda r: r[4]["tested"] < r[3]["tested"] and r[4]["covered"] == r[3]["covered"])(d["rows"])'
check "the machine is named" json out 'd["machine"]["cpu"] and d["machine"]["threads"] >= 1 and d["machine"]["compiler"]'

succeeds bench builtin:cubes "${small[@]}" --effects both --methods none --report a/b -q
check "the report is whole" test "$(ls a/b | tr '\n' ' ')" = "bench.csv bench.json bench.tex index.html "
check "the page holds its pictures" grep -q 'src="data:image/png;base64,' a/b/index.html
check "the page asks no network" bash -c '! grep -q http a/b/index.html'
check "the table tells where the report is" grep -q 'a/b/index.html' out
succeeds bench builtin:cubes "${small[@]}" --effects still --methods none -t 1 --json
check "threads are those asked for" json out 'd["machine"]["threads"] == 1'

refuses 2 "--methods: 'nope' is not one of auto, " bench builtin:cubes --methods none,nope
refuses 2 "no effect 'blurry'; there are: still, motion, " bench builtin:cubes --effects blurry
refuses 2 "--effects: 'still,' has an empty name" bench builtin:cubes --effects still,
for wrong in nan -1 inf; do refuses 2 "--seconds: $wrong is not from 0" bench builtin:cubes --seconds $wrong; done
refuses 2 "--peer: 'optix' is not one of embree" bench builtin:cubes --peer optix
refuses 2 "--spp" bench builtin:cubes --spp 0
refuses 3 "nope.glb" bench nope.glb --quick
touch file
refuses 4 "--report file/sub: cannot make this folder" bench builtin:cubes --report file/sub
refuses 4 "--report file: cannot make this folder" bench builtin:cubes --report file
if [[ $(id -u) != 0 ]]; then
    mkdir locked && chmod 555 locked
    refuses 4 "locked" bench builtin:cubes --report locked/r
fi

checks=$((checks + 1))
"$PENTAPRISM" bench builtin:car -r 1024x768 --report stopped --progress plain >out 2>err &
process=$!
sleep 1
kill -INT "$process"
status=0
wait "$process" || status=$?
[[ $status == 130 ]] && grep -q '^pentaprism: error: interrupted' err || fail "SIGINT: exit code $status: $(cat err)"
check "no report of what was not measured" test -z "$(ls stopped)"

run bench builtin:cubes "${small[@]}" --effects both --methods auto --peer embree -t 2 --json -q
if [[ $status == 0 ]]; then
    check "the ray tracer is timed with one thread and with all" json out '[p["threads"] for p in d["peers"]] == [1, 2]'
    check "its keys are there" json out 'all(set("scene effect threads peer build_ms trace_ms ours_ms ratio".split()) <= set(p) for p in d["peers"])'
    check "ratio is its time over ours" json out 'all(abs(p["ratio"] - (p["build_ms"] + p["trace_ms"]) / p["ours_ms"]) < 1e-9 for p in d["peers"])'
    PENTAPRISM_THREADS=1 run bench builtin:cubes "${small[@]}" --effects still --methods auto --peer embree --json -q
    check "one thread is measured once, also if the environment says so" json out '[p["threads"] for p in d["peers"]] == [1]'
elif [[ $status != 5 ]]; then
    fail "bench --peer embree: exit code $status: $(cat err)"
fi
finish
