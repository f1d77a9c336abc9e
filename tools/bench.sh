#!/usr/bin/env bash
# Installs what is missing, builds the benchmarks (Release) and runs them: tools/bench.sh [--quick] [--help] [SECTION...]
set -euo pipefail
cd "$(dirname "$0")/.."
tools/setup.sh bench
JINK_CMAKE_ARGS="${JINK_CMAKE_ARGS:-} -DJINK_BUILD_BENCH=ON" tools/build.sh release jink_bench
exec build/release/jink_bench "$@"
