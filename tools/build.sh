#!/usr/bin/env bash
# Configures and builds a preset: tools/build.sh PRESET [TARGET...]. Installs what is missing first.
# JINK_CMAKE_ARGS adds options, as -DJINK_WARNINGS_AS_ERRORS=ON.
set -euo pipefail
cd "$(dirname "$0")/.."
preset=${1:?a preset: dev, release, asan or tsan}; shift
tools/setup.sh
export CMAKE_CXX_COMPILER_LAUNCHER=${CMAKE_CXX_COMPILER_LAUNCHER:-ccache} CMAKE_C_COMPILER_LAUNCHER=${CMAKE_C_COMPILER_LAUNCHER:-ccache}
# shellcheck disable=SC2086
cmake --preset "$preset" ${JINK_CMAKE_ARGS:-} >"build-$preset.log" 2>&1 || { cat "build-$preset.log" >&2; rm -f "build-$preset.log"; exit 1; }
mv "build-$preset.log" "build/$preset/configure.log"
cmake --build --preset "$preset" ${1:+--target "$@"}
