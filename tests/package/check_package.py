#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Holds the Debian packages of tools/package.sh to what is promised of them: unpacked into a folder, not installed.

    check_package.py [FOLDER]       the packages' folder; build/package unless told

Needs Python alone, besides what the packages need, CMake and a compiler. It flies `jink demo`, so no other simulator
may run. Where lintian is installed, it has a say too.
"""

import gzip
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parents[2]
PACKAGES = ("jink", "jink-lab", "libjink-dev")
LABORATORY = ("ompl", "pagmo", "boost", "tbb")


class Failed(Exception):
    """A check did not hold; its text says which."""


def check(holds, text):
    if not holds:
        raise Failed(text)
    print(f"ok   {text}", flush=True)


def output(*command, status=0, seconds=120, **options):
    done = subprocess.run([str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          timeout=seconds, check=False, **options)
    if done.returncode != status:
        raise Failed(f"{' '.join(map(str, command))}: exit status {done.returncode}\n{done.stdout[-4000:]}")
    return done.stdout


def fields(deb):
    """The fields and the file names of a package's control archive."""
    control = dict(re.findall(r"^(\S+): (.*)$", output("dpkg-deb", "-f", deb), re.MULTILINE))
    names = output("sh", "-c", 'dpkg-deb --ctrl-tarfile "$0" | tar t', deb).split()
    return control, {name.removeprefix("./") for name in names} - {""}


def control_archives(debs):
    for name, deb in debs.items():
        control, files = fields(deb)
        check(control["Package"] == name and control["Maintainer"] and control["Section"], f"{deb.name}: {control['Version']}")
        check(not files & {"preinst", "postinst", "prerm", "postrm"}, f"{name}: nothing is run, enabled or started")
        depends = control.get("Depends", "")
        if name == "jink":
            check("libfastrtps" in depends and "libc6" in depends, "jink depends on the libraries that it links")
            check(not any(word in depends for word in LABORATORY), "and on none of the laboratory's")
            kept = output("dpkg-deb", "-I", deb, "conffiles").split()
            listed = re.findall(r" \.(/etc/\S+[^/\s])$", output("dpkg-deb", "-c", deb), re.MULTILINE)
            check(sorted(kept) == sorted(listed) and len(kept) > 15, f"all {len(kept)} files in /etc are the user's to change")
        if name == "jink-lab":
            check(f"jink (= {control['Version']})" in depends and "libompl" in depends, "jink-lab needs the same jink")
        if name == "libjink-dev":
            check(depends == "libeigen3-dev (>= 3.4)", "libjink-dev needs Eigen alone")


def places(root):
    """What is in the packages knows nothing of where it was made."""
    strangers = [file for file in root.rglob("*") if file.is_file() and str(SOURCE).encode() in file.read_bytes()]
    check(not strangers, f"no file names the source tree {strangers}")
    for program in ("jink", "jink-lab"):
        paths = re.findall(r"R(?:UN)?PATH\D*\[(.*)\]", output("readelf", "-d", root / "usr/bin" / program))
        check(paths == ["$ORIGIN/../lib/jink/mavsdk"], f"{program}: run path {paths}")
        libraries = output("ldd", root / "usr/bin" / program)
        check("not found" not in libraries and str(root) in re.search(r"libcmavsdk\S* => .*/usr/(\S+)|$", libraries)[0],
              f"{program} finds its libraries, MAVSDK in the package")
    for name in PACKAGES:
        folder = root / "usr/share/doc" / name
        check("BSD-3-Clause" in (folder / "copyright").read_text() and (folder / "changelog.Debian.gz").exists(), f"{name}: licence")
    check("PX4 Development Team" in (root / "usr/share/doc/jink/copyright").read_text(), "and MAVSDK's")
    unit = (root / "usr/lib/systemd/system/jink.service").read_text()
    mission = re.search(r"^Environment=JINK_MISSION=/(etc/jink/\S+)", unit, re.MULTILINE)[1]
    check("DynamicUser=yes" in unit and (root / mission).exists(), f"jink.service flies /{mission} without privileges")


def commands(program):
    """A program's commands as --help has them."""
    return re.findall(r"^  ([a-z]+) ", output(program, "--help").partition("Subcommands:")[2], re.MULTILINE)


def completed(root, *words):
    script = 'source "$0"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _jink; printf "%s\\n" "${COMPREPLY[@]}"'
    return output("bash", "-c", script, root / "usr/share/bash-completion/completions/jink", *words).split()


def words(root):
    """The manual pages know every command, and so does completion, which knows every option too."""
    for name in ("jink", "jink-lab"):
        program = root / "usr/bin" / name
        page = gzip.open(root / f"usr/share/man/man1/{name}.1.gz", "rt").read().replace("\\-", "-")
        missing = [command for command in commands(program) if f"{name} {command}" not in page]
        check(not missing and len(commands(program)) > 3, f"{name}(1) tells of {', '.join(commands(program))} {missing or ''}")
        check(set(commands(program)) <= set(completed(root, program, "")), f"{name} TAB completes them")
        check((root / "usr/share/bash-completion/completions" / name).exists(), f"{name} has its completion")
        for command in commands(program):
            options = set(re.findall(r"^  (?:-h,)?(--[a-z0-9-]+)", output(program, command, "--help"), re.MULTILINE))
            check(options and options == set(completed(root, program, command, "--")), f"{name} {command} --TAB: {len(options)} options")
    check(completed(root, root / "usr/bin/jink", "de") == ["demo"], "jink deTAB is demo")


def programs(root, scratch):
    jink = root / "usr/bin/jink"
    version = output(jink, "--version").split()[1]
    control, _ = fields(root.parent / "jink.deb")
    check(control["Version"].startswith(version + "-"), f"jink {version}")
    crossing = root / "etc/jink/scenarios/crossing.yaml"
    check("reached" in output(jink, "plan", crossing, cwd=scratch), "jink plan of an installed scenario")
    parameters = root / "etc/jink/planner.yaml"
    text = parameters.read_text()
    parameters.write_text(text + "surplus: 1\n")
    said = output(jink, "plan", crossing, status=2, cwd=scratch)
    parameters.write_text(text)
    check(str(parameters) in said, f"its parameters are the installed ones: {said.strip()}")
    taken = scratch / "file"
    taken.write_text("")
    said = output(jink, "demo", "--out", taken, status=2, cwd=scratch)
    check("--out" in said and len(said.splitlines()) == 1, said.strip())
    said = output(jink, "demo", crossing, crossing, status=2, cwd=scratch)
    check("jink: " in said and "jink-mission/1" in said, "jink demo with a mission that is none")
    said = output(jink, "demo", "none.yaml", status=2, cwd=scratch)
    check(said.startswith("jink: ") and len(said.splitlines()) == 1, f"with a scenario that is none: {said.strip()}")
    said = output(jink, "demo", cwd=scratch)
    check("the simulator's verdict: scenario crossing: reached" in said, "jink demo reaches the target")
    page = pathlib.Path(re.search(r"^flight report: (.*)$", said, re.MULTILINE)[1])
    check(page == scratch / "jink-demo/flight.html" and page.stat().st_size > 100_000, f"its report is {page.name}")
    output(jink, "arena", "--runs", 1, "--families", "crossing", "--tiers", "perfect", "--out", "arena", cwd=scratch)
    check(list((scratch / "arena").iterdir()), "jink arena starts jink-lab beside it")
    (root / "usr/bin/jink-lab").rename(scratch / "jink-lab")
    said = output(jink, "arena", status=2, cwd=scratch)
    check("package jink-lab" in said, f"without it: {said.strip()}")


def library(root, scratch):
    examples = scratch / "examples"
    shutil.copytree(root / "usr/share/doc/libjink-dev/examples", examples)
    build = examples / "build"
    output("cmake", "-S", examples, "-B", build, "-DCMAKE_BUILD_TYPE=Release", f"-DCMAKE_PREFIX_PATH={root / 'usr'}")
    output("cmake", "--build", build, "--parallel")
    said = output("ctest", "--test-dir", build)
    check("100% tests passed, 0 tests failed out of 5" in said, "the examples build by find_package(jink), and do what they say")
    include = root / "usr/include/jink"
    headers = sorted(file.relative_to(include) for file in include.rglob("*.hpp"))
    text = "".join(f'#include "{header}"\n' for header in headers) + "int main() {}\n"
    (scratch / "headers.cpp").write_text(text)
    (scratch / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.22)\nproject(headers LANGUAGES CXX)\nfind_package(jink REQUIRED CONFIG)\n"
        "add_executable(headers headers.cpp)\ntarget_link_libraries(headers PRIVATE jink::planner jink::tracking)\n")
    output("cmake", "-S", scratch, "-B", scratch / "headers", f"-DCMAKE_PREFIX_PATH={root / 'usr'}")
    output("cmake", "--build", scratch / "headers")
    check(len(headers) > 40, f"all {len(headers)} headers compile outside of the tree")


def users_files(debs, place):
    """What a user changed in /etc outlives an upgrade and a removal; a purge takes it."""
    if os.geteuid() != 0:
        print("     not root: nothing is installed and removed")
        return
    root = place / "installed"
    (root / "var/lib/dpkg/updates").mkdir(parents=True)
    (root / "var/lib/dpkg/info").mkdir()
    for name in ("status", "available"):
        (root / "var/lib/dpkg" / name).write_text("")
    dpkg = ("dpkg", f"--root={root}", f"--log={place / 'dpkg.log'}", "--force-depends", "--force-script-chrootless")
    parameters = root / "etc/jink/planner.yaml"
    output(*dpkg, "-i", debs["jink"], debs["jink-lab"])
    changed = parameters.read_text() + "# mine\n"
    parameters.write_text(changed)
    output(*dpkg, "-i", debs["jink"])
    check(parameters.read_text() == changed, "a changed planner.yaml outlives an upgrade")
    output(*dpkg, "-r", "jink-lab", "jink")
    check(parameters.read_text() == changed and not (root / "usr/bin/jink").exists(), "and a removal")
    output(*dpkg, "-P", "jink")
    check(not (root / "etc/jink").exists(), "a purge takes it")


def service(root, scratch):
    """The unit is one, and what it starts flies, and is stopped as systemd does it."""
    unit = root / "usr/lib/systemd/system/jink.service"
    if shutil.which("systemd-analyze"):
        said = output("systemd-analyze", "verify", "--man=no", unit)
        check(not said, f"systemd has nothing to say to {unit.name} {said}")
    text = unit.read_text()
    command = re.search(r"^ExecStart=/bin/sh -c '(.*)'$", text, re.MULTILINE)[1].replace("%%", "%")
    mission = re.search(r"^Environment=JINK_MISSION=/(etc/jink/\S+)", text, re.MULTILINE)[1]
    state = scratch / "state"
    state.mkdir()
    environment = {"PATH": f"{root / 'usr/bin'}:{os.environ['PATH']}", "JINK_MISSION": str(root / mission)}
    with subprocess.Popen([root / "usr/bin/jink", "sim", root / "etc/jink/scenarios/crossing.yaml"], stdout=subprocess.DEVNULL,
                          stderr=subprocess.DEVNULL) as simulator:
        try:
            flight = subprocess.Popen(["/bin/sh", "-c", command], cwd=state, env=environment, text=True, stdout=subprocess.PIPE,
                                      stderr=subprocess.STDOUT)
            said = ""
            for line in flight.stdout:
                said += line
                if re.search(r"offboard +\d+ %", line) and flight.poll() is None:
                    flight.terminate()
            status = flight.wait()
        finally:
            simulator.terminate()
    check(status == 1 and "accepted: hold" in said and list(state.glob("flight-*.jsonl")),
          f"{unit.name} flies; SIGTERM brakes and hands over: {said.splitlines()[-4:-3]}")


def verdict_of_lintian(debs):
    if shutil.which("lintian") is None:
        print("     lintian is not installed: not asked")
        return
    # Nobody's bug tracker waits for an upload.
    said = output("lintian", "--no-tag-display-limit", "--allow-root", "--fail-on", "error,warning", "--suppress-tags",
                  "initial-upload-closes-no-bugs", *debs.values())
    check(not re.search("^[EW]:", said, re.MULTILINE), "lintian has no errors and no warnings")


def main(arguments):
    folder = pathlib.Path(arguments[0] if arguments else SOURCE / "build/package")
    os.environ.pop("JINK_CONFIG_DIR", None)
    with tempfile.TemporaryDirectory(prefix="jink-package-") as name:
        place = pathlib.Path(name).resolve()
        root, scratch = place / "root", place / "scratch"
        scratch.mkdir()
        try:
            debs = {}
            for package in PACKAGES:
                found = list(folder.glob(f"{package}_*.deb"))
                check(len(found) == 1, f"one package {package} in {folder}")
                debs[package] = found[0]
                shutil.copy(found[0], place / f"{package}.deb")
                output("dpkg-deb", "-x", found[0], root)
            control_archives(debs)
            places(root)
            words(root)
            users_files(debs, place)
            verdict_of_lintian(debs)
            service(root, scratch)
            programs(root, scratch)
            library(root, scratch)
        except Failed as failed:
            print(f"FAIL {failed}")
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
