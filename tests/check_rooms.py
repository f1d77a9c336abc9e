"""Holds the rooms to what they may use: what a room does not link, it cannot include.

    check_rooms.py SOURCE_DIR BUILD_DIR

Each room's library has include folders for itself and for the rooms it links (cmake/Room.cmake), so an include of
another room does not compile. This reads the real compile commands and, for every room, tries a header of each room that
it does not see. It also checks that each room's CMakeLists.txt begins with what is in it and what is not.
"""

import json
import pathlib
import re
import shlex
import subprocess
import sys

source, build = (pathlib.Path(a).resolve() for a in sys.argv[1:3])
TOP = ("planner", "config", "bridge", "sim", "tools")


def room_of(file):
    return str(file.parent.relative_to(source))


def rooms():
    """Every folder with headers -> one of them."""
    found = {}
    for top in TOP:
        for header in sorted((source / top).rglob("*.hpp")):
            found.setdefault(room_of(header), str(header.relative_to(source)))
    return found


def commands():
    """Room -> compile command of one of its sources, or of all at once, without the source."""
    found = {}
    for entry in json.loads((build / "compile_commands.json").read_text()):
        words = [w for w in shlex.split(entry["command"]) if w != entry["file"]]
        if "ccache" in words[0]:
            words = words[1:]
        output = words.index("-o")
        room = words[output + 1].partition("/CMakeFiles/")[0]
        if room.split("/")[0] not in TOP or not any((source / room).glob("*.cpp")):
            continue
        found.setdefault(room, [w for i, w in enumerate(words) if w != "-c" and i not in (output, output + 1)])
    return found


def included_folders(command):
    """The rooms that a command sees: those its include folders hold."""
    seen = set()
    for word in command:
        folder = pathlib.Path(word[2:])
        if word.startswith("-I") and folder.parent == build / "rooms":
            seen.update(str(link.relative_to(folder)) for link in folder.rglob("*") if link.is_symlink())
    return seen


def may_include(command, header):
    """Whether a source of that room finds the header."""
    text = f'#if !__has_include("{header}")\n#error not to be had\n#endif\n'
    return subprocess.run([*command, "-fsyntax-only", "-w", "-x", "c++", "-"], input=text, text=True, capture_output=True,
                          check=False, cwd=build).returncode == 0


def main():
    headers, known = rooms(), commands()
    faults, refused = [], 0
    for room, command in sorted(known.items()):
        seen = included_folders(command)
        if room in headers and not may_include(command, headers[room]):
            faults.append(f"{room} does not see its own {headers[room]}")
        stranger = next((r for r in sorted(headers) if r not in seen and r != room), None)
        if stranger is None:
            faults.append(f"{room} sees every other room")
        elif may_include(command, headers[stranger]):
            faults.append(f"{room} may include {headers[stranger]}, though it does not link {stranger}")
        else:
            refused += 1
        for lower, upper in (("planner", ("config", "bridge", "sim", "tools")), ("config", ("bridge", "sim", "tools")),
                             ("bridge", ("sim", "tools")), ("sim", ("tools",))):
            if room.split("/")[0] == lower:
                faults += [f"{room} links {other}: that is upwards" for other in seen if other.split("/")[0] in upper]
    for listing in sorted(p for top in TOP for p in (source / top).rglob("CMakeLists.txt") if "ros2" not in p.parts):
        lines = [line for line in listing.read_text().splitlines() if "SPDX" not in line][:2]
        if len(lines) < 2 or not re.match(r"# In here: \S", lines[0]) or not re.match(r"# Not in here: \S", lines[1]):
            faults.append(f"{listing.relative_to(source)} does not begin with what is in here and what is not")
    print("\n".join(faults) or f"{len(known)} rooms see what they link, {refused} strangers refused")
    return 1 if faults or refused == 0 else 0


sys.exit(main())
