#!/usr/bin/env bash
# Formats the C++ sources with clang-format 14; with --check only tells which ones it would change.
set -euo pipefail
cd "$(dirname "$0")/.."
mode=(-i); [ "${1:-}" = --check ] && mode=(--dry-run --Werror)
git ls-files -z '*.cpp' '*.hpp' '*.h' | xargs -0 clang-format-14 "${mode[@]}"
