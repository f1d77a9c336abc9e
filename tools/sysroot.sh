#!/usr/bin/env bash
# Fetches what jink is linked with on another architecture: tools/sysroot.sh ARCH PACKAGE..., Debian's names for both.
# Debian packages with all that they depend on, and MAVSDK's library, are unpacked in build/sysroot-ARCH; nothing is
# installed, and no package of this machine's own changes. Quick when all is there.
set -euo pipefail
cd "$(dirname "$0")/.."
arch=${1:?an architecture: arm64}; shift
case $arch in
arm64) wheel=manylinux_2_28_aarch64 ;;
*) echo "sysroot: MAVSDK has no library for $arch" >&2; exit 2 ;;
esac
root=$PWD/build/sysroot-$arch
mavsdk=$(grep '^mavsdk==' tools/requirements.txt)
present=$(cat "$root/.holds" 2>/dev/null || true)
missing=$(printf '%s\n' "$@" "$mavsdk" | grep -vxF "$present" || true)
[ -n "$missing" ] || exit 0

set -- $(printf '%s\n' "$@" $present | grep -v '^mavsdk==' | sort -u)  # what is there already stays
echo "sysroot: fetching for $arch: $*"
rm -rf "$root"
mkdir -p "$root/.apt/lists/partial" "$root/.apt/archives/partial" "$root/DEBIAN"
: >"$root/.apt/status"
# The machine's own sources and keys, but a state of its own in which nothing is installed.
apt=(apt-get -qq -o "APT::Architecture=$arch" -o "APT::Architectures::=$arch" -o "Dir::State=$root/.apt" -o "Dir::Cache=$root/.apt"
     -o "Dir::State::status=$root/.apt/status" -o APT::Sandbox::User= -o Acquire::Languages=none)
"${apt[@]}" update
"${apt[@]}" install -y --no-install-recommends --download-only "$@" >/dev/null
for deb in "$root"/.apt/archives/*.deb; do
  dpkg-deb -x "$deb" "$root"
  # dpkg-shlibdeps reads here which package has a library.
  for file in shlibs symbols; do
    dpkg-deb --ctrl-tarfile "$deb" | tar -xO "./$file" >>"$root/DEBIAN/$file" 2>/dev/null || true
  done
done
# What names a place from the root on means this one.
find "$root" -name '*.cmake' -exec sed -i "s#\"/usr\b#\"$root/usr#g" {} +
find "$root" -type l -lname '/*' | while read -r link; do ln -sfr "$root$(readlink "$link")" "$link"; done
.venv/bin/pip download -q --disable-pip-version-check --platform "$wheel" --only-binary=:all: --no-deps -d "$root/.apt" "$mavsdk"
.venv/bin/python -m zipfile -e "$root"/.apt/mavsdk-*.whl "$root/.apt/mavsdk"
mv "$root/.apt/mavsdk/mavsdk/lib/libcmavsdk.so" "$root/usr/lib/"
rm -rf "$root/.apt"
printf '%s\n' "$@" "$mavsdk" >"$root/.holds"
