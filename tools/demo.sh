#!/usr/bin/env bash
# Installs what is missing, builds the flight program, then flies with `jink demo`: one process `jink sim` (autopilot on UDP,
# obstacle tracks on DDS), one process `jink fly`. Ends with a summary and the path of the HTML flight report.
#   tools/demo.sh [SCENARIO [MISSION]]       default: config/scenarios/crossing.yaml, config/missions/sitl.yaml
set -euo pipefail
cd "$(dirname "$0")/.."
JINK_GROUPS="" tools/build.sh release jink
exec build/release/jink demo --out out/demo "$@"
