#!/bin/bash
# The shards of a manifest as a Slurm array, one shard a task:
#
#   vpost batch plan release -m machine.toml -O corrected --manifest plan.jsonl
#   sbatch --array=1-16 slurm.sh plan.jsonl 16
#
# What is missing afterwards, and running only that:
#
#   vpost batch merge --manifest plan.jsonl --shards 16
#   sbatch --array="$(vpost batch merge --manifest plan.jsonl --shards 16 --missing slurm)" slurm.sh plan.jsonl 16
#
#SBATCH --job-name=vpost
#SBATCH --output=vpost-%A_%a.log
#SBATCH --cpus-per-task=4
#SBATCH --time=01:00:00
set -euo pipefail

manifest=$1
# The number of shards, not that of the array's tasks: the array that runs again has fewer.
shards=$2

status=0
vpost batch run --quiet --manifest "$manifest" --shard "auto/$shards" --jobs "${SLURM_CPUS_PER_TASK:-1}" || status=$?

# 75: a disk or share failed, and may work again. Slurm starts the task anew, three times at most.
if [ "$status" -eq 75 ] && [ "${SLURM_RESTART_COUNT:-0}" -lt 3 ]; then
  scontrol requeue "${SLURM_ARRAY_JOB_ID}_${SLURM_ARRAY_TASK_ID}"
fi
exit "$status"
