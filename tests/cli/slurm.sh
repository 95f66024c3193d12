#!/usr/bin/env bash
# packaging/slurm/render-array.sh: an array of four on this machine, with its own munged, slurmctld and slurmd.
script=$(cd "$(dirname "$0")/../../packaging/slurm" && pwd)/render-array.sh
source "$(dirname "$0")/lib.bash"
skip() {
    echo "skipped: $1"
    exit 77
}
small=(-r 64x36 -s 2)

# The script itself, without Slurm.
succeeds render builtin:cubes -o one.exr "${small[@]}"
for i in 1 2 3; do
    check "the script renders shard $i" env SLURM_ARRAY_TASK_ID=$i SLURM_ARRAY_TASK_COUNT=1 PENTAPRISM_SHARDS=3 \
        bash "$script" builtin:cubes -o a.exr "${small[@]}" 2>err
done
succeeds merge a.exr.*-of-3.shard -o a.exr
check "the shards are one run" cmp -s a.exr one.exr
check "it wants an array" bash -c '! bash "$1" builtin:cubes -o b.exr 2>err' - "$script"
check "and says so" grep -q 'sbatch --array=1-N' err
[[ $failures == 0 ]] || finish

for program in slurmctld slurmd sbatch munged; do
    [[ -x $(command -v $program || echo /usr/sbin/$program) ]] || skip "$program is not installed (slurm-wlm, munge)"
done
[[ $(id -u) == 0 ]] || skip "only root may start Slurm's daemons"
for daemon in slurmctld slurmd munged; do
    pgrep -x $daemon >/dev/null && skip "$daemon runs here already"
done
[[ -e /etc/munge/munge.key ]] || skip "munge has no key"

host=$(hostname -s)
export SLURM_CONF=$work/slurm.conf
cat >"$SLURM_CONF" <<END
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
AuthType=auth/munge
SlurmUser=root
SlurmdUser=root
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
SlurmctldLogFile=$work/slurmctld.log
SlurmdLogFile=$work/slurmd.log
SlurmctldPort=16817
SlurmdPort=16818
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
ReturnToService=2
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=main Nodes=$host Default=YES MaxTime=INFINITE State=UP
END
mkdir -p state spool shots whole /run/munge
chown munge /run/munge
stop() {
    kill "$slurmd" "$slurmctld" 2>/dev/null
    [[ -s /run/munge/munged.pid ]] && kill "$(cat /run/munge/munged.pid)" 2>/dev/null
    wait 2>/dev/null
    rm -rf "$work"
}
slurmd= slurmctld=
trap stop EXIT
su -s /bin/sh munge -c /usr/sbin/munged || skip "munged does not start"
slurmctld -D >/dev/null 2>&1 &
slurmctld=$!
slurmd -D >/dev/null 2>&1 &
slurmd=$!
for _ in $(seq 60); do
    sinfo -h -o %T 2>/dev/null | grep -q idle && break
    sleep 0.5
done
sinfo -h -o %T 2>/dev/null | grep -q idle || skip "the node does not come up: $(tail -n 1 slurmd.log slurmctld.log | tr '\n' ' ')"

succeeds render builtin:cubes -o 'whole/f.#.exr' -f 1-6 "${small[@]}"
export PENTAPRISM
check "an array of four ends well: $(cat slurm-*.out 2>/dev/null)" timeout 120 \
    sbatch --wait --array=1-4 --cpus-per-task=1 "$script" builtin:cubes -o "$work/shots/f.#.exr" -f 1-6 "${small[@]}"
check "its frames are those of one run" diff -r whole shots
rm shots/f.3.exr
check "the same line again makes what is missing" timeout 120 \
    sbatch --wait --array=1-4 --cpus-per-task=1 "$script" builtin:cubes -o "$work/shots/f.#.exr" -f 1-6 "${small[@]}"
check "and they are one run again" diff -r whole shots
finish
