#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# try_packages.sh FILE.deb...: on a bare Debian 12, as root: installs the packages of `./run package`, gives a massage,
# fits a press in Python, compiles a stranger's project against them, and removes them without a rest. Run it where nothing can be harmed.
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
test -s /usr/lib/udev/rules.d/60-tuina.rules
man_page=$(zcat /usr/share/man/man1/tuina.1.gz | head -1)
[[ $man_page == .TH\ tuina* ]]
python3 - <<'PYTHON'
import numpy as np, tuina
from tuina import simulation
time_s = np.arange(0.0, 2.0, 1e-3)
depth_m = 6e-3 * np.sin(np.pi * time_s) ** 2 - 1e-3
force_n = tuina.force_at_depth(depth_m, alpha_n=9.8, beta_per_m=185.4)
fit = tuina.fit_curve(tuina.Presses(time_s, depth_m, force_n))
assert abs(fit.alpha_n - 9.8) < 0.1, fit.alpha_n
back = tuina.fit_back(simulation.scan(simulation.person("phantom:medium", "prone")))
assert "GV4" in tuina.locate_acupoints(back, tuina.read_atlas()).names
assert tuina.read_atlas().bodies["prone"] > 1 and tuina.__file__.startswith("/usr/lib/python3"), tuina.__file__
print(f"python: alpha {fit.alpha_n:.2f} N")
PYTHON
apt-get install -y -qq --no-install-recommends g++ cmake ninja-build > /dev/null
cmake -G Ninja -S "$consumer" -B consumer > /dev/null
cmake --build consumer > /dev/null
consumer/consumer
apt-get install -y -qq --reinstall --no-install-recommends $packages > /dev/null  # as an upgrade does
du -shc /usr/share/tuina /usr/bin/tuina /usr/bin/tuina-evaluate | tail -1
apt-get remove -y -qq --purge python3-tuina tuina libtuina-dev > /dev/null
for rest in /usr/share/tuina /usr/include/tuina /usr/bin/tuina /usr/lib/cmake/tuina /usr/share/doc/tuina \
    /usr/share/doc/python3-tuina /usr/lib/python3/dist-packages/tuina /usr/lib/udev/rules.d/60-tuina.rules; do
  [ ! -e "$rest" ] || { echo "left behind: $rest" >&2; exit 1; }
done
echo "installed, used and removed in $(($(date +%s) - start)) s"
