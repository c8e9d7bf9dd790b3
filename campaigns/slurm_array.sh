#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
#SBATCH --job-name=tuina
#SBATCH --cpus-per-task=1
#SBATCH --output=/dev/null
# A campaign as a Slurm array; a job for each shard, in a folder that all nodes see:
#   sbatch --array=1-100 campaigns/slurm_array.sh FOLDER 100 massage --sessions 100000
# A lost shard is done again by its number: --array=7. Then: tuina evaluate merge FOLDER/*.cells
set -eu
folder=$1 shards=$2
shift 2
mkdir -p "$folder"
exec "${TUINA:-tuina}" evaluate "$@" --shard "$SLURM_ARRAY_TASK_ID/$shards" \
  --out "$folder/$SLURM_ARRAY_TASK_ID.cells" --quiet
