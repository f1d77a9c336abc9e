#!/usr/bin/env bash
# Installs what is missing, builds the Python package and makes it fit for other machines: build/wheel/*.whl.
# tests/python/check_wheel.sh tries it.
#   tools/wheel.sh [PYTHON...]      /usr/bin/python3 unless told; from 3.12 on one wheel is for all later ones
set -euo pipefail
cd "$(dirname "$0")/.."
[ $# -gt 0 ] || set -- /usr/bin/python3
tools/setup.sh python
# The same compiler and cache as tools/build.sh.
export CMAKE_CXX_COMPILER_LAUNCHER=${CMAKE_CXX_COMPILER_LAUNCHER:-ccache} CMAKE_C_COMPILER_LAUNCHER=${CMAKE_C_COMPILER_LAUNCHER:-ccache}
export CCACHE_DEPEND=${CCACHE_DEPEND:-1}
export CCACHE_SLOPPINESS=${CCACHE_SLOPPINESS:-pch_defines,time_macros,include_file_mtime,include_file_ctime}
export CMAKE_ARGS=${JINK_CMAKE_ARGS:-}
rm -rf build/wheel; mkdir -p build/wheel
for python in "$@"; do
  "$python" -m venv --clear build/wheel/venv
  build/wheel/venv/bin/pip wheel -q --disable-pip-version-check --no-deps -w build/wheel/made .
done
PATH=$PWD/.venv/bin:$PATH .venv/bin/auditwheel repair -w build/wheel build/wheel/made/*.whl
rm -rf build/wheel/venv build/wheel/made
ls build/wheel/*.whl
