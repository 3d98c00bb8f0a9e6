#!/bin/bash
# The parts of a study as an array of Slurm jobs, here 40 (see docs/parts.md):
#     sbatch --array=1-40 profiles/parts/slurm.sh studies/NAME.yaml 40
# Those that `impactlab merge` names are started again with the same 40: --array=3,17-19
#SBATCH --job-name=impactlab
#SBATCH --cpus-per-task=4
#SBATCH --mem=2G
#SBATCH --time=04:00:00
#SBATCH --requeue
# ... --account=..., --partition=...
set -eu
exec impactlab run "$1" --part "$SLURM_ARRAY_TASK_ID/$2" --workers "$SLURM_CPUS_PER_TASK"
