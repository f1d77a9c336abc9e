#!/usr/bin/env bash
# Installs what is missing, builds the benchmarks (Release) and runs them: tools/bench.sh [--quick] [--help] [SECTION...]
set -euo pipefail
cd "$(dirname "$0")/.."
JINK_GROUPS="lab bench" tools/build.sh release jink_bench
exec build/release/jink_bench "$@"
