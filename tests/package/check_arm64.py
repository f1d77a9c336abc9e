#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Holds the packages that are cross-built for arm64 to those of amd64: the same files and dependencies, and what they
compute has the same bits. Programs run under qemu.

    check_arm64.py [FOLDER [AMD64]]     the packages' folders; build/package-arm64 and build/package unless told

What tools/package.sh needs is there (tools/setup.sh arm64). Where lintian is installed, it has a say too.
"""

import json
import os
import pathlib
import re
import sys
import tempfile

from check_package import SOURCE, Failed, check, fields, output, verdict_of_lintian

SYSROOT = SOURCE / "build/sysroot-arm64"
EMULATOR = ("qemu-aarch64-static", "-L", SYSROOT)
# Of a summary, what the machine has a say in.
CLOCKED = {"planning_time_s", "threads"}


def names(deb):
    return sorted(line.split()[5] for line in output("dpkg-deb", "-c", deb).splitlines())


def depended_on(control):
    return sorted(re.findall(r"(?:^|, )([a-z0-9.+-]+)", control.get("Depends", "")))


def packages(debs, natives):
    for name, deb in debs.items():
        control, native = fields(deb)[0], fields(natives[name])[0]
        check((control["Architecture"], control["Version"]) == ("arm64", native["Version"]), f"{deb.name}")
        check(names(deb) == names(natives[name]), f"{name}: the same files as for amd64")
        check(depended_on(control) == depended_on(native), f"and the same dependencies: {control.get('Depends')}")


def places(root):
    files = [file for file in root.rglob("*") if file.is_file() and not file.is_symlink()]
    strangers = [file for file in files if str(SOURCE).encode() in file.read_bytes()]
    check(not strangers, f"no file names the source tree {strangers}")
    machines = {file.name: output("readelf", "-h", file) for file in files if file.read_bytes()[:4] == b"\x7fELF"}
    check("jink" in machines and all("AArch64" in header for header in machines.values()), f"for arm64: {', '.join(machines)}")


def summaries(root, native, scratch):
    """What plans and flights give is the same to the last bit."""
    program = (*EMULATOR, root / "usr/bin/jink")
    check(output(*program, "--version") == output(native / "usr/bin/jink", "--version"), "jink --version")
    scenarios = root / "etc/jink/scenarios"
    for command, name, *options in (("plan", "crossing"), ("plan", "table2-5", "--mode", "paper"), ("replay", "crossing")):
        told = []
        for run in (program, (native / "usr/bin/jink",)):
            file = scratch / "summary.json"
            output(*run, command, scenarios / f"{name}.yaml", *options, "--json", file, seconds=600)
            told.append({key: value for key, value in json.loads(file.read_text()).items() if key not in CLOCKED})
        differ = [key for key in told[0] if told[0][key] != told[1].get(key)]
        check(not differ, f"jink {command} {name}: {told[0]['outcome']}, the same bits as on amd64 {differ or ''}")


def examples(root, native, scratch):
    """Built by find_package(jink) for both, they print the same."""
    printed = []
    for place, more in ((root, [f"-DCMAKE_TOOLCHAIN_FILE={SOURCE / 'cmake/arm64.cmake'}"]), (native, [])):
        build = scratch / f"examples-{place.name}"
        output("cmake", "-S", place / "usr/share/doc/libjink-dev/examples", "-B", build, "-DCMAKE_BUILD_TYPE=Release",
               f"-Djink_DIR={place / 'usr/lib/cmake/jink'}", *more)
        output("cmake", "--build", build, "--parallel", seconds=600)
        emulator = EMULATOR if more else ()
        printed.append({file.name: output(*emulator, file) for file in sorted(build.glob("0*")) if file.is_file()})
    check(printed[0] == printed[1] and len(printed[0]) == 5, f"the examples print what they do on amd64: {', '.join(printed[0])}")


def main(arguments):
    folders = [SOURCE / "build/package-arm64", SOURCE / "build/package"]
    folders[:len(arguments)] = map(pathlib.Path, arguments)
    os.environ.pop("JINK_CONFIG_DIR", None)
    with tempfile.TemporaryDirectory(prefix="jink-arm64-") as name:
        place = pathlib.Path(name).resolve()
        try:
            debs, natives = ({re.sub("_.*", "", deb.name): deb for deb in there.glob("*.deb")} for there in folders)
            check({"jink", "libjink-dev"} <= set(debs) <= set(natives), f"packages {', '.join(debs)} in {folders[0]}, beside those in {folders[1]}")
            for name in debs:
                output("dpkg-deb", "-x", debs[name], place / "arm64")
                output("dpkg-deb", "-x", natives[name], place / "amd64")
            packages(debs, natives)
            places(place / "arm64")
            verdict_of_lintian(debs)
            summaries(place / "arm64", place / "amd64", place)
            examples(place / "arm64", place / "amd64", place)
        except Failed as failed:
            print(f"FAIL {failed}")
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
