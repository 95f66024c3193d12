#!/usr/bin/env bash
# mpirun: the frames of a sequence, or the tiles of one frame, by several processes; the bytes are those of one run.
source "$(dirname "$0")/lib.bash"
small=(-r 200x120 -s 4 --fstop 2 --frame 3)
command -v mpirun >/dev/null || { echo "skipped: mpirun is not installed (packaging/apt-mpi.txt)"; exit 77; }
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1
export ASAN_OPTIONS=detect_leaks=0  # OpenMPI frees not all that it has; a sanitized build would stop at that

# ranks N ARGUMENTS...: as run(), by N processes.
ranks() {
    local n=$1
    shift
    status=0
    timeout 120 mpirun -n "$n" --oversubscribe "$PENTAPRISM" "$@" -t 1 >out 2>err </dev/null || status=$?
}
all_well() {
    checks=$((checks + 1))
    ranks "$@"
    [[ $status == 0 ]] || fail "mpirun -n $*: exit code $status: $(head -c 800 err)"
}

ranks 2 render builtin:cubes -o first.exr "${small[@]}"
if [[ $status == 5 ]]; then
    check "a build without MPI says so" grep -q 'mpirun started 2 processes, but this build has no MPI' err
    check "and makes nothing" test ! -e first.exr
    [[ $failures == 0 ]] || finish
    echo "skipped: built without MPI"
    exit 77
fi
succeeds render builtin:cubes -o one.exr "${small[@]}" --aov cryptomatte,motion
succeeds render builtin:cubes -o one.png "${small[@]}"
for n in 1 2 3; do
    all_well $n render builtin:cubes -o many.exr "${small[@]}" --aov cryptomatte,motion
    check "$n ranks: the frame is that of one run" cmp -s many.exr one.exr
done
all_well 2 render builtin:cubes -o many.png "${small[@]}" --stats stats.json
check "a .png, too" cmp -s many.png one.png
check "statistics are those of the first rank" json stats.json '0 < d["samples"] < 200 * 120 * 4'
touch -d 2001-01-01 many.png
all_well 2 render builtin:cubes -o many.png "${small[@]}" --resume
check "what is there is left alone" test "$(stat -c %Y many.png)" -lt 1000000000

mkdir whole shared
succeeds render builtin:cubes -o 'whole/f.#.png' -f 1-5 -r 64x36 -s 1
all_well 2 render builtin:cubes -o 'shared/f.#.png' -f 1-5 -r 64x36 -s 1
check "a sequence is that of one run" diff -r whole shared
succeeds render builtin:cubes --dataset set -f 1-3 -r 64x36 -s 1
all_well 2 render builtin:cubes --dataset sets -f 1-3 -r 64x36 -s 1
check "a data set is that of one run" diff -r set sets

# Failures end all processes with the exit code of the one that failed, and leave nothing half-written.
ranks 2 render builtin:cubes -o many.exr "${small[@]}" --spp 0
check "bad usage is 2, not $status" test "$status" = 2
ranks 2 render builtin:cubes -o a.exr "${small[@]}" --shard 1/2
check "--shard with mpirun is 2, not $status" test "$status" = 2
check "and says why" grep -q -- '--shard: mpirun shares out the work already' err
ranks 2 render no.glb -o a.exr "${small[@]}"
check "no scene is 3, not $status" test "$status" = 3
ranks 2 render builtin:cubes -o many.png "${small[@]}" --seed 1 --resume
check "other settings are 2, not $status: $(cat err)" test "$status" = 2
if [[ -c /dev/full ]]; then
    ln -s /dev/full full.exr.part
    ranks 2 render builtin:cubes -o full.exr "${small[@]}"
    check "a full disk is 4, not $status" test "$status" = 4
    check "and is said" grep -q 'full.exr: cannot write (No space left on device)' err
fi
# A rank that dies. All have joined when the first one tells how far it is.
mpirun -n 2 --oversubscribe "$PENTAPRISM" render builtin:cubes -o dead.exr -r 4096x4096 -s 256 -t 1 --progress ndjson >out 2>err \
    </dev/null &
mpi=$!
for _ in $(seq 600); do
    grep -q '"event":"progress"' err && break
    sleep 0.1
done
check "the ranks are at work: $(head -c 800 err)" grep -q '"event":"progress"' err
victim=$(pgrep -f -P "$mpi" -- '-o dead.exr' | tail -n 1)
check "there is a rank to kill" test -n "$victim"
kill -9 "${victim:-$mpi}"
status=0
wait "$mpi" || status=$?
check "a dead rank ends the work, with an exit code" test "$status" != 0
check "and leaves no picture" test ! -e dead.exr -a ! -e a.exr -a ! -e full.exr
finish
