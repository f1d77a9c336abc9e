#!/usr/bin/env bash
# Installs what is missing, builds, and packs the Debian packages jink, jink-lab and libjink-dev: build/package/*.deb.
# tests/package/check_package.py tries them.
set -euo pipefail
cd "$(dirname "$0")/.."
tools/setup.sh lab package
JINK_GROUPS=lab tools/build.sh release jink jink_lab
rm -rf build/package; mkdir -p build/package
(umask 022; cd build/release && cpack -B ../package >../package/cpack.log 2>&1) || { cat build/package/cpack.log >&2; exit 1; }
rm -rf build/package/_CPack_Packages
ls build/package/*.deb
