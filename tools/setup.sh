#!/usr/bin/env bash
# Installs what jink builds with on Debian 12: packages by apt, Python packages into .venv. Quick when nothing is missing.
# The other scripts call it with the groups they need; safe to run by hand. Not root: uses sudo and says so.
#   tools/setup.sh [GROUP...]      none: what the flight program jink builds with. Besides:
#     lab         the laboratory jink-lab and its figures
#     test        the test suite, which tests the laboratory too: give both
#     docs        tools/docs.sh
#     style       clang-format and clang-tidy
#     bench       tools/bench.sh
#     package     tools/package.sh
#     lintian     tests/package/check_package.py
#     python      tools/wheel.sh
#     sanitizers  tools/fuzz.sh and the preset asan
#     arm64       the preset arm64: cross-compiler, qemu, and in build/sysroot-arm64 what the groups beside it link
set -euo pipefail
cd "$(dirname "$0")/.."

packages=(
  build-essential cmake ninja-build ccache ca-certificates python3 python3-venv
  libeigen3-dev libyaml-cpp-dev libcli11-dev libfmt-dev nlohmann-json3-dev libgeographiclib-dev zlib1g-dev
  libfastrtps-dev libfastcdr-dev fastddsgen
)
requirements=(tools/requirements.txt)
foreign=
for group in "$@"; do
  case $group in
  lab) packages+=(libompl-dev libpagmo-dev libboost-math-dev gnuplot-nox fonts-dejavu-core) ;;
  test)
    packages+=(libgtest-dev liboctomap-dev fonts-dejavu-core openssl)
    requirements+=(tools/requirements-test.txt tools/requirements-clients.txt)
    # A browser without a screen, where there is none: the flight report is played and looked at (64 MB and its libraries).
    command -v chromium-headless-shell chromium google-chrome >/dev/null || packages+=(chromium-headless-shell)
    ;;
  docs) packages+=(doxygen) ;;
  style) packages+=(git clang-format-14 clang-tidy-14) ;;
  bench) packages+=(libbenchmark-dev) ;;
  package) packages+=(dpkg-dev file) ;;
  lintian) packages+=(lintian) ;;
  python) packages+=(python3-dev); requirements+=(tools/requirements-python.txt) ;;
  sanitizers) packages+=(clang-14 libclang-rt-14-dev) ;;
  arm64) packages+=(g++-aarch64-linux-gnu qemu-user-static) foreign=arm64 ;;
  *) echo "setup: unknown group of packages: $group" >&2; exit 2 ;;
  esac
done
missing=()
for p in "${packages[@]}"; do
  [ "$(dpkg-query -W -f '${db:Status-Status}' "$p" 2>/dev/null)" = installed ] || missing+=("$p")
done
if [ ${#missing[@]} -gt 0 ]; then
  as_root=()
  if [ "$(id -u)" != 0 ]; then
    command -v sudo >/dev/null || { echo "setup: needs root or sudo to install: ${missing[*]}" >&2; exit 3; }
    echo "setup: using sudo to install: ${missing[*]}"; as_root=(sudo)
  else
    echo "setup: installing ${missing[*]}"
  fi
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update -qq
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
fi

# Python packages: MAVSDK's C++ core comes in its wheel; pymavlink generates the MAVLink headers.
for file in "${requirements[@]}"; do
  venv=.venv
  [ "$file" != tools/requirements-clients.txt ] || venv=.venv/clients  # its packages have names that .venv has
  installed=$venv/.installed-$(basename "$file")
  cmp -s "$file" "$installed" && continue
  echo "setup: Python packages into $venv: $(grep -v '^#' "$file" | tr '\n' ' ')"
  [ -x $venv/bin/python ] || /usr/bin/python3 -m venv $venv
  $venv/bin/pip install -q --disable-pip-version-check -r "$file"
  cp "$file" "$installed"
done

if [ -n "$foreign" ]; then
  linked=()
  for p in "${packages[@]}"; do
    [[ $p != *-dev ]] || linked+=("$p")
  done
  tools/sysroot.sh $foreign "${linked[@]}"
fi
