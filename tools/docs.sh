#!/usr/bin/env bash
# Makes the reference of planner/ with doxygen: build/docs/html/index.html. Fails where a public entity is undocumented.
set -euo pipefail
cd "$(dirname "$0")/.."
tools/setup.sh docs
# Doxygen is silent about members of a namespace that is not documented itself.
git grep -hoE '^namespace jink[a-z_:]*' -- 'planner/*.hpp' | sort -u | while read -r _ name; do
  grep -qx "/// @namespace $name" docs/doxygen.dox ||
    { echo "docs: docs/doxygen.dox says nothing of namespace $name" >&2; exit 1; }
done
mkdir -p build/docs
doxygen docs/Doxyfile
echo "the planner's reference: build/docs/html/index.html"
