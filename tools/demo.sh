#!/usr/bin/env bash
# Installs what is missing, builds the flight program, then flies: one process `jink sim` (autopilot on UDP, obstacle
# tracks on DDS), one process `jink fly`. Ends with a summary and the path of the HTML flight report.
#   tools/demo.sh [SCENARIO [MISSION]]       default: config/scenarios/crossing.yaml, config/missions/sitl.yaml
set -euo pipefail
cd "$(dirname "$0")/.."
scenario=${1:-config/scenarios/crossing.yaml}
mission=${2:-config/missions/sitl.yaml}
JINK_GROUPS="" tools/build.sh release jink
jink=build/release/jink
out=out/demo; mkdir -p "$out"

"$jink" sim "$scenario" --log "$out/sim.jsonl" --json "$out/sim.json" >"$out/sim.txt" 2>&1 &
sim=$!
trap 'kill -INT $sim 2>/dev/null || true; wait $sim 2>/dev/null || true' EXIT
sleep 0.5
kill -0 $sim 2>/dev/null || { cat "$out/sim.txt" >&2; exit 1; }

status=0
"$jink" fly "$mission" --log "$out/fly.jsonl" --json "$out/fly.json" || status=$?
kill -INT $sim 2>/dev/null || true
judged=0; wait $sim || judged=$?
trap - EXIT
echo "the simulator's verdict: $(tail -n 1 "$out/sim.txt")"
[ -s "$out/fly.jsonl" ] && echo "flight report: $("$jink" report "$out/fly.jsonl" --summary "$out/fly.json" --out "$out/flight.html")"
[ $status -ne 0 ] && exit $status
exit $judged
