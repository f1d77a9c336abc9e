#!/usr/bin/env bash
# Configures and builds a preset: tools/build.sh PRESET [TARGET...]. Installs what is missing first.
# JINK_GROUPS says what to build besides the flight program, in tools/setup.sh's groups: "lab test" unless told. What the
# build folder was configured for before stays. JINK_CMAKE_ARGS adds options, as -DJINK_WARNINGS_AS_ERRORS=ON.
# JINK_UNITY=ON compiles all sources of a target as one, in half the time where everything is compiled.
set -euo pipefail
cd "$(dirname "$0")/.."
preset=${1:?a preset: dev, release, asan, tsan or arm64}; shift
groups=(${JINK_GROUPS-lab test}); [ "$preset" != asan ] || groups+=(sanitizers); [ "$preset" != arm64 ] || groups+=(arm64)
tools/setup.sh ${groups[@]+"${groups[@]}"}
options=(-DCMAKE_UNITY_BUILD="${JINK_UNITY:-OFF}" -DCMAKE_UNITY_BUILD_BATCH_SIZE=0)
[ -f "build/$preset/CMakeCache.txt" ] || options+=(-DJINK_BUILD_LAB=OFF -DJINK_BUILD_TESTS=OFF)
for group in ${groups[@]+"${groups[@]}"}; do
  case $group in
  lab) options+=(-DJINK_BUILD_LAB=ON) ;;
  test) options+=(-DJINK_BUILD_TESTS=ON) ;;
  bench) options+=(-DJINK_BUILD_BENCH=ON) ;;
  esac
done
export CMAKE_CXX_COMPILER_LAUNCHER=${CMAKE_CXX_COMPILER_LAUNCHER:-ccache} CMAKE_C_COMPILER_LAUNCHER=${CMAKE_C_COMPILER_LAUNCHER:-ccache}
# Objects are found by their dependency files, which spares the preprocessor's run before each compilation.
export CCACHE_DEPEND=${CCACHE_DEPEND:-1}
# What ccache asks for where headers are precompiled; no source of the project uses __TIME__.
export CCACHE_SLOPPINESS=${CCACHE_SLOPPINESS:-pch_defines,time_macros,include_file_mtime,include_file_ctime}
# shellcheck disable=SC2086
cmake --preset "$preset" ${options[@]+"${options[@]}"} ${JINK_CMAKE_ARGS:-} >"build-$preset.log" 2>&1 ||
  { cat "build-$preset.log" >&2; rm -f "build-$preset.log"; exit 1; }
mv "build-$preset.log" "build/$preset/configure.log"
cmake --build --preset "$preset" ${1:+--target "$@"}
