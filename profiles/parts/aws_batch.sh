#!/bin/bash
# The parts of a study as an array job of AWS Batch, here 40 (see docs/parts.md):
#     profiles/parts/aws_batch.sh studies/NAME.yaml 40 s3://BUCKET/NAME
# Needed: a queue, and a job definition whose image has impactlab[s3] and the folder studies/, here
# both named impactlab. An index counts from 0, a part from 1.
set -eu
part='$((AWS_BATCH_JOB_ARRAY_INDEX + 1))'
exec aws batch submit-job --job-name impactlab --job-queue impactlab --job-definition impactlab \
  --array-properties "size=$2" --retry-strategy attempts=5 --container-overrides \
  "{\"command\": [\"sh\", \"-c\", \"exec impactlab run $1 --part $part/$2 --workers 4 --to $3\"]}"
