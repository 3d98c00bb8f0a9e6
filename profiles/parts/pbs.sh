#!/bin/bash
# The parts of a study as an array of PBS jobs, here 40 (see docs/parts.md):
#     qsub -J 1-40 -v STUDY=studies/NAME.yaml,PARTS=40 profiles/parts/pbs.sh
# Those that `impactlab merge` names are started again range by range, or all: finished ones end at once.
#PBS -N impactlab
#PBS -l select=1:ncpus=4:mem=2gb
#PBS -l walltime=04:00:00
#PBS -r y
# ... -A account, -q queue
set -eu
cd "$PBS_O_WORKDIR"
exec impactlab run "$STUDY" --part "$PBS_ARRAY_INDEX/$PARTS" --workers "$NCPUS"
