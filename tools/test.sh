#!/usr/bin/env bash
# Installs what is missing, builds, and runs the whole test suite. Safe to run again; quick when nothing changed.
#   tools/test.sh [PRESET [CTEST OPTION...]]        release unless told: dev, asan, tsan
# JINK_TARGETS names what to build where the tests chosen need less than all.
set -euo pipefail
cd "$(dirname "$0")/.."
preset=${1:-release}; shift || true
# shellcheck disable=SC2086
JINK_GROUPS="lab test" tools/build.sh "$preset" ${JINK_TARGETS:-}
if [ "$preset" = tsan ]; then export TSAN_OPTIONS="suppressions=$PWD/tests/support/tsan.supp ${TSAN_OPTIONS:-}"; fi
if [ "$preset" = asan ]; then
  # Fast DDS 2.9 deletes the statistics part of its writers through a base of another size.
  export ASAN_OPTIONS="new_delete_type_mismatch=0 ${ASAN_OPTIONS:-}"
fi
# One more than cores: the system tests mostly wait.
log=build/$preset/Testing/Temporary/LastTest.log
ctest --preset "$preset" -j "$(($(nproc) + 1))" "$@" || {
  status=$?
  echo "== what failed, from $log:"
  grep -hE -A4 '^FAIL|^AssertionError|: Failure$|ERROR: .*Sanitizer|WARNING: ThreadSanitizer' "$log" | tail -n 80
  exit "$status"
}
