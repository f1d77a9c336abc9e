#!/usr/bin/env bash
# Builds the fuzzers of tests/fuzz (clang 14, libFuzzer, address and undefined sanitizers) and runs each for so many
# seconds, two at a time, from its corpus. Not zero where one finds something; the input is then under
# build/asan/artifacts, and belongs into tests/fuzz/corpus/NAME once it is mended.
#   tools/fuzz.sh [SECONDS [NAME...]]        default: 60, all
set -euo pipefail
cd "$(dirname "$0")/.."
seconds=${1:-60}
case $seconds in ''|*[!0-9]*|0) echo "fuzz: '$seconds' is not a whole number of seconds above 0" >&2; exit 2 ;; esac
shift || true
JINK_GROUPS="test" tools/build.sh asan jink_fuzzers
names=("$@"); [ $# -gt 0 ] || names=($(basename -a tests/fuzz/corpus/*))
for name in "${names[@]}"; do
  [ -x "build/asan/fuzz_$name" ] || { echo "fuzz: there is no fuzzer '$name'" >&2; exit 2; }
done

fuzz() {
  local name=$1 log=build/asan/$1.log
  mkdir -p "build/asan/found/$name" build/asan/artifacts
  # What was found goes to the first folder; a corpus that is worth keeping is committed by hand.
  if "build/asan/fuzz_$name" -max_total_time="$seconds" -timeout=20 -rss_limit_mb=2048 -print_final_stats=1 \
      -artifact_prefix="build/asan/artifacts/$name-" "build/asan/found/$name" "tests/fuzz/corpus/$name" >"$log" 2>&1; then
    echo "fuzz: $name: $(sed -n 's/^stat::number_of_executed_units: *//p' "$log") inputs, nothing found"
  else
    echo "fuzz: $name: FOUND SOMETHING, see $PWD/$log" >&2
    tail -n 60 "$log" >&2
    return 1
  fi
}
export -f fuzz; export seconds
printf '%s\n' "${names[@]}" | xargs -P 2 -I{} bash -c 'fuzz {}'
