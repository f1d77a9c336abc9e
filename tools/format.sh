#!/usr/bin/env bash
# Formats the C++ sources with clang-format 14; with --check only says which ones it would change.
#   tools/format.sh [--check] [FILE...]      default: all that git tracks
set -euo pipefail
cd "$(dirname "$0")/.."
mode=(-i)
if [ "${1:-}" = --check ]; then mode=(--dry-run --Werror); shift; fi
files=("$@"); [ $# -gt 0 ] || mapfile -t files < <(git ls-files '*.cpp' '*.hpp' '*.h')
printf '%s\0' "${files[@]}" | xargs -0 clang-format-14 "${mode[@]}"
