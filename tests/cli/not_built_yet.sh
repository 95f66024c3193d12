#!/usr/bin/env bash
# Every option and command of the contract is known by name; what is not built yet says so and does nothing.
source "$(dirname "$0")/lib.bash"

help_of() { "$PENTAPRISM" "$@" --help; }

while read -r option value; do
    refuses 2 "$option.* is not built yet \(planned: see CHANGELOG\)" render builtin:cubes -o a.exr "$option" $value
done <<'END'
--focus-range 1,2
--max-foreground-blur 5
--sampler sobol
--aov depth,albedo
--aov ste
--samples dump
--resume
--shard 1/4
END
for command in merge view; do
    refuses 2 "$command is not built yet \(planned: see CHANGELOG\)" "$command" some thing --option
    check "$command is in the help" grep -q "^  $command .*not built yet" <(help_of)
done
check "no file was made" test ! -e a.exr

# The names that users' scripts rely on.
render_help=$(help_of render)
for option in -r,--resolution -s,--spp --filter --crop --exposure --tonemap --background --camera --focal-length --sensor-width \
    --fstop --lens-radius --focus-distance --focus-object --focus-pixel --aperture-blades --aperture-rotation --aperture-ratio \
    --aperture-roundness \
    --focus-range --max-foreground-blur --no-defocus --shutter --shutter-position --shutter-curve --rolling-shutter \
    --rolling-shutter-duration --motion-segments --no-motion-blur --frame -f,--frames --fps --animation --culling --visibility \
    --backend --shading --sampler --seed -t,--threads --aov --sharp --dataset --stats --samples --overwrite --skip-existing \
    --resume --shard --progress -q,--quiet --log-level -o,--output; do
    check "render --help shows $option" grep -qE -- "^ +$option( |$)" <<<"$render_help"
done
finish
