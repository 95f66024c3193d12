#!/usr/bin/env bash
# A scene that cannot be read is exit code 3, and no output is touched.
source "$(dirname "$0")/lib.bash"

echo 'not a scene' >bad.glb
echo '{"asset":' >bad.gltf
: >empty.glb
for command in info "render -o a.exr" verify; do
    # shellcheck disable=SC2086
    refuses 3 'missing.glb' $command missing.glb
    refuses 3 'bad.glb' $command bad.glb
    refuses 3 'bad.gltf' $command bad.gltf
    refuses 3 'empty.glb' $command empty.glb
    refuses 3 'nosuch' $command builtin:nosuch
    refuses 3 '' $command .
    refuses 3 'lib.xyz' $command lib.xyz
done
refuses 3 'nosuch' scene nosuch -o a.glb
refuses 3 '' info $'two\nlines.glb'
check "no file was made" test ! -e a.exr -a ! -e a.glb
finish
