#!/usr/bin/env bash
# --target-error: samples go where they are needed, the machine changes no bit, and what cannot work is refused.
source "$(dirname "$0")/lib.bash"

small=(builtin:cubes -r 100x58 -s 4 --fstop 0.5 --frame 5 -q --target-error 0.02 --max-spp 64)
succeeds render "${small[@]}" -o one.exr -t 1 --aov samples,variance --stats stats.json
check "more than the least, less than the most" json stats.json '4 < d["mean_spp"] < 64'
check "samples are those of the picture" json stats.json 'd["samples"] == round(d["mean_spp"] * 100 * 58)'
check "those that decide are counted apart" json stats.json 'd["pilot_samples"] == 4 * 100 * 58'
succeeds render "${small[@]}" -o two.exr -t 2 --aov samples,variance
check "threads do not change a bit" cmp one.exr two.exr
PENTAPRISM_ISA=scalar run render "${small[@]}" -o scalar.exr --aov samples,variance
checks=$((checks + 1))
[[ $status == 0 ]] || fail "scalar: exit code $status"
check "the processor does not change a bit" cmp one.exr scalar.exr
for i in 1 2 3; do succeeds render "${small[@]}" -o part.exr --aov samples,variance --shard $i/3; done
succeeds merge part.exr.*-of-3.shard -o merged.exr
check "shards are the picture" cmp one.exr merged.exr

succeeds render builtin:cubes -r 100x58 -s 4 --fstop 0.5 --frame 5 -q -o uniform.exr --stats stats.json
check "without it" json stats.json 'd["mean_spp"] == 4 and "pilot_samples" not in d'

# A crop that has no block of some of its tile's numbers of samples.
succeeds render builtin:hand -r 70x66 --frame 5 --crop 33,36,1,2 --transparency a-buffer -s 2 --max-spp 512 --target-error 0.01 -q -o crop.exr

plain=(builtin:cubes -r 32x32 -o a.exr)
refuses 2 "--target-error: 0 " render "${plain[@]}" --target-error 0
refuses 2 "--target-error: 2 " render "${plain[@]}" --target-error 2
refuses 2 "--target-error" render "${plain[@]}" --target-error little
refuses 2 "--max-spp.*--target-error" render "${plain[@]}" --max-spp 64
refuses 2 "--max-spp" render "${plain[@]}" --target-error 0.01 --max-spp 5000
refuses 2 "--max-spp 8: .*--spp 16" render "${plain[@]}" --target-error 0.01 --max-spp 8
for method in accumulation interleaved raytrace micropolygon; do
    refuses 2 "--target-error.*$method" render "${plain[@]}" --target-error 0.01 --visibility $method
done
refuses 2 "--target-error.*gl" render "${plain[@]}" --target-error 0.01 --backend gl
refuses 2 "--samples.*--target-error" render builtin:cubes -r 32x32 --samples a.5ds --target-error 0.01
check "nothing was written" test ! -e a.exr -a ! -e a.5ds
finish
