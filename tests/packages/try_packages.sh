#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# try_packages.sh [--all] FILE.deb...: on a bare Debian 12, as root: installs the packages of `./run package` and does
# what the site tells a newcomer to do: a massage, the page, a programme and a scan of one's own, a press in Python. It
# compiles an example and a stranger's project against them, installs them once more as an upgrade does, and removes
# them without a rest. Each step ends with the seconds since the beginning. With --all every example is compiled, and
# linked with the static libraries, too, which need the -dev packages of whatever is hidden in them. Run it where
# nothing can be harmed.
set -euo pipefail
here=$(realpath "$(dirname "$0")/../..")
kinds=(shared)
examples=("$here/examples/05_whole_session.cpp")
if [ "$1" = --all ]; then
  kinds+=(static)
  examples=("$here"/examples/*.cpp)
  shift
fi
packages=$(realpath "$@")
cd "$(mktemp -d)"
start=$(date +%s)
said() { echo "$(($(date +%s) - start)) s: $*"; }
# Nothing here must outlive a loss of power, so nothing waits for the disk.
export DEBIAN_FRONTEND=noninteractive
install=(apt-get install -y -qq --no-install-recommends -o Dpkg::Options::=--force-unsafe-io)
there() { dpkg-query -W -f '${db:Status-Abbrev} ${Package} ${Installed-Size}\n' | grep '^ii' | sort; }
apt-get update -qq
there > before.txt
# shellcheck disable=SC2086
"${install[@]}" $(printf '%s\n' $packages | grep -E '/(tuina|tuina-udev)_') > apt.txt 2>&1 || { cat apt.txt; exit 1; }
there | comm -13 before.txt - > new.txt
# Debian's OpenCV needs the client's libraries of OpenGL and X11; beyond these nothing of a desktop may come.
if grep -E ' (libwayland|libgtk|libqt|xserver|x11-|xdg-|libcairo|dbus|libcups)' new.txt; then
  echo "these are of a desktop" >&2
  exit 1
fi
said "tuina installed: $(awk '{ kb += $3 } END { printf "%d packages, %.0f MB", NR, kb / 1024 }' new.txt)"
# shellcheck disable=SC2086
"${install[@]}" $packages > apt.txt 2>&1 || { cat apt.txt; exit 1; }
said "library, headers and Python installed"

tuina --version
tuina massage --quiet --json --out report > report.json
test -s report/report.html
test -s /usr/lib/udev/rules.d/60-tuina.rules
man_page=$(zcat /usr/share/man/man1/tuina.1.gz | sed -n 1p)
[[ $man_page == .TH\ tuina* ]]
said "a massage was given"

tuina serve --port 0 --out sessions > addresses.txt &
server=$!
trap 'kill $server 2>/dev/null || true' EXIT
for _ in $(seq 100); do [ -s addresses.txt ] && break; sleep 0.1; done
python3 - "$(head -1 addresses.txt)" <<'PYTHON'
import http.cookiejar, sys, urllib.request
browser = urllib.request.build_opener(urllib.request.HTTPCookieProcessor(http.cookiejar.CookieJar()))
page = browser.open(sys.argv[1]).read().decode()
assert "<html" in page, page
PYTHON
kill $server
wait $server
said "the page was served"

# The block of docs/PAGE that begins behind a line, as a reader copies it.
block() { sed -n "/$2/,\$p" "$here/docs/$1" | sed -n '/^```[a-z]/,/^```$/{//!p;/^```$/q}'; }
block programmes.md '^A programme is' > mine.toml
tuina plan report/scan.ply report/acupoints.json --programme mine.toml --picture plan.svg > plan.txt 2>&1
tuina massage --quiet --programme mine.toml --out own_programme
said "a massage by a programme of one's own was given"
mkdir own_scan
(cd own_scan && block first_massage.md '^## 6' | bash -e > own_scan.txt 2>&1) || { cat own_scan/own_scan.txt; exit 1; }
test -s own_scan/shoulders.svg
said "a scan of one's own was mapped and planned on"

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
said "tuina was imported"

needed=(g++ cmake ninja-build pkg-config)
[ ${#kinds[@]} = 1 ] || mapfile -t -O ${#needed[@]} needed < <(
  dpkg-query -W -f '${Recommends}\n' libtuina-dev | tr ',' '\n' | tr -d ' ')
"${install[@]}" "${needed[@]}" > apt.txt 2>&1 || { cat apt.txt; exit 1; }
said "a compiler was installed"

for kind in "${kinds[@]}"; do
  cmake -G Ninja -S "$here/tests/consumer" -B "$kind" -DKIND="$kind" > /dev/null
  cmake --build "$kind" > /dev/null
  "$kind/consumer"
done
# The six lines of docs/install.md, with an example.
mkdir mine
sed -n '/^```cmake$/,/^```$/{//!p}' "$here/docs/install.md" > mine/CMakeLists.txt
cp "$here/examples/04_press_once.cpp" mine/main.cpp
cmake -G Ninja -S mine -B mine > /dev/null
cmake --build mine > /dev/null
mine/mine | tail -1
# By pkg-config; each example is compiled once, and linked in each way.
compile() {  # SOURCE KINDS
  local name kind
  local -A library=([shared]=tuina [static]=tuina-static)
  name=$(basename "$1" .cpp)
  # shellcheck disable=SC2046
  g++ -DTUINA_MODELS='"/usr/share/tuina/models"' $(pkg-config --cflags tuina) -c "$1" -o "$name.o"
  for kind in $2; do
    # shellcheck disable=SC2046
    g++ "$name.o" $(pkg-config --libs "${library[$kind]}") -o "$name.$kind"
  done
}
export -f compile
export kinds_text="${kinds[*]}"
printf '%s\n' "${examples[@]}" | xargs -P 2 -I {} bash -ec 'compile {} "$kinds_text"'
[[ $(ldd 05_whole_session.shared) == *"libtuina.so.0.1 => /"* ]]
if [ ${#kinds[@]} = 2 ]; then
  for kind in "${kinds[@]}"; do ./04_press_once."$kind" > press."$kind".txt; done
  cmp press.shared.txt press.static.txt
  [[ $(ldd 04_press_once.static) != *libtuina.so* ]]
fi
said "compiled against it, ${kinds[*]}"

# shellcheck disable=SC2086
"${install[@]}" --reinstall $packages > apt.txt 2>&1  # as an upgrade does
mine/mine > /dev/null
du -shc /usr/share/tuina /usr/bin/tuina /usr/bin/tuina-evaluate /usr/lib/libtuina.so.0.1.0 | tail -1
apt-get remove -y -qq --purge python3-tuina tuina tuina-udev libtuina-dev libtuina0.1 > apt.txt 2>&1
for rest in /usr/share/tuina /usr/include/tuina /usr/bin/tuina /usr/lib/cmake/tuina /usr/lib/pkgconfig/tuina.pc \
    /usr/lib/libtuina.so* /usr/share/doc/tuina /usr/share/doc/libtuina* /usr/share/doc/python3-tuina \
    /usr/lib/python3/dist-packages/tuina /usr/lib/udev/rules.d/60-tuina.rules; do
  [ ! -e "$rest" ] || { echo "left behind: $rest" >&2; exit 1; }
done
said "installed, used and removed"
