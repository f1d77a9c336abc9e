#!/usr/bin/env bash
# Runs clang-tidy 14 over the project's sources with the release build's commands: tools/tidy.sh [FILE...]
set -euo pipefail
cd "$(dirname "$0")/.."
# Clang cannot read GCC's precompiled headers.
mkdir -p build/tidy
cmake -B build/release -DCMAKE_UNITY_BUILD=OFF >/dev/null  # a command for each source
sed 's/ -include [^ ]*cmake_pch.hxx//' build/release/compile_commands.json >build/tidy/compile_commands.json
files=("$@"); [ $# -gt 0 ] || mapfile -t files < <(git ls-files '*.cpp' | grep -vE '^tests/fuzz/')
printf '%s\n' "${files[@]}" | xargs -P "$(nproc)" -n 4 clang-tidy-14 -p build/tidy --quiet --extra-arg=-Wno-unknown-warning-option 2>/dev/null
