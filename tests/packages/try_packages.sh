#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# try_packages.sh FILE.deb...: on a bare Debian 12, as root: installs the packages of `./run package`, gives a massage,
# compiles a stranger's project against them, and removes them without a rest. Run it where nothing can be harmed.
set -euo pipefail
packages=$(realpath "$@")
consumer=$(realpath "$(dirname "$0")/../consumer")
cd "$(mktemp -d)"
start=$(date +%s)
apt-get update -qq
# shellcheck disable=SC2086
apt-get install -y -qq --no-install-recommends $packages > /dev/null
echo "installed in $(($(date +%s) - start)) s"
tuina --version
tuina massage --quiet --json --out report > report.json
test -s report/report.html
apt-get install -y -qq --no-install-recommends g++ cmake ninja-build > /dev/null
cmake -G Ninja -S "$consumer" -B consumer > /dev/null
cmake --build consumer > /dev/null
consumer/consumer
apt-get install -y -qq --reinstall --no-install-recommends $packages > /dev/null  # as an upgrade does
du -shc /usr/share/tuina /usr/bin/tuina /usr/bin/tuina-evaluate | tail -1
apt-get remove -y -qq --purge tuina libtuina-dev > /dev/null
for rest in /usr/share/tuina /usr/include/tuina /usr/bin/tuina /usr/lib/cmake/tuina /usr/share/doc/tuina; do
  [ ! -e "$rest" ] || { echo "left behind: $rest" >&2; exit 1; }
done
echo "installed, used and removed in $(($(date +%s) - start)) s"
