#!/usr/bin/env bash
# Installs what is missing, builds, and runs the whole test suite. Safe to run again; quick when nothing changed.
#   tools/test.sh [PRESET [CTEST OPTION...]]        release unless told: dev, asan, tsan
# JINK_TARGETS names what to build where the tests chosen need less than all.
set -euo pipefail
cd "$(dirname "$0")/.."
preset=${1:-release}; shift || true
# shellcheck disable=SC2086
JINK_GROUPS="lab test" tools/build.sh "$preset" ${JINK_TARGETS:-}
# One more than cores: the system tests mostly wait.
log=build/$preset/Testing/Temporary/LastTest.log
ctest --preset "$preset" -j "$(($(nproc) + 1))" "$@" || {
  status=$?
  echo "== what failed, from $log:"
  grep -hE -A4 '^FAIL|^AssertionError|: Failure$|ERROR: .*Sanitizer|WARNING: ThreadSanitizer' "$log" | tail -n 80
  exit "$status"
}
