#!/usr/bin/env bash
# --transparency a-buffer: no chance about opacity, the machine changes no bit, and what cannot work is refused.
source "$(dirname "$0")/lib.bash"

small=(builtin:fairy-forest -r 70x50 -s 4 --frame 5 -q --fstop 2.8)
succeeds render "${small[@]}" --transparency a-buffer -o one.exr -t 1 --aov depth,object-id
succeeds render "${small[@]}" --transparency a-buffer -o other.exr -t 2 --aov depth,object-id
check "threads do not change a bit" cmp one.exr other.exr
PENTAPRISM_ISA=scalar run render "${small[@]}" --transparency a-buffer -o other.exr --aov depth,object-id
checks=$((checks + 1))
[[ $status == 0 ]] || fail "scalar: exit code $status"
check "the processor does not change a bit" cmp one.exr other.exr
succeeds render "${small[@]}" --transparency a-buffer -o other.exr --culling hierarchical --aov depth,object-id
check "no culling test changes a bit" cmp one.exr other.exr
for i in 1 2; do
    succeeds render "${small[@]}" --transparency a-buffer -o part.exr --aov depth,object-id --shard $i/2
done
succeeds merge part.exr.*-of-2.shard -o merged.exr
check "shards are the picture" cmp one.exr merged.exr

succeeds render "${small[@]}" -o chance.exr
succeeds render "${small[@]}" -o said.exr --transparency stochastic
check "stochastic is the default" cmp chance.exr said.exr
succeeds render builtin:cubes -r 64x36 -q -o opaque.exr
succeeds render builtin:cubes -r 64x36 -q -o layers.exr --transparency a-buffer
succeeds compare opaque.exr layers.exr --fail-above 0  # where all is opaque it is the same picture

plain=(builtin:cubes -r 32x32 -o a.exr --transparency a-buffer)
refuses 2 "--transparency: 'layers' is not one of" render builtin:cubes -r 32x32 -o a.exr --transparency layers
for method in accumulation interleaved raytrace micropolygon; do
    refuses 2 "--transparency a-buffer.*$method" render "${plain[@]}" --visibility $method
done
refuses 2 "--transparency a-buffer.*gl" render "${plain[@]}" --backend gl
refuses 2 "--aov ste.*a-buffer" render "${plain[@]}" --culling hull --aov ste
refuses 2 "--samples.*a-buffer" render builtin:cubes -r 32x32 --samples a.5ds --transparency a-buffer
check "nothing was written" test ! -e a.exr -a ! -e a.5ds
finish
