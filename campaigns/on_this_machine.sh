#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# A campaign on the cores of this machine, by GNU parallel:
#   campaigns/on_this_machine.sh FOLDER SHARDS massage --sessions 100
# The same line again goes on where it ended. Then: tuina evaluate merge FOLDER/*.cells
set -eu
folder=$1 shards=$2
shift 2
mkdir -p "$folder"
# Each shard has a core of its own, unless JOBS says otherwise.
seq "$shards" | parallel --will-cite --quote --jobs "${JOBS:-100%}" \
  "${TUINA:-tuina}" evaluate "$@" --shard "{}/$shards" --out "$folder/{}.cells" --quiet
