#!/usr/bin/env bash
# `info` and `scene` print what scripts rely on, and nothing else on stdout.
source "$(dirname "$0")/lib.bash"

succeeds --version
check "the version is one line" grep -qE '^pentaprism [0-9]+\.[0-9]+\.[0-9]+$' out
succeeds --help
for command in render scene info verify; do
    check "--help lists $command" grep -qE "^  $command " out
done
succeeds scene --list
check "cubes is listed" grep -qE '^cubes +50 triangles' out
succeeds scene --list --json
check "the list is JSON" json out 'any(s["name"] == "cubes" and s["triangles"] == 50 for s in d)'
check "at least one scene has a description" json out 'all(s["description"] for s in d)'

succeeds scene cubes -o cubes.glb
check "stdout stays empty" test ! -s out
succeeds scene builtin:cubes -o again.glb
check "the same scene gives the same bytes" cmp -s cubes.glb again.glb
for scene in builtin:cubes cubes.glb; do succeeds render $scene -o "${scene/:/-}.png" -r 64x36 -s 1 --frame 24; done
check "a written scene is the same picture" "$PENTAPRISM" compare builtin-cubes.png cubes.glb.png --fail-above 0.0001
succeeds info cubes.glb --json
check "a written scene can be read" json out 'd["triangles"] == 50 and d["scene"] == "cubes.glb" and len(d["scene_hash"]) == 32'
check "all keys are there" json out \
    'all(k in d for k in "triangles meshes nodes cameras lights animations skins morph_targets textures memory_mb warnings".split())'
if command -v xxh128sum >/dev/null; then
    check "the hash is that of xxh128sum" json out "d['scene_hash'] == '$(xxh128sum cubes.glb | cut -d' ' -f1)'"
fi
succeeds info builtin:cubes
check "info tells of triangles" grep -qE '^  triangles +50 ' out
succeeds info --json builtin:cubes
refuses 2 'NAME and -o' scene
refuses 2 '--output FILE.glb is missing' scene cubes
refuses 2 'must end in .glb' scene cubes -o cubes.obj
refuses 2 '--json' scene --json

if [[ -n ${PENTAPRISM_SCENES:-} && -f $PENTAPRISM_SCENES/forest/forest.glb ]]; then
    succeeds info "$PENTAPRISM_SCENES/forest/forest.glb" --json
    check "the forest has what its table says" json out \
        'd["triangles"] == 171807 and len(d["cameras"]) == 2 and len(d["textures"]) == 10 and len(d["animations"]) == 1 and d["skins"] == 1'
    succeeds info "$PENTAPRISM_SCENES/forest/forest.glb"
fi
finish
