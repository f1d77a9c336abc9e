#!/usr/bin/env bash
# Installs what jink builds with on Debian 12: packages by apt, Python packages into .venv. Quick when nothing is missing.
# Called by tools/demo.sh, tools/test.sh and .ci/run; safe to run by hand. Not root: uses sudo and says so.
#   tools/setup.sh [test|docs|bench|sanitizers...]   what the tests, tools/docs.sh, tools/bench.sh, or tools/fuzz.sh and
#                                                    the preset asan need too
set -euo pipefail
cd "$(dirname "$0")/.."

packages=(
  build-essential cmake ninja-build ccache git ca-certificates pkg-config
  libeigen3-dev libyaml-cpp-dev libgtest-dev
  libcli11-dev libspdlog-dev libfmt-dev nlohmann-json3-dev libgeographiclib-dev fonts-dejavu-core
  libfastrtps-dev libfastcdr-dev fastddsgen libompl-dev libpagmo-dev libboost-math-dev gnuplot-nox
  python3 python3-venv
  clang-format-14 clang-tidy-14
)
for group in "$@"; do
  case $group in
  # A browser without a screen, where there is none: the flight report is played and looked at (64 MB and its libraries).
  test) command -v chromium-headless-shell chromium google-chrome >/dev/null || packages+=(chromium-headless-shell) ;;
  docs) packages+=(doxygen) ;;
  bench) packages+=(libbenchmark-dev) ;;
  sanitizers) packages+=(clang-14 libclang-rt-14-dev) ;;
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

# Python packages: MAVSDK's C++ core comes in its wheel; pymavlink generates the MAVLink headers; both and cyclonedds test.
if ! cmp -s tools/requirements.txt .venv/.installed; then
  echo "setup: Python packages into .venv: $(grep -v '^#' tools/requirements.txt | tr '\n' ' ')"
  [ -x .venv/bin/python ] || /usr/bin/python3 -m venv .venv
  .venv/bin/pip install -q --disable-pip-version-check -r tools/requirements.txt
  cp tools/requirements.txt .venv/.installed
fi
