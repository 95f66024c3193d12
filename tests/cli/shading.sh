#!/usr/bin/env bash
# Shadows, surroundings and shading rates: the same bits whatever the machine, and what the options promise.
source "$(dirname "$0")/lib.bash"

small=(builtin:cubes -r 96x54 -s 4 --fstop 2 --frame 5 -q)
same() { python3 - "$1" "$2" <<'END'
import json, subprocess, sys, os
out = subprocess.run([os.environ["PENTAPRISM"], "compare", sys.argv[1], sys.argv[2], "--linear", "--json"], capture_output=True)
sys.exit(0 if json.loads(out.stdout)["max"] == 0 else 1)
END
}
export PENTAPRISM
for rate in pixel sample decoupled; do
    succeeds render "${small[@]}" -o one.exr -t 1 --shading $rate --background sky
    succeeds render "${small[@]}" -o two.exr -t 2 --shading $rate --background sky
    check "$rate: threads do not change a bit" same one.exr two.exr
    PENTAPRISM_ISA=scalar run render "${small[@]}" -o scalar.exr --shading $rate --background sky
    checks=$((checks + 1))
    [[ $status == 0 ]] || fail "scalar: exit code $status"
    check "$rate: the processor does not change a bit" same one.exr scalar.exr
done
succeeds render "${small[@]}" -o plain.exr
succeeds render "${small[@]}" -o cells.exr --shading decoupled
check "cells by default" same plain.exr cells.exr
succeeds render "${small[@]}" -o still-cells.exr --no-motion-blur --no-defocus
succeeds render "${small[@]}" -o still-pixels.exr --no-motion-blur --no-defocus --shading pixel
check "a still frame's cells are its pixels" same still-cells.exr still-pixels.exr
# Thin pieces of a cut floor once took their colours from far along themselves: an error of 0.029 instead of 0.008.
range=(builtin:cubes -r 320x180 --fstop 0.5 --frame 5 --focus-range 0.6,1.5 -q)
succeeds render "${range[@]}" -o range-cells.exr
succeeds render "${range[@]}" -o range-samples.exr --shading sample
succeeds compare range-cells.exr range-samples.exr --fail-above 0.015
succeeds render "${small[@]}" -o moving.exr --shadows moving
check "shadows move by default" same plain.exr moving.exr
succeeds render "${small[@]}" -o off.exr --shadows off
check "shadows are seen" bash -c '! "$PENTAPRISM" compare plain.exr off.exr --fail-above 0.002 >/dev/null 2>&1'
succeeds render "${small[@]}" -o still.exr --shadows still
for filter in off pixel full; do succeeds render "${small[@]}" -o "filter-$filter.exr" --texture-filter $filter; done
succeeds render "${small[@]}" -o burley.exr --brdf burley
succeeds render "${small[@]}" -o lit.exr --background one.exr  # any picture is one of all directions
refuses 3 "nothing.hdr" render "${small[@]}" -o a.exr --background nothing.hdr
refuses 3 "nothing.exr" render "${small[@]}" -o a.exr --background nothing.exr
printf 'no picture' >broken.hdr
refuses 3 "broken.hdr" render "${small[@]}" -o a.exr --background broken.hdr
refuses 2 "--shadows" render "${small[@]}" -o a.exr --shadows some
refuses 2 "--texture-filter" render "${small[@]}" -o a.exr --texture-filter best
check "nothing was written" test ! -e a.exr
finish
