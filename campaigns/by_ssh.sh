#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# A campaign on machines that are reached by ssh, without a batch system; HOSTS is a file with one of
# them on each line, and tuina is installed there:
#   campaigns/by_ssh.sh HOSTS FOLDER SHARDS massage --sessions 100
# Each host does every so many-th shard and keeps its file in its home; a line in HOSTS that stands
# twice is two shards at a time. The same line again goes on where it ended.
# Then: tuina evaluate merge FOLDER/*.cells
set -eu
hosts=$1 folder=$2 shards=$3
shift 3
mkdir -p "$folder"
count=$(grep -c . "$hosts")
# Words of the evaluation for the shell at the other end.
words=
for word; do words="$words '$(printf %s "$word" | sed "s/'/'\\\\''/g")'"; done

of_host() {  # HOST FIRST
  shard=$2
  while [ "$shard" -le "$shards" ]; do
    file=tuina-campaign/$(basename "$folder")/$shard.cells
    ssh -n -o BatchMode=yes ${SSH_OPTIONS:-} "$1" "mkdir -p '$(dirname "$file")' && nice '${TUINA:-tuina}' evaluate$words \
      --shard $shard/$shards --out '$file' --quiet >/dev/null && cat '$file'" > "$folder/.$shard" &&
      mv "$folder/.$shard" "$folder/$shard.cells" ||
      { rm -f "$folder/.$shard" && echo "shard $shard: $1 has not done it" >&2; }
    shard=$((shard + count))
  done
}

first=1
for host in $(cat "$hosts"); do
  of_host "$host" "$first" &
  first=$((first + 1))
done
wait
