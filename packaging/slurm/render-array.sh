#!/bin/bash
# A sequence, or one large frame, by a Slurm array: task I of N renders shard I/N.
#
#   sbatch --array=1-40 --cpus-per-task=16 render-array.sh SCENE -o '/shared/shots/f.####.exr' -f 1-2400 [OPTIONS of render]
#
# Tasks that failed or ran out of time: the same line again. --resume leaves finished frames alone. To run only some of
# the tasks again, say how many shards there are: PENTAPRISM_SHARDS=40 sbatch --array=3,17 ... (the same options).
# One frame makes OUT.I-of-N.shard files; join them afterwards:
#
#   sbatch --dependency=afterok:JOB --wrap "pentaprism merge /shared/a.exr.*-of-40.shard -o /shared/a.exr"
#
#SBATCH --job-name=pentaprism
#SBATCH --requeue
set -eu
: "${SLURM_ARRAY_TASK_ID:?start it with sbatch --array=1-N}"
shards=${PENTAPRISM_SHARDS:-$SLURM_ARRAY_TASK_COUNT}
exec "${PENTAPRISM:-pentaprism}" render "$@" --resume --progress plain \
    --shard "$SLURM_ARRAY_TASK_ID/$shards" --threads "${SLURM_CPUS_PER_TASK:-1}"
