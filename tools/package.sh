#!/usr/bin/env bash
# Installs what is missing, builds, and packs the Debian packages jink, jink-lab and libjink-dev.
#   tools/package.sh          for amd64, or what this machine is: build/package/*.deb
#   tools/package.sh arm64    cross-built: build/package-arm64/*.deb
# JINK_GROUPS= leaves jink-lab out; DEBFULLNAME and DEBEMAIL name who packs. tests/package tries them.
set -euo pipefail
cd "$(dirname "$0")/.."
arch=${1:-}
case $arch in
'') preset=release ;;
arm64) preset=arm64; export DEB_HOST_ARCH=arm64 ;;
*) echo "package: not an architecture: $arch; none for this machine's, or arm64" >&2; exit 2 ;;
esac
groups=${JINK_GROUPS-lab}
folder=build/package${arch:+-$arch}
tools/setup.sh $groups package
JINK_GROUPS=$groups tools/build.sh $preset jink ${groups:+jink_lab}
rm -rf $folder; mkdir -p $folder
(umask 022; cd build/$preset && cpack -B ../../$folder >../../$folder/cpack.log 2>&1) || { cat $folder/cpack.log >&2; exit 1; }
rm -rf $folder/_CPack_Packages
ls $folder/*.deb
