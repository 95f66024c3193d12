#!/usr/bin/env bash
# Every command and option of the contract is known by name; a command that is not built yet says so.
source "$(dirname "$0")/lib.bash"

help_of() { "$PENTAPRISM" "$@" --help; }

for command in view; do
    refuses 2 "$command is not built yet \(planned: see CHANGELOG\)" "$command" some thing --option
    check "$command is in the help" grep -q "^  $command .*not built yet" <(help_of)
done

# The names that users' scripts rely on.
render_help=$(help_of render)
for option in -r,--resolution -s,--spp --target-error --max-spp --filter --crop --exposure --tonemap --background --camera --focal-length --sensor-width \
    --fstop --lens-radius --focus-distance --focus-object --focus-pixel --aperture-blades --aperture-rotation --aperture-ratio \
    --aperture-roundness \
    --focus-range --max-foreground-blur --tilt --swing --aperture-image --cats-eye --no-defocus --shutter --shutter-position --shutter-curve --rolling-shutter \
    --rolling-shutter-duration --motion-segments --no-motion-blur --frame -f,--frames --fps --animation --culling --visibility \
    --backend --shading --sampler --seed -t,--threads --aov --sharp --dataset --stats --samples --overwrite --skip-existing \
    --resume --shard --progress -q,--quiet --log-level -o,--output; do
    check "render --help shows $option" grep -qE -- "^ +$option( |$)" <<<"$render_help"
done
finish
