#!/usr/bin/env bash
# `--backend gl`: the processor's picture, and one line with exit code 5 where there is no driver.
source "$(dirname "$0")/lib.bash"

run render builtin:cubes -o probe.png -r 16x16 -s 1 --backend gl
if [[ $status == 5 ]]; then
    check "what is missing is said in one line" test "$(wc -l <err)" = 1
    check "and how to get it" grep -q "^pentaprism: error: --backend gl: .*install" err
    check "no file was made" test ! -e probe.png
    [[ $failures == 0 ]] || finish
    echo "no OpenGL here: $(cat err)"
    exit 77
fi
check "a picture was made" test -s probe.png

picture=(render builtin:hand -r 80x60 -s 5 --frame 24 --fstop 2.8 --aov depth,object-id)
succeeds "${picture[@]}" -o cpu.exr
succeeds "${picture[@]}" -o gl.exr --backend gl --stats gl.json
check "the file is the processor's, byte for byte" cmp cpu.exr gl.exr
check "the statistics name the device" json gl.json 'd["device"] and d["tested"] >= d["covered"] > 0'
check "and the pipeline" json gl.json 'd["gl_pipeline"] == "compute"'
for pipeline in geometry compute; do
    succeeds "${picture[@]}" -o again.exr --backend gl --gl-pipeline $pipeline --stats again.json
    check "$pipeline gives that picture" cmp cpu.exr again.exr
    check "and its name" json again.json "d['gl_pipeline'] == '$pipeline'"
done
for threads in 1 4; do
    succeeds "${picture[@]}" -o again.exr --backend gl --culling dual-space -t "$threads"
    check "with $threads threads, too" cmp cpu.exr again.exr
done

shaded=("${picture[@]}" --shading pixel)
succeeds "${shaded[@]}" -o cpu.exr --stats cpu.json
succeeds "${shaded[@]}" -o gl.exr --backend gl --stats gl.json
succeeds compare cpu.exr gl.exr --fail-above 0.001
check "the device shaded as many points" json gl.json 'd["shaded"] == json.load(open("cpu.json"))["shaded"] > 0'
succeeds "${shaded[@]}" -o sky.exr --background sky --backend gl
succeeds "${shaded[@]}" -o cpu.exr --background sky
succeeds compare cpu.exr sky.exr --fail-above 0.001

succeeds bench builtin:cubes --backend gl -r 32x32 -s 2 --effects both --methods none,hyperplane --runs 1 --json
check "bench rows are gl's and lose nothing" json out 'all(r["backend"] == "gl-compute" and r["false_culls"] == 0 and 0 < r["ste"] <= 1 for r in d["rows"])'

refuses 2 "--culling half-space: not with --backend gl, which has auto, .*none" render builtin:cubes -o a.png --backend gl --culling half-space
refuses 2 "--culling bbox@bucket: not with --backend gl" render builtin:cubes -o a.png --backend gl --culling bbox@bucket
refuses 2 "--gl-pipeline: .*geometry" render builtin:cubes -o a.png --backend gl --gl-pipeline tiles
refuses 2 "--gl-pipeline: only --backend gl has one" render builtin:cubes -o a.png --gl-pipeline compute
refuses 2 "--backend gl: --visibility raytrace" render builtin:cubes -o a.png --backend gl --visibility raytrace
__EGL_VENDOR_LIBRARY_FILENAMES=/dev/null refuses 5 "--backend gl: .*install" render builtin:cubes -o a.png --backend gl
if grep -q Mesa gl.json; then
    MESA_GL_VERSION_OVERRIDE=3.3 refuses 5 "--backend gl: .*4\.5" render builtin:cubes -o a.png --backend gl
fi
check "no file was made" test ! -e a.png
finish
