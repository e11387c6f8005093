#!/bin/sh
#SBATCH --requeue
#SBATCH --open-mode=append
# Runs one shard of a corda command in each task of a Slurm array; as a job without an array, joins them.
# Usage: array=$(sbatch --parsable --array=0-7 slurm.sh COMMAND...)
#        sbatch --dependency=afterany:$array slurm.sh COMMAND...
if [ -n "${SLURM_ARRAY_TASK_ID:-}" ]; then
    exec "$@" --shard "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT"
fi
exec "$@" --resume
