#!/usr/bin/env bash
# The methods of visibility: each renders, with the same picture for any number of threads and culling test, and says what it counted.
source "$(dirname "$0")/lib.bash"

picture=(builtin:cubes -r 96x54 -s 4 --fstop 2 --shutter 1 --frame 12 -q)
for method in stochastic accumulation interleaved micropolygon; do
    succeeds render "${picture[@]}" -o "$method.exr" --visibility "$method" -t 1 --stats "$method.json"
    succeeds render "${picture[@]}" -o again.exr --visibility "$method" -t 4
    check "$method: the same bytes from one thread and from four" cmp "$method.exr" again.exr
    check "$method: tests are counted" json "$method.json" '0 < d["covered"] < d["tested"] and 0 < d["ste"] < 1'
done
check "accumulation is another picture" [ "$(cksum <accumulation.exr)" != "$(cksum <stochastic.exr)" ]
check "interleaved is another picture" [ "$(cksum <interleaved.exr)" != "$(cksum <accumulation.exr)" ]

# compare gives the largest difference of a channel; settings in the header differ, so bytes do.
same() {
    run compare "$1" "$2" --json
    checks=$((checks + 1))
    [[ $status == 0 ]] && json out 'd["max"] <= 0.02' || fail "$1 and $2 differ: $(head -c 300 out err)"
}
for method in accumulation interleaved; do
    succeeds render "${picture[@]}" -o culled.exr --visibility "$method" --culling none
    check "$method: the culling test changes no pixel" cmp "$method.exr" culled.exr
done
same stochastic.exr micropolygon.exr

for method in raytrace micropolygon; do
    refuses 2 "--culling none: --visibility $method has no use for it" render "${picture[@]}" -o no.exr --visibility "$method" --culling none
done
run render "${picture[@]}" -o raytrace.exr --visibility raytrace --stats raytrace.json
if [[ $status == 5 ]]; then
    check "without Embree it says what to do" grep -q '^pentaprism: error: this build has no Embree.*install libembree-dev' err
    check "and makes no file" [ ! -e raytrace.exr ]
else
    check "raytrace renders" [ "$status" == 0 ]
    check "raytrace tests nothing" json raytrace.json 'd["tested"] == 0 and d["ste"] == 0'
    same stochastic.exr raytrace.exr
fi

succeeds experiment guided-sampling builtin:cubes -r 32x18 -s 32 --repeats 4 --fstop 2 --shutter 1 -o guided.png --json -q
check "the experiment finds the biased estimator" json out '{r["name"]: r for r in d["rows"]}["private"]["rms_z"] > 2 and len(d["rows"]) == 5'
check "and draws it" [ -s guided.png ]
refuses 2 '--spp: this experiment takes 32' experiment guided-sampling builtin:cubes -s 16
refuses 2 '--crop: the experiment has whole pictures' experiment guided-sampling builtin:cubes --crop 0,8,0,8
refuses 2 '--target-error: the experiment has' experiment guided-sampling builtin:cubes --target-error 0.1
refuses 2 "there is no option '--visibility'; see pentaprism experiment guided-sampling --help" \
    experiment guided-sampling builtin:cubes --visibility accumulation
refuses 4 'no/folder' experiment guided-sampling builtin:cubes -o no/folder/a.png
refuses 2 '--output a.jpg: the name must end in' experiment guided-sampling builtin:cubes -o a.jpg
finish
